//! Picking bodies with a ray.

use sim_core::{DVec3, Shape};

use super::Session;

/// Half the size, in distances of the camera, up to which a body is drawn as a dot.
const SPECK: f64 = 0.004;

impl Session {
    /// Selects the nearest body that a ray from `origin` along `direction` meets, or none.
    pub fn pick(&mut self, origin: DVec3, direction: DVec3) {
        let hit = self.hit(origin, direction);
        let hit = hit.or_else(|| self.dot_near(origin, direction.normalize_or_zero()));
        self.select(hit.map(|(_, i)| i));
    }

    /// The nearest body that a ray meets, and where, in lengths of `direction`.
    pub(super) fn hit(&mut self, origin: DVec3, direction: DVec3) -> Option<(f64, usize)> {
        self.world.build_bvhs();
        (0..self.world.len())
            .filter(|&i| !self.is_hidden(i))
            .filter_map(|i| Some((self.ray(i, origin, direction)?, i)))
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Where a ray meets a body, in lengths of `direction`. Half-spaces are everywhere behind
    /// something, and are selected in the list instead.
    fn ray(&self, i: usize, origin: DVec3, direction: DVec3) -> Option<f64> {
        // In the frame of the shape.
        let back = self.shown_rotation(i).inverse();
        let origin = back * (origin - self.shown_position(i));
        let direction = back * direction;
        match *self.world.shape(i)? {
            Shape::Mesh(_) => Some(self.world.bvh(i)?.ray(origin, direction)?.t),
            Shape::Sphere { radius } => ray_to_sphere(origin, direction, radius),
            Shape::HalfSpace { .. } => None,
        }
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
        match self.world.shape(i) {
            Some(Shape::HalfSpace { .. }) => false,
            _ => self.bounds(i).half.max_element() <= least,
        }
    }
}

/// Where a ray first meets a sphere about the origin, in lengths of its direction; from inside,
/// where it leaves.
fn ray_to_sphere(origin: DVec3, direction: DVec3, radius: f64) -> Option<f64> {
    let length = direction.length();
    let along = origin.dot(direction) / length;
    // From the point nearest to the centre, rather than by b² - 4ac, which cancels far away.
    let aside = origin - along / length * direction;
    let half_chord = (radius * radius - aside.length_squared()).sqrt();
    let (near, far) = (-along - half_chord, -along + half_chord);
    let first = if near >= 0.0 { near } else { far };
    (first >= 0.0).then_some(first / length)
}
