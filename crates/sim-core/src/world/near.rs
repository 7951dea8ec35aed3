//! Near pairs: swept boxes of bodies on straight trajectories, and the pairs whose boxes meet.

use alloc::vec::Vec;
use glam::DVec3;

use super::bodies::Bodies;
use crate::{
    Aabb, Extent, Shape,
    collide::{Broad, Front, Swept},
};

impl Bodies {
    /// A box around a body on a straight way from a place to another.
    pub(super) fn swept_box(&self, body: usize, from: DVec3, to: DVec3) -> Swept {
        let Extent {
            low,
            high,
            farthest,
            ..
        } = self.extent_however_turned(body);
        // More than is lost in rounding, here and where vertices are placed.
        let margin = 8.0 * f64::EPSILON * (from.abs() + to.abs() + 2.0 * farthest);
        Swept {
            min: from.min(to) + low - margin,
            max: from.max(to) + high + margin,
            body,
        }
    }

    /// The farthest that the plane of a body comes on a straight way, if it is a half-space.
    pub(super) fn swept_front(&self, wall: usize, from: DVec3, to: DVec3) -> Option<Front> {
        let &Shape::HalfSpace { normal } = self.shape(wall)? else {
            return None;
        };
        Some(Front {
            normal,
            body: wall,
            level: normal.dot(from).max(normal.dot(to)),
            // More than is lost in rounding.
            slack: 16.0 * f64::EPSILON * (from.length() + to.length()),
        })
    }

    /// Pairs that may meet whose boxes, each widened by a length, meet.
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

    /// Where two bodies at their places should part to: out of a half-space, or along the line of their
    /// centres; `None` where their centres are in one place, and no direction is closer.
    pub(super) fn line_apart(&self, at: &[DVec3], (i, j): (usize, usize)) -> Option<DVec3> {
        match (self.shape(i), self.shape(j)) {
            (Some(&Shape::HalfSpace { normal }), _) => Some(normal),
            (_, Some(&Shape::HalfSpace { normal })) => Some(-normal),
            _ => (self.centre(at, j) - self.centre(at, i)).try_normalize(),
        }
    }

    /// Middle of a body's box, m.
    pub(super) fn centre(&self, at: &[DVec3], body: usize) -> DVec3 {
        let mesh = self.mesh(body);
        let middle = mesh.map_or(DVec3::ZERO, |mesh| Aabb::centre(&mesh.bounds()));
        at[body] + middle
    }
}
