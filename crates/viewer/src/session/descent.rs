//! How two hierarchies determine whether two meshes meet, level by level, for teaching: the pairs of boxes compared,
//! and the pairs that are candidates for the next level.
//!
//! This is the textbook descent through the trees of the program. The program's own descent processes many pairs at
//! once, in another order, and stops at the first hit.

use sim_core::{Aabb, Bvh, DMat3, DQuat, DVec3};

use super::compare::placed;
use super::{Contest, Session};
use crate::picture::Line;

/// The number of pairs of one level above which the descent stops.
const MOST_PAIRS: usize = 20_000;
const MEET: [f32; 4] = [0.92, 0.35, 0.0, 0.95];
const APART: [f32; 4] = [0.20, 0.34, 0.58, 0.65];

/// One level of the descent.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Level {
    /// Pairs of boxes compared.
    pub compared: usize,
    /// The pairs that meet.
    pub meeting: usize,
    /// Boxes of the first and of the second mesh, by their index in [`Bvh::boxes`], and whether one of their pairs
    /// meets.
    boxes: [Vec<(usize, bool)>; 2],
}

/// One comparison of the descent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pair {
    /// The boxes, by their indices in [`Bvh::boxes`].
    boxes: [usize; 2],
    /// Whether they meet.
    pub meet: bool,
    /// The number of pairs of their children, compared next if the boxes meet; 0 if neither box has children, and
    /// triangles are tested instead.
    pub below: usize,
}

/// The placement of the second tree in the frame of the first.
struct At {
    turned: DMat3,
    offset: DVec3,
}

impl At {
    fn new((rotation, offset): (DQuat, DVec3)) -> Self {
        Self {
            turned: DMat3::from_quat(rotation),
            offset,
        }
    }
}

/// The boxes of a tree in the order of [`Bvh::boxes`], each with the indices of its children.
struct Tree {
    boxes: Vec<Aabb>,
    children: Vec<Vec<usize>>,
    /// The indices in order.
    itself: Vec<usize>,
}

impl Tree {
    fn of(bvh: &Bvh) -> Self {
        let (mut boxes, mut children) = (Vec::new(), Vec::new());
        // Each box precedes the boxes in it.
        let mut path: Vec<usize> = Vec::new();
        for (n, (level, aabb)) in bvh.boxes().enumerate() {
            path.truncate(level);
            if let Some(&parent) = path.last() {
                let siblings: &mut Vec<usize> = &mut children[parent];
                siblings.push(n);
            }
            path.push(n);
            boxes.push(aabb);
            children.push(Vec::new());
        }
        Self {
            itself: (0..boxes.len()).collect(),
            boxes,
            children,
        }
    }

    /// The boxes compared on the next level: the children, or the box itself if it is a leaf.
    fn below(&self, n: usize) -> &[usize] {
        match self.children[n].is_empty() {
            true => &self.itself[n..=n],
            false => &self.children[n],
        }
    }

    /// The pairs after two boxes that meet; none after two leaves.
    fn after(&self, other: &Self, [a, b]: [usize; 2]) -> Vec<[usize; 2]> {
        if self.children[a].is_empty() && other.children[b].is_empty() {
            return Vec::new();
        }
        let others = other.below(b);
        let all = self.below(a).iter();
        all.flat_map(|&a| others.iter().map(move |&b| [a, b]))
            .collect()
    }

    /// Whether a box meets one of another mesh. If that mesh is rotated, its box is replaced by the bounding box along
    /// the axes of the first.
    fn meets(&self, other: &Self, [a, b]: [usize; 2], at: &At) -> bool {
        let (a, b) = (self.boxes[a], other.boxes[b]);
        let apart = at.turned * b.centre() + at.offset - a.centre();
        let reach = a.half_extent() + at.turned.abs() * b.half_extent();
        apart.abs().cmple(reach).all()
    }
}

/// All comparisons in depth-first order, as in a search for all hits. The second tree is rotated, then translated.
pub fn pairs(first: &Bvh, second: &Bvh, placed: (DQuat, DVec3)) -> Vec<Pair> {
    let (first, second, at) = (Tree::of(first), Tree::of(second), At::new(placed));
    let mut left = vec![[0, 0]];
    let mut pairs = Vec::new();
    while let Some(boxes) = left.pop() {
        if pairs.len() == MOST_PAIRS {
            break;
        }
        let meet = first.meets(&second, boxes, &at);
        let after = first.after(&second, boxes);
        pairs.push(Pair {
            boxes,
            meet,
            below: after.len(),
        });
        if meet {
            left.extend(after.into_iter().rev());
        }
    }
    pairs
}

/// All levels, from the two root boxes to pairs of leaves; the second tree is rotated, then translated.
pub fn descent(first: &Bvh, second: &Bvh, placed: (DQuat, DVec3)) -> Vec<Level> {
    let (first, second, at) = (Tree::of(first), Tree::of(second), At::new(placed));
    let mut pairs = vec![[0, 0]];
    let mut levels = Vec::new();
    while !pairs.is_empty() && pairs.len() <= MOST_PAIRS {
        let meets = |&&pair: &&[usize; 2]| first.meets(&second, pair, &at);
        let meeting: Vec<[usize; 2]> = pairs.iter().filter(meets).copied().collect();
        let listed = |of: usize| {
            let mut boxes: Vec<(usize, bool)> = pairs.iter().map(|p| (p[of], false)).collect();
            boxes.extend(meeting.iter().map(|p| (p[of], true)));
            // The last entry of each box says whether any of its pairs meets.
            boxes.sort_unstable();
            boxes.dedup_by(|later, kept| {
                let same = later.0 == kept.0;
                kept.1 |= same && later.1;
                same
            });
            boxes
        };
        levels.push(Level {
            compared: pairs.len(),
            meeting: meeting.len(),
            boxes: [listed(0), listed(1)],
        });
        // Both trees descend; a leaf is compared again until the other tree reaches its leaves.
        let below = meeting.iter().flat_map(|&pair| first.after(&second, pair));
        pairs = below.collect();
    }
    levels
}

impl Session {
    /// The descent for the two compared bodies in their present state.
    pub fn descent(&mut self) -> Vec<Level> {
        self.descend(descent).unwrap_or_default()
    }

    /// The comparisons of that descent in order.
    pub fn pairs(&mut self) -> Vec<Pair> {
        self.descend(pairs).unwrap_or_default()
    }

    /// Applies `look` to the trees of the two compared bodies.
    fn descend<T>(&mut self, look: impl Fn(&Bvh, &Bvh, (DQuat, DVec3)) -> T) -> Option<T> {
        let (Contest::Pair(i, j) | Contest::Apart(i, j)) = self.contest() else {
            return None;
        };
        self.world.build_bvhs();
        let at = placed(&self.world, i, j);
        Some(look(self.world.bvh(i)?, self.world.bvh(j)?, at))
    }

    /// Moves up or down by levels in the descent; shows it if it was hidden.
    pub fn step_descent(&mut self, by: isize) {
        let deepest = self.descent().len().saturating_sub(1);
        self.display.pair = None;
        let shown = &mut self.display.descent;
        *shown = Some(shown.map_or(0, |level| level.saturating_add_signed(by).min(deepest)));
    }

    /// Moves to the next or a previous comparison of the descent, or begins with the first.
    pub fn step_pair(&mut self, by: isize) {
        let last = self.pairs().len().saturating_sub(1);
        self.display.descent.get_or_insert(0);
        let shown = &mut self.display.pair;
        *shown = Some(shown.map_or(0, |pair| pair.saturating_add_signed(by).min(last)));
    }

    /// Adds the boxes of the shown level, those that are candidates for the next one and the others. For a single
    /// comparison: its boxes, among those found to meet before.
    pub(super) fn add_descent(&mut self, lines: &mut Vec<Line>) {
        let Some(shown) = self.display.descent else {
            return;
        };
        let (Contest::Pair(i, j) | Contest::Apart(i, j)) = self.contest() else {
            return;
        };
        let listed = match self.display.pair {
            None => self.level_boxes(shown),
            Some(shown) => self.pair_boxes(shown),
        };
        for (body, listed) in [i, j].into_iter().zip(listed) {
            let Some(bvh) = self.world.bvh(body) else {
                continue;
            };
            let boxes: Vec<Aabb> = bvh.boxes().map(|(_, aabb)| aabb).collect();
            let (origin, rotation) = (self.world.origin(body), self.world.rotation(body));
            for (n, colour, width) in listed {
                let (middle, half) = (boxes[n].centre(), boxes[n].half_extent());
                let edges = super::overlaps::edges(middle, half);
                lines.extend(edges.map(|(from, to)| Line {
                    from: origin + rotation * from,
                    to: origin + rotation * to,
                    colour,
                    width,
                }));
            }
        }
    }

    fn level_boxes(&mut self, shown: usize) -> [Vec<Drawn>; 2] {
        let levels = self.descent();
        let Some(level) = levels.get(shown.min(levels.len().saturating_sub(1))) else {
            return Default::default();
        };
        let drawn = |&(n, meets): &(usize, bool)| match meets {
            true => (n, MEET, 2.2),
            false => (n, APART, 1.5),
        };
        let of = |which: usize| level.boxes[which].iter().map(drawn).collect();
        [of(0), of(1)]
    }

    fn pair_boxes(&mut self, shown: usize) -> [Vec<Drawn>; 2] {
        let pairs = self.pairs();
        let Some(now) = pairs.get(shown.min(pairs.len().saturating_sub(1))) else {
            return Default::default();
        };
        let before = &pairs[..shown.min(pairs.len())];
        let of = |which: usize| {
            let mut met: Vec<usize> = before
                .iter()
                .filter(|pair| pair.meet)
                .map(|pair| pair.boxes[which])
                .collect();
            met.sort_unstable();
            met.dedup();
            let [red, green, blue, _] = MEET;
            let faint = [red, green, blue, 0.35];
            let now = (now.boxes[which], if now.meet { MEET } else { APART }, 4.0);
            met.into_iter()
                .map(|n| (n, faint, 1.0))
                .chain([now])
                .collect()
        };
        [of(0), of(1)]
    }
}

/// The index of a box in a tree, its colour, and the width of its edges.
type Drawn = (usize, [f32; 4], f32);
