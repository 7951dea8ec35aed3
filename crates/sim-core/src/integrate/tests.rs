//! Measures the properties that the table states for each method.

use alloc::{vec, vec::Vec};
use core::f64::consts::PI;
use glam::{DMat2, DVec2, DVec3};

use super::*;

/// A system of one body with a given acceleration. Jacobians come from finite differences.
struct One<F> {
    acceleration: F,
    is_coupled: bool,
    by_velocity: bool,
}

impl<F: Fn(f64, DVec3, DVec3) -> DVec3> System for One<F> {
    fn len(&self) -> usize {
        1
    }

    fn is_coupled(&self) -> bool {
        self.is_coupled
    }

    fn depends_on_velocity(&self) -> bool {
        self.by_velocity
    }

    fn accelerations(&self, t: f64, x: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        a[0] = (self.acceleration)(t, x[0], v[0]);
    }
}

fn conservative<F: Fn(DVec3) -> DVec3>(a: F) -> One<impl Fn(f64, DVec3, DVec3) -> DVec3> {
    One {
        acceleration: move |_, x, _| a(x),
        is_coupled: false,
        by_velocity: false,
    }
}

fn general<F: Fn(f64, DVec3, DVec3) -> DVec3>(acceleration: F) -> One<F> {
    One {
        acceleration,
        is_coupled: false,
        by_velocity: true,
    }
}

fn kepler() -> One<impl Fn(f64, DVec3, DVec3) -> DVec3> {
    conservative(|x| -x / (x.length_squared() * libm::sqrt(x.length_squared())))
}

fn fixed() -> impl Iterator<Item = &'static Method> {
    METHODS.into_iter().filter(|method| !method.adaptive)
}

fn run<S: System>(
    method: &'static Method,
    system: &S,
    (x, v): (DVec3, DVec3),
    (dt, steps): (f64, u32),
) -> (DVec3, DVec3) {
    let mut stepper = Stepper::new(method, &[x], &[v]);
    for _ in 0..steps {
        stepper.step(system, dt).unwrap();
    }
    (stepper.position()[0], stepper.velocity()[0])
}

#[test]
fn names_are_unique_and_found() {
    for method in METHODS {
        assert!(core::ptr::eq(Method::named(method.name).unwrap(), method));
    }
    assert_eq!(Method::named("euler"), None);
}

#[test]
fn a_constant_acceleration_does_what_the_method_says_of_it() {
    let (x, v, a) = (
        DVec3::X,
        DVec3::new(1.0, 2.0, 3.0),
        DVec3::new(0.0, -0.5, 2.0),
    );
    for is_coupled in [false, true] {
        let system = One {
            acceleration: move |_, _, _| a,
            is_coupled,
            by_velocity: true,
        };
        for method in METHODS {
            let (n, dt) = (20, 0.2);
            let (x1, v1) = run(method, &system, (x, v), (dt, n));
            let n = f64::from(n);
            // A step is x + dt v + fall dt² a; v grows by dt a in each.
            let weight = n * (n - 1.0) / 2.0 + n * method.fall.unwrap();
            let exact = x + n * dt * v + weight * dt * dt * a;
            assert!(
                (x1 - exact).length() < 1e-12,
                "{}: {x1} {exact}",
                method.name
            );
            assert!((v1 - (v + n * dt * a)).length() < 1e-12, "{}", method.name);
        }
    }
}

/// The matrix of a method's step on `x'' = -k x - c x'`, from the definition of the method for `y' = A y`.
fn step_matrix(method: &Method, k: f64, c: f64, h: f64) -> DMat2 {
    let one = DMat2::IDENTITY;
    let a = h * DMat2::from_cols(DVec2::new(0.0, -k), DVec2::new(1.0, -c));
    let drift = |part: f64| DMat2::from_cols(DVec2::X, DVec2::new(part * h, 1.0));
    // v + e h a(x, v) with the velocity before, then v + i h a(x, v) with the velocity after.
    let kick = |explicit: f64, implicit: f64| {
        let (e, i) = (explicit * h, implicit * h);
        let (pull, keep) = (-(e + i) * k, 1.0 - e * c);
        DMat2::from_cols(
            DVec2::new(1.0, pull / (1.0 + i * c)),
            DVec2::new(0.0, keep / (1.0 + i * c)),
        )
    };
    let composed = |drifts: &[f64], kicks: &[f64]| {
        let (mut matrix, mut explicit) = (drift(drifts[0]), drifts[0]);
        for (b, next) in kicks.iter().zip(&drifts[1..]) {
            matrix = drift(*next) * kick(explicit, b - explicit) * matrix;
            explicit = next - (b - explicit);
        }
        matrix
    };
    match method.name {
        "forward-euler" => one + a,
        "backward-euler" => (one - a).inverse(),
        "symplectic-euler" => drift(1.0) * kick(1.0, 0.0),
        "rk4" => one + a * (one + 0.5 * a * (one + 1.0 / 3.0 * a * (one + 0.25 * a))),
        "velocity-verlet" => kick(0.0, 0.5) * drift(1.0) * kick(0.5, 0.0),
        "implicit-midpoint" => (one - 0.5 * a).inverse() * (one + 0.5 * a),
        "symplectic-4" => composed(&symplectic4::DRIFTS, &symplectic4::KICKS),
        "symplectic-8" => composed(&symplectic8::DRIFTS, &symplectic8::KICKS),
        // The Padé approximation of exp with degrees 2 and 3 (Hairer, Wanner 1996, sec. IV.3).
        "radau5" => {
            let over = one + a * (2.0 / 5.0 * one + a * (1.0 / 20.0));
            let under = one + a * (-3.0 / 5.0 * one + a * (3.0 / 20.0 * one - a * (1.0 / 60.0)));
            under.inverse() * over
        }
        other => panic!("{other} has no step matrix here"),
    }
}

#[test]
fn each_fixed_step_method_meets_the_powers_of_its_step_matrix() {
    for (k, c, dt) in [(1.0, 0.0, 0.1), (4.0, 0.3, 0.05), (1e6, 1e3, 5e-4)] {
        let system = One {
            acceleration: move |_, x: DVec3, v: DVec3| -k * x - c * v,
            is_coupled: false,
            by_velocity: c != 0.0,
        };
        for method in fixed() {
            let matrix = step_matrix(method, k, c, dt);
            let start = DVec2::new(1.0, 0.5);
            let mut exact = start;
            let mut stepper = Stepper::new(method, &[start.x * DVec3::X], &[start.y * DVec3::X]);
            let mut scale: f64 = 0.0;
            for step in 0..1000 {
                exact = matrix * exact;
                stepper.step(&system, dt).unwrap();
                let (x, v) = (stepper.position()[0].x, stepper.velocity()[0].x);
                let rate = libm::sqrt(k);
                let error = (x - exact.x).abs() * rate + (v - exact.y).abs();
                scale = scale.max(exact.x.abs() * rate + exact.y.abs());
                assert!(
                    error < 1e-12 * scale,
                    "{} {k} {c} step {step}: {error}",
                    method.name
                );
            }
        }
    }
}

/// `log2` of the factor by which the error at time `t` decreases with half of `dt`.
fn measured_order<S: System>(
    method: &'static Method,
    system: &S,
    start: (DVec3, DVec3),
    exact: (DVec3, DVec3),
    (t, steps): (f64, u32),
) -> f64 {
    let error = |n: u32| {
        let (x, v) = run(method, system, start, (t / f64::from(n), n));
        (x - exact.0).length() + (v - exact.1).length()
    };
    libm::log2(error(steps) / error(2 * steps))
}

#[test]
fn fixed_step_methods_have_the_order_they_claim() {
    let (cos, sin) = (libm::cos(2.0), libm::sin(2.0));
    let oscillator = conservative(|x| -x);
    let drag = general(|_, _, v: DVec3| -v.length() * v);
    // x = (1 + t) exp(-t): the acceleration depends on time, position and velocity.
    let driven = general(|t, x: DVec3, v: DVec3| {
        let e = libm::exp(-t);
        let along = (1.0 + t) * e;
        -2.0 * v - x * x.x / along * DVec3::X
    });
    for method in fixed() {
        // Enough steps that the leading term dominates, and few enough that rounding does not.
        let steps = match method.order {
            8 => 4,
            5 => 16,
            4 => 64,
            2 => 128,
            _ => 1024,
        };
        let claimed = f64::from(method.order);
        let of = |system: &dyn Fn(u32) -> f64| system(steps);
        let orders = [
            of(&|n| {
                let exact = (cos * DVec3::X, -sin * DVec3::X);
                measured_order(
                    method,
                    &oscillator,
                    (DVec3::X, DVec3::ZERO),
                    exact,
                    (2.0, n),
                )
            }),
            of(&|n| {
                let exact = (libm::log(3.0) * DVec3::X, DVec3::X / 3.0);
                let n = if method.order == 8 { 12 } else { 4 * n };
                measured_order(method, &drag, (DVec3::ZERO, DVec3::X), exact, (2.0, n))
            }),
            of(&|n| {
                let e = libm::exp(-1.0);
                let exact = (2.0 * e * DVec3::X, -e * DVec3::X);
                measured_order(method, &driven, (DVec3::X, DVec3::ZERO), exact, (1.0, n))
            }),
        ];
        for order in orders {
            assert!(
                (order - claimed).abs() < 0.05,
                "{}: {orders:?}",
                method.name
            );
        }
    }
}

#[test]
fn reversible_methods_go_back_where_they_came_from_and_others_do_not() {
    let pendulum = conservative(|x| DVec3::new(-libm::sin(x.x), -x.y * x.y * x.y, 0.0));
    let dragged = general(|_, x: DVec3, v: DVec3| -x - 0.1 * v.length() * v);
    let start = (DVec3::new(1.0, 0.5, 0.0), DVec3::new(0.0, 0.2, 0.0));
    for method in fixed() {
        let back = |system: &dyn Fn(&mut Stepper, f64)| {
            let mut stepper = Stepper::new(method, &[start.0], &[start.1]);
            (0..200).for_each(|_| system(&mut stepper, 0.1));
            (0..200).for_each(|_| system(&mut stepper, -0.1));
            (stepper.position()[0] - start.0).length() + (stepper.velocity()[0] - start.1).length()
        };
        let errors = [
            back(&|stepper, dt| stepper.step(&pendulum, dt).unwrap()),
            back(&|stepper, dt| stepper.step(&dragged, dt).unwrap()),
        ];
        for error in errors {
            assert_eq!(
                error < 1e-10,
                method.reversible,
                "{}: {errors:?}",
                method.name
            );
        }
    }
}

#[test]
fn symplectic_methods_do_not_drift_in_energy_and_others_do() {
    let energy = |stepper: &Stepper| {
        let (x, v) = (stepper.position()[0], stepper.velocity()[0]);
        0.5 * v.length_squared() - 1.0 / x.length()
    };
    for method in fixed() {
        let e = 0.6;
        let (x, v) = (
            (1.0 - e) * DVec3::X,
            libm::sqrt((1.0 + e) / (1.0 - e)) * DVec3::Y,
        );
        let mut stepper = Stepper::new(method, &[x], &[v]);
        let start = energy(&stepper);
        // The largest error of each of 100 orbits: a drift would show as a trend.
        let mut worst = vec![];
        for _ in 0..100 {
            let mut largest: f64 = 0.0;
            for _ in 0..1000 {
                // A method that loses energy falls into the centre, where it finds no next step.
                let error = match stepper.step(&kepler(), 2.0 * PI / 1000.0) {
                    Ok(()) => (energy(&stepper) - start).abs(),
                    Err(_) => f64::INFINITY,
                };
                largest = largest.max(error);
            }
            worst.push(largest);
        }
        let growth = worst[99] / worst[0];
        if method.symplectic {
            assert!(
                growth < 1.2 || worst[99] < 2e-13,
                "{}: {growth}",
                method.name
            );
        } else {
            assert!(growth > 2.0, "{}: {growth}", method.name);
        }
    }
}

#[test]
fn coupled_and_single_solves_agree() {
    let acceleration = |_: f64, x: DVec3, v: DVec3| {
        let turn = DVec3::new(v.y, -v.x, 0.2 * v.z);
        -1e3 * x * (1.0 + x.length_squared()) - 20.0 * v + 5.0 * turn
    };
    let start = (DVec3::new(1.0, -0.5, 0.3), DVec3::new(0.0, 2.0, 1.0));
    for method in fixed() {
        let [alone, coupled] = [false, true].map(|is_coupled| {
            let system = One {
                acceleration,
                is_coupled,
                by_velocity: true,
            };
            run(method, &system, start, (0.002, 100))
        });
        let difference = (alone.0 - coupled.0).length() + (alone.1 - coupled.1).length();
        assert!(difference < 1e-10, "{}: {difference}", method.name);
    }
}

#[test]
fn an_equation_without_solution_is_an_error() {
    // w = 0 + dt (1 + w²) has no solution for dt > 1/2.
    let runaway = general(|_, _, v: DVec3| (1.0 + v.x * v.x) * DVec3::X);
    for method in [
        &backward_euler::METHOD,
        &implicit_midpoint::METHOD,
        &radau5::METHOD,
    ] {
        let mut stepper = Stepper::new(method, &[DVec3::ZERO], &[DVec3::ZERO]);
        let failure = (0..10).find_map(|_| stepper.step(&runaway, 4.0).err());
        assert!(
            matches!(failure, Some(Failure::NotConverged { body: 0, .. })),
            "{}: {failure:?}",
            method.name
        );
    }
}

#[test]
fn stability_limits_hold_from_both_sides() {
    let (k, c) = (1e6, 1e3);
    let spring = general(move |_, x: DVec3, v: DVec3| -k * x - c * v - 9.81 * DVec3::X);
    for (name, limit) in [
        ("forward-euler", 1e-3),
        ("symplectic-euler", 1e-3 * (libm::sqrt(5.0) - 1.0)),
        ("rk4", 2.622_54e-3),
        ("velocity-verlet", 2e-3),
        ("backward-euler", f64::INFINITY),
        ("implicit-midpoint", f64::INFINITY),
        ("radau5", f64::INFINITY),
    ] {
        let method = Method::named(name).unwrap();
        let found = method.stable_dt(k, c);
        assert!(
            found == limit || (found / limit - 1.0).abs() < 1e-5,
            "{name}: {found}"
        );
    }
    for method in fixed() {
        let limit = method.stable_dt(k, c);
        let reached = |dt: f64| {
            let mut stepper = Stepper::new(method, &[DVec3::X], &[DVec3::ZERO]);
            let failed = (0..4000).any(|_| stepper.step(&spring, dt).is_err());
            let (x, v) = (stepper.position()[0], stepper.velocity()[0]);
            if failed {
                f64::INFINITY
            } else {
                x.length().max(v.length() / 1e3)
            }
        };
        if limit.is_infinite() {
            let rest = reached(1.0 / 60.0);
            assert!(rest < 1.0, "{}: {rest}", method.name);
        } else {
            assert!(reached(0.99 * limit) < 1.0, "{}", method.name);
            assert!(method.growth(k, c, 1.0001 * limit) > 1.0, "{}", method.name);
            // Order eight first becomes unstable in narrow resonances, in which it grows slowly.
            if method.order < 8 {
                let beyond = reached(1.01 * limit);
                assert!(beyond.is_nan() || beyond > 1e6, "{}", method.name);
            }
        }
    }
}

#[test]
fn forward_euler_has_no_stable_step_without_damping() {
    assert_eq!(forward_euler::METHOD.stable_dt(4.0, 0.0), 0.0);
    // A narrow window of instability, where half a turn a step meets the composition's own rhythm.
    assert!((symplectic4::METHOD.stable_dt(1.0, 0.0) - 3.1328).abs() < 1e-3);
    assert!(symplectic4::METHOD.growth(1.0, 0.0, 3.145) > 1.01);
    assert!((velocity_verlet::METHOD.stable_dt(4.0, 0.0) - 1.0).abs() < 1e-6);
}

/// Bodies on a line between two walls, with springs of 10 kN/m between neighbours. It counts the products that a method
/// requests.
struct Line {
    len: usize,
    products: core::cell::Cell<u32>,
}

impl Line {
    fn pull(&self, x: &[DVec3], a: &mut [DVec3]) {
        let at = |i: usize| x.get(i).copied().unwrap_or(DVec3::ZERO);
        for (i, a) in a.iter_mut().enumerate() {
            let left = if i > 0 { at(i - 1) } else { DVec3::ZERO };
            *a = 1e4 * (left - 2.0 * x[i] + at(i + 1));
        }
    }
}

impl System for Line {
    fn len(&self) -> usize {
        self.len
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }

    fn accelerations(&self, _: f64, x: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
        self.pull(x, a);
    }

    fn apply_jacobian(
        &self,
        _: f64,
        _: (&[DVec3], &[DVec3]),
        (dx, _): (&[DVec3], &[DVec3]),
        da: &mut [DVec3],
    ) {
        self.products.set(self.products.get() + 1);
        self.pull(dx, da);
    }

    fn jacobians(&self, _: f64, _: &[DVec3], _: &[DVec3], out: &mut [Jacobians]) {
        out.fill(Jacobians {
            position: glam::DMat3::from_diagonal(DVec3::splat(-2e4)),
            ..Jacobians::ZERO
        });
    }
}

#[test]
fn the_cost_of_a_chain_grows_as_its_length() {
    for name in ["backward-euler", "implicit-midpoint", "radau5"] {
        let products = |len: usize| {
            let line = Line {
                len,
                products: 0.into(),
            };
            let shape = |i: usize| libm::sin(i as f64 * 0.7) * DVec3::X;
            let start: Vec<DVec3> = (0..len).map(shape).collect();
            let rest = vec![DVec3::ZERO; len];
            let mut stepper = Stepper::new(Method::named(name).unwrap(), &start, &rest);
            for _ in 0..10 {
                stepper.step(&line, 1.0 / 60.0).unwrap();
            }
            line.products.get()
        };
        // The cost of a product is proportional to the number of bodies; the number of products does not depend on it.
        let (short, long) = (products(100), products(1000));
        std::println!("{name}: {short} and {long} products in ten steps");
        assert!(4 * long < 5 * short, "{name}: {short} {long}");
    }
}
