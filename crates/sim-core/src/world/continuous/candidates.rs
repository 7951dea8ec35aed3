//! Which pairs come near each other on their trajectories.

use alloc::vec::Vec;
use core::mem;

use super::super::{profile::Phase, stepping::Cause};
use super::{event_loop::EventLoop, solver::ContactSolver, view::View};
use crate::{
    Extent,
    collide::{Broad, Front, Swept},
};

/// What is kept of who is near whom.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbours {
    pub(super) broad: Broad,
    /// Whether that knows what is near bodies where they are: they have not been placed since.
    pub(super) knows_near: bool,
    /// Pairs that have come near in this step.
    pub(super) candidate_pairs: Vec<(usize, usize)>,
    /// Room for the bodies near one.
    pub(super) partners: Vec<usize>,
}

/// Pairs that are listed before they are sorted, and named once each.
const MAX_LISTED: usize = 1 << 16;

impl Neighbours {
    /// Names each pair once where very many are listed.
    pub(super) fn shorten(&mut self) {
        if self.candidate_pairs.len() > MAX_LISTED {
            self.candidate_pairs.sort_unstable();
            self.candidate_pairs.dedup();
        }
    }
}

impl View<'_> {
    /// A box around a body all along its trajectory.
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
        // More than is lost in rounding, here and where vertices are placed, and than a search goes beyond
        // the end of the step; and as far as bodies may be moved where others that meet are parted.
        let bend = self.motion().chord_deviation(body);
        let size = (from.abs() + to.abs() + 4.0 * bend + 2.0 * farthest).max_element();
        let reach = bend + 8192.0 * f64::EPSILON * size;
        Swept {
            min: from.min(to) + low - reach,
            max: from.max(to) + high + reach,
            body,
        }
    }

    /// The farthest that the plane of a body comes on its trajectory, if it is a half-space.
    fn front(&self, wall: usize) -> Option<Front> {
        let (from, to) = (&self.paths.start.position, &self.paths.end.position);
        let mut front = self.scene.bodies.swept_front(wall, from[wall], to[wall])?;
        let deviation = self.motion().chord_deviation(wall);
        front.level += deviation.dot(front.normal.abs());
        Some(front)
    }
}

impl ContactSolver<'_> {
    /// Whether it is known what is near bodies where they are. A copy of a world has to find it out again.
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

    /// Takes what a body sweeps on its new trajectory in the place of what it swept.
    pub(super) fn update_swept(&mut self, body: usize) {
        if let Some(front) = self.view().front(body) {
            self.solver.near.broad.replace_front(front);
        } else if self.solver.scene.bodies.has_shape(body) {
            let swept = self.view().swept(body);
            self.solver.near.broad.replace(swept);
        }
    }

    /// Finds the next impacts of a body whose trajectory is new. Of two such, the pair is asked once.
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
