//! Picking bodies with a ray.

use sim_core::{DVec3, Shape, query};

use super::Session;

/// The half size, in distances of the camera, up to which a body is drawn as a dot.
const SPECK: f64 = 0.004;

/// The most bodies that are tested for hiding something.
const MOST_HIDING: usize = 200;

impl Session {
    /// Selects the nearest body that a ray from `origin` along `direction` meets, or none.
    pub fn pick(&mut self, origin: DVec3, direction: DVec3) {
        let hit = self.hit(origin, direction);
        let hit = hit.or_else(|| self.dot_near(origin, direction.normalize_or_zero()));
        self.select(hit.map(|(_, i)| i));
    }

    /// The nearest body that a ray meets as drawn, and the ray parameter there, in lengths of `direction`. Half-spaces
    /// fill the background almost everywhere, so they are selected in the list instead.
    pub(super) fn hit(&self, origin: DVec3, direction: DVec3) -> Option<(f64, usize)> {
        (0..self.world.len())
            .filter(|&i| !self.is_hidden(i) && !self.is_half_space(i))
            .filter_map(|i| {
                // In the frame of the shape, which may be rotated.
                let back = self.shown_rotation(i).inverse();
                let from = back * (origin - self.shown_position(i));
                let shown = self.world.placed(i)?.at(DVec3::ZERO).ok()?;
                let hit = query::ray(shown, from, back * direction).ok()??;
                Some((hit.time, i))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Whether a body is drawn before a point, to which a ray from `origin` along `direction` leads. Not tested for a
    /// crowd.
    pub fn hides(&self, point: DVec3, (origin, direction): (DVec3, DVec3)) -> bool {
        let along = (point - origin).dot(direction) / direction.length_squared();
        let hit = (self.world.len() <= MOST_HIDING).then(|| self.hit(origin, direction));
        hit.flatten().is_some_and(|(hit, _)| hit < along)
    }

    /// The dot that the ray passes most closely, if it is close enough, with its ray parameter.
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
        match self.world.shape(i) {
            Some(Shape::HalfSpace { .. }) => false,
            _ => self.bounds(i).half.max_element() <= least,
        }
    }
}
