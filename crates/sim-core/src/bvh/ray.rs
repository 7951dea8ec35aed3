//! Rays against a BVH: picking and line of sight.

use glam::DVec3;

use super::{Bvh, LEAF, MAX_DEPTH};
use crate::Aabb;

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
    /// 2013, "Watertight ray/triangle intersection"). A direction of zero meets nothing.
    pub fn ray(&self, origin: DVec3, direction: DVec3) -> Option<RayHit> {
        let shear = Shear::along(direction)?;
        let mut best: Option<RayHit> = None;
        // Each level leaves at most three siblings behind.
        let mut stack = [self.root(); 3 * MAX_DEPTH + 1];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let code = stack[top];
            let nearest = best.map_or(f64::INFINITY, |b| b.t);
            let node = self.node(code);
            if code & LEAF == 0 {
                for lane in node.lanes() {
                    if slab(&node.boxes.bounds(lane), origin, direction, nearest) {
                        stack[top] = node.child[lane];
                        top += 1;
                    }
                }
                continue;
            }
            let triangles = self.triangles(node);
            for lane in node.lanes() {
                let (face, corners) = (triangles.face[lane], triangles.corners(lane));
                let corners = corners.map(|v| shear.apply(v.as_dvec3() - origin));
                let hit = meet(corners).map(|z| z * shear.per_t);
                let nearest = best.map_or(f64::INFINITY, |b| b.t);
                if let Some(t) = hit.filter(|&t| t >= 0.0 && t < nearest) {
                    best = Some(RayHit { t, face });
                }
            }
        }
        best
    }
}

/// Turns the ray into the z axis: the largest component becomes z, the others are sheared off.
struct Shear {
    axes: [usize; 3],
    x: f64,
    y: f64,
    per_t: f64,
}

impl Shear {
    fn along(direction: DVec3) -> Option<Shear> {
        let z = direction.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let largest = direction[z];
        (largest != 0.0 && direction.is_finite()).then(|| Shear {
            axes,
            x: direction[axes[0]] / largest,
            y: direction[axes[1]] / largest,
            per_t: 1.0 / largest,
        })
    }

    fn apply(&self, p: DVec3) -> DVec3 {
        let [x, y, z] = self.axes.map(|axis| p[axis]);
        DVec3::new(x - self.x * z, y - self.y * z, z)
    }
}

/// Where the z axis passes through the triangle.
fn meet([a, b, c]: [DVec3; 3]) -> Option<f64> {
    // The same products for both triangles at an edge, so that they agree about it.
    let u = c.x * b.y - c.y * b.x;
    let v = a.x * c.y - a.y * c.x;
    let w = b.x * a.y - b.y * a.x;
    let mixed = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
    let area = u + v + w;
    (!mixed && area != 0.0).then(|| (u * a.z + v * b.z + w * c.z) / area)
}

/// Whether the ray meets the box before `nearest`; generous by a few ulps.
fn slab(bounds: &Aabb, origin: DVec3, direction: DVec3, nearest: f64) -> bool {
    let (mut enter, mut leave) = (0.0_f64, nearest);
    for axis in 0..3 {
        let (min, max) = (f64::from(bounds.min[axis]), f64::from(bounds.max[axis]));
        let inverse = 1.0 / direction[axis];
        if inverse.is_infinite() {
            if origin[axis] < min || origin[axis] > max {
                return false;
            }
            continue;
        }
        let (near, far) = (
            (min - origin[axis]) * inverse,
            (max - origin[axis]) * inverse,
        );
        enter = enter.max(near.min(far));
        leave = leave.min(near.max(far) * (1.0 + 8.0 * f64::EPSILON));
    }
    enter <= leave
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
