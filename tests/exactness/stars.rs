//! Clumps of small stars that attract each other and collide. They pass through no centre, and conserve momentum and,
//! under methods with error control, energy within the tolerance.

use kit::bodies::body;
use kit::random::Random;
use kit::shapes::ball;
use kit::worlds::world_of;
use sim_core::{Body, DVec3, Force, METHODS, Method, Settings, World};

use crate::scenes::{judge, step};

/// The factor by which the error tolerances of single steps add up in the energy of many.
const STEPS: f64 = 1e3;

fn total(world: &World) -> f64 {
    world.kinetic_energy() + world.potential_energy()
}

fn case(random: &mut Random) -> Option<Result<(), String>> {
    let adaptive: Vec<&'static Method> = METHODS.into_iter().filter(|m| m.adaptive).collect();
    let method = random.pick(&adaptive);
    let rate = random.pick(&[30.0, 60.0, 240.0, 960.0]);
    let tolerance = random.pick(&[1e-8, 1e-10, 1e-12]);
    let settings = Settings {
        method,
        dt: 1.0 / rate,
        tolerance,
        ..Settings::default()
    };
    let count = random.whole(2, 6);
    let (is_equal, is_flat) = (random.one_in(2), random.one_in(3));
    let size = 10_f64.powf(random.from(-3.0, -0.7));
    let speed = random.pick(&[0.0, 0.0, 0.1, 1.0]);
    let mut stars: Vec<Body> = Vec::new();
    for _ in 0..count {
        let mut of = |least: f64, most: f64| match is_equal {
            true => 1.0,
            false => 10_f64.powf(random.from(least, most)),
        };
        let (radius, mass) = (size * of(-1.0, 0.0), of(-1.0, 1.0));
        let mut place = match random.one_in(4) {
            true => DVec3::new(random.whole(-2, 2) as f64, random.whole(-2, 2) as f64, 0.0) * 0.5,
            false => random.vector(),
        };
        let mut velocity = speed * random.vector();
        if is_flat {
            (place.z, velocity.z) = (0.0, 0.0);
        }
        let star = body(&ball(radius), place, velocity);
        stars.push(Body { mass, ..star });
    }
    let mut world = world_of(settings, &stars);
    if !world.overlapping().is_empty() {
        return None;
    }
    let force = Force::Gravitation { constant: 1.0 };
    world.add_force(force).expect("a force");
    let (energy, momentum) = (total(&world), world.momentum());
    // The greatest kinetic energy and momenta so far, at impacts too.
    let (mut fastest, mut push) = (energy.abs(), 0.0_f64);
    let verdict = (|| {
        for at in 1..=(2.0 * rate) as u64 {
            let impacts = step(&mut world).map_err(|error| format!("step {at}: {error}"))?;
            fastest = fastest.max(world.kinetic_energy());
            for impact in &impacts {
                let (i, j) = impact.bodies;
                let (m, n) = (world.mass(i), world.mass(j));
                let (reduced, closing) = (m * n / (m + n), impact.speeds.0);
                fastest = fastest.max(0.5 * reduced * closing * closing);
                push = push.max(reduced * closing);
            }
            let momenta = (0..world.len()).map(|i| world.mass(i) * world.velocity(i).length());
            push = push.max(momenta.sum());
            let change = (total(&world) - energy).abs() / fastest;
            if change > STEPS * tolerance {
                return Err(format!("step {at}: energy off by {change:e}"));
            }
            let change = (world.momentum() - momentum).length() / push;
            if change > 1e-11 {
                return Err(format!("step {at}: momentum off by {change:e}"));
            }
        }
        Ok(())
    })();
    let has_met = world.impacts() > 0;
    match verdict {
        Ok(()) if !has_met => None,
        Ok(()) => Some(Ok(())),
        Err(what) => {
            let name = method.name;
            Some(Err(format!(
                "{what}: {name}, {count} stars of {size:.1e} m, {rate} Hz, tolerance {tolerance:e}"
            )))
        }
    }
}

#[test]
fn clumps_of_stars_keep_what_they_have() {
    judge(25, case);
}

/// Two stars at rest 1 m apart, which meet when they touch and separate as they came. A method with a fixed step that
/// finds no motion there reports an error with the bodies and a remedy.
#[test]
fn stars_head_on_part_again_or_the_error_names_both() {
    for radius in [0.1, 1e-3, 1e-6] {
        for method in METHODS {
            let (dt, tolerance) = (1.0 / 240.0, 1e-10);
            let settings = Settings {
                method,
                dt,
                tolerance,
                ..Settings::default()
            };
            let star = |x: f64, mass: f64| Body {
                mass,
                ..body(&ball(radius), x * DVec3::X, DVec3::ZERO)
            };
            let mut world = world_of(settings, &[star(0.0, 4.0), star(1.0, 7.0)]);
            let force = Force::Gravitation { constant: 1.0 };
            world.add_force(force).expect("a force");
            let (start, name) = (total(&world), (method.name, radius));
            let done = (0..200).try_for_each(|_| world.step());
            match done {
                Ok(()) if method.adaptive => {
                    let closing = -28.0 + 28.0 / (2.0 * radius);
                    assert_eq!(world.impacts(), 1, "{name:?}");
                    let off = (total(&world) - start).abs();
                    assert!(off < STEPS * tolerance * closing, "{name:?}: {off:e} J");
                }
                Ok(()) => {}
                Err(error) => {
                    assert!(!method.adaptive, "{name:?}: {error}");
                    let text = error.to_string();
                    assert!(text.contains("body 0 beside body 1"), "{text}");
                    assert!(text.contains(method.title), "{text}");
                    assert!(
                        text.contains("choose a method that controls its error"),
                        "{text}"
                    );
                }
            }
        }
    }
}
