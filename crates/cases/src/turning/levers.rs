//! Forces at points of turning bodies: a top and a pendulum with closed forms, and a brick on a spring.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, TAU};

use kit::elliptic::{complete, functions};
use sim_core::{
    Body, DQuat, DVec3, Force, Inertia, Method, Settings, StepError, Turn, World, WorldError,
};

use crate::problems::Effort;
use crate::worlds;

/// A body with a force at one of its points, and a known final state.
pub struct Lever {
    /// Name in tables and file names.
    pub name: &'static str,
    /// Name in prose.
    pub title: &'static str,
    /// The body, the force, and the source of the final state.
    pub about: &'static str,
    /// Its initial state.
    make: fn() -> Tied,
    /// The duration, s.
    time: fn() -> f64,
    /// The final position of [`Tied::watched`], m.
    end: fn() -> DVec3,
}

/// A body and the force on it.
#[derive(Clone, Copy, Debug)]
struct Tied {
    mass: f64,
    /// Moments of inertia about the axes of its frame, kg m².
    moments: DVec3,
    rotation: DQuat,
    /// Spin in the world, rad/s.
    spin: DVec3,
    /// Force at the centre of mass, N.
    weight: DVec3,
    /// The point of application, in its frame, m.
    point: DVec3,
    pull: Pull,
    /// The point whose final position is compared, in its frame, m.
    watched: DVec3,
}

#[derive(Clone, Copy, Debug)]
enum Pull {
    /// A constant force, N.
    Constant(DVec3),
    /// A spring without rest length to a fixed point.
    Spring { anchor: DVec3, stiffness: f64 },
}

/// All levers.
pub static LEVERS: [Lever; 3] = [
    Lever {
        name: "top",
        title: "A top nods",
        about: "A symmetric top, moments 1, 1 and 0.5 kg m², tilted by 60° and let go with 6 rad/s about its \
                axis, under 2 N down at half a metre from its centre of mass: the place of a point of its \
                axis at 1 m after one and a half nods, at its lowest, where it goes about fastest. The end is \
                that of Lagrange's quadrature.",
        make: top,
        time: || 1.5 * nod().0,
        end: || {
            let (_, around, lowest) = nod();
            let (angle, out) = (1.5 * around, (1.0 - lowest * lowest).sqrt());
            DVec3::new(out * angle.cos(), lowest, -out * angle.sin())
        },
    },
    Lever {
        name: "pendulum",
        title: "A pendulum swings",
        about: "The same body, let go level without a spin: a pendulum about its centre of mass that swings by \
                90°. The place of a point of its axis at 1 m after nine eighths of a period, where it is \
                on its way down, by Jacobi's elliptic functions: not at its lowest, where whatever loses \
                energy ends too.",
        make: pendulum,
        time: || 4.5 * complete(0.5),
        end: || {
            // sin θ/2 = k cd t, with k² = 1/2 and θ measured from the lowest position.
            let [_, cn, dn] = functions(4.5 * complete(0.5), 0.5);
            let angle = 2.0 * (0.5_f64.sqrt() * cn / dn).asin();
            DVec3::new(angle.sin(), -angle.cos(), 0.0)
        },
    },
    Lever {
        name: "brick",
        title: "A brick on a spring",
        about: "A brick of 0.2 × 1 × 0.4 m, 1 kg, that hangs by a corner from a spring of 500 N/m and falls, \
                swings and turns for 2 s: the place of the opposite corner. The end is that of the symplectic \
                method of order 8 at 1/10,000 s, with which Radau's of order 5 agrees to 1e-10 m.",
        make: brick,
        time: || 2.0,
        end: || {
            let reference =
                Method::named("symplectic-8").unwrap_or_else(|| unreachable!("a method"));
            let end = LEVERS[2].after(reference, Effort::Steps(20_000));
            end.unwrap_or(DVec3::NAN)
        },
    },
];

/// Moments about the axis, which is the third one, and across it, kg m²; the lever's torque, N m; spin, rad/s.
const ALONG: f64 = 0.5;
const ACROSS: f64 = 1.0;
const TORQUE: f64 = 1.0;
const SPIN: f64 = 6.0;
const TILT: f64 = FRAC_PI_3;

fn symmetric(tilt: f64, spin: f64) -> Tied {
    let rotation = DQuat::from_rotation_z(-tilt) * DQuat::from_rotation_x(-FRAC_PI_2);
    Tied {
        mass: 3.0,
        moments: DVec3::new(ACROSS, ACROSS, ALONG),
        rotation,
        spin: rotation * (spin * DVec3::Z),
        // It balances the force at the point; otherwise the body would fly off.
        weight: 2.0 * TORQUE * DVec3::Y,
        point: 0.5 * DVec3::Z,
        pull: Pull::Constant(-2.0 * TORQUE * DVec3::Y),
        watched: DVec3::Z,
    }
}

fn top() -> Tied {
    symmetric(TILT, SPIN)
}

fn pendulum() -> Tied {
    symmetric(FRAC_PI_2, 0.0)
}

fn brick() -> Tied {
    let half = DVec3::new(0.1, 0.5, 0.2);
    let squares = half * half / 3.0;
    let rotation = DQuat::from_rotation_z(0.3);
    Tied {
        mass: 1.0,
        moments: DVec3::new(
            squares.y + squares.z,
            squares.z + squares.x,
            squares.x + squares.y,
        ),
        rotation,
        spin: DVec3::ZERO,
        weight: -kit::worlds::GRAVITY * DVec3::Y,
        point: half,
        pull: Pull::Spring {
            anchor: rotation * half,
            stiffness: 500.0,
        },
        watched: -half,
    }
}

/// The nodding of the top: its period from one highest position of the axis to the next, s, the angle of precession in
/// that time, and the lowest height of the axis.
///
/// With `u` the height of the axis, `A² u'² = (a - u) (2 A τ (1 - u²) - L² (a - u))`, of which `a` is the root at the
/// release. If `u` is written as a cosine between two roots, the integrands are smooth and periodic, so that a sum over
/// equidistant points is exact up to rounding.
/// steps is right to rounding.
fn nod() -> (f64, f64, f64) {
    let (a, along) = (TILT.cos(), ALONG * SPIN);
    // The other factor, divided by 2 A τ, is 1 - u² - k (a - u).
    let k = along * along / (2.0 * ACROSS * TORQUE);
    let root = (0.25 * k * k + 1.0 - k * a).sqrt();
    let (lowest, beyond) = (0.5 * k - root, 0.5 * k + root);
    let steps = 256;
    let (mut time, mut around) = (0.0, 0.0);
    for i in 0..steps {
        let phase = TAU * f64::from(i) / f64::from(steps);
        let u = 0.5 * (a + lowest) + 0.5 * (a - lowest) * phase.cos();
        let dt = (ACROSS / (2.0 * TORQUE * (beyond - u))).sqrt() * TAU / f64::from(steps);
        time += dt;
        around += dt * along * (a - u) / (ACROSS * (1.0 - u * u));
    }
    (time, around, lowest)
}

impl Lever {
    /// The final position, which can take long to compute, m.
    pub fn exact(&self) -> DVec3 {
        (self.end)()
    }

    /// The duration, s.
    pub fn time(&self) -> f64 {
        (self.time)()
    }

    /// The lever in one of our worlds.
    pub fn world(&self, settings: Settings) -> Result<World, WorldError> {
        let tied = (self.make)();
        let inertia = Inertia::new(tied.moments, DQuat::IDENTITY, DVec3::ZERO);
        let body = Body {
            mass: tied.mass,
            force: tied.weight,
            turn: Some(Turn {
                rotation: tied.rotation,
                spin: tied.spin,
                inertia: Some(inertia.unwrap_or_else(|_| unreachable!("moments of bodies"))),
                ..Turn::default()
            }),
            ..Body::default()
        };
        let force = match tied.pull {
            Pull::Constant(force) => Force::Push {
                body: 0,
                point: tied.point,
                force,
            },
            Pull::Spring { anchor, stiffness } => Force::Anchor {
                body: 0,
                point: Some(tied.point),
                anchor,
                rest_length: 0.0,
                stiffness,
                damping: 0.0,
            },
        };
        worlds::under(settings, [body], &[force])
    }

    /// The distance of the watched point in a world from its final position, m.
    pub fn error(&self, world: &World, exact: DVec3) -> f64 {
        (world.point_of(0, (self.make)().watched) - exact).length()
    }

    /// The final position of the watched point, m, with a method; an adaptive one takes twenty steps of the world.
    pub fn after(&self, method: &'static Method, effort: Effort) -> Result<DVec3, StepError> {
        let (steps, tolerance) = match effort {
            Effort::Steps(steps) => (steps, 1e-13),
            Effort::Tolerance(tolerance) => (20, tolerance),
        };
        let settings = Settings {
            dt: self.time() / steps as f64,
            method,
            tolerance,
            ..Settings::default()
        };
        let mut world = self
            .world(settings)
            .unwrap_or_else(|error| unreachable!("{error}"));
        worlds::step(&mut world, steps)?;
        Ok(world.point_of(0, (self.make)().watched))
    }

    /// The same with Rapier, which receives the forces at points before every step.
    #[cfg(feature = "rapier3d-f64")]
    pub fn after_by_rapier(&self, steps: u64) -> DVec3 {
        let mut tied = self.rapier(self.time() / steps as f64);
        (0..steps).for_each(|_| tied.step());
        tied.watched()
    }

    /// The lever in a world of Rapier.
    #[cfg(feature = "rapier3d-f64")]
    pub fn rapier(&self, dt: f64) -> TiedInRapier {
        TiedInRapier::new((self.make)(), dt)
    }
}

#[cfg(feature = "rapier3d-f64")]
pub use peer::TiedInRapier;

#[cfg(feature = "rapier3d-f64")]
mod peer {
    use rapier3d_f64::prelude::*;
    use sim_core::DVec3;

    use super::{Pull, Tied};
    use crate::scenes::vector;

    /// A lever in a world of Rapier.
    pub struct TiedInRapier {
        world: PhysicsWorld,
        body: RigidBodyHandle,
        tied: Tied,
    }

    impl TiedInRapier {
        pub(super) fn new(tied: Tied, dt: f64) -> TiedInRapier {
            let mut world = PhysicsWorld::new();
            world.gravity = Vector::ZERO;
            world.integration_parameters.dt = dt;
            let r = tied.rotation;
            let pose = Pose::from_rotation(Rotation::from_xyzw(r.x, r.y, r.z, r.w));
            let inertia = MassProperties::new(Vector::ZERO, tied.mass, vector(tied.moments));
            let body = RigidBodyBuilder::dynamic()
                .pose(pose)
                .angvel(vector(tied.spin))
                .additional_mass_properties(inertia)
                .can_sleep(false);
            let body = world.insert_body(body);
            TiedInRapier { world, body, tied }
        }

        fn place(&self, point: DVec3) -> DVec3 {
            let p = self.world.bodies[self.body].position() * vector(point);
            DVec3::new(p.x, p.y, p.z)
        }

        /// Makes a step.
        pub fn step(&mut self) {
            let place = self.place(self.tied.point);
            let force = match self.tied.pull {
                Pull::Constant(force) => force,
                Pull::Spring { anchor, stiffness } => stiffness * (anchor - place),
            };
            let body = &mut self.world.bodies[self.body];
            body.reset_forces(true);
            body.reset_torques(true);
            body.add_force(vector(self.tied.weight), true);
            body.add_force_at_point(vector(force), vector(place), true);
            self.world.step();
        }

        /// The position of the watched point, m.
        pub fn watched(&self) -> DVec3 {
            self.place(self.tied.watched)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(lever: &Lever, method: &str, steps: u64) -> DVec3 {
        let method = Method::named(method).expect("a method");
        lever.after(method, Effort::Steps(steps)).expect("an end")
    }

    #[test]
    fn the_nod_is_that_of_seventeen_digits() {
        let (time, around, _) = nod();
        assert!((time - 2.278_301_997_688_738).abs() < 4e-15, "{time}");
        assert!((around - 0.786_521_243_768_659).abs() < 4e-15, "{around}");
    }

    #[test]
    fn two_methods_that_have_nothing_in_common_come_to_every_end() {
        for lever in &LEVERS {
            let exact = lever.exact();
            for (method, steps) in [("radau5", 8000), ("symplectic-8", 3000)] {
                let off = (after(lever, method, steps) - exact).length();
                println!("{} {method}: {off:e}", lever.name);
                assert!(off < 1e-10, "{} {method}: {off:e}", lever.name);
            }
        }
    }

    /// A body at rest at the end hides no error: steps of half the length give half the error.
    #[test]
    fn methods_of_the_first_order_err_by_the_first_order() {
        for lever in &LEVERS {
            let exact = lever.exact();
            let [coarse, fine] = [3200, 6400]
                .map(|steps| (after(lever, "symplectic-euler", steps) - exact).length());
            let order = (coarse / fine).log2();
            assert!((order - 1.0).abs() < 0.1, "{}: {order}", lever.name);
        }
    }
}
