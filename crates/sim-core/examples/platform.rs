//! A lift: a kinematic body that keeps the velocity it is given and carries what lies on it.
//!
//! `cargo run -p sim-core --example platform`

use sim_core::{Body, BodyKind, DVec3, Force, Settings, Shape, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = World::new(Settings::default())?;
    let lift = world.add(Body {
        shape: Some(Shape::HalfSpace { normal: DVec3::Y }),
        kind: BodyKind::Kinematic,
        ..Body::default()
    })?;
    let load = world.add(Body {
        shape: Some(Shape::Sphere { radius: 0.5 }),
        position: 0.5 * DVec3::Y,
        restitution: 0.0,
        ..Body::default()
    })?;
    world.add_force(Force::Gravity {
        acceleration: -9.81 * DVec3::Y,
    })?;
    // Up for two seconds, then it stands.
    for (until, speed) in [(2.0, 1.5), (4.0, 0.0)] {
        world.set_velocity(lift, speed * DVec3::Y)?;
        while world.time() < until {
            world.step()?;
        }
        let (floor, height) = (world.position(lift).y, world.position(load).y);
        println!(
            "{until} s: the lift is at {floor:.3} m, the load {:.9} m above",
            height - floor
        );
    }
    Ok(())
}
