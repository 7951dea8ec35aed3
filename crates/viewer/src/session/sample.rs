//! The figures recorded after each step: the curves of the plots and the columns of their tables.

use std::fmt::Write;

use sim_core::{DVec3, Phase, Profile, World};

/// The figures of one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Simulated time, s.
    pub time: f64,
    /// Steps since the start of the world.
    pub steps: u64,
    /// Kinetic energy, J.
    pub kinetic: f64,
    /// The rotational part of the kinetic energy, J; `None` if there are no turning bodies.
    pub turning: Option<f64>,
    /// Potential energy, J; not finite at a centre of attraction.
    pub potential: f64,
    /// Momentum, kg m/s.
    pub momentum: DVec3,
    /// Angular momentum about the origin, kg m²/s: orbital and rotational, of all moving bodies.
    pub angular_momentum: DVec3,
    /// Largest distance of a body from its exact position, m, if known.
    pub error: Option<f64>,
    /// Real time of the step, s; `None` for a state that did not result from a step.
    pub cost: Option<f64>,
    /// The parts of that time, s, in the order of [`Phase::ALL`], if they were timed.
    pub phases: Option<[f64; Phase::ALL.len()]>,
    /// Persisting contacts.
    pub contacts: usize,
    /// Impacts in the step.
    pub impacts: u64,
}

impl Sample {
    /// The figures of the present state of a world.
    pub fn of(world: &World, error: Option<f64>, cost: Option<f64>, impacts: u64) -> Self {
        Self {
            time: world.time(),
            steps: world.steps(),
            kinetic: world.kinetic_energy(),
            turning: turns(world).then(|| world.turning_energy()),
            potential: world.potential_energy(),
            momentum: world.momentum(),
            angular_momentum: world.angular_momentum_about(DVec3::ZERO),
            error,
            cost,
            phases: None,
            contacts: world.contacts().count(),
            impacts,
        }
    }

    /// Adds the times of the phases of a step, in ns, if they were measured.
    pub(super) fn with_profile(self, profile: Option<Profile>) -> Self {
        let phases = profile.map(|p| Phase::ALL.map(|phase| 1e-9 * p.spent(phase) as f64));
        Self { phases, ..self }
    }

    /// The time of a phase of the step, s.
    pub fn phase(&self, phase: Phase) -> Option<f64> {
        self.phases.map(|phases| phases[phase as usize])
    }
}

/// Whether a world has turning bodies.
pub fn turns(world: &World) -> bool {
    (0..world.len()).any(|i| world.turns(i))
}

/// A figure over time.
pub struct Column {
    /// Its name in the CSV tables, with the unit.
    pub name: &'static str,
    /// Its value, if known.
    pub value: fn(&Sample) -> Option<f64>,
}

/// Every figure, in the order of the tables.
pub static COLUMNS: [Column; 19] = [
    Column {
        name: "time_s",
        value: |s| Some(s.time),
    },
    Column {
        name: "step",
        value: |s| Some(s.steps as f64),
    },
    Column {
        name: "kinetic_energy_J",
        value: |s| Some(s.kinetic),
    },
    Column {
        name: "potential_energy_J",
        value: |s| Some(s.potential),
    },
    Column {
        name: "total_energy_J",
        value: |s| Some(s.kinetic + s.potential),
    },
    Column {
        name: "momentum_x_kg_m_s",
        value: |s| Some(s.momentum.x),
    },
    Column {
        name: "momentum_y_kg_m_s",
        value: |s| Some(s.momentum.y),
    },
    Column {
        name: "momentum_z_kg_m_s",
        value: |s| Some(s.momentum.z),
    },
    Column {
        name: "angular_momentum_x_kg_m2_s",
        value: |s| Some(s.angular_momentum.x),
    },
    Column {
        name: "angular_momentum_y_kg_m2_s",
        value: |s| Some(s.angular_momentum.y),
    },
    Column {
        name: "angular_momentum_z_kg_m2_s",
        value: |s| Some(s.angular_momentum.z),
    },
    Column {
        name: "path_error_m",
        value: |s| s.error,
    },
    Column {
        name: "step_cost_s",
        value: |s| s.cost,
    },
    Column {
        name: "integrate_s",
        value: |s| s.phase(Phase::Integrate),
    },
    Column {
        name: "broad_phase_s",
        value: |s| s.phase(Phase::Broad),
    },
    Column {
        name: "narrow_phase_s",
        value: |s| s.phase(Phase::Narrow),
    },
    Column {
        name: "response_s",
        value: |s| s.phase(Phase::Respond),
    },
    Column {
        name: "contacts",
        value: |s| Some(s.contacts as f64),
    },
    Column {
        name: "impacts",
        value: |s| Some(s.impacts as f64),
    },
];

/// The first line of a table: `run`, if the runs have names, and the columns.
pub fn csv_head(named: bool) -> String {
    let names = COLUMNS.iter().map(|column| column.name);
    let names: Vec<&str> = named.then_some("run").into_iter().chain(names).collect();
    names.join(",") + "\n"
}

/// A line of a table: numbers are exact, unknown figures are empty.
pub fn csv_line(run: Option<&str>, sample: &Sample) -> String {
    let mut line = String::new();
    if let Some(run) = run {
        line += &quoted(run);
        line.push(',');
    }
    for (n, column) in COLUMNS.iter().enumerate() {
        if n > 0 {
            line.push(',');
        }
        if let Some(value) = (column.value)(sample).filter(|value| value.is_finite()) {
            // Writing to a String cannot fail.
            let _ = write!(line, "{value}");
        }
    }
    line.push('\n');
    line
}

/// A field of a table, quoted if necessary.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
