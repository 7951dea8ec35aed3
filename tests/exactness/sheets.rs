//! Flat sheets face to face, at any tilt, that meet at or near the boundary of a step: they never pass through each
//! other.

use kit::bodies::body;
use kit::random::Random;
use sim_core::{Body, BodyKind, DVec3, Vec3};

use crate::scenes::{judge, step, world};
use crate::shapes::sheet;

/// A corner of a sheet: arbitrary, or with many equal coordinates.
fn corner(random: &mut Random) -> Vec3 {
    match random.below(3) {
        0 => {
            let mut of = || random.whole(-8, 8) as f32 / 16.0;
            Vec3::new(of(), of(), of())
        }
        _ => 0.5 * random.vector().as_vec3(),
    }
}

/// A vector of numbers of any kind.
fn vector(random: &mut Random, size: f64) -> DVec3 {
    match random.below(3) {
        0 => DVec3::ZERO,
        1 => {
            let mut of = || random.whole(-8, 8) as f64 / 8.0 * size;
            DVec3::new(of(), of(), of())
        }
        _ => size * random.vector(),
    }
}

/// Two sheets that approach each other.
struct Pair {
    bodies: [Body; 2],
    /// From the second to the first.
    normal: DVec3,
    /// The closing speed, m/s.
    speed: f64,
    /// The size of the coordinates, m.
    scale: f64,
    scene: String,
}

/// Sheets that meet after a time, up to rounding, and then continue for at least half a step.
fn pair(random: &mut Random, hit: f64, dt: f64) -> Option<Pair> {
    let (p, q) = (corner(random), corner(random));
    let normal = p.as_dvec3().cross(q.as_dvec3());
    if normal.length() < 0.02 {
        return None;
    }
    let normal = normal.normalize();
    let upper = sheet(p, q);
    let by = random.pick(&[1.0, 1.0, 1.0, 2.0, 0.5]);
    let lower = sheet(by * p, by * q);
    let speed = random.pick(&[1.0, 0.5, 3.0, 0.01]) * random.from(0.5, 1.5);
    let masses = match random.below(3) {
        0 => [1.0, 1.0],
        1 => [1.0, f64::INFINITY],
        _ => [1.0, random.from(0.2, 5.0)],
    };
    let common = match masses[1].is_finite() {
        true => vector(random, 1.0),
        false => DVec3::ZERO,
    };
    // The distance from the origin, m.
    let size = random.pick(&[0.25, 1.0, 10.0, 1000.0]);
    let far = vector(random, size);
    // From the middle to the nearest side.
    let (sides, area) = ([p - q, p + q], p.as_dvec3().cross(q.as_dvec3()).length());
    let least = area / f64::from(sides[0].length().max(sides[1].length()));
    // The lateral displacement is so small that they overlap when they meet, and for as long after.
    let aside = 0.25 * least / (2.0 * hit + 3.0 * dt) * random.vector();
    let relative = aside.reject_from(normal) - speed * normal;
    // Corner exactly on corner, or not.
    let shift = match random.one_in(4) {
        true => DVec3::ZERO,
        false => (0.25 * least * random.vector()).reject_from(normal),
    };
    let place = far - hit * relative + shift;
    let first = Body {
        mass: masses[0],
        ..body(&upper, place, common + relative)
    };
    let second = Body {
        mass: if masses[1].is_finite() {
            masses[1]
        } else {
            1.0
        },
        kind: match masses[1].is_finite() {
            true => BodyKind::Dynamic,
            false => BodyKind::Kinematic,
        },
        ..body(&lower, far, common)
    };
    let scene = format!("{p} {q} by {by}, {place} {far}, {relative} + {common}, masses {masses:?}");
    Some(Pair {
        bodies: [first, second],
        normal,
        speed,
        scale: far.length() + place.length() + (common.length() + speed) * 2.0 * (hit + dt) + 1.0,
        scene,
    })
}

/// A time at the end of a step up to rounding, or near it, or anywhere.
fn hit(random: &mut Random, dt: f64) -> f64 {
    let steps = random.whole(1, 5) as f64;
    let by = match random.below(4) {
        0 => 0.0,
        1 => random.whole(-16, 16) as f64 * f64::EPSILON,
        2 => 10f64.powi(-random.whole(9, 15) as i32) * random.from(-1.0, 1.0),
        _ => random.unit() / steps,
    };
    steps * dt * (1.0 + by)
}

/// Some pairs that meet at one time up to rounding, each far away from the others.
fn case(random: &mut Random) -> Option<Result<(), String>> {
    let dt = random.pick(&[1.0 / 16.0, 0.05, 1.0 / 60.0, 1.0]);
    let first_hit = hit(random, dt);
    let count = random.pick(&[1, 1, 2, 3]);
    let mut pairs = Vec::new();
    for k in 0..count {
        let late = random.whole(-8, 8) as f64 * f64::EPSILON;
        let mut pair = pair(random, first_hit * (1.0 + late), dt)?;
        let apart = f64::from(k) * 3000.0 * DVec3::X;
        pair.bodies
            .iter_mut()
            .for_each(|body| body.position += apart);
        pair.scale += apart.length();
        pairs.push(pair);
    }
    let bodies = pairs.iter().flat_map(|pair| pair.bodies.clone());
    let mut world = world(dt, bodies.collect());
    if !world.overlapping().is_empty() {
        return None;
    }
    let mut impacts = 0;
    let verdict = (|| {
        for _ in 0..(first_hit / dt) as u64 + 3 {
            impacts += step(&mut world)?.len();
            for (k, pair) in pairs.iter().enumerate() {
                let between = world.position(2 * k) - world.position(2 * k + 1);
                let height = pair.normal.dot(between);
                let exact = pair.speed * (world.time() - first_hit).abs();
                if (height - exact).abs() > 1e-13 * pair.scale {
                    let time = world.time();
                    return Err(format!(
                        "at {time} s the height of pair {k} is {height}, not {exact}"
                    ));
                }
            }
        }
        for (k, pair) in pairs.iter().enumerate() {
            let parting = world.velocity(2 * k) - world.velocity(2 * k + 1);
            let parting = pair.normal.dot(parting);
            if (parting - pair.speed).abs() > 1e-13 * pair.scale {
                return Err(format!("they part at {parting} m/s, not {}", pair.speed));
            }
        }
        match impacts == pairs.len() {
            true => Ok(()),
            false => Err(format!("{impacts} impacts")),
        }
    })();
    let scenes = || {
        let scenes: Vec<&str> = pairs.iter().map(|pair| pair.scene.as_str()).collect();
        format!(
            "dt {dt}, hit after {} steps, {}",
            first_hit / dt,
            scenes.join("; ")
        )
    };
    Some(verdict.map_err(|what| format!("{what}: {}", scenes())))
}

#[test]
fn sheets_do_not_pass_through_each_other() {
    judge(1000, case);
}
