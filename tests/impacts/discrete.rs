//! The discrete mode puts bodies back: case 24.

use kit::meshes::cube;
use kit::worlds::world_of;
use sim_core::{Collision, DVec3, Settings};

use crate::shapes::star;
use crate::worlds::{DT, mesh_body, settings};

#[test]
fn a_hit_puts_bodies_back_to_where_the_step_began() {
    let (star, cube) = (star(1.0, 0.2), cube(0.5));
    for collision in [Collision::Naive, Collision::Bvh] {
        for phase in 0..16 {
            let x = -3.0 - 2.0 * DT * f64::from(phase) / 16.0;
            let settings = Settings {
                collision,
                ..settings(DT)
            };
            let mut world = world_of(
                settings,
                &[
                    mesh_body(&star, DVec3::ZERO, DVec3::ZERO),
                    mesh_body(&cube, DVec3::new(x, 0.25, 0.0), 2.0 * DVec3::X),
                ],
            );
            let (mut hits, mut moves) = (0, 0);
            for _ in 0..180 {
                let before = [0, 1].map(|i| world.position(i));
                let impacts = world.impacts();
                world.step().expect("a step");
                let after = [0, 1].map(|i| world.position(i));
                if world.impacts() > impacts {
                    assert_eq!(after, before, "{collision:?}, phase {phase}");
                    hits += 1;
                } else {
                    moves += 1;
                }
            }
            assert!(hits > 0, "{collision:?}, phase {phase}");
            // What is lost is the time of the steps with a hit, and no more.
            let centre = 0.5 * (world.position(0) + world.position(1));
            let moved = centre.x - 0.5 * x;
            assert!((moved - f64::from(moves) * DT).abs() < 1e-12, "{moved}");
        }
    }
}
