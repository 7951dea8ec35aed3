//! A ball against one mesh.
//!
//! The distance of a moving point from a triangle is a convex function of time. A tangent lies below the function, so
//! Newton's method from before the contact never goes past it. One loop serves faces, edges and vertices; a point is a
//! ball of radius zero. All arithmetic is f64. Distances are right to within 2^-49 times the sum of the magnitudes of
//! coordinates, radius and motion, except for triangles with angles as small as that.

use core::ops::ControlFlow;
use glam::DVec3;

use super::{placement::is_in_range, snap, solid::each_in_box};
use crate::{
    Aabb,
    bvh::{Bvh, LEAF, MAX_DEPTH},
};

/// The first contact of a moving ball with a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallTouch {
    /// The part of the motion before the contact, 0 to 1, rounded down.
    pub time: f64,
    /// The point of the mesh that is touched, in the mesh's frame, m (rounded).
    pub point: DVec3,
    /// Unit normal from the mesh to the ball (rounded).
    pub normal: DVec3,
    /// The triangle of the mesh that is touched; if an edge or a vertex is touched, one of its triangles.
    pub face: u32,
}

/// The first entering contact of a mesh with a ball about `centre` that moves by `motion`, all in the mesh's frame, m.
/// `None` if there is no contact within the motion, if a number is not finite or beyond 1e100 m, or if the radius is
/// negative.
///
/// At an entering contact the motion leads towards the feature that is touched. A ball that overlaps the surface at the
/// start touches it at time 0, or not at all if it moves away. Before the returned time the distance is more than the
/// radius, up to 2^-48 times the sum of the magnitudes of all coordinates, the radius and the motion. The true contact
/// is not before the returned time, and later at most by the time that this length takes at the normal speed.
pub fn ball_touch(mesh: &Bvh, centre: DVec3, radius: f64, motion: DVec3) -> Option<BallTouch> {
    if !(is_ball(centre, radius) && is_in_range(motion)) {
        return None;
    }
    let (centre, motion) = (snap(centre), snap(motion));
    let ball = Ball {
        centre,
        radius,
        motion,
    };
    let mut best: Option<BallTouch> = None;
    // Near the border of a face, an edge is as near as the face up to rounding, and rounding turns the normal of an
    // edge. So contacts with the normal of a face are also kept separately.
    let mut best_upright: Option<BallTouch> = None;
    let mut error: f64 = 0.0;
    // The nearest node is on top.
    let mut stack = [(0.0, mesh.root()); 3 * MAX_DEPTH + 1];
    let mut top = 1;
    while top > 0 {
        top -= 1;
        let (entry, code) = stack[top];
        let horizon = best.map_or(1.0, |best| best.time);
        if entry > horizon {
            continue;
        }
        let node = mesh.node(code);
        let first = top;
        for lane in node.lanes() {
            let Some(entry) = ball.entry(&node.boxes.bounds(lane), horizon) else {
                continue;
            };
            if code & LEAF == 0 {
                let farther = |&(other, _): &(f64, u32)| other >= entry;
                let place = first + stack[first..top].iter().take_while(|x| farther(x)).count();
                stack.copy_within(place..top, place + 1);
                stack[place] = (entry, node.child[lane]);
                top += 1;
                continue;
            }
            let triangles = mesh.triangles(node);
            let corners = triangles.corners(lane).map(|v| v.as_dvec3());
            let latest = best.map(|best| best.time);
            let Some((touch, is_upright, own)) = ball.touch(triangles.face[lane], corners, latest)
            else {
                continue;
            };
            error = error.max(own);
            let first = |old: Option<BallTouch>| match old {
                Some(old) if !ball.is_before(&touch, &old) => Some(old),
                _ => Some(touch),
            };
            if is_upright {
                best_upright = first(best_upright);
            }
            best = first(best);
        }
    }
    let (first, upright) = (best?, best_upright);
    // The time of each contact is early by up to twice the error.
    let is_tie = |upright: &BallTouch| {
        let speed = -upright.normal.dot(motion);
        (upright.time - first.time) * speed <= 2.0 * error
    };
    upright.filter(is_tie).or(best)
}

/// Whether a closed ball and the surface of a mesh share a point, in the mesh's frame, m: whether the distance, rounded
/// as in [`ball_touch`], is at most the radius.
pub fn ball_meets(mesh: &Bvh, centre: DVec3, radius: f64) -> bool {
    if !is_ball(centre, radius) {
        return false;
    }
    let reach = DVec3::splat(radius.next_up());
    let (min, max) = (centre - reach, centre + reach);
    let visit = |_, corners: [glam::Vec3; 3]| {
        let nearest = nearest(centre, corners.map(|v| v.as_dvec3()));
        if (centre - nearest).length() <= radius {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    };
    each_in_box(mesh, min, max, visit).is_break()
}

fn is_ball(centre: DVec3, radius: f64) -> bool {
    is_in_range(centre) && (0.0..=1e100).contains(&radius)
}

struct Ball {
    centre: DVec3,
    radius: f64,
    motion: DVec3,
}

/// Whether an error, m, is large enough for bounds axis by axis: more than a nanometre, and than 1e-9 of the radius.
pub(crate) fn is_told_by_axis(error: f64, radius: f64) -> bool {
    error > 1e-9 * radius.max(1.0)
}

/// A centre over a triangle: its height above the plane along the normal, m, and the error of the height.
#[derive(Clone, Copy)]
struct Over {
    normal: DVec3,
    height: f64,
    error: f64,
}

/// Newton's method at least halves the distance from a double root in each step. So it reaches the rounding of the
/// distances in fewer steps than this.
const MOST_STEPS: u32 = 64;

impl Ball {
    /// A bound on the rounding of the distance from a triangle at a corner, m.
    fn error(&self, corner: DVec3) -> f64 {
        let size = self.centre.abs() + self.motion.abs() + corner.abs();
        (size.element_sum() + self.radius) * 8.0 * f64::EPSILON
    }

    /// The same along a unit vector: a triangle that is long on one axis does not add to the error along another.
    fn error_along(&self, [a, b, c]: [DVec3; 3], unit: DVec3) -> f64 {
        let corner = a.abs().max(b.abs()).max(c.abs());
        let size = self.centre.abs() + self.motion.abs() + corner + DVec3::splat(self.radius);
        size.dot(unit.abs()) * 8.0 * f64::EPSILON
    }

    /// The height of a centre over a long triangle, if it is over the triangle up to `most`, m. `apart` is the vector
    /// from the nearest point of the triangle to the centre.
    fn over(&self, apart: DVec3, centre: DVec3, corners: [DVec3; 3], most: f64) -> Option<Over> {
        let [a, b, c] = corners;
        let (u, v) = (b - a, c - a);
        let across = u.cross(v);
        let normal = unit(across)?;
        let height = apart.dot(normal);
        let aside = (apart - height * normal).length();
        if aside > most && !is_inside(centre, corners) {
            return None;
        }
        // A bound on the rotation of the normal by rounding, by axis. `apart` includes the rounding along the triangle.
        let products = |i: usize, j: usize| (u[i] * v[j]).abs() + (u[j] * v[i]).abs();
        let turned = DVec3::new(products(1, 2), products(2, 0), products(0, 1)) / across.length();
        let turned = 8.0 * f64::EPSILON * apart.abs().dot(turned);
        let error = self.error_along(corners, normal) + turned;
        Some(Over {
            normal,
            height,
            error: error.min(most),
        })
    }

    /// A lower bound on the time at which the ball may reach the contents of a box; `None` if it is after the horizon.
    fn entry(&self, bounds: &Aabb, horizon: f64) -> Option<f64> {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let reach = self.radius + 2.0 * self.error(min.abs().max(max.abs()));
        let (mut enter, mut leave) = (0.0_f64, horizon);
        for axis in 0..3 {
            let near = min[axis] - reach - self.centre[axis];
            let far = max[axis] + reach - self.centre[axis];
            let inverse = 1.0 / self.motion[axis];
            if inverse.is_finite() {
                let (s, t) = (near * inverse, far * inverse);
                // Both are rounded twice; the times that count are positive.
                enter = enter.max(s.min(t) * (1.0 - 2.0 * f64::EPSILON));
                leave = leave.min(s.max(t) * (1.0 + 2.0 * f64::EPSILON));
            } else if near > 0.0 || far < 0.0 {
                return None;
            }
        }
        (enter <= leave).then_some(enter)
    }

    /// The contact with a triangle within the motion, if it is no later than the time `other` up to rounding. Also
    /// whether its normal is that of the triangle, and the error of the distance, m.
    fn touch(
        &self,
        face: u32,
        corners: [DVec3; 3],
        other: Option<f64>,
    ) -> Option<(BallTouch, bool, f64)> {
        let [a, b, c] = corners;
        let across = (b - a).cross(c - a);
        let error = self.error(a.abs().max(b.abs()).max(c.abs()));
        let is_long = is_told_by_axis(error, self.radius);
        let mut time = 0.0;
        let mut last = None;
        for _ in 0..MOST_STEPS {
            let centre = self.centre + time * self.motion;
            let point = nearest(centre, corners);
            let apart = square(centre - point, (centre, point), corners);
            let distance = apart.length();
            // Over a face, use the face's normal: neither a small distance nor rounding sideways spoils it. At an
            // edge, once the ball is there, use the last normal: the direction to a nearest point at distance zero is
            // only rounding.
            let side = apart.dot(across);
            let upright = || {
                let normal = unit(across)? * libm::copysign(1.0, side);
                let aside = (apart - distance * normal).length();
                (aside <= error || is_inside(centre, corners)).then_some(normal)
            };
            let over = is_long
                .then(|| self.over(apart, centre, corners, error))
                .flatten();
            let (normal, is_upright) = match (over, last) {
                (Some(over), Some((last, _))) if over.height.abs() <= over.error => (last, true),
                (Some(over), _) => (over.normal * libm::copysign(1.0, over.height), true),
                (None, Some(last)) if distance <= error => last,
                (None, None) if distance <= error => (unit(across)?, true),
                _ => match upright().filter(|_| side != 0.0) {
                    Some(normal) => (normal, true),
                    None => (apart / distance, false),
                },
            };
            let speed = -normal.dot(self.motion);
            if speed <= 0.0 {
                return None;
            }
            let (gap, error, point) = match over {
                Some(over) => {
                    let point = centre - over.height * over.normal;
                    (apart.dot(normal) - self.radius, over.error, point)
                }
                None if is_long => {
                    let along = self.error_along(corners, normal);
                    (distance - self.radius, error.min(along), point)
                }
                None => (distance - self.radius, error, point),
            };
            if gap <= error {
                let time = if time > 0.0 {
                    (time - error / speed).max(0.0)
                } else {
                    0.0
                };
                let touch = BallTouch {
                    time,
                    point,
                    normal,
                    face,
                };
                return (time <= 1.0).then_some((touch, is_upright, error));
            }
            time += gap / speed;
            let is_late = other.is_some_and(|other| time - 3.0 * error / speed > other);
            if is_late || time - error / speed > 1.0 {
                return None;
            }
            last = Some((normal, is_upright));
        }
        None
    }

    /// The order of contacts: by time, then by how much they oppose the motion, then by triangle.
    fn is_before(&self, new: &BallTouch, old: &BallTouch) -> bool {
        let along = |touch: &BallTouch| touch.normal.dot(self.motion);
        let order = new.time.total_cmp(&old.time);
        let order = order.then_with(|| along(new).total_cmp(&along(old)));
        order.then_with(|| new.face.cmp(&old.face)).is_lt()
    }
}

/// The point of a closed triangle that is nearest to `p`; the triangle may degenerate to a segment or a point. The
/// point is in the plane if it is inside (Ericson 2005, "Real-Time Collision Detection", sec. 5.1.5), else on an edge.
/// The result is the same to the bit for both orders of `b` and `c`, so that mirrored triangles, which have the
/// opposite winding, have mirrored points.
pub(crate) fn nearest(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let area = |x: DVec3, y: DVec3| normal.dot((x - p).cross(y - p));
    let parts = [area(b, c), area(c, a), area(a, b)];
    if normal != DVec3::ZERO && parts.iter().all(|&part| part > 0.0) {
        let whole = parts[0] + (parts[1] + parts[2]);
        return a + ((parts[1] / whole) * ab + (parts[2] / whole) * ac);
    }
    let on_edges = [(a, b), (a, c), (b, c)].map(|(a, b)| nearest_on_edge(p, a, b));
    let [x, y, z] = on_edges;
    // Lengths that round to the same number may belong to different vectors.
    let nearer = |x: DVec3, y: DVec3| {
        let key = |x: DVec3| {
            let DVec3 { x, y, z } = (p - x).abs();
            [x * x + y * y + z * z, x, y, z]
        };
        if key(y) < key(x) { y } else { x }
    };
    nearer(nearer(x, y), z)
}

/// The vector `apart` from the nearest point of a triangle to `p`, made perpendicular to the edge that has this point,
/// if it is on one. Rounding moves the point along the edge. This turns a short vector so much that a ball moving along
/// the edge would seem to move away from it.
fn square(apart: DVec3, (p, point): (DVec3, DVec3), [a, b, c]: [DVec3; 3]) -> DVec3 {
    let edges = [(a, b), (a, c), (b, c)];
    let is_between =
        |&(a, b): &(DVec3, DVec3)| point != a && point != b && nearest_on_edge(p, a, b) == point;
    match edges.into_iter().find(is_between) {
        Some((a, b)) => {
            let along = b - a;
            apart - (apart.dot(along) / along.length_squared()) * along
        }
        None => apart,
    }
}

/// The unit vector of a direction, exact along an axis.
fn unit(way: DVec3) -> Option<DVec3> {
    let unit = way / way.length();
    unit.is_finite().then_some(unit)
}

/// Whether the point of a triangle that is nearest to `p` is on none of its edges.
fn is_inside(p: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let normal = (b - a).cross(c - a);
    let area = |x: DVec3, y: DVec3| normal.dot((x - p).cross(y - p));
    normal != DVec3::ZERO && area(b, c) > 0.0 && area(c, a) > 0.0 && area(a, b) > 0.0
}

/// The nearest point of an edge. It is computed from the nearer end, so the order of the ends does not matter.
fn nearest_on_edge(p: DVec3, a: DVec3, b: DVec3) -> DVec3 {
    let along = b - a;
    let length = along.length_squared();
    let (from_a, from_b) = ((p - a).dot(along), (b - p).dot(along));
    if from_a <= 0.0 {
        a
    } else if from_b <= 0.0 {
        b
    } else if from_a < from_b {
        a + (from_a / length) * along
    } else if from_b < from_a {
        b - (from_b / length) * along
    } else {
        0.5 * (a + b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::{cube, sphere};
    use alloc::vec;

    fn v(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }

    #[test]
    fn balls_touch_faces_edges_and_vertices() {
        let cube = Bvh::build(&cube());
        let root = core::f64::consts::FRAC_1_SQRT_2;
        let third = v(1.0, 1.0, 1.0).normalize();
        for (radius, from, motion, time, normal) in [
            (0.5, v(3.0, 0.1, 0.2), v(-4.0, 0.0, 0.0), 0.5, DVec3::X),
            (0.0, v(3.0, 0.1, 0.2), v(-5.0, 0.0, 0.0), 0.5, DVec3::X),
            (0.0, v(3.0, 0.0, 0.0), v(-5.0, 0.0, 0.0), 0.5, DVec3::X),
            (0.1, v(2.6, 0.0, 0.0), v(-4.0, 0.0, 0.0), 0.5, DVec3::X),
            (
                1.0,
                v(0.5 + 3.0 * root, 0.5 + 3.0 * root, 0.0),
                v(-4.0 * root, -4.0 * root, 0.0),
                0.5,
                v(root, root, 0.0),
            ),
            (
                1.0,
                DVec3::splat(0.5) + 3.0 * third,
                -4.0 * third,
                0.5,
                third,
            ),
            (1.0, v(1.5, 0.0, 0.0), v(-1.0, 0.2, 0.0), 0.0, DVec3::X),
            (0.0, v(0.5, 0.1, 0.2), v(-1.0, 0.2, 0.0), 0.0, DVec3::X),
        ] {
            let touch = ball_touch(&cube, from, radius, motion).unwrap();
            assert!(touch.time <= time && touch.time > time - 1e-13, "{touch:?}");
            assert!((touch.normal - normal).length() < 1e-13, "{touch:?}");
            let at = from + touch.time * motion - radius * normal;
            assert!((touch.point - at).length() < 1e-13, "{touch:?}");
        }
    }

    /// The ball is beside an edge, a tenth of a nanometre above a face, and moves along the edge.
    #[test]
    fn what_moves_along_an_edge_touches_the_face_beside_it() {
        let corner = |x: f32, y: f32, z: f32| crate::Vec3::new(x, y, z);
        let corners = vec![
            corner(-0.43301263, 0.49999997, -0.75000006),
            corner(0.433013, -0.50000006, -0.7499998),
            corner(-0.4330126, -0.50000006, -0.75),
        ];
        let face = Bvh::build(&crate::Mesh::new(corners, vec![[0, 1, 2]]).unwrap());
        let from = v(
            -0.4330126240876674,
            0.14997237507681924,
            -0.7500000387347324,
        );
        let to = v(
            -0.4330126240688852,
            0.14997158591157433,
            -0.7500000387671764,
        );
        let touch = ball_touch(&face, from, 0.0, to - from).unwrap();
        assert!((touch.time - 0.2044).abs() < 1e-3, "{touch:?}");
    }

    #[test]
    fn what_parts_slides_or_passes_touches_nothing() {
        let cube = Bvh::build(&cube());
        for (radius, from, motion) in [
            (1.0, v(1.5, 0.0, 0.0), v(1.0, 0.2, 0.0)),
            (1.0, v(1.5, 0.0, 0.0), v(0.0, 0.2, 0.0)),
            (0.0, v(0.5, 0.0, 0.0), v(1.0, 0.2, 0.0)),
            (0.5, v(3.0, 1.0 + 1e-12, 0.0), v(-6.0, 0.0, 0.0)),
            (0.5, v(3.0, 0.0, 0.0), v(-1.9, 0.0, 0.0)),
            (0.5, v(3.0, 0.0, 0.0), DVec3::ZERO),
            (-0.5, v(1.0, 0.0, 0.0), DVec3::NEG_X),
            (f64::NAN, v(1.0, 0.0, 0.0), DVec3::NEG_X),
            (0.5, v(f64::NAN, 0.0, 0.0), DVec3::NEG_X),
        ] {
            assert_eq!(ball_touch(&cube, from, radius, motion), None, "{from}");
        }
    }

    /// The mirror image of a triangle has the opposite winding. Contacts are the same to the bit.
    #[test]
    fn mirrored_triangles_are_touched_alike() {
        let mut random = crate::test_random::Random(0x9e37_79b9_7f4a_7c15);
        let mut hits = 0;
        for round in 0..20_000 {
            // On a lattice, where the distances to two edges are often equal; and anywhere.
            let (most, unit) = [(3, 0.5), (1 << 20, 0.5_f64.powi(19))][round % 2];
            let corners = [0; 3].map(|_| random.vector(most) * unit);
            let (from, aim) = (random.vector(3 * most) * unit, random.vector(most) * unit);
            let touch = |mirror: DVec3, order: [usize; 3]| {
                let corners = order.map(|i| mirror * corners[i]);
                let ball = Ball {
                    centre: mirror * from,
                    radius: 0.3,
                    motion: mirror * (1.5 * aim - 1.5 * from),
                };
                let (touch, ..) = ball.touch(0, corners, None)?;
                Some((touch.time, mirror * touch.point, mirror * touch.normal))
            };
            let plain = touch(DVec3::ONE, [0, 1, 2]);
            hits += u32::from(plain.is_some());
            for axis in DVec3::AXES {
                let mirrored = touch(DVec3::ONE - 2.0 * axis, [0, 2, 1]);
                assert_eq!(mirrored, plain, "{round} {corners:?} {from} {aim}");
            }
        }
        assert!(hits > 4000, "{hits}");
    }

    #[test]
    fn balls_are_apart_before_the_touch_and_meet_after() {
        let mesh = Bvh::build(&sphere(12));
        let mut hits = 0;
        for i in 0..2000 {
            let angle = f64::from(i) * 0.7;
            let height = 0.0013 * f64::from(i) - 1.3;
            let from = v(4.0 * libm::cos(angle), 4.0 * libm::sin(angle), height);
            let motion = v(-0.9, 0.1, -0.05) * from;
            let radius = [0.0, 1e-9, 0.01, 0.5, 2.0][i as usize % 5];
            let meets = |t: f64| ball_meets(&mesh, from + t * motion, radius);
            match ball_touch(&mesh, from, radius, motion) {
                Some(touch) => {
                    hits += 1;
                    assert!((0..20).all(|k| !meets((touch.time - 1e-12) * f64::from(k) / 19.0)));
                    // A point is on a surface only for an instant, and a small ball not for long.
                    assert!(radius < 1e-6 || meets(touch.time + 1e-7), "{i} {touch:?}");
                    assert!(touch.normal.dot(motion) < 0.0);
                }
                None => assert!((0..=1000).all(|k| !meets(f64::from(k) * 1e-3)), "{i}"),
            }
        }
        assert!(hits > 100);
    }

    /// Plates 0.1 mm thick and up to 1e30 m long are hit at the same time as short ones.
    #[test]
    fn long_plates_are_hit_no_earlier_than_short_ones() {
        let cube = cube();
        for (axis, along) in [(0, 1), (1, 2), (2, 0), (0, 2), (1, 0), (2, 1)] {
            for long in [1.0, 1e6, 1e12, 1e15, 1e17, 1e30] {
                let mut size = crate::Vec3::splat(3.0);
                (size[axis], size[along]) = (f32::powi(0.5, 13), long as f32);
                let corners = cube.vertices().iter().map(|&v| v * size).collect();
                let plate = crate::Mesh::new(corners, cube.triangles().to_vec()).unwrap();
                for radius in [0.0, 1e-3, 0.5] {
                    let mut unit = DVec3::ZERO;
                    unit[axis] = 1.0;
                    let from = v(0.1, -0.2, 0.3) * (1.0 - unit) - 4.0 * unit;
                    let touch = ball_touch(&Bvh::build(&plate), from, radius, 16.0 * unit);
                    let exact = (4.0 - 0.5_f64.powi(14) - radius) / 16.0;
                    let touch = touch.unwrap();
                    assert!(touch.time <= exact, "{touch:?}, not {exact}");
                    // A nanometre is too small to show.
                    assert!(exact - touch.time < 1e-10, "{long}: {touch:?}, not {exact}");
                    assert_eq!(touch.normal, -unit);
                }
            }
        }
    }

    /// The time at which a moving point reaches a given distance from a triangle: from the plane of a face inside its
    /// border, from the line of an edge between its ends, or from a corner.
    fn closed_form(p: DVec3, d: DVec3, radius: f64, corners: [DVec3; 3]) -> Option<f64> {
        let mut times = vec![];
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize();
        let edges = [(a, b), (b, c), (c, a)];
        for side in [radius, -radius] {
            let time = (side - normal.dot(p - a)) / normal.dot(d);
            let at = p + time * d;
            if edges
                .iter()
                .all(|&(a, b)| normal.dot((b - a).cross(at - a)) >= 0.0)
            {
                times.push(time);
            }
        }
        // The lesser root of |x + t y|² = r².
        let root = |x: DVec3, y: DVec3| {
            let (half, square) = (x.dot(y), y.length_squared());
            let inner = half * half - square * (x.length_squared() - radius * radius);
            (inner >= 0.0).then(|| (-half - libm::sqrt(inner)) / square)
        };
        for (a, b) in edges {
            let along = (b - a).normalize();
            let off = |v: DVec3| v - along.dot(v) * along;
            let time = root(off(p - a), off(d));
            times.extend(time.filter(|&t| {
                let part = along.dot(p + t * d - a);
                (0.0..=(b - a).length()).contains(&part)
            }));
            times.extend(root(p - a, d));
        }
        let ahead = |t: &f64| (0.0..=1.0).contains(t);
        times.into_iter().filter(ahead).min_by(f64::total_cmp)
    }

    #[test]
    fn balls_touch_when_closed_forms_say_so() {
        let mesh = sphere(8);
        let tree = Bvh::build(&mesh);
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        let mut random = |most: f64| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            ((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0) * most
        };
        let (mut hits, mut asked) = (0, 0);
        while asked < 1000 {
            let from = v(random(3.0), random(3.0), random(3.0));
            let motion = v(random(1.0), random(1.0), random(1.0)) - 1.2 * from;
            let radius = 0.4 * (random(1.0) + 1.0);
            if from.length() < 1.1 + radius {
                continue;
            }
            asked += 1;
            let corners = |i: usize| mesh.corners(i).map(|v| v.as_dvec3());
            let times = (0..mesh.triangles().len())
                .filter_map(|i| closed_form(from, motion, radius, corners(i)));
            let exact = times.min_by(f64::total_cmp);
            let touch = ball_touch(&tree, from, radius, motion).map(|touch| touch.time);
            assert_eq!(touch.is_some(), exact.is_some(), "{from} {motion} {radius}");
            if let Some((time, exact)) = touch.zip(exact) {
                hits += 1;
                // A grazing contact has an error of the square root of the rounding.
                assert!((time - exact).abs() < 1e-7, "{time} {exact}");
                assert!(time <= exact + 1e-14, "{time} is later than {exact}");
            }
        }
        assert!(hits > 300, "{hits}");
    }
}
