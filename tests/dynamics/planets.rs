//! Planets and stars, over long times and in close encounters.

use std::f64::consts::PI;

use cases::problems::{self, kepler, pleiades};
use cases::solvers::SOLVERS;
use cases::worlds::settings;
use kit::worlds::step;
use sim_core::{DVec3, METHODS, Method, World};

use crate::worlds::method;

fn kepler_world(method: &'static Method, e: f64, steps_an_orbit: u32) -> World {
    let dt = 2.0 * PI / f64::from(steps_an_orbit);
    kepler::world(settings(method, dt), e).expect("a world")
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

/// The digits printed in the book are accurate to about 1e-11.
#[test]
fn the_pleiades_end_where_the_book_says() {
    let problems = problems::all();
    let stars = problems
        .iter()
        .find(|known| known.card().name == "pleiades");
    let dop853 = SOLVERS
        .iter()
        .find(|known| known.name == "sim_core::Dop853");
    let (stars, dop853) = stars.zip(dop853).expect("they are in the tables");
    for tolerance in [1e-13, 1e-15] {
        let end = stars.by_solver(dop853, tolerance).expect("a solution");
        println!("Pleiades at {tolerance:e}: {:.1e}", end.error);
        assert!(end.error < 1e-10, "{tolerance:e}: {end:?}");
    }
    let mut world = pleiades::world(settings(method("dop853"), 0.05)).expect("a world");
    step(&mut world, 60);
    for (i, end) in pleiades::END.into_iter().enumerate() {
        let at = world.position(i % 7);
        let off = (if i < 7 { at.x } else { at.y }) - end;
        assert!(off.abs() < 1e-9, "{i}: {off:e}");
    }
}

#[test]
fn a_body_at_the_centre_of_attraction_is_an_error_and_not_a_number() {
    for method in METHODS {
        let mut world = kepler_world(method, 0.6, 100);
        world.set_position(0, DVec3::ZERO).expect("a position");
        let velocity = world.velocity(0);
        // Some methods do not evaluate forces at the start of the step.
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
