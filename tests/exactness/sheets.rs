//! Flat sheets face on, at any tilt, that meet on the border of a step or beside it: they never pass
//! through each other.

use sim_core::{Body, DVec3, Shape, Vec3};

use crate::scenes::{Random, body, immovable, judge, step, world};
use crate::shapes::sheet;

/// A corner of a sheet: anywhere, or where many coordinates agree.
fn corner(random: &mut Random) -> Vec3 {
    match random.below(3) {
        0 => {
            let mut of = || random.whole(-8, 8) as f32 / 16.0;
            Vec3::new(of(), of(), of())
        }
        _ => 0.5 * random.vector().as_vec3(),
    }
}

/// A vector of any kind of numbers.
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

fn scaled(shape: &Shape, by: f32) -> Shape {
    match shape {
        Shape::Mesh(mesh) => sheet(by * mesh.vertices()[0], by * mesh.vertices()[1]),
        other => other.clone(),
    }
}

fn case(random: &mut Random) -> Option<Result<(), String>> {
    let (p, q) = (corner(random), corner(random));
    let normal = p.as_dvec3().cross(q.as_dvec3());
    if normal.length() < 0.02 {
        return None;
    }
    let normal = normal.normalize();
    let upper = sheet(p, q);
    let by = random.pick(&[1.0, 1.0, 1.0, 2.0, 0.5]);
    let lower = scaled(&upper, by);
    let dt = random.pick(&[1.0 / 16.0, 0.05, 1.0 / 60.0, 1.0]);
    let hits = random.whole(1, 5) as f64;
    let hit = match random.below(4) {
        // On the border, but for rounding.
        0 => hits * dt,
        1 => hits * dt * (1.0 + random.whole(-16, 16) as f64 * f64::EPSILON),
        2 => hits * dt * (1.0 + 10f64.powi(-random.whole(9, 15) as i32) * random.from(-1.0, 1.0)),
        _ => (hits + random.unit()) * dt,
    };
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
    // From the middle to the nearest side.
    let (sides, area) = ([p - q, p + q], p.as_dvec3().cross(q.as_dvec3()).length());
    let least = area / f64::from(sides[0].length().max(sides[1].length()));
    // So little aside that they overlap when they meet, and for as long after.
    let aside = 0.25 * least / (2.0 * hit + 3.0 * dt) * random.vector();
    let aside = aside.reject_from(normal);
    // How far from the origin, m.
    let size = random.pick(&[0.25, 1.0, 10.0, 1000.0]);
    let far = vector(random, size);
    let relative = aside - speed * normal;
    // Upon each other to the corner, or not.
    let shift = match random.one_in(4) {
        true => DVec3::ZERO,
        false => (0.25 * least * random.vector()).reject_from(normal),
    };
    let place = far - hit * relative + shift;
    let bodies = [
        Body {
            mass: masses[0],
            ..body(&upper, place, common + relative)
        },
        Body {
            mass: masses[1],
            ..body(&lower, far, common)
        },
    ];
    let bodies = match masses[1].is_finite() {
        true => bodies,
        false => {
            let [first, second] = bodies;
            [first, immovable(second)]
        }
    };
    let mut world = world(dt, bodies.to_vec());
    if !world.overlapping().is_empty() {
        return None;
    }
    let scale = far.length() + place.length() + (common.length() + speed) * 2.0 * (hit + dt) + 1.0;
    let verdict = (|| {
        let mut impacts = 0;
        let count = (hit / dt) as u64 + 3;
        for _ in 0..count {
            impacts += step(&mut world)?.len();
            let height = normal.dot(world.position(0) - world.position(1));
            let exact = speed * (world.time() - hit).abs();
            let off = (height - exact).abs();
            if off > 1e-13 * scale {
                let time = world.time();
                return Err(format!("at {time} s the height is {height}, not {exact}"));
            }
        }
        let parting = normal.dot(world.velocity(0) - world.velocity(1));
        if (parting - speed).abs() > 1e-13 * scale {
            return Err(format!("they part at {parting} m/s, not {speed}"));
        }
        match impacts {
            1 => Ok(()),
            _ => Err(format!("{impacts} impacts")),
        }
    })();
    let scene = || {
        let hit = hit / dt;
        format!(
            "{p} {q} by {by}, {place} {far}, {relative} + {common}, masses {masses:?}, dt {dt}, hit {hit}"
        )
    };
    Some(verdict.map_err(|what| format!("{what}: {}", scene())))
}

#[test]
fn sheets_do_not_pass_through_each_other() {
    judge(1000, case);
}
