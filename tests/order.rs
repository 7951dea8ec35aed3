//! The order in which bodies stand in a file has no say in what becomes of them.

use scene::{SCENES, Scene};
use sim_core::{Collision, DVec3, World};

const STEPS: usize = 200;

const MODES: [(&str, Collision); 3] = [
    ("continuous", Collision::Continuous),
    ("bvh", Collision::Bvh),
    ("naive", Collision::Naive),
];

/// Scenes and modes that do not hold it yet, and why.
const NOT_YET: [(&str, &str, &str); 0] = [];

/// What is not run, and why.
const LEFT_OUT: [(&str, &str, &str); 1] = [(
    "herd",
    "naive",
    "cows against cows take minutes; the BVH has the same answers",
)];

/// The bodies of a scene in another order: `order[i]` is where the one that comes to place `i` was.
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

/// Some orders of so many bodies: the reverse, a rotation, and two by chance.
fn orders(count: usize) -> Vec<Vec<usize>> {
    let mut orders = vec![
        (0..count).rev().collect(),
        (0..count).map(|i| (i + 1 + count / 3) % count).collect(),
    ];
    let mut state = 7_u64;
    for _ in 0..2 {
        let mut order: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            order.swap(last, (state >> 33) as usize % (last + 1));
        }
        orders.push(order);
    }
    orders
}

/// Position and velocity of each body after each step, or the error that ends them.
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
    // A zero has no sign that would matter.
    let plain = |v: DVec3| (v + DVec3::ZERO).to_array().map(f64::to_bits);
    let ([x, y, z], [u, v, w]) = (plain(world.position(body)), plain(world.velocity(body)));
    [x, y, z, u, v, w]
}

/// The first step after which a body is elsewhere in another order, and that body.
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

#[test]
fn the_order_of_bodies_changes_no_bit_of_the_gallery() {
    let mut wrong = Vec::new();
    for entry in SCENES {
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
            match (differing, NOT_YET.iter().find(is_named)) {
                (None, None) => {}
                (Some((step, body)), None) => {
                    wrong.push(format!("{} {mode}: {body} in step {step}", entry.name));
                }
                (Some((step, body)), Some((.., why))) => {
                    println!("{} {mode}: {body} in step {step}: {why}", entry.name);
                }
                (None, Some(_)) => {
                    wrong.push(format!(
                        "{} {mode} holds it now: take it from the list",
                        entry.name
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
