//! Floors and hollows of triangles.

use std::f64::consts::TAU;

use kit::random::Random;
use kit::shapes::mesh;
use sim_core::{DVec3, Shape, Vec3};

/// A level grid of cells in the plane y = 0, centred at its origin. Its inner vertices are displaced by a fraction of a
/// cell, and its diagonals have either direction.
pub(crate) fn grid((along, across): (u32, u32), size: [f64; 2], random: &mut Random) -> Shape {
    let mut vertices = Vec::new();
    for i in 0..=along {
        for j in 0..=across {
            let is_inner = i > 0 && i < along && j > 0 && j < across;
            let mut aside = || {
                if is_inner {
                    random.from(-0.3, 0.3)
                } else {
                    0.0
                }
            };
            let x = (f64::from(i) + aside()) / f64::from(along) - 0.5;
            let z = (f64::from(j) + aside()) / f64::from(across) - 0.5;
            vertices.push(Vec3::new((size[0] * x) as f32, 0.0, (size[1] * z) as f32));
        }
    }
    let number = |i: u32, j: u32| i * (across + 1) + j;
    let mut triangles = Vec::new();
    for i in 0..along {
        for j in 0..across {
            let [p, q] = [number(i, j), number(i, j + 1)];
            let [r, s] = [number(i + 1, j + 1), number(i + 1, j)];
            match random.from(0.0, 1.0) < 0.5 {
                true => triangles.extend([[p, q, r], [p, r, s]]),
                false => triangles.extend([[p, q, s], [q, r, s]]),
            }
        }
    }
    mesh(vertices, triangles)
}

/// A level disc of triangles that share the vertex at its centre.
pub(crate) fn fan(triangles: u32, radius: f64) -> Shape {
    let mut vertices = vec![Vec3::ZERO];
    vertices.extend((0..triangles).map(|i| {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(triangles)).sin_cos();
        Vec3::new((radius * cos) as f32, 0.0, (radius * sin) as f32)
    }));
    let rim = (0..triangles).map(|i| [0, 1 + (i + 1) % triangles, 1 + i]);
    mesh(vertices, rim.collect())
}

/// A surface of revolution about the y axis, open or closed at its ends, given by points (radius, height) of its
/// outline. Where a radius is 0 there is one vertex. Seen from the axis its triangles are counter-clockwise.
pub(crate) fn turned(outline: &[[f64; 2]], sides: u32) -> Shape {
    let mut vertices = Vec::new();
    let mut rings: Vec<Vec<u32>> = Vec::new();
    for &[radius, height] in outline {
        let count = if radius == 0.0 { 1 } else { sides };
        let first = vertices.len() as u32;
        vertices.extend((0..count).map(|i| {
            let (sin, cos) = (TAU * f64::from(i) / f64::from(sides)).sin_cos();
            DVec3::new(radius * cos, height, radius * sin).as_vec3()
        }));
        rings.push((0..sides).map(|i| first + i % count).collect());
    }
    let mut triangles = Vec::new();
    for pair in rings.windows(2) {
        let (low, high) = (&pair[0], &pair[1]);
        for i in 0..sides as usize {
            let j = (i + 1) % sides as usize;
            for triangle in [[low[i], low[j], high[j]], [low[i], high[j], high[i]]] {
                let [a, b, c] = triangle;
                if a != b && b != c && c != a {
                    triangles.push(triangle);
                }
            }
        }
    }
    mesh(vertices, triangles)
}
