//! A planet around a fixed sun.

use std::f64::consts::PI;

use sim_core::{Body, DMat3, DVec3, Force, Jacobians, Settings, System, World, WorldError};

use super::{Card, FirstOrder, Problem};
use crate::worlds;

/// `x'' = -x / |x|³`, state `(x, y, x', y')`.
#[derive(Clone, Debug)]
pub(super) struct Kepler;

fn perihelion(e: f64) -> (DVec3, DVec3) {
    let velocity = ((1.0 + e) / (1.0 - e)).sqrt() * DVec3::Y;
    ((1.0 - e) * DVec3::X, velocity)
}

/// The same problem in a world, under a force of attraction.
pub fn world(settings: Settings, eccentricity: f64) -> Result<World, WorldError> {
    let (position, velocity) = perihelion(eccentricity);
    let planet = Body {
        position,
        velocity,
        ..Body::default()
    };
    let pull = Force::Attraction {
        body: None,
        centre: DVec3::ZERO,
        strength: 1.0,
    };
    worlds::under(settings, [planet], &[pull])
}

/// A hundred orbits from the perihelion. With the semi-major axis 1 and `G M = 1`, one orbit takes 2π.
pub(super) fn problem(eccentricity: f64) -> Problem<Kepler, 4> {
    let (position, velocity) = perihelion(eccentricity);
    let (name, title) = match eccentricity {
        0.9 => ("kepler-0.9", "Kepler, e = 0.9, 100 orbits"),
        _ => ("kepler-0.6", "Kepler, e = 0.6, 100 orbits"),
    };
    Problem {
        card: Card {
            name,
            title,
            about: "x″ = -x/|x|³ from the perihelion (1 - e, 0) with (0, √((1+e)/(1-e))) for \
                    200 π. Exact end: back at the start (Hairer, Lubich, Wanner 2006, Geometric \
                    Numerical Integration, sec. I.2).",
            error: "position or velocity",
            time: 200.0 * PI,
            steps: [1_600, 1_600 << 13],
            frames: 100,
            is_stiff: false,
        },
        equations: Kepler,
        position: vec![position],
        velocity: vec![velocity],
        exact: vec![position.x, 0.0, 0.0, velocity.y],
        scale: 1.0,
    }
}

impl System for Kepler {
    fn len(&self) -> usize {
        1
    }

    fn is_coupled(&self) -> bool {
        false
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }

    fn accelerations(&self, _: f64, x: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
        let squared = x[0].length_squared();
        a[0] = -x[0] / (squared * squared.sqrt());
    }

    fn jacobians(&self, _: f64, x: &[DVec3], _: &[DVec3], out: &mut [Jacobians]) {
        let x = x[0];
        let squared = x.length_squared();
        let outer = DMat3::from_cols(x.x * x, x.y * x, x.z * x) * (3.0 / squared);
        let inverse = 1.0 / (squared * squared.sqrt());
        out[0] = Jacobians {
            position: (outer - DMat3::IDENTITY) * inverse,
            velocity: DMat3::ZERO,
        };
    }
}

impl FirstOrder<4> for Kepler {
    fn slope(&self, y: &[f64; 4], dy: &mut [f64; 4]) {
        let squared = y[0] * y[0] + y[1] * y[1];
        let inverse = 1.0 / (squared * squared.sqrt());
        *dy = [y[2], y[3], -y[0] * inverse, -y[1] * inverse];
    }

    fn slope_along(&self, y: &[f64; 4], d: &[f64; 4], out: &mut [f64; 4]) {
        let squared = y[0] * y[0] + y[1] * y[1];
        let inverse = 1.0 / (squared * squared.sqrt());
        let along = 3.0 * (y[0] * d[0] + y[1] * d[1]) / squared;
        let pull = |i: usize| inverse * (along * y[i] - d[i]);
        *out = [d[2], d[3], pull(0), pull(1)];
    }

    fn state(x: &[DVec3], v: &[DVec3]) -> [f64; 4] {
        [x[0].x, x[0].y, v[0].x, v[0].y]
    }
}
