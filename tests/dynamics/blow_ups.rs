//! The errors of a world when a step is too long: the body, the step, and the limit of the step length.

use cases::hard_cases::stiff_spring;
use cases::worlds::{named_limit, spring_to_origin};
use sim_core::{Body, DVec3, Force, METHODS, Method, StepError, World};

use crate::worlds::{failure, method, point, world};

/// A spring of 10⁶ N/m with a damper.
fn stiff(method: &'static Method, dt: f64) -> World {
    stiff_spring::world(method, dt).expect("a world")
}

#[test]
fn a_blow_up_names_body_method_and_step_and_leaves_the_world() {
    for (name, limit) in [
        ("forward-euler", 1e-3),
        ("symplectic-euler", (5f64.sqrt() - 1.0) * 1e-3),
        ("rk4", 2.6225e-3),
        ("velocity-verlet", 2e-3),
    ] {
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

#[test]
fn a_blow_up_names_the_step_for_the_motion_before_it() {
    for (name, stable) in [
        ("forward-euler", 2.0),
        ("symplectic-euler", 2.0),
        ("rk4", 2.785_293_563_4),
    ] {
        // The decay rate of a disturbance is 2 c |v| / m.
        let limit = stable / (2.0 * 2.0 * 900.0);
        for dt in [0.02, 1.0, 10.0 * limit] {
            let error = failure(&mut dragged(method(name), dt, 900.0, 0.0), 60);
            let error = error.unwrap_or_else(|| panic!("{name} goes on at {dt} s"));
            let said = named_limit(&error).unwrap_or_else(|| panic!("{error}"));
            assert!((said / limit - 1.0).abs() < 1e-6, "{name}, {dt} s: {error}");
        }
        // From rest the problem becomes stiff: at 10 m/s, where drag balances the force.
        let limit = stable / (2.0 * 2.0 * 10.0);
        for dt in [1.05 * limit, 2.0 * limit, 20.0 * limit] {
            let mut world = dragged(method(name), dt, 0.0, 200.0);
            let Some(error) = failure(&mut world, 10_000) else {
                // It may circle around a position of rest that it cannot reach.
                assert!(dt < 4.0 * limit, "{name} goes on at {dt} s");
                continue;
            };
            let said = named_limit(&error).unwrap_or_else(|| panic!("{error}"));
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

/// Scenes that blow up if `dt` is too long.
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
    // The body that blows up is neither the first nor, initially, the fastest.
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
        // Methods with error control have no limit.
        for method in METHODS.into_iter().filter(|method| !method.adaptive) {
            let place = |dt: f64| format!("{scene}, {}, {dt:.3e} s", method.name);
            for dt in [5e-3, 1.0 / 60.0, 0.3] {
                let Some(error) = failure(&mut start(method, dt), 500) else {
                    continue;
                };
                let Some(said) = named_limit(&error).filter(|&said| said > 0.0) else {
                    // The method is unstable at every step, or there is no motion that an implicit method could find.
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
