//! The depths of overlaps, against closed forms.

use std::sync::Arc;

use kit::bodies::{at, immovable};
use kit::meshes;
use kit::random::Random;
use kit::shapes::{ball, cow, cuboid, half_space, mesh};
use kit::worlds::{add_gravity, meet, world};
use sim_core::{Body, DQuat, DVec3, Shape, Turn, Vec3, World};

use crate::{WEIGHT, touching};

/// The only overlap of a world with two bodies.
fn only(world: &World) -> sim_core::Overlap {
    let overlaps = world.overlaps();
    assert_eq!(overlaps.len(), 1, "{overlaps:?}");
    assert_eq!(overlaps[0].bodies, (0, 1));
    overlaps[0]
}

#[test]
fn depths_of_spheres_and_half_spaces_are_exact() {
    let mut random = Random::xorshift(7, 33);
    for _ in 0..200 {
        let way = random.direction();
        let apart = 0.4 + 0.5 * random.signed().abs();
        let overlap = only(&world([
            at(&ball(0.5), way),
            at(&ball(0.75), way * (1.0 + apart)),
        ]));
        assert!(
            (overlap.depth - (1.25 - apart)).abs() < 1e-14,
            "{overlap:?}"
        );
        assert!((overlap.normal - way).length() < 1e-14 && overlap.is_least);
        for (shape, reach) in [
            (ball(0.5), 0.5),
            (cuboid([0.5; 3]), 0.5 * way.abs().element_sum()),
        ] {
            let floor = immovable(at(&half_space(way), way));
            let body = at(
                &shape,
                way * (1.0 + reach - 0.25) + way.any_orthogonal_vector(),
            );
            for (turned, sign) in [(false, 1.0), (true, -1.0)] {
                let mut pair = [floor.clone(), body.clone()];
                if turned {
                    pair.reverse();
                }
                let overlap = only(&world(pair));
                assert!((overlap.depth - 0.25).abs() < 1e-6, "{overlap:?}");
                assert!((overlap.normal - sign * way).length() < 1e-14 && overlap.is_least);
            }
        }
    }
}

#[test]
fn depths_of_boxes_are_those_of_the_axis_that_parts_them_first() {
    let mut random = Random::xorshift(11, 33);
    let (first, second) = ([0.5, 1.0, 0.25], [0.75, 0.5, 0.5]);
    let shapes = (cuboid(first), cuboid(second));
    let reach = DVec3::new(1.25, 1.5, 0.75);
    let mut seen = 0;
    for _ in 0..300 {
        let offset = 0.99 * random.vector() * reach;
        if !meet(&shapes.0, &shapes.1, offset) {
            continue;
        }
        seen += 1;
        let least = (reach - offset.abs()).min_element();
        let overlap = only(&world([at(&shapes.0, DVec3::ZERO), at(&shapes.1, offset)]));
        assert!(
            (overlap.depth - least).abs() < 1e-10,
            "{least}: {overlap:?}"
        );
        assert!(overlap.is_least);
    }
    assert!(seen > 200);
}

#[test]
fn depths_of_balls_in_faces_edges_and_corners_of_a_mesh_are_those_of_the_distance() {
    let cube = at(&cuboid([0.5; 3]), DVec3::ZERO);
    for out in [
        DVec3::X,
        DVec3::NEG_Y,
        DVec3::new(1.0, -1.0, 0.0),
        DVec3::new(-1.0, 1.0, 1.0),
        DVec3::new(1.0, 2.0, 0.0),
    ] {
        let normal = out.normalize();
        let corner = 0.5 * out.signum() * out.abs().cmpgt(DVec3::ZERO).select_one();
        let at_ball = at(&ball(0.25), corner + 0.15 * normal + 0.1 * free_way(out));
        let overlap = only(&world([cube.clone(), at_ball]));
        assert!((overlap.depth - 0.1).abs() < 1e-7, "{out}: {overlap:?}");
        assert!(
            (overlap.normal - normal).length() < 1e-4,
            "{out}: {overlap:?}"
        );
        assert!(overlap.is_least, "{out}");
    }
}

/// Ones where a mask is set.
trait SelectOne {
    fn select_one(self) -> DVec3;
}

impl SelectOne for glam::BVec3 {
    fn select_one(self) -> DVec3 {
        DVec3::select(self, DVec3::ONE, DVec3::ZERO)
    }
}

/// The path along the face or edge nearest to a direction.
fn free_way(out: DVec3) -> DVec3 {
    DVec3::select(out.cmpeq(DVec3::ZERO), DVec3::ONE, DVec3::ZERO)
}

#[test]
fn a_depth_parts_and_less_does_not() {
    let mut random = Random::xorshift(5, 33);
    let shapes = [cow(), cuboid([0.5; 3]), ball(0.5), cow()];
    for _ in 0..40 {
        let (first, second) = (&shapes[random.below(4)], &shapes[random.below(4)]);
        let direction = random.direction();
        let depth = [1e-3, 0.1, 0.5][random.below(3)];
        let offset = (touching(first, second, direction) - depth) * direction;
        let overlaps = world([at(first, DVec3::ZERO), at(second, offset)]).overlaps();
        let Some(overlap) = overlaps.first() else {
            // Between hollow bodies there may be positions without contact.
            continue;
        };
        let by = |part: f64| offset + (part * overlap.depth) * overlap.normal;
        assert!(
            overlap.depth <= depth * (1.0 + 1e-9),
            "{overlap:?} of {depth}"
        );
        assert!(!meet(first, second, by(1.0 + 1e-9)), "{overlap:?}");
        assert!(meet(first, second, by(1.0 - 1e-9)), "{overlap:?}");
    }
}

#[test]
fn what_touches_by_rounding_is_no_overlap() {
    let mut random = Random::xorshift(3, 33);
    let (mut met, mut balls) = (0, 0);
    for _ in 0..400 {
        let normal = random.direction();
        let place = 10.0 * random.vector();
        // Constructed to touch, with rounded numbers.
        let bodies = [
            immovable(at(&half_space(normal), place)),
            at(
                &ball(0.5),
                place + 0.5 * normal + 3.0 * normal.any_orthogonal_vector(),
            ),
        ];
        let mut world = world(bodies);
        add_gravity(&mut world, WEIGHT);
        met += world.overlapping().len();
        balls += 1;
        assert_eq!(world.overlaps(), []);
        for _ in 0..3 {
            world.step().expect("a step");
            assert_eq!((world.overlaps().len(), world.overlapping().len()), (0, 0));
        }
    }
    assert!(met > 50 && met < balls, "{met} of {balls}");
    // A deeper position is an overlap.
    let body = at(&ball(0.5), DVec3::Y * (0.5 - 1e-6));
    let world = world([immovable(at(&half_space(DVec3::Y), DVec3::ZERO)), body]);
    let flush = world.flush(0, 1);
    assert!((1e-9..1e-6).contains(&flush), "{flush}");
    assert!((only(&world).depth - 1e-6).abs() < 1e-15);
}

#[test]
fn many_in_one_place_are_as_deep_as_two() {
    let tilt = DQuat::from_rotation_x(0.3) * DQuat::from_rotation_y(0.5);
    let tilted = meshes::cube(0.5).transformed(tilt, DVec3::ONE);
    let shapes = [
        (cuboid([0.5; 3]), 400),
        (Shape::Mesh(Arc::new(tilted.expect("a mesh"))), 200),
        (ball(0.5), 400),
        (cow(), 40),
    ];
    for (shape, count) in shapes {
        let crowd = |count| world(vec![at(&shape, DVec3::ONE); count]);
        let (mut pair, mut many) = (crowd(2), crowd(count));
        let expected = only(&pair);
        assert_eq!(many.overlapping().len(), count * (count - 1) / 2);
        for world in [&mut pair, &mut many] {
            world.step().expect("a step");
        }
        for bodies in [(0, 1), (0, count - 1), (count / 2, count - 1)] {
            let overlap = many.overlap(bodies.0, bodies.1).expect("an overlap");
            assert_eq!(overlap.depth, expected.depth);
        }
        assert!((0..count).all(|body| many.position(body) == DVec3::ONE));
    }
}

#[test]
fn turning_bodies_in_one_place_are_told() {
    let Shape::Mesh(one) = cow() else {
        unreachable!()
    };
    // Two components in one mesh.
    let beside = one.vertices().iter().map(|&v| v + Vec3::new(3.0, 0.0, 0.0));
    let vertices = one.vertices().iter().copied().chain(beside);
    let more = one.vertices().len() as u32;
    let others = one
        .triangles()
        .iter()
        .map(|t| t.map(|corner| corner + more));
    let triangles = one.triangles().iter().copied().chain(others);
    let two = mesh(vertices.collect(), triangles.collect());
    for (shape, count) in [(cow(), 12), (two, 2)] {
        let body = Body {
            turn: Some(Turn::default()),
            ..at(&shape, DVec3::ZERO)
        };
        let mut world = world(vec![body; count]);
        world.step().expect("a step");
        assert_eq!(world.overlapping().len(), count * (count - 1) / 2);
    }
}
