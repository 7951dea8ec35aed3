//! A ball bounces under gravity, by every method: how well each finds its impacts.
//!
//! Between impacts a body moves as its method makes it; an impact is where that way meets the
//! floor, not where a chord of it does. So the error of an impact's time is the method's own, and
//! nothing but rounding where a method is exact for parabolas.

use sim_core::{Body, BodyKind, DVec3, Force, METHODS, Method, Settings, Shape, World};

use crate::scope::Scope;

const G: f64 = 9.81;
const BOUNCES: usize = 3;

/// A run of a method at a rate.
#[derive(Debug)]
pub(crate) struct Bounce {
    pub(crate) method: &'static Method,
    /// s
    pub(crate) dt: f64,
    /// Largest error of the times of three impacts, s; `None` unless there are three.
    pub(crate) time: Option<f64>,
    /// Largest relative change of the energy in 2.5 s.
    pub(crate) energy: f64,
}

pub(super) fn measure(scope: Scope) -> Vec<Bounce> {
    let halvings = match scope {
        Scope::Full => 8,
        Scope::Quick => 3,
    };
    let runs = METHODS.into_iter().flat_map(|method| {
        (0..halvings).filter_map(move |halving| run(method, 1.0 / (30 << halving) as f64).ok())
    });
    runs.collect()
}

fn run(method: &'static Method, dt: f64) -> anyhow::Result<Bounce> {
    let mut world = World::new(Settings {
        method,
        dt,
        tolerance: 1e-13,
        ..Settings::default()
    })?;
    world.add(Body {
        shape: Some(Shape::HalfSpace { normal: DVec3::Y }),
        kind: BodyKind::Static,
        ..Body::default()
    })?;
    world.add(Body {
        shape: Some(Shape::Sphere { radius: 0.0 }),
        position: DVec3::Y,
        ..Body::default()
    })?;
    world.add_force(Force::Gravity {
        acceleration: -G * DVec3::Y,
    })?;
    let mut impacts = Vec::new();
    let mut energy: f64 = 0.0;
    for _ in 0..(2.5 / dt).round() as u32 {
        world.step_reporting(&mut impacts)?;
        let now = world.kinetic_energy() + G * world.position(1).y;
        energy = energy.max((now / G - 1.0).abs());
    }
    let fall = (2.0 / G).sqrt();
    let errors = (0..)
        .zip(&impacts)
        .map(|(n, impact)| (impact.time - f64::from(2 * n + 1) * fall).abs());
    let time = (impacts.len() == BOUNCES).then(|| errors.fold(0.0, f64::max));
    Ok(Bounce {
        method,
        dt,
        time,
        energy,
    })
}
