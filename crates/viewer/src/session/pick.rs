//! Where bodies are: picking them with a ray, and the room they take up.

use scene::SceneBody;
use sim_core::{Aabb, DVec3, Force};

use super::{Session, State};

/// Half the size, in distances of the camera, up to which a body is drawn as a dot.
const SPECK: f64 = 0.004;
/// Largest way that the opening view makes room for, in radii of the body: a bullet would be a
/// dot in it.
const OPENING_REACH: f64 = 8.0;
/// Depth over width and height below which all is in an upright plane, and where to look at that
/// from: yaw and pitch, radians.
const FLAT: f64 = 0.3;
const FRONT: (f64, f64) = (0.2, 0.16);
/// How far ahead the opening view looks under forces: simulated time, s, steps, and positions.
const OPENING_TIME: f64 = 6.4;
const OPENING_STEPS: f64 = 720.0;
const OPENING_POSITIONS: f64 = 20_000.0;

impl Session {
    /// Where body `i` is drawn, m: between the last two states while running.
    pub(super) fn shown_position(&self, i: usize) -> DVec3 {
        match self.state {
            State::Running => self.world.interpolated(i, self.clock.fraction()),
            State::Layout | State::Paused => self.world.position(i),
        }
    }

    /// Selects the nearest body that a ray from `origin` along `direction` meets, or none.
    pub fn pick(&mut self, origin: DVec3, direction: DVec3) {
        self.world.build_bvhs();
        let hit = (0..self.world.len())
            .filter_map(|i| {
                let hit = self
                    .world
                    .bvh(i)?
                    .ray(origin - self.shown_position(i), direction)?;
                Some((hit.t, i))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let hit = hit.or_else(|| self.dot_near(origin, direction.normalize_or_zero()));
        self.select(hit.map(|(_, i)| i));
    }

    /// The body drawn as a dot that a ray passes most closely, in distances along it, and close enough.
    fn dot_near(&self, origin: DVec3, direction: DVec3) -> Option<(f64, usize)> {
        (0..self.world.len())
            .filter(|&i| self.is_dot(i))
            .filter_map(|i| {
                let way = self.shown_position(i) - origin;
                let along = way.dot(direction);
                let aside = (way - along * direction).length() / along;
                (along > 0.0 && aside < 2.0 * SPECK).then_some((aside, i))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Whether a body is a point, or too small to be seen.
    pub(super) fn is_dot(&self, i: usize) -> bool {
        let least = SPECK * self.camera.distance;
        let mesh = self.world.mesh(i);
        mesh.is_none_or(|mesh| mesh.bounds().half_extent().max_element() <= least)
    }

    /// Centre and radius, m, of a ball around the selected body, or around all bodies.
    pub(super) fn extent(&self) -> Option<(DVec3, f64)> {
        let (min, max) = match self.selection {
            Some(i) => self.body_box(i),
            None => self.world_box()?,
        };
        Some(((min + max) / 2.0, ((max - min).length() / 2.0).max(1e-3)))
    }

    /// Top of the selected body's box as drawn, m: where its name goes.
    pub fn selected_top(&self) -> Option<DVec3> {
        let (min, max) = self.body_box(self.selection?);
        let middle = (min + max) / 2.0;
        Some(DVec3::new(middle.x, max.y, middle.z))
    }

    /// Looks at all bodies with room around them, or at a single one and where it goes next, so
    /// that nothing leaves the first view at once.
    pub(super) fn frame_opening(&mut self) {
        let Some((centre, radius)) = self.extent() else {
            return;
        };
        if !self.world.forces().is_empty() {
            return self.frame_motion();
        }
        if self.world.len() > 1 {
            return self.camera.frame(centre, 1.2 * radius);
        }
        let (velocity, acceleration) = (
            self.world.velocity(0),
            self.world.force(0) / self.world.mass(0),
        );
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
                if falls && at.y < low.y {
                    continue;
                }
                let at = at.clamp(low - OPENING_REACH * size, high + OPENING_REACH * size);
                let half = self.world.mesh(i).map(|mesh| mesh.bounds().half_extent());
                let half = half.unwrap_or_default();
                (min, max) = (min.min(at - half), max.max(at + half));
            }
        }
        let (size, middle) = (max - min, 0.5 * (min + max));
        if size.z < FLAT * size.x.max(size.y) {
            // Motion in an upright plane is looked at nearly from the front.
            (self.camera.yaw, self.camera.pitch) = FRONT;
        }
        self.camera.frame(middle, (0.47 * size.length()).max(1e-3));
    }

    /// A place for `body` that touches nothing: beside all others along x, at their height.
    pub(super) fn free_place(&self, body: &SceneBody) -> DVec3 {
        let reach = reach(body);
        match self.world_box() {
            None => DVec3::ZERO,
            Some((min, max)) => {
                let middle = (min + max) / 2.0;
                DVec3::new(max.x + 1.1 * reach + 0.1, middle.y, middle.z)
            }
        }
    }

    fn world_box(&self) -> Option<(DVec3, DVec3)> {
        (0..self.world.len())
            .map(|i| self.body_box(i))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    fn body_box(&self, i: usize) -> (DVec3, DVec3) {
        let position = self.shown_position(i);
        match self.world.mesh(i) {
            Some(mesh) => {
                let Aabb { min, max } = mesh.bounds();
                (position + min.as_dvec3(), position + max.as_dvec3())
            }
            None => (position, position),
        }
    }
}

/// Radius, m, of the ball about its own origin that holds a body however it is turned.
fn reach(body: &SceneBody) -> f64 {
    let Aabb { min, max } = body.mesh.mesh().bounds();
    let corner = min.as_dvec3().abs().max(max.as_dvec3().abs());
    (corner * body.scale.abs()).length()
}
