//! Rays and points against a BVH: picking, line of sight, inside and outside.

use core::array;
use glam::{DVec3, Vec3, Vec4};

use super::{Boxes, Bvh, LEAF, MAX_DEPTH, Triangles, WIDTH};
use crate::Aabb;

/// The hit of a ray on a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// The point is `origin + t direction`.
    pub t: f64,
    /// Index of the triangle.
    pub face: u32,
}

impl Bvh {
    /// The nearest triangle on a ray, in the mesh's frame; either side of a face counts.
    ///
    /// Watertight: a ray through an edge or a corner meets a triangle there (Woop, Benthin, Wald
    /// 2013, "Watertight ray/triangle intersection"). A direction of zero, or below
    /// the normal range of f64, meets nothing.
    pub fn ray(&self, origin: DVec3, direction: DVec3) -> Option<RayHit> {
        Some(self.cast(origin, direction, (f64::INFINITY, false))?.0)
    }

    /// The same before a given time, with the corners of the triangle.
    pub(crate) fn ray_before(
        &self,
        origin: DVec3,
        direction: DVec3,
        within: f64,
    ) -> Option<(RayHit, [Vec3; 3])> {
        self.cast(origin, direction, (within, false))
    }

    /// Whether a ray meets any triangle: [`Bvh::ray`] without the search for the nearest.
    pub fn ray_meets(&self, origin: DVec3, direction: DVec3) -> bool {
        self.cast(origin, direction, (f64::INFINITY, true))
            .is_some()
    }

    /// The nearest hit before a given time, or any hit.
    fn cast(
        &self,
        origin: DVec3,
        direction: DVec3,
        (within, any): (f64, bool),
    ) -> Option<(RayHit, [Vec3; 3])> {
        let ray = Ray::new(origin, direction, self.bounds)?;
        let mut best: Option<(&Triangles, usize)> = None;
        let mut nearest = within / ray.scale;
        let mut leave = ray.up(nearest);
        let found = |nearest: f64, (triangles, lane): (&Triangles, usize)| {
            let (t, face) = (nearest * ray.scale, triangles.face[lane]);
            (RayHit { t, face }, triangles.corners(lane))
        };
        // Codes, and the times when the ray enters their boxes. Each level leaves at most three siblings.
        let mut stack = [(0, 0.0f32); 3 * MAX_DEPTH + 1];
        let (mut top, mut code) = (0, self.root());
        loop {
            let node = self.node(code);
            if code & LEAF == 0 {
                let enter = ray.enter(&node.boxes, leave);
                let first = top;
                for lane in node.lanes().filter(|&lane| enter[lane] < f32::INFINITY) {
                    // Farthest first, because the last one is visited next.
                    let mut place = top;
                    while place > first && stack[place - 1].1 < enter[lane] {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = (node.child[lane], enter[lane]);
                    top += 1;
                }
            } else {
                let triangles = self.triangles(node);
                let mut lanes = ray.may_meet(triangles);
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    let time = ray.meet(triangles, lane);
                    if time >= nearest {
                        continue;
                    }
                    nearest = time;
                    leave = ray.up(nearest);
                    best = Some((triangles, lane));
                    if any {
                        return Some(found(nearest, (triangles, lane)));
                    }
                }
            }
            loop {
                if top == 0 {
                    return Some(found(nearest, best?));
                }
                top -= 1;
                if stack[top].1 <= leave {
                    code = stack[top].0;
                    break;
                }
            }
        }
    }
}

/// A ray, scaled so that the largest component of its direction is one; `scale` converts its times back.
///
/// It tests boxes, and excludes most triangles that it misses, in f32, from a point at time `start` that is as near
/// to the mesh as the mesh is large. f64 decides the rest.
struct Ray {
    origin: DVec3,
    scale: f64,
    /// The last axis is that of the largest component; the shear that maps the ray to it.
    axes: [usize; 3],
    shear: [f64; 2],
    forward: f64,
    /// The time when the ray is at `near`.
    start: f64,
    near: Vec3,
    inverse: Vec3,
    /// A bound on the error of a coordinate in f32, relative to `near` or along the ray.
    blur: f32,
}

/// Replaces the inverse of a component near zero. The motion of a ray with such a component along the mesh is far
/// less than `blur`, and `blur` times this number is more than the size of the mesh.
const BEYOND: f32 = 1e18;

impl Ray {
    fn new(origin: DVec3, direction: DVec3, bounds: Aabb) -> Option<Ray> {
        let z = direction.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let largest = direction[z].abs();
        if largest < f64::MIN_POSITIVE || !direction.is_finite() || !origin.is_finite() {
            return None;
        }
        let along = direction / largest;
        let forward = along[z];
        let first = if forward > 0.0 {
            bounds.min[z]
        } else {
            bounds.max[z]
        };
        let start = ((f64::from(first) - origin[z]) * forward).max(0.0);
        let near = origin + start * along;
        // Eight roundings of 2^-24 to convert a coordinate into the frame of the ray, or a plane to a time; and the
        // roundings of f64, here and in `meet`.
        let size = f64::from(bounds.min.abs().max(bounds.max.abs()).max_element())
            + near.abs().max_element();
        let far = origin.abs().max_element() + start;
        let blur = f64::from(f32::EPSILON) * 8.0 * size + 16.0 * f64::EPSILON * far + 1e-30;
        let inverse = |d: f64| {
            let inverse = 1.0 / d as f32;
            inverse.clamp(-BEYOND, BEYOND)
        };
        Some(Ray {
            origin,
            scale: 1.0 / largest,
            axes,
            shear: [along[axes[0]] * forward, along[axes[1]] * forward],
            forward,
            start,
            near: near.as_vec3(),
            inverse: Vec3::new(inverse(along.x), inverse(along.y), inverse(along.z)),
            // If sums overflow, f32 excludes nothing.
            blur: if size < 1e37 {
                blur as f32
            } else {
                f32::INFINITY
            },
        })
    }

    /// A time relative to `near`, rounded up.
    #[inline]
    fn up(&self, time: f64) -> f32 {
        ((time - self.start) as f32).next_up()
    }

    /// The times when the ray enters four boxes, relative to `near` and rounded down; infinity if it does not before
    /// `leave`.
    #[inline]
    fn enter(&self, boxes: &Boxes, leave: f32) -> [f32; WIDTH] {
        let (mut enter, mut leave) = ([0.0_f32; WIDTH], [leave; WIDTH]);
        for axis in 0..3 {
            let (near, inverse) = (self.near[axis], self.inverse[axis]);
            for lane in 0..WIDTH {
                let middle = (boxes.centre[axis][lane] - near) * inverse;
                let reach = (boxes.half[axis][lane] + self.blur) * inverse.abs();
                let (first, last) = (middle - reach, middle + reach);
                // Beyond the range of f32 these are NaN, and exclude nothing.
                enter[lane] = if first > enter[lane] {
                    first
                } else {
                    enter[lane]
                };
                leave[lane] = if last < leave[lane] {
                    last
                } else {
                    leave[lane]
                };
            }
        }
        array::from_fn(|lane| {
            if enter[lane] <= leave[lane] {
                enter[lane].min(f32::MAX)
            } else {
                f32::INFINITY
            }
        })
    }

    /// The lanes of the triangles that the ray may meet, as bits: all except those that it certainly misses.
    #[inline]
    fn may_meet(&self, triangles: &Triangles) -> u32 {
        let [x, y, z] = self.axes;
        let blur = Vec4::splat(self.blur);
        let shear = self.shear.map(|shear| Vec4::splat(shear as f32));
        let corner = |k: usize| {
            let at = |axis: usize| Vec4::from(triangles.corners[k + axis]) - self.near[axis];
            let height = at(z);
            [at(x) - shear[0] * height, at(y) - shear[1] * height]
        };
        let [a, b, c] = [0, 3, 6].map(corner);
        let across = |p: [Vec4; 2], q: [Vec4; 2]| p[0] * q[1] - p[1] * q[0];
        let (u, v, w) = (across(c, b), across(a, c), across(b, a));
        let largest = |p: [Vec4; 2]| p[0].abs().max(p[1].abs());
        // Each factor errs by `blur`, each product by 2^-24, and so does their difference.
        let r = largest(a).max(largest(b)).max(largest(c)) + blur;
        let error = r * r * (8.0 * f32::EPSILON) + 6.0 * r * blur + f32::MIN_POSITIVE;
        let (low, high) = (u.min(v).min(w), u.max(v).max(w));
        !(low.cmplt(-error) & high.cmpgt(error)).bitmask() & ((1 << WIDTH) - 1)
    }

    /// The time when the ray meets a triangle; infinity if it does not.
    #[inline]
    fn meet(&self, triangles: &Triangles, lane: usize) -> f64 {
        // Transform the ray to the z axis: the largest component stays, the others are sheared off.
        let [x, y, z] = self.axes;
        let corner = |k: usize| {
            let at = |axis: usize| f64::from(triangles.corners[k + axis][lane]) - self.origin[axis];
            let height = at(z);
            [
                at(x) - self.shear[0] * height,
                at(y) - self.shear[1] * height,
                height,
            ]
        };
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = [0, 3, 6].map(corner);
        // The same products for both triangles at an edge, so that they agree about it.
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        let mixed = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
        let area = u + v + w;
        let time = (u * az + v * bz + w * cz) / area * self.forward;
        if !mixed && area != 0.0 && time >= 0.0 {
            time
        } else {
            f64::INFINITY
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, test_meshes};
    use alloc::vec::Vec;

    #[test]
    fn rays_find_the_nearest_face_of_a_cube() {
        let bvh = Bvh::build(&test_meshes::cube());
        let hit = bvh.ray(DVec3::new(-3.0, 0.1, 0.2), DVec3::X).unwrap();
        assert_eq!(hit.t, 2.5);
        assert!(bvh.ray(DVec3::new(-3.0, 0.6, 0.2), DVec3::X).is_none());
        assert!(bvh.ray(DVec3::new(-3.0, 0.1, 0.2), -DVec3::X).is_none());
        assert!(bvh.ray(DVec3::ZERO, DVec3::ZERO).is_none());
        assert_eq!(bvh.ray(DVec3::ZERO, DVec3::Y * 0.25).unwrap().t, 2.0);
    }

    #[test]
    fn rays_through_edges_and_corners_are_hits() {
        let bvh = Bvh::build(&test_meshes::cube());
        for target in [
            (0.5, 0.5, 0.5),
            (-0.5, 0.5, 0.2),
            (0.5, 0.1, -0.5),
            (0.5, 0.0, 0.0),
        ] {
            let target = DVec3::from(target);
            for origin in [target * 3.0, target + DVec3::new(2.0, 2.0, 2.0)] {
                let hit = bvh.ray(origin, target - origin);
                assert!(hit.is_some_and(|h| h.t <= 1.0 + 1e-12), "{origin} {target}");
            }
        }
    }

    #[test]
    fn no_ray_slips_through_a_closed_mesh() {
        let mesh = test_meshes::sphere(40);
        let bvh = Bvh::build(&mesh);
        for &v in mesh.vertices() {
            for &w in &mesh.vertices()[..7] {
                let aim = v.as_dvec3().lerp(w.as_dvec3(), 0.5);
                let nearest = bvh.ray(DVec3::new(0.01, 0.02, 0.03), v.as_dvec3());
                assert!(nearest.is_some());
                assert!(
                    bvh.ray(DVec3::new(0.01, 0.02, 0.03), aim).is_some() || aim.length() < 1e-9
                );
            }
        }
    }

    /// The nearest time of all triangles, each tested in f64.
    fn slowly(bvh: &Bvh, origin: DVec3, direction: DVec3) -> Option<f64> {
        let ray = Ray::new(origin, direction, bvh.bounds())?;
        let times = bvh.triangles.iter();
        let times = times.flat_map(|four| (0..WIDTH).map(|lane| ray.meet(four, lane)));
        let nearest = times.fold(f64::INFINITY, f64::min);
        (nearest < f64::INFINITY).then_some(nearest * ray.scale)
    }

    /// Sizes at which products overflow or underflow in f32, distant places, and directions along walls.
    #[test]
    fn what_is_ruled_out_in_f32_is_no_hit() {
        let ball = test_meshes::sphere(14);
        let mut hits = 0;
        for (size, away) in [
            (1.0, 0.0),
            (1.0, 1e3),
            (1e-2, 1e3),
            (1e-30, 0.0),
            (1e-40, 0.0),
            (1e15, 1e19),
            (1e30, 0.0),
            (1e38, 0.0),
        ] {
            let at = |v: &Vec3| (v.as_dvec3() * size + away).as_vec3();
            let vertices: Vec<Vec3> = ball.vertices().iter().map(at).collect();
            let bvh = Bvh::build(&Mesh::new(vertices, ball.triangles().to_vec()).unwrap());
            let middle = DVec3::splat(away);
            let features = ball.edges().iter().step_by(7).map(|edge| {
                let [a, b] = edge.map(|v| at(&ball.vertices()[v as usize]).as_dvec3());
                [a, 0.5 * (a + b)]
            });
            for target in features.flatten() {
                for far in [0.01, 1.0, 30.0, 1e5, 1e12, 1e200] {
                    let origin = middle + DVec3::new(0.3, 0.2, 1.0) * far * size;
                    let to = target - origin;
                    let along = to / to.length();
                    for direction in [
                        to,
                        along * DVec3::new(1.0, 0.0, 1.0),
                        along * DVec3::new(1.0, 1e-22, 1e-30),
                        -to,
                    ] {
                        // Through the target, also if it is not in that direction.
                        for origin in [origin, target - far * size * direction.normalize()] {
                            let found = bvh.ray(origin, direction).map(|hit| hit.t);
                            assert_eq!(found, slowly(&bvh, origin, direction), "{size} {far}");
                            hits += usize::from(found.is_some());
                        }
                    }
                }
            }
        }
        assert!(hits > 10_000, "{hits}");
    }
}
