//! A ball that bounces on a floor without end.

use sim_core::DVec3;

use super::{Form, GRAVITY, Goal, Item, Known, Scene};

/// Radius of the ball, m.
pub const RADIUS: f64 = 0.25;

/// An elastic ball dropped from 1 m: the height of its lowest point is 1 - (t - 2 n √(2/g))² g/2.
pub fn bouncing_ball() -> Known {
    let (duration, fall) = (10.0, (2.0 / GRAVITY).sqrt());
    let from_top = duration - 2.0 * fall * f64::round(duration / (2.0 * fall));
    let height = 1.0 - 0.5 * GRAVITY * from_top * from_top;
    Known {
        scene: Scene::falling(vec![
            Item::new(Form::Wall(DVec3::Y), DVec3::ZERO, DVec3::ZERO),
            Item::new(Form::Ball(RADIUS), (1.0 + RADIUS) * DVec3::Y, DVec3::ZERO),
        ]),
        duration,
        impact: Some(fall),
        goal: Goal::Places {
            at: vec![(height + RADIUS) * DVec3::Y],
            way: 1.0,
        },
    }
}
