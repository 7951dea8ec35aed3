//! The feature of two moving meshes that touches first, and the contact normal that it gives.
//!
//! An impulse needs one normal where many edges and faces meet. The normal is that of the feature
//! that touches first along the relative motion of the step, because this feature stops the bodies;
//! the features that overlap at the end of the step depend on the length of the step instead.
//!
//! - A vertex in a face gives the face's normal; two crossing edges give their common perpendicular. The normal
//!   points from the first mesh to the second, against the motion.
//! - Of features that touch at the same time (times are known exactly and rounded down), a vertex in a face goes
//!   before two edges, because a face has a tangent plane of its own, while the perpendicular of two edges that end
//!   there may point anywhere. Of the rest, the feature whose normal opposes the motion most goes first, then the one
//!   that is first in the meshes.
//! - Edges that are parallel up to the rounding of placed vertices cross at a place that depends on this rounding, and
//!   their perpendicular has no meaning. The normal of the adjacent face that opposes the motion most replaces it.
//!
//! So a cube that meets a cube face-on gets the face's normal and bounces straight back, though four corners, and edges
//! with edges, touch at the same time.
//!
//! The motion is a translation, so every time of contact solves a linear equation. With the
//! second mesh moving by `d` and `h(x) = orient(a, b, c, x)`:
//!
//! ```text
//! vertex x in face abc:     t = -h(x) / (n·d),   n = (b-a) × (c-a)
//! edges a + s u, c + q w:   t = u·(w×m) / D,  s = m·(w×e) / D,  q = -u·(m×e) / D,
//!                           m = c - a,  e = -d,  D = u·(w×e)
//! ```

use glam::DVec3;

use super::{
    cuboids,
    placement::is_in_range,
    snap,
    sweep::{Kind, Search},
    tree,
};
use crate::bvh::Bvh;

/// The pair of features that touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// An edge of each mesh.
    EdgeEdge {
        /// Edge of the first mesh.
        first: u32,
        /// Edge of the second mesh.
        second: u32,
    },
}

impl Feature {
    /// The same pair with the meshes in the other order.
    pub(super) fn turned(self) -> Feature {
        match self {
            Feature::VertexFace { vertex, face } => Feature::FaceVertex { face, vertex },
            Feature::FaceVertex { face, vertex } => Feature::VertexFace { vertex, face },
            Feature::EdgeEdge { first, second } => Feature::EdgeEdge {
                first: second,
                second: first,
            },
        }
    }
}

/// The first contact along a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The part of the motion before the contact, 0 to 1, rounded down.
    pub time: f64,
    /// The contact point in the first mesh's frame, m (rounded).
    pub point: DVec3,
    /// Unit normal, from the first mesh to the second.
    pub normal: DVec3,
    /// The features that touch.
    pub feature: Feature,
}

/// The first entering contact of two meshes. The second one is displaced by `offset` and then moves by `motion` (m),
/// both in the first one's frame. `None` if there is no contact within the motion.
///
/// A contact enters if its normal opposes the motion and the meshes do not slip past each other there after a small
/// move to the side, which is decided exactly. To slide along a face is no contact, nor is to move away from a
/// surface that touches at the start. So meshes that are apart at the start and cross as soon as they touch have a
/// contact at their [`time_of_impact`]. The set of contacts is exact for the placed vertices ([`super::Placement`]);
/// the time is the greatest f64 that is not above the exact one ([`super::moving`]). If meshes meet at the start
/// without such a feature, this is not found. Components of `offset` and `motion` below 2^-250 m count as zero. A
/// component that is not a number or is beyond 1e100 m leaves the meshes apart.
pub fn first_touch(first: &Bvh, second: &Bvh, offset: DVec3, motion: DVec3) -> Option<Touch> {
    let (offset, motion) = in_range(offset, motion)?;
    if let Some((first, second)) = first.cuboid().zip(second.cuboid())
        && let Ok(touch) = cuboids::first_touch(first, second, offset, motion)
    {
        return touch;
    }
    Search::run(Kind::Entering, (first, second), offset, motion).best()
}

/// The time when the closed surfaces of two meshes first meet, as a part of the motion, 0 to 1; `None` if they do
/// not. The second mesh is displaced by `offset` and then moves by `motion` (m). Units, range and rounding are those
/// of [`first_touch`]; 0 if the meshes meet at the start.
///
/// It is exact, because surfaces that come to meet do so with a vertex in a triangle, or with two edges that cross in
/// one point and not along the motion. Proof: take triangles that touch for the first time, and a corner `p` of the
/// convex set that they share. Consider the least corners, edges or interiors that contain `p`. They have no
/// direction in common, so their dimensions add up to at most three. An interior and an edge would have met before,
/// displaced a little against the motion, and so would two edges in a plane along the motion. Of a triangle that is a
/// segment, the longest edge is the whole triangle.
pub fn time_of_impact(first: &Bvh, second: &Bvh, offset: DVec3, motion: DVec3) -> Option<f64> {
    let (offset, motion) = in_range(offset, motion)?;
    if tree::intersect(first, second, offset) {
        return Some(0.0);
    }
    Search::run(Kind::Any, (first, second), offset, motion).time()
}

fn in_range(offset: DVec3, motion: DVec3) -> Option<(DVec3, DVec3)> {
    (is_in_range(offset) && is_in_range(motion)).then(|| (snap(offset), snap(motion)))
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
        // Aligned, offset, overhanging, and slightly oblique.
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
