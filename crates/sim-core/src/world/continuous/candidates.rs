//! The search for pairs that come near each other on their trajectories.

use alloc::vec::Vec;
use core::mem;

use super::super::{profile::Phase, stepping::Cause};
use super::{event_loop::EventLoop, solver::ContactSolver, view::View};
use crate::{
    Extent,
    collide::{Broad, Front, Swept},
};

/// The neighbours of bodies, kept for the step and for later ones.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbours {
    pub(super) broad: Broad,
    /// Whether `broad` knows the neighbours of the bodies at their positions, because no body was placed since it was
    /// filled.
    pub(super) knows_near: bool,
    /// Pairs that have come near in this step.
    pub(super) candidate_pairs: Vec<(usize, usize)>,
    /// Memory for the neighbours of a body.
    pub(super) partners: Vec<usize>,
}

/// The number of pairs that may be listed before the list is sorted and duplicates are removed.
const MAX_LISTED: usize = 1 << 16;

impl Neighbours {
    /// Removes duplicates if very many pairs are listed.
    pub(super) fn shorten(&mut self) {
        if self.candidate_pairs.len() > MAX_LISTED {
            self.candidate_pairs.sort_unstable();
            self.candidate_pairs.dedup();
        }
    }
}

impl View<'_> {
    /// A box around a body along its whole trajectory.
    fn swept(&self, body: usize) -> Swept {
        // Two calls, so that the common one keeps the extent in registers.
        match self.scene.bodies.turners.is_empty() {
            true => self.swept_within(body, self.scene.bodies.extent(body)),
            false => self.swept_within(body, self.scene.bodies.extent_however_turned(body)),
        }
    }

    #[inline(always)]
    fn swept_within(&self, body: usize, extent: Extent) -> Swept {
        let (from, to) = (
            self.paths.start.position[body],
            self.paths.end.position[body],
        );
        let Extent {
            low,
            high,
            farthest,
            ..
        } = extent;
        // The margin is more than rounding, here and in the placing of vertices, and more than a search goes beyond
        // the end of the step. It also covers the displacement of bodies when other overlapping bodies are moved
        // apart.
        let bend = self.motion().chord_deviation(body);
        let size = (from.abs() + to.abs() + 4.0 * bend + 2.0 * farthest).max_element();
        let reach = bend + 8192.0 * f64::EPSILON * size;
        Swept {
            min: from.min(to) + low - reach,
            max: from.max(to) + high + reach,
            body,
        }
    }

    /// The farthest position of the plane of a body along its trajectory, if the body is a half-space.
    fn front(&self, wall: usize) -> Option<Front> {
        let (from, to) = (&self.paths.start.position, &self.paths.end.position);
        let mut front = self.scene.bodies.swept_front(wall, from[wall], to[wall])?;
        let deviation = self.motion().chord_deviation(wall);
        front.level += deviation.dot(front.normal.abs());
        Some(front)
    }
}

impl ContactSolver<'_> {
    /// Whether the neighbours of bodies at their positions are known. A copy of a world computes them again.
    pub(super) fn knows_near(&mut self) -> bool {
        if self.near.knows_near && self.near.broad.is_empty() {
            let mut broad = mem::take(&mut self.near.broad);
            let view = self.view();
            broad.fill(
                &view.scene.bodies.solid,
                |body| view.swept(body),
                |body| view.front(body),
            );
            self.near.broad = broad;
        }
        self.near.knows_near
    }
}

impl EventLoop<'_> {
    /// Finds the pairs whose swept boxes meet.
    pub(super) fn find_candidate_pairs(&mut self) {
        let mut broad = mem::take(&mut self.solver.near.broad);
        let mut pairs = mem::take(&mut self.solver.near.candidate_pairs);
        let view = self.view();
        broad.fill(
            &view.scene.bodies.solid,
            |body| view.swept(body),
            |body| view.front(body),
        );
        pairs.clear();
        broad.each_pair(|i, j| pairs.push((i, j)));
        pairs.retain(|&(i, j)| self.solver.scene.may_collide(i, j));
        let count = pairs.len();
        self.solver.near.broad = broad;
        self.solver.near.knows_near = true;
        self.solver.near.candidate_pairs = pairs;
        for place in 0..count {
            let (i, j) = self.solver.near.candidate_pairs[place];
            self.solver.scene.bodies.need_bvh(i);
            self.solver.scene.bodies.need_bvh(j);
        }
    }

    /// Replaces the swept box of a body by that of its new trajectory.
    pub(super) fn update_swept(&mut self, body: usize) {
        if let Some(front) = self.view().front(body) {
            self.solver.near.broad.replace_front(front);
        } else if self.solver.scene.bodies.has_shape(body) {
            let swept = self.view().swept(body);
            self.solver.near.broad.replace(swept);
        }
    }

    /// Finds the next impacts of a body whose trajectory is new. A pair of two such bodies is searched once.
    pub(super) fn find_impacts_of(
        &mut self,
        body: usize,
        restarted: &[usize],
    ) -> Result<(), (usize, Cause)> {
        if !self.solver.scene.bodies.has_shape(body) {
            return Ok(());
        }
        let phase = self.record.enter(Phase::Narrow);
        let mut partners = mem::take(&mut self.solver.near.partners);
        partners.clear();
        let broad = &self.solver.near.broad;
        broad.each_partner(body, |other| partners.push(other));
        for &other in &partners {
            let pair = (body.min(other), body.max(other));
            let is_asked = other < body && restarted.binary_search(&other).is_ok();
            if is_asked || !self.solver.scene.may_collide(pair.0, pair.1) {
                continue;
            }
            self.solver.near.candidate_pairs.push(pair);
            self.solver.scene.bodies.need_bvh(body);
            self.solver.scene.bodies.need_bvh(other);
            let mut probe = mem::take(&mut self.solver.paths.probe);
            let event = self.view().find_impact(pair.0, pair.1, &mut probe);
            self.queue.work.add(mem::take(&mut probe.work));
            self.solver.paths.probe = probe;
            self.queue.waiting.extend(event?);
            self.queue.work.check(pair, self.solver.scene.bodies)?;
        }
        self.solver.near.partners = partners;
        self.record.enter(phase);
        Ok(())
    }
}
