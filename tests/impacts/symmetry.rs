//! Worlds that must end alike: cases 20, 25, 29.

use std::sync::Arc;

use kit::bodies::{immovable, wall};
use kit::meshes::{builtin, cube};
use sim_core::{Body, DVec3, Impact, Mesh, Shape, Vec3, World};

use crate::shapes::star;
use crate::worlds::{assert_close, ball, bits, mesh_body, run, world};

const STEPS: u64 = 96;
const DT: f64 = 1.0 / 48.0;

/// Balls of several sizes and masses between two walls.
fn balls() -> Vec<Body> {
    let of = |mass, radius, position, velocity| Body {
        mass,
        ..ball(radius, position, velocity)
    };
    vec![
        wall(
            DVec3::new(1.0, 0.0, 0.25),
            DVec3::new(-4.0, 0.0, 0.0),
            DVec3::ZERO,
        ),
        wall(
            DVec3::new(-1.0, 0.5, 0.0),
            DVec3::new(4.0, 0.0, 0.0),
            DVec3::ZERO,
        ),
        of(
            1.0,
            0.5,
            DVec3::new(-2.0, 0.1, 0.0),
            DVec3::new(4.0, 0.0, 0.3),
        ),
        of(
            3.0,
            0.75,
            DVec3::new(0.3, 0.0, 0.2),
            DVec3::new(-1.0, 0.2, -0.1),
        ),
        of(
            0.7,
            0.25,
            DVec3::new(2.4, 0.3, -0.1),
            DVec3::new(-3.0, -0.1, 0.2),
        ),
    ]
}

/// Meshes of several kinds.
fn meshes() -> Vec<Body> {
    let of = |mass, mesh, position, velocity| Body {
        mass,
        ..mesh_body(mesh, position, velocity)
    };
    let (cube, star) = (cube(0.5), star(1.0, 0.2));
    vec![
        immovable(mesh_body(&cube, DVec3::new(4.0, 0.2, 0.1), DVec3::ZERO)),
        of(
            1.0,
            &cube,
            DVec3::new(-2.5, 0.3, 0.1),
            DVec3::new(4.0, 0.1, 0.3),
        ),
        of(
            3.0,
            &star,
            DVec3::new(0.3, 0.0, 0.2),
            DVec3::new(-1.0, 0.2, -0.1),
        ),
        of(
            0.7,
            &star,
            DVec3::new(2.4, 0.35, -0.1),
            DVec3::new(-3.0, -0.1, 0.2),
        ),
    ]
}

fn scenes() -> [(&'static str, Vec<Body>); 2] {
    [("balls", balls()), ("meshes", meshes())]
}

/// The same shape, its points and lengths as told.
fn shape_of(shape: &Shape, point: impl Fn(Vec3) -> Vec3, length: f64, is_mirror: bool) -> Shape {
    match shape {
        Shape::Mesh(mesh) => {
            let vertices = mesh.vertices().iter().map(|&v| point(v)).collect();
            let turned = |[a, b, c]: [u32; 3]| if is_mirror { [a, c, b] } else { [a, b, c] };
            let triangles = mesh.triangles().iter().map(|&t| turned(t)).collect();
            Shape::Mesh(Arc::new(Mesh::new(vertices, triangles).expect("a mesh")))
        }
        Shape::Sphere { radius } => Shape::Sphere {
            radius: radius * length,
        },
        // Of any length, so that it may be mapped as a point.
        Shape::HalfSpace { normal } => Shape::HalfSpace {
            normal: point(normal.as_vec3()).as_dvec3(),
        },
    }
}

/// Position and velocity of each body.
type Ends = Vec<(DVec3, DVec3)>;

type Map = fn(DVec3) -> DVec3;

fn ends(world: &World) -> Ends {
    (0..world.len())
        .map(|i| (world.position(i), world.velocity(i)))
        .collect()
}

fn all_ends(bodies: &[Body], least_impacts: usize) -> Ends {
    let mut world = world(DT, bodies);
    let impacts = run(&mut world, STEPS).len();
    assert!(impacts >= least_impacts, "{impacts} impacts");
    ends(&world)
}

#[test]
fn a_world_of_any_size_and_mass_ends_the_same_way_to_the_bit() {
    // Vertices are f32, and must not underflow.
    for ((name, bodies), largest) in scenes().into_iter().zip([200, 60]) {
        let base = all_ends(&bodies, 3);
        for k in [1, -1, 2, -7, 20, -20, 60, -60, 200, -200] {
            if k > largest || -k > largest {
                continue;
            }
            let factor = 2f64.powi(k);
            let scaled: Vec<Body> = bodies
                .iter()
                .map(|body| Body {
                    shape: body.shape.as_ref().map(|shape| {
                        let is_mesh = matches!(shape, Shape::Mesh(_));
                        let by = if is_mesh { factor as f32 } else { 1.0 };
                        shape_of(shape, |v| v * by, factor, false)
                    }),
                    position: body.position * factor,
                    velocity: body.velocity * factor,
                    mass: body.mass * 2f64.powi(-k / 2),
                    ..body.clone()
                })
                .collect();
            let found = all_ends(&scaled, 3);
            for (i, (&(x, v), found)) in base.iter().zip(found).enumerate() {
                assert_eq!(found, (x * factor, v * factor), "{name}: 2^{k}, body {i}");
            }
        }
    }
}

fn mapped(bodies: &[Body], map: Map, is_mirror: bool) -> Vec<Body> {
    let point = |v: Vec3| map(v.as_dvec3()).as_vec3();
    bodies
        .iter()
        .map(|body| Body {
            shape: body
                .shape
                .as_ref()
                .map(|s| shape_of(s, point, 1.0, is_mirror)),
            position: map(body.position),
            velocity: map(body.velocity),
            ..body.clone()
        })
        .collect()
}

#[test]
fn a_mirrored_world_ends_in_the_mirror_to_the_bit() {
    let mirrors: [Map; 4] = [
        |v| DVec3::new(-v.x, v.y, v.z),
        |v| DVec3::new(v.x, -v.y, v.z),
        |v| DVec3::new(v.x, v.y, -v.z),
        |v| -v,
    ];
    for (name, bodies) in scenes() {
        let base = all_ends(&bodies, 3);
        for (k, mirror) in mirrors.into_iter().enumerate() {
            let found = all_ends(&mapped(&bodies, mirror, true), 3);
            for (i, (&(x, v), found)) in base.iter().zip(found).enumerate() {
                assert_eq!(
                    found,
                    (mirror(x), mirror(v)),
                    "{name}: mirror {k}, body {i}"
                );
            }
        }
    }
}

/// Sums of three products round in the order of the axes, so that a bit may differ: 1e-12.
#[test]
fn other_axes_change_nothing_but_rounding() {
    let permutations: [(Map, bool); 3] = [
        (|v| DVec3::new(v.y, v.z, v.x), false),
        (|v| DVec3::new(v.y, v.x, v.z), true),
        (|v| DVec3::new(v.z, v.y, v.x), true),
    ];
    for (name, bodies) in scenes() {
        let base = all_ends(&bodies, 3);
        for (map, is_mirror) in permutations {
            let found = all_ends(&mapped(&bodies, map, is_mirror), 3);
            for (i, (&(x, v), found)) in base.iter().zip(found).enumerate() {
                let what = format!("{name}, body {i}");
                assert_close(found.0, map(x), 1e-12, &what);
                assert_close(found.1, map(v), 1e-12, &what);
            }
        }
    }
}

#[test]
fn the_order_of_bodies_changes_nothing_but_rounding() {
    for (name, bodies) in scenes() {
        let n = bodies.len();
        let base = all_ends(&bodies, 3);
        for shift in 1..n {
            let order: Vec<usize> = (0..n).map(|i| (n + shift - i) % n).collect();
            let reordered: Vec<Body> = order.iter().map(|&i| bodies[i].clone()).collect();
            let found = all_ends(&reordered, 3);
            for (&i, found) in order.iter().zip(found) {
                let what = format!("{name}, order {order:?}, body {i}");
                assert_close(found.0, base[i].0, 1e-12, &what);
                assert_close(found.1, base[i].1, 1e-12, &what);
            }
        }
    }
}

/// 1 km/s more for everything: 1e-12 of the way.
#[test]
fn a_moving_world_ends_the_same_way() {
    let wind = DVec3::new(1000.0, 0.0, 0.0);
    for (name, bodies) in scenes() {
        let base = all_ends(&bodies, 3);
        let moving: Vec<Body> = bodies
            .iter()
            .map(|body| Body {
                velocity: body.velocity + wind,
                ..body.clone()
            })
            .collect();
        let way = wind * STEPS as f64 * DT;
        let found = all_ends(&moving, 3);
        for (i, (&(x, v), found)) in base.iter().zip(found).enumerate() {
            let what = format!("{name}, body {i}");
            assert_close(found.0 - way, x, 1e-12 * way.x, &what);
            assert_close(found.1 - wind, v, 1e-12 * way.x, &what);
        }
    }
}

#[test]
fn a_reversed_world_goes_back_to_its_start() {
    for (name, bodies) in scenes() {
        let mut world = world(DT, &bodies);
        let impacts = run(&mut world, STEPS);
        for i in 0..world.len() {
            world
                .set_velocity(i, -world.velocity(i))
                .expect("a velocity");
        }
        let back = run(&mut world, STEPS);
        assert_eq!(back.len(), impacts.len(), "{name}: {impacts:?} {back:?}");
        for (i, body) in bodies.iter().enumerate() {
            let what = format!("{name}, body {i}");
            assert_close(world.position(i), body.position, 1e-9, &what);
            assert_close(world.velocity(i), -body.velocity, 1e-9, &what);
        }
    }
}

#[test]
fn the_length_of_a_step_changes_nothing() {
    for (name, bodies) in scenes() {
        let ends: Vec<(f64, Ends, Vec<Impact>)> = [1, 2, 10, 60, 1_000, 10_000]
            .into_iter()
            .map(|steps| {
                let dt = 1.0 / steps as f64;
                let mut world = world(dt, &bodies);
                let impacts = run(&mut world, steps);
                (dt, ends(&world), impacts)
            })
            .collect();
        let (_, base, impacts) = &ends[0];
        assert!(impacts.len() >= 2, "{name}");
        for (dt, end, others) in &ends[1..] {
            let what = format!("{name}, dt {dt}");
            let pairs = |impacts: &[Impact]| impacts.iter().map(|i| i.bodies).collect::<Vec<_>>();
            assert_eq!(
                pairs(impacts),
                pairs(others),
                "{what}: {impacts:?} {others:?}"
            );
            for (a, b) in impacts.iter().zip(others) {
                assert!((a.time - b.time).abs() <= 1e-12, "{what}: {a:?} {b:?}");
            }
            for (i, (a, b)) in base.iter().zip(end).enumerate() {
                assert_close(b.0, a.0, 1e-12, &format!("{what}, body {i}"));
                assert_close(b.1, a.1, 1e-12, &format!("{what}, body {i}"));
            }
        }
    }
}

/// Twice, in several threads at once, and going on from a copy.
#[test]
fn runs_of_the_same_world_have_the_same_bits() {
    let cow = builtin("cow.obj");
    let mut cows = meshes();
    cows.push(mesh_body(
        &cow,
        DVec3::new(0.0, 4.0, 0.0),
        DVec3::new(0.1, -3.0, 0.2),
    ));
    for bodies in [balls(), meshes(), cows] {
        let run_all = || {
            let mut world = world(DT, &bodies);
            let impacts = run(&mut world, STEPS);
            (bits(&world), impacts)
        };
        let first = run_all();
        assert!(!first.1.is_empty());
        assert_eq!(run_all(), first);
        std::thread::scope(|scope| {
            let threads: Vec<_> = (0..4).map(|_| scope.spawn(run_all)).collect();
            for thread in threads {
                assert_eq!(thread.join().expect("it ends"), first);
            }
        });
        let mut half = world(DT, &bodies);
        run(&mut half, STEPS / 2);
        let mut copy = half.clone();
        run(&mut half, STEPS / 2);
        run(&mut copy, STEPS / 2);
        assert_eq!(bits(&copy), first.0);
        assert_eq!(bits(&half), first.0);
    }
}
