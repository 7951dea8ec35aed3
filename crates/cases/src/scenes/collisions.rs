//! Scenes of two colliding bodies with a known final state.

use kit::meshes::builtin;
use sim_core::DVec3;

use super::{Family, Form, Pair, Who, bouncing_ball};

/// The fraction of a run after which the pair touches; at no rate is it a boundary of a step.
const IMPACT: f64 = 0.5187;

const SPEEDS: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];

/// Scenes that test collisions.
pub static COLLISIONS: [Family; 3] = [
    Family {
        name: "cube-cube",
        title: "Cube on cube, head on",
        about: "One cube of 1 kg and 1 m comes face on upon another at rest, and touches it after \
                0.5187 s of 1 s; the cubes exchange their velocities.",
        speeds: &SPEEDS,
        make: |speed| {
            let forms = [Form::Cube(0.5), Form::Cube(0.5)];
            Pair::new(forms, DVec3::X).known(speed, IMPACT, 1.0)
        },
        tolerance: 1e-12,
        passed_by: &[Who::Continuous],
    },
    Family {
        name: "cube-cow",
        title: "Cube on cow",
        about: "A cube comes upon the cow, both of 1 kg. The exact end is that of one impact with \
                the features that touch first, found over the whole way at once.",
        speeds: &SPEEDS,
        make: |speed| {
            let forms = [Form::Mesh(builtin("cow.obj")), Form::Cube(0.5)];
            Pair::new(forms, DVec3::new(1.0, 0.05, 0.1)).known(speed, IMPACT, 1.0)
        },
        tolerance: 1e-12,
        passed_by: &[Who::Continuous],
    },
    Family {
        name: "ball",
        title: "Bouncing ball",
        about: "Dropped from 1 m, elastic, for 10 s under 9.81 m/s², by velocity Verlet, which is \
                exact in flight: 11 bounces. Parts of the way are parts of 1 m.",
        speeds: &[1.0],
        make: |_| bouncing_ball(),
        tolerance: 1e-12,
        passed_by: &[Who::Continuous],
    },
];
