//! The extent of a mesh along a direction.

use glam::{DVec3, Vec3};

use super::{Bvh, LEAF, MAX_DEPTH, WIDTH};

impl Bvh {
    /// The least `v · direction` (m; products and sums are rounded) of all corners of triangles, and the middle of
    /// the corners that attain it.
    pub(crate) fn least_along(&self, direction: DVec3) -> (f64, DVec3) {
        if let Some(cuboid) = self.cuboid() {
            return cuboid.least_along(direction);
        }
        let mut least = f64::INFINITY;
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let mut stack = [0; (WIDTH - 1) * MAX_DEPTH + 1];
        stack[0] = self.root();
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let code = stack[waiting];
            let node = self.node(code);
            if code & LEAF != 0 {
                let triangles = self.triangles(node);
                for v in node.lanes().flat_map(|lane| triangles.corners(lane)) {
                    let along = v.as_dvec3().dot(direction);
                    if along < least {
                        (least, low, high) = (along, v, v);
                    } else if along == least {
                        (low, high) = (low.min(v), high.max(v));
                    }
                }
                continue;
            }
            for lane in node.lanes() {
                let of = |axes: &[[f32; WIDTH]; 3]| {
                    Vec3::from_array(axes.map(|axis| axis[lane])).as_dvec3()
                };
                let (centre, half) = (of(&node.boxes.centre), of(&node.boxes.half));
                let (middle, reach) = (centre.dot(direction), half.dot(direction.abs()));
                let size = centre.abs().dot(direction.abs()) + reach;
                if middle - reach - 8.0 * f64::EPSILON * size <= least {
                    stack[waiting] = node.child[lane];
                    waiting += 1;
                }
            }
        }
        (least, 0.5 * (low.as_dvec3() + high.as_dvec3()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::{cube, sphere};

    #[test]
    fn reach_is_that_of_the_corners() {
        for mesh in [cube(), sphere(14)] {
            let tree = Bvh::build(&mesh);
            for i in 0..200 {
                let angle = f64::from(i);
                let out = DVec3::new(libm::cos(angle), libm::sin(angle), 0.02 * (angle - 100.0));
                let corners = mesh.vertices().iter().map(|v| v.as_dvec3().dot(out));
                let expected = corners.fold(f64::INFINITY, f64::min);
                let (least, at) = tree.least_along(out);
                assert_eq!(least, expected);
                assert!((at.dot(out) - least).abs() < 1e-6);
            }
        }
        let (least, at) = Bvh::build(&cube()).least_along(DVec3::Y);
        assert_eq!((least, at), (-0.5, DVec3::new(0.0, -0.5, 0.0)));
    }
}
