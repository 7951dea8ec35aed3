//! All features of two shapes that touch at one time: corners in faces, and edges that cross.
//!
//! An impact needs more than one pair of nearest points. For example, a cube that lands on its face touches with four
//! corners, and does not start to rotate.

use alloc::{collections::BTreeMap, vec::Vec};
use core::ops::ControlFlow;
use glam::{DMat3, DVec3};

use super::{
    Figure, Moving,
    pieces::{Boxed, Item, Points},
};

/// Two points near each other, and the direction that separates them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// The points of the first shape and of the second, relative to the first centre of mass, m.
    pub points: [DVec3; 2],
    /// A unit vector from the first shape to the second.
    pub normal: DVec3,
    /// The shape whose rotation turns the normal: 0 or 1.
    pub owner: usize,
    /// If edges cross, their directions, of the first shape and of the second: the normal stays perpendicular to both.
    pub edges: Option<[DVec3; 2]>,
}

/// The least cosine of the angle between the line of two near points and the normal of their features. If the cosine is
/// less, other features of the two shapes are nearer.
const ALONG: f64 = 0.75;

/// Sine of the angle between two edges below which their cross product gives no normal; their ends give the contacts.
const CROSSING: f64 = 1e-6;

/// Up to this many contact points are compared with each other one by one.
const FEW: usize = 64;

/// Two normals whose cosine is above this count as equal.
const SAME: f64 = 1.0 - 1e-8;

/// The features of two shapes that are within `reach` (m) of each other at the start of their motion, where the shapes
/// are nowhere nearer than `distance` (m). Contact points in one plane are reduced to the corners of their convex hull,
/// which have the same effect without friction.
///
/// A pair with a ball returns none: a ball touches at one point, which another module finds.
pub fn features_within(
    a: &Moving<'_>,
    b: &Moving<'_>,
    (distance, reach): (f64, f64),
) -> Vec<ContactPoint> {
    let mut found = Vec::new();
    match (a.figure, b.figure) {
        (Figure::HalfSpace(normal), Figure::Mesh(_)) => {
            corners_on_plane(b, a, normal, reach, &mut |corner, foot| {
                found.push(ContactPoint {
                    points: [foot, corner],
                    normal,
                    owner: 0,
                    edges: None,
                });
            });
        }
        (Figure::Mesh(_), Figure::HalfSpace(normal)) => {
            let between = b.position - a.position;
            corners_on_plane(a, b, normal, reach, &mut |corner, foot| {
                found.push(ContactPoint {
                    points: [corner + between, foot + between],
                    normal: -normal,
                    owner: 1,
                    edges: None,
                });
            });
        }
        (Figure::Mesh(_), Figure::Mesh(_)) => {
            let _ = between_meshes(a, b, (distance, reach), |touch| {
                found.push(touch);
                ControlFlow::Continue(())
            });
        }
        _ => {}
    }
    cut_to_hulls(once(found, reach))
}

/// Normals of the features of two meshes that are within `reach`, m, of each other at the start of their motion, in
/// both directions. Returns the first ones found: the search ends when there are `most`.
pub fn normals_within(a: &Moving<'_>, b: &Moving<'_>, reach: f64, most: usize) -> Vec<DVec3> {
    let mut normals: Vec<DVec3> = Vec::new();
    if let (Figure::Mesh(_), Figure::Mesh(_)) = (a.figure, b.figure) {
        let _ = between_meshes(a, b, (0.0, reach), |touch| {
            for normal in [touch.normal, -touch.normal] {
                if !normals.iter().any(|known| known.dot(normal) >= SAME) {
                    normals.push(normal);
                }
            }
            match normals.len() < most {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        });
    }
    normals
}

/// The corners of a mesh near a plane, and their feet on it, relative to the centre of mass of the plane's shape.
fn corners_on_plane(
    mesh: &Moving<'_>,
    plane: &Moving<'_>,
    normal: DVec3,
    reach: f64,
    found: &mut dyn FnMut(DVec3, DVec3),
) {
    let rotation = mesh.rotation_at(0.0);
    let back = rotation.inverse() * normal;
    let between = mesh.position - plane.position;
    let height = normal.dot(between + plane.rotation_at(0.0) * plane.centre);
    let mut items = alloc::vec![Boxed::root(mesh)];
    while let Some(boxed) = items.pop() {
        let lowest = height + back.dot(boxed.centre) - back.abs().dot(boxed.half);
        if lowest > reach {
            continue;
        }
        if let Item::Piece(..) = boxed.item {
            for corner in Points::of(mesh, boxed.item).corners() {
                let above = height + back.dot(corner);
                if above <= reach {
                    let corner = between + rotation * corner;
                    found(corner, corner - above * normal);
                }
            }
            continue;
        }
        items.extend(Boxed::within(mesh, boxed.item).iter());
    }
}

/// Corners on faces and crossing edges of two meshes.
fn between_meshes(
    a: &Moving<'_>,
    b: &Moving<'_>,
    (distance, reach): (f64, f64),
    mut found: impl FnMut(ContactPoint) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let (of_a, of_b) = (a.rotation_at(0.0), b.rotation_at(0.0));
    let to_a = of_a.inverse();
    let turn = DMat3::from_quat((to_a * of_b).normalize());
    let back = turn.transpose();
    let offset = to_a * (b.position - a.position);
    let wide = DVec3::splat(reach);
    let mut pairs = alloc::vec![(Boxed::root(a), Boxed::root(b))];
    let mut touches = Vec::new();
    while let Some((first, second)) = pairs.pop() {
        // Axes of both boxes only: enough for a bound on the distance.
        let between = turn * second.centre + offset - first.centre;
        let is_far = |apart: DVec3, own: DVec3, other: DVec3, turn: &DMat3| {
            let half = turn.abs() * other;
            let slack = 16.0 * f64::EPSILON * (apart + half + own);
            (apart - half - own).cmpgt(wide + slack).any()
        };
        if is_far(between.abs(), first.half, second.half, &turn)
            || is_far((back * between).abs(), second.half, first.half, &back)
        {
            continue;
        }
        match (first.item, second.item) {
            (Item::Piece(..), Item::Piece(..)) => {
                let (p, q) = (Points::of(a, first.item), Points::of(b, second.item));
                let q = q.corners().map(|corner| turn * corner + offset);
                of_triangles(&p.corners(), &q, (distance, reach), &mut touches);
                for touch in touches.drain(..) {
                    found(ContactPoint {
                        points: touch.points.map(|point| of_a * point),
                        normal: of_a * touch.normal,
                        edges: touch.edges.map(|edges| edges.map(|edge| of_a * edge)),
                        ..touch
                    })?;
                }
            }
            (Item::Node(_), Item::Piece(..)) => {
                let within = Boxed::within(a, first.item);
                pairs.extend(within.iter().map(|&first| (first, second)));
            }
            (Item::Node(_), Item::Node(_)) if first.farthest >= second.farthest => {
                let within = Boxed::within(a, first.item);
                pairs.extend(within.iter().map(|&first| (first, second)));
            }
            _ => {
                let within = Boxed::within(b, second.item);
                pairs.extend(within.iter().map(|&second| (first, second)));
            }
        }
    }
    ControlFlow::Continue(())
}

/// Corners on faces and crossing edges of two triangles in one frame.
fn of_triangles(
    p: &[DVec3; 3],
    q: &[DVec3; 3],
    (distance, reach): (f64, f64),
    found: &mut Vec<ContactPoint>,
) {
    // Less than `distance`, so that a corner below the border of a face does not count as beside it.
    let slack = 0.25 * distance;
    for (corners, face, owner) in [(q, p, 0), (p, q, 1)] {
        let normal = (face[1] - face[0]).cross(face[2] - face[0]);
        let Some(normal) = normal.try_normalize() else {
            continue;
        };
        for &corner in corners {
            let above = normal.dot(corner - face[0]);
            let foot = corner - above * normal;
            if above.abs() > reach || !is_within(foot, face, normal, slack) {
                continue;
            }
            let points = match owner {
                0 => [foot, corner],
                _ => [corner, foot],
            };
            let normal = match (points[1] - points[0]).dot(normal) < 0.0 {
                true => -normal,
                false => normal,
            };
            found.push(ContactPoint {
                points,
                normal,
                owner,
                edges: None,
            });
        }
    }
    for k in 0..3 {
        let (p0, u) = (p[k], p[(k + 1) % 3] - p[k]);
        for m in 0..3 {
            let (q0, v) = (q[m], q[(m + 1) % 3] - q[m]);
            let cross = u.cross(v);
            let sine2 = cross.length_squared() / (u.length_squared() * v.length_squared());
            if sine2.is_nan() || sine2 < CROSSING * CROSSING {
                continue;
            }
            // The nearest points of the two lines.
            let r = q0 - p0;
            let (s, t) = (
                r.cross(v).dot(cross) / cross.length_squared(),
                r.cross(u).dot(cross) / cross.length_squared(),
            );
            if !(0.0..=1.0).contains(&s) || !(0.0..=1.0).contains(&t) {
                continue;
            }
            let points = [p0 + s * u, q0 + t * v];
            let between = points[1] - points[0];
            if between.length() > reach {
                continue;
            }
            let normal = cross.normalize();
            let normal = match between.dot(normal) < 0.0 {
                true => -normal,
                false => normal,
            };
            if between.dot(normal) < ALONG * between.length() {
                continue;
            }
            found.push(ContactPoint {
                points,
                normal,
                owner: 0,
                edges: Some([u.normalize(), v.normalize()]),
            });
        }
    }
}

/// Whether a point in a triangle's plane is inside the triangle, or outside by less than `slack`.
fn is_within(point: DVec3, face: &[DVec3; 3], normal: DVec3, slack: f64) -> bool {
    (0..3).all(|k| {
        let edge = face[(k + 1) % 3] - face[k];
        let inward = normal.cross(edge);
        inward.dot(point - face[k]) >= -slack * inward.length()
    })
}

/// Keeps one of all contact points that share a place and a normal.
fn once(found: Vec<ContactPoint>, reach: f64) -> Vec<ContactPoint> {
    let mut kept: Vec<ContactPoint> = Vec::with_capacity(found.len());
    let is_same = |known: &ContactPoint, touch: &ContactPoint| {
        (known.points[1] - touch.points[1]).length() <= 2.0 * reach
            && known.normal.dot(touch.normal) >= SAME
    };
    if found.len() <= FEW {
        for touch in found {
            if !kept.iter().any(|known| is_same(known, &touch)) {
                kept.push(touch);
            }
        }
        return kept;
    }
    // By cells as wide as contact points in one place may be apart.
    let mut cells: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
    for touch in found {
        let cell = (touch.points[1] / (2.0 * reach)).floor();
        let cell = cell.to_array().map(|along| along as i64);
        let is_known = NEIGHBOURS.iter().any(|step| {
            let near = [0, 1, 2].map(|axis| cell[axis].saturating_add(step[axis]));
            let known = cells.get(&near).map_or(&[][..], Vec::as_slice);
            known.iter().any(|&known| is_same(&kept[known], &touch))
        });
        if !is_known {
            cells.entry(cell).or_default().push(kept.len());
            kept.push(touch);
        }
    }
    kept
}

/// Steps from a cell to itself and to its neighbours.
const NEIGHBOURS: [[i64; 3]; 27] = {
    let mut steps = [[0; 3]; 27];
    let mut k = 0;
    while k < 27 {
        let of = k as i64;
        steps[k] = [of % 3 - 1, of / 3 % 3 - 1, of / 9 - 1];
        k += 1;
    }
    steps
};

/// Reduces the contact points of each normal to the corners of their convex hull.
fn cut_to_hulls(mut found: Vec<ContactPoint>) -> Vec<ContactPoint> {
    let mut kept = Vec::new();
    while let Some(first) = found.first().copied() {
        let (plane, rest): (Vec<ContactPoint>, Vec<ContactPoint>) = found
            .into_iter()
            .partition(|touch| touch.normal.dot(first.normal) >= SAME);
        found = rest;
        kept.extend(hull(plane, first.normal));
    }
    kept
}

/// The corners of the hull of points, seen along a normal (Andrew 1979, "Another efficient algorithm for
/// convex hulls in two dimensions").
fn hull(mut touches: Vec<ContactPoint>, normal: DVec3) -> Vec<ContactPoint> {
    if touches.len() < 4 {
        return touches;
    }
    let (u, v) = normal.any_orthonormal_pair();
    let flat = |touch: &ContactPoint| (touch.points[1].dot(u), touch.points[1].dot(v));
    touches.sort_by(|a, b| {
        let ((ax, ay), (bx, by)) = (flat(a), flat(b));
        ax.total_cmp(&bx).then(ay.total_cmp(&by))
    });
    let turns_left = |a: &ContactPoint, b: &ContactPoint, c: &ContactPoint| {
        let ((ax, ay), (bx, by), (cx, cy)) = (flat(a), flat(b), flat(c));
        (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0.0
    };
    let mut corners: Vec<ContactPoint> = Vec::new();
    let mut chain = |along: &mut dyn Iterator<Item = &ContactPoint>| {
        let begin = corners.len();
        for touch in along {
            while corners.len() >= begin + 2
                && !turns_left(
                    &corners[corners.len() - 2],
                    &corners[corners.len() - 1],
                    touch,
                )
            {
                corners.pop();
            }
            corners.push(*touch);
        }
        corners.pop();
    };
    chain(&mut touches.iter());
    chain(&mut touches.iter().rev());
    corners
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_random::Random;

    #[test]
    fn of_many_touches_the_same_are_left_as_of_few() {
        let reach = 1e-3;
        let mut random = Random(7);
        let mut digit = |count: usize| random.below(count) as f64;
        let touches: Vec<ContactPoint> = (0..2000)
            .map(|_| {
                // On both sides of the borders between cells, and of the distance within which points share a place.
                let place = DVec3::new(digit(80), digit(12), digit(12)) - DVec3::splat(6.0);
                let point = 0.45 * reach * place;
                ContactPoint {
                    points: [point; 2],
                    normal: [DVec3::X, DVec3::Y][digit(2) as usize],
                    owner: 0,
                    edges: None,
                }
            })
            .collect();
        let mut one_by_one: Vec<ContactPoint> = Vec::new();
        for touch in &touches {
            let is_known = one_by_one.iter().any(|known| {
                (known.points[1] - touch.points[1]).length() <= 2.0 * reach
                    && known.normal == touch.normal
            });
            if !is_known {
                one_by_one.push(*touch);
            }
        }
        let kept = once(touches, reach);
        assert!(kept.len() > FEW && kept.len() < 1000, "{}", kept.len());
        assert_eq!(kept, one_by_one);
    }
}
