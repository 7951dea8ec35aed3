//! Worlds under forces against exact solutions: hard cases of dynamics.

use std::f64::consts::PI;
use std::slice;

use kit::problems::{kepler, pleiades};
use kit::worlds::{step, world_of};
use sim_core::{
    Body, BodyLaw, BodyMotion, DMat3, DVec3, Dop853, Force, Jacobians, Law, METHODS, Method,
    PairLaw, PairMotion, Settings, StepError, Tolerance, World, WorldError,
};

fn method(name: &str) -> &'static Method {
    Method::named(name).expect("a method")
}

fn world(method: &'static Method, dt: f64, bodies: &[Body], forces: &[Force]) -> World {
    let settings = Settings {
        dt,
        method,
        tolerance: 1e-13,
        ..Settings::default()
    };
    let mut world = world_of(settings, bodies);
    for force in forces {
        world.add_force(force.clone()).expect("a force");
    }
    world
}

fn point(position: DVec3, velocity: DVec3) -> Body {
    Body {
        position,
        velocity,
        ..Body::default()
    }
}

fn spring_to_origin(stiffness: f64, damping: f64) -> Force {
    Force::Anchor {
        body: 0,
        point: None,
        anchor: DVec3::ZERO,
        rest_length: 0.0,
        stiffness,
        damping,
    }
}

/// Steps until one fails.
fn failure(world: &mut World, steps: u64) -> Option<StepError> {
    (0..steps).find_map(|_| world.step().err())
}

// Case 1: ballistic flight.

#[test]
fn a_throw_lands_where_each_method_says() {
    for method in METHODS {
        for rate in [5.0, 30.0, 60.0, 240.0] {
            let dt = 1.0 / rate;
            let stone = Body {
                force: -DVec3::Y,
                ..point(DVec3::new(-4.0, 0.0, 0.0), DVec3::new(2.0, 2.0, 0.0))
            };
            let by_constant = world(method, dt, slice::from_ref(&stone), &[]);
            let weightless = Body {
                force: DVec3::ZERO,
                ..stone.clone()
            };
            let gravity = Force::Gravity {
                acceleration: -DVec3::Y,
            };
            let by_weight = world(method, dt, &[weightless], &[gravity]);
            // A force of no effect sends the body through the method's own step.
            let no_drag = Force::LinearDrag {
                body: None,
                coefficient: 0.0,
            };
            let by_method = world(method, dt, &[stone], &[no_drag]);
            for mut world in [by_constant, by_weight, by_method] {
                step(&mut world, (4.0 * rate) as u64);
                let height = match method.name {
                    "forward-euler" => 2.0 * dt,
                    "backward-euler" | "symplectic-euler" => -2.0 * dt,
                    _ => 0.0,
                };
                let at = world.position(0);
                let error = (at - DVec3::new(4.0, height, 0.0)).length();
                assert!(error < 1e-13 * rate, "{} {rate}: {error}", method.name);
            }
        }
    }
}

// Case 2: order, in a world with drag.

#[test]
fn worlds_converge_with_the_order_of_their_method() {
    for method in METHODS.into_iter().filter(|method| !method.adaptive) {
        let error = |steps: u32| {
            let force = Force::QuadraticDrag {
                body: None,
                coefficient: 1.0,
            };
            let body = point(DVec3::ZERO, DVec3::X);
            let mut world = world(method, 2.0 / f64::from(steps), &[body], &[force]);
            step(&mut world, u64::from(steps));
            (world.position(0).x - 3f64.ln()).abs() + (world.velocity(0).x - 1.0 / 3.0).abs()
        };
        let steps = match method.order {
            8 => 12,
            5 => 64,
            4 => 256,
            _ => 1024,
        };
        let order = (error(steps) / error(2 * steps)).log2();
        let claimed = f64::from(method.order);
        assert!((order - claimed).abs() < 0.05, "{}: {order}", method.name);
    }
}

// Case 3: an oscillator over a thousand periods.

#[test]
fn an_oscillator_keeps_to_the_amplitude_of_its_method() {
    let amplitude = |method: &'static Method, dt: f64| {
        let body = point(DVec3::X, DVec3::ZERO);
        let mut world = world(method, dt, &[body], &[spring_to_origin(1.0, 0.0)]);
        let steps = (2000.0 * PI / dt).round() as u64;
        step(&mut world, steps);
        (world.position(0).x.hypot(world.velocity(0).x), steps as f64)
    };
    let dt = 1.0 / 60.0;
    let (found, n) = amplitude(method("forward-euler"), dt);
    let exact = (0.5 * n * (dt * dt).ln_1p()).exp();
    assert!((found / exact - 1.0).abs() < 1e-10, "{found} {exact}");
    for dt in [1.0 / 60.0, 0.1] {
        let (found, n) = amplitude(method("backward-euler"), dt);
        let exact = (-0.5 * n * (dt * dt).ln_1p()).exp();
        assert!((found / exact - 1.0).abs() < 1e-10, "{found} {exact}");
    }
    let dt: f64 = 0.2;
    let (found, n) = amplitude(method("rk4"), dt);
    let exact = (0.5 * n * (-dt.powi(6) / 72.0 + dt.powi(8) / 576.0).ln_1p()).exp();
    assert!((found / exact - 1.0).abs() < 1e-10, "{found} {exact}");
    assert!((found - 0.98620).abs() < 1e-5);
}

#[test]
fn symplectic_euler_keeps_its_own_energy_exactly() {
    let dt = 1.0 / 60.0;
    let body = point(DVec3::X, DVec3::ZERO);
    let mut world = world(
        method("symplectic-euler"),
        dt,
        &[body],
        &[spring_to_origin(1.0, 0.0)],
    );
    let energy = |world: &World| {
        let (q, p) = (world.position(0).x, world.velocity(0).x);
        0.5 * (p * p + q * q - dt * p * q)
    };
    let start = energy(&world);
    for _ in 0..376_991 {
        step(&mut world, 1);
        assert!((energy(&world) / start - 1.0).abs() < 1e-12);
    }
}

#[test]
fn order_eight_stays_with_an_oscillator_for_a_thousand_periods() {
    let body = point(DVec3::X, DVec3::ZERO);
    let mut world = world(
        method("symplectic-8"),
        0.2,
        &[body],
        &[spring_to_origin(1.0, 0.0)],
    );
    step(&mut world, 31_416);
    let t = world.time();
    let (x, v) = (world.position(0).x, world.velocity(0).x);
    let amplitude = (x.hypot(v) - 1.0).abs();
    let error = (x - t.cos()).abs().max((v + t.sin()).abs());
    println!(
        "symplectic-8, 1000 periods at dt = 0.2: amplitude {amplitude:.1e}, error {error:.1e}"
    );
    assert!(amplitude < 1e-12 && error < 1e-7);
}

// Case 4: a stiff damped spring, and what the world says when it blows up.

const STIFF: (f64, f64) = (1e6, 1e3);

fn stiff(method: &'static Method, dt: f64) -> World {
    let weight = Force::Gravity {
        acceleration: -9.81 * DVec3::X,
    };
    let spring = spring_to_origin(STIFF.0, STIFF.1);
    world(
        method,
        dt,
        &[point(DVec3::X, DVec3::ZERO)],
        &[spring, weight],
    )
}

#[test]
fn implicit_methods_find_the_rest_of_a_stiff_spring_at_sixty_hertz() {
    for name in ["backward-euler", "radau5"] {
        let mut world = stiff(method(name), 1.0 / 60.0);
        step(&mut world, 600);
        let x = world.position(0).x;
        assert!((x / -9.81e-6 - 1.0).abs() < 1e-12, "{name}: {x}");
    }
    // Without damping at infinity the midpoint rule is slower.
    let mut world = stiff(method("implicit-midpoint"), 1.0 / 60.0);
    step(&mut world, 600);
    assert!((world.position(0).x + 9.81e-6).abs() < 1.0);
}

#[test]
fn a_stiff_spring_is_bounded_below_the_limit_and_reported_above_it() {
    for (name, limit) in [
        ("forward-euler", 1e-3),
        ("symplectic-euler", (5f64.sqrt() - 1.0) * 1e-3),
        ("rk4", 2.6225e-3),
        ("velocity-verlet", 2e-3),
    ] {
        let mut below = stiff(method(name), 0.99 * limit);
        assert_eq!(failure(&mut below, 20_000), None, "{name}");
        assert!(below.position(0).x.abs() < 1.0, "{name}");
        let mut above = stiff(method(name), 1.01 * limit);
        let before = |world: &World| (world.position(0), world.velocity(0), world.steps());
        let mut last = before(&above);
        let error = loop {
            match above.step() {
                Ok(()) => last = before(&above),
                Err(error) => break error,
            }
            assert!(above.steps() < 20_000, "{name} goes on");
        };
        let StepError::Unstable {
            body,
            step,
            method: title,
            stable_dt,
        } = error
        else {
            panic!("{name}: {error}");
        };
        assert_eq!((body, step, title), (0, last.2 + 1, method(name).title));
        assert!(
            (stable_dt / limit - 1.0).abs() < 1e-3,
            "{name}: {stable_dt}"
        );
        assert_eq!(before(&above), last, "{name} changed the world");
        let said = error.to_string();
        assert!(said.contains("body 0") && said.contains(title), "{said}");
    }
}

#[test]
fn at_sixty_hertz_explicit_methods_say_so_within_a_few_steps() {
    for name in [
        "forward-euler",
        "symplectic-euler",
        "rk4",
        "velocity-verlet",
    ] {
        let mut world = stiff(method(name), 1.0 / 60.0);
        let error = failure(&mut world, 50).expect("it blows up");
        println!("{error}");
        assert!(
            matches!(error, StepError::Unstable { .. }),
            "{name}: {error}"
        );
        assert!(world.steps() < 12, "{name}: {}", world.steps());
    }
}

/// A ball of 1 kg under quadratic drag, with a speed and a constant force along x.
fn dragged(method: &'static Method, dt: f64, speed: f64, force: f64) -> World {
    let drag = Force::QuadraticDrag {
        body: None,
        coefficient: 2.0,
    };
    let ball = Body {
        force: force * DVec3::X,
        ..point(DVec3::ZERO, speed * DVec3::X)
    };
    world(method, dt, &[ball], &[drag])
}

/// The stable step that an error names.
fn named(error: &StepError) -> Option<f64> {
    match *error {
        StepError::Unstable { stable_dt, .. } => Some(stable_dt),
        StepError::OutOfRange { stable_dt, .. } => stable_dt,
        _ => None,
    }
}

#[test]
fn a_blow_up_names_the_step_for_the_motion_before_it() {
    for (name, stable) in [
        ("forward-euler", 2.0),
        ("symplectic-euler", 2.0),
        ("rk4", 2.785_293_563_4),
    ] {
        // The rate of decay of a disturbance is 2 c |v| / m.
        let limit = stable / (2.0 * 2.0 * 900.0);
        for dt in [0.02, 1.0, 10.0 * limit] {
            let error = failure(&mut dragged(method(name), dt, 900.0, 0.0), 60);
            let error = error.unwrap_or_else(|| panic!("{name} goes on at {dt} s"));
            let said = named(&error).unwrap_or_else(|| panic!("{error}"));
            assert!((said / limit - 1.0).abs() < 1e-6, "{name}, {dt} s: {error}");
        }
        // From rest it gets stiff on its way: at a speed of 10 m/s, where drag holds the force.
        let limit = stable / (2.0 * 2.0 * 10.0);
        for dt in [1.05 * limit, 2.0 * limit, 20.0 * limit] {
            let mut world = dragged(method(name), dt, 0.0, 200.0);
            let Some(error) = failure(&mut world, 10_000) else {
                // It may go round a place of rest that it cannot reach.
                assert!(dt < 4.0 * limit, "{name} goes on at {dt} s");
                continue;
            };
            let said = named(&error).unwrap_or_else(|| panic!("{error}"));
            println!(
                "{name}, {:.2} of its limit: {:.3} of it is named",
                dt / limit,
                said / limit
            );
            assert!(said < dt && (0.9..1.1).contains(&(said / limit)), "{error}");
        }
    }
}

type Start = fn(&'static Method, f64) -> World;

/// Scenes that blow up where `dt` is too long.
const BLOW_UPS: [(&str, Start); 6] = [
    ("drag", |method, dt| dragged(method, dt, 900.0, 0.0)),
    ("drag from rest", |method, dt| {
        dragged(method, dt, 0.0, 200.0)
    }),
    ("damped anchor", stiff),
    ("anchor", |method, dt| {
        let bodies = [point(DVec3::X, DVec3::ZERO)];
        world(method, dt, &bodies, &[spring_to_origin(1e6, 0.0)])
    }),
    ("spring", |method, dt| {
        let heavy = Body {
            mass: 50.0,
            ..point(DVec3::new(1.1, 0.2, 0.0), DVec3::ZERO)
        };
        let spring = Force::Spring {
            bodies: [0, 1],
            points: None,
            rest_length: 1.0,
            stiffness: 4e5,
            damping: 100.0,
        };
        world(
            method,
            dt,
            &[point(DVec3::ZERO, DVec3::Y), heavy],
            &[spring],
        )
    }),
    // The one that blows up is neither the first nor, at first, the fastest.
    ("a slow one among others", |method, dt| {
        let bodies = [
            point(DVec3::ZERO, 100.0 * DVec3::Z),
            point(1e-3 * DVec3::X, DVec3::ZERO),
            point(DVec3::Y, DVec3::Z),
        ];
        let anchor = Force::Anchor {
            body: 1,
            point: None,
            anchor: DVec3::ZERO,
            rest_length: 0.0,
            stiffness: 1e6,
            damping: 300.0,
        };
        let drag = Force::QuadraticDrag {
            body: Some(0),
            coefficient: 1e-3,
        };
        world(method, dt, &bodies, &[anchor, drag])
    }),
];

#[test]
fn with_the_step_that_a_blow_up_names_the_same_run_does_not_blow_up() {
    let mut reported = 0;
    for (scene, start) in BLOW_UPS {
        // Those with error control have no limit.
        for method in METHODS.into_iter().filter(|method| !method.adaptive) {
            let place = |dt: f64| format!("{scene}, {}, {dt:.3e} s", method.name);
            for dt in [5e-3, 1.0 / 60.0, 0.3] {
                let Some(error) = failure(&mut start(method, dt), 500) else {
                    continue;
                };
                let Some(said) = named(&error).filter(|&said| said > 0.0) else {
                    // Unstable at every step, or no motion that an implicit method could find.
                    let is_known = matches!(error, StepError::NotConverged { .. })
                        || method.stable_dt(1e6, 0.0) == 0.0;
                    assert!(is_known, "{}: {error}", place(dt));
                    continue;
                };
                reported += 1;
                assert!(said < dt, "{}: {error}", place(dt));
                let mut world = start(method, 0.9 * said);
                let again = failure(&mut world, 5000);
                assert_eq!(again, None, "{}: {error}", place(dt));
                let fastest = (0..world.len()).map(|i| world.velocity(i).length());
                let fastest = fastest.fold(0.0, f64::max);
                assert!(fastest <= 5000.0, "{}: {fastest} m/s", place(dt));
            }
        }
    }
    println!("{reported} blow-ups named a step");
    assert!(reported >= 50, "{reported}");
}

// Case 5: stiff linear, y' = A y as velocities under a matrix of drag.

#[derive(Debug)]
struct MatrixDrag(DMat3);

impl BodyLaw for MatrixDrag {
    fn force(&self, at: &BodyMotion) -> DVec3 {
        self.0 * at.velocity
    }

    fn jacobians(&self, _: &BodyMotion) -> Jacobians {
        Jacobians {
            position: DMat3::ZERO,
            velocity: self.0,
        }
    }
}

#[test]
fn backward_euler_is_exact_for_its_own_solution_of_a_stiff_linear_system() {
    // Eigenvalues -1 along (1, 1) and -1e6 along (1, -1).
    let (slow, fast) = (-1.0, -1e6);
    let (same, other) = (0.5 * (slow + fast), 0.5 * (slow - fast));
    let matrix = DMat3::from_cols(
        DVec3::new(same, other, 0.0),
        DVec3::new(other, same, 0.0),
        DVec3::ZERO,
    );
    for steps in [10, 100, 1000] {
        let dt = 1.0 / f64::from(steps);
        let force = Force::Body {
            body: None,
            law: Law::new(MatrixDrag(matrix)),
        };
        let body = point(DVec3::ZERO, 2.0 * DVec3::X);
        let mut world = world(method("backward-euler"), dt, &[body], &[force]);
        step(&mut world, u64::from(steps as u32));
        let exact = (1.0 + dt).powi(-steps);
        let v = world.velocity(0);
        let error = (v.x - exact).abs().max((v.y - exact).abs());
        assert!(error < 1e-12, "{steps}: {error}");
    }
    let force = Force::Body {
        body: None,
        law: Law::new(MatrixDrag(matrix)),
    };
    let mut world = world(
        method("radau5"),
        0.01,
        &[point(DVec3::ZERO, 2.0 * DVec3::X)],
        &[force],
    );
    step(&mut world, 100);
    let e = (-1f64).exp();
    assert!(
        (world.velocity(0).x - e).abs() < 1e-9,
        "{}",
        world.velocity(0)
    );
}

// Case 6: Kepler's ellipse, a hundred times round.

fn kepler_world(method: &'static Method, e: f64, steps_an_orbit: u32) -> World {
    let start = kepler::start(e);
    let body = point(start[0] * DVec3::X, start[3] * DVec3::Y);
    let sun = Force::Attraction {
        body: None,
        centre: DVec3::ZERO,
        strength: 1.0,
    };
    world(
        method,
        2.0 * PI / f64::from(steps_an_orbit),
        &[body],
        &[sun],
    )
}

#[test]
fn energy_after_a_hundred_orbits_is_what_is_known_of_each_method() {
    for (name, known) in [
        ("symplectic-euler", 3.4e-3),
        ("velocity-verlet", 1e-4),
        ("rk4", 1.1e-7),
        ("symplectic-8", 3e-13),
        ("dop853", 3e-11),
    ] {
        let mut world = kepler_world(method(name), 0.6, 1000);
        let energy = |world: &World| world.kinetic_energy() + world.potential_energy();
        let start = energy(&world);
        step(&mut world, 100_000);
        let error = (energy(&world) - start).abs();
        println!("{name}: {error:.2e}");
        assert!(error < 1.3 * known, "{name}: {error}");
    }
}

#[test]
fn adaptive_worlds_come_back_after_a_hundred_orbits() {
    for (e, bar) in [(0.6, 1e-7), (0.9, 1e-6)] {
        for name in ["dop853", "dopri5"] {
            let mut world = kepler_world(method(name), e, 20);
            let start = world.position(0);
            step(&mut world, 2000);
            let error = (world.position(0) - start).length();
            println!("{name}, e = {e}: {error:.1e} after 100 orbits");
            assert!(error < bar, "{name} {e}: {error}");
        }
    }
}

// Case 7: Pleiades.

fn pleiades_world(method: &'static Method, dt: f64) -> World {
    let s = pleiades::START;
    let bodies: Vec<Body> = (0..7)
        .map(|i| Body {
            mass: (i + 1) as f64,
            ..point(
                DVec3::new(s[i], s[7 + i], 0.0),
                DVec3::new(s[14 + i], s[21 + i], 0.0),
            )
        })
        .collect();
    world(method, dt, &bodies, &[Force::Gravitation { constant: 1.0 }])
}

#[test]
fn the_pleiades_end_where_the_book_says() {
    let slope =
        |_: f64, y: &[f64; pleiades::N], dy: &mut [f64; pleiades::N]| pleiades::slope(y, dy);
    let mut solver = Dop853::new(slope, 0.0, pleiades::START, Tolerance::of(1e-15));
    solver.advance(3.0).expect("a solution");
    let reference = *solver.state();
    let off = |at: &dyn Fn(usize) -> f64| {
        let errors = (0..14).map(|i| (at(i) - reference[i]).abs());
        errors.fold(0.0, f64::max)
    };
    let book = off(&|i| pleiades::END[i]);
    assert!(book < 1e-10, "{book}");
    let mut solver = Dop853::new(slope, 0.0, pleiades::START, Tolerance::of(1e-13));
    solver.advance(3.0).expect("a solution");
    let solved = off(&|i| solver.state()[i]);
    let mut world = pleiades_world(method("dop853"), 0.05);
    step(&mut world, 60);
    let stepped = off(&|i| {
        let at = world.position(i % 7);
        if i < 7 { at.x } else { at.y }
    });
    println!("Pleiades at 1e-13: solver {solved:.1e}, world {stepped:.1e}; book {book:.1e}");
    assert!(solved < 1e-10 && stepped < 1e-9);
}

// Case 28: bad input.

#[test]
fn forces_out_of_range_are_refused_by_field_and_disturb_nothing() {
    let mut world = stiff(method("backward-euler"), 1.0 / 60.0);
    let before = world.forces().to_vec();
    for bad in [f64::NAN, f64::INFINITY, -1.0, 1e101] {
        let anchor = |anchor, rest_length, stiffness, damping| Force::Anchor {
            body: 0,
            point: None,
            anchor,
            rest_length,
            stiffness,
            damping,
        };
        let forces = [
            ("stiffness", anchor(DVec3::ZERO, 0.0, bad, 0.0)),
            ("damping", anchor(DVec3::ZERO, 0.0, 1.0, bad)),
            ("rest_length", anchor(DVec3::ZERO, bad, 1.0, 0.0)),
            ("anchor", anchor((bad * 1e101) * DVec3::Y, 0.0, 1.0, 0.0)),
            (
                "coefficient",
                Force::LinearDrag {
                    body: None,
                    coefficient: bad,
                },
            ),
            (
                "coefficient",
                Force::QuadraticDrag {
                    body: Some(0),
                    coefficient: bad,
                },
            ),
            (
                "strength",
                Force::Attraction {
                    body: None,
                    centre: DVec3::ZERO,
                    strength: bad,
                },
            ),
            ("constant", Force::Gravitation { constant: bad }),
            (
                "acceleration",
                Force::Gravity {
                    acceleration: (bad * 1e101) * DVec3::Z,
                },
            ),
        ];
        for (field, force) in forces {
            for refused in [
                world.add_force(force.clone()).map(|_| ()),
                world.replace_force(0, force.clone()),
            ] {
                let Err(WorldError::Force { error, .. }) = refused else {
                    panic!("{field} {bad} is taken");
                };
                assert_eq!(error.field(), field);
            }
        }
    }
    let spring = |i, j| Force::Spring {
        bodies: [i, j],
        points: None,
        rest_length: 0.0,
        stiffness: 1.0,
        damping: 0.0,
    };
    assert!(matches!(
        world.add_force(spring(0, 1)),
        Err(WorldError::NoBody { body: 1, bodies: 1 })
    ));
    assert!(matches!(
        world.add_force(spring(0, 0)),
        Err(WorldError::Force { .. })
    ));
    assert!(matches!(
        world.remove_force(2),
        Err(WorldError::NoForce {
            index: 2,
            forces: 2
        })
    ));
    for tolerance in [0.0, -1.0, f64::NAN, 2.0] {
        let settings = Settings {
            tolerance,
            ..*world.settings()
        };
        assert!(world.set_settings(settings).is_err());
    }
    assert_eq!(world.forces(), before);
    step(&mut world, 1);
}

#[test]
fn a_body_at_the_centre_of_attraction_is_an_error_and_not_a_number() {
    for method in METHODS {
        let mut world = kepler_world(method, 0.6, 100);
        world.set_position(0, DVec3::ZERO).expect("a position");
        let velocity = world.velocity(0);
        // Some methods look at no force where the step begins.
        match world.step() {
            Ok(()) => assert!(world.position(0).is_finite() && world.velocity(0).is_finite()),
            Err(error) => {
                assert_eq!(error.body(), 0);
                let after = (world.position(0), world.velocity(0));
                assert_eq!(after, (DVec3::ZERO, velocity));
            }
        }
    }
}

// Every method on every force.

/// Forces of all kinds on two bodies, each with a potential or a damping.
fn every_force() -> Vec<(&'static str, Force)> {
    #[derive(Debug)]
    struct Cubic;
    impl BodyLaw for Cubic {
        fn force(&self, at: &BodyMotion) -> DVec3 {
            -at.position * at.position.length_squared()
        }
    }
    #[derive(Debug)]
    struct Repulsion;
    impl PairLaw for Repulsion {
        fn force(&self, at: &PairMotion) -> DVec3 {
            -at.position / at.position.length_squared() - 0.1 * at.time.sin() * at.velocity
        }
    }
    vec![
        (
            "gravity",
            Force::Gravity {
                acceleration: DVec3::new(0.0, -9.81, 1.0),
            },
        ),
        (
            "linear drag",
            Force::LinearDrag {
                body: None,
                coefficient: 0.7,
            },
        ),
        (
            "quadratic drag",
            Force::QuadraticDrag {
                body: Some(1),
                coefficient: 0.4,
            },
        ),
        (
            "anchor",
            Force::Anchor {
                body: 1,
                point: None,
                anchor: DVec3::new(0.0, 1.0, 0.0),
                rest_length: 0.5,
                stiffness: 9.0,
                damping: 0.3,
            },
        ),
        (
            "spring",
            Force::Spring {
                bodies: [1, 0],
                points: None,
                rest_length: 0.8,
                stiffness: 9.0,
                damping: 0.3,
            },
        ),
        (
            "attraction",
            Force::Attraction {
                body: None,
                centre: DVec3::new(0.0, 0.0, -2.0),
                strength: 3.0,
            },
        ),
        ("gravitation", Force::Gravitation { constant: 2.0 }),
        (
            "body law",
            Force::Body {
                body: None,
                law: Law::new(Cubic),
            },
        ),
        (
            "pair law",
            Force::Pair {
                bodies: None,
                law: Law::of_pair(Repulsion),
            },
        ),
    ]
}

fn pair() -> [Body; 2] {
    [
        Body {
            mass: 2.0,
            ..point(DVec3::new(1.0, 0.2, 0.0), DVec3::new(0.0, 0.5, 0.3))
        },
        point(DVec3::new(-0.5, 0.0, 0.4), DVec3::new(0.2, -0.6, 0.0)),
    ]
}

#[test]
fn every_method_solves_every_force() {
    for (name, force) in every_force() {
        let end = |method: &'static Method, steps: u32| {
            let mut world = world(
                method,
                0.5 / f64::from(steps),
                &pair(),
                slice::from_ref(&force),
            );
            step(&mut world, u64::from(steps));
            (0..2)
                .flat_map(|i| [world.position(i), world.velocity(i)])
                .collect::<Vec<_>>()
        };
        let exact = end(method("dop853"), 1);
        for method in METHODS {
            let error = |steps| {
                let off = end(method, steps).into_iter().zip(&exact);
                off.map(|(a, b)| (a - *b).length()).fold(0.0, f64::max)
            };
            if method.adaptive {
                assert!(error(3) < 1e-11, "{} {name}: {}", method.name, error(3));
                continue;
            }
            let (coarse, fine) = (error(64), error(128));
            let order = (coarse / fine).log2();
            let as_claimed = order > f64::from(method.order) - 0.35 || fine < 1e-11;
            assert!(as_claimed, "{} {name}: {coarse:e} {fine:e}", method.name);
        }
    }
}

#[test]
fn forces_between_bodies_keep_momentum_and_forces_with_a_potential_energy() {
    for (name, force) in every_force() {
        let mut world = world(method("dop853"), 0.02, &pair(), slice::from_ref(&force));
        let energy = |world: &World| world.kinetic_energy() + world.potential_energy();
        let (start, momentum) = (energy(&world), world.momentum());
        step(&mut world, 50);
        if matches!(name, "spring" | "gravitation" | "pair law") {
            assert!((world.momentum() - momentum).length() < 1e-13, "{name}");
        }
        let change = energy(&world) - start;
        match name {
            "gravity" | "attraction" | "gravitation" => assert!(change.abs() < 1e-10, "{name}"),
            "linear drag" | "quadratic drag" | "anchor" | "spring" => {
                assert!(change < -1e-4, "{name}: {change}");
            }
            _ => {}
        }
    }
}

#[test]
fn editing_forces_takes_effect_from_the_next_step() {
    let mut world = stiff(method("rk4"), 1e-3);
    step(&mut world, 10);
    world.remove_force(0).expect("a force");
    assert_eq!(world.forces().len(), 1);
    let (x, v) = (world.position(0).x, world.velocity(0).x);
    step(&mut world, 1);
    assert!((world.velocity(0).x - (v - 9.81e-3)).abs() < 1e-13);
    assert!((world.position(0).x - (x + 1e-3 * v - 0.5 * 9.81e-6)).abs() < 1e-13);
    let drag = Force::LinearDrag {
        body: Some(0),
        coefficient: 5.0,
    };
    world.replace_force(0, drag).expect("a force");
    let v = world.velocity(0).x;
    step(&mut world, 1);
    assert!((world.velocity(0).x / v - (-5e-3f64).exp()).abs() < 1e-12);
}

#[test]
fn bodies_without_forces_move_as_if_there_were_none() {
    for method in METHODS {
        let bodies: Vec<Body> = (0..300)
            .map(|i| Body {
                force: -DVec3::Y,
                ..point(
                    f64::from(i) * DVec3::X,
                    DVec3::new(1.0, 0.1 * f64::from(i), 0.0),
                )
            })
            .collect();
        let mut free = world(method, 0.01, &bodies, &[]);
        let spring = Force::Spring {
            bodies: [100, 103],
            points: None,
            rest_length: 1.0,
            stiffness: 5.0,
            damping: 0.1,
        };
        let mut some = world(method, 0.01, &bodies, &[spring]);
        step(&mut free, 20);
        step(&mut some, 20);
        for i in (0..100).chain(104..300) {
            assert_eq!(free.position(i), some.position(i), "{} {i}", method.name);
        }
        assert_ne!(free.position(100), some.position(100));
    }
}

// A chain of stiffly coupled bodies.

fn chain(method: &'static Method, links: usize) -> World {
    let bodies: Vec<Body> = (0..links)
        .map(|i| point(i as f64 * DVec3::X, DVec3::ZERO))
        .collect();
    let mut forces: Vec<Force> = (1..links)
        .map(|i| Force::Spring {
            bodies: [i - 1, i],
            points: None,
            rest_length: 1.0,
            stiffness: 1e5,
            damping: 10.0,
        })
        .collect();
    forces.push(Force::Anchor {
        body: 0,
        point: None,
        anchor: DVec3::ZERO,
        rest_length: 0.0,
        stiffness: 1e5,
        damping: 10.0,
    });
    forces.push(Force::Gravity {
        acceleration: -9.81 * DVec3::Y,
    });
    world(method, 1.0 / 60.0, &bodies, &forces)
}

#[test]
fn a_stiff_chain_of_a_thousand_steps_at_sixty_hertz() {
    for name in ["backward-euler", "implicit-midpoint"] {
        let mut world = chain(method(name), 1000);
        let energy = |world: &World| world.kinetic_energy() + world.potential_energy();
        let start = energy(&world);
        step(&mut world, 60);
        let gain = (energy(&world) - start) / world.kinetic_energy();
        assert!(gain < 1e-3, "{name}: {gain}");
        // The free end falls as if it hung on nothing: news of the anchor has not reached it.
        let end = world.position(999);
        assert!((end.y / (-0.5 * 9.81) - 1.0).abs() < 0.05, "{name}: {end}");
    }
}

// Determinism.

#[test]
fn two_runs_give_the_same_bits() {
    for method in METHODS {
        let forces: Vec<Force> = every_force().into_iter().map(|(_, force)| force).collect();
        let [first, second] = [0, 1].map(|_| {
            let mut world = world(method, 0.01, &pair(), &forces);
            step(&mut world, 30);
            [0, 1].map(|i| (world.position(i), world.velocity(i)))
        });
        assert_eq!(first, second, "{}", method.name);
    }
}
