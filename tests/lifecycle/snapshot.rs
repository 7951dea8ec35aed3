//! A world that is written and read continues bit for bit.

use kit::bodies::{at, immovable, wall};
use kit::shapes::{ball, cube, cuboid};
use kit::worlds::{add_gravity, step, world};
use sim_core::{
    Body, BodyKind, BodyLaw, BodyMotion, Collision, DQuat, DVec3, Force, Groups, Law, METHODS,
    Mesh, Method, PairLaw, PairMotion, Settings, Turn, World,
};

use super::{gallery, world_of};

/// The step at which worlds are written, and the last step.
const WRITTEN: u64 = 37;
const LAST: u64 = 100;

fn through_text(world: &World) -> World {
    let text = serde_json::to_string(world).expect("a text");
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}"))
}

fn through_bytes(world: &World) -> World {
    let bytes = postcard::to_allocvec(world).expect("bytes");
    postcard::from_bytes(&bytes).expect("a world")
}

/// Every way to copy a world.
fn again(world: &World) -> [(&'static str, World); 3] {
    [
        ("a copy", world.clone()),
        ("from text", through_text(world)),
        ("from bytes", through_bytes(world)),
    ]
}

#[test]
fn every_scene_goes_on_to_the_bit_in_every_mode() {
    let mut scenes = 0;
    for (scene, mode) in gallery() {
        let mut world = world_of(&scene, mode);
        step(&mut world, WRITTEN);
        let mut others = again(&world);
        for number in WRITTEN..LAST {
            for (how, other) in &mut others {
                let what = || format!("{} {mode:?}, step {number}, {how}", scene.name);
                assert_eq!(other.state_hash(), world.state_hash(), "{}", what());
                assert_eq!(other.impacts(), world.impacts(), "{}", what());
                other.step().expect("a step");
            }
            world.step().expect("a step");
        }
        let contacts = |world: &World| world.contacts().collect::<Vec<_>>();
        for (how, other) in &others {
            assert_eq!(
                other.state_hash(),
                world.state_hash(),
                "{} {how}",
                scene.name
            );
            assert_eq!(contacts(other), contacts(&world), "{} {how}", scene.name);
            assert_eq!(other.last_impact(), world.last_impact());
            assert_eq!(other.bundled(), world.bundled());
            assert_eq!(other.contact_steps(), world.contact_steps());
        }
        scenes += 1;
    }
    assert!(scenes > 60, "{scenes}");
}

#[test]
fn heaps_go_on_to_the_bit_from_any_step() {
    for name in ["wall", "funnel", "dominoes", "stack"] {
        let scene = scene::Scene::load(name).expect("a gallery scene");
        let mut world = scene.world().expect("a world");
        let mut others: Vec<World> = Vec::new();
        for number in 0..60 {
            if number % 4 == 0 {
                others.push(through_bytes(&world));
            }
            world.step().expect("a step");
            for other in &mut others {
                other.step().expect("a step");
                assert_eq!(other.state_hash(), world.state_hash(), "{name} {number}");
            }
            // One of the copies is written and read again at every step.
            if let Some(other) = others.first_mut() {
                *other = through_bytes(other);
            }
        }
    }
}

/// A world with at least one of everything that a world can have.
pub(crate) fn motley() -> World {
    let floor = Body {
        kind: BodyKind::Static,
        friction: f64::INFINITY,
        ..wall(DVec3::new(0.3, 1.0, -0.1), -3.0 * DVec3::Y, DVec3::ZERO)
    };
    let cubes = (0..4).map(|i| Body {
        friction: 0.4,
        restitution: 0.25,
        user_data: u64::MAX - i,
        groups: Groups {
            member_of: 1 << i,
            ..Groups::ALL
        },
        ..at(&cube(), (1.2 * i as f64) * DVec3::Y)
    });
    let lift = Body {
        kind: BodyKind::Kinematic,
        velocity: 0.1 * DVec3::Y,
        mass: 3.0,
        ..at(&ball(0.7), 0.5 * DVec3::X)
    };
    let first = Body {
        position: 9.0 * DVec3::X,
        ..Body::default()
    };
    let turn = Turn {
        rotation: DQuat::from_rotation_x(0.4),
        spin: DVec3::new(0.3, 5.0, -2.0),
        torque: 0.1 * DVec3::Z,
        inertia: None,
    };
    let tumbling = Body {
        turn: Some(turn),
        ..at(&cuboid([0.2, 0.3, 0.4]), DVec3::new(1.5, 1.0, 1.5))
    };
    let rolling = Body {
        turn: Some(turn),
        ..at(&ball(0.3), DVec3::new(-1.5, 1.0, 1.5))
    };
    let turntable = Body {
        turn: Some(turn),
        ..immovable(at(&cuboid([0.5, 0.1, 0.5]), DVec3::new(1.5, 0.0, 1.5)))
    };
    let bodies = [first, floor].into_iter().chain(cubes);
    let mut world = world(bodies.chain([lift, tumbling, rolling, turntable]));
    add_gravity(&mut world, -9.81 * DVec3::Y);
    let forces = [
        Force::Gravitation { constant: 0.01 },
        Force::Spring {
            bodies: [2, 4],
            points: None,
            rest_length: 1.0,
            stiffness: 5.0,
            damping: 0.1,
        },
        Force::LinearDrag {
            body: Some(3),
            coefficient: 0.2,
        },
    ];
    for force in forces {
        world.add_force(force).expect("a force");
    }
    world.ignore_pair(2, 4).expect("a pair");
    step(&mut world, 40);
    world.remove(0).expect("it is there");
    world
        .add(at(&ball(0.4), world.position(3) + 0.1 * DVec3::X))
        .expect("a body in another one");
    world
}

#[test]
fn all_that_a_world_has_goes_on_and_handles_stay() {
    let mut world = motley();
    let handle = world.handle(4);
    for number in 0..60 {
        let mut others = again(&world);
        if number == 20 {
            // Removed from all copies alike.
            world.remove(2).expect("it is there");
            for (_, other) in &mut others {
                other.remove(2).expect("it is there");
            }
        }
        if number == 40 {
            world.set_kind(0, BodyKind::Kinematic).expect("a kind");
            for (_, other) in &mut others {
                other.set_kind(0, BodyKind::Kinematic).expect("a kind");
            }
        }
        world.step().expect("a step");
        for (how, mut other) in others {
            other.step().expect("a step");
            assert_eq!(other.state_hash(), world.state_hash(), "{number}: {how}");
            assert_eq!(other.index_of(handle), world.index_of(handle));
            assert!(other.bodies().eq(world.bodies()));
            assert_eq!(other.forces(), world.forces());
            assert!(other.ignored_pairs().eq(world.ignored_pairs()));
            assert_eq!(other.settings(), world.settings());
        }
    }
}

#[test]
fn how_bodies_turn_goes_on_to_the_bit_in_every_mode() {
    for collision in [Collision::Continuous, Collision::Bvh, Collision::Naive] {
        let mut world = motley();
        let settings = Settings {
            collision,
            ..*world.settings()
        };
        world.set_settings(settings).expect("settings");
        let tumbling = world.len() - 4;
        assert!(world.turns(tumbling));
        for number in 0..120 {
            let mut others = again(&world);
            world.step().expect("a step");
            for (how, other) in &mut others {
                other.step().expect("a step");
                let what = || format!("{collision:?}, step {number}, {how}");
                assert_eq!(other.state_hash(), world.state_hash(), "{}", what());
                for body in 0..world.len() {
                    assert_eq!(other.turn(body), world.turn(body), "{}", what());
                    assert_eq!(
                        other.interpolated_pose(body, 0.25),
                        world.interpolated_pose(body, 0.25)
                    );
                    let momentum = other.angular_momentum(body);
                    assert_eq!(momentum, world.angular_momentum(body));
                }
                assert_eq!(other.impacts(), world.impacts());
            }
        }
        // The turning bodies have collided.
        let turned = |body: usize| world.turns(body) && world.velocity(body) != DVec3::ZERO;
        assert!((0..world.len()).any(turned));
    }
}

#[test]
fn motion_that_grows_without_bound_fails_at_the_same_step() {
    let settings = Settings {
        method: Method::named("symplectic-euler").expect("a method"),
        dt: 0.1,
        ..Settings::default()
    };
    let mut world = World::new(settings).expect("settings");
    world
        .add(Body {
            position: DVec3::X,
            ..Body::default()
        })
        .expect("a body");
    let anchor = Force::Anchor {
        body: 0,
        point: None,
        anchor: DVec3::ZERO,
        rest_length: 0.0,
        stiffness: 500.0,
        damping: 0.0,
    };
    world.add_force(anchor).expect("a spring");
    step(&mut world, 4);
    let mut others = again(&world);
    let error = loop {
        if let Err(error) = world.step() {
            break error;
        }
    };
    for (how, other) in &mut others {
        let other = loop {
            if let Err(error) = other.step() {
                break error;
            }
        };
        assert_eq!(other, error, "{how}");
    }
}

#[test]
fn parts_are_written_and_read_alone() {
    let body = Body {
        shape: Some(cube()),
        friction: f64::INFINITY,
        position: DVec3::new(0.1, -0.0, 1e-300),
        user_data: u64::MAX,
        ..Body::default()
    };
    let text = serde_json::to_string(&body).expect("a text");
    let read: Body = serde_json::from_str(&text).expect("a body");
    assert_eq!(read, body);
    assert_eq!(read.position.y.to_bits(), (-0.0_f64).to_bits());
    // Absent fields have their defaults.
    let read: Body = serde_json::from_str(r#"{"kind": "Static"}"#).expect("a body");
    assert_eq!(read.kind, BodyKind::Static);
    for method in METHODS {
        let settings = Settings {
            method,
            ..Settings::default()
        };
        let text = serde_json::to_string(&settings).expect("a text");
        assert!(text.contains(method.name), "{text}");
        assert_eq!(
            serde_json::from_str::<Settings>(&text).expect("settings"),
            settings
        );
    }
    let mesh = r#"{"vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,3]]}"#;
    let error = serde_json::from_str::<Mesh>(mesh).expect_err("no vertex 3");
    assert!(error.to_string().contains('3'), "{error}");
}

#[derive(Debug)]
struct Wind;

impl BodyLaw for Wind {
    fn force(&self, _: &BodyMotion) -> DVec3 {
        DVec3::X
    }
}

impl PairLaw for Wind {
    fn force(&self, _: &PairMotion) -> DVec3 {
        DVec3::X
    }
}

#[test]
fn what_is_code_is_refused() {
    let mut world = world([Body::default(), Body::default()]);
    add_gravity(&mut world, DVec3::Y);
    let laws = [
        Force::Body {
            body: None,
            law: Law::new(Wind),
        },
        Force::Pair {
            bodies: None,
            law: Law::of_pair(Wind),
        },
    ];
    for law in laws {
        let index = world.add_force(law).expect("a force");
        let error = serde_json::to_string(&world).expect_err("it is code");
        assert_eq!(
            error.to_string(),
            "force 1 is a law from outside: it is code, which has no text"
        );
        world.remove_force(index).expect("it is there");
    }
    static OTHER: std::sync::OnceLock<Method> = std::sync::OnceLock::new();
    let rk4 = Method::named("rk4").expect("a method");
    let method = OTHER.get_or_init(|| Method {
        name: "rk4",
        ..copy(rk4)
    });
    let settings = Settings {
        method,
        ..Settings::default()
    };
    world.set_settings(settings).expect("settings");
    let error = serde_json::to_string(&world).expect_err("it is code");
    assert!(
        error.to_string().contains("rk4 is not in the table"),
        "{error}"
    );
    let text = r#"{"method": "guess"}"#;
    let error = serde_json::from_str::<Settings>(text).expect_err("no method");
    assert!(error.to_string().contains("guess"), "{error}");
}

fn copy(method: &Method) -> Method {
    Method { ..*method }
}
