//! A ball that falls on a floor, by nothing but the public interface of `sim-core`.

use sim_core::{Body, BodyKind, DVec3, Force, Settings, Shape, World};

/// The height of a ball of radius 0.5 m, dropped from 2 m, after a second, m; it loses nothing.
pub fn height_after_a_second() -> Result<f64, Box<dyn std::error::Error>> {
    let mut world = World::new(Settings::default())?;
    world.add(Body {
        shape: Some(Shape::HalfSpace { normal: DVec3::Y }),
        kind: BodyKind::Static,
        ..Body::default()
    })?;
    let ball = world.add(Body {
        shape: Some(Shape::Sphere { radius: 0.5 }),
        position: 2.5 * DVec3::Y,
        ..Body::default()
    })?;
    world.add_force(Force::Gravity {
        acceleration: -9.81 * DVec3::Y,
    })?;
    while world.time() < 1.0 - 1e-9 {
        world.step()?;
    }
    Ok(world.position(ball).y)
}
