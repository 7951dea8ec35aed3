//! The relative pose of two meshes: the second one in the first one's frame.

use glam::{DMat3, DQuat, DVec3, Vec3};

use crate::Aabb;

/// The pose of the second of two meshes relative to the first: displaced, and perhaps rotated.
///
/// Its vertices are *placed*, each exactly once: `fl64(f64(v) + offset)`, or with a rotation the products and sums of
/// `R v + offset` in a fixed order. Every decision is exact for the placed vertices. Components of the offset below
/// 2^-250 m count as zero, so that no product in an exact decision underflows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    offset: DVec3,
    /// Columns of the rotation, if there is one.
    turn: Option<DMat3>,
}

impl From<DVec3> for Placement {
    /// Displaced by an offset, m. With an offset that is not a number, or is beyond 1e100 m, meshes are apart.
    fn from(offset: DVec3) -> Placement {
        Placement {
            offset: snap(offset),
            turn: None,
        }
    }
}

impl Placement {
    /// Rotated about its origin, then displaced, m; `None` unless `rotation` is of unit length.
    pub fn turned(rotation: DQuat, offset: DVec3) -> Option<Placement> {
        // Normalised: the tolerance of the check is too wide for the bounds of slabs.
        let unit = rotation.is_normalized().then(|| rotation.normalize())?;
        let is_identity = unit.xyz() == DVec3::ZERO;
        Some(Placement {
            offset: snap(offset),
            turn: (!is_identity).then(|| DMat3::from_quat(unit)),
        })
    }

    /// The displacement, m.
    pub fn offset(&self) -> DVec3 {
        self.offset
    }

    pub(super) fn turn(&self) -> Option<&DMat3> {
        self.turn.as_ref()
    }

    /// A vertex of the second mesh in the first one's frame, m.
    #[inline(always)]
    pub fn place(&self, v: Vec3) -> DVec3 {
        let v = v.as_dvec3();
        match self.turn {
            None => v + self.offset,
            Some(turn) => {
                snap(turn.x_axis * v.x + turn.y_axis * v.y + turn.z_axis * v.z + self.offset)
            }
        }
    }

    /// A point of the first mesh's frame, converted to the second one's, m, rounded.
    pub(super) fn back(&self, point: DVec3) -> DVec3 {
        self.direction_back(point - self.offset)
    }

    /// A direction of the second mesh's frame, converted to the first one's, rounded.
    pub(super) fn direction(&self, direction: DVec3) -> DVec3 {
        self.turn.map_or(direction, |turn| turn * direction)
    }

    /// A direction of the first mesh's frame, converted to the second one's, rounded.
    pub(super) fn direction_back(&self, direction: DVec3) -> DVec3 {
        self.turn
            .map_or(direction, |turn| turn.transpose() * direction)
    }

    /// Least and greatest corner of a box around every placed vertex of `bounds`.
    #[inline]
    pub(super) fn corners(&self, bounds: &Aabb) -> (DVec3, DVec3) {
        match &self.turn {
            // Rounding is monotone.
            None => (
                bounds.min.as_dvec3() + self.offset,
                bounds.max.as_dvec3() + self.offset,
            ),
            Some(turn) => self.turned_corners(turn, *bounds),
        }
    }

    fn turned_corners(&self, turn: &DMat3, bounds: Aabb) -> (DVec3, DVec3) {
        let (centre, half) = (bounds.centre(), bounds.half_extent());
        let middle = *turn * centre + self.offset;
        let reach =
            turn.x_axis.abs() * half.x + turn.y_axis.abs() * half.y + turn.z_axis.abs() * half.z;
        let size =
            centre.abs().element_sum() + half.element_sum() + self.offset.abs().element_sum();
        // More than all roundings, and than small components that count as zero.
        let reach = reach + DVec3::splat(16.0 * f64::EPSILON * size + TINY);
        (middle - reach, middle + reach)
    }

    /// Whether a box of the first mesh meets a box of the second; a "no" is a proof.
    #[inline]
    pub(super) fn boxes_meet(&self, first: &Aabb, second: &Aabb) -> bool {
        let (min, max) = self.corners(second);
        // Infinite corners prove nothing.
        let apart = first.min.as_dvec3().cmpgt(max) | min.cmpgt(first.max.as_dvec3());
        let is_apart = |turn| self.apart_along_second(turn, *first, *second);
        !apart.any() && !self.turn.as_ref().is_some_and(is_apart)
    }

    /// Whether boxes are apart along an axis of the second mesh.
    fn apart_along_second(&self, turn: &DMat3, first: Aabb, second: Aabb) -> bool {
        let back = turn.transpose();
        let (near, far) = (first.centre(), second.centre());
        let (half, reach) = (first.half_extent(), second.half_extent());
        let height = back * (self.offset - near) + far;
        let reach = back.abs() * half + reach;
        let size = near.abs() + far.abs() + reach + half + self.offset.abs();
        // More than all roundings, including those of placed corners.
        let rounding = 64.0 * f64::EPSILON * size.element_sum() + TINY;
        height.abs().cmpgt(reach + DVec3::splat(rounding)).any()
    }

    /// Whether the offset is in range: with an offset that is not a number, or is beyond 1e100 m, farther than any mesh
    /// reaches, meshes are apart.
    pub(super) fn is_in_range(&self) -> bool {
        is_in_range(self.offset)
    }
}

/// Whether exact decisions about a point or vector neither overflow nor fail; false for NaN.
pub(super) fn is_in_range(v: DVec3) -> bool {
    v.abs().cmple(DVec3::splat(FARTHEST)).all()
}

/// Beyond this, m, exact decisions would overflow.
pub(super) const FARTHEST: f64 = 1e100;

/// 2^-250.
const TINY: f64 = f64::from_bits((1023 - 250) << 52);

/// The vector that decisions use: components below 2^-250 are zero.
///
/// Placed vertices are then multiples of 2^-303, because f32 has no numbers below 2^-149, and no product in an exact
/// decision underflows.
pub(crate) fn snap(offset: DVec3) -> DVec3 {
    DVec3::select(offset.abs().cmplt(DVec3::splat(TINY)), DVec3::ZERO, offset)
}
