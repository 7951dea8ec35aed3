//! The feature of two moving meshes that touches first, and the contact normal that it gives.
//!
//! An impulse needs one normal where many edges and faces meet. The normal is that of the feature
//! that touches first along the relative motion of the step, because it is what stops the bodies;
//! what overlaps at the end of the step depends on the length of the step instead.
//!
//! - A vertex in a face gives the face's normal, two crossing edges give their common
//!   perpendicular; it is turned to point from the first mesh to the second, against the motion.
//! - Of features that touch at the same time, to within the rounding of the times, a vertex in a
//!   face goes before two edges, since a face has a tangent plane of its own where the
//!   perpendicular of two edges that end there may point anywhere. Of those left the one that
//!   opposes the motion most goes first, then the one that comes first in the meshes.
//!
//! So a cube that meets a cube face-on gets the face's normal and bounces straight back, though
//! four corners, and edges with edges, touch at once.
//!
//! The motion is a translation, so every time of contact solves a linear equation. With the
//! second mesh moving by `d` and `h(x) = orient(a, b, c, x)`:
//!
//! ```text
//! vertex x in face abc:     t = -h(x) / (n·d),   n = (b-a) × (c-a)
//! edges a + s u, c + q w:   t = u·(w×m) / D,  s = m·(w×e) / D,  q = -u·(m×e) / D,
//!                           m = c - a,  e = -d,  D = u·(w×e)
//! ```

use alloc::vec::Vec;
use core::ops::ControlFlow;
use glam::{DVec3, Vec3};

use super::{
    pairs::{Portable, TILE, Tiles, descend},
    snap,
};
use crate::bvh::{Boxes, Bvh, Slabs, WIDTH};

/// What touches what.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Feature {
    /// A vertex of the first mesh in a face of the second.
    VertexFace {
        /// Vertex of the first mesh.
        vertex: u32,
        /// Triangle of the second mesh.
        face: u32,
    },
    /// A vertex of the second mesh in a face of the first.
    FaceVertex {
        /// Triangle of the first mesh.
        face: u32,
        /// Vertex of the second mesh.
        vertex: u32,
    },
    /// An edge of each.
    EdgeEdge {
        /// Edge of the first mesh.
        first: u32,
        /// Edge of the second mesh.
        second: u32,
    },
}

/// The first contact along a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Part of the motion done at the contact, 0 to 1 (rounded).
    pub time: f64,
    /// Where, in the first mesh's frame, m (rounded).
    pub point: DVec3,
    /// Unit normal, from the first mesh to the second.
    pub normal: DVec3,
    /// What touches.
    pub feature: Feature,
}

/// The first contact of two meshes that are apart with the second displaced by `offset` and then
/// moving by `motion` (m), both in the first one's frame. `None` if they do not touch on the way.
pub fn first_touch(first: &Bvh, second: &Bvh, offset: DVec3, motion: DVec3) -> Option<Touch> {
    let mut search = Search {
        first,
        second,
        offset: snap(offset),
        motion,
        direction: motion.try_normalize()?,
        earliest: 1.0,
        found: Vec::new(),
    };
    let _ = descend(first, second, &mut search);
    search.best()
}

/// Candidates for the first contact.
struct Search<'a> {
    first: &'a Bvh,
    second: &'a Bvh,
    offset: DVec3,
    motion: DVec3,
    direction: DVec3,
    /// An upper bound of the earliest time.
    earliest: f64,
    /// Contacts that may be the earliest, with the rounding error of their times.
    found: Vec<(Touch, f64)>,
}

/// Bounds the rounding error of a triple product, relative to that of absolute values: three
/// differences, two multiplications, and the sums, doubled for the rounding of the bound itself.
const TRIPLE_ERROR: f64 = 16.0 * f64::EPSILON;

/// Times that differ by more are no tie, whatever the error of either. A contact whose time is known
/// worse than this, as its motion runs almost along the feature, loses to one that is known well,
/// though it may have been first by less than its error.
const LONGEST_TIE: f64 = 1e-9;

impl Tiles for Search<'_> {
    type Lanes = Portable;

    /// Boxes that meet no later than the earliest contact so far.
    fn boxes(&mut self, first: &Boxes, second: &Boxes) -> (u32, Portable) {
        let (mut bits, mut times) = (0, [f32::INFINITY; TILE]);
        for (pair, place) in times.iter_mut().enumerate() {
            let time = self.entry(first, pair / WIDTH, second, pair % WIDTH);
            if let Some(time) = time.filter(|&t| t <= self.earliest) {
                bits |= 1 << pair;
                *place = time as f32;
            }
        }
        (bits, Portable::new(times))
    }

    /// Slabs know nothing of motion.
    fn slabs(&self, _: (&Boxes, &Slabs), _: (&Boxes, &Slabs), pairs: u32) -> u32 {
        pairs
    }

    fn triangles(&mut self, first: u32, second: u32, mut pairs: u32) -> ControlFlow<()> {
        let (first, second) = (self.first.node(first), self.second.node(second));
        let (first, second) = (self.first.triangles(first), self.second.triangles(second));
        while pairs != 0 {
            let pair = pairs.trailing_zeros() as usize;
            pairs &= pairs - 1;
            let (i, j) = (pair / WIDTH, pair % WIDTH);
            self.try_triangles(
                (first.face[i], first.corners(i)),
                (second.face[j], second.corners(j)),
            );
        }
        ControlFlow::Continue(())
    }
}

impl Search<'_> {
    /// When two boxes begin to meet, rounded down; `None` if they do not within the motion.
    fn entry(&self, first: &Boxes, i: usize, second: &Boxes, j: usize) -> Option<f64> {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            let wide = |x: &[[f32; WIDTH]; 3], lane: usize| f64::from(x[axis][lane]);
            let (a, b) = (wide(&first.centre, i), wide(&second.centre, j));
            let reach = wide(&first.half, i) + wide(&second.half, j);
            if reach < 0.0 {
                return None;
            }
            let offset = self.offset[axis];
            let between = a - (b + offset);
            let (near, far) = (between - reach, between + reach);
            let slack = 8.0 * f64::EPSILON * (a.abs() + b.abs() + reach + offset.abs());
            let (near, far) = (near - slack, far + slack);
            let motion = self.motion[axis];
            let inverse = 1.0 / motion;
            if inverse.is_finite() {
                let (s, t) = (near * inverse, far * inverse);
                // One more rounding than the slack has seen.
                enter = enter.max(s.min(t) * (1.0 - f64::EPSILON));
                leave = leave.min(s.max(t) * (1.0 + f64::EPSILON));
            } else if near > 0.0 || far < 0.0 {
                return None;
            }
        }
        (enter <= leave).then_some(enter)
    }

    fn try_triangles(&mut self, (s_face, s): (u32, [Vec3; 3]), (t_face, t): (u32, [Vec3; 3])) {
        let first = s.map(|v| v.as_dvec3());
        let second = t.map(|v| v.as_dvec3() + self.offset);
        let (s, t) = (self.first.topology(), self.second.topology());
        let (s_owned, t_owned) = (s.owned[s_face as usize], t.owned[t_face as usize]);
        let (s_vertices, t_vertices) = (s.triangles[s_face as usize], t.triangles[t_face as usize]);
        let (s_edges, t_edges) = (
            s.triangle_edges[s_face as usize],
            t.triangle_edges[t_face as usize],
        );
        for i in (0..3).filter(|&i| t_owned.vertex[i]) {
            let feature = Feature::FaceVertex {
                face: s_face,
                vertex: t_vertices[i],
            };
            self.vertex_face(second[i], first, self.motion, feature);
        }
        for i in (0..3).filter(|&i| s_owned.vertex[i]) {
            let feature = Feature::VertexFace {
                vertex: s_vertices[i],
                face: t_face,
            };
            self.vertex_face(first[i], second, -self.motion, feature);
        }
        for i in (0..3).filter(|&i| s_owned.edge[i]) {
            for j in (0..3).filter(|&j| t_owned.edge[j]) {
                let feature = Feature::EdgeEdge {
                    first: s_edges[i],
                    second: t_edges[j],
                };
                let ends = [first[i], first[(i + 1) % 3], second[j], second[(j + 1) % 3]];
                self.edge_edge(ends, feature);
            }
        }
    }

    /// A point moving by `d` against a triangle at rest.
    fn vertex_face(&mut self, x: DVec3, [a, b, c]: [DVec3; 3], d: DVec3, feature: Feature) {
        let normal = (b - a).cross(c - a);
        let (height, height_error) = triple(b - a, c - a, x - a);
        let (fall, fall_error) = triple(b - a, c - a, d);
        let sides = [(a, b), (b, c), (c, a)].map(|(a, b)| triple(d, a - x, b - x));
        let outside = |sign: f64| sides.iter().any(|&(s, error)| sign * s > error);
        if outside(1.0) && outside(-1.0) {
            return;
        }
        let moving = matches!(feature, Feature::FaceVertex { .. });
        let place = |t: f64| if moving { x + t * d } else { x };
        self.add(
            (-height, height_error),
            (fall, fall_error),
            normal,
            place,
            feature,
        );
    }

    fn edge_edge(&mut self, [a, b, c, e]: [DVec3; 4], feature: Feature) {
        let (u, w, m, back) = (b - a, e - c, c - a, -self.motion);
        let (det, det_error) = triple(u, w, back);
        let (time, time_error) = triple(u, w, m);
        let (on_first, on_first_error) = triple(m, w, back);
        let (on_second, on_second_error) = triple(m, u, back);
        let within = |x: f64, error: f64| {
            let x = if det < 0.0 { -x } else { x };
            x >= -error && x <= det.abs() + error + det_error
        };
        if !within(on_first, on_first_error) || !within(on_second, on_second_error) {
            return;
        }
        let place = |_| a + (on_first / det).clamp(0.0, 1.0) * u;
        self.add(
            (time, time_error),
            (det, det_error),
            u.cross(w),
            place,
            feature,
        );
    }

    /// Notes the contact at time `numerator / denominator`, if it may be the earliest.
    fn add(
        &mut self,
        (numerator, numerator_error): (f64, f64),
        (denominator, denominator_error): (f64, f64),
        normal: DVec3,
        place: impl Fn(f64) -> DVec3,
        feature: Feature,
    ) {
        // Motion along the feature never enters it.
        if denominator.abs() <= denominator_error {
            return;
        }
        let time = numerator / denominator;
        // By the least that the true denominator can be.
        let error = (numerator_error + time.abs() * denominator_error)
            / (denominator.abs() - denominator_error);
        if time < -error || time - error > self.earliest {
            return;
        }
        let Some(normal) = normal.try_normalize() else {
            return;
        };
        let time = time.clamp(0.0, 1.0);
        self.earliest = self.earliest.min(time + error);
        let against = if normal.dot(self.motion) < 0.0 {
            normal
        } else {
            -normal
        };
        let touch = Touch {
            time,
            point: place(time),
            normal: against,
            feature,
        };
        self.found.push((touch, error));
    }

    fn best(mut self) -> Option<Touch> {
        let earliest = self.earliest;
        // A time that is known badly (motion almost along the feature) does not tie with all others.
        self.found
            .retain(|(touch, error)| touch.time - error.min(LONGEST_TIE) <= earliest);
        let rank = |touch: &Touch| {
            let edges = matches!(touch.feature, Feature::EdgeEdge { .. });
            (edges, touch.normal.dot(self.direction), touch.feature)
        };
        let first = |x: &Touch, y: &Touch| {
            let ((edges_x, along_x, feature_x), (edges_y, along_y, feature_y)) = (rank(x), rank(y));
            edges_x
                .cmp(&edges_y)
                .then(along_x.total_cmp(&along_y))
                .then(feature_x.cmp(&feature_y))
        };
        self.found.into_iter().map(|(touch, _)| touch).min_by(first)
    }
}

/// `a·(b × c)` and a bound of its rounding error.
fn triple(a: DVec3, b: DVec3, c: DVec3) -> (f64, f64) {
    let value = a.x * (b.y * c.z - b.z * c.y)
        + a.y * (b.z * c.x - b.x * c.z)
        + a.z * (b.x * c.y - b.y * c.x);
    let (a, b, c) = (a.abs(), b.abs(), c.abs());
    let size = a.x * (b.y * c.z + b.z * c.y)
        + a.y * (b.z * c.x + b.x * c.z)
        + a.z * (b.x * c.y + b.y * c.x);
    (value, TRIPLE_ERROR * size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collide::tree;
    use crate::test_meshes::{cube, sphere};
    use glam::DQuat;

    fn cubes(offset: DVec3, motion: DVec3) -> Option<Touch> {
        let cube = Bvh::build(&cube());
        first_touch(&cube, &cube, offset, motion)
    }

    fn v(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }

    #[test]
    fn cubes_face_on_touch_along_the_face_normal() {
        // Aligned, offset, overhanging, and not quite straight on.
        for (y, z) in [
            (0.0, 0.0),
            (0.3, 0.2),
            (0.5, -0.5),
            (0.999, 0.0),
            (-0.25, 1e-9),
            (1e-17, 0.0),
        ] {
            for slant in [0.0, 1e-3, -0.2] {
                let touch = cubes(v(3.0, y, z), v(-4.0, slant, 0.0)).unwrap();
                assert_eq!(touch.normal, DVec3::X, "{y} {z} {slant}: {touch:?}");
                assert!((touch.time - 0.5).abs() < 1e-15);
                assert!((touch.point.x - 0.5).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn a_corner_gets_the_normal_of_the_face_it_meets() {
        let corner_first = DQuat::from_rotation_arc(v(1.0, 1.0, 1.0).normalize(), DVec3::NEG_X);
        let tilted = Bvh::build(&cube().transformed(corner_first, DVec3::ONE).unwrap());
        let straight = Bvh::build(&cube());
        let touch = first_touch(&straight, &tilted, v(3.0, 0.1, 0.2), v(-4.0, 0.3, 0.0)).unwrap();
        assert!(
            matches!(touch.feature, Feature::FaceVertex { .. }),
            "{touch:?}"
        );
        assert_eq!(touch.normal, DVec3::X);
        let back = first_touch(&tilted, &straight, v(-3.0, -0.1, -0.2), v(4.0, -0.3, 0.0)).unwrap();
        assert!(matches!(back.feature, Feature::VertexFace { .. }));
        assert_eq!(back.normal, DVec3::NEG_X);
        assert!((back.time - touch.time).abs() < 1e-15);
    }

    #[test]
    fn crossing_edges_get_their_common_perpendicular() {
        let turn = |axis, angle| {
            let turned = cube().transformed(DQuat::from_axis_angle(axis, angle), DVec3::ONE);
            Bvh::build(&turned.unwrap())
        };
        let eighth = core::f64::consts::FRAC_PI_4;
        // One cube has an edge along z in front, the other one along y.
        let (first, second) = (turn(DVec3::Z, eighth), turn(DVec3::Y, eighth));
        let touch = first_touch(&first, &second, v(3.0, 0.1, 0.05), v(-3.0, 0.0, 0.0)).unwrap();
        assert!(
            matches!(touch.feature, Feature::EdgeEdge { .. }),
            "{touch:?}"
        );
        assert!((touch.normal - DVec3::X).length() < 1e-7);
        let gap = 3.0 - 2.0 * core::f64::consts::FRAC_1_SQRT_2;
        assert!((touch.time - gap / 3.0).abs() < 1e-7);
    }

    #[test]
    fn no_touch_without_way_or_motion() {
        assert_eq!(cubes(v(3.0, 0.0, 0.0), DVec3::ZERO), None);
        assert_eq!(cubes(v(3.0, 0.0, 0.0), v(-1.9, 0.0, 0.0)), None);
        assert_eq!(cubes(v(3.0, 1.1, 0.0), v(-6.0, 0.0, 0.0)), None);
        assert_eq!(cubes(v(3.0, 0.0, 0.0), v(5.0, 0.0, 0.0)), None);
    }

    #[test]
    fn bodies_are_apart_before_the_touch_and_meet_after() {
        let (ball, cube) = (Bvh::build(&sphere(12)), Bvh::build(&cube()));
        for i in 0..200 {
            let angle = f64::from(i) * 0.7;
            let offset = v(
                4.0 * libm::cos(angle),
                4.0 * libm::sin(angle),
                0.013 * f64::from(i) - 1.3,
            );
            let motion = v(-0.9, 0.1, -0.05) * offset;
            let touch = first_touch(&ball, &cube, offset, motion);
            let at = |t: f64| tree::intersect(&ball, &cube, offset + t * motion);
            match touch {
                Some(t) => {
                    assert!(!at(t.time - 1e-9) && at(t.time + 1e-9), "{i} {t:?}");
                    assert!(t.normal.dot(motion) < 0.0 && (t.normal.length() - 1.0).abs() < 1e-15);
                }
                None => assert!((0..=1000).all(|s| !at(f64::from(s) * 1e-3)), "{i}"),
            }
        }
    }
}
