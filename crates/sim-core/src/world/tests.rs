use alloc::{format, string::ToString, sync::Arc, vec::Vec};
use glam::DVec3;

use super::{Collision, Phase, Profile, Settings, StepError, World, WorldError};
use crate::{
    Body, BodyKind, Force, METHODS, Mesh, Shape,
    test_meshes::{cube, sphere},
};

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn body(mesh: &Arc<Mesh>, mass: f64, position: DVec3, velocity: DVec3) -> Body {
    Body {
        shape: Some(mesh.clone().into()),
        mass,
        position,
        velocity,
        ..Body::default()
    }
}

/// A world in the discrete mode of the course.
fn world(bodies: impl IntoIterator<Item = Body>) -> World {
    let settings = Settings {
        collision: Collision::Bvh,
        ..Settings::default()
    };
    let mut world = World::new(settings).unwrap();
    for body in bodies {
        world.add(body).unwrap();
    }
    world
}

fn run(world: &mut World, steps: u32) {
    for _ in 0..steps {
        world.step().unwrap();
    }
}

/// Checks the invariant between steps: no two bodies meet.
fn assert_apart(world: &mut World) {
    for j in 0..world.len() {
        for i in 0..j {
            assert!(
                !world.meeting().contains(&(i, j)),
                "{i} and {j} meet after step {}",
                world.steps()
            );
        }
    }
}

#[test]
fn a_cube_face_on_bounces_straight_back() {
    let cube = Arc::new(cube());
    for (y, z) in [(0.0, 0.0), (0.25, 0.0), (0.3, -0.7), (1e-9, 0.5)] {
        for (m1, m2) in [(1.0, 1.0), (1.0, 3.0), (5.0, 0.2), (1.0, 1e9)] {
            let mut world = world([
                body(&cube, m1, v(-2.0, y, z), v(3.0, 0.0, 0.0)),
                body(&cube, m2, v(2.0, 0.0, 0.0), v(-1.0, 0.0, 0.0)),
            ]);
            run(&mut world, 90);
            assert_eq!(world.impacts(), 1);
            assert_eq!(world.last_impact().unwrap().normal, DVec3::X);
            let exact1 = ((m1 - m2) * 3.0 - 2.0 * m2) / (m1 + m2);
            let exact2 = (2.0 * m1 * 3.0 - (m2 - m1)) / (m1 + m2);
            assert!((world.velocity(0).x - exact1).abs() < 1e-12);
            assert!((world.velocity(1).x - exact2).abs() < 1e-12);
            assert_eq!((world.velocity(0).y, world.velocity(0).z), (0.0, 0.0));
            assert_eq!((world.velocity(1).y, world.velocity(1).z), (0.0, 0.0));
        }
    }
}

#[test]
fn the_first_contact_is_placed_in_space_and_time() {
    let cube = Arc::new(cube());
    let mut world = world([
        body(&cube, 1.0, v(-2.0, 0.0, 0.0), v(3.0, 0.0, 0.0)),
        body(&cube, 1.0, v(2.0, 0.25, 0.0), v(-1.0, 0.0, 0.0)),
    ]);
    run(&mut world, 60);
    let impact = world.last_impact().unwrap();
    assert_eq!(impact.bodies, (0, 1));
    assert!((impact.time - 0.75).abs() < 1e-12, "{impact:?}");
    assert!((impact.point.x - 0.75).abs() < 1e-12);
    assert!((impact.impulse - 4.0).abs() < 1e-12);
    // 45 steps of 1/60 s end on the contact; touching is a hit.
    assert!(impact.step == 45 || impact.step == 46);
}

#[test]
fn after_a_hit_both_are_where_the_step_began_to_the_bit() {
    let cube = Arc::new(cube());
    let mut world = world([
        body(&cube, 1.0, v(-1.3, 0.1, 0.0), v(3.0, 0.2, 0.0)),
        body(&cube, 2.0, v(1.1, 0.0, 0.3), v(-1.0, 0.0, 0.1)),
    ]);
    loop {
        let before = (world.position(0), world.position(1));
        world.step().unwrap();
        assert_apart(&mut world);
        if world.impacts() > 0 {
            assert_eq!((world.position(0), world.position(1)), before);
            break;
        }
        assert!(world.steps() < 100);
    }
}

#[test]
fn spheres_and_cubes_keep_momentum_and_energy_and_stay_apart() {
    let (cube, ball) = (Arc::new(cube()), Arc::new(sphere(10)));
    let ring = (0..8).map(|i| {
        let angle = f64::from(i) * core::f64::consts::FRAC_PI_4;
        let out = v(
            libm::cos(angle),
            libm::sin(angle),
            0.1 * libm::sin(3.0 * angle),
        );
        let mesh = if i % 2 == 0 { &cube } else { &ball };
        body(
            mesh,
            1.0 + f64::from(i),
            4.0 * out,
            -(1.0 + 0.2 * f64::from(i)) * out,
        )
    });
    let mut world = world(ring);
    let (energy, momentum) = (world.kinetic_energy(), world.momentum());
    for _ in 0..600 {
        world.step().unwrap();
        assert_apart(&mut world);
    }
    assert!(world.impacts() >= 8, "{}", world.impacts());
    assert!((world.kinetic_energy() / energy - 1.0).abs() < 1e-13);
    assert!((world.momentum() - momentum).length() < 1e-12);
}

#[test]
fn a_body_put_back_into_a_third_ones_way_pushes_it_back_too() {
    // The second cube stops the first; the third follows the first so closely that it enters the
    // place to which the first goes back.
    let cube = Arc::new(cube());
    let fast = v(30.0, 0.0, 0.0);
    let mut world = world([
        body(&cube, 1.0, v(0.0, 0.0, 0.0), fast),
        body(&cube, 1.0, v(1.25, 0.0, 0.0), DVec3::ZERO),
        body(&cube, 1.0, v(-1.25, 0.0, 0.0), fast),
    ]);
    let energy = world.kinetic_energy();
    for _ in 0..30 {
        world.step().unwrap();
        assert_apart(&mut world);
    }
    assert_eq!(world.velocity(2), DVec3::ZERO);
    assert_eq!((world.velocity(0), world.velocity(1)), (fast, fast));
    assert_eq!(world.kinetic_energy(), energy);
}

#[test]
fn naive_and_bvh_worlds_are_the_same_to_the_bit() {
    let (cube, ball) = (Arc::new(cube()), Arc::new(sphere(8)));
    let run_with = |collision| {
        let settings = Settings {
            collision,
            ..Settings::default()
        };
        let mut world = World::new(settings).unwrap();
        world
            .add(body(&ball, 1.0, v(-3.0, 0.2, 0.1), v(5.0, 0.0, 0.0)))
            .unwrap();
        world
            .add(body(&cube, 2.0, v(0.0, 0.0, 0.0), v(0.0, 0.1, 0.0)))
            .unwrap();
        world
            .add(body(&ball, 3.0, v(3.0, -0.3, 0.0), v(-4.0, 0.0, 0.3)))
            .unwrap();
        run(&mut world, 120);
        let state: Vec<_> = (0..3)
            .map(|i| (world.position(i), world.velocity(i)))
            .collect();
        (state, world.impacts())
    };
    let naive = run_with(Collision::Naive);
    assert!(naive.1 > 1);
    assert_eq!(naive, run_with(Collision::Bvh));
}

#[test]
fn pairs_that_begin_in_overlap_are_told_and_only_part() {
    let cube = Arc::new(cube());
    for approach in [1.0, 0.0, -1.0] {
        let mut world = world([
            body(&cube, 1.0, v(0.0, 0.0, 0.0), v(approach, 0.0, 0.0)),
            body(&cube, 2.0, v(0.9, 0.05, 0.0), v(-approach, 0.0, 0.0)),
        ]);
        assert_eq!(world.overlapping(), [(0, 1)]);
        let energy = world.kinetic_energy();
        let gap = |w: &World| w.position(1).x - w.position(0).x;
        for _ in 0..120 {
            let before = gap(&world);
            world.step().unwrap();
            // A body that is inside after one step is detected at the end of this step.
            assert!(gap(&world) >= before - 2.0 / 60.0 - 1e-12);
            assert!(world.kinetic_energy() <= energy * (1.0 + 4.0 * f64::EPSILON));
        }
        if approach == 0.0 {
            assert_eq!(
                (world.position(0), world.overlapping()),
                (DVec3::ZERO, &[(0, 1)][..])
            );
        } else {
            assert!(gap(&world) > 1.0 && world.overlapping().is_empty());
        }
    }
}

#[test]
fn a_placed_body_is_looked_at_afresh() {
    let cube = Arc::new(cube());
    let mut world = world([
        body(&cube, 1.0, v(0.0, 0.0, 0.0), DVec3::ZERO),
        body(&cube, 1.0, v(5.0, 0.0, 0.0), DVec3::ZERO),
    ]);
    world.set_position(1, v(0.5, 0.0, 0.0)).unwrap();
    assert_eq!(world.overlapping(), [(0, 1)]);
    world.set_position(0, v(-5.0, 0.0, 0.0)).unwrap();
    assert!(world.overlapping().is_empty());
    assert_eq!(world.interpolated(0, 0.5), v(-5.0, 0.0, 0.0));
}

#[test]
fn an_impact_says_where_its_bodies_were() {
    let ball = |x: f64, speed: f64, kind: BodyKind| Body {
        kind,
        position: v(x, 0.1, 0.0),
        velocity: v(speed, 0.0, 0.0),
        shape: Some(Shape::Sphere { radius: 0.5 }),
        ..Body::default()
    };
    for collision in [Collision::Continuous, Collision::Bvh, Collision::Naive] {
        // Also against a moving wall that is not movable.
        for kind in [BodyKind::Dynamic, BodyKind::Kinematic] {
            let mut world = world([ball(0.0, 20.0, BodyKind::Dynamic), ball(1.2, -10.0, kind)]);
            let settings = Settings {
                collision,
                ..*world.settings()
            };
            world.set_settings(settings).unwrap();
            let mut impacts = Vec::new();
            world.step_reporting(&mut impacts).unwrap();
            let [impact] = &impacts[..] else {
                panic!("{collision:?}: {impacts:?}");
            };
            let (first, second) = impact.positions;
            let apart = first.distance(second);
            assert!((apart - 1.0).abs() < 1e-9, "{collision:?}: {apart}");
            assert!((first.x - 20.0 * impact.time).abs() < 1e-9);
            assert!((impact.point.x - first.x - 0.5).abs() < 1e-9);
        }
    }
}

/// A clock that advances by one each time it is read.
fn ticks() -> u64 {
    use core::sync::atomic::{AtomicU64, Ordering};
    static TICKS: AtomicU64 = AtomicU64::new(0);
    TICKS.fetch_add(1, Ordering::Relaxed)
}

#[test]
fn a_profile_tells_the_phases_and_changes_no_bit() {
    let cubes = [Arc::new(cube()), Arc::new(cube())];
    for collision in [Collision::Continuous, Collision::Bvh] {
        let bodies = cubes.iter().zip([1.0, -1.0]);
        let mut plain = world(bodies.map(|(mesh, side)| {
            let velocity = v(-6.0 * side, 0.0, 0.0);
            body(mesh, 1.0, v(0.6 * side, 0.0, 0.0), velocity)
        }));
        let settings = Settings {
            collision,
            ..*plain.settings()
        };
        plain.set_settings(settings).unwrap();
        let mut profiled = plain.clone();
        let (mut impacts, mut profile) = (Vec::new(), Profile::default());
        for _ in 0..4 {
            plain.step().unwrap();
            profiled
                .step_profiled(&mut impacts, ticks, &mut profile)
                .unwrap();
        }
        assert_eq!(plain.state_hash(), profiled.state_hash());
        assert_eq!(impacts.len(), 1);
        for phase in [Phase::Integrate, Phase::Narrow, Phase::Respond] {
            assert!(profile.spent(phase) > 0, "{collision:?}: {phase:?}");
        }
    }
}

#[test]
fn time_is_steps_times_dt_also_after_a_change_of_dt() {
    let mut world = world([]);
    run(&mut world, 600);
    assert_eq!(world.time(), 600.0 * (1.0 / 60.0));
    let slower = Settings {
        dt: 0.25,
        ..*world.settings()
    };
    for _ in 0..4 {
        // Setting a value to itself does not round it.
        world.set_settings(slower).unwrap();
        run(&mut world, 1);
    }
    assert!((world.time() - 11.0).abs() < 1e-14);
    assert_eq!(world.steps(), 604);
}

#[test]
fn values_out_of_range_are_refused_by_field_and_disturb_nothing() {
    let mut world = world([Body::default()]);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        let at = v(0.0, bad, 0.0);
        let fields = [
            ("position", world.set_position(0, at)),
            ("velocity", world.set_velocity(0, at)),
            ("force", world.set_force(0, at)),
        ];
        for (name, outcome) in fields {
            let WorldError::Vector { body: 0, field, .. } = outcome.unwrap_err() else {
                panic!("{name} {bad}");
            };
            assert_eq!(field, name);
        }
        let added = world.add(Body {
            velocity: at,
            ..Body::default()
        });
        assert!(
            added
                .unwrap_err()
                .to_string()
                .contains("velocity of body 1")
        );
    }
    for bad in [0.0, -1.0, -0.0, f64::NAN, f64::INFINITY, 1e-200] {
        assert!(world.clone().set_mass(0, bad).is_err(), "{bad}");
        let settings = Settings {
            dt: bad,
            ..Settings::default()
        };
        assert!(world.set_settings(settings).is_err() && World::new(settings).is_err());
    }
    run(&mut world, 1);
    assert_eq!(
        (world.len(), world.mass(0), world.position(0)),
        (1, 1.0, DVec3::ZERO)
    );
}

#[test]
fn friction_is_kept_for_each_body_once_one_is_rough() {
    let mut world = world([Body::default(), Body::default()]);
    assert!(!world.bodies.is_rough());
    assert_eq!((world.friction(0), world.friction(1)), (0.0, 0.0));
    world.set_friction(0, 0.3).unwrap();
    let rough = Body {
        friction: f64::INFINITY,
        ..Body::default()
    };
    assert_eq!(world.add(rough), Ok(2));
    assert_eq!(world.add(Body::default()), Ok(3));
    let known = |world: &World| [0, 1, 2, 3].map(|body| world.friction(body));
    assert_eq!(known(&world), [0.3, 0.0, f64::INFINITY, 0.0]);
    for bad in [-1.0, -f64::MIN_POSITIVE, f64::NEG_INFINITY, f64::NAN] {
        let refused = [
            world.set_friction(1, bad).unwrap_err(),
            world
                .add(Body {
                    friction: bad,
                    ..Body::default()
                })
                .unwrap_err(),
        ];
        for (error, index) in refused.into_iter().zip([1, 4]) {
            let text = error.to_string();
            let expected = format!("friction of body {index} is {bad}: it must be between 0");
            assert!(text.starts_with(&expected), "{text}");
        }
    }
    let nobody = WorldError::NoBody { body: 4, bodies: 4 };
    assert_eq!(world.set_friction(4, 0.5), Err(nobody));
    assert_eq!(known(&world), [0.3, 0.0, f64::INFINITY, 0.0]);
    world.set_friction(0, 0.0).unwrap();
    assert_eq!(world.friction(0), 0.0);
}

#[test]
fn two_bodies_have_the_geometric_mean_of_their_friction() {
    let endless = f64::INFINITY;
    for (first, second, expected) in [
        (0.0, 0.0, 0.0),
        (0.3, 0.3, 0.3),
        (0.7, 0.7, 0.7),
        (0.25, 4.0, 1.0),
        (0.5, 0.0, 0.0),
        (0.5, endless, endless),
        (endless, endless, endless),
        (0.0, endless, 0.0),
    ] {
        let of = |friction| Body {
            friction,
            ..Body::default()
        };
        let world = world([of(first), of(second)]);
        for (i, j) in [(0, 1), (1, 0)] {
            assert_eq!(
                world.bodies.pair_friction(i, j),
                expected,
                "{first} and {second}"
            );
        }
    }
}

#[test]
fn motion_beyond_numbers_names_the_body_and_leaves_the_world_as_it_was() {
    for method in METHODS {
        let settings = Settings {
            dt: 1e90,
            method,
            ..Settings::default()
        };
        let mut world = World::new(settings).unwrap();
        world.add(Body::default()).unwrap();
        let wild = Body {
            force: v(1e100, 0.0, 0.0),
            mass: 1e-100,
            ..Body::default()
        };
        world.add(wild).unwrap();
        let error = (0..10).find_map(|_| world.step().err()).unwrap();
        let StepError::OutOfRange { body, step, .. } = error else {
            panic!("{}: {error}", method.name);
        };
        assert_eq!((body, step), (1, world.steps() + 1), "{}", method.name);
        assert!(world.position(1).is_finite() && world.previous_position(1).is_finite());
    }
}

/// A crowd of balls and cubes that fall into a pen.
#[cfg(feature = "rayon")]
fn crowd() -> World {
    let cube = Arc::new(cube());
    let mut world = World::new(Settings::default()).unwrap();
    for normal in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::Z, DVec3::NEG_Z] {
        let wall = Body {
            shape: Some(crate::Shape::HalfSpace { normal }),
            position: -10.0 * normal,
            kind: BodyKind::Static,
            ..Body::default()
        };
        world.add(wall).unwrap();
    }
    for i in 0..216 {
        let (x, y, z) = (i % 6, i / 6 % 6, i / 36);
        let place = v(f64::from(x), f64::from(y), f64::from(z)) * 1.5 - 4.0;
        let drift = v(
            f64::from(i % 7) - 3.0,
            f64::from(i % 5) - 2.0,
            f64::from(i % 3) - 1.0,
        );
        let mut one = body(&cube, 1.0 + f64::from(i % 4), place, 2.0 * drift);
        if i % 2 == 0 {
            one.shape = Some(crate::Shape::Sphere { radius: 0.5 });
        }
        one.restitution = 0.8;
        world.add(one).unwrap();
    }
    let weight = crate::Force::Gravity {
        acceleration: v(0.0, -9.81, 0.0),
    };
    world.add_force(weight).unwrap();
    world
}

#[cfg(feature = "rayon")]
#[test]
fn the_number_of_threads_changes_no_bit() {
    let ran = [1, 2, 3, 8].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut world = crowd();
            run(&mut world, 60);
            let state: Vec<_> = (0..world.len())
                .map(|i| (world.position(i), world.velocity(i)))
                .collect();
            (world.impacts(), state)
        })
    });
    assert!(ran[0].0 > 100, "{}", ran[0].0);
    assert!(ran.iter().all(|other| *other == ran[0]));
}

#[test]
fn the_applied_force_is_what_the_motion_shows() {
    let mut world = World::new(Settings {
        dt: 1e-6,
        ..Settings::default()
    })
    .expect("sound settings");
    let kinds = [BodyKind::Dynamic, BodyKind::Dynamic, BodyKind::Kinematic];
    for (n, (mass, kind)) in [2.0, 3.0, 1.0].into_iter().zip(kinds).enumerate() {
        let n = n as f64;
        let body = Body {
            mass,
            position: DVec3::new(3.0 * n, n * n, -n),
            velocity: DVec3::new(1.0, -n, 0.5),
            kind,
            force: if kind.is_movable() {
                DVec3::Y
            } else {
                DVec3::ZERO
            },
            ..Body::default()
        };
        world.add(body).expect("a sound body");
    }
    let spring = Force::Spring {
        bodies: [0, 1],
        points: None,
        rest_length: 1.0,
        stiffness: 5.0,
        damping: 0.3,
    };
    let forces = [
        Force::Gravity {
            acceleration: DVec3::new(0.0, -9.81, 0.0),
        },
        Force::QuadraticDrag {
            body: None,
            coefficient: 0.2,
        },
        Force::LinearDrag {
            body: Some(1),
            coefficient: 0.4,
        },
        Force::Gravitation { constant: 2.0 },
        spring,
    ];
    for force in forces {
        world.add_force(force).expect("a sound force");
    }
    let applied: Vec<DVec3> = (0..3).map(|i| world.applied_force(i)).collect();
    let before: Vec<DVec3> = (0..3).map(|i| world.velocity(i)).collect();
    world.step().expect("a step");
    for i in 0..2 {
        let change = (world.velocity(i) - before[i]) / world.settings().dt;
        let shown = world.mass(i) * change;
        assert!(
            (applied[i] - shown).length() < 1e-3 * shown.length(),
            "{i}: {} {shown}",
            applied[i]
        );
    }
    assert_eq!(applied[2], DVec3::ZERO);
}
