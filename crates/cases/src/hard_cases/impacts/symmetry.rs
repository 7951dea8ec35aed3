//! Cases 20, 25, 29: worlds that must end in equivalent states.

use std::sync::Arc;

use kit::bodies::{ball, immovable, mesh_body, wall};
use kit::meshes::{builtin, cube, star};
use kit::worlds::{precise, run, world_of};
use sim_core::{Body, DVec3, Impact, Mesh, Shape, Vec3};

use super::{Finding, Tried, apart, motions, worst};

/// The number of steps.
pub const STEPS: u64 = 96;
/// The step, s.
pub const DT: f64 = 1.0 / 48.0;

/// Balls of several sizes and masses between walls; cubes and the cow; cubes and stars.
pub fn scenes() -> [(&'static str, Vec<Body>); 3] {
    let (cube, cow, star) = (cube(0.5), builtin("cow.obj"), star(1.0, 0.2));
    let of = |mass, body| Body { mass, ..body };
    let v = DVec3::new;
    let balls = vec![
        wall(v(1.0, 0.0, 0.25), -4.0 * DVec3::X, DVec3::ZERO),
        wall(v(-1.0, 0.5, 0.0), 4.0 * DVec3::X, DVec3::ZERO),
        ball(0.5, v(-2.0, 0.1, 0.0), v(4.0, 0.0, 0.3)),
        of(3.0, ball(0.75, v(0.3, 0.0, 0.2), v(-1.0, 0.2, -0.1))),
        of(0.7, ball(0.25, v(2.4, 0.3, -0.1), v(-3.0, -0.1, 0.2))),
    ];
    let cows = vec![
        immovable(mesh_body(&cube, v(5.0, 0.2, 0.1), DVec3::ZERO)),
        mesh_body(&cube, v(-4.0, 0.3, 0.1), v(4.0, 0.1, 0.3)),
        of(3.0, mesh_body(&cow, v(0.3, 0.0, 0.2), v(-1.0, 0.2, -0.1))),
        of(
            0.7,
            mesh_body(&cube, v(3.2, 0.35, -0.1), v(-3.0, -0.1, 0.2)),
        ),
    ];
    let stars = vec![
        immovable(mesh_body(&cube, v(4.0, 0.2, 0.1), DVec3::ZERO)),
        mesh_body(&cube, v(-2.5, 0.3, 0.1), v(4.0, 0.1, 0.3)),
        of(3.0, mesh_body(&star, v(0.3, 0.0, 0.2), v(-1.0, 0.2, -0.1))),
        of(
            0.7,
            mesh_body(&star, v(2.4, 0.35, -0.1), v(-3.0, -0.1, 0.2)),
        ),
    ];
    [
        ("balls", balls),
        ("cubes and a cow", cows),
        ("cubes and stars", stars),
    ]
}

type Ends = Vec<(DVec3, DVec3)>;

fn ends(bodies: &[Body]) -> anyhow::Result<Ends> {
    let mut world = world_of(precise(DT), bodies);
    let impacts = run(&mut world, STEPS)?.len();
    anyhow::ensure!(impacts >= 2, "{impacts} impacts are too few");
    Ok(motions(&world))
}

fn scaled(shape: &Shape, by: f64) -> anyhow::Result<Shape> {
    Ok(match shape {
        Shape::Mesh(mesh) => {
            let vertices = mesh.vertices().iter().map(|&v| v * by as f32);
            let mesh = Mesh::new(vertices.collect(), mesh.triangles().to_vec())?;
            Shape::Mesh(Arc::new(mesh))
        }
        Shape::Sphere { radius } => Shape::Sphere {
            radius: radius * by,
        },
        half_space => half_space.clone(),
    })
}

fn mirrored(shape: &Shape) -> anyhow::Result<Shape> {
    Ok(match shape {
        Shape::Mesh(mesh) => {
            let vertices = mesh
                .vertices()
                .iter()
                .map(|&v| v * Vec3::new(-1.0, 1.0, 1.0));
            let triangles = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]);
            Shape::Mesh(Arc::new(Mesh::new(
                vertices.collect(),
                triangles.collect(),
            )?))
        }
        Shape::HalfSpace { normal } => Shape::HalfSpace {
            normal: *normal * MIRROR,
        },
        sphere => sphere.clone(),
    })
}

const MIRROR: DVec3 = DVec3::new(-1.0, 1.0, 1.0);

fn mapped(
    bodies: &[Body],
    shape: impl Fn(&Shape) -> anyhow::Result<Shape>,
    vector: impl Fn(DVec3) -> DVec3,
) -> anyhow::Result<Vec<Body>> {
    let bodies = bodies.iter().map(|body| {
        Ok(Body {
            shape: body.shape.as_ref().map(&shape).transpose()?,
            position: vector(body.position),
            velocity: vector(body.velocity),
            ..body.clone()
        })
    });
    bodies.collect()
}

/// The figure is relative to the tolerances; it is infinite if results that must agree bit for bit do not.
pub(crate) fn symmetries() -> Tried {
    let (mut figure, mut bits): (f64, u32) = (0.0, 0);
    // Vertices are f32, and must not underflow.
    for ((_, bodies), largest) in scenes().iter().zip([200, 60, 60]) {
        let base = ends(bodies)?;
        for k in [1, -1, 20, -20, 60, -60, 200, -200] {
            if k > largest || -k > largest {
                continue;
            }
            let by = 2f64.powi(k);
            let found = ends(&mapped(bodies, |s| scaled(s, by), |v| v * by)?)?;
            let exact: Ends = base.iter().map(|&(x, v)| (x * by, v * by)).collect();
            bits += u32::from(found != exact);
        }
        let found = ends(&mapped(bodies, mirrored, |v| v * MIRROR)?)?;
        let exact: Ends = base
            .iter()
            .map(|&(x, v)| (x * MIRROR, v * MIRROR))
            .collect();
        bits += u32::from(found != exact);
        let reversed: Vec<Body> = bodies.iter().rev().cloned().collect();
        let mut found = ends(&reversed)?;
        found.reverse();
        let reordered = apart(&found, &base);
        let wind = 1000.0 * DVec3::X;
        let way = STEPS as f64 * DT * wind;
        let moving: Vec<Body> = bodies
            .iter()
            .map(|body| Body {
                velocity: body.velocity + wind,
                ..body.clone()
            })
            .collect();
        let found: Ends = ends(&moving)?
            .iter()
            .map(|&(x, v)| (x - way, v - wind))
            .collect();
        let moved = apart(&found, &base) / way.x;
        let mut world = world_of(precise(DT), bodies);
        let there = run(&mut world, STEPS)?.len();
        for i in 0..world.len() {
            world.set_velocity(i, -world.velocity(i))?;
        }
        bits += u32::from(run(&mut world, STEPS)?.len() != there);
        let start: Ends = bodies.iter().map(|b| (b.position, -b.velocity)).collect();
        let back = apart(&motions(&world), &start);
        figure = worst([figure, reordered / 1e-12, moved / 1e-12, back / 1e-9]);
    }
    let why = format!(
        "scaled by powers of two and mirrored: {bits} runs differ in a bit, or in impacts if reversed; \
         figure: bodies in another order and 1 km/s more for all, of 1e-12; reversed, of 1e-9"
    );
    let figure = if bits > 0 { f64::INFINITY } else { figure };
    Ok(Finding::within(figure, 1.0, why))
}

pub(crate) fn any_dt() -> Tried {
    let (mut figure, mut other): (f64, u32) = (0.0, 0);
    for (_, bodies) in scenes() {
        let mut base = None;
        for steps in [1, 2, 10, 60, 1_000, 10_000] {
            let mut world = world_of(precise(1.0 / steps as f64), &bodies);
            let impacts = run(&mut world, steps)?;
            let (first, ends) = base.get_or_insert_with(|| (impacts.clone(), motions(&world)));
            let pairs = |impacts: &[Impact]| impacts.iter().map(|i| i.bodies).collect::<Vec<_>>();
            other += u32::from(pairs(first) != pairs(&impacts) || impacts.len() < 2);
            let late = first
                .iter()
                .zip(&impacts)
                .map(|(a, b)| (a.time - b.time).abs());
            figure = worst(late.chain([figure, apart(&motions(&world), ends)]));
        }
    }
    let why = format!(
        "1 s to 1e-4 s; {other} runs have other impacts; figure: times, and ends after 1 s"
    );
    let figure = if other > 0 { f64::INFINITY } else { figure };
    Ok(Finding::within(figure, 1e-12, why))
}

pub(crate) fn same_bits() -> Tried {
    let mut differing = 0;
    for (_, bodies) in scenes() {
        let first = ends(&bodies)?;
        differing += u32::from(ends(&bodies)? != first);
        let others: Vec<_> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..4).map(|_| scope.spawn(|| ends(&bodies))).collect();
            threads.into_iter().map(|thread| thread.join()).collect()
        });
        for other in others {
            let is_same = matches!(other, Ok(Ok(ends)) if ends == first);
            differing += u32::from(!is_same);
        }
    }
    let why = "runs that differ in a bit, of two after each other and four at once";
    Ok(Finding::within(f64::from(differing), 0.0, why))
}
