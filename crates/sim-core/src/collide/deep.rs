//! Proves that two meshes overlap so deeply that no small translation separates them.

use alloc::vec::Vec;
use core::ops::ControlFlow;
use glam::DVec3;

use super::{
    Placement,
    ball::ball_meets,
    solid::{Place, each_in_box, locate},
};
use crate::bvh::Bvh;

/// The place of the lines in the intersection of the boxes. It is beside the middle, where symmetric meshes have edges.
const ASIDE: DVec3 = DVec3::new(0.47, 0.53, 0.49);

/// A bound on the rounding of widths and positions of rotated meshes, relative to their size.
const ROUNDING: f64 = 1e-12;

/// Whether two meshes certainly meet after every translation of the second one by at most `by`, m, from its placement.
///
/// A point inside both meshes that is farther than `by` from both surfaces stays inside both. Suppose the surfaces were
/// apart after such a translation. Then one would be inside the other, because each is connected and a region inside
/// both is bounded by one of them. But then the inner one would be narrower along every direction. The answer is false
/// if no such point is found; it is sought on three lines through the intersection of the boxes.
pub(crate) fn stay_in_each_other(
    first: &Bvh,
    second: &Bvh,
    at: impl Into<Placement>,
    by: f64,
) -> bool {
    let at = at.into();
    let is_solid = |mesh: &Bvh| mesh.is_closed() && mesh.topology().connected;
    if !(is_solid(first) && is_solid(second)) || may_enclose(first, second, &at) {
        return false;
    }
    let ([low, high], (other_low, other_high)) = (ends(first), at.corners(&second.bounds()));
    let (low, high) = (low.max(other_low), high.min(other_high));
    let near_middle = low + ASIDE * (high - low);
    // Twice as far, to cover the rounding of positions and distances.
    let is_deep = |mesh: &Bvh, point: DVec3| {
        locate(mesh, point) == Some(Place::Inside) && !ball_meets(mesh, point, 2.0 * by)
    };
    DVec3::AXES.into_iter().any(|axis| {
        let through = near_middle - axis * near_middle;
        let own = crossings(first, through, axis);
        let other = crossings(second, at.back(through), at.direction_back(axis));
        longest_in_both(&own, &other).is_some_and(|along| {
            let point = through + along * axis;
            is_deep(first, point) && is_deep(second, at.back(point))
        })
    })
}

fn ends(mesh: &Bvh) -> [DVec3; 2] {
    [mesh.bounds().min.as_dvec3(), mesh.bounds().max.as_dvec3()]
}

/// Whether one of two meshes may be wide enough along all directions to enclose the other one.
fn may_enclose(first: &Bvh, second: &Bvh, at: &Placement) -> bool {
    let size = |mesh: &Bvh| ends(mesh)[1] - ends(mesh)[0];
    let (own, other) = (size(first), size(second));
    if at.turn().is_none() {
        return own.cmplt(other).all() || other.cmplt(own).all();
    }
    let width = |mesh: &Bvh, along: DVec3| -mesh.least_along(along).0 - mesh.least_along(-along).0;
    let more = 1.0 + ROUNDING;
    let wider = DVec3::AXES
        .into_iter()
        .fold((false, false), |(one, two), axis| {
            let of_second = width(second, at.direction_back(axis));
            let of_first = width(first, at.direction(axis));
            (
                one || own.dot(axis) > more * of_second || of_first > more * other.dot(axis),
                two || of_second > more * own.dot(axis) || other.dot(axis) > more * of_first,
            )
        });
    wider != (true, true)
}

/// Where a line crosses the surface of a mesh, up to rounding: distances, m, from the point `through` along the unit
/// vector `along`.
fn crossings(mesh: &Bvh, through: DVec3, along: DVec3) -> Vec<f64> {
    let [low, high] = ends(mesh);
    let far = along * ((low - through).length() + (high - low).length());
    let mut found = Vec::new();
    let _ = each_in_box(
        mesh,
        (through - far).min(through + far),
        (through - far).max(through + far),
        |_, corners| {
            let [a, b, c] = corners.map(|v| v.as_dvec3() - through);
            // Twice the areas of the triangles that the corners form with the line, in the projection along the line.
            let areas = [b.cross(c), c.cross(a), a.cross(b)].map(|area| area.dot(along));
            let (least, most) = areas
                .into_iter()
                .fold((0.0_f64, 0.0_f64), |(least, most), area| {
                    (least.min(area), most.max(area))
                });
            let whole = areas.iter().sum::<f64>();
            if (least == 0.0 || most == 0.0) && whole != 0.0 {
                let corner = areas[0] * a + areas[1] * b + areas[2] * c;
                found.push(corner.dot(along) / whole);
            }
            ControlFlow::Continue(())
        },
    );
    found.sort_unstable_by(f64::total_cmp);
    found
}

/// The middle of the longest interval inside both meshes, from their crossings.
fn longest_in_both(first: &[f64], second: &[f64]) -> Option<f64> {
    let stretches = |crossings: &[f64]| -> Vec<[f64; 2]> {
        crossings
            .chunks_exact(2)
            .map(|ends| [ends[0], ends[1]])
            .collect()
    };
    let others = stretches(second);
    let shared = stretches(first).into_iter().flat_map(|[low, high]| {
        others
            .iter()
            .map(move |&[other_low, other_high]| [low.max(other_low), high.min(other_high)])
    });
    let [low, high] = shared.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0])))?;
    (low < high).then_some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::{
        collide::tree::intersect,
        test_meshes::{cube, sphere},
        test_random::Random,
    };

    #[test]
    fn what_stays_in_each_other_meets_wherever_it_is_moved() {
        let meshes = [cube(), sphere(8), sphere(13)].map(|mesh| Bvh::build(&mesh));
        let mut random = Random(1);
        let mut next = || random.in_cube();
        let mut told = [0; 2];
        for (i, first) in meshes.iter().enumerate() {
            for second in &meshes[i..] {
                for round in 0..200 {
                    let offset = match round {
                        0 => DVec3::ZERO,
                        1 => 0.25 * DVec3::X,
                        _ => next(),
                    };
                    let by = 0.2 * next().x.abs();
                    let stays = stay_in_each_other(first, second, offset, by);
                    told[usize::from(stays)] += 1;
                    for _ in 0..20 {
                        let moved = offset + by * next().normalize_or_zero();
                        assert!(!stays || intersect(first, second, moved), "{offset} {by}");
                    }
                }
            }
        }
        assert!(told[0] > 300 && told[1] > 300, "{told:?}");
        for mesh in &meshes {
            assert!(stay_in_each_other(mesh, mesh, DVec3::ZERO, 0.1));
        }
    }

    #[test]
    fn what_is_turned_in_each_other_meets_wherever_it_is_moved() {
        let meshes = [cube(), sphere(9)].map(|mesh| Bvh::build(&mesh));
        let mut random = Random(1);
        let mut next = || random.in_cube();
        let mut told = [0; 2];
        for (first, second) in [(0, 0), (0, 1), (1, 1)].map(|(i, j)| (&meshes[i], &meshes[j])) {
            for _ in 0..200 {
                let rotation = DQuat::from_scaled_axis(3.0 * next());
                let placed = |offset| Placement::turned(rotation, offset).expect("a rotation");
                let (offset, by) = (next(), 0.1 * next().x.abs());
                let stays = stay_in_each_other(first, second, placed(offset), by);
                told[usize::from(stays)] += 1;
                for _ in 0..20 {
                    let moved = placed(offset + by * next().normalize_or_zero());
                    assert!(!stays || intersect(first, second, moved), "{offset} {by}");
                }
            }
        }
        assert!(told[0] > 100 && told[1] > 100, "{told:?}");
    }

    #[test]
    fn what_is_in_the_room_of_another_may_be_moved() {
        let large = Bvh::build(&cube());
        let sized = |scale: f32| {
            let mesh = cube();
            let vertices = mesh.vertices().iter().map(|&v| scale * v).collect();
            Bvh::build(&crate::Mesh::new(vertices, mesh.triangles().to_vec()).expect("a mesh"))
        };
        let inner = sized(0.5);
        assert!(!intersect(&large, &inner, DVec3::ZERO));
        assert!(!stay_in_each_other(&large, &inner, DVec3::ZERO, 0.01));
        assert!(!stay_in_each_other(&inner, &large, DVec3::ZERO, 0.01));
    }
}
