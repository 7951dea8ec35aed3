//! A mesh lies on another one while both fall on a floor: energy does not grow.

use kit::bodies::{body, immovable, wall};
use kit::random::Random;
use kit::worlds::{GRAVITY, add_gravity};
use sim_core::collide::touch::time_of_impact;
use sim_core::collide::tree;
use sim_core::{Body, Bvh, DVec3, Shape, Vec3};

use crate::scenes::{energy, judge, judge_from, step, world};
use crate::shapes::{channel, cube, globe, sheet, tetrahedron};

fn case(random: &mut Random) -> Option<Result<(), String>> {
    let mut shape = || match random.below(5) {
        0 => tetrahedron(0.3),
        1 => channel(0.5),
        2 => globe(4, 0.3),
        3 => globe(6, 0.35),
        _ => cube(0.3),
    };
    let shapes = [shape(), shape()];
    let trees = shapes
        .iter()
        .map(|shape| shape.mesh().map(|mesh| Bvh::build(mesh)));
    let trees: Option<Vec<Bvh>> = trees.collect();
    let trees = trees?;
    // Lowered onto it from above.
    let from = DVec3::new(random.from(-0.3, 0.3), 2.0, random.from(-0.3, 0.3));
    let way = DVec3::Y * -4.0;
    let time = time_of_impact(&trees[0], &trees[1], from, way)?;
    let mut on = from + time * way;
    while tree::intersect(&trees[0], &trees[1], on) {
        on.y += 4.0 * f64::EPSILON;
    }
    let height = random.from(0.36, 0.6);
    let low = DVec3::new(random.from(-1.0, 1.0), height, random.from(-1.0, 1.0));
    let velocity = DVec3::new(random.from(-1.0, 1.0), random.from(-2.0, 0.0), 0.5);
    let restitution = random.pick(&[1.0, 1.0, 0.5, 0.0]);
    let floor = match random.one_in(2) {
        true => wall(DVec3::Y, DVec3::ZERO, DVec3::ZERO),
        false => {
            let floor = sheet(Vec3::new(20.0, 0.0, 20.0), Vec3::new(-20.0, 0.0, 20.0));
            immovable(body(&floor, DVec3::ZERO, DVec3::ZERO))
        }
    };
    let bodies = [
        floor,
        body(&shapes[0], low, velocity),
        Body {
            mass: random.pick(&[1.0, 0.5, 1.43]),
            ..body(&shapes[1], low + on, velocity)
        },
    ];
    let bodies = bodies.map(|body| Body {
        restitution,
        ..body
    });
    let mut world = world(1.0 / 60.0, bodies.to_vec());
    if !world.overlapping().is_empty() {
        return None;
    }
    add_gravity(&mut world, DVec3::Y * -GRAVITY);
    let mut before = energy(&world, GRAVITY);
    let scale = before.abs() + 10.0;
    let verdict = (|| {
        for at in 1..=30 {
            step(&mut world)?;
            let now = energy(&world, GRAVITY);
            if now > before + 1e-10 * scale {
                return Err(format!("step {at}: energy grows by {:e} J", now - before));
            }
            before = now;
        }
        let fallen = (1..3).find(|&i| world.position(i).y < -0.5);
        match fallen {
            Some(body) => Err(format!("body {body} has fallen through the floor")),
            None => Ok(()),
        }
    })();
    let triangles = |shape: &Shape| shape.mesh().map_or(0, |mesh| mesh.triangles().len());
    let counts = shapes.each_ref().map(triangles);
    let scene =
        || format!("{counts:?} triangles, {low} and {on} from it, {velocity}, e {restitution}");
    Some(verdict.map_err(|what| format!("{what}: {}", scene())))
}

#[test]
fn what_lies_on_what_falls_gains_nothing() {
    judge(150, case);
}

/// A body at rest on others transmits an impulse larger than those of its own speed; the step terminates.
#[test]
fn what_is_handed_on_has_an_end() {
    judge_from(2585, 1, case);
}
