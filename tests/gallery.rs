//! Gallery scenes against closed forms.

use scene::Scene;
use sim_core::{Collision, DVec3, METHODS, Method, Settings, World};

/// The error of each method's height against `v t - t²/2` under a constant acceleration of -1 m/s², in units of
/// `t dt / 2`.
///
/// Forward Euler moves with the velocity from before the step: the heights of `n` steps sum to
/// `v n dt - dt² n (n - 1) / 2`, which is `t dt / 2` too high. Both other Euler methods move with the velocity from
/// after it, `dt² n (n + 1) / 2`, and are too low by the same amount; they differ only if the force depends on the
/// motion. Methods of higher order are exact for parabolas.
fn height_error(method: &Method) -> f64 {
    match method.name {
        "forward-euler" => 1.0,
        "backward-euler" | "symplectic-euler" => -1.0,
        _ => {
            assert!(method.order >= 2, "{}", method.name);
            0.0
        }
    }
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

/// The first point at which the polyline through the positions descends through height 0.
fn landing(path: &[(f64, f64, f64)]) -> f64 {
    // A position of height 0 up to rounding counts as on the line, whatever its sign.
    let down = path
        .windows(2)
        .find(|pair| pair[0].2 > 0.0 && pair[1].2 <= 1e-12);
    let [(_, x0, y0), (_, x1, y1)] = down.expect("it comes down") else {
        unreachable!("a window of two");
    };
    x0 + (x1 - x0) * y0 / (y0 - y1)
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

/// Runs a force-free scene of the gallery and checks that momentum and kinetic energy are conserved, to 1e-12 of the
/// sums of their parts.
fn run_conserving(scene: &str, steps: u32) -> World {
    let mut world = Scene::load(scene)
        .expect("a gallery scene")
        .world()
        .expect("a world");
    let (momentum, energy) = (world.momentum(), world.kinetic_energy());
    let largest: f64 = (0..world.len())
        .map(|i| world.mass(i) * world.velocity(i).length())
        .sum();
    for _ in 0..steps {
        world.step().expect("a step");
    }
    assert!(
        (world.kinetic_energy() / energy - 1.0).abs() < 1e-12,
        "{scene}"
    );
    assert!(
        (world.momentum() - momentum).length() < 1e-12 * largest,
        "{scene}"
    );
    world
}

#[test]
fn the_cube_hits_the_cow_and_they_part_again() {
    let mut gap = f64::INFINITY;
    for steps in (60..=600).step_by(60) {
        let world = run_conserving("cube-cow", steps);
        let distance = (world.position(1) - world.position(0)).length();
        assert!(world.overlapping().is_empty());
        if steps > 60 {
            assert!(
                world.impacts() >= 1 && distance > gap,
                "step {steps}: {distance} m"
            );
        }
        gap = distance;
    }
}

#[test]
fn two_cubes_meet_the_two_body_formula() {
    let world = run_conserving("two-cubes", 300);
    assert_eq!(world.impacts(), 2);
    // Head on with equal masses: velocities are exchanged.
    assert!((world.velocity(0) + 2.0 * DVec3::X).length() < 1e-12);
    assert!((world.velocity(1) - 2.0 * DVec3::X).length() < 1e-12);
    // Off centre the faces meet first, so the exchange is along x alone.
    let (m1, u1, m2, u2) = (1.0, 2.0, 3.0, -1.0);
    let exact = |m1: f64, u1: f64, m2: f64, u2: f64| ((m1 - m2) * u1 + 2.0 * m2 * u2) / (m1 + m2);
    let light = DVec3::new(exact(m1, u1, m2, u2), 0.2, 0.0);
    let heavy = DVec3::new(exact(m2, u2, m1, u1), 0.0, 0.0);
    assert!((world.velocity(2) - light).length() < 1e-12);
    assert!((world.velocity(3) - heavy).length() < 1e-12);
}

#[test]
fn naive_and_bvh_worlds_are_the_same_to_the_bit() {
    for (name, steps) in [("two-cubes", 300), ("cube-cow", 60)] {
        let mut scene = Scene::load(name).expect("a gallery scene");
        let [naive, bvh] = [Collision::Naive, Collision::Bvh].map(|collision| {
            scene.collision = collision;
            let mut world = scene.world().expect("a world");
            for _ in 0..steps {
                world.step().expect("a step");
            }
            assert!(world.impacts() >= 1, "{name}");
            let motion = (0..world.len()).map(|i| (world.position(i), world.velocity(i)));
            motion.collect::<Vec<_>>()
        });
        assert_eq!(naive, bvh, "{name}");
    }
}

/// A gallery scene after a number of steps.
fn run(scene: &str, steps: u64) -> World {
    let scene = Scene::load(scene).expect("a gallery scene");
    assert_eq!(scene.collision, Collision::Continuous);
    let mut world = scene.world().expect("a world");
    for _ in 0..steps {
        world.step().expect("a step");
    }
    world
}

#[test]
fn the_ball_bounces_when_the_closed_form_says() {
    let scene = Scene::load("bounce").expect("a gallery scene");
    let mut world = scene.world().expect("a world");
    let mut impacts = Vec::new();
    while world.time() < 3.0 {
        world.step_reporting(&mut impacts).expect("a step");
    }
    let first = (2.0 / 9.81_f64).sqrt();
    let mut time = first;
    for (n, impact) in impacts.iter().enumerate() {
        assert!((impact.time - time).abs() < 1e-9, "{n}: {} s", impact.time);
        time += 2.0 * first * 0.8_f64.powi(n as i32 + 1);
    }
    assert_eq!(impacts.len(), 6);
    let world = run("bounce", 600);
    assert!(
        (world.position(1).y - 0.1).abs() < 1e-9,
        "it lies on the floor"
    );
    assert!(world.velocity(1).length() < 1e-6, "{}", world.velocity(1));
}

#[test]
fn the_bullet_never_passes_a_plate() {
    let world = run("bullet", 60);
    assert_eq!(world.impacts(), 105);
    assert_eq!(world.velocity(0), DVec3::new(-1000.0, 0.0, 0.0));
    // The path is 1000 m; the way to the first plate is 4.7495 m, and to each further one 9.499 m.
    let gap = 9.499;
    let left = 1000.0 - 0.5 * gap - 104.0 * gap;
    let x = 0.5 * gap - left;
    assert!(
        (world.position(0).x - x).abs() < 1e-4,
        "{}",
        world.position(0).x
    );
    let mut scene = Scene::load("bullet").expect("a gallery scene");
    scene.collision = Collision::Bvh;
    let mut world = scene.world().expect("a world");
    world.step().expect("a step");
    assert_eq!(world.impacts(), 0, "a discrete test lets it through");
}

#[test]
fn the_last_ball_of_the_cradle_leaves_as_the_first_came() {
    let world = run("cradle", 120);
    assert_eq!(world.impacts(), 4);
    let speeds = [0.0, 0.0, 0.0, 0.0, 2.0];
    for (i, speed) in speeds.into_iter().enumerate() {
        assert_eq!(world.velocity(i), DVec3::new(speed, 0.0, 0.0), "{i}");
    }
}

#[test]
fn collisions_count_the_digits_of_pi() {
    let world = run("galperin", 600);
    assert_eq!(world.impacts(), 314);
    let (small, large) = (world.velocity(1).x, world.velocity(2).x);
    assert!(0.0 <= small && small <= large, "they never meet again");
    assert!((world.kinetic_energy() / 5000.0 - 1.0).abs() < 1e-12);
}

#[test]
fn walls_that_close_in_speed_the_ball_up() {
    let world = run("closing-walls", 1800);
    assert_eq!(world.impacts(), 61);
    assert!((world.velocity(2) + 7.2 * DVec3::X).length() < 1e-12);
    assert_eq!(world.velocity(1), DVec3::new(-0.1, 0.0, 0.0));
}

#[test]
fn the_peg_passes_the_channel_untouched() {
    let world = run("u-channel", 240);
    assert_eq!(world.impacts(), 0);
    assert_eq!(world.velocity(1), DVec3::NEG_Z);
    assert!(world.position(1).z < -1.7, "{}", world.position(1));
    // The clearance is real: displaced by slightly more than it, the peg overlaps the wall.
    let mut world = run("u-channel", 120);
    let middle = world.position(1);
    for aside in [DVec3::X, DVec3::NEG_X, DVec3::NEG_Y] {
        world
            .set_position(1, middle + 0.9e-6 * aside)
            .expect("a place");
        assert_eq!(world.overlapping(), [], "{aside}");
        world
            .set_position(1, middle + 1.1e-6 * aside)
            .expect("a place");
        assert_eq!(world.overlapping(), [(0, 1)], "{aside}");
    }
}

#[test]
fn a_hundred_cubes_keep_their_energy_in_their_box() {
    let world = run("hundred-cubes", 600);
    assert!(world.impacts() > 100, "{}", world.impacts());
    assert!((world.kinetic_energy() / 50.0 - 1.0).abs() < 1e-12);
    assert_eq!(world.overlapping(), []);
    for i in 6..world.len() {
        let at = (world.position(i) - DVec3::new(0.0, 3.0, 0.0)).abs();
        assert!(at.max_element() <= 2.75 + 1e-9, "{i}: {at}");
    }
}

#[test]
fn the_herd_settles_in_its_pen() {
    let mut world = run("herd", 300);
    // They have fallen 4 m on average: nearly all energy from that is dissipated.
    let early = world.kinetic_energy();
    assert!(early < 100.0, "{early} J");
    for _ in 0..120 {
        world.step().expect("a step");
    }
    for i in 5..world.len() {
        let at = world.position(i);
        let is_inside = at.x.abs() < 7.0 && at.z.abs() < 7.0 && at.y > 0.0;
        assert!(is_inside, "{i}: {at}");
    }
    let late = world.kinetic_energy();
    assert!(late < 50.0, "{late} J");
}

/// The index of a body in a gallery scene, by its name.
fn body(scene: &Scene, name: &str) -> usize {
    let found = scene.bodies.iter().position(|body| body.name == name);
    found.unwrap_or_else(|| panic!("no body {name}"))
}

const GRAVITY: f64 = 9.81;

/// Regression: bricks that landed among others were lifted into these, and moved back to the start of the step.
#[test]
fn bricks_without_friction_gain_nothing_at_any_rate() {
    for rate in [120.0, 480.0] {
        let mut world = Scene::load("wall")
            .expect("a scene")
            .world()
            .expect("a world");
        let settings = Settings {
            dt: 1.0 / rate,
            ..*world.settings()
        };
        world.set_settings(settings).expect("settings");
        for body in 0..world.len() {
            world.set_friction(body, 0.0).expect("a friction");
        }
        let energy = |world: &World| world.kinetic_energy() + world.potential_energy();
        let start = energy(&world);
        let mut before = start;
        for step in 0..(2.0 * rate) as u32 {
            world.step().expect("a step");
            let gained = energy(&world) - before;
            assert!(gained <= 1e-12 * start, "{rate} Hz, {step}: {gained:e} J");
            before += gained;
        }
    }
}

/// Steps a gallery scene under gravity in which only friction and impacts change the energy.
fn settle(name: &str, steps: u32) -> (Scene, World) {
    let scene = Scene::load(name).expect("a gallery scene");
    let mut world = scene.world().expect("a world");
    let energy = |world: &World| world.kinetic_energy() + world.potential_energy();
    let start = energy(&world);
    let mut before = start;
    for step in 0..steps {
        world.step().expect("a step");
        let after = energy(&world);
        assert!(
            after - before <= 1e-12 * start,
            "{name}: the energy rises by {:e} J in step {step}",
            after - before
        );
        before = after;
    }
    assert_eq!(world.overlapping(), [], "{name}");
    (scene, world)
}

#[test]
fn the_stack_stands_where_cubes_end() {
    let (_, world) = settle("stack", 120);
    for level in 0..12 {
        let (at, velocity) = (world.position(1 + level), world.velocity(1 + level));
        let height = 0.25 + 0.5 * level as f64;
        assert!((at.y - height).abs() < 1e-9, "{level}: {at}");
        assert_eq!(velocity, DVec3::ZERO, "{level}");
    }
    let weight = world.position(13).y - 6.4;
    assert!(weight.abs() < 1e-8, "the weight is off by {weight:e} m");
}

#[test]
fn what_slides_on_the_slope_has_too_little_friction() {
    let (scene, world) = settle("slope", 60);
    for (name, friction) in [
        ("mu 0", 0.0),
        ("mu 0.3", 0.3),
        ("mu 0.5", 0.5),
        ("mu 0.7", 0.7),
        ("mu 0.74", 0.74),
        ("mu 0.76", 0.76),
        ("mu 0.9", 0.9),
    ] {
        let at = body(&scene, name);
        let own: f64 = scene.bodies[at].friction;
        assert!((own.sqrt() - friction).abs() < 1e-12, "{name}");
        let down = DVec3::new(0.8, -0.6, 0.0);
        let speed = (GRAVITY * (0.6 - 0.8 * friction)).max(0.0);
        let off = (world.velocity(at) - speed * down).length();
        assert!(off < 1e-9, "{name}: {}", world.velocity(at));
        let way = 0.5 * speed * world.time() * down;
        let off = world.position(at) - scene.bodies[at].position - way;
        assert!(off.length() < 1e-7, "{name}: off by {off}");
        if friction > 0.75 {
            assert_eq!(world.velocity(at), DVec3::ZERO, "{name}");
        }
    }
    let (scene, world) = settle("slope", 600);
    for name in ["mu 0", "mu 0.3", "mu 0.5", "mu 0.7", "mu 0.76", "mu 0.9"] {
        assert_eq!(world.velocity(body(&scene, name)), DVec3::ZERO, "{name}");
    }
    assert!(world.velocity(body(&scene, "mu 0.74")).length() > 0.7);
}

#[test]
fn a_push_gets_through_the_dominoes_as_far_as_one_would_slide() {
    let (scene, world) = settle("dominoes", 300);
    let (gap, reach) = (0.5 - 0.1875, 16.0 / (2.0 * 0.2 * GRAVITY));
    let moved = |name: &str| {
        let at = body(&scene, name);
        assert_eq!(world.velocity(at), DVec3::ZERO, "{name}");
        world.position(at).x - scene.bodies[at].position.x
    };
    for number in 1..=16 {
        let way = (reach - gap * f64::from(number - 1)).clamp(0.0, gap);
        let moved = moved(&format!("elastic {number}"));
        assert!((moved - way).abs() < 1e-9, "{number}: {moved}, not {way}");
    }
    // The three sticky bodies are pushed together; the fourth is not reached.
    let at = |number: usize| world.position(body(&scene, &format!("sticky {number}"))).x;
    for number in 1..3 {
        let between = at(number + 1) - at(number) - 0.1875;
        assert!((0.0..1e-9).contains(&between), "{number}: {between:e}");
    }
    let slowing = 0.2 * GRAVITY;
    let mut speed: f64 = 4.0;
    for pushed in [1.0, 2.0] {
        speed = (speed * speed - 2.0 * slowing * gap).sqrt() * pushed / (pushed + 1.0);
    }
    let way = speed * speed / (2.0 * slowing);
    let off = moved("sticky 3") - way;
    assert!(off.abs() < 1e-9, "off by {off:e} m");
    for number in 4..=16 {
        assert_eq!(moved(&format!("sticky {number}")), 0.0, "{number}");
    }
}

#[test]
fn the_belt_carries_what_has_friction() {
    let scene = Scene::load("conveyor").expect("a gallery scene");
    let after = |steps| {
        let world = run("conveyor", steps);
        ["rough box", "box", "slippery box", "smooth ball"].map(|name| {
            let at = body(&scene, name);
            (world.position(at), world.velocity(at))
        })
    };
    let carried = DVec3::X;
    for (name, (_, velocity)) in ["rough", "box"].into_iter().zip(after(60)) {
        assert!((velocity - carried).length() < 1e-12, "{name}: {velocity}");
    }
    let (early, late) = (after(150), after(210));
    for i in 0..3 {
        let (before, velocity) = early[i];
        assert!((velocity - carried).length() < 1e-12, "{i}: {velocity}");
        let creep = late[i].0 - before - carried;
        assert!(creep.length() < 1e-9, "{i}: {creep}");
    }
    let late = after(360);
    let (at, velocity) = late[3];
    assert_eq!((at.x, velocity.x), (-1.0, 0.0), "the ball stays");
    let (at, velocity) = late[0];
    let held = 3.0 - 0.05 - 0.375;
    assert!((at.x - held).abs() < 1e-9, "at the fence: {at}");
    assert!(velocity.length() < 1e-12, "{velocity}");
}

#[test]
fn the_wall_stands_but_where_the_ball_went_through() {
    let (scene, world) = settle("wall", 300);
    let start = scene.world().expect("a world");
    let mut pushed_out = 0;
    for at in 0..world.len() {
        assert_eq!(world.velocity(at), DVec3::ZERO, "{}", scene.bodies[at].name);
        let way = world.position(at) - start.position(at);
        if way.z > 0.4 {
            pushed_out += 1;
        }
    }
    assert!((4..20).contains(&pushed_out), "{pushed_out}");
    for name in ["brick 1", "brick 5"] {
        let at = body(&scene, name);
        let moved = (world.position(at) - start.position(at)).length();
        assert!(moved < 0.01, "{name} of the lowest course: {moved} m");
    }
}

#[test]
fn the_funnel_runs_empty() {
    let (scene, world) = settle("funnel", 360);
    for at in 2..world.len() {
        let name = &scene.bodies[at].name;
        assert_eq!(world.velocity(at), DVec3::ZERO, "{name}");
        let height = world.position(at).y;
        assert!((0.15..1.5).contains(&height), "{name}: {height} m");
    }
}

#[test]
fn the_cows_come_to_rest_in_their_bin() {
    let (scene, world) = settle("bin", 300);
    for at in 5..world.len() {
        let (place, velocity) = (world.position(at), world.velocity(at));
        let name = &scene.bodies[at].name;
        assert!(velocity.length() < 1e-9, "{name}: {velocity}");
        let is_inside = place.x.abs() < 1.0 && place.z.abs() < 1.0 && place.y > 0.0;
        assert!(is_inside, "{name}: {place}");
    }
}
