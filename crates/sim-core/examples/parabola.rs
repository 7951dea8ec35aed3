//! A stone on a parabola, against the closed form.

use sim_core::{Body, DVec3, Method, Settings, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let method = Method::named("rk4").ok_or("rk4 is in the table")?;
    let mut world = World::new(Settings {
        dt: 0.2,
        method,
        ..Settings::default()
    })?;
    let (start, velocity, force) = (DVec3::X * -4.0, DVec3::new(2.0, 2.0, 0.0), -DVec3::Y);
    let stone = world.add(Body {
        position: start,
        velocity,
        force,
        ..Body::default()
    })?;
    while world.steps() < 20 {
        world.step()?;
    }
    let t = world.time();
    let exact = start + t * velocity + 0.5 * t * t * force;
    let error = (world.position(stone) - exact).length();
    println!(
        "t = {t:.1} s: at {}, error {error:.1e} m",
        world.position(stone)
    );
    Ok(())
}
