//! Impacts under unbounded forces: bodies that collide do not pass through centres and gain no energy.

use kit::bodies::{ball, immovable};
use kit::random::Random;
use kit::worlds::{precise, world_of};
use sim_core::{Body, DVec3, Force, METHODS, Method, Settings, World};

fn settings_of(method: &'static Method, dt: f64) -> Settings {
    Settings {
        method,
        tolerance: 1e-10,
        ..precise(dt)
    }
}

fn adaptive() -> impl Iterator<Item = &'static Method> {
    METHODS.into_iter().filter(|method| method.adaptive)
}

fn energy(world: &World) -> f64 {
    world.kinetic_energy() + world.potential_energy()
}

/// Steps a world that conserves energy. Returns the greatest gain or loss of energy, relative to the greatest kinetic
/// energy so far, at impacts too; or the error.
fn drift(world: &mut World, steps: u32) -> Result<f64, String> {
    let start = energy(world);
    let (mut most, mut fastest) = (0.0_f64, start.abs());
    let mut impacts = Vec::new();
    for _ in 0..steps {
        impacts.clear();
        let done = world.step_reporting(&mut impacts);
        done.map_err(|error| error.to_string())?;
        fastest = fastest.max(world.kinetic_energy());
        for impact in &impacts {
            let (i, j) = impact.bodies;
            let (first, second) = (inverse_mass(world, i), inverse_mass(world, j));
            let speed = impact.speeds.0;
            fastest = fastest.max(0.5 * speed * speed / (first + second));
        }
        most = most.max((energy(world) - start).abs());
    }
    Ok(most / fastest)
}

/// The inverse mass, 1/kg; 0 for an immovable body.
fn inverse_mass(world: &World, body: usize) -> f64 {
    match world.kind(body).is_movable() {
        true => 1.0 / world.mass(body),
        false => 0.0,
    }
}

fn gravitating(method: &'static Method, dt: f64, stars: &[Body]) -> World {
    let mut world = world_of(settings_of(method, dt), stars);
    world
        .add_force(Force::Gravitation { constant: 1.0 })
        .expect("a force");
    world
}

fn star(mass: f64, radius: f64, position: DVec3, velocity: DVec3) -> Body {
    Body {
        mass,
        ..ball(radius, position, velocity)
    }
}

#[test]
fn stars_that_fall_into_each_other_bounce_and_keep_their_energy() {
    for method in adaptive() {
        for radius in [0.1, 1e-3, 1e-6] {
            let stars = [
                star(4.0, radius, DVec3::ZERO, DVec3::ZERO),
                star(7.0, radius, DVec3::X, DVec3::ZERO),
            ];
            let mut world = gravitating(method, 1.0 / 240.0, &stars);
            let drift = drift(&mut world, 260);
            let what = format!("{}, radius {radius}", method.name);
            assert!(
                matches!(drift, Ok(drift) if drift < 1e-8),
                "{what}: {drift:?}"
            );
            assert!(world.impacts() >= 2, "{what}: {}", world.impacts());
        }
    }
}

/// Two stars on parabolic orbits about each other, whose nearest distance is less than the touching distance by a
/// fraction. They touch with a small or large speed along the line of centres, and with a speed a hundred times larger
/// across it. However strongly forces pull them back, they separate as they came.
#[test]
fn stars_that_graze_each_other_part_as_they_came() {
    let (radius, mass) = (1e-3_f64, [4.0_f64, 7.0]);
    let both = mass[0] + mass[1];
    for nearest in [0.99995, 0.995, 0.9, 0.75, 0.5] {
        let nearest = 2.0 * radius * nearest;
        let across = (2.0 * both * nearest).sqrt();
        let along = -(2.0 * both - across * across).sqrt();
        let relative = DVec3::new(along, across, 0.0);
        for method in adaptive() {
            let stars = [
                star(mass[0], radius, DVec3::ZERO, -mass[1] / both * relative),
                star(mass[1], radius, DVec3::X, mass[0] / both * relative),
            ];
            let mut world = gravitating(method, 1.0 / 240.0, &stars);
            let drift = drift(&mut world, 60);
            let what = format!("{}, nearest {nearest}", method.name);
            assert!(
                matches!(drift, Ok(drift) if drift < 1e-8),
                "{what}: {drift:?}"
            );
            assert_eq!(world.impacts(), 1, "{what}");
        }
    }
}

/// A method with a fixed step that finds no motion through the centre is not tested.
#[test]
fn implicit_methods_are_asked_for_no_motion_through_a_star() {
    for name in ["implicit-midpoint"] {
        let method = Method::named(name).expect("a method");
        let stars = [
            star(4.0, 1e-3, DVec3::ZERO, DVec3::ZERO),
            star(7.0, 1e-3, DVec3::X, DVec3::ZERO),
        ];
        let mut world = gravitating(method, 1.0 / 240.0, &stars);
        while world.impacts() == 0 {
            world
                .step()
                .unwrap_or_else(|error| panic!("{name}: {error}"));
        }
        assert!(
            world.steps() > 70 && world.steps() < 90,
            "{name}: {}",
            world.steps()
        );
    }
}

#[test]
fn pairs_of_stars_keep_their_energy_through_many_impacts() {
    let mut random = Random::linear(7);
    let mut impacts = 0;
    for case in 0..16 {
        let radius = 10_f64.powf(-1.0 - 3.0 * random.unit());
        let mut vector = || random.vector();
        let (away, velocity) = (vector().normalize(), vector());
        // The second body passes the first, if at all, at about its radius.
        let velocity = 0.5 * velocity.normalize() * radius.sqrt();
        let (first, second) = (1.0 + random.unit(), 1.0 + random.unit());
        let stars = [
            star(first, radius, DVec3::ZERO, DVec3::ZERO),
            star(second, radius, 0.5 * away, velocity),
        ];
        for method in adaptive() {
            let mut world = gravitating(method, 1.0 / 60.0, &stars);
            let drift = drift(&mut world, 120);
            let what = format!("case {case}, {}, radius {radius:e}", method.name);
            assert!(
                matches!(drift, Ok(drift) if drift < 1e-7),
                "{what}: {drift:?}"
            );
            impacts += world.impacts();
        }
    }
    assert!(impacts > 40, "{impacts}");
}

/// A fixed centre of attraction within a ball, hit from any side.
#[test]
fn what_falls_onto_a_ball_about_a_centre_bounces_off_it() {
    let mut random = Random::linear(5);
    for method in adaptive() {
        for _ in 0..6 {
            let radius = 10_f64.powf(-1.0 - 4.0 * random.unit());
            let from = DVec3::from_array([0; 3].map(|_| random.unit() + 0.2));
            let bodies = [
                immovable(ball(radius, DVec3::ZERO, DVec3::ZERO)),
                ball(0.1 * radius, from, DVec3::ZERO),
            ];
            let mut world = world_of(settings_of(method, 1.0 / 60.0), &bodies);
            let force = Force::Attraction {
                body: Some(1),
                centre: DVec3::ZERO,
                strength: 5.0,
            };
            world.add_force(force).expect("a force");
            let drift = drift(&mut world, 240);
            let what = format!("{}, radius {radius:e}, from {from}", method.name);
            assert!(
                matches!(drift, Ok(drift) if drift < 1e-7),
                "{what}: {drift:?}"
            );
            assert!(world.impacts() >= 1, "{what}");
        }
    }
}
