//! Time integration: one fixed step from a state to the next.
//!
//! A [`Method`] is a value in the table [`METHODS`]. A new one is a file here and a line there;
//! tests, benchmarks, scene files and the control panel go through the table.

mod backward_euler;
mod forward_euler;
mod rk4;
mod symplectic_euler;

use alloc::vec::Vec;
use glam::DVec3;

/// A way to step `x' = v`, `v' = F/m` forward by `dt`.
#[derive(Debug)]
pub struct Method {
    /// Name in scene files and on the command line.
    pub name: &'static str,
    /// Name in prose.
    pub title: &'static str,
    /// Order of convergence: the error at a fixed time shrinks as `dt` to this power.
    pub order: u32,
    /// Stability on `x'' = -ω² x`, in a few words.
    pub stability: &'static str,
    /// Where it is described.
    pub source: &'static str,
    /// Steps every body: reads the state before, writes the state after.
    pub(crate) step: fn(&State, &mut State, &Forces<'_>, f64),
}

/// Every method, the course's four in its order.
pub static METHODS: [&Method; 4] = [
    &forward_euler::METHOD,
    &backward_euler::METHOD,
    &symplectic_euler::METHOD,
    &rk4::METHOD,
];

impl Method {
    /// The method of that name.
    pub fn named(name: &str) -> Option<&'static Method> {
        METHODS.into_iter().find(|m| m.name == name)
    }
}

impl PartialEq for Method {
    fn eq(&self, other: &Method) -> bool {
        self.name == other.name
    }
}

/// Motion of all bodies, in columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct State {
    pub(crate) position: Vec<DVec3>,
    pub(crate) velocity: Vec<DVec3>,
}

impl State {
    pub(crate) fn push(&mut self, position: DVec3, velocity: DVec3) {
        self.position.push(position);
        self.velocity.push(velocity);
    }

    pub(crate) fn copy_from(&mut self, other: &State) {
        self.position.copy_from_slice(&other.position);
        self.velocity.copy_from_slice(&other.velocity);
    }

    /// The first body with a component of position or velocity beyond ±`largest`, or NaN.
    pub(crate) fn beyond(&self, largest: f64) -> Option<usize> {
        let largest = DVec3::splat(largest);
        let within = |x: &DVec3| x.abs().cmple(largest).all();
        let lost = |(x, v): (&DVec3, &DVec3)| !(within(x) && within(v));
        self.position.iter().zip(&self.velocity).position(lost)
    }

    /// Writes the state that `step` makes of each body of `before` and its acceleration.
    fn fill(
        &mut self,
        before: &State,
        forces: &Forces<'_>,
        step: impl Fn(DVec3, DVec3, DVec3) -> (DVec3, DVec3),
    ) {
        let start = before.position.iter().zip(&before.velocity);
        let end = self.position.iter_mut().zip(&mut self.velocity);
        let drive = forces.force.iter().zip(forces.mass);
        for (((x, v), (x_end, v_end)), (&force, &mass)) in start.zip(end).zip(drive) {
            (*x_end, *v_end) = step(*x, *v, force / mass);
        }
    }
}

/// What drives each body: its constant resultant force (N) on its mass (kg).
pub(crate) struct Forces<'a> {
    pub(crate) force: &'a [DVec3],
    pub(crate) mass: &'a [f64],
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, Settings, World};

    /// A 2 kg point from the origin at (1, 2, 3) m/s under (0, -1, 4) N, after `steps`.
    fn fall(method: &'static Method, dt: f64, steps: u32) -> (DVec3, DVec3) {
        let settings = Settings {
            dt,
            method,
            ..Settings::default()
        };
        let mut world = World::new(settings).unwrap();
        let body = world.add(Body {
            velocity: DVec3::new(1.0, 2.0, 3.0),
            force: DVec3::new(0.0, -1.0, 4.0),
            mass: 2.0,
            ..Body::default()
        });
        let body = body.unwrap();
        for _ in 0..steps {
            world.step().unwrap();
        }
        (world.position(body), world.velocity(body))
    }

    #[test]
    fn names_are_unique_and_found() {
        for method in METHODS {
            assert!(core::ptr::eq(Method::named(method.name).unwrap(), method));
        }
        assert_eq!(Method::named("euler"), None);
    }

    #[test]
    fn each_method_meets_its_own_exact_discrete_solution() {
        let (v, a) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.0, -0.5, 2.0));
        for method in METHODS {
            // After n steps x = n dt v + k dt² a, with k the sum of the weights of a.
            let weight = |n: f64| match method.name {
                "forward-euler" => n * (n - 1.0) / 2.0,
                "backward-euler" | "symplectic-euler" => n * (n + 1.0) / 2.0,
                _ => n * n / 2.0,
            };
            for (dt, steps) in [(0.2, 20), (1.0 / 60.0, 240), (1.0 / 240.0, 960)] {
                let n = f64::from(steps);
                let (x, w) = fall(method, dt, steps);
                let exact = n * dt * v + weight(n) * dt * dt * a;
                assert!(
                    (x - exact).length() < 1e-12,
                    "{} {dt}: {x} {exact}",
                    method.name
                );
                assert!(
                    (w - (v + n * dt * a)).length() < 1e-12,
                    "{} {dt}",
                    method.name
                );
            }
        }
    }

    #[test]
    fn order_one_methods_halve_their_error_with_dt_and_rk4_has_none() {
        let exact = DVec3::new(1.0, 2.0 - 0.25, 3.0 + 1.0);
        for method in METHODS {
            let error = |n: u32| (fall(method, 1.0 / f64::from(n), n).0 - exact).length();
            match method.order {
                1 => {
                    let order = libm::log2(error(64) / error(128));
                    assert!((order - 1.0).abs() < 1e-9, "{} {order}", method.name);
                }
                _ => assert!(error(64) < 1e-13),
            }
        }
    }
}
