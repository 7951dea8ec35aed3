//! Meshes so large that slabs are compared, very close to contact.

use std::sync::Arc;

use kit::agree::assert_same;
use kit::meshes::{builtin, grid, mesh, scaled};
use sim_core::collide::{Placement, tree};
use sim_core::{Bvh, DQuat, DVec3, Mesh, Vec3};

/// A bent sheet of 24 by 24 quads about the origin.
fn sheet(at: impl Fn(f32, f32) -> Vec3) -> Arc<Mesh> {
    grid(24, false, |x, z| at(x - 0.5, z - 0.5))
}

/// The cow, and sheets whose folds lie close to each other.
fn large() -> [Arc<Mesh>; 3] {
    let cow = cow::cow(1_000).expect("a cow of this size can be made");
    let vertices = cow.vertices.into_iter().map(Vec3::from_array).collect();
    let folded = |folds: f32, thickness: f32| {
        sheet(|x, z| Vec3::new(x, thickness * (folds * x + 1.3 * z).sin(), z))
    };
    [
        mesh(vertices, cow.triangles),
        folded(20.0, 0.2),
        folded(3.0, 0.05),
    ]
}

/// Tests both sides of the first contact along many directions, to within rounding.
#[test]
fn naive_and_bvh_agree_where_surfaces_come_within_a_hair() {
    let meshes = large();
    let mut answers = [0, 0];
    for (i, first) in meshes.iter().enumerate() {
        for second in &meshes[i..] {
            let (a, b) = (Bvh::build(first), Bvh::build(second));
            for k in 0..8 {
                let angle = f64::from(k) * 2.4;
                let along = DVec3::new(angle.cos(), 0.3 - 0.1 * f64::from(k), angle.sin());
                let (mut apart, mut meeting) = (6.0, 0.0);
                while apart - meeting > 1e-15 * apart {
                    let middle = 0.5 * (apart + meeting);
                    if middle <= meeting || middle >= apart {
                        break;
                    }
                    let meet = tree::intersect(&a, &b, along * middle);
                    *(if meet { &mut meeting } else { &mut apart }) = middle;
                }
                for far in [apart, meeting, 1.001 * apart, 0.999 * meeting] {
                    let meet = assert_same(first, second, along * far);
                    answers[usize::from(meet)] += 1;
                }
            }
        }
    }
    assert!(answers[0] > 60 && answers[1] > 60, "{answers:?}");
}

/// Puts a vertex of one mesh exactly on a vertex, the middle of an edge and that of a face of another.
#[test]
fn meshes_that_touch_exactly_meet() {
    let cube = builtin("cube.obj");
    let [cow, sheet, _] = large();
    for (first, second) in [(&cube, &cow), (&cow, &cow), (&cow, &sheet), (&sheet, &cube)] {
        for k in 0..12 {
            let pick = |n: usize, salt: usize| (k * 7919 + salt) % n;
            let vertex = second.vertices()[pick(second.vertices().len(), 1)].as_dvec3();
            let corners = first
                .corners(pick(first.triangles().len(), 3))
                .map(|v| v.as_dvec3());
            let [x, y, _] = corners;
            for target in [x, (x + y) * 0.5] {
                // The test needs exact sums, which these floats have.
                let offset = target - vertex;
                if vertex + offset == target {
                    assert!(assert_same(first, second, offset));
                }
            }
        }
    }
}

/// Two spheres, one inside the other without contact: mostly slabs are compared.
#[test]
fn nested_spheres_are_apart_until_they_touch() {
    let sphere = |n: u32, radius: f32| {
        let ring = |i: u32, j: u32| {
            let (polar, azimuth) = (
                (i as f32 + 1.0) / (n as f32 + 1.0) * std::f32::consts::PI,
                j as f32 / n as f32 * std::f32::consts::TAU,
            );
            radius
                * Vec3::new(
                    polar.sin() * azimuth.cos(),
                    polar.cos(),
                    polar.sin() * azimuth.sin(),
                )
        };
        let vertices = (0..n)
            .flat_map(|i| (0..n).map(move |j| ring(i, j)))
            .collect();
        let at = |i: u32, j: u32| i * n + j % n;
        let quads = (0..n - 1).flat_map(|i| (0..n).map(move |j| (i, j)));
        let triangles = quads.flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            [[a, b, c], [a, c, d]]
        });
        mesh(vertices, triangles.collect())
    };
    let (outer, inner) = (sphere(40, 1.0), sphere(36, 0.96));
    let mut answers = [0, 0];
    for k in 0..60 {
        let far = 0.001 * f64::from(k);
        let meet = assert_same(&outer, &inner, DVec3::new(0.6, 0.64, 0.48) * far);
        answers[usize::from(meet)] += 1;
        let turn = DQuat::from_rotation_y(0.1 * f64::from(k));
        let at = Placement::turned(turn, DVec3::new(-0.8, 0.0, 0.6) * far).expect("a rotation");
        let meet = assert_same(&outer, &inner, at);
        answers[usize::from(meet)] += 1;
    }
    assert!(answers[0] > 40 && answers[1] > 40, "{answers:?}");
}

/// Flat sheets far from the origin of their frames, so that their slabs are as thin as the rounding of f32 there, and
/// bent sheets at all scales, where products of coordinates exceed the range of f32.
#[test]
fn slabs_and_planes_prove_nothing_that_is_false() {
    let out = Vec3::new(900.0, 1100.0, -700.0);
    let tilted = |x: f32, z: f32| out + Vec3::new(x + 0.3 * z, 0.61 * x - 0.43 * z, z - 0.2 * x);
    let flat = sheet(tilted);
    let normal = DVec3::new(0.61, -1.0, -0.37).normalize();
    let mut answers = [0, 0];
    for k in -30..=30 {
        let offset = DVec3::new(0.11, 0.03, 0.07) + normal * (f64::from(k) * 4e-6);
        let meet = assert_same(&flat, &flat, offset);
        answers[usize::from(meet)] += 1;
    }
    let bent = sheet(|x, z| Vec3::new(x, 0.1 * (9.0 * x).sin() * (7.0 * z).cos(), z));
    for exponent in [-36, -20, -10, 10, 12, 13, 14, 15, 18, 25, 36, 38] {
        let scale = 10.0_f64.powi(exponent);
        let scaled = scaled(&bent, DVec3::splat(scale));
        for k in 0..12 {
            let offset = DVec3::new(0.2, 0.02 * f64::from(k), 0.1) * scale;
            let meet = assert_same(&scaled, &scaled, offset);
            answers[usize::from(meet)] += 1;
            let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.64, 0.48), 0.3);
            let at = Placement::turned(turn, offset).expect("a rotation");
            let meet = assert_same(&scaled, &scaled, at);
            answers[usize::from(meet)] += 1;
        }
    }
    assert!(answers[0] > 50 && answers[1] > 50, "{answers:?}");
}

/// Regression: slabs rotated by a matrix that is not exactly a rotation belong to a slightly different mesh.
#[test]
fn what_passes_as_of_unit_length_is_a_rotation() {
    let turn = DQuat::from_axis_angle(DVec3::new(0.8, 0.0, -0.6), 3.0);
    let longer = DQuat::from_array(turn.to_array().map(|x| x * 1.00009));
    let at = Placement::turned(longer, DVec3::ZERO).expect("passes");
    let second = sheet(|x, z| Vec3::new(x, 10.0 + 1e-4 * (20.0 * x).sin() * (17.0 * z).cos(), z));
    let up = at.place(Vec3::Y);
    let mut answers = [0, 0];
    for k in -40..40 {
        let gap = f64::from(k) * 1e-5 * up;
        let first = sheet(|x, z| {
            let over = at.place(Vec3::new(x, 10.0 + 0.3e-4 * x, z));
            (over + gap).as_vec3()
        });
        let meet = assert_same(&first, &second, at);
        answers[usize::from(meet)] += 1;
    }
    assert!(answers[0] > 10 && answers[1] > 10, "{answers:?}");
    assert!(Placement::turned(DQuat::from_array([0.0; 4]), DVec3::ZERO).is_none());
    assert!(Placement::turned(DQuat::from_array([0.0, 0.0, 0.0, 1.1]), DVec3::ZERO).is_none());
}

/// Regression: at the limits of f32 boxes are infinite and exclude nothing.
#[test]
fn the_largest_floats_are_in_range() {
    let end = f32::MAX;
    let corners = vec![
        Vec3::ZERO,
        Vec3::new(end, 0.0, 0.0),
        Vec3::new(0.0, end, 0.0),
    ];
    let mesh = mesh(corners, vec![[0, 1, 2]]);
    let turn = DQuat::from_rotation_z(0.3);
    for offset in [0.0, 1e38, 1e39, -7e38, 1e200, f64::NAN, f64::INFINITY] {
        let offset = DVec3::splat(offset);
        let meet = assert_same(&mesh, &mesh, offset);
        assert_eq!(meet, offset == DVec3::ZERO);
        let turned = Placement::turned(turn, offset).expect("a rotation");
        let meet = assert_same(&mesh, &mesh, turned);
        assert_eq!(meet, offset == DVec3::ZERO);
    }
}

/// Regression: the midpoint of two neighbouring floats is one of them.
#[test]
fn triangles_with_almost_one_centre_make_a_tree() {
    for count in [5, 9, 17, 40, 200] {
        let ends = [f32::from_bits(0x3f80_0001), f32::from_bits(0x3f80_0002)];
        let corners = (0..count).flat_map(|i| [0.0, ends[i % 2], 0.0]);
        let corners = corners.map(|x| Vec3::new(x, 0.0, 0.0)).collect();
        let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
        let mesh = mesh(corners, triangles.collect());
        assert!(assert_same(&mesh, &mesh, DVec3::ZERO));
    }
}

/// Two soups in one plane, interleaved, that meet in a single triangle. Their slabs have zero thickness. The second one
/// lies far from its own origin, so their heights differ by rounding.
#[test]
fn roundings_of_slabs_are_allowed_for() {
    let soup = |shift: f32, extra: Option<(f32, f32)>, at: &dyn Fn(f32, f32) -> Vec3| {
        let cells = (0..14u8).flat_map(|i| (0..14u8).map(move |j| (f32::from(i), f32::from(j))));
        let corners = cells.map(|(s, z)| (s + shift, z + shift)).chain(extra);
        let corners = corners.flat_map(|(s, z)| [(s, z), (s + 0.25, z), (s, z + 0.25)]);
        let vertices: Vec<Vec3> = corners.map(|(s, z)| at(s, z)).collect();
        let triangles = (0..vertices.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
        mesh(vertices, triangles.collect())
    };
    for far in [500.0f32, 50_000.0] {
        let first = soup(0.0, None, &|s, z| Vec3::new(far + s, -far - s, z));
        let offset = DVec3::new(f64::from(far), f64::from(-far - 1.0), 0.0);
        for (extra, meet) in [
            (None, false),
            (Some((9.125, 5.0)), true),
            (Some((3.0, 11.125)), true),
        ] {
            let second = soup(0.5, extra, &|s, z| Vec3::new(s, 1.0 - s, z));
            assert_eq!(assert_same(&first, &second, offset), meet);
            assert_eq!(assert_same(&second, &first, -offset), meet);
        }
    }
}
