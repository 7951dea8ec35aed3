//! Points in closed meshes: they bounce, slide and rest, and none escapes.

use kit::bodies::{body, immovable};
use kit::random::Random;
use kit::shapes::cow;
use kit::worlds::add_gravity;
use sim_core::{Body, DVec3, Shape, collide::Place, collide::locate};

use crate::scenes::{judge, judge_from, world};
use crate::shapes::{cube, globe, tetrahedron};

/// The number of points in a room. Each collides only with its walls.
const POINTS: usize = 25;

fn case(random: &mut Random) -> Option<Result<(), String>> {
    let room = match random.below(5) {
        0 => cube(1.0),
        1 => tetrahedron(1.5),
        2 => globe(3, 1.0),
        3 => globe(12, 1.0),
        _ => cow(),
    };
    let friction = random.pick(&[0.0, 0.0, 0.3]);
    let restitution = random.pick(&[0.0, 0.5, 0.9, 1.0]);
    let place = match random.one_in(2) {
        true => DVec3::ZERO,
        false => random.vector(),
    };
    let radius = random.pick(&[0.0, 0.0, 1e-9]);
    let weight = random.pick(&[0.0, 1.0, 9.81]);
    let dt = random.pick(&[1.0 / 60.0, 1.0 / 30.0, 1.0 / 600.0]);
    let mut world = world(dt, vec![]);
    let wall = Body {
        friction,
        restitution,
        ..immovable(body(&room, place, DVec3::ZERO))
    };
    world.add(wall).expect("a room");
    world.build_bvhs();
    let size = {
        let mesh = room.mesh().expect("a mesh");
        mesh.bounds().half_extent().max_element()
    };
    let middle = room.mesh().expect("a mesh").bounds().centre();
    let inside = |world: &sim_core::World, at: DVec3| {
        let bvh = world.bvh(0).expect("built");
        locate(bvh, at - place)
    };
    let mut points = 0;
    for _ in 0..40 * POINTS {
        let at = place + middle + size * random.vector();
        if inside(&world, at) != Some(Place::Inside) {
            continue;
        }
        let velocity = random.pick(&[0.0, 1.0, 30.0]) * random.vector();
        let point = Body {
            friction,
            restitution,
            ..body(&Shape::Sphere { radius }, at, velocity)
        };
        if points == POINTS {
            break;
        }
        world.add(point).expect("a point");
        points += 1;
    }
    if points == 0 || !world.overlapping().is_empty() {
        return None;
    }
    let acceleration = weight * random.vector();
    add_gravity(&mut world, acceleration);
    let verdict = (|| {
        for at in 1..=60 {
            world
                .step()
                .map_err(|error| format!("step {at}: {error}"))?;
            for i in 1..world.len() {
                if inside(&world, world.position(i)) != Some(Place::Inside) {
                    return Err(format!("step {at}: point {i} is out"));
                }
            }
        }
        Ok(())
    })();
    let triangles = room.mesh().map_or(0, |mesh| mesh.triangles().len());
    Some(verdict.map_err(|what| {
        format!("{what}: {triangles} triangles, radius {radius}, e {restitution}, friction {friction}, weight {acceleration}, dt {dt}")
    }))
}

#[test]
fn points_stay_in_their_rooms() {
    judge(25, case);
}

/// A point slid over two triangles that are coplanar up to f32 rounding, and past the seam of a wall.
#[test]
fn points_that_slip_through_a_seam_are_put_back() {
    judge_from(288, 1, case);
}
