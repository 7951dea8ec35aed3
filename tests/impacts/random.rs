//! Random shapes on random paths.

use std::sync::Arc;

use kit::worlds::meeting;
use proptest::prelude::*;
use sim_core::{Body, DVec3, Mesh, Shape, Vec3, World};

use crate::worlds::{DT, run_apart, world};

/// Triangles between random points of a coarse grid, with many degenerate ones and exact contacts, or of a fine grid,
/// without them. `None` if they form no mesh.
fn soup() -> impl Strategy<Value = Option<Arc<Mesh>>> {
    let vertex = prop_oneof![
        (-2i8..=2, -2i8..=2, -2i8..=2).prop_map(|(x, y, z)| [x, y, z].map(|c| f32::from(c) / 2.0)),
        [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0],
    ];
    let vertices = prop::collection::vec(vertex.prop_map(Vec3::from_array), 3..12);
    let triangles = prop::collection::vec([0u32..12, 0u32..12, 0u32..12], 1..16);
    (vertices, triangles).prop_map(|(vertices, triangles)| {
        let n = vertices.len() as u32;
        let triangles = triangles.into_iter().map(|t| t.map(|v| v % n));
        let proper = triangles.filter(|&[a, b, c]| a != b && b != c && c != a);
        Mesh::new(vertices, proper.collect()).ok().map(Arc::new)
    })
}

fn shape() -> impl Strategy<Value = Option<Shape>> {
    prop_oneof![
        6 => soup().prop_map(|mesh| mesh.map(Shape::Mesh)),
        1 => (0.0f64..1.0).prop_map(|radius| Some(Shape::Sphere { radius })),
        1 => Just(Some(Shape::Sphere { radius: 0.0 })),
    ]
}

/// Coarse numbers cause exact ties; speeds range from rest to many body lengths per step.
fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    let coarse = (-4i8..=4, -4i8..=4, -4i8..=4)
        .prop_map(move |(x, y, z)| [x, y, z].map(|c| f64::from(c) * size / 4.0));
    let fine = [-size..size, -size..size, -size..size];
    prop_oneof![coarse, fine].prop_map(DVec3::from_array)
}

fn body() -> impl Strategy<Value = Option<Body>> {
    let velocity = prop_oneof![vector(2.0), vector(300.0)];
    let mass = prop_oneof![Just(1.0), 1e-3f64..1e3];
    (shape(), vector(4.0), velocity, mass).prop_map(|(shape, position, velocity, mass)| {
        Some(Body {
            shape: Some(shape?),
            position,
            velocity,
            mass,
            ..Body::default()
        })
    })
}

/// A world without overlap at the start, otherwise `None`.
fn apart(bodies: &[Option<Body>]) -> Option<World> {
    let bodies: Option<Vec<Body>> = bodies.iter().cloned().collect();
    let world = world(DT, &bodies?);
    world.overlapping().is_empty().then_some(world)
}

/// The invariants of a force-free elastic world.
struct Kept {
    energy: f64,
    momentum: DVec3,
    /// Sum of the magnitudes of all momenta.
    scale: f64,
}

impl Kept {
    fn of(world: &World) -> Kept {
        let movable = (0..world.len()).filter(|&i| world.kind(i).is_movable());
        Kept {
            energy: world.kinetic_energy(),
            momentum: world.momentum(),
            scale: movable
                .map(|i| world.mass(i) * world.velocity(i).length())
                .sum(),
        }
    }

    /// Relative change of the energy.
    fn energy_error(&self, world: &World) -> f64 {
        (world.kinetic_energy() / self.energy - 1.0).abs()
    }

    /// Change of the momentum, relative to the sum of the momenta.
    fn momentum_error(&self, world: &World) -> f64 {
        (world.momentum() - self.momentum).length() / self.scale
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn nothing_meets_and_nothing_is_lost(bodies in prop::collection::vec(body(), 2..5)) {
        let world = apart(&bodies);
        prop_assume!(world.is_some());
        let mut world = world.expect("assumed");
        let kept = Kept::of(&world);
        for step in 1..=20 {
            run_apart(&mut world, 1);
            let found = meeting(&world, *world.settings());
            prop_assert!(found.is_empty(), "step {}: {:?} overlap", step, found);
        }
        let tolerance = 1e-14 * (1.0 + world.impacts() as f64);
        let (energy, momentum) = (kept.energy_error(&world), kept.momentum_error(&world));
        let at_rest = (0..world.len()).all(|i| world.velocity(i) == DVec3::ZERO);
        prop_assert!(at_rest || energy <= tolerance, "energy off by {:e}", energy);
        prop_assert!(at_rest || momentum <= tolerance, "momentum off by {:e}", momentum);
    }
}
