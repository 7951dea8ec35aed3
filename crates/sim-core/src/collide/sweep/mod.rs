//! The search for the first contact of two trees, one of which moves.
//!
//! The search visits pairs of boxes in the order in which they begin to meet ([`boxes`]), until that time is after the
//! first contact so far. Pairs of triangles give contacts of features ([`features`]), in exact arithmetic if f64
//! leaves a doubt. Of contacts at the same time, the first one in a fixed order counts ([`candidate`]). At the borders
//! of faces, only contacts that block the motion count ([`border`]).

mod border;
mod boxes;
mod candidate;
mod features;
mod near;
mod seen;

use core::cmp::Ordering;
use glam::DVec3;

use super::{pairs::TILE, touch::Touch};
use crate::bvh::{Bvh, LEAF, Node, WIDTH};
use border::Around;
use boxes::Moving;
use candidate::Candidate;
pub(super) use candidate::opposing_cmp;
use features::View;
pub(crate) use near::{Curve, stay_apart};

/// The contacts that count.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Contacts whose normal opposes the motion: they block it.
    Entering,
    /// All contacts except those of two edges in a plane parallel to the motion.
    Any,
}

/// Up to this many pairs of triangles are tested one by one, without the test in lanes first.
const FEW: u32 = 2;

pub(super) struct Search<'a> {
    first: &'a Bvh,
    second: &'a Bvh,
    offset: DVec3,
    motion: DVec3,
    kind: Kind,
    boxes: Moving,
    view: View,
    /// No contact after this time is the first one.
    horizon: f64,
    best: Option<Candidate>,
    /// The first time at which a vertex slides into a triangle, rounded down.
    slide: Option<f64>,
    around: Around,
    /// Whether the meshes meet at the start, once that was needed.
    meet_at_start: Option<bool>,
}

impl<'a> Search<'a> {
    /// Looks for contacts within the motion.
    pub(super) fn run(
        kind: Kind,
        (first, second): (&'a Bvh, &'a Bvh),
        offset: DVec3,
        motion: DVec3,
    ) -> Search<'a> {
        let mut search = Search {
            first,
            second,
            offset,
            motion,
            kind,
            boxes: Moving::new(first, second, offset, motion),
            view: View::new(first, second, offset, motion),
            horizon: 1.0,
            best: None,
            slide: None,
            around: Around::default(),
            meet_at_start: None,
        };
        if motion != DVec3::ZERO {
            search.visit(first.root(), second.root());
        }
        search
    }

    /// The first contact; [`candidate`] orders contacts at the same time.
    pub(super) fn best(mut self) -> Option<Touch> {
        let mut best = self.best.take()?;
        let time = best.rounded();
        let beside = self.normal_beside(&best);
        Some(Touch {
            time,
            point: best.point + time * best.drift,
            normal: beside.unwrap_or_else(|| best.normal()),
            feature: best.feature,
        })
    }

    /// The time of the first contact.
    pub(super) fn time(self) -> Option<f64> {
        let crossing = self.best.map(|mut best| best.rounded());
        crossing
            .into_iter()
            .chain(self.slide)
            .min_by(f64::total_cmp)
    }

    /// Visits all pairs below two nodes or leaves, in the order in which their boxes meet. If only one of the two is
    /// a leaf, the leaf is passed on as a whole to the children of the node, once for all its triangles.
    fn visit(&mut self, a: u32, b: u32) {
        let (node, other) = (self.first.node(a), self.second.node(b));
        let (mut pairs, enter) = self.boxes.meet(&node.boxes, &other.boxes, self.horizon);
        if (a ^ b) & LEAF != 0 {
            pairs = self.not_parted(pairs, (a, node), other);
        }
        if pairs == 0 {
            return;
        }
        let among = match (a & LEAF == 0, b & LEAF == 0) {
            (true, false) => Among::Rows,
            (false, true) => Among::Columns,
            _ => Among::Pairs,
        };
        let is_leaves = a & b & LEAF != 0;
        if is_leaves && pairs.count_ones() > FEW {
            let of_first = (&node.boxes, self.first.triangles(node));
            let of_second = (&other.boxes, self.second.triangles(other));
            pairs &= !self.boxes.parted(of_first, of_second, self.horizon);
        }
        let (list, count) = in_order(pairs, &enter, among);
        for &(soonest, lane) in &list[..count] {
            // Below the normal numbers, quotients lose no more than this.
            if f64::from(soonest) > self.horizon + f64::from(f32::MIN_POSITIVE) {
                return;
            }
            let (i, j) = (lane as usize / WIDTH, lane as usize % WIDTH);
            if is_leaves {
                self.try_triangles((node, i), (other, j));
            } else {
                self.visit(node.child[i], other.child[j]);
            }
        }
    }

    /// The pairs of a triangle (in the leaf) and a box (in the node) in which the box does not stay on one side of the
    /// triangle's plane. The box of a large triangle says little about where the triangle is.
    fn not_parted(&self, pairs: u32, (a, first): (u32, &Node), second: &Node) -> u32 {
        let (mut left, mut kept) = (pairs, 0);
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let (i, j) = (lane / WIDTH, lane % WIDTH);
            let is_first_leaf = a & LEAF != 0;
            let (mesh, leaf, node, of_leaf, of_node, way) = match is_first_leaf {
                true => (self.first, first, second, i, j, 1.0),
                false => (self.second, second, first, j, i, -1.0),
            };
            let (to_leaf, to_box) = match is_first_leaf {
                true => (DVec3::ZERO, self.offset),
                false => (self.offset, DVec3::ZERO),
            };
            let corners = mesh.triangles(leaf).corners(of_leaf);
            let corners = corners.map(|corner| corner.as_dvec3() + to_leaf);
            let of_lane = |x: &[[f32; WIDTH]; 3]| {
                DVec3::from_array([0, 1, 2].map(|axis| f64::from(x[axis][of_node])))
            };
            let placed = (
                of_lane(&node.boxes.centre) + to_box,
                of_lane(&node.boxes.half),
            );
            if !self.view.parts(corners, placed, way, self.horizon) {
                kept |= 1 << lane;
            }
        }
        kept
    }

    fn slide(&mut self, time: Option<f64>) {
        let Some(time) = time else { return };
        self.slide = Some(self.slide.map_or(time, |first| first.min(time)));
        self.horizon = self.horizon.min(time.next_up());
    }

    /// Keeps a contact if it is before the best one so far.
    fn add(&mut self, mut new: Candidate) {
        let mut is_tie = false;
        new.is_from_inside = self.comes_from_inside(&new);
        if let Some(old) = &mut self.best {
            if new.bounds.0 > old.bounds.1 {
                return;
            }
            if new.bounds.1 >= old.bounds.0 {
                let order = new.rounded().total_cmp(&old.rounded());
                is_tie = order == Ordering::Equal;
                // If rounding leaves a doubt, the new contact is the later one.
                if order == Ordering::Greater || (is_tie && !new.is_before(old)) {
                    return;
                }
            }
        }
        if self.kind == Kind::Entering && new.is_on_brink {
            if !self.counts(&mut new) {
                return;
            }
            if let Some(old) = self.best.as_mut().filter(|_| is_tie && new.is_doubtful)
                && !new.is_before(old)
            {
                return;
            }
        }
        self.horizon = self.horizon.min(new.bounds.1);
        self.best = Some(new);
    }
}

/// Which pairs of a tile are visited.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Among {
    Pairs,
    /// For each lane of the first mesh, its soonest pair.
    Rows,
    /// For each lane of the second mesh, its soonest pair.
    Columns,
}

/// The times and lanes of some pairs, soonest first, and their number.
#[inline(never)]
fn in_order(mut pairs: u32, enter: &[f32; TILE], among: Among) -> ([(f32, u32); TILE], usize) {
    let mut list = [(0.0, 0); TILE];
    let mut count = 0;
    'pairs: while pairs != 0 {
        let lane = pairs.trailing_zeros();
        pairs &= pairs - 1;
        let time = enter[lane as usize];
        let mut place = count;
        let group = |lane: u32| match among {
            Among::Pairs => TILE as u32,
            Among::Rows => lane / WIDTH as u32,
            Among::Columns => lane % WIDTH as u32,
        };
        if among != Among::Pairs
            && let Some(known) = (0..count).find(|&k| group(list[k].1) == group(lane))
        {
            if list[known].0 <= time {
                continue 'pairs;
            }
            // Removed here, and inserted again further ahead.
            place = known;
            count -= 1;
        }
        while place > 0 && list[place - 1].0 > time {
            list[place] = list[place - 1];
            place -= 1;
        }
        list[place] = (time, lane);
        count += 1;
    }
    (list, count)
}
