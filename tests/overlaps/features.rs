//! The vertices, edges and faces that touch in contacts.

use kit::bodies::{at, immovable};
use kit::shapes::{ball, cuboid, half_space};
use kit::worlds::{add_gravity, world};
use sim_core::{ContactFeature, DVec3, Feature, RestingContact, Touching, World};

use crate::WEIGHT;

/// The contacts of a world after a few steps, and the touching features of each.
fn touching(mut world: World) -> Vec<(RestingContact, Vec<Touching>)> {
    add_gravity(&mut world, WEIGHT);
    for _ in 0..5 {
        world.step().expect("a step");
    }
    let contacts: Vec<RestingContact> = world.contacts().collect();
    let features = contacts
        .iter()
        .map(|contact| world.contact_features(contact));
    contacts.iter().copied().zip(features.clone()).collect()
}

fn only(world: World) -> Vec<Touching> {
    let mut all = touching(world);
    assert_eq!(all.len(), 1, "{all:?}");
    all.remove(0).1
}

fn has_points(touching: &[Touching], points: &[[f64; 3]]) {
    assert_eq!(touching.len(), points.len(), "{touching:?}");
    for &point in points {
        let point = DVec3::from(point);
        let is_there = |t: &&Touching| (t.point - point).length() < 1e-9;
        assert_eq!(
            touching.iter().filter(is_there).count(),
            1,
            "{point} of {touching:?}"
        );
    }
    for touch in touching {
        assert!((-1e-11..1e-11).contains(&touch.gap), "{touch:?}");
    }
}

#[test]
fn a_cube_stands_on_the_corners_of_its_face() {
    let block = immovable(at(&cuboid([2.0, 0.5, 2.0]), DVec3::ZERO));
    let floor = immovable(at(&half_space(DVec3::Y), 0.5 * DVec3::Y));
    let corners = [
        [-0.2, 0.5, -0.4],
        [0.8, 0.5, -0.4],
        [-0.2, 0.5, 0.6],
        [0.8, 0.5, 0.6],
    ];
    for ground in [block, floor] {
        let stood = at(&cuboid([0.5; 3]), DVec3::new(0.3, 1.0, 0.1));
        for is_first in [true, false] {
            let mut pair = [stood.clone(), ground.clone()];
            if !is_first {
                pair.reverse();
            }
            let is_mesh = ground
                .shape
                .as_ref()
                .is_some_and(|shape| shape.mesh().is_some());
            let touching = only(world(pair));
            has_points(&touching, &corners);
            // The vertices of its lower side.
            let vertices = touching.iter().map(|touch| match touch.feature {
                ContactFeature::Meshes(Feature::VertexFace { vertex, .. })
                    if is_mesh && is_first =>
                {
                    vertex
                }
                ContactFeature::Meshes(Feature::FaceVertex { vertex, .. })
                    if is_mesh && !is_first =>
                {
                    vertex
                }
                ContactFeature::Vertex(vertex) if !is_mesh => vertex,
                other => panic!("{other:?}"),
            });
            let mut vertices: Vec<u32> = vertices.collect();
            vertices.sort_unstable();
            assert_eq!(vertices, [0, 1, 4, 5]);
        }
    }
}

#[test]
fn faces_that_lie_across_each_other_touch_where_their_edges_cross_and_in_corners() {
    // Crossed bars.
    let lower = immovable(at(&cuboid([2.0, 0.5, 0.25]), DVec3::ZERO));
    let bar = at(&cuboid([0.25, 0.5, 2.0]), DVec3::Y);
    let touching = only(world([lower.clone(), bar]));
    has_points(
        &touching,
        &[
            [-0.25, 0.5, -0.25],
            [0.25, 0.5, -0.25],
            [-0.25, 0.5, 0.25],
            [0.25, 0.5, 0.25],
        ],
    );
    let are_edges =
        |t: &Touching| matches!(t.feature, ContactFeature::Meshes(Feature::EdgeEdge { .. }));
    assert!(touching.iter().all(are_edges), "{touching:?}");
    // Over the end: two corners on it, two crossings, and two corners of the lower one in the upper.
    let over = at(&cuboid([0.5, 0.5, 0.125]), DVec3::new(2.0, 1.0, 0.1875));
    let touching = only(world([lower, over]));
    has_points(
        &touching,
        &[
            [1.5, 0.5, 0.0625],
            [1.5, 0.5, 0.3125 - 0.0625],
            [2.0, 0.5, 0.0625],
            [2.0, 0.5, 0.25],
        ],
    );
}

#[test]
fn what_is_round_touches_a_face_an_edge_or_a_corner() {
    let block = immovable(at(&cuboid([0.5; 3]), DVec3::ZERO));
    for is_first in [true, false] {
        let touched = |position: DVec3, normal: DVec3| {
            let ball = at(&ball(0.25), position + (0.25 + 1e-13) * normal);
            let mut pair = [ball, block.clone()];
            if !is_first {
                pair.reverse();
            }
            let mut world = world(pair);
            world.step().expect("a step");
            let contacts: Vec<RestingContact> = world.contacts().collect();
            assert_eq!(contacts.len(), 1, "{position}");
            let touching = world.contact_features(&contacts[0]);
            assert_eq!(touching.len(), 1, "{touching:?}");
            assert!(
                (touching[0].point - position).length() < 1e-9,
                "{touching:?}"
            );
            touching[0].feature
        };
        let face = touched(DVec3::new(0.1, 0.5, 0.2), DVec3::Y);
        assert!(matches!(face, ContactFeature::Face(_)), "{face:?}");
        // On the diagonal of a side, which is not an edge.
        let face = touched(DVec3::new(0.0, 0.5, 0.0), DVec3::Y);
        assert!(matches!(face, ContactFeature::Face(_)), "{face:?}");
        let edge = touched(
            DVec3::new(0.5, 0.5, 0.1),
            DVec3::new(1.0, 1.0, 0.0).normalize(),
        );
        assert!(matches!(edge, ContactFeature::Edge(_)), "{edge:?}");
        let corner = touched(DVec3::splat(0.5), DVec3::ONE.normalize());
        assert_eq!(corner, ContactFeature::Vertex(7));
    }
    let floor = immovable(at(&half_space(DVec3::Y), DVec3::ZERO));
    let touching = only(world([floor, at(&ball(0.5), 0.5 * DVec3::Y)]));
    has_points(&touching, &[[0.0, 0.0, 0.0]]);
    assert_eq!(touching[0].feature, ContactFeature::Smooth);
}

#[test]
fn each_contact_of_a_corner_has_its_own_features() {
    let walls = [
        at(&cuboid([2.0, 0.5, 2.0]), DVec3::new(0.0, -0.5, 0.0)),
        at(&cuboid([0.5, 2.0, 2.0]), DVec3::new(-0.5, 2.0, 0.0)),
    ];
    let [floor, wall] = walls.map(immovable);
    let all = touching(world([
        floor,
        wall,
        at(&cuboid([0.5; 3]), DVec3::new(0.5, 0.5, 0.0)),
    ]));
    assert_eq!(all.len(), 2, "{all:?}");
    for (contact, touching) in all {
        assert_eq!(touching.len(), 4, "{contact:?}");
        for touch in &touching {
            let along = if contact.bodies.0 == 0 {
                touch.point.y
            } else {
                touch.point.x
            };
            assert!(along.abs() < 1e-9, "{touch:?}");
        }
    }
    // The features of an overlap are not known.
    let mut pair = world([
        at(&cuboid([0.5; 3]), DVec3::ZERO),
        at(&cuboid([0.5; 3]), 0.5 * DVec3::X),
    ]);
    pair.step().expect("a step");
    let contact = pair.contacts().next().expect("it is held");
    assert!(contact.is_overlap && pair.contact_features(&contact).is_empty());
}
