//! Tunnelling, which the discrete modes do not see: bodies that have passed through each other within a step.
//!
//! Between two sampled states the bodies are assumed to move straight. An exact test decides whether they touch on the
//! way, as in the continuous mode. Pairs with a turning body are left out.

use sim_core::{Collision, DQuat, DVec3, Impact, World, query};

use super::Session;
use crate::number;
use crate::picture::{Ghost, Line};

/// The most bodies for which the search is made.
const MOST_BODIES: usize = 64;
/// The most results for one step.
const MOST: usize = 8;
/// The simulated time for which a result is shown, s, and the least number of steps.
const SHOWN: f64 = 0.5;
const SHOWN_STEPS: f64 = 3.0;
/// The least relative displacement for the search, in thicknesses of the thinner swept box.
const LEAST_WAY: f64 = 0.01;
const RED: [f32; 3] = [0.86, 0.08, 0.10];

/// Two bodies that have passed through each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Missed {
    /// The bodies; the second one moved farther.
    pub bodies: (usize, usize),
    /// The time of contact, s.
    pub time: f64,
    /// Positions of the second body before the step, at the contact, and after the step, m.
    pub places: [DVec3; 3],
    /// The contact point, m.
    pub point: DVec3,
    /// Displacement of the second body relative to the first in the step, m.
    pub way: f64,
    /// Thickness of the thinner body along that displacement, m.
    pub thickness: f64,
}

/// All impacts that the last step of `world` missed; `impacts` are those that it found.
pub(super) fn missed(world: &mut World, impacts: &[Impact]) -> Vec<Missed> {
    let discrete = world.settings().collision != Collision::Continuous;
    if !discrete || world.len() > MOST_BODIES {
        return Vec::new();
    }
    let mut found = Vec::new();
    for i in 0..world.len() {
        for j in i + 1..world.len() {
            let known = world.overlapping().contains(&(i, j))
                || impacts.iter().any(|impact| impact.bodies == (i, j));
            if known || !may_touch(world, i, j) || found.len() == MOST {
                continue;
            }
            world.build_bvhs();
            found.extend(passed(world, i, j));
        }
    }
    found
}

/// Displacement of a body in the last step, m.
fn way(world: &World, i: usize) -> DVec3 {
    world.position(i) - world.previous_position(i)
}

/// Whether two bodies may collide: by their groups, and because their swept boxes of the last step meet.
fn may_touch(world: &World, i: usize, j: usize) -> bool {
    // Turning bodies do not move on straight paths.
    if !world.groups(i).collide(world.groups(j)) || world.turns(i) || world.turns(j) {
        return false;
    }
    let swept = |i: usize| {
        let (low, high) = extent(world, i)?;
        let (from, to) = (world.previous_position(i), world.position(i));
        Some((from.min(to) + low, from.max(to) + high))
    };
    let (Some(first), Some(second)) = (swept(i), swept(j)) else {
        return false;
    };
    // A body that moves less than a small fraction of the thinner one's thickness cannot pass farther than that. So
    // heaps of bodies that hardly move are not searched.
    let thickness = [first, second].map(|(low, high)| (high - low).min_element());
    let past = (way(world, i) - way(world, j)).length();
    past > LEAST_WAY * thickness[0].min(thickness[1])
        && first.0.cmple(second.1).all()
        && second.0.cmple(first.1).all()
}

/// A body's box about its position, m; `None` if it has no interior or is infinite.
fn extent(world: &World, i: usize) -> Option<(DVec3, DVec3)> {
    let [low, high] = world.shape(i)?.bounds()?;
    Some((low, high))
}

/// The first contact on the way, if there is one.
fn passed(world: &World, i: usize, j: usize) -> Option<Missed> {
    // The body that moves farther counts as the passing one.
    let farther = way(world, j).length() >= way(world, i).length();
    let (still, mover) = if farther { (i, j) } else { (j, i) };
    let motion = way(world, mover) - way(world, still);
    let placed = |i: usize| world.placed(i)?.at(world.previous_position(i)).ok();
    let (first, second) = (placed(still)?, placed(mover)?);
    // Overlaps are reported elsewhere.
    if query::intersects(first, second) {
        return None;
    }
    let hit = query::time_of_impact(first, second, motion).ok()??;
    let part = hit.time;
    let dt = world.settings().dt;
    let direction = motion.normalize();
    let thickness = |i: usize| {
        let (low, high) = extent(world, i)?;
        Some((high - low).dot(direction.abs()))
    };
    let before = world.previous_position(mover);
    Some(Missed {
        bodies: (still, mover),
        time: world.time() - (1.0 - part) * dt,
        places: [
            before,
            before + part * way(world, mover),
            world.position(mover),
        ],
        point: hit.points[0] + part * way(world, still),
        way: motion.length(),
        thickness: thickness(still)?.min(thickness(mover)?),
    })
}

impl Missed {
    /// A description with the names of the bodies.
    pub(super) fn text(&self, name: impl Fn(usize) -> String) -> String {
        let (still, mover) = self.bodies;
        format!(
            "{} passed through {} at t = {:.4} s: a step of {} past {}.",
            name(mover),
            name(still),
            self.time,
            number::length(self.way),
            number::length(self.thickness),
        )
    }
}

impl Session {
    /// Draws recent results: the body before and after the step, the path between, and the contact on it.
    pub(super) fn add_missed(
        &mut self,
        ghosts: &mut Vec<Ghost>,
        lines: &mut Vec<Line>,
        marks: &mut Vec<Line>,
    ) {
        let (now, seen) = (self.world.time(), self.shown_time());
        let shown = SHOWN.max(SHOWN_STEPS * self.world.settings().dt);
        let late: Vec<Missed> = self
            .playback
            .past()
            .rev()
            .take_while(|moment| now - moment.world.time() < shown)
            .flat_map(|moment| moment.missed.iter().cloned())
            .filter(|missed| missed.time <= seen)
            .take(MOST)
            .collect();
        for missed in late {
            let [red, green, blue] = RED;
            let colour = [red, green, blue, 1.0];
            let [from, at, to] = missed.places;
            if let Some(mesh) = self.body_mesh(missed.bodies.1) {
                ghosts.extend(missed.places.map(|position| Ghost {
                    mesh: mesh.clone(),
                    position,
                    // Neither body rotates.
                    rotation: DQuat::IDENTITY,
                    colour: RED,
                }));
            }
            if let Some((low, high)) = extent(&self.world, missed.bodies.1) {
                // The swept box: its edges along the motion.
                for corner in 0..8 {
                    let pick = |bit: usize, low: f64, high: f64| match corner >> bit & 1 {
                        0 => low,
                        _ => high,
                    };
                    let corner = DVec3::new(
                        pick(0, low.x, high.x),
                        pick(1, low.y, high.y),
                        pick(2, low.z, high.z),
                    );
                    lines.push(Line {
                        from: from + corner,
                        to: to + corner,
                        colour: [red, green, blue, 0.7],
                        width: 1.3,
                    });
                }
            }
            let mut mark = |from, to, width| {
                marks.push(Line {
                    from,
                    to,
                    colour,
                    width,
                })
            };
            mark(missed.point, missed.point, 11.0);
            mark(from, at, 2.0);
        }
    }
}
