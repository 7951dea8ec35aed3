//! Bodies on oblique planes of triangles slide down them as if there were no seams.

use kit::bodies::{body, immovable};
use kit::random::Random;
use kit::shapes::mesh;
use kit::worlds::add_gravity;
use sim_core::{Body, DVec3, Shape, Vec3};

use crate::scenes::{energy, judge, step, world};
use crate::shapes::{cube, globe};

const G: f64 = 10.0;

/// A plane through the origin with an integer normal, cut into triangles whose corners have integer coordinates and lie
/// in it exactly.
fn slope(random: &mut Random, normal: [i64; 3]) -> Shape {
    let [a, b, c] = normal;
    let (u, w) = ([b, -a, 0], [0, c, -b]);
    let cells = random.whole(1, 5);
    let size = random.pick(&[2, 8, 32]);
    let vertex = |i: i64, j: i64| {
        let at = |k: usize| size * ((2 * i - cells) * u[k] + (2 * j - cells) * w[k]);
        Vec3::new(at(0) as f32, at(1) as f32, at(2) as f32)
    };
    let grid = (0..=cells).flat_map(|i| (0..=cells).map(move |j| (i, j)));
    let vertices = grid.map(|(i, j)| vertex(i, j)).collect();
    let number = |i: i64, j: i64| (i * (cells + 1) + j) as u32;
    let mut triangles = Vec::new();
    for i in 0..cells {
        for j in 0..cells {
            let [p, q] = [number(i, j), number(i + 1, j)];
            let [r, s] = [number(i + 1, j + 1), number(i, j + 1)];
            match random.one_in(2) {
                true => triangles.extend([[p, q, r], [p, r, s]]),
                false => triangles.extend([[p, q, s], [q, r, s]]),
            }
        }
    }
    mesh(vertices, triangles)
}

fn case(random: &mut Random) -> Option<Result<(), String>> {
    let whole = loop {
        let [a, b, c] = [random.whole(-4, 4), random.whole(1, 5), random.whole(-4, 4)];
        if a != 0 || c != 0 {
            break [a, b, c];
        }
    };
    let normal = DVec3::from_array(whole.map(|x| x as f64)).normalize();
    let slope = slope(random, whole);
    let size = random.pick(&[0.25, 0.3, 0.5, 0.75, 1.0]);
    let shape = match random.below(3) {
        0 => Shape::Sphere { radius: size },
        1 => cube(size as f32),
        _ => globe(5, size as f32),
    };
    // The support of the body towards the plane.
    let reach = match &shape {
        Shape::Mesh(mesh) => {
            let heights = mesh.vertices().iter().map(|v| -normal.dot(v.as_dvec3()));
            heights.fold(0.0, f64::max)
        }
        _ => size,
    };
    let gap = random.pick(&[0.0, 0.0, 1e-15, 1e-14, 1e-12]);
    let aside = random.vector().reject_from(normal);
    let at = (reach + gap) * normal + aside;
    let restitution = random.pick(&[0.0, 0.5, 1.0]);
    let bodies = [
        immovable(body(&slope, DVec3::ZERO, DVec3::ZERO)),
        body(&shape, at, DVec3::ZERO),
    ];
    let bodies = bodies.map(|body| Body {
        restitution,
        ..body
    });
    let mut world = world(1.0 / 60.0, bodies.to_vec());
    add_gravity(&mut world, DVec3::Y * -G);
    let down = (DVec3::Y * -G).reject_from(normal);
    let start = energy(&world, G);
    let verdict = (|| {
        for _ in 0..24 {
            step(&mut world)?;
        }
        let time = world.time();
        let moved = world.position(1) - at;
        let off = (moved - 0.5 * time * time * down).length();
        let wrong = (world.velocity(1) - time * down).length();
        // Its position is exact up to the rounding of its vertices.
        if off > 1e-6 || wrong > 1e-9 {
            return Err(format!("{off:e} m and {wrong:e} m/s off"));
        }
        let grown = energy(&world, G) - start;
        match grown <= 1e-5 {
            true => Ok(()),
            false => Err(format!("energy grows by {grown:e}")),
        }
    })();
    let kind = match &shape {
        Shape::Mesh(mesh) => mesh.triangles().len(),
        _ => 0,
    };
    let scene =
        || format!("normal {whole:?} size {size}, {kind} triangles, gap {gap:e}, e {restitution}");
    Some(verdict.map_err(|what| format!("{what}: {}", scene())))
}

#[test]
fn bodies_put_on_slopes_slide_down() {
    judge(200, case);
}
