//! A body that just touches a floor made of several bodies, in addition to the case of grazing; and trajectories that
//! dip into another body and out again within a step.

use kit::bodies::{body, mesh_body};
use kit::meshes::{builtin, cube, mesh};
use kit::random::Random;
use kit::worlds::{GRAVITY, add_gravity, precise, world_of};
use sim_core::{Body, BodyKind, DVec3, Force, Method, Settings, Shape, Vec3};

use crate::worlds::{DT, run, world};

/// A cube slides along a floor of four cubes, slightly above it, and is not stopped at their joints.
#[test]
fn joints_of_a_floor_stop_nothing() {
    let tile = cube(0.5);
    for height in [1.0 + 1e-12, 1.0 + 1e-9] {
        let mut bodies: Vec<Body> = (0..4)
            .map(|i| Body {
                kind: BodyKind::Static,
                ..mesh_body(&tile, DVec3::X * f64::from(i), DVec3::ZERO)
            })
            .collect();
        let velocity = DVec3::new(2.0, 0.0, 0.5);
        bodies.push(mesh_body(&tile, DVec3::new(-2.0, height, -0.25), velocity));
        let mut world = world(DT, &bodies);
        assert!(run(&mut world, 200).is_empty(), "height {height}");
        assert_eq!(world.velocity(4), velocity);
    }
}

/// Bodies that fall freely beside a wall, at a distance of rounding size, meet nothing, and are not too much work.
#[test]
fn what_falls_beside_a_wall_falls_freely() {
    let forms = [
        Shape::Mesh(cube(0.5)),
        Shape::Sphere { radius: 0.5 },
        Shape::Mesh(builtin("cow.obj")),
    ];
    let wall = Body {
        kind: BodyKind::Static,
        ..mesh_body(&cube(20.0), DVec3::new(20.0, 0.0, 0.0), DVec3::ZERO)
    };
    for form in forms {
        let widest = match &form {
            Shape::Mesh(mesh) => f64::from(mesh.bounds().max.x),
            _ => 0.5,
        };
        for ulps in [0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 1024] {
            let gap = f64::from(ulps) * f64::EPSILON;
            let start = DVec3::new(-widest - gap, 0.1, 0.2);
            let beside = body(&form, start, DVec3::new(0.0, 1.0, 0.3));
            let mut world = world_of(precise(0.1), [wall.clone(), beside]);
            add_gravity(&mut world, -GRAVITY * DVec3::Y);
            let impacts = run(&mut world, 3);
            assert_eq!(impacts.len(), 0, "{ulps} ulps");
            let fallen = 0.3 - 0.5 * GRAVITY * 0.09;
            let at = start + DVec3::new(0.0, fallen, 0.09);
            // Contacts keep their gap.
            let (off, gap) = (world.position(1) - at, DVec3::new(1e-11, 1e-14, 1e-14));
            assert!(off.abs().cmple(gap).all(), "{ulps} ulps: off by {off}");
        }
    }
}

/// A tip at the origin that points down.
fn tip() -> Shape {
    let vertices = vec![
        Vec3::ZERO,
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::new(-1.0, 1.0, 1.0),
        Vec3::new(-1.0, 1.0, -1.0),
    ];
    let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    Shape::Mesh(mesh(vertices, triangles))
}

/// A thrown body touches a tip for some milliseconds around its highest position, a micrometre deep or less, in a step
/// of a tenth of a second. Each impact is found, at its time.
#[test]
fn what_dips_into_a_tip_within_a_step_hits_it() {
    let mut random = Random::splitmix(7);
    let forms = [Shape::Mesh(cube(0.5)), Shape::Sphere { radius: 0.5 }];
    for case in 0..200_u32 {
        let form = &forms[case as usize % 2];
        let depth = 10_f64.powf(random.from(-10.0, -4.0));
        // The time of the highest position, from the start of the only step.
        let (dt, highest) = (0.1, random.from(0.02, 0.08));
        let sideways = match form {
            Shape::Sphere { .. } => DVec3::ZERO,
            _ => DVec3::new(0.3, 0.0, -0.2),
        };
        let up = GRAVITY * highest;
        let below = 0.5 + 0.5 * up * highest - depth;
        let start = DVec3::new(0.0, -below, 0.0) - highest * sideways;
        let tip = Body {
            kind: BodyKind::Static,
            ..body(&tip(), DVec3::ZERO, DVec3::ZERO)
        };
        let thrown = body(form, start, sideways + up * DVec3::Y);
        for bodies in [[tip.clone(), thrown.clone()], [thrown, tip]] {
            let mut world = world_of(precise(dt), bodies);
            add_gravity(&mut world, -GRAVITY * DVec3::Y);
            let impacts = run(&mut world, 1);
            let [impact] = &impacts[..] else {
                panic!("{case}: {} impacts at a depth of {depth:e}", impacts.len());
            };
            let time = highest - (2.0 * depth / GRAVITY).sqrt();
            // Some rounding errors of the height, and the gap between a sphere and a mesh, change the time by this.
            let rounding = 1e-13 / (2.0 * depth * GRAVITY).sqrt() + 1e-14;
            let late = impact.time - time;
            assert!(late.abs() < rounding, "{case}: {late:e} at {depth:e}");
        }
    }
}

/// A cube on its way up first turns back from a fin beside it, at a distance of 1e-15 m, which is none to certificates,
/// and then dips into the tip above it.
#[test]
fn what_passes_a_fin_and_dips_into_a_tip_hits_the_tip() {
    let Shape::Mesh(one) = tip() else {
        unreachable!("the tip is a mesh");
    };
    let fin = [[0.5, -0.5, 0.0], [1.5, -0.5, 0.2], [1.5, -0.5, -0.2]];
    let vertices = one.vertices().iter().copied();
    let vertices = vertices.chain(fin.map(Vec3::from));
    let triangles = one.triangles().iter().copied().chain([[4, 5, 6]]);
    let both = mesh(vertices.collect(), triangles.collect());
    let mut random = Random::splitmix(9);
    for case in 0..50_u32 {
        let depth = 10_f64.powf(random.from(-9.0, -5.0));
        let highest = random.from(0.055, 0.08);
        let (up, nearest) = (GRAVITY * highest, 0.02);
        let aside = GRAVITY * nearest;
        let below = 0.5 + 0.5 * up * highest - depth;
        let start = DVec3::new(-1e-15 - 0.5 * aside * nearest, -below, 0.0);
        let fixed = Body {
            kind: BodyKind::Static,
            ..mesh_body(&both, DVec3::ZERO, DVec3::ZERO)
        };
        let thrown = mesh_body(&cube(0.5), start, DVec3::new(aside, up, 0.0));
        let mut world = world_of(precise(0.1), [fixed, thrown]);
        add_gravity(&mut world, -GRAVITY * DVec3::new(1.0, 1.0, 0.0));
        let impacts = run(&mut world, 1);
        assert_eq!(impacts.len(), 1, "{case}: at a depth of {depth:e}");
        let late = impacts[0].time - (highest - (2.0 * depth / GRAVITY).sqrt());
        let rounding = 1e-13 / (2.0 * depth * GRAVITY).sqrt() + 1e-14;
        assert!(late.abs() < rounding, "{case}: {late:e} at {depth:e}");
    }
}

/// The same for a varying force: a cube on a spring that reverses at the tip.
#[test]
fn what_a_spring_swings_into_a_tip_hits_it() {
    let mut random = Random::splitmix(8);
    for case in 0..20_u32 {
        let depth = 10_f64.powf(random.from(-8.0, -4.0));
        let (dt, highest) = (0.1, random.from(0.03, 0.07));
        // It oscillates with an amplitude of 1 m about a point 1.5 m below the tip, at 3 rad/s.
        let (rate, middle) = (3.0, -1.5 + depth);
        let phase: f64 = -rate * highest;
        let start = DVec3::new(0.0, middle + phase.cos(), 0.0);
        let velocity = DVec3::new(0.0, -rate * phase.sin(), 0.0);
        let tip = Body {
            kind: BodyKind::Static,
            ..body(&tip(), DVec3::ZERO, DVec3::ZERO)
        };
        let settings = Settings {
            method: Method::named("dop853").expect("a method"),
            ..precise(dt)
        };
        let mut world = world_of(settings, [tip, mesh_body(&cube(0.5), start, velocity)]);
        world
            .add_force(Force::Anchor {
                body: 1,
                point: None,
                anchor: DVec3::new(0.0, middle, 0.0),
                stiffness: rate * rate,
                damping: 0.0,
                rest_length: 0.0,
            })
            .expect("a spring");
        let impacts = run(&mut world, 1);
        assert_eq!(impacts.len(), 1, "{case}: at a depth of {depth:e}");
        let late = impacts[0].time - (highest - (1.0 - depth).acos() / rate);
        assert!(late.abs() < 1e-9, "{case}: {late:e} at {depth:e}");
    }
}
