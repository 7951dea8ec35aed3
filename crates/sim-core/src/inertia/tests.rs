use alloc::{string::ToString, vec, vec::Vec};
use glam::Vec3;

use super::*;
use crate::test_meshes::{cube, sphere};

fn mesh(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
    let vertices = vertices.iter().map(|&v| Vec3::from_array(v)).collect();
    Mesh::new(vertices, triangles.to_vec()).unwrap()
}

/// Triangles of a convex hull about its origin, from all triples of vertices that have the others on one side: simple,
/// and by another method than the code under test.
fn hull(vertices: &[Vec3]) -> Mesh {
    let mut faces: Vec<Vec<u32>> = vec![];
    let n = vertices.len() as u32;
    for (a, b, c) in (0..n).flat_map(|a| (0..n).flat_map(move |b| (0..n).map(move |c| (a, b, c)))) {
        let at = |i: u32| vertices[i as usize].as_dvec3();
        let normal = (at(b) - at(a)).cross(at(c) - at(a));
        if a >= b || a >= c || b == c || normal.dot(at(a)) <= 1e-6 {
            continue;
        }
        let height = |i: u32| normal.dot(at(i) - at(a));
        if (0..n).any(|i| height(i) > 1e-5) {
            continue;
        }
        // All corners of the face, in order around its centre.
        let mut face: Vec<u32> = (0..n).filter(|&i| height(i).abs() <= 1e-5).collect();
        let middle = face.iter().map(|&i| at(i)).sum::<DVec3>() / face.len() as f64;
        let (x, y) = (at(face[0]) - middle, normal.cross(at(face[0]) - middle));
        let angle = |i: u32| {
            libm::atan2(
                (at(i) - middle).dot(y) * x.length() / y.length(),
                (at(i) - middle).dot(x),
            )
        };
        face.sort_by(|&i, &j| angle(i).total_cmp(&angle(j)));
        let least = (0..face.len()).min_by_key(|&i| face[i]).unwrap();
        face.rotate_left(least);
        if !faces.contains(&face) {
            faces.push(face);
        }
    }
    let fan = |face: &Vec<u32>| {
        let face = face.clone();
        (1..face.len() - 1).map(move |i| [face[0], face[i], face[i + 1]])
    };
    Mesh::new(vertices.to_vec(), faces.iter().flat_map(fan).collect()).unwrap()
}

/// Some points with all combinations of signs of their coordinates, each result once.
fn signs(points: &[[f64; 3]]) -> Vec<Vec3> {
    let mut all: Vec<Vec3> = vec![];
    for p in points {
        for bits in 0..8 {
            let sign = |axis: usize| {
                if bits >> axis & 1 == 0 {
                    p[axis]
                } else {
                    -p[axis]
                }
            };
            let v = DVec3::new(sign(0), sign(1), sign(2)).as_vec3();
            if !all.contains(&v) {
                all.push(v);
            }
        }
    }
    all
}

fn cycles([a, b, c]: [f64; 3]) -> [[f64; 3]; 3] {
    [[a, b, c], [b, c, a], [c, a, b]]
}

#[test]
fn platonic_solids_have_their_moments() {
    let golden = 0.5 * (1.0 + libm::sqrt(5.0));
    let one = 1.0 / golden;
    let tetrahedron = [[1., 1., 1.], [1., -1., -1.], [-1., 1., -1.], [-1., -1., 1.]];
    let tetrahedron: Vec<Vec3> = tetrahedron.map(Vec3::from_array).into();
    let cubic = signs(&[[1.0, 1.0, 1.0]]);
    let octahedron = signs(&cycles([1.0, 0.0, 0.0]));
    let icosahedron = signs(&cycles([0.0, 1.0, golden]));
    let dodecahedron: Vec<Vec3> = [cubic.clone(), signs(&cycles([0.0, one, golden]))].concat();
    // Vertices, their edge, and the moment of unit mass and edge.
    let solids = [
        (cubic, 2.0, 1.0 / 6.0, 1e-15),
        (tetrahedron, libm::sqrt(8.0), 1.0 / 20.0, 1e-15),
        (octahedron, libm::sqrt(2.0), 1.0 / 10.0, 1e-15),
        (icosahedron, 2.0, 0.261_803_398_874_989_5, 1e-7),
        (dodecahedron, 2.0 * one, 0.607_355_503_741_639_3, 1e-7),
    ];
    for (vertices, edge, moment, bar) in solids {
        let inertia = Inertia::solid(&hull(&vertices), 1.0).unwrap();
        let found = inertia.moments() / (edge * edge);
        let error = (found / moment - 1.0).abs().max_element();
        assert!(
            error <= bar,
            "{} vertices: {found} {moment}",
            vertices.len()
        );
        assert!(inertia.centre().length() < 1e-7);
    }
}

#[test]
fn a_box_keeps_its_axes_and_a_cube_has_equal_moments_to_the_bit() {
    let inertia = Inertia::solid(&cube(), 6.0).unwrap();
    assert_eq!(inertia.moments(), DVec3::ONE);
    assert_eq!(
        (inertia.axes(), inertia.centre()),
        (DQuat::IDENTITY, DVec3::ZERO)
    );
    // Side lengths that f32 cannot represent.
    let sides = DVec3::new(0.1, 0.7, 1.3);
    let boxed = cube().transformed(DQuat::IDENTITY, sides).unwrap();
    let exact = boxed.bounds().half_extent() * 2.0;
    let solid = Solid::of(&boxed).unwrap();
    let squares = exact * exact;
    let moments = (DVec3::splat(squares.element_sum()) - squares) / 12.0;
    let found = solid.inertia(1.0).unwrap();
    assert!((found.moments() / moments - 1.0).abs().max_element() < 4.0 * f64::EPSILON);
    assert!((solid.volume() / exact.element_product() - 1.0).abs() < 4.0 * f64::EPSILON);
    assert_eq!(found.axes(), DQuat::IDENTITY);
}

#[test]
fn where_and_how_a_solid_lies_changes_only_where_its_axes_are() {
    let sides = DVec3::new(1.0, 2.0, 4.0);
    let still = cube().transformed(DQuat::IDENTITY, sides).unwrap();
    let moments = Inertia::solid(&still, 1.0).unwrap().moments();
    let turn = DQuat::from_scaled_axis(DVec3::new(0.4, -1.1, 0.7));
    let turned = still.transformed(turn, DVec3::ONE).unwrap();
    let away = Vec3::new(64.0, -32.0, 8.0);
    let moved = turned.vertices().iter().map(|&v| v + away).collect();
    let moved = Mesh::new(moved, turned.triangles().to_vec()).unwrap();
    let found = Inertia::solid(&moved, 1.0).unwrap();
    // Vertices were rounded to f32, and at 64 m to 4e-6 m.
    assert!((found.centre() - away.as_dvec3()).length() < 4e-6);
    let tensor = |inertia: DVec3, axes: DQuat| {
        let axes = DMat3::from_quat(axes);
        axes * DMat3::from_diagonal(inertia) * axes.transpose()
    };
    let difference = tensor(found.moments(), found.axes()) - tensor(moments, turn);
    assert!(difference.to_cols_array().iter().all(|x| x.abs() < 2e-5));
}

#[test]
fn size_changes_no_digit() {
    let solid = Solid::of(&sphere(9)).unwrap();
    for power in [-100, -20, 33, 100] {
        let scale = libm::exp2(f64::from(power));
        let scaled = sphere(9)
            .transformed(DQuat::IDENTITY, DVec3::splat(scale))
            .unwrap();
        let scaled = Solid::of(&scaled).unwrap();
        assert_eq!(scaled.axes, solid.axes);
        assert_eq!(scaled.centre, solid.centre * scale);
        assert_eq!(scaled.spread, solid.spread * scale * scale);
        assert_eq!(scaled.volume, solid.volume * scale * scale * scale);
    }
}

#[test]
fn round_meshes_come_near_the_ball() {
    for (n, bar) in [(20, 2e-2), (80, 2e-3)] {
        let inertia = Inertia::solid(&sphere(n), 1.0).unwrap();
        let ball = Inertia::ball(1.0, 1.0).unwrap();
        assert!(
            (inertia.moments() / ball.moments() - 1.0)
                .abs()
                .max_element()
                < bar
        );
    }
    assert_eq!(Inertia::ball(0.5, 10.0).unwrap().moments(), DVec3::ONE);
}

#[test]
fn a_ring_has_the_moments_of_a_torus() {
    // Radii 1 and 1/4: about the axis m (R² + 3 r²/4), across it m (R²/2 + 5 r²/8).
    let (n, k) = (256, 128);
    let angle = |i: u32, of: u32| f64::from(i) * core::f64::consts::TAU / f64::from(of);
    let place = |i: u32, j: u32| {
        let (round, around) = (angle(i, n), angle(j, k));
        let out = 1.0 + 0.25 * libm::cos(around);
        let (x, y) = (out * libm::cos(round), out * libm::sin(round));
        DVec3::new(x, y, 0.25 * libm::sin(around)).as_vec3()
    };
    let vertices = (0..n * k).map(|v| place(v / k, v % k)).collect();
    let at = |i: u32, j: u32| i % n * k + j % k;
    let quads = (0..n * k).map(|v| (v / k, v % k));
    let triangles = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let ring = Mesh::new(vertices, triangles.collect()).unwrap();
    let moments = Inertia::solid(&ring, 1.0).unwrap().moments();
    let exact = DVec3::new(0.5 + 0.625 / 16.0, 0.5 + 0.625 / 16.0, 1.0 + 0.75 / 16.0);
    let mut found = moments.to_array();
    found.sort_by(f64::total_cmp);
    let error = DVec3::from_array(found) / exact - 1.0;
    assert!(error.abs().max_element() < 1e-3, "{found:?} {exact}");
}

#[test]
fn what_has_no_inside_is_refused_by_name() {
    let all = cube();
    let with = |triangles: Vec<[u32; 3]>| Mesh::new(all.vertices().to_vec(), triangles).unwrap();
    let refused = |mesh: &Mesh| Solid::of(mesh).unwrap_err();
    let triangles = all.triangles().to_vec();
    assert_eq!(refused(&with(triangles[1..].to_vec())), InertiaError::Open);
    let mut one = triangles.clone();
    one[3].swap(0, 1);
    assert_eq!(refused(&with(one)), InertiaError::NotOriented);
    let inward = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert_eq!(
        refused(&with(inward)),
        InertiaError::InsideOut { volume: -1.0 }
    );
    // A sheet with two sides, and one that is parallel to no axis.
    let sheet = [[0, 1, 2], [0, 2, 1]];
    let lying = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
    let aslant = [[0.1, 0.2, 0.3], [1.1, -0.7, 0.4], [0.3, 0.9, -0.8]];
    for corners in [lying, aslant] {
        assert_eq!(refused(&mesh(&corners, &sheet)), InertiaError::NoVolume);
    }
    // A cube of side 1 and, far away, one of side 0.9 that is inside out.
    let far = all.vertices().iter().map(|&v| v * 0.9 + 9.0 * Vec3::X);
    let vertices = all.vertices().iter().copied().chain(far).collect();
    let inward = triangles
        .iter()
        .map(|t| t.map(|v| v + 8))
        .map(|[a, b, c]| [a, c, b]);
    let both = Mesh::new(vertices, triangles.iter().copied().chain(inward).collect()).unwrap();
    assert_eq!(refused(&both), InertiaError::NotSolid);
    assert!(refused(&both).to_string().contains("inside out"));
}

#[test]
fn given_moments_must_be_those_of_a_body() {
    let new = |x, y, z| Inertia::new(DVec3::new(x, y, z), DQuat::IDENTITY, DVec3::ZERO);
    // A plate: rounding puts the sum of two moments on the wrong side of the third.
    assert!(
        new(0.1, 0.7, 0.8).is_ok() && new(1.0, 1.0, 2.0).is_ok() && new(1e-12, 1.0, 1.0).is_ok()
    );
    let moments = DVec3::new(1.0, 1.0, 2.000_001);
    assert_eq!(
        new(1.0, 1.0, 2.000_001),
        Err(InertiaError::Triangle { moments })
    );
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(
            matches!(new(1.0, bad, 1.0), Err(InertiaError::NotPositive { .. })),
            "{bad}"
        );
        assert!(
            matches!(Inertia::ball(1.0, bad), Err(InertiaError::Mass { .. })),
            "{bad}"
        );
        assert!(
            matches!(Inertia::ball(bad, 1.0), Err(InertiaError::Radius { .. })),
            "{bad}"
        );
        assert!(
            matches!(Inertia::solid(&cube(), bad), Err(InertiaError::Mass { .. })),
            "{bad}"
        );
    }
    let axes = DQuat::from_xyzw(1.0, 1.0, 0.0, 0.0);
    assert_eq!(
        Inertia::new(DVec3::ONE, axes, DVec3::ZERO),
        Err(InertiaError::Axes)
    );
    let centre = DVec3::new(0.0, f64::NAN, 0.0);
    assert_eq!(
        Inertia::new(DVec3::ONE, DQuat::IDENTITY, centre),
        Err(InertiaError::Centre)
    );
}
