//! The inertia of meshes against rational arithmetic by another quadrature rule: the mean of a polynomial of degree two
//! over a tetrahedron is a twentieth of the sum of its values at the corners plus four fifths of that at the middle.

use kit::random::Random;
use kit::rational::{Point, Q, cross, dot, rational, zero};
use sim_core::{DMat3, DQuat, DVec3, Mesh, Solid, Vec3};

/// The volume, and its first and second moments about the origin, exactly.
fn integrals(mesh: &Mesh) -> (Q, Point, [[Q; 3]; 3]) {
    let whole = |n: i64| Q::from_integer(n.into());
    let mut volume = zero();
    let mut first = [zero(), zero(), zero()];
    let mut second = [0; 3].map(|_| [zero(), zero(), zero()]);
    for triangle in 0..mesh.triangles().len() {
        let corners = mesh.corners(triangle);
        let corners = corners.map(|v| v.as_dvec3().to_array().map(rational));
        let part = dot(&corners[0], &cross(&corners[1], &corners[2])) / whole(6);
        let sum = |i: usize| &corners[0][i] + &corners[1][i] + &corners[2][i];
        for i in 0..3 {
            first[i] += &part * sum(i) / whole(4);
            for j in 0..3 {
                let at_corners: Q = corners.iter().map(|v| &v[i] * &v[j]).sum();
                let at_middle = sum(i) * sum(j) / whole(16);
                let mean = at_corners / whole(20) + at_middle * whole(4) / whole(5);
                second[i][j] += &part * mean;
            }
        }
        volume += part;
    }
    (volume, first, second)
}

fn rounded(q: &Q) -> f64 {
    // The digits are scaled first, because numerator and denominator may each exceed f64.
    let scale = Q::from_integer(2.into()).pow(200);
    let whole = (q * &scale).round().to_integer();
    whole.to_string().parse::<f64>().expect("digits") * 2_f64.powi(-200)
}

/// A star: the radius varies with the direction, so that faces have many orientations.
fn star(random: &mut Random, away: DVec3) -> Mesh {
    let (n, k) = (7_u32, 9_u32);
    let mut vertices = vec![away.as_vec3() + Vec3::Z, away.as_vec3() - Vec3::Z];
    for i in 0..n * k {
        let (ring, part) = (i / k, i % k);
        let polar = f64::from(ring + 1) * std::f64::consts::PI / f64::from(n + 1);
        let round = f64::from(part) * std::f64::consts::TAU / f64::from(k);
        let (sin, cos) = polar.sin_cos();
        let out = DVec3::new(sin * round.cos(), sin * round.sin(), cos);
        vertices.push((away + random.from(0.3, 1.7) * out).as_vec3());
    }
    let at = |ring: u32, i: u32| 2 + ring * k + i % k;
    let mut triangles = Vec::new();
    for i in 0..k {
        triangles.push([0, at(0, i), at(0, i + 1)]);
        triangles.push([1, at(n - 1, i + 1), at(n - 1, i)]);
        for ring in 0..n - 1 {
            triangles.push([at(ring, i), at(ring + 1, i), at(ring, i + 1)]);
            triangles.push([at(ring, i + 1), at(ring + 1, i), at(ring + 1, i + 1)]);
        }
    }
    Mesh::new(vertices, triangles).expect("a mesh")
}

#[test]
fn stars_have_the_inertia_of_rational_arithmetic() {
    let mut random = Random::splitmix(14);
    for case in 0..16 {
        let away = if case % 2 == 0 { 0.0 } else { 50.0 } * random.vector();
        let mesh = star(&mut random, away);
        let thin = DVec3::new(1.0, 1.0, [1.0, 1e-3][case / 2 % 2]);
        let mesh = mesh.transformed(DQuat::IDENTITY, thin).expect("a mesh");
        let solid = Solid::of(&mesh).expect("a solid");
        let (volume, first, second) = integrals(&mesh);
        let centre = first.map(|x| x / &volume);
        // The mean of products of coordinates about the centre.
        let spread = |i: usize, j: usize| &second[i][j] / &volume - &centre[i] * &centre[j];
        let size = mesh.bounds().half_extent().max_element();
        let off = DVec3::from_array([0, 1, 2].map(|i| rounded(&centre[i]))) - solid.centre();
        assert!(
            off.length() < 4e-16 * (size + away.length()),
            "{case}: {off}"
        );
        assert!(
            (solid.volume() / rounded(&volume) - 1.0).abs() < 2e-15,
            "{case}"
        );
        // The tensor from moments and axes, compared with the exact one.
        let inertia = solid.inertia(1.0).expect("an inertia");
        let axes = DMat3::from_quat(inertia.axes());
        let tensor = axes * DMat3::from_diagonal(inertia.moments()) * axes.transpose();
        let trace: Q = (0..3).map(|i| spread(i, i)).sum();
        for i in 0..3 {
            for j in 0..3 {
                let unit = if i == j { trace.clone() } else { zero() };
                let exact = rounded(&(unit - spread(i, j)));
                let error = (tensor.col(j)[i] - exact).abs() / inertia.moments().max_element();
                assert!(error < 1e-14, "{case}: {i} {j} {error:e}");
            }
        }
    }
}
