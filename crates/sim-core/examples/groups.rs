//! Who collides with whom: sparks fly through each other, and bounce off the floor.
//!
//! `cargo run -p sim-core --example groups`

use sim_core::{Body, BodyKind, DVec3, Force, Groups, Settings, Shape, World};

const SPARKS: u32 = 1;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for through_each_other in [false, true] {
        let groups = match through_each_other {
            true => Groups {
                member_of: SPARKS,
                collides_with: !SPARKS,
            },
            false => Groups::ALL,
        };
        let mut world = World::new(Settings::default())?;
        // Unless told otherwise it is in all groups and collides with all.
        world.add(Body {
            shape: Some(Shape::HalfSpace { normal: DVec3::Y }),
            kind: BodyKind::Static,
            ..Body::default()
        })?;
        for i in 0..100 {
            let angle = f64::from(i);
            world.add(Body {
                shape: Some(Shape::Sphere { radius: 0.1 }),
                position: DVec3::new(2.0 * angle.cos(), 1.0 + 0.03 * angle, 2.0 * angle.sin()),
                velocity: DVec3::new(-2.0 * angle.cos(), 3.0, -2.0 * angle.sin()),
                groups,
                ..Body::default()
            })?;
        }
        world.add_force(Force::Gravity {
            acceleration: -9.81 * DVec3::Y,
        })?;
        let (mut impacts, mut between) = (Vec::new(), 0);
        while world.time() < 3.0 {
            impacts.clear();
            world.step_reporting(&mut impacts)?;
            between += impacts.iter().filter(|impact| impact.bodies.0 != 0).count();
        }
        println!(
            "{} impacts, {between} of them between sparks",
            world.impacts()
        );
    }
    Ok(())
}
