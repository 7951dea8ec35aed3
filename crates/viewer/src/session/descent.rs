//! How two hierarchies answer whether two meshes meet, level by level, for teaching: which boxes are
//! compared, and which of them come into question for the next level.
//!
//! It is the descent of textbooks through the trees of the program, whose own takes many pairs at once,
//! in another order, and stops at the first hit.

use sim_core::{Aabb, Bvh, DVec3};

use super::{Contest, Session};
use crate::picture::Line;

/// Pairs of one level beyond which no further one is looked at.
const MOST_PAIRS: usize = 20_000;
const MEET: [f32; 4] = [0.92, 0.35, 0.0, 0.95];
const APART: [f32; 4] = [0.20, 0.34, 0.58, 0.65];

/// One level of the descent.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Level {
    /// Pairs of boxes compared.
    pub compared: usize,
    /// Those that meet.
    pub meeting: usize,
    /// Boxes of the first and of the second mesh, by their place among [`Bvh::boxes`], and whether one
    /// of their pairs meets.
    boxes: [Vec<(usize, bool)>; 2],
}

/// The boxes of a tree in the order of [`Bvh::boxes`], each with the places of its children.
struct Tree {
    boxes: Vec<Aabb>,
    children: Vec<Vec<usize>>,
}

impl Tree {
    fn of(bvh: &Bvh) -> Self {
        let (mut boxes, mut children) = (Vec::new(), Vec::new());
        // Each box comes before those in it.
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
        Self { boxes, children }
    }
}

/// All levels, from the two boxes around everything to pairs of leaves, with the second mesh displaced.
pub fn descent(first: &Bvh, second: &Bvh, offset: DVec3) -> Vec<Level> {
    let (first, second) = (Tree::of(first), Tree::of(second));
    let mut pairs = vec![(0, 0)];
    let mut levels = Vec::new();
    while !pairs.is_empty() && pairs.len() <= MOST_PAIRS {
        let meets = |&(a, b): &(usize, usize)| {
            let (a, b) = (first.boxes[a], second.boxes[b]);
            let apart = b.centre() + offset - a.centre();
            let reach = a.half_extent() + b.half_extent();
            apart.abs().cmple(reach).all()
        };
        let meeting: Vec<(usize, usize)> = pairs.iter().copied().filter(|p| meets(p)).collect();
        let listed = |of: fn(&(usize, usize)) -> usize| {
            let mut boxes: Vec<(usize, bool)> = pairs.iter().map(|p| (of(p), false)).collect();
            boxes.extend(meeting.iter().map(|p| (of(p), true)));
            // Of each box the last entry, which says whether any pair meets.
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
            boxes: [listed(|p| p.0), listed(|p| p.1)],
        });
        // Both go down; a leaf waits for the other to come to its leaves.
        let below = |tree: &Tree, n: usize| match tree.children[n].is_empty() {
            true => vec![n],
            false => tree.children[n].clone(),
        };
        pairs = meeting
            .iter()
            .filter(|&&(a, b)| !first.children[a].is_empty() || !second.children[b].is_empty())
            .flat_map(|&(a, b)| {
                let others = below(&second, b);
                below(&first, a)
                    .into_iter()
                    .flat_map(move |a| others.clone().into_iter().map(move |b| (a, b)))
            })
            .collect();
    }
    levels
}

impl Session {
    /// The descent for the two bodies that are compared, as they are now.
    pub fn descent(&mut self) -> Vec<Level> {
        let (Contest::Pair(i, j) | Contest::Apart(i, j)) = self.contest() else {
            return Vec::new();
        };
        self.world.build_bvhs();
        let (Some(first), Some(second)) = (self.world.bvh(i), self.world.bvh(j)) else {
            return Vec::new();
        };
        let offset = self.world.position(j) - self.world.position(i);
        descent(first, second, offset)
    }

    /// Goes up or down in the descent that is shown; shows it if it was not.
    pub fn step_descent(&mut self, by: isize) {
        let deepest = self.descent().len().saturating_sub(1);
        let shown = &mut self.display.descent;
        *shown = Some(shown.map_or(0, |level| level.saturating_add_signed(by).min(deepest)));
    }

    /// The boxes of the level shown: those that come into question for the next one, and the others.
    pub(super) fn add_descent(&mut self, lines: &mut Vec<Line>) {
        let Some(shown) = self.display.descent else {
            return;
        };
        let (Contest::Pair(i, j) | Contest::Apart(i, j)) = self.contest() else {
            return;
        };
        let levels = self.descent();
        let Some(level) = levels.get(shown.min(levels.len().saturating_sub(1))) else {
            return;
        };
        for (body, listed) in [i, j].into_iter().zip(&level.boxes) {
            let Some(bvh) = self.world.bvh(body) else {
                continue;
            };
            let boxes: Vec<Aabb> = bvh.boxes().map(|(_, aabb)| aabb).collect();
            let origin = self.world.position(body);
            for &(n, meets) in listed {
                let (middle, half) = (boxes[n].centre(), boxes[n].half_extent());
                let edges = super::overlaps::edges(middle, half);
                lines.extend(edges.map(|(from, to)| Line {
                    from: origin + from,
                    to: origin + to,
                    colour: if meets { MEET } else { APART },
                    width: if meets { 2.2 } else { 1.5 },
                }));
            }
        }
    }
}
