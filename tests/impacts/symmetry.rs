//! Worlds that must end in equivalent states at other sizes, on other axes and in any order, in addition to the cases
//! of
//! `cases::hard_cases::symmetry`.

use std::sync::Arc;

use cases::hard_cases::symmetry::{DT, STEPS, scenes};
use kit::bodies::mesh_body;
use kit::meshes::builtin;
use sim_core::{Body, DVec3, Mesh, Shape, Vec3, World};

use crate::worlds::{assert_close, bits, run, world};

/// The shape with mapped points and lengths.
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
        // The normal may have any length, so it can be mapped as a point.
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
    for ((name, bodies), largest) in scenes().into_iter().zip([200, 60, 60]) {
        let base = all_ends(&bodies, 2);
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
            let found = all_ends(&scaled, 2);
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
        let base = all_ends(&bodies, 2);
        for (k, mirror) in mirrors.into_iter().enumerate() {
            let found = all_ends(&mapped(&bodies, mirror, true), 2);
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

/// The rounding of sums of three products depends on the order of the axes, so results may differ by 1e-12.
#[test]
fn other_axes_change_nothing_but_rounding() {
    let permutations: [(Map, bool); 3] = [
        (|v| DVec3::new(v.y, v.z, v.x), false),
        (|v| DVec3::new(v.y, v.x, v.z), true),
        (|v| DVec3::new(v.z, v.y, v.x), true),
    ];
    for (name, bodies) in scenes() {
        let base = all_ends(&bodies, 2);
        for (map, is_mirror) in permutations {
            let found = all_ends(&mapped(&bodies, map, is_mirror), 2);
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
        let base = all_ends(&bodies, 2);
        for shift in 1..n {
            let order: Vec<usize> = (0..n).map(|i| (n + shift - i) % n).collect();
            let reordered: Vec<Body> = order.iter().map(|&i| bodies[i].clone()).collect();
            let found = all_ends(&reordered, 2);
            for (&i, found) in order.iter().zip(found) {
                let what = format!("{name}, order {order:?}, body {i}");
                assert_close(found.0, base[i].0, 1e-12, &what);
                assert_close(found.1, base[i].1, 1e-12, &what);
            }
        }
    }
}

/// Twice, in several threads at once, and continued from a copy.
#[test]
fn runs_of_the_same_world_have_the_same_bits() {
    let [balls, cows, stars] = scenes().map(|(_, bodies)| bodies);
    let mut both = stars.clone();
    both.push(mesh_body(
        &builtin("cow.obj"),
        DVec3::new(0.0, 4.0, 0.0),
        DVec3::new(0.1, -3.0, 0.2),
    ));
    for bodies in [balls, cows, stars, both] {
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
