//! Runs one variant: a world of its own, or the exact solution. Records its states.

use std::time::Duration;

use sim_core::{DQuat, DVec3, Profile, Settings, StepError, World, WorldError};

use crate::session::exact::Exact;
use crate::session::figures::{Drift, Reference};
use crate::session::sample::Sample;
use crate::stopwatch::nanoseconds;

/// The least number of recorded states of the exact solution per simulated second, so that its path looks smooth.
const EXACT_RATE: f64 = 60.0;

/// A state of a variant: its figures, and the positions of its bodies' origins, m.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// The figures.
    pub sample: Sample,
    pub(super) places: Box<[DVec3]>,
    /// The rotations of the bodies; empty if there are no turning bodies.
    pub(super) rotations: Box<[DQuat]>,
}

/// The source of the states.
#[derive(Clone, Debug)]
pub struct Runner {
    world: World,
    exact: Exact,
    course: Course,
    reference: Reference,
    profiled: bool,
}

#[derive(Clone, Debug)]
enum Course {
    Steps,
    /// The exact solution: its start, s, the number of recorded states, and the time between two of them, s.
    Exact {
        start: f64,
        noted: u64,
        apart: f64,
    },
}

/// The reason why a variant stops.
#[derive(Debug)]
pub enum Halt {
    /// A step failed.
    Step(StepError),
    /// The exact solution is not known after this time.
    Unknown,
}

impl Runner {
    /// A variant that steps from the present state of `world` with other settings.
    pub fn stepping(world: &World, settings: Settings) -> Result<Self, WorldError> {
        let mut own = world.clone();
        own.set_settings(settings)?;
        Ok(Self {
            exact: Exact::of(&own),
            reference: Reference::of(&own),
            world: own,
            course: Course::Steps,
            profiled: false,
        })
    }

    /// Also times steps by phase.
    pub fn profiled(self) -> Self {
        Self {
            profiled: true,
            ..self
        }
    }

    /// The exact solution from the present state of `world`, if it is known for every body.
    pub fn exact(world: &World) -> Option<Self> {
        let mut exact = Exact::of(world);
        let movable = (0..world.len()).any(|i| world.kind(i).is_movable());
        let dt = world.settings().dt;
        let known = movable && exact.knows_all(world.time());
        known.then(|| Self {
            exact,
            reference: Reference::of(world),
            world: world.clone(),
            course: Course::Exact {
                start: world.time(),
                noted: 0,
                apart: dt / (dt * EXACT_RATE).ceil(),
            },
            profiled: false,
        })
    }

    /// Simulated time reached, s.
    pub fn time(&self) -> f64 {
        match self.course {
            Course::Steps => self.world.time(),
            Course::Exact {
                start,
                noted,
                apart,
            } => start + noted as f64 * apart,
        }
    }

    /// The world that it steps, or the world that represents the exact solution.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The drift since the start.
    pub fn drift(&self) -> Drift {
        self.reference.drift(&self.world)
    }

    /// The present state, reached by a step that took `cost`, s, with so many impacts.
    pub fn snapshot(&mut self, cost: Option<f64>, impacts: u64) -> Snapshot {
        let error = match self.course {
            Course::Steps => self.exact.error(&self.world),
            Course::Exact { .. } => Some(0.0),
        };
        let mut sample = Sample::of(&self.world, error, cost, impacts);
        sample.time = self.time();
        if let Course::Exact { noted, .. } = self.course {
            sample.steps = noted;
        }
        let world = &self.world;
        Snapshot {
            sample,
            places: (0..world.len()).map(|i| world.origin(i)).collect(),
            rotations: rotations(world),
        }
    }

    /// Advances to the next state.
    pub fn step(&mut self, stopwatch: &impl Fn() -> Duration) -> Result<Snapshot, Halt> {
        let Course::Exact {
            start,
            noted,
            apart,
        } = self.course
        else {
            let mut impacts = Vec::new();
            let before = stopwatch();
            let mut profile = self.profiled.then(Profile::default);
            match &mut profile {
                Some(profile) => self.world.step_profiled(&mut impacts, nanoseconds, profile),
                None => self.world.step_reporting(&mut impacts),
            }
            .map_err(Halt::Step)?;
            let cost = stopwatch().saturating_sub(before).as_secs_f64();
            let mut snapshot = self.snapshot(Some(cost), impacts.len() as u64);
            snapshot.sample = snapshot.sample.with_profile(profile);
            return Ok(snapshot);
        };
        let time = start + (noted + 1) as f64 * apart;
        self.exact.watch(time, apart);
        for i in 0..self.world.len() {
            let (place, velocity) = self.exact.at(i, time).ok_or(Halt::Unknown)?;
            let placed = self.world.set_position(i, place);
            let moving = placed.and_then(|()| self.world.set_velocity(i, velocity));
            moving.map_err(|_| Halt::Unknown)?;
        }
        self.course = Course::Exact {
            start,
            noted: noted + 1,
            apart,
        };
        Ok(self.snapshot(None, 0))
    }
}

/// The rotations of the bodies of a world; empty if there are no turning bodies.
fn rotations(world: &World) -> Box<[DQuat]> {
    let bodies = 0..world.len();
    match bodies.clone().any(|i| world.turns(i)) {
        true => bodies.map(|i| world.rotation(i)).collect(),
        false => Box::default(),
    }
}
