//! Floors, bodies on them, and closed forms of motion in bowls.

use std::f64::consts::TAU;

use kit::bodies::{at, immovable};
use kit::shapes::half_space;
use kit::worlds::{GRAVITY, add_gravity};
use sim_core::{Body, DVec3, Method, Settings, Shape, World};

/// A world under gravity, stepped by a method at 60 Hz.
pub(crate) fn world(method: &'static Method) -> World {
    let settings = Settings {
        method,
        ..Settings::default()
    };
    let mut world = World::new(settings).expect("settings");
    add_gravity(&mut world, GRAVITY * DVec3::NEG_Y);
    world
}

pub(crate) fn rk4() -> &'static Method {
    Method::named("rk4").expect("a method")
}

/// Speed, m/s, and period, s, of a conical pendulum of a length, m, at an angle from its lowest point.
pub(crate) fn conical_pendulum(length: f64, angle: f64) -> (f64, f64) {
    let speed = (GRAVITY * length * angle.sin() * angle.tan()).sqrt();
    (speed, TAU * length * angle.sin() / speed)
}

/// An immovable body.
pub(crate) fn fixed(shape: &Shape, position: DVec3) -> Body {
    Body {
        restitution: 0.0,
        ..immovable(at(shape, position))
    }
}

/// An immovable half-space below a plane through a point.
pub(crate) fn ground(normal: DVec3, position: DVec3) -> Body {
    fixed(&half_space(normal), position)
}
