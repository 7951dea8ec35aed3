//! Near pairs: swept boxes of bodies on straight trajectories, and the pairs whose boxes meet.

use alloc::vec::Vec;
use glam::DVec3;

use super::bodies::Bodies;
use crate::{
    Aabb, Extent, Shape,
    collide::{Broad, Front, Swept},
};

impl Bodies {
    /// A box around a body on a straight path between two positions.
    pub(super) fn swept_box(&self, body: usize, from: DVec3, to: DVec3) -> Swept {
        let Extent {
            low,
            high,
            farthest,
            ..
        } = self.extent_however_turned(body);
        // More than the rounding here and of placed vertices.
        let margin = 8.0 * f64::EPSILON * (from.abs() + to.abs() + 2.0 * farthest);
        Swept {
            min: from.min(to) + low - margin,
            max: from.max(to) + high + margin,
            body,
        }
    }

    /// The farthest position of a half-space's plane on a straight path; `None` for other bodies.
    pub(super) fn swept_front(&self, wall: usize, from: DVec3, to: DVec3) -> Option<Front> {
        let &Shape::HalfSpace { normal } = self.shape(wall)? else {
            return None;
        };
        Some(Front {
            normal,
            body: wall,
            level: normal.dot(from).max(normal.dot(to)),
            // More than rounding.
            slack: 16.0 * f64::EPSILON * (from.length() + to.length()),
        })
    }

    /// The pairs that may meet and whose boxes, each widened by a length, meet.
    pub(super) fn near_pairs(
        &self,
        at: &[DVec3],
        margin: impl Fn(usize) -> f64,
    ) -> Vec<(usize, usize)> {
        let mut broad = Broad::default();
        let swept = |body: usize| {
            let extent = self.extent_however_turned(body);
            let wide = DVec3::splat(margin(body));
            Swept {
                min: at[body] + extent.low - wide,
                max: at[body] + extent.high + wide,
                body,
            }
        };
        let front = |body: usize| {
            let mut front = self.swept_front(body, at[body], at[body])?;
            front.slack += margin(body);
            Some(front)
        };
        broad.fill(&self.solid, swept, front);
        let mut pairs = Vec::new();
        broad.each_pair(|i, j| {
            if self.may_meet(i, j) {
                pairs.push((i, j));
            }
        });
        pairs.sort_unstable();
        pairs
    }

    /// The direction in which two overlapping bodies should part: out of a half-space, or along the line of their
    /// centres. `None` if the centres coincide, so that no direction is preferred.
    pub(super) fn line_apart(&self, at: &[DVec3], (i, j): (usize, usize)) -> Option<DVec3> {
        match (self.shape(i), self.shape(j)) {
            (Some(&Shape::HalfSpace { normal }), _) => Some(normal),
            (_, Some(&Shape::HalfSpace { normal })) => Some(-normal),
            _ => (self.centre(at, j) - self.centre(at, i)).try_normalize(),
        }
    }

    /// The centre of a body's box, m.
    pub(super) fn centre(&self, at: &[DVec3], body: usize) -> DVec3 {
        let mesh = self.mesh(body);
        let middle = mesh.map_or(DVec3::ZERO, |mesh| Aabb::centre(&mesh.bounds()));
        at[body] + middle
    }
}
