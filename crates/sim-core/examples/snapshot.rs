//! A world is written as text and read again; both go on to the same bits.
//!
//! `cargo run -p sim-core --example snapshot --features serde`

use sim_core::{Body, BodyKind, DVec3, Force, Settings, Shape, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = World::new(Settings::default())?;
    world.add(Body {
        shape: Some(Shape::HalfSpace { normal: DVec3::Y }),
        kind: BodyKind::Static,
        ..Body::default()
    })?;
    let ball = world.add(Body {
        shape: Some(Shape::Sphere { radius: 0.5 }),
        position: DVec3::new(0.1, 3.0, 0.2),
        restitution: 0.8,
        ..Body::default()
    })?;
    let ball = world.handle(ball);
    world.add_force(Force::Gravity {
        acceleration: -9.81 * DVec3::Y,
    })?;
    while world.time() < 1.0 {
        world.step()?;
    }
    let text = serde_json::to_string(&world)?;
    println!("{} bytes", text.len());
    // Numbers to the bit: feature `float_roundtrip` of serde_json.
    let mut read: World = serde_json::from_str(&text)?;
    for _ in 0..600 {
        world.step()?;
        read.step()?;
    }
    let height = read.position(read.index_of(ball)?).y;
    println!("{height} m high, hash {:016x}", read.state_hash());
    assert_eq!(read.state_hash(), world.state_hash());
    Ok(())
}
