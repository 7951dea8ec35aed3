//! A stone on a parabola, against the closed form, in twenty lines.

use sim_core::{Body, DVec3, Settings, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = World::new(Settings::default())?;
    let stone = world.add(Body {
        velocity: DVec3::new(2.0, 3.0, 0.0),
        force: -DVec3::Y,
        ..Body::default()
    })?;
    while world.steps() < 360 {
        world.step()?;
    }
    let (t, at) = (world.time(), world.position(stone));
    let exact = DVec3::new(2.0 * t, 3.0 * t - 0.5 * t * t, 0.0);
    println!("t = {t} s: at {at}, {:.3} m off", at.distance(exact));
    Ok(())
}
