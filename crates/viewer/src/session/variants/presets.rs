//! Predefined comparisons.

use sim_core::{Collision, METHODS, Settings};

use crate::session::{MAX_RATE, MIN_RATE};

/// A predefined comparison.
pub struct Preset {
    /// Its name.
    pub title: &'static str,
    /// What it shows.
    pub meaning: &'static str,
    /// The settings to run in addition to those of the scene.
    pub settings: fn(&Settings) -> Vec<Settings>,
}

/// All predefined comparisons.
pub static PRESETS: [Preset; 3] = [
    Preset {
        title: "The four methods of the course",
        meaning: "Forward, backward and symplectic Euler and RK4, at this rate",
        settings: |own| {
            let course = METHODS.into_iter().take(4);
            course.map(|method| Settings { method, ..*own }).collect()
        },
    },
    Preset {
        title: "This method at five rates",
        meaning: "A quarter, half, once, twice and four times the present rate: how fast the error \
                  falls tells the order of the method",
        settings: |own| {
            let rates = [0.25, 0.5, 1.0, 2.0, 4.0].map(|part| part / own.dt);
            let offered = rates
                .into_iter()
                .filter(|r| (MIN_RATE..=MAX_RATE).contains(r));
            offered
                .map(|rate| Settings {
                    dt: 1.0 / rate,
                    ..*own
                })
                .collect()
        },
    },
    Preset {
        title: "Discrete against continuous",
        meaning: "Impacts looked for at the end of each step, as in the course, and within the step",
        settings: |own| {
            let modes = [Collision::Bvh, Collision::Continuous];
            modes.map(|collision| Settings { collision, ..*own }).into()
        },
    },
];
