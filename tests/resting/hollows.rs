//! Wedges, cones and funnels: bodies in them settle, and then cost nothing.

use kit::meshes::{self, builtin};
use kit::random::Random;
use kit::shapes::{ball, cube, mesh, scaled};
use sim_core::collide::{ball_meets, tree};
use sim_core::{Body, Bvh, DVec3, Shape, Vec3, World};

use crate::meshes::turned;
use crate::scenes::{fixed, rk4, world};

/// A groove along z with walls of a slope, open at its ends, deep enough for the bodies.
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

fn small_cow() -> Shape {
    let cow = builtin("cow.obj");
    let size = cow.bounds().half_extent().max_element();
    Shape::Mesh(meshes::scaled(&cow, DVec3::splat(0.4 / size)))
}

/// Steps until a body has come to rest, with the exact test at each step; then it stays at rest, bit for bit.
fn settle(world: &mut World, seconds: f64) -> Result<(), String> {
    let body = world.len() - 1;
    let hollow = Bvh::build(world.mesh(0).expect("a hollow"));
    let own = world.mesh(body).map(|mesh| Bvh::build(mesh));
    let radius = match world.shape(body) {
        Some(&Shape::Sphere { radius }) => radius,
        _ => 0.0,
    };
    let meets = |at: DVec3| match &own {
        Some(own) => tree::intersect(&hollow, own, at),
        None => ball_meets(&hollow, at, radius),
    };
    let steps = (seconds / world.settings().dt) as u32;
    let mut rest = None;
    let mut still = 0;
    for count in 0..steps {
        world.step().map_err(|error| error.to_string())?;
        if meets(world.position(body)) {
            return Err(format!("step {count}: overlap"));
        }
        still = match world.velocity(body) == DVec3::ZERO {
            true => still + 1,
            false => 0,
        };
        // A reversal of the motion is no rest.
        if still == 3 {
            rest = Some(count);
            break;
        }
    }
    if rest.is_none() {
        let speed = world.velocity(body).length();
        // A body held by friction may still be lifted to its gap.
        return match world.friction(body) > 0.0 && speed < 1e-10 {
            true => Ok(()),
            false => Err(format!("moves at {speed:e} m/s")),
        };
    }
    let at = world.position(body);
    for _ in 0..100 {
        world.step().map_err(|error| error.to_string())?;
    }
    match world.position(body) == at {
        true => Ok(()),
        false => Err("moves after it has rested".into()),
    }
}

fn put_into(hollow: &Shape, shape: &Shape, at: DVec3, restitution: f64, friction: f64) -> World {
    let mut world = world(rk4());
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

/// Across a groove a frictionless elastic body moves to and fro for ever; an inelastic one settles. Along the groove
/// nothing stops it.
#[test]
fn bodies_settle_in_wedges_and_funnels() {
    let shapes = [
        ("ball", ball(0.3)),
        ("cube", scaled(&cube(), DVec3::splat(0.5))),
        ("cow", small_cow()),
    ];
    let mut random = Random::splitmix(3);
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
                    let settled = settle(&mut world, 20.0);
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
