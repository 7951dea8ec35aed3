//! Gallery scenes against closed forms.

use scene::Scene;
use sim_core::{METHODS, Method, World};

/// How far each method's height is from `v t - t²/2` under a constant acceleration of -1 m/s², in
/// units of `t dt / 2`.
///
/// Forward Euler moves with the velocity from before the step: the heights of `n` steps sum to
/// `v n dt - dt² n (n - 1) / 2`, which is `t dt / 2` too high. Both other Euler methods move with
/// the velocity from after it, `dt² n (n + 1) / 2`, as much too low: they differ only where the
/// force depends on the motion. RK4 is exact for polynomials of degree up to four.
const HEIGHT_ERRORS: [(&str, f64); 4] = [
    ("forward-euler", 1.0),
    ("backward-euler", -1.0),
    ("symplectic-euler", -1.0),
    ("rk4", 0.0),
];

fn height_error(method: &Method) -> f64 {
    let known = HEIGHT_ERRORS.iter().find(|known| known.0 == method.name);
    known.expect("every method has a closed form").1
}

fn world(scene: &str, method: &'static Method) -> World {
    let mut scene = Scene::load(scene).expect("a gallery scene");
    scene.method = method;
    scene.world().expect("a world")
}

/// Steps a thrown body, checks each position against the closed form of its method, and returns
/// the times, distances and heights after each step.
fn throw(scene: &str, method: &'static Method, steps: u32) -> Vec<(f64, f64, f64)> {
    let mut world = world(scene, method);
    let dt = world.settings().dt;
    let (start, velocity) = (world.position(0), world.velocity(0));
    (1..=steps)
        .map(|n| {
            world.step().expect("a step");
            let t = f64::from(n) * dt;
            let error = height_error(method) * t * dt / 2.0;
            let at = world.position(0);
            let x = start.x + velocity.x * t;
            let y = start.y + velocity.y * t - t * t / 2.0 + error;
            let place = format!("{scene}, {}, t = {t}", method.name);
            assert!((at.x - x).abs() < 1e-12, "{place}: x = {}, not {x}", at.x);
            assert!((at.y - y).abs() < 1e-12, "{place}: y = {}, not {y}", at.y);
            assert_eq!(at.z, 0.0, "{place}");
            (world.time(), at.x, at.y)
        })
        .collect()
}

/// Where the polyline through the positions first comes down through height 0.
fn landing(path: &[(f64, f64, f64)]) -> f64 {
    // A position of height 0 but for rounding lies on the line, on whichever side it fell.
    let down = path
        .windows(2)
        .find(|pair| pair[0].2 > 0.0 && pair[1].2 <= 1e-12);
    let [(_, x0, y0), (_, x1, y1)] = down.expect("it comes down") else {
        unreachable!("a window of two");
    };
    x0 + (x1 - x0) * y0 / (y0 - y1)
}

#[test]
fn the_table_covers_all_methods() {
    for method in METHODS {
        height_error(method);
    }
    assert_eq!(METHODS.len(), HEIGHT_ERRORS.len());
}

#[test]
fn parabola_is_the_first_lab() {
    let scene = Scene::load("parabola").expect("a gallery scene");
    assert_eq!((scene.method.name, scene.dt), ("forward-euler", 1.0 / 60.0));
    let [cube] = &scene.bodies[..] else {
        panic!("one body");
    };
    assert_eq!(cube.position.to_array(), [-5.0, 0.0, 0.0]);
    assert_eq!(cube.velocity.to_array(), [2.0, 3.0, 0.0]);
    assert_eq!(cube.force.to_array(), [0.0, -1.0, 0.0]);
    assert_eq!(cube.mass, 1.0);
}

#[test]
fn parabola_follows_each_methods_closed_form() {
    for method in METHODS {
        let path = throw("parabola", method, 420);
        let late = height_error(method) / 60.0;
        let x = landing(&path);
        let expected = -5.0 + 2.0 * (6.0 + late);
        assert!((x - expected).abs() < 1e-12, "{}: {x}", method.name);
    }
}

#[test]
fn five_hertz_lands_where_each_method_says() {
    for (name, expected) in [
        ("forward-euler", 4.4),
        ("backward-euler", 3.6),
        ("symplectic-euler", 3.6),
        ("rk4", 4.0),
    ] {
        let method = Method::named(name).expect("a method");
        let x = landing(&throw("five-hertz", method, 30));
        assert!((x - expected).abs() < 1e-12, "{name}: {x}");
    }
}

#[test]
fn five_hertz_shows_each_methods_error_at_four_seconds() {
    for method in METHODS {
        let path = throw("five-hertz", method, 20);
        let &(t, x, y) = path.last().expect("20 steps");
        let dt = 0.2;
        let error = height_error(method) * 2.0 * dt;
        assert!((t - 4.0).abs() < 1e-12);
        assert!((x - 4.0).abs() < 1e-12, "{}: {x}", method.name);
        assert!((y - error).abs() < 1e-12, "{}: {y}", method.name);
    }
}
