//! The room that bodies take up, and the camera that looks at them.

use scene::{SceneBody, SceneShape};
use sim_core::{Aabb, DVec3, Force, Shape};

use super::{Session, State};

/// Largest way that the opening view makes room for, in radii of the body: a bullet would be a
/// dot in it. Half-spaces farther away are not looked at either.
const OPENING_REACH: f64 = 8.0;
/// Depth over width and height below which all is in an upright plane, and where to look at that
/// from: yaw and pitch, radians.
const FLAT: f64 = 0.3;
const FRONT: (f64, f64) = (0.2, 0.16);
/// How far ahead the opening view looks under forces: simulated time, s, steps, and positions.
const OPENING_TIME: f64 = 6.4;
const OPENING_STEPS: f64 = 720.0;
const OPENING_POSITIONS: f64 = 20_000.0;

/// A body's box about its position, m; that of points and half-spaces has no size.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bounds {
    pub(super) centre: DVec3,
    pub(super) half: DVec3,
}

impl Session {
    /// Where body `i` is drawn, m: between the last two states while running.
    pub(super) fn shown_position(&self, i: usize) -> DVec3 {
        match self.state {
            State::Running => self.world.interpolated(i, self.clock.fraction()),
            State::Layout | State::Paused => self.world.position(i),
        }
    }

    /// Centre and radius, m, of a ball around the selected body, or around all bodies.
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

    /// Top of the selected body's box as drawn, m: where its name goes.
    pub fn selected_top(&self) -> Option<DVec3> {
        let selected = self.selection?;
        if self.is_half_space(selected) {
            return Some(self.foot(selected, self.room().0));
        }
        let (min, max) = self.body_box(selected);
        let middle = (min + max) / 2.0;
        Some(DVec3::new(middle.x, max.y, middle.z))
    }

    /// Looks at all bodies with room around them, or at a single one and where it goes next, so
    /// that nothing leaves the first view at once.
    pub(super) fn frame_opening(&mut self) {
        if !self.world.forces().is_empty() {
            return self.frame_motion();
        }
        let mut bodies = (0..self.world.len()).filter(|&i| !self.is_half_space(i));
        let Some(body) = bodies.next() else {
            return self.frame();
        };
        let (centre, radius) = self.room();
        if self.world.len() > 1 {
            return self.camera.frame(centre, 1.2 * radius);
        }
        let velocity = self.world.velocity(body);
        let acceleration = self.world.force(body) / self.world.mass(body);
        let (mut min, mut max) = (centre - radius, centre + radius);
        for time in [0.5, 1.0, 1.5, 2.0, 2.5, 3.0] {
            let way = velocity * time + acceleration * (0.5 * time * time);
            let there = centre + way.clamp_length_max(OPENING_REACH * radius);
            (min, max) = (min.min(there - radius), max.max(there + radius));
        }
        let ball = (max - min).length() / 2.0;
        self.camera.frame((min + max) / 2.0, ball);
    }

    /// Looks at where forces will take the bodies next. What falls below the lowest start is let go.
    fn frame_motion(&mut self) {
        let Some((low, high)) = self.world_box() else {
            return;
        };
        let (low, high) = self.with_feet(low, high);
        let has_weight = |force: &Force| matches!(force, Force::Gravity { .. });
        let falls = self.world.forces().iter().any(has_weight);
        let size = (high - low).max_element();
        let (mut min, mut max) = (low, high);
        for force in self.world.forces() {
            if let Force::Anchor { anchor: point, .. } | Force::Attraction { centre: point, .. } =
                *force
            {
                (min, max) = (min.min(point), max.max(point));
            }
        }
        let mut ahead = self.world.clone();
        let steps = (OPENING_TIME / ahead.settings().dt).min(OPENING_STEPS);
        let steps = steps.min(OPENING_POSITIONS / self.world.len().max(1) as f64);
        for _ in 0..steps as u32 {
            if ahead.step().is_err() {
                break;
            }
            for i in 0..ahead.len() {
                let at = ahead.position(i);
                if self.is_half_space(i) || falls && at.y < low.y {
                    continue;
                }
                let at = at.clamp(low - OPENING_REACH * size, high + OPENING_REACH * size);
                let half = self.bounds(i).half;
                (min, max) = (min.min(at - half), max.max(at + half));
            }
        }
        let (size, middle) = (max - min, 0.5 * (min + max));
        if size.z < FLAT * size.x.max(size.y) {
            // Motion in an upright plane is looked at nearly from the front.
            (self.camera.yaw, self.camera.pitch) = FRONT;
        }
        let mut radius = (0.47 * size.length()).max(1e-3);
        if (0..self.world.len()).any(|i| self.is_half_space(i)) {
            radius = radius.max(1.1 * self.room().1);
        }
        self.camera.frame(middle, radius);
    }

    /// A place for `body` that touches nothing: beside all others along x, at their height, or for
    /// a half-space through the origin or else behind them all.
    pub(super) fn free_place(&self, body: &SceneBody) -> DVec3 {
        let Some((min, max)) = self.world_box() else {
            return DVec3::ZERO;
        };
        let middle = (min + max) / 2.0;
        let reach = match &body.shape {
            SceneShape::HalfSpace { normal } => {
                let normal = normal.normalize_or_zero();
                let lowest = (middle - 0.5 * normal.signum() * (max - min)).dot(normal);
                return if lowest > 0.0 {
                    DVec3::ZERO
                } else {
                    (lowest - 0.1) * normal
                };
            }
            SceneShape::Sphere { radius } => *radius,
            // However it is turned.
            SceneShape::Mesh(mesh) => {
                let Aabb { min, max } = mesh.mesh().bounds();
                let corner = min.as_dvec3().abs().max(max.as_dvec3().abs());
                (corner * body.scale.abs()).length()
            }
        };
        DVec3::new(max.x + 1.1 * reach + 0.1, middle.y, middle.z)
    }

    /// Box of all bodies as drawn, but for half-spaces.
    fn world_box(&self) -> Option<(DVec3, DVec3)> {
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

    /// Box of a body about its position.
    pub(super) fn bounds(&self, i: usize) -> Bounds {
        match self.world.shape(i) {
            Some(Shape::Mesh(mesh)) => Bounds {
                centre: mesh.bounds().centre(),
                half: mesh.bounds().half_extent(),
            },
            Some(&Shape::Sphere { radius }) => Bounds {
                centre: DVec3::ZERO,
                half: DVec3::splat(radius),
            },
            Some(Shape::HalfSpace { .. }) | None => Bounds::default(),
        }
    }

    pub(super) fn is_half_space(&self, i: usize) -> bool {
        matches!(self.world.shape(i), Some(Shape::HalfSpace { .. }))
    }

    /// Centre and radius, m, of a ball around the room.
    pub(super) fn room(&self) -> (DVec3, f64) {
        let (min, max) = self.room_box();
        (0.5 * (min + max), (0.5 * (max - min).length()).max(1e-3))
    }

    /// Box of all bodies as they were set up and of what they stand before: how much of a
    /// half-space is worth seeing. It stays while they move.
    pub(super) fn room_box(&self) -> (DVec3, DVec3) {
        let set_up = |i: usize| self.scene.bodies[i].position;
        let boxes = (0..self.world.len())
            .filter(|&i| !self.is_half_space(i))
            .map(|i| {
                let Bounds { centre, half } = self.bounds(i);
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

    /// A box grown to where its middle stands on the half-spaces near it, as they were set up.
    fn with_feet(&self, min: DVec3, max: DVec3) -> (DVec3, DVec3) {
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

    /// The point of a half-space's plane, as drawn, nearest to another point.
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
