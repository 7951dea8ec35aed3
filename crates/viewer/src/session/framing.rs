//! The region that bodies occupy, and the camera that shows it.

use scene::{SceneBody, SceneShape};
use sim_core::{Aabb, DMat3, DVec3, Shape};

use super::Session;

/// The longest path that the opening view includes, in radii of the body: for a bullet's path the bullet would be a
/// dot. Half-spaces farther away are not included either.
pub(super) const OPENING_REACH: f64 = 8.0;

/// The gap below bodies that stand on a new half-space, in sizes of all bodies: larger than rounding.
const STAND: f64 = 1e-9;

/// A body's box about its position, m; of zero size for points and half-spaces.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bounds {
    pub(super) centre: DVec3,
    pub(super) half: DVec3,
}

impl Session {
    /// Centre and radius, m, of a sphere around the selected body, or around all bodies.
    pub(super) fn extent(&self) -> Option<(DVec3, f64)> {
        let (min, max) = match self.selection {
            Some(i) if !self.is_half_space(i) => self.body_box(i),
            Some(_) => return Some(self.room()),
            None if self.world.is_empty() => return None,
            None => match self.world_box() {
                Some(all) => all,
                None => return Some(self.room()),
            },
        };
        Some(((min + max) / 2.0, ((max - min).length() / 2.0).max(1e-3)))
    }

    /// Top of a body's box as drawn, m: the place of its name.
    pub fn top(&self, body: usize) -> DVec3 {
        if self.is_half_space(body) {
            return self.foot(body, self.room().0);
        }
        let (min, max) = self.body_box(body);
        let middle = (min + max) / 2.0;
        DVec3::new(middle.x, max.y, middle.z)
    }

    /// The middle of a body's box as drawn, m: the place of its handles. For a half-space, the point of its plane
    /// nearest to all bodies.
    pub fn middle(&self, body: usize) -> DVec3 {
        if self.is_half_space(body) {
            return self.foot(body, self.room().0);
        }
        self.shown_position(body) + self.bounds(body).centre
    }

    /// A position for `body` without contact: beside all others along x, at their height. A half-space goes through the
    /// origin, or otherwise just behind all bodies.
    pub(super) fn free_place(&self, body: &SceneBody) -> DVec3 {
        let Some((min, max)) = self.world_box() else {
            return DVec3::ZERO;
        };
        let middle = (min + max) / 2.0;
        let reach = match &body.shape {
            SceneShape::HalfSpace { normal } => {
                let normal = normal.normalize_or_zero();
                let lowest = (middle - 0.5 * normal.signum() * (max - min)).dot(normal);
                // Through the origin, or below the bodies that reach behind it. Zeros have a positive sign.
                let gap = STAND * (max - min).max_element().max(lowest.abs());
                return (lowest - gap).min(0.0) * normal + DVec3::ZERO;
            }
            SceneShape::Sphere { radius } => *radius,
            // The radius covers every rotation.
            SceneShape::Mesh(mesh) => {
                let Aabb { min, max } = mesh.mesh().bounds();
                let corner = min.as_dvec3().abs().max(max.as_dvec3().abs());
                (corner * body.scale.abs()).length()
            }
        };
        DVec3::new(max.x + 1.1 * reach + 0.1, middle.y, middle.z)
    }

    /// Box of all bodies as drawn, without half-spaces.
    pub(super) fn world_box(&self) -> Option<(DVec3, DVec3)> {
        (0..self.world.len())
            .filter(|&i| !self.is_half_space(i))
            .map(|i| self.body_box(i))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    fn body_box(&self, i: usize) -> (DVec3, DVec3) {
        let Bounds { centre, half } = self.bounds(i);
        let middle = self.shown_position(i) + centre;
        (middle - half, middle + half)
    }

    /// Box of a body about its position, rotated as drawn.
    pub(super) fn bounds(&self, i: usize) -> Bounds {
        let Bounds { centre, half } = self.bounds_unturned(i);
        if !self.world.turns(i) {
            return Bounds { centre, half };
        }
        let turned = DMat3::from_quat(self.shown_rotation(i));
        Bounds {
            centre: turned * centre,
            half: turned.abs() * half,
        }
    }

    /// Box of a body about its position that contains it at any rotation.
    fn bounds_however_turned(&self, i: usize) -> Bounds {
        let bounds = self.bounds_unturned(i);
        match self.world.turns(i) {
            true => Bounds {
                centre: DVec3::ZERO,
                half: DVec3::splat(bounds.centre.length() + bounds.half.length()),
            },
            false => bounds,
        }
    }

    pub(super) fn bounds_unturned(&self, i: usize) -> Bounds {
        let bounds = self.world.shape(i).and_then(Shape::bounds);
        bounds.map_or_else(Bounds::default, |[low, high]| Bounds {
            centre: (low + high) * 0.5,
            half: (high - low) * 0.5,
        })
    }

    /// Whether a body can never move.
    pub(super) fn is_static(&self, i: usize) -> bool {
        !self.world.kind(i).is_movable() && self.world.velocity(i) == DVec3::ZERO
    }

    pub(super) fn is_half_space(&self, i: usize) -> bool {
        matches!(self.world.shape(i), Some(Shape::HalfSpace { .. }))
    }

    /// Centre and radius, m, of a sphere around the room box.
    pub(super) fn room(&self) -> (DVec3, f64) {
        let (min, max) = self.room_box();
        (0.5 * (min + max), (0.5 * (max - min).length()).max(1e-3))
    }

    /// Box of all bodies as they were set up and of the half-spaces near them. It determines the drawn part of
    /// half-spaces and stays constant while bodies move.
    pub(super) fn room_box(&self) -> (DVec3, DVec3) {
        let set_up = |i: usize| self.scene.bodies[i].position;
        let boxes = (0..self.world.len())
            .filter(|&i| !self.is_half_space(i))
            .map(|i| {
                let Bounds { centre, half } = self.bounds_however_turned(i);
                (set_up(i) + centre - half, set_up(i) + centre + half)
            });
        let bodies = boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        match bodies {
            Some((min, max)) => self.with_feet(min, max),
            None => {
                let places = (0..self.world.len()).map(set_up);
                let middle = places.reduce(|a, b| a.lerp(b, 0.5)).unwrap_or_default();
                (middle - 1.0, middle + 1.0)
            }
        }
    }

    /// Extends a box to the feet of its middle on the half-spaces near it, as they were set up.
    pub(super) fn with_feet(&self, min: DVec3, max: DVec3) -> (DVec3, DVec3) {
        let middle = 0.5 * (min + max);
        let reach = OPENING_REACH * (max - min).length();
        (0..self.world.len())
            .filter(|&i| self.is_half_space(i))
            .map(|i| self.foot_at(i, self.scene.bodies[i].position, middle))
            .filter(|foot| foot.distance(middle) < reach)
            .fold((min, max), |(min, max), foot| {
                (min.min(foot), max.max(foot))
            })
    }

    /// The point of a half-space's plane, as drawn, that is nearest to `point`.
    pub(super) fn foot(&self, half_space: usize, point: DVec3) -> DVec3 {
        self.foot_at(half_space, self.shown_position(half_space), point)
    }

    fn foot_at(&self, half_space: usize, position: DVec3, point: DVec3) -> DVec3 {
        match self.world.shape(half_space) {
            Some(&Shape::HalfSpace { normal }) => point - (point - position).dot(normal) * normal,
            _ => position,
        }
    }
}
