//! Scenes of two bodies whose end is known.

use std::sync::Arc;

use sim_core::collide::touch::first_touch;
use sim_core::{Bvh, DVec3, Mesh};

#[derive(Clone, Debug)]
pub(super) enum Form {
    /// An immovable floor with its normal along y.
    Floor,
    Ball(f64),
    /// A cube as engines know it, half of a side; and as a mesh.
    Cube(f64, Arc<Mesh>),
    Mesh(Arc<Mesh>),
}

#[derive(Clone, Debug)]
pub(super) struct Item {
    pub(super) form: Form,
    pub(super) position: DVec3,
    pub(super) velocity: DVec3,
}

/// Elastic bodies of 1 kg, the first of them at rest or a floor.
#[derive(Clone, Debug)]
pub(super) struct Scene {
    pub(super) items: [Item; 2],
    pub(super) gravity: f64,
    /// s
    pub(super) duration: f64,
    /// Time of the first impact, s.
    pub(super) impact: f64,
    /// Where bodies end.
    end: [DVec3; 2],
    /// How far the faster one goes, m.
    way: f64,
}

/// What a run ends with.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    /// Of the first impact, s.
    pub(super) time: Option<f64>,
    pub(super) positions: [DVec3; 2],
    pub(super) velocities: [DVec3; 2],
}

impl Scene {
    pub(super) fn steps(&self, rate: u32) -> u32 {
        (self.duration * f64::from(rate)).round() as u32
    }

    pub(super) fn position_error(&self, end: &End) -> f64 {
        let errors = [0, 1].map(|i| (end.positions[i] - self.end[i]).length());
        errors[0].max(errors[1]) / self.way
    }

    pub(super) fn energy_error(&self, end: &End) -> f64 {
        let energy = |motions: [(DVec3, DVec3); 2]| {
            let parts = motions.map(|(x, v)| 0.5 * v.length_squared() + self.gravity * x.y);
            parts[0] + parts[1]
        };
        let start = self
            .items
            .each_ref()
            .map(|item| (item.position, item.velocity));
        let end = [0, 1].map(|i| (end.positions[i], end.velocities[i]));
        (energy(end) / energy(start) - 1.0).abs()
    }
}

/// A scene for each speed.
pub(super) struct Family {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) about: &'static str,
    /// How many speeds it is made for.
    pub(super) speeds: usize,
    pub(super) make: fn(f64) -> Scene,
}

pub(super) static FAMILIES: [Family; 3] = [
    Family {
        name: "cube-cube",
        title: "Cube on cube, head on",
        about: "One cube of 1 kg and 1 m comes face on upon another at rest, and touches it after \
                0.5187 s of 1 s; the cubes exchange their velocities.",
        speeds: 4,
        make: |speed| pair(speed, Form::Cube(0.5, builtin("cube.obj")), DVec3::X),
    },
    Family {
        name: "cube-cow",
        title: "Cube on cow",
        about: "A cube comes upon the cow, both of 1 kg. The exact end is that of one impact with \
                the features that touch first, found over the whole way at once.",
        speeds: 4,
        make: |speed| {
            let way = DVec3::new(1.0, 0.05, 0.1);
            pair(speed, Form::Mesh(builtin("cow.obj")), way.normalize())
        },
    },
    Family {
        name: "ball",
        title: "Bouncing ball",
        about: "Dropped from 1 m, elastic, for 10 s under 9.81 m/s², by velocity Verlet, which is \
                exact in flight: 11 bounces. Parts of the way are parts of 1 m.",
        speeds: 1,
        make: |_| bouncing_ball(),
    },
];

fn builtin(name: &str) -> Arc<Mesh> {
    scene::mesh_file::builtin(name).unwrap_or_else(|| unreachable!("{name} is built in"))
}

/// Part of a run after which the pair touches: at no rate at the border of a step.
const IMPACT: f64 = 0.5187;

/// A cube that comes along `way` upon something at rest.
fn pair(speed: f64, still: Form, way: DVec3) -> Scene {
    let cube = builtin("cube.obj");
    let first = match &still {
        Form::Cube(_, mesh) | Form::Mesh(mesh) => Bvh::build(mesh),
        _ => unreachable!("pairs are of meshes"),
    };
    let (from, motion) = (-16.0 * way, 32.0 * way);
    let touch = first_touch(&first, &Bvh::build(&cube), from, motion);
    let touch = touch.unwrap_or_else(|| unreachable!("they are aimed at each other"));
    let (touching, normal) = (from + touch.time * motion, touch.normal);
    let (velocity, rest) = (speed * way, 1.0 - IMPACT);
    // Equal masses exchange what they have along the normal.
    let given = velocity.dot(normal) * normal;
    let item = |form, position, velocity| Item {
        form,
        position,
        velocity,
    };
    Scene {
        items: [
            item(still, DVec3::ZERO, DVec3::ZERO),
            item(
                Form::Cube(0.5, cube),
                touching - IMPACT * velocity,
                velocity,
            ),
        ],
        gravity: 0.0,
        duration: 1.0,
        impact: IMPACT,
        end: [rest * given, touching + rest * (velocity - given)],
        way: speed,
    }
}

const G: f64 = 9.81;
const RADIUS: f64 = 0.25;

fn bouncing_ball() -> Scene {
    let (duration, fall) = (10.0, (2.0 / G).sqrt());
    let from_top = duration - 2.0 * fall * f64::round(duration / (2.0 * fall));
    let item = |form, height| Item {
        form,
        position: height * DVec3::Y,
        velocity: DVec3::ZERO,
    };
    Scene {
        items: [
            item(Form::Floor, 0.0),
            item(Form::Ball(RADIUS), 1.0 + RADIUS),
        ],
        gravity: G,
        duration,
        impact: fall,
        end: [
            DVec3::ZERO,
            (RADIUS + 1.0 - 0.5 * G * from_top * from_top) * DVec3::Y,
        ],
        way: 1.0,
    }
}
