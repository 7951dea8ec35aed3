//! The order of bodies in a file does not influence the result.

use std::path::Path;

use kit::random::Random;
use scene::{SCENES, Scene};
use sim_core::{Collision, DVec3, METHODS, World};

const STEPS: usize = 200;

const MODES: [(&str, Collision); 3] = [
    ("continuous", Collision::Continuous),
    ("bvh", Collision::Bvh),
    ("naive", Collision::Naive),
];

/// The runs left out, with reasons.
const LEFT_OUT: [(&str, &str, &str); 2] = [
    (
        "herd",
        "naive",
        "cows against cows take minutes; the BVH has the same answers",
    ),
    ("bin", "naive", "the same"),
];

/// Scenes in which turning bodies are hit: sums over touching features depend on the order of bodies.
const TURNING: [&str; 5] = [
    "cubes-turning",
    "cube-cow-spin",
    "cows-turning",
    "nut-on-bolt",
    "chain",
];

/// The scene with its bodies in another order: `order[i]` is the original index of body `i`.
fn permuted(scene: &Scene, order: &[usize]) -> Scene {
    let mut place = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        place[old] = new;
    }
    let mut permuted = scene.clone();
    permuted.bodies = order.iter().map(|&old| scene.bodies[old].clone()).collect();
    let forces = scene.forces.iter().cloned();
    permuted.forces = forces
        .map(|force| {
            force
                .renumbered(|body| Some(place[body]))
                .expect("all bodies stay")
        })
        .collect();
    permuted
}

/// Some orders of so many bodies: the reverse, a rotation, and two random ones.
fn orders(count: usize) -> Vec<Vec<usize>> {
    let mut orders = vec![
        (0..count).rev().collect(),
        (0..count).map(|i| (i + 1 + count / 3) % count).collect(),
    ];
    let mut random = Random::linear(7);
    for _ in 0..2 {
        let mut order: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            order.swap(last, random.below(last + 1));
        }
        orders.push(order);
    }
    orders
}

/// Position and velocity of each body after each step, or the error that ended the run.
fn run(scene: &Scene, steps: usize) -> (World, Vec<Vec<[u64; 6]>>, bool) {
    let mut world = scene.world().expect("a world");
    let mut states = Vec::new();
    for _ in 0..steps {
        if world.step().is_err() {
            return (world, states, true);
        }
        states.push((0..world.len()).map(|body| bits(&world, body)).collect());
    }
    (world, states, false)
}

fn bits(world: &World, body: usize) -> [u64; 6] {
    // Zeros are compared without their sign.
    let plain = |v: DVec3| (v + DVec3::ZERO).to_array().map(f64::to_bits);
    let ([x, y, z], [u, v, w]) = (plain(world.position(body)), plain(world.velocity(body)));
    [x, y, z, u, v, w]
}

/// The first step after which a body has another state in another order, and that body.
fn first_difference(scene: &Scene, order: &[usize], steps: usize) -> Option<(usize, String)> {
    let (world, states, failed) = run(scene, steps);
    let (other_world, others, other_failed) = run(&permuted(scene, order), steps);
    for (step, (state, other)) in states.iter().zip(&others).enumerate() {
        for (new, &old) in order.iter().enumerate() {
            if state[old] != other[new] {
                return Some((step + 1, scene.bodies[old].name.clone()));
            }
        }
    }
    let same = (states.len(), failed, world.impacts())
        == (others.len(), other_failed, other_world.impacts());
    (!same).then(|| (states.len() + 1, "impacts, or an error".to_owned()))
}

/// Panics if some orders of the bodies of a scene give other states.
fn assert_order_free(what: &str, scene: &Scene, orders: &[Vec<usize>], steps: usize) {
    for order in orders {
        let difference = first_difference(scene, order, steps);
        assert_eq!(difference, None, "{what}: {order:?}");
    }
}

fn parsed(text: &str) -> Scene {
    Scene::parse(text, Path::new("order.toml")).expect("a scene")
}

/// Regression: a cube hit from both sides within a step was hit by the first body in the file.
#[test]
fn a_body_that_two_hit_in_a_step_is_hit_by_the_earlier_one() {
    let scene = parsed(
        r#"
        rate = 60
        [[body]]
        name = "a"
        mesh = "cube.obj"
        position = [-1.05, 0, 0]
        velocity = [10, 0, 0]
        [[body]]
        name = "b"
        mesh = "cube.obj"
        [[body]]
        name = "c"
        mesh = "cube.obj"
        position = [1.05, 0.3, 0]
        velocity = [-10, 0, 0]
        mass = 2
        "#,
    );
    let orders = [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ];
    for (mode, collision) in MODES {
        let scene = Scene {
            collision,
            ..scene.clone()
        };
        assert_order_free(mode, &scene, &orders.map(Vec::from), 60);
    }
}

/// Equal balls in a row and a collapsing square: simultaneous hits, up to rounding or exactly.
#[test]
fn bodies_that_touch_at_the_same_time_go_together() {
    let ball = |name: usize, [x, y]: [f64; 2], [u, v]: [f64; 2], more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nsphere = 0.5\nposition = [{x}, {y}, 0]\n\
             velocity = [{u}, {v}, 0]\n{more}\n"
        )
    };
    let mut text = "rate = 60\n".to_owned();
    for (i, [x, y]) in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]]
        .into_iter()
        .enumerate()
    {
        let more = ["", "restitution = 0.5", "mass = 2", ""][i];
        text += &ball(i, [0.52 * x, 0.52 * y], [-3.0 * x, -3.0 * y], more);
    }
    for i in 4..8 {
        let x = 1.01 * i as f64;
        text += &ball(i, [x, 0.0], [if i == 4 { 40.0 } else { 0.0 }, 0.0], "");
    }
    let scene = parsed(&text);
    let symmetric = parsed(
        &text
            .replace("restitution = 0.5", "")
            .replace("mass = 2", ""),
    );
    for (mode, collision) in MODES {
        let scene = Scene {
            collision,
            ..scene.clone()
        };
        assert_order_free(mode, &scene, &orders(8), 120);
        let scene = Scene {
            collision,
            ..symmetric.clone()
        };
        let world = run(&scene, 2).0;
        let [first, .., last] = [0, 1, 2, 3].map(|body| world.velocity(body));
        assert_eq!(first, -last, "{mode}: nobody is first");
    }
}

/// Heaps in which all bodies overlap, and a box so full that a few hundred meet in a step.
#[test]
fn crowds_have_no_first_body() {
    let heap = r#"
        rate = 60
        collision = "bvh"
        [[body]]
        name = "ball"
        sphere = 1
        copies = 1
        speed = 1
        inside = [[-2, -2, -2], [2, 2, 2]]
    "#;
    let mut heap = parsed(heap);
    let ball = heap.bodies.remove(0);
    for i in 0..40 {
        let mut ball = ball.clone();
        let turn = f64::from(i);
        ball.name = i.to_string();
        ball.position = DVec3::new(turn.sin(), (2.0 * turn).cos(), (3.0 * turn).sin());
        ball.velocity = 3.0 * DVec3::new((5.0 * turn).cos(), (7.0 * turn).sin(), turn.cos());
        ball.mass = f64::from(1 + i % 3);
        heap.bodies.push(ball);
    }
    // Two of them at the same position.
    heap.bodies[1].position = heap.bodies[0].position;
    let world = heap.world().expect("a world");
    assert!(world.overlapping().len() > 300);
    assert_order_free("heap", &heap, &orders(40), 60);

    let full = parsed(
        r#"
        rate = 60
        collision = "bvh"
        [[body]]
        name = "floor"
        half-space = [0, 1, 0]
        position = [0, -4, 0]
        [[body]]
        name = "roof"
        half-space = [0, -1, 0]
        position = [0, 4, 0]
        [[body]]
        name = "cube"
        mesh = "cube.obj"
        rotation = [10, 20, 30]
        copies = 30
        speed = 20
        inside = [[-4, -4, -4], [4, 4, 4]]
        [[body]]
        name = "cow"
        mesh = "cow.obj"
        scale = [0.25, 0.25, 0.25]
        copies = 30
        speed = 20
        restitution = 0.5
        inside = [[-4, -4, -4], [4, 4, 4]]
        "#,
    );
    let world = run(&full, 120).0;
    assert!(world.impacts() > 100, "{}", world.impacts());
    assert_order_free("full", &full, &orders(full.bodies.len()), 120);
}

/// Springs with shared bodies, bodies without springs, drag on some and attraction between all: sums of many terms,
/// norms over all bodies and coupled equations give the same results.
#[test]
fn forces_are_summed_in_no_order_of_bodies() {
    let mut text = "rate = 60\ncollision = \"bvh\"\n".to_owned();
    for i in 0..9 {
        let turn = f64::from(i);
        let position = DVec3::new(turn.sin(), (2.0 * turn).cos(), (3.0 * turn).sin());
        let velocity = DVec3::new((5.0 * turn).cos(), (7.0 * turn).sin(), turn.cos());
        text += &format!(
            "[[body]]\nname = \"{i}\"\nsphere = 0.001\nposition = {position}\n\
             velocity = {velocity}\nmass = {}\n",
            1 + i % 3
        );
    }
    text += "[[force]]\nkind = \"gravity\"\nacceleration = [0, -9.8, 0]\n";
    let mut springs = text.clone();
    for (one, other) in [(0, 5), (5, 2), (2, 0), (5, 7), (1, 8)] {
        springs += &format!(
            "[[force]]\nkind = \"spring\"\nbodies = [\"{one}\", \"{other}\"]\n\
             rest_length = 1\nstiffness = 30\ndamping = 0.5\n"
        );
    }
    for body in [0, 3, 6] {
        springs += &format!(
            "[[force]]\nkind = \"quadratic-drag\"\nbody = \"{body}\"\ncoefficient = 0.3\n"
        );
    }
    let drag = "[[force]]\nkind = \"linear-drag\"\ncoefficient = 0.1\n";
    let gravitation = "[[force]]\nkind = \"gravitation\"\nconstant = 0.1\n";
    let cases = [
        ("springs", springs.clone()),
        ("springs and drag", springs.clone() + drag),
        ("gravitation", text.clone() + gravitation),
        ("all", springs + drag + gravitation),
    ];
    for (what, text) in cases {
        for method in METHODS {
            let mut scene = parsed(&text);
            scene.method = method;
            let what = format!("{what}, {}", method.name);
            assert!(!run(&scene, 40).2, "{what}");
            assert_order_free(&what, &scene, &orders(9), 40);
        }
    }
}

#[test]
fn the_order_of_bodies_changes_no_bit_of_the_gallery() {
    let mut wrong = Vec::new();
    for entry in SCENES {
        if TURNING.contains(&entry.name) {
            println!("{} is left out: what turns is hit in it", entry.name);
            continue;
        }
        for (mode, collision) in MODES {
            let is_named = |named: &&(&str, &str, &str)| (named.0, named.1) == (entry.name, mode);
            if let Some((.., why)) = LEFT_OUT.iter().find(is_named) {
                println!("{} {mode} is left out: {why}", entry.name);
                continue;
            }
            let mut scene = entry.scene().expect("a gallery scene");
            scene.collision = collision;
            let orders = orders(scene.bodies.len());
            let differing = orders
                .iter()
                .find_map(|order| first_difference(&scene, order, STEPS));
            if let Some((step, body)) = differing {
                wrong.push(format!("{} {mode}: {body} in step {step}", entry.name));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
