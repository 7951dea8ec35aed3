//! Bodies come and go; handles go on naming those that stay.
//!
//! `cargo run -p sim-core --example removal`

use sim_core::{Body, BodyKind, DVec3, Force, Settings, Shape, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = World::new(Settings::default())?;
    world.add(Body {
        shape: Some(Shape::HalfSpace { normal: DVec3::Y }),
        kind: BodyKind::Static,
        ..Body::default()
    })?;
    // A tower of balls, each of which lies on the one before.
    let mut tower = Vec::new();
    for storey in 0..3_u32 {
        let body = world.add(Body {
            shape: Some(Shape::Sphere { radius: 0.5 }),
            position: (0.5 + f64::from(storey)) * DVec3::Y,
            restitution: 0.0,
            user_data: u64::from(10 * storey),
            ..Body::default()
        })?;
        tower.push(world.handle(body));
    }
    world.add_force(Force::Gravity {
        acceleration: -9.81 * DVec3::Y,
    })?;
    while world.time() < 1.0 {
        world.step()?;
    }
    let gone = world.remove(world.index_of(tower[0])?)?;
    println!("ball {} is taken away from below", gone.user_data);
    while world.time() < 2.0 {
        world.step()?;
    }
    for handle in tower {
        match world.index_of(handle) {
            Ok(body) => {
                let body = world.body(body);
                let (height, ball) = (body.position.y, body.user_data);
                println!("ball {ball} is body {} now, {height:.6} m high", body.index);
            }
            Err(error) => println!("{error}"),
        }
    }
    Ok(())
}
