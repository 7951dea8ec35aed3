//! A camera that orbits a target, with perspective or without.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DMat4, DVec3, DVec4, Mat4};

/// The range of distances from the target, m.
const DISTANCE: std::ops::RangeInclusive<f64> = 1e-4..=1e12;
/// The near plane, as a fraction of the distance to the target.
const NEAR: f64 = 1e-3;
/// Without perspective, the distance of the far plane behind the eye, in distances to the target.
const PARALLEL_REACH: f64 = 200.0;
/// The factor by which the view is larger than a framed sphere.
const FRAME_MARGIN: f64 = 1.1;

/// A camera that looks at a target from a distance; `y` is up.
///
/// The fields may be set freely; the methods keep them in their ranges and ignore values that are not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point in the middle of the view, m.
    pub target: DVec3,
    /// The distance from the eye to the target, m, above zero.
    pub distance: f64,
    /// Rotation about `y`, radians: at 0 the eye is towards `+z` of the target, at a quarter turn towards `+x`.
    pub yaw: f64,
    /// The elevation angle of the eye above the target, radians, within a quarter turn.
    pub pitch: f64,
    /// Field of view, radians, in `(0, pi)`: vertical, or horizontal if the picture is taller than wide.
    pub fov_y: f64,
    /// Whether the projection is parallel, so that the apparent size does not depend on the distance. At the target,
    /// sizes are the same in both projections.
    pub parallel: bool,
}

impl Default for Camera {
    /// A three-quarter view, from a little above, of a few metres around the origin.
    fn default() -> Self {
        Self {
            target: DVec3::new(0.0, 0.5, 0.0),
            distance: 8.0,
            yaw: 35f64.to_radians(),
            pitch: 20f64.to_radians(),
            fov_y: 40f64.to_radians(),
            parallel: false,
        }
    }
}

impl Camera {
    /// Rotates the eye around the target: `dx` radians to the right, `dy` upwards, at most to straight above.
    pub fn orbit(&mut self, dx: f64, dy: f64) {
        if dx.is_finite() && dy.is_finite() {
            self.yaw = (self.yaw + dx).rem_euclid(TAU);
            self.pitch = (self.pitch + dy).clamp(-FRAC_PI_2, FRAC_PI_2);
        }
    }

    /// Moves eye and target together, `dx` to the right and `dy` up, in heights of the view at the target (in widths if
    /// the picture is taller than wide).
    pub fn pan(&mut self, dx: f64, dy: f64) {
        let span = 2.0 * self.distance * (0.5 * self.fov_y).tan();
        let [right, up, _] = self.axes();
        let moved = self.target + span * (dx * right + dy * up);
        if moved.is_finite() {
            self.target = moved;
        }
    }

    /// Rotates the direction of view about the eye: `dx` radians to the right, `dy` upwards.
    pub fn look(&mut self, dx: f64, dy: f64) {
        let eye = self.eye();
        self.orbit(-dx, -dy);
        let moved = eye + self.distance * self.forward();
        if moved.is_finite() {
            self.target = moved;
        }
    }

    /// Moves eye and target together, to the right, up, and forward, in distances to the target.
    pub fn fly(&mut self, way: DVec3) {
        let [right, up, backward] = self.axes();
        let moved = self.target + self.distance * (way.x * right + way.y * up - way.z * backward);
        if moved.is_finite() {
            self.target = moved;
        }
    }

    /// Divides the distance to the target by a factor above zero: 2 halves the distance, 0.5 doubles it.
    pub fn zoom(&mut self, factor: f64) {
        let distance = self.distance / factor;
        if factor > 0.0 && distance.is_finite() {
            self.distance = distance.clamp(*DISTANCE.start(), *DISTANCE.end());
        }
    }

    /// Zooms by a factor above zero and keeps fixed the point of the scene seen at `(x, y)`, at the distance of the
    /// target; the coordinates are those of [`ray`](Self::ray).
    pub fn zoom_at(&mut self, factor: f64, x: f64, y: f64, aspect: f64) {
        let [right, up, _] = self.axes();
        let [half_width, half_height] = self.half_extents(aspect);
        let aside = x * half_width * right + y * half_height * up;
        let before = self.distance;
        self.zoom(factor);
        let moved = self.target + (before - self.distance) * aside;
        if moved.is_finite() {
            self.target = moved;
        }
    }

    /// Moves the camera so that the whole sphere is in view, for any shape of the picture. The direction of view stays.
    pub fn frame(&mut self, centre: DVec3, radius: f64) {
        let distance = FRAME_MARGIN * radius / (0.5 * self.fov_y).sin();
        if centre.is_finite() && distance.is_finite() {
            self.target = centre;
            self.distance = distance.clamp(*DISTANCE.start(), *DISTANCE.end());
        }
    }

    /// The position of the eye, m.
    pub fn eye(&self) -> DVec3 {
        self.target - self.distance * self.forward()
    }

    /// The direction of view, a unit vector.
    pub fn forward(&self) -> DVec3 {
        let [_, _, backward] = self.axes();
        -backward
    }

    /// The origin (m) and unit direction of the ray through a point of the picture: from the eye, or without
    /// perspective from beside it. `x` and `y` are in `[-1, 1]` over the picture, `y` up; `aspect` is its width over
    /// its height.
    pub fn ray(&self, x: f64, y: f64, aspect: f64) -> (DVec3, DVec3) {
        let [right, up, backward] = self.axes();
        let [half_width, half_height] = self.half_extents(aspect);
        let aside = x * half_width * right + y * half_height * up;
        match self.parallel {
            true => (self.eye() + self.distance * aside, -backward),
            false => (self.eye(), (aside - backward).normalize()),
        }
    }

    /// The position of a point in the picture, `y` up: in `[-1, 1]` within the picture, beyond that outside it. `None`
    /// for points beside or behind the eye.
    pub fn project(&self, point: DVec3, aspect: f64) -> Option<[f64; 2]> {
        let from_eye = point - self.eye();
        let [right, up, backward] = self.axes();
        let [half_width, half_height] = self.half_extents(aspect);
        let depth = -from_eye.dot(backward);
        (depth > NEAR * self.distance).then(|| {
            let size = if self.parallel { self.distance } else { depth };
            [
                from_eye.dot(right) / (size * half_width),
                from_eye.dot(up) / (size * half_height),
            ]
        })
    }

    /// The matrix from points relative to the eye (world axes, m) to clip space. Depth is reversed, without a far
    /// plane: 1 at the near plane, 0 at infinity. So its precision in f32 suffices at every distance.
    pub fn view_projection(&self, aspect: f64) -> Mat4 {
        let [right, up, backward] = self.axes();
        let [half_width, half_height] = self.half_extents(aspect);
        let view = DMat4::from_cols(
            DVec4::new(right.x, up.x, backward.x, 0.0),
            DVec4::new(right.y, up.y, backward.y, 0.0),
            DVec4::new(right.z, up.z, backward.z, 0.0),
            DVec4::W,
        );
        let projection = match self.parallel {
            false => DMat4::from_cols(
                DVec4::X / half_width,
                DVec4::Y / half_height,
                -DVec4::W,
                DVec4::Z * self.near(),
            ),
            true => DMat4::from_cols(
                DVec4::X / (half_width * self.distance),
                DVec4::Y / (half_height * self.distance),
                DVec4::Z / (PARALLEL_REACH * self.distance),
                DVec4::Z + DVec4::W,
            ),
        };
        (projection * view).as_mat4()
    }

    /// The factor for relative offsets of the depth buffer's value: with it an offset at the target has the same effect
    /// as in perspective.
    pub fn depth_share(&self) -> f64 {
        match self.parallel {
            true => 1.0 / PARALLEL_REACH,
            false => 1.0,
        }
    }

    /// The depth of the near plane, m.
    pub fn near(&self) -> f64 {
        NEAR * self.distance
    }

    /// Half the width and height of the view at a depth of one.
    pub fn half_extents(&self, aspect: f64) -> [f64; 2] {
        let half = (0.5 * self.fov_y).tan();
        if aspect < 1.0 {
            [half, half / aspect]
        } else {
            [half * aspect, half]
        }
    }

    /// Unit vectors to the right, up and towards the eye.
    pub fn axes(&self) -> [DVec3; 3] {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.sin_cos();
        let right = DVec3::new(cos_yaw, 0.0, -sin_yaw);
        let backward = DVec3::new(cos_pitch * sin_yaw, sin_pitch, cos_pitch * cos_yaw);
        [right, backward.cross(right), backward]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASPECTS: [f64; 4] = [0.3, 1.0, 1.6, 4.0];

    #[test]
    fn ray_through_a_projected_point_passes_through_it() {
        let mut camera = Camera::default();
        for (step, aspect) in ASPECTS.into_iter().cycle().take(40).enumerate() {
            camera.parallel = step % 2 == 1;
            camera.orbit(0.7, 0.3 * (step as f64).sin());
            let point = camera.target + DVec3::new(1.0, -0.4, 0.6) * (step as f64).cos();
            let [x, y] = camera.project(point, aspect).expect("in front of the eye");
            let (origin, direction) = camera.ray(x, y, aspect);
            let away = (point - origin).reject_from_normalized(direction).length();
            assert!(away < 1e-12, "{away} m off at aspect {aspect}");
        }
    }

    #[test]
    fn projection_agrees_with_the_matrix() {
        for (aspect, parallel) in ASPECTS
            .map(|a| [(a, false), (a, true)])
            .into_iter()
            .flatten()
        {
            let camera = Camera {
                target: DVec3::new(1e8, 3.0, -1e8),
                parallel,
                ..Camera::default()
            };
            let point = camera.target + DVec3::new(0.5, 1.0, -0.7);
            let clip =
                camera.view_projection(aspect) * (point - camera.eye()).as_vec3().extend(1.0);
            let [x, y] = camera.project(point, aspect).expect("in front of the eye");
            assert!((f64::from(clip.x / clip.w) - x).abs() < 1e-6);
            assert!((f64::from(clip.y / clip.w) - y).abs() < 1e-6);
            assert!(clip.z > 0.0 && clip.z < clip.w);
        }
    }

    #[test]
    fn framed_sphere_is_in_view_and_fills_it() {
        for aspect in ASPECTS {
            let mut camera = Camera::default();
            let (centre, radius) = (DVec3::new(3.0, -2.0, 7.0), 2.5);
            camera.frame(centre, radius);
            let [right, up, _] = camera.axes();
            let mut largest: f64 = 0.0;
            for step in 0..360 {
                let (sin, cos) = f64::from(step).to_radians().sin_cos();
                // The outline of a sphere is a circle nearer to the eye than the centre.
                let sink = radius / camera.distance;
                let outline = centre - camera.forward() * radius * sink
                    + radius * (1.0 - sink * sink).sqrt() * (cos * right + sin * up);
                let [x, y] = camera
                    .project(outline, aspect)
                    .expect("in front of the eye");
                largest = largest.max(x.abs()).max(y.abs());
            }
            assert!(
                (0.85..1.0).contains(&largest),
                "{largest} at aspect {aspect}"
            );
        }
    }

    #[test]
    fn zoom_keeps_what_the_pointer_is_on() {
        for (factor, aspect) in [(2.0, 1.6), (0.3, 0.4)] {
            let mut camera = Camera::default();
            let [x, y] = [0.6, -0.4];
            let (eye, direction) = camera.ray(x, y, aspect);
            // The point at which the ray reaches the target's distance.
            let at = eye + direction * (camera.distance / direction.dot(camera.forward()));
            let distance = camera.distance;
            camera.zoom_at(factor, x, y, aspect);
            assert!((camera.distance - distance / factor).abs() < 1e-12);
            let [u, v] = camera.project(at, aspect).expect("in front of the eye");
            assert!((u - x).abs() < 1e-12 && (v - y).abs() < 1e-12, "{u}, {v}");
        }
        let mut camera = Camera::default();
        camera.zoom_at(f64::NAN, 0.5, 0.5, 1.0);
        assert_eq!(camera, Camera::default());
    }

    #[test]
    fn looks_straight_down_without_tumbling() {
        let mut camera = Camera::default();
        camera.orbit(0.0, 100.0);
        assert!((camera.forward() - DVec3::NEG_Y).length() < 1e-12);
        assert!(
            camera
                .axes()
                .iter()
                .all(|axis| (axis.length() - 1.0).abs() < 1e-12)
        );
        assert!(camera.eye().y > camera.target.y);
    }

    #[test]
    fn flying_goes_where_it_looks_and_looking_stays_where_it_is() {
        let mut camera = Camera::default();
        let (eye, ahead) = (camera.eye(), camera.forward());
        camera.fly(DVec3::new(0.0, 0.0, 0.5));
        assert!((camera.eye() - eye - 0.5 * camera.distance * ahead).length() < 1e-12);
        let eye = camera.eye();
        camera.look(0.3, 0.1);
        assert!(camera.eye().distance(eye) < 1e-12);
        let [right, ..] = Camera::default().axes();
        assert!(camera.forward().dot(right) > 0.2, "to the right");
        assert!(camera.forward().y > ahead.y, "upwards");
        let before = camera;
        camera.fly(DVec3::splat(f64::NAN));
        camera.look(f64::NAN, f64::INFINITY);
        assert_eq!(camera, before);
    }

    #[test]
    fn pan_moves_the_target_by_view_heights() {
        let mut camera = Camera::default();
        let before = camera.target;
        camera.pan(0.25, 0.5);
        let [x, y] = camera.project(before, 1.5).expect("in front of the eye");
        assert!((x + 0.5 / 1.5).abs() < 1e-12 && (y + 1.0).abs() < 1e-12);
    }

    #[test]
    fn senseless_input_changes_nothing() {
        let before = Camera::default();
        let mut camera = before;
        camera.orbit(f64::NAN, 1.0);
        camera.pan(f64::INFINITY, 0.0);
        camera.zoom(0.0);
        camera.zoom(-1.0);
        camera.zoom(f64::NAN);
        camera.frame(DVec3::NAN, 1.0);
        camera.frame(DVec3::ZERO, f64::INFINITY);
        assert_eq!(camera, before);
        camera.frame(DVec3::ZERO, 0.0);
        assert!(camera.distance > 0.0);
    }
}
