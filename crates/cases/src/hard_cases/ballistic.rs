//! Case 1: a throw, for which every error is known.

use sim_core::{Body, DVec3, Force, Method};

use super::{Finding, Tried};
use crate::worlds;

pub(super) fn test(method: &'static Method) -> Tried {
    let Some(fall) = method.fall else {
        let why = "it does not say what it does to a constant force";
        return Ok(Finding::does_not_apply(why));
    };
    let stone = Body {
        position: DVec3::new(-4.0, 0.0, 0.0),
        velocity: DVec3::new(2.0, 2.0, 0.0),
        force: -DVec3::Y,
        ..Body::default()
    };
    let weightless = Body {
        force: DVec3::ZERO,
        ..stone.clone()
    };
    let gravity = Force::Gravity {
        acceleration: -DVec3::Y,
    };
    // A force without effect makes the method step the body itself, instead of the closed form.
    let no_drag = Force::LinearDrag {
        body: None,
        coefficient: 0.0,
    };
    // The ways, each with its rounding error per step in addition to 1e-13, m.
    let ways = [
        (stone.clone(), vec![], 0.0),
        (weightless, vec![gravity], 0.0),
        (stone, vec![no_drag], 1e-14),
    ];
    let mut worst: f64 = 0.0;
    for rate in [5.0, 30.0, 60.0, 240.0] {
        let dt = 1.0 / rate;
        // N steps fall by dt² (N (N - 1)/2 + N f), of which N²/2 is exact.
        let exact = DVec3::new(4.0, (2.0 - 4.0 * fall) * dt, 0.0);
        for (body, forces, rounding) in &ways {
            let settings = worlds::settings(method, dt);
            let mut world = worlds::under(settings, [body.clone()], forces)?;
            worlds::step(&mut world, (4.0 * rate) as u64)?;
            let off = (world.position(0) - exact).length();
            worst = worst.max(off / (1e-13 + rounding * rate));
        }
    }
    let why = match fall {
        0.5 => "exact at every dt".into(),
        _ => format!("lands at y = {:+} dt, as it must", 2.0 - 4.0 * fall),
    };
    Ok(Finding::within(worst, 1.0, why))
}
