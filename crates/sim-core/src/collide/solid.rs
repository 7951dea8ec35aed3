//! Points, segments and boxes against one mesh.

use core::ops::ControlFlow;
use glam::{DVec3, Vec3};

use super::{
    placement::{FARTHEST, Placement, snap},
    predicates::{Axis, above, segment_meets_triangle},
    tree,
};
use crate::bvh::{Bvh, LEAF, MAX_DEPTH};

/// The place of a point relative to a closed mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Inside: a path out of the mesh crosses its surface an odd number of times.
    Inside,
    /// On a triangle.
    On,
    /// Neither inside nor on the surface.
    Outside,
}

/// The place of a point in the mesh's frame, m, exactly; `None` if the mesh is open. A point that is not a number is
/// outside.
///
/// A ray along the x axis crosses the surface. If the ray meets an edge or a corner, the point counts as moved by an
/// infinitesimal step along y and a yet smaller one along z, so that it crosses each edge on one side (Edelsbrunner,
/// Mücke 1990, "Simulation of simplicity").
pub fn locate(mesh: &Bvh, point: DVec3) -> Option<Place> {
    if !mesh.is_closed() {
        return None;
    }
    let (point, bounds) = (snap(point), mesh.bounds());
    let within = bounds.min.as_dvec3().cmple(point) & point.cmple(bounds.max.as_dvec3());
    if !within.all() {
        return Some(Place::Outside);
    }
    if meets(mesh, point, point) {
        return Some(Place::On);
    }
    let far = DVec3::new(f64::INFINITY, point.y, point.z);
    let mut inside = false;
    let _ = each_in_box(mesh, point, far, |_, corners| {
        inside ^= crosses(corners.map(|v| v.as_dvec3()), point);
        ControlFlow::Continue(())
    });
    Some(if inside {
        Place::Inside
    } else {
        Place::Outside
    })
}

/// Whether a closed segment, in the mesh's frame, m, and the surface of a mesh share a point, exactly. `None` if an
/// end is not a number or is beyond ±1e100 m. Components below 2^-250 m count as zero.
pub fn segment_meets(mesh: &Bvh, p: DVec3, q: DVec3) -> Option<bool> {
    let in_range = |p: DVec3| p.abs().cmple(DVec3::splat(FARTHEST)).all();
    (in_range(p) && in_range(q)).then(|| meets(mesh, snap(p), snap(q)))
}

fn meets(mesh: &Bvh, p: DVec3, q: DVec3) -> bool {
    let meets = |_, corners: [Vec3; 3]| {
        if segment_meets_triangle(p, q, corners.map(|v| v.as_dvec3())) {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    };
    each_in_box(mesh, p.min(q), p.max(q), meets).is_break()
}

/// Whether the second of two closed meshes lies wholly inside the first one, without touching its surface. The second
/// mesh must be connected. Tests of surfaces do not detect this case.
pub fn contains(first: &Bvh, second: &Bvh, at: impl Into<Placement>) -> bool {
    let at = at.into();
    let [corner, ..] = second.triangles(second.first_leaf()).corners(0);
    locate(first, at.place(corner)) == Some(Place::Inside) && !tree::intersect(first, second, at)
}

/// Visits the triangles, by index and corners, whose boxes meet a closed box, until told to stop. It may visit a few
/// other triangles too.
pub fn each_in_box(
    mesh: &Bvh,
    min: DVec3,
    max: DVec3,
    mut visit: impl FnMut(u32, [Vec3; 3]) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let mut stack = [mesh.root(); 3 * MAX_DEPTH + 1];
    let mut top = 1;
    while top > 0 {
        top -= 1;
        let code = stack[top];
        let node = mesh.node(code);
        for lane in node.lanes() {
            let bounds = node.boxes.bounds(lane);
            let meets = bounds.min.as_dvec3().cmple(max) & min.cmple(bounds.max.as_dvec3());
            if !meets.all() {
                continue;
            }
            if code & LEAF == 0 {
                stack[top] = node.child[lane];
                top += 1;
            } else {
                let triangles = mesh.triangles(node);
                visit(triangles.face[lane], triangles.corners(lane))?;
            }
        }
    }
    ControlFlow::Continue(())
}

/// Whether the ray from a point along x, moved as in `locate`, crosses a triangle that does not contain the point.
fn crosses(triangle: [DVec3; 3], p: DVec3) -> bool {
    let [a, b, c] = triangle;
    let turns = [(a, b), (b, c), (c, a)].map(|(a, b)| {
        let turn = Axis::X.orient(a, b, p);
        // The derivatives of the turn with respect to the point's y, then to its z.
        let tie = [a.z - b.z, b.y - a.y].into_iter();
        core::iter::once(turn).chain(tie).find(|&x| x != 0.0)
    });
    // If a side is parallel to x it has no turn, and the projected triangle has no area.
    let [Some(u), Some(v), Some(w)] = turns else {
        return false;
    };
    let left = [u, v, w].map(|x| x > 0.0);
    let round = left == [left[0]; 3];
    round && above(triangle, p) != left[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::{cube, sphere};
    use crate::{Mesh, collide::Placement};
    use alloc::{vec, vec::Vec};
    use glam::DQuat;

    fn v(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }

    #[test]
    fn a_lattice_of_points_about_a_cube_is_told_apart_exactly() {
        let cube = Bvh::build(&cube());
        let steps: Vec<f64> = (-6..=6).map(|i| f64::from(i) * 0.125).collect();
        for &x in &steps {
            for &y in &steps {
                for &z in &steps {
                    let out = x.abs().max(y.abs()).max(z.abs());
                    let exact = match out {
                        _ if out < 0.5 => Place::Inside,
                        0.5 => Place::On,
                        _ => Place::Outside,
                    };
                    assert_eq!(locate(&cube, v(x, y, z)), Some(exact), "{x} {y} {z}");
                }
            }
        }
        let ulp = 0.5_f64.next_up();
        assert_eq!(locate(&cube, v(ulp, 0.1, 0.2)), Some(Place::Outside));
        assert_eq!(locate(&cube, v(-0.5, 0.1, 0.2)), Some(Place::On));
        assert_eq!(
            locate(&cube, v(0.5_f64.next_down(), 0.5, 0.5)),
            Some(Place::On)
        );
        assert_eq!(locate(&cube, v(0.0, 0.0, 1e-300)), Some(Place::Inside));
        for far in [1e200, f64::INFINITY, f64::NAN] {
            assert_eq!(locate(&cube, v(-far, 0.1, 0.2)), Some(Place::Outside));
            assert_eq!(
                segment_meets(&cube, v(-far, 0.1, 0.2), v(1.0, 0.1, 0.2)),
                None
            );
        }
        assert_eq!(locate(&cube, DVec3::splat(f64::NAN)), Some(Place::Outside));
    }

    #[test]
    fn ways_out_through_corners_cross_once() {
        let ball = sphere(16);
        let tree = Bvh::build(&ball);
        for &corner in ball.vertices() {
            let corner = corner.as_dvec3();
            assert_eq!(locate(&tree, corner), Some(Place::On));
            for x in [-2.0, -0.01, 0.0, 0.01, 2.0] {
                let p = v(corner.x * 0.5 + x, corner.y, corner.z);
                let radius = p.length();
                if !(0.97..=1.0).contains(&radius) {
                    let exact = if radius < 1.0 {
                        Place::Inside
                    } else {
                        Place::Outside
                    };
                    assert_eq!(locate(&tree, p), Some(exact), "{p}");
                }
            }
        }
    }

    #[test]
    fn open_meshes_have_no_inside() {
        let lid_off = Mesh::new(cube().vertices().to_vec(), cube().triangles()[1..].to_vec());
        assert_eq!(locate(&Bvh::build(&lid_off.unwrap()), DVec3::ZERO), None);
    }

    #[test]
    fn segments_meet_the_surface_or_do_not() {
        let cube = Bvh::build(&cube());
        let tip = 0.5_f64.next_up();
        for (p, q, meets) in [
            (v(-2.0, 0.1, 0.2), v(2.0, 0.1, 0.2), true),
            (v(-0.4, 0.1, 0.2), v(0.4, 0.1, 0.2), false),
            (v(2.0, 0.1, 0.2), v(0.5, 0.1, 0.2), true),
            (v(2.0, 0.1, 0.2), v(tip, 0.1, 0.2), false),
            (v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0), true),
            (v(1.0, 0.0, 0.0), v(0.0, 1.0_f64.next_up(), 0.0), false),
        ] {
            assert_eq!(segment_meets(&cube, p, q), Some(meets), "{p} {q}");
            assert_eq!(segment_meets(&cube, q, p), Some(meets), "{q} {p}");
        }
    }

    #[test]
    fn a_small_cube_in_a_large_one_is_contained_until_it_touches() {
        let small = Bvh::build(&cube());
        let large = cube()
            .transformed(DQuat::IDENTITY, DVec3::splat(4.0))
            .unwrap();
        let large = Bvh::build(&large);
        for (x, inside) in [
            (0.0, true),
            (1.25, true),
            (1.5, false),
            (2.0, false),
            (5.0, false),
        ] {
            assert_eq!(contains(&large, &small, v(x, 0.1, 0.2)), inside, "{x}");
            assert!(!contains(&small, &large, v(-x, -0.1, -0.2)));
        }
        let eighth = DQuat::from_rotation_z(core::f64::consts::FRAC_PI_4);
        let turned = |x| Placement::turned(eighth, v(x, 0.0, 0.0)).unwrap();
        assert!(contains(&large, &small, turned(1.25)) && !contains(&large, &small, turned(1.35)));
    }

    #[test]
    fn boxes_find_their_triangles() {
        let ball = sphere(20);
        let tree = Bvh::build(&ball);
        let (min, max) = (v(0.2, -0.3, 0.1), v(0.9, 0.4, 0.7));
        let mut found = vec![];
        let _ = each_in_box(&tree, min, max, |face, corners| {
            assert_eq!(corners, ball.corners(face as usize));
            found.push(face);
            ControlFlow::Continue(())
        });
        found.sort_unstable();
        let all = 0..ball.triangles().len() as u32;
        let inside = |&face: &u32| {
            let c = ball.corners(face as usize).map(|v| v.as_dvec3());
            let (low, high) = (c[0].min(c[1]).min(c[2]), c[0].max(c[1]).max(c[2]));
            low.cmple(max).all() && min.cmple(high).all()
        };
        let needed: Vec<u32> = all.filter(inside).collect();
        assert!(needed.iter().all(|face| found.contains(face)));
        assert!(found.len() < needed.len() + 8 && needed.len() > 20);
    }
}
