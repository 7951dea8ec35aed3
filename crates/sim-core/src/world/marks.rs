//! States of a motion while it grows, for the error of an unstable step.

use alloc::vec::Vec;
use core::ops::Range;
use glam::DVec3;

#[cfg(feature = "serde")]
use super::error::LARGEST;
use super::state::State;

/// Growth of the greatest speed after which the motion is kept again.
const DOUBLED: f64 = 2.0;

/// Times that the greatest speed can double until it has grown a millionfold, and growth is counted
/// anew.
const MOST: usize = 20;

/// The motion from which growth is counted, and that of what is fastest each time that the greatest
/// speed has doubled since.
#[derive(Clone, Debug, Default)]
pub(super) struct Marks {
    marks: Vec<Mark>,
    /// What is kept of all of them, one after the other.
    motion: State,
}

/// A mark as data.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KeptMotion {
    time: f64,
    speed: f64,
    first: usize,
    /// Position and velocity of that body, and of those after it.
    motion: Vec<(DVec3, DVec3)>,
}

#[cfg(feature = "serde")]
impl Marks {
    pub(super) fn kept(&self) -> Vec<KeptMotion> {
        let kept = |mark: &Mark| {
            let all = mark.start..mark.start + mark.bodies.len();
            let (x, v) = (&self.motion.position, &self.motion.velocity);
            KeptMotion {
                time: mark.time,
                speed: mark.speed,
                first: mark.bodies.start,
                motion: all.map(|place| (x[place], v[place])).collect(),
            }
        };
        self.marks.iter().map(kept).collect()
    }

    /// Of so many bodies; `None` if it is no motion of theirs.
    pub(super) fn of_kept(kept: Vec<KeptMotion>, bodies: usize) -> Option<Marks> {
        let mut marks = Marks::default();
        for mark in kept {
            let end = mark.first.checked_add(mark.motion.len())?;
            let start = marks.motion.position.len();
            for (position, velocity) in mark.motion {
                marks.motion.push(position, velocity);
            }
            let all = start..marks.motion.position.len();
            let is_number = |number: f64| number.abs() <= LARGEST;
            let is_sound = end <= bodies
                && marks.motion.beyond(all, LARGEST).is_none()
                && is_number(mark.time)
                && is_number(mark.speed);
            marks.marks.push(is_sound.then_some(Mark {
                time: mark.time,
                speed: mark.speed,
                bodies: mark.first..end,
                start,
            })?);
        }
        Some(marks)
    }
}

#[derive(Clone, Debug)]
struct Mark {
    time: f64,
    /// Greatest component of a velocity a step later, m/s.
    speed: f64,
    bodies: Range<usize>,
    /// Where their motion begins among all that is kept.
    start: usize,
}

impl Marks {
    /// Forgets all, and makes room for marks of all bodies once and then of up to `most` of them.
    pub(super) fn begin(&mut self, all: usize, most: usize) {
        self.marks.clear();
        self.motion.position.clear();
        self.motion.velocity.clear();
        self.marks.reserve(1 + MOST);
        self.motion.position.reserve(all + MOST * most);
        self.motion.velocity.reserve(all + MOST * most);
    }

    /// Whether a greatest speed is a reason to keep the motion that has led to it.
    pub(super) fn is_due(&self, speed: f64) -> bool {
        let last = self.marks.last();
        last.is_some_and(|mark| speed > DOUBLED * mark.speed)
    }

    /// Keeps the motion of some bodies, which leads to a greatest speed in a step.
    pub(super) fn add(&mut self, time: f64, speed: f64, bodies: Range<usize>, motion: &State) {
        let start = self.motion.position.len();
        let (x, v) = (&motion.position, &motion.velocity);
        self.motion.position.extend_from_slice(&x[bodies.clone()]);
        self.motion.velocity.extend_from_slice(&v[bodies.clone()]);
        self.marks.push(Mark {
            time,
            speed,
            bodies,
            start,
        });
    }

    /// Times, positions and velocities of some bodies wherever all of them were kept.
    pub(super) fn of(
        &self,
        bodies: Range<usize>,
    ) -> impl Iterator<Item = (f64, &[DVec3], &[DVec3])> {
        self.marks.iter().filter_map(move |mark| {
            if bodies.start < mark.bodies.start || mark.bodies.end < bodies.end {
                return None;
            }
            let start = mark.start + bodies.start - mark.bodies.start;
            let kept = start..start + bodies.len();
            let (x, v) = (&self.motion.position, &self.motion.velocity);
            Some((mark.time, &x[kept.clone()], &v[kept]))
        })
    }
}
