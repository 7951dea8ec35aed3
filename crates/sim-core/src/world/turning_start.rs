//! Turning bodies that touch where they were placed.
//!
//! For the exact test, bodies that touch meet. A turning body that is placed in contact with another one is moved
//! away by the least translation along the normal of the contact, at most by the rounding of `f32` vertices. A deeper
//! overlap stays: the two bodies pass through each other until they are apart.

use alloc::vec::Vec;
use glam::DVec3;

use super::{World, bodies::Bodies, state::State};
use crate::{
    collide::{
        MOST_NORMALS,
        turning::{Turning, normals_within},
    },
    impulse::{Joined, project},
};

/// The most rounds. In each, a body moved away from another one may come to meet a third.
const ROUNDS: usize = 16;
/// The most halvings of the translation.
const HALVINGS: i32 = 24;

impl World {
    /// Moves turning bodies away from the bodies that they touch since they were placed.
    pub(super) fn part_turning(&mut self) {
        if self.bodies.turners.is_empty() {
            return;
        }
        let mut planes: Vec<(usize, usize, DVec3, f64)> = Vec::new();
        let start = self.previous.clone();
        for _ in 0..ROUNDS {
            let mut met = false;
            for &(i, j) in &self.overlaps.pairs {
                let meets = |state: &State| self.bodies.meet_in(state, i, j);
                if !self.bodies.pair_tumbles(i, j) || !meets(&self.previous) {
                    continue;
                }
                let most = self.layout().flush(i, j);
                let known = planes.iter_mut().find(|plane| (plane.0, plane.1) == (i, j));
                // Other planes have moved the bodies back: double the translation.
                if let Some(plane) = known {
                    plane.3 = (2.0 * plane.3).min(most);
                    met = true;
                } else if let Some((normal, by)) =
                    self.bodies.way_apart(&self.previous, (i, j), most)
                {
                    planes.push((i, j, normal, by));
                    met = true;
                }
            }
            if !met {
                break;
            }
            self.previous.position.clone_from(&start.position);
            let joined: Vec<Joined> = planes
                .iter()
                .map(|&(i, j, normal, _)| Joined {
                    bodies: (i, j),
                    normal,
                })
                .collect();
            let missing: Vec<f64> = planes.iter().map(|plane| plane.3).collect();
            let yielding: Vec<f64> = (0..self.len())
                .map(|body| match self.bodies.tumbles(body) {
                    true => 1.0 / self.bodies.mass[body],
                    false => 0.0,
                })
                .collect();
            project(&joined, &yielding, &mut self.previous.position, &missing);
        }
        for (current, (moved, from)) in self
            .current
            .position
            .iter_mut()
            .zip(self.previous.position.iter().zip(&start.position))
        {
            *current += *moved - *from;
        }
        let (bodies, previous) = (&self.bodies, &self.previous);
        self.overlaps
            .retain(|&(i, j)| !bodies.pair_tumbles(i, j) || bodies.meet_in(previous, i, j));
    }
}

impl Bodies {
    /// A normal along which a translation of at most `most`, m, separates two bodies that meet, and the length of this
    /// translation: the least one found.
    fn way_apart(&self, state: &State, (i, j): (usize, usize), most: f64) -> Option<(DVec3, f64)> {
        let place = |body: usize| (state.position[body], DVec3::ZERO, DVec3::ZERO);
        let turning = |body: usize| Turning::Still(self.rotation_in(state, body));
        let first = self.moving(i, place(i), turning(i))?;
        let second = self.moving(j, place(j), turning(j))?;
        if self.stay_in_each_other(state, (i, j), most) {
            return None;
        }
        let normals = normals_within(&first, &second, most, MOST_NORMALS);
        let line = self.line_apart(&state.position, (i, j));
        let mut tried: Vec<DVec3> = Vec::new();
        let mut least: Option<(DVec3, f64)> = None;
        let mut moved = state.clone();
        for normal in normals.into_iter().chain(line) {
            if tried.iter().any(|known| known.dot(normal) > 1.0 - 1e-9) {
                continue;
            }
            tried.push(normal);
            for halving in (0..=HALVINGS).rev() {
                let by = libm::ldexp(most, -halving);
                if least.is_some_and(|(_, known)| known <= by) {
                    break;
                }
                moved.position[j] = state.position[j] + by * normal;
                if !self.meet_in(&moved, i, j) {
                    least = Some((normal, by));
                    break;
                }
            }
            moved.position[j] = state.position[j];
        }
        // Increased by the gap that a search needs to distinguish it from a contact.
        let (normal, by) = least?;
        let size = self.extent_however_turned(i).farthest.max(0.0)
            + self.extent_however_turned(j).farthest
            + (state.position[j] - state.position[i]).length();
        Some((normal, by + SEEN * f64::EPSILON * size))
    }
}

/// The least gap that a search distinguishes from a contact, in roundings.
const SEEN: f64 = 128.0;
