//! The states of a growing motion, for the error of an unstable step.

use alloc::vec::Vec;
use core::ops::Range;
use glam::DVec3;

#[cfg(feature = "serde")]
use super::error::LARGEST;
use super::state::State;

/// The motion is stored again when the greatest speed has grown by this factor.
const DOUBLED: f64 = 2.0;

/// The greatest speed can double this often until it has grown a millionfold and growth is measured anew.
const MOST: usize = 20;

/// The motion from which growth is measured, and the motion of the fastest bodies each time that the greatest speed has
/// doubled since.
#[derive(Clone, Debug, Default)]
pub(super) struct Marks {
    marks: Vec<Mark>,
    /// The motions of all marks, one after the other.
    motion: State,
}

/// A mark as data of a snapshot.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KeptMotion {
    time: f64,
    speed: f64,
    first: usize,
    /// Positions and velocities of that body and of the bodies after it.
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

    /// The marks of a snapshot; `None` if they do not fit the number of bodies.
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
    /// The greatest component of a velocity one step later, m/s.
    speed: f64,
    bodies: Range<usize>,
    /// The start of these bodies' motion in `Marks::motion`.
    start: usize,
}

impl Marks {
    /// Removes all marks, and reserves memory for one mark of all bodies and then for marks of up to `most` bodies.
    pub(super) fn begin(&mut self, all: usize, most: usize) {
        self.marks.clear();
        self.motion.position.clear();
        self.motion.velocity.clear();
        self.marks.reserve(1 + MOST);
        self.motion.position.reserve(all + MOST * most);
        self.motion.velocity.reserve(all + MOST * most);
    }

    /// Whether the greatest speed has grown so much that the motion before it should be stored.
    pub(super) fn is_due(&self, speed: f64) -> bool {
        let last = self.marks.last();
        last.is_some_and(|mark| speed > DOUBLED * mark.speed)
    }

    /// Stores the motion of some bodies, after which a step reaches a greatest speed.
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

    /// Times, positions and velocities of some bodies from each mark that has all of them.
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
