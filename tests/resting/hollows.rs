//! Wedges, cones and funnels: what is put into them settles, and then costs nothing.

use sim_core::{Body, DQuat, DVec3, Shape, Vec3, World};
use std::sync::Arc;

use crate::meshes::{Random, fixed, mesh, turned};
use crate::scenes::{ball, cube, world};

/// A groove along z with walls of a slope, open at its ends, deep enough for what is put in.
fn wedge(slope: f32) -> Shape {
    let (wide, long) = (2.0, 4.0);
    let ring = |z: f32| {
        [
            Vec3::new(-wide, slope * wide, z),
            Vec3::new(0.0, 0.0, z),
            Vec3::new(wide, slope * wide, z),
        ]
    };
    let vertices = [ring(-long), ring(long)].concat();
    mesh(vertices, vec![[0, 3, 1], [1, 3, 4], [1, 4, 2], [2, 4, 5]])
}

fn funnel(sides: u32, rings: u32, slope: f64) -> Shape {
    let outline: Vec<[f64; 2]> = (0..=rings)
        .map(|k| {
            let radius = 2.0 * f64::from(k) / f64::from(rings);
            [radius, slope * radius]
        })
        .collect();
    turned(&outline, sides)
}

fn cow() -> Shape {
    let cow = scene::mesh_file::builtin("cow.obj").expect("built in");
    let size = cow.bounds().half_extent().max_element();
    let cow = cow.transformed(DQuat::IDENTITY, DVec3::splat(0.4 / size));
    Shape::Mesh(Arc::new(cow.expect("a cow")))
}

/// Steps until a body has come to rest, with the exact test at each; and then it stays, to the bit.
fn settle(world: &mut World, seconds: f64, comes_to_rest: bool) -> Result<f64, String> {
    let body = world.len() - 1;
    let steps = (seconds / world.settings().dt) as u32;
    let mut rest = None;
    for count in 0..steps {
        world.step().map_err(|error| error.to_string())?;
        let mut again = World::new(*world.settings()).expect("settings");
        for i in 0..world.len() {
            let copy = Body {
                shape: world.shape(i).cloned(),
                position: world.position(i),
                mass: world.mass(i),
                ..Body::default()
            };
            again.add(copy).expect("a body");
        }
        if !again.overlapping().is_empty() {
            return Err(format!("step {count}: overlap"));
        }
        if world.velocity(body) == DVec3::ZERO {
            rest = Some(world.time());
            break;
        }
    }
    let Some(rest) = rest else {
        return match comes_to_rest {
            true => Err(format!("moves at {:e} m/s", world.velocity(body).length())),
            false => Ok(seconds),
        };
    };
    let at = world.position(body);
    for _ in 0..100 {
        world.step().map_err(|error| error.to_string())?;
    }
    match world.position(body) == at {
        true => Ok(rest),
        false => Err("moves after it has rested".into()),
    }
}

fn put_into(hollow: &Shape, shape: &Shape, at: DVec3, restitution: f64, friction: f64) -> World {
    let mut world = world(sim_core::Method::named("rk4").expect("a method"));
    let hollow = Body {
        restitution,
        friction,
        ..fixed(hollow, DVec3::ZERO)
    };
    world.add(hollow).expect("a hollow");
    let body = Body {
        shape: Some(shape.clone()),
        position: at,
        restitution,
        friction,
        ..Body::default()
    };
    world.add(body).expect("a body");
    world
}

/// Across a groove what has no friction goes to and fro for ever if it gives everything back; else it
/// settles. Along the groove nothing stops it.
#[test]
fn bodies_settle_in_wedges_and_funnels() {
    let shapes = [("ball", ball(0.3)), ("cube", cube_of(0.5)), ("cow", cow())];
    let mut random = Random(3);
    let mut wrong = Vec::new();
    let mut count = 0;
    let hollows = [
        ("wedge", wedge(1.0)),
        ("steep wedge", wedge(2.0)),
        ("4", funnel(4, 1, 1.0)),
        ("7", funnel(7, 1, 0.7)),
        ("64", funnel(64, 4, 1.5)),
        ("1000", funnel(100, 5, 1.0)),
        ("20,000", funnel(200, 50, 1.0)),
    ];
    for (hollow_name, hollow) in &hollows {
        for (name, shape) in &shapes {
            for restitution in [0.0, 0.3, 0.5] {
                for friction in [0.0, 0.3] {
                    let at = DVec3::new(random.from(-0.3, 0.3), 3.2, random.from(-0.3, 0.3));
                    let mut world = put_into(hollow, shape, at, restitution, friction);
                    let settled = settle(&mut world, 20.0, true);
                    count += 1;
                    if let Err(what) = settled {
                        wrong.push(format!(
                            "{name} in {hollow_name}, e {restitution}, friction {friction}: {what}"
                        ));
                    }
                }
            }
        }
    }
    assert_eq!(count, 7 * 3 * 3 * 2);
    assert!(
        wrong.is_empty(),
        "{} wrong:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

fn cube_of(side: f64) -> Shape {
    crate::meshes::scaled(&cube(), DVec3::splat(side))
}
