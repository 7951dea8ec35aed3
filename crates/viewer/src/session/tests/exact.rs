//! Compares the exact solution with very accurate methods, and tests when it stops being known.

use super::*;
use crate::session::Exact;

fn world(text: &str) -> sim_core::World {
    let scene = Scene::parse(text, Path::new("exact.toml")).expect("a scene");
    scene.world().expect("a world")
}

fn gallery_world(name: &str) -> sim_core::World {
    let scene = Scene::load(name).expect("in the gallery");
    scene.world().expect("a world")
}

/// A world with one body under these forces, which steps almost without error.
fn accurate(body: &str, forces: &str) -> sim_core::World {
    world(&format!(
        "rate = 100\nmethod = \"dop853\"\ntolerance = 1e-14\n[[body]]\nname = \"b\"\nmesh = \"cube.obj\"\n{body}\n{forces}"
    ))
}

/// Steps for `time`, s; the largest error on the way, relative to 1 m.
fn worst(world: &mut sim_core::World, time: f64) -> f64 {
    let mut exact = Exact::of(world);
    let mut worst: f64 = 0.0;
    while world.time() < time {
        world.step().expect("a step");
        worst = worst.max(exact.error(world).expect("known"));
    }
    worst
}

#[test]
fn agrees_with_accurate_methods_under_every_law_it_knows() {
    let thrown = "position = [1, 2, -1]\nvelocity = [3, 1, 0.5]\nmass = 2";
    let anchor = |k: f64, c: f64| {
        format!(
            "[[force]]\nkind = \"anchor\"\nbody = \"b\"\nanchor = [0.5, 0, 0]\nstiffness = {k}\ndamping = {c}"
        )
    };
    let gravity = "[[force]]\nkind = \"gravity\"\nacceleration = [0, -9.81, 0]\n";
    let drag = "[[force]]\nkind = \"linear-drag\"\nbody = \"b\"\ncoefficient = 0.7\n";
    let centre = |strength: f64| {
        format!(
            "[[force]]\nkind = \"attraction\"\nbody = \"b\"\ncentre = [0, 0, 0]\nstrength = {strength}"
        )
    };
    let cases = [
        ("free", gravity.to_owned(), 2.0, 1e-12),
        ("drag", gravity.to_owned() + drag, 5.0, 1e-11),
        ("spring", anchor(10.0, 0.0), 5.0, 1e-11),
        (
            "under-damped",
            gravity.to_owned() + &anchor(10.0, 1.0),
            5.0,
            1e-11,
        ),
        // c = 2 sqrt(k m)
        ("critical", anchor(8.0, 8.0), 5.0, 1e-11),
        ("nearly critical", anchor(8.0, 8.000_001), 5.0, 1e-11),
        (
            "over-damped",
            gravity.to_owned() + &anchor(8.0, 40.0),
            5.0,
            1e-11,
        ),
        (
            "two springs",
            anchor(3.0, 0.2) + "\n" + &anchor(5.0, 0.0) + "\n" + drag,
            5.0,
            1e-11,
        ),
        ("ellipse", centre(20.0), 30.0, 1e-8),
        ("hyperbola", centre(5.0), 10.0, 1e-10),
        // v² = 2 μ / r
        (
            "nearly a parabola",
            centre(10.25 / 2.0 * 6.0_f64.sqrt()),
            5.0,
            1e-10,
        ),
    ];
    for (name, forces, time, most) in cases {
        let error = worst(&mut accurate(thrown, &forces), time);
        assert!(error < most, "{name}: {error:e}");
    }
}

#[test]
fn bounces_of_balls_and_boxes_are_followed() {
    let floor = "[[body]]\nname = \"floor\"\nhalf-space = [0, 1, 0]\nrestitution = 0.9\n";
    let wall = "[[body]]\nname = \"wall\"\nhalf-space = [-1, 0, 0]\nposition = [3, 0, 0]\n";
    let gravity = "[[force]]\nkind = \"gravity\"\nacceleration = [0, -9.81, 0]\n";
    for shape in ["sphere = 0.2", "mesh = \"cube.obj\""] {
        for restitution in [1.0, 0.7] {
            let text = format!(
                "rate = 60\nmethod = \"rk4\"\n{floor}{wall}[[body]]\nname = \"b\"\n{shape}\nposition = [0, 1.3, 0]\n\
                 velocity = [2, 0, 1]\nrestitution = {restitution}\n{gravity}"
            );
            let error = worst(&mut world(&text), 8.0);
            // Hops shorter than a millisecond, before the body rests, are not resolved by the world.
            assert!(error < 3e-6, "{shape}, {restitution}: {error:e}");
        }
    }
    let mut bullet = gallery_world("bullet");
    let error = worst(&mut bullet, 1.0);
    assert!(bullet.impacts() > 100 && error < 1e-6, "{error:e}");
}

#[test]
fn tells_what_the_discrete_mode_misses() {
    let mut bullet = gallery_world("bullet");
    let settings = sim_core::Settings {
        collision: Collision::Bvh,
        ..*bullet.settings()
    };
    bullet.set_settings(settings).expect("settings");
    let error = worst(&mut bullet, 0.5);
    assert!(error > 100.0, "through the plate, and {error} m away");
}

#[test]
fn is_not_known_once_bodies_may_meet() {
    let mut world = session().world().clone();
    let mut exact = Exact::of(&world);
    while world.time() < 0.95 {
        world.step().expect("a step");
        assert!(exact.error(&world).is_some_and(|away| away < 1e-12));
    }
    while world.time() < 1.1 {
        world.step().expect("a step");
    }
    assert_eq!(exact.error(&world), None);
    // The same in a single call. In the discrete mode the bodies pass through each other without an impact.
    for collision in [Collision::Continuous, Collision::Bvh] {
        let settings = sim_core::Settings {
            dt: 3.0,
            collision,
            ..*world.settings()
        };
        let mut world = session().world().clone();
        world.set_settings(settings).expect("settings");
        let mut exact = Exact::of(&world);
        world.step().expect("a step");
        assert_eq!(exact.error(&world), None, "{collision:?}");
    }
}
