//! Rays and points against a BVH: picking, line of sight, inside and outside.

use glam::{DVec3, Vec3};

use super::{Bvh, LEAF, MAX_DEPTH, Node, Triangles, WIDTH};

/// Where a ray meets a mesh.
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

    /// The same before a time, with the corners of the triangle.
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

    /// The nearest hit before a time, or any.
    fn cast(
        &self,
        origin: DVec3,
        direction: DVec3,
        (within, any): (f64, bool),
    ) -> Option<(RayHit, [Vec3; 3])> {
        let ray = Ray::new(origin, direction)?;
        let mut best: Option<(&Triangles, usize)> = None;
        let mut nearest = within / ray.scale;
        let found = |nearest: f64, (triangles, lane): (&Triangles, usize)| {
            let (t, face) = (nearest * ray.scale, triangles.face[lane]);
            (RayHit { t, face }, triangles.corners(lane))
        };
        // Codes and where the ray enters their boxes. Each level leaves at most three siblings.
        let mut stack = [(0, 0.0f32); 3 * MAX_DEPTH + 1];
        let (mut top, mut code) = (0, self.root());
        loop {
            let node = self.node(code);
            if code & LEAF == 0 {
                let enter = ray.enter(node, nearest);
                let first = top;
                for lane in node.lanes().filter(|&lane| enter[lane] < f32::INFINITY) {
                    // Farthest first, as the last one is looked at next.
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
                let hits = ray.meet(triangles);
                for lane in node.lanes() {
                    if hits[lane] >= nearest {
                        continue;
                    }
                    nearest = hits[lane];
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
                if f64::from(stack[top].1) <= nearest {
                    code = stack[top].0;
                    break;
                }
            }
        }
    }
}

/// A ray whose direction has a largest component of one; `scale` leads back from its times.
struct Ray {
    origin: DVec3,
    inverse: DVec3,
    scale: f64,
    /// The largest component is the last axis; the shear that takes the ray to it.
    axes: [usize; 3],
    shear: [f64; 2],
    forward: f64,
}

/// Stands for the inverse of nothing: far beyond all boxes, but no product with it overflows.
const BEYOND: f64 = 1e200;

impl Ray {
    fn new(origin: DVec3, direction: DVec3) -> Option<Ray> {
        let z = direction.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let largest = direction[z].abs();
        if largest < f64::MIN_POSITIVE || !direction.is_finite() || !origin.is_finite() {
            return None;
        }
        let along = direction / largest;
        let inverse = |d: f64| {
            if d.abs() > 1.0 / BEYOND {
                1.0 / d
            } else {
                BEYOND
            }
        };
        let forward = along[z];
        Some(Ray {
            origin,
            inverse: DVec3::new(inverse(along.x), inverse(along.y), inverse(along.z)),
            scale: 1.0 / largest,
            axes,
            shear: [along[axes[0]] / forward, along[axes[1]] / forward],
            forward,
        })
    }

    /// Where the ray enters the boxes of a node, rounded down; infinity where it does not before
    /// `nearest`.
    #[inline]
    fn enter(&self, node: &Node, nearest: f64) -> [f32; WIDTH] {
        let (mut enter, mut leave) = ([0.0_f64; WIDTH], [nearest; WIDTH]);
        for axis in 0..3 {
            let (origin, inverse) = (self.origin[axis], self.inverse[axis]);
            for lane in 0..WIDTH {
                let centre = f64::from(node.boxes.centre[axis][lane]);
                let half = f64::from(node.boxes.half[axis][lane]);
                let middle = (centre - origin) * inverse;
                // More than the roundings of both, and of the half extent.
                let slack = 8.0 * f64::EPSILON * (centre.abs() + origin.abs() + half.abs());
                let reach = (half + slack) * inverse.abs();
                let (near, far) = (middle - reach, middle + reach);
                enter[lane] = if near > enter[lane] {
                    near
                } else {
                    enter[lane]
                };
                leave[lane] = if far < leave[lane] { far } else { leave[lane] };
            }
        }
        let mut down = [f32::INFINITY; WIDTH];
        for lane in 0..WIDTH {
            let meets = enter[lane] <= leave[lane];
            let rounded = (enter[lane] * (1.0 - 1e-7)) as f32;
            down[lane] = if meets {
                rounded.min(f32::MAX)
            } else {
                f32::INFINITY
            };
        }
        down
    }

    /// Where the ray meets four triangles; infinity where it does not.
    #[inline]
    #[expect(clippy::needless_range_loop, reason = "lanes of several columns")]
    fn meet(&self, triangles: &Triangles) -> [f64; WIDTH] {
        // The ray becomes the z axis: the largest component stays, the others are sheared off.
        let mut corners = [[0.0; WIDTH]; 9];
        let [x, y, z] = self.axes;
        for k in [0, 3, 6] {
            for lane in 0..WIDTH {
                let at =
                    |axis: usize| f64::from(triangles.corners[k + axis][lane]) - self.origin[axis];
                let height = at(z);
                corners[k][lane] = at(x) - self.shear[0] * height;
                corners[k + 1][lane] = at(y) - self.shear[1] * height;
                corners[k + 2][lane] = height;
            }
        }
        let mut times = [f64::INFINITY; WIDTH];
        for lane in 0..WIDTH {
            let [ax, ay, az, bx, by, bz, cx, cy, cz] = corners.map(|column| column[lane]);
            // The same products for both triangles at an edge, so that they agree about it.
            let u = cx * by - cy * bx;
            let v = ax * cy - ay * cx;
            let w = bx * ay - by * ax;
            let mixed = ((u < 0.0) | (v < 0.0) | (w < 0.0)) & ((u > 0.0) | (v > 0.0) | (w > 0.0));
            let area = u + v + w;
            let time = (u * az + v * bz + w * cz) / area * self.forward;
            let hit = !mixed & (area != 0.0) & (time >= 0.0);
            times[lane] = if hit { time } else { f64::INFINITY };
        }
        times
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes;

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
}
