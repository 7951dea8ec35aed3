//! Bodies put into the world in overlap: case 23.

use std::sync::Arc;

use kit::bodies::wall;
use kit::meshes::{builtin, cube};
use sim_core::{Body, DVec3, Mesh};

use crate::shapes::torus;
use crate::worlds::{DT, ULP, ball, mesh_body, run, world};

fn of_mesh(mesh: &Arc<Mesh>) -> Body {
    mesh_body(mesh, DVec3::ZERO, DVec3::ZERO)
}

/// Pairs, the second one displaced along x by nine tenths of what would part them.
fn pairs() -> Vec<(&'static str, [Body; 2], f64)> {
    let sphere = ball(0.5, DVec3::ZERO, DVec3::ZERO);
    let cow = builtin("cow.obj");
    let width = f64::from(cow.bounds().max.x - cow.bounds().min.x);
    let twice = |body: Body| [body.clone(), body];
    let floor = wall(DVec3::X, DVec3::ZERO, DVec3::ZERO);
    vec![
        ("cubes", twice(of_mesh(&cube(0.5))), 1.0),
        ("spheres", twice(sphere.clone()), 1.0),
        ("tori", twice(of_mesh(&torus(0.75, 0.25))), 2.0),
        ("cows", twice(of_mesh(&cow)), width),
        ("sphere in a floor", [floor.clone(), sphere], 0.5),
        ("cube in a floor", [floor, of_mesh(&cube(0.5))], 0.5),
    ]
}

/// Whether they approach, rest or part: no energy comes in, and those that part do part.
#[test]
fn overlap_adds_no_energy_and_does_not_hold_together() {
    for (name, bodies, reach) in pairs() {
        for speed in [0.0, 0.5, -0.5] {
            let mut bodies = bodies.clone();
            bodies[1].position = DVec3::X * 0.9 * reach;
            bodies[1].velocity = DVec3::new(speed, 0.0, 0.1 * speed);
            let mut world = world(DT, &bodies);
            let what = format!("{name} at {speed}");
            assert_eq!(world.overlapping(), [(0, 1)], "{what}");
            let energy = world.kinetic_energy();
            for _ in 0..120 {
                let before = world.kinetic_energy();
                world.step().expect("a step");
                let after = world.kinetic_energy();
                assert!(
                    after <= before * (1.0 + 2.0 * ULP),
                    "{what}: {before} to {after}"
                );
            }
            if speed == 0.0 {
                assert_eq!(world.kinetic_energy(), 0.0, "{what}");
            } else {
                assert!(world.overlapping().is_empty(), "{what}");
                let error = (world.kinetic_energy() / energy - 1.0).abs();
                assert!(error <= 1e-14, "{what}: energy off by {error:e}");
            }
        }
    }
}

/// A third body bounces off a pair in overlap as off anything.
#[test]
fn others_are_not_disturbed_by_a_pair_in_overlap() {
    let cube = cube(0.5);
    let pair = [0.0, 0.9].map(|x| mesh_body(&cube, DVec3::X * x, DVec3::ZERO));
    let [first, second] = pair;
    let third = mesh_body(&cube, DVec3::new(-3.0, 0.0, 0.0), 4.0 * DVec3::X);
    let mut world = world(DT, &[first, second, third]);
    let energy = world.kinetic_energy();
    let impacts = run(&mut world, 120);
    assert!(impacts.iter().any(|i| i.bodies == (0, 2)), "{impacts:?}");
    let momentum = world.momentum() - 4.0 * DVec3::X;
    assert!(momentum.length() <= 1e-14 * 4.0, "{momentum}");
    let error = (world.kinetic_energy() / energy - 1.0).abs();
    assert!(error <= 1e-14, "energy off by {error:e}");
    let distances = world.position(0) - world.position(2);
    assert!(distances.x >= 1.0, "{distances}");
}
