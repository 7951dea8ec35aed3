//! Axis-aligned boxes.

use glam::{DVec3, Vec3};

/// A closed axis-aligned box in a mesh's own frame, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box of no points: `min` above `max`, neutral in [`Aabb::union`].
    pub const EMPTY: Aabb = Aabb {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The least box around some points.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Aabb {
        points.into_iter().fold(Aabb::EMPTY, |bounds, p| Aabb {
            min: bounds.min.min(p),
            max: bounds.max.max(p),
        })
    }

    /// The least box around both.
    pub fn union(self, other: Aabb) -> Aabb {
        Aabb {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Centre, m.
    pub fn centre(&self) -> DVec3 {
        // In f64 the sum of two f32 cannot overflow.
        (self.min.as_dvec3() + self.max.as_dvec3()) * 0.5
    }

    /// Half of the extent along each axis, m.
    pub fn half_extent(&self) -> DVec3 {
        (self.max.as_dvec3() - self.min.as_dvec3()) * 0.5
    }

    /// Half of the surface area, m²: the measure of the surface area heuristic.
    pub fn half_area(&self) -> f64 {
        let e = self.max.as_dvec3() - self.min.as_dvec3();
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// Whether this box and `other`, displaced by `offset`, share a point.
    ///
    /// Corners are placed as vertices are, `fl64(f64(v) + offset)`. Rounding is monotone, so
    /// the placed box holds every placed vertex, and a "no" is a proof.
    pub fn meets(&self, other: &Aabb, offset: DVec3) -> bool {
        let min = other.min.as_dvec3() + offset;
        let max = other.max.as_dvec3() + offset;
        self.min.as_dvec3().cmple(max).all() && min.cmple(self.max.as_dvec3()).all()
    }

    /// Whether this box meets `other` somewhere on its way from `offset` to `offset + motion`.
    pub fn meets_swept(&self, other: &Aabb, offset: DVec3, motion: DVec3) -> bool {
        let end = offset + motion;
        let min = other.min.as_dvec3() + offset.min(end);
        let max = other.max.as_dvec3() + offset.max(end);
        self.min.as_dvec3().cmple(max).all() && min.cmple(self.max.as_dvec3()).all()
    }
}
