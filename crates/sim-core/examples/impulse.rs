//! An explosion: each body gets an impulse away from a point, the weaker the farther it is.
//!
//! `cargo run -p sim-core --example impulse`

use sim_core::{Body, BodyKind, DVec3, Settings, Shape, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = World::new(Settings::default())?;
    for i in 1..=4 {
        let x = f64::from(i);
        world.add(Body {
            shape: Some(Shape::Sphere { radius: 0.25 }),
            position: DVec3::new(2.0 * x, 0.0, x),
            mass: x,
            ..Body::default()
        })?;
    }
    // Nothing moves this one.
    world.add(Body {
        shape: Some(Shape::HalfSpace { normal: DVec3::X }),
        position: -DVec3::X,
        kind: BodyKind::Static,
        ..Body::default()
    })?;
    let (centre, strength) = (DVec3::ZERO, 30.0);
    for body in 0..world.len() {
        let away = world.position(body) - centre;
        world.apply_impulse(body, strength * away / away.length().powi(3))?;
    }
    world.step()?;
    for body in world.bodies() {
        let (mass, speed) = (body.mass, body.velocity.length());
        println!(
            "body {}: {mass} kg, {:?}, {speed:.3} m/s",
            body.index, body.kind
        );
    }
    let sum = world.momentum();
    println!("momentum of all: {sum:.3} kg m/s");
    Ok(())
}
