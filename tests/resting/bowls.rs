//! Balls that swing and circle in bowls of flat triangles, compared with the pendulum.

use std::f64::consts::TAU;

use glam::DVec3;
use kit::bodies::{body, immovable};
use kit::shapes::{ball, mesh};
use kit::worlds::{GRAVITY, add_gravity, world};
use sim_core::{Body, Bvh, Shape, World, collide};

use crate::scenes::conical_pendulum;

const BOWL: f64 = 2.0;
const RADIUS: f64 = 0.25;
/// The length of the pendulum, m.
const LENGTH: f64 = BOWL - RADIUS;

/// A part of a sphere about the origin, open at the top, with triangles between its rings.
fn bowl(sides: u32) -> Shape {
    let open = 1.2;
    let rings = (f64::from(sides) * open / TAU).ceil() as u32;
    let mut vertices = vec![DVec3::new(0.0, -BOWL, 0.0).as_vec3()];
    for ring in 1..=rings {
        let (sin, cos) = (open * f64::from(ring) / f64::from(rings)).sin_cos();
        vertices.extend((0..sides).map(|side| {
            let (z, x) = (TAU * f64::from(side) / f64::from(sides)).sin_cos();
            (BOWL * DVec3::new(sin * x, -cos, sin * z)).as_vec3()
        }));
    }
    let corner = |ring: u32, side: u32| 1 + (ring - 1) * sides + side % sides;
    let mut triangles = Vec::new();
    for side in 0..sides {
        triangles.push([0, corner(1, side), corner(1, side + 1)]);
        for ring in 1..rings {
            let [a, b] = [side, side + 1].map(|side| corner(ring, side));
            let [c, d] = [side, side + 1].map(|side| corner(ring + 1, side));
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    mesh(vertices, triangles)
}

/// A ball that touches the bowl at an angle from its lowest point, with a velocity across the slope.
fn in_bowl(sides: u32, angle: f64, across: f64, restitution: f64) -> World {
    let shape = bowl(sides);
    let tree = Bvh::build(shape.mesh().expect("it is one"));
    let way = DVec3::new(angle.sin(), -angle.cos(), 0.0);
    let (mut apart, mut met) = (0.9 * LENGTH, 1.1 * LENGTH);
    while met - apart > 1e-14 {
        let middle = 0.5 * (apart + met);
        match collide::ball_meets(&tree, middle * way, RADIUS) {
            true => met = middle,
            false => apart = middle,
        }
    }
    let give = |body: Body| Body {
        restitution,
        ..body
    };
    let mut world = world([
        give(immovable(body(&shape, DVec3::ZERO, DVec3::ZERO))),
        give(body(&ball(RADIUS), apart * way, across * DVec3::Z)),
    ]);
    add_gravity(&mut world, GRAVITY * DVec3::NEG_Y);
    world
}

/// The energy relative to the lowest point.
fn energy(world: &World) -> f64 {
    let height = world.position(1).y + LENGTH;
    0.5 * world.velocity(1).length_squared() + GRAVITY * height
}

/// Runs for a time. Returns the fraction of the energy that is lost, and the greatest rise in a step as a fraction of
/// the energy; `look` receives time and position after each step.
fn run(world: &mut World, time: f64, mut look: impl FnMut(f64, DVec3)) -> (f64, f64) {
    let start = energy(world);
    let (mut last, mut rise) = (start, 0.0_f64);
    while world.time() < time {
        world.step().expect("it goes on");
        assert!(world.meeting().is_empty());
        let now = energy(world);
        rise = rise.max((now - last) / start);
        last = now;
        look(world.time(), world.position(1));
    }
    (1.0 - last / start, rise)
}

/// At each edge between flat triangles an inelastic ball loses the component of its motion across: a fraction of the
/// energy that decreases with the number of edges. On the triangles themselves nothing is lost.
#[test]
fn balls_circle_in_bowls_as_on_a_pendulum() {
    let angle: f64 = 0.5;
    let (speed, period) = conical_pendulum(LENGTH, angle);
    let circled = |sides: u32, restitution: f64| {
        let mut world = in_bowl(sides, angle, speed, restitution);
        let (mut turned, mut last) = (0.0, 0.0);
        let (lost, rise) = run(&mut world, 2.0 * period, |_, place| {
            let now = place.z.atan2(place.x);
            turned += (now - last).rem_euclid(TAU);
            last = now;
        });
        println!(
            "{sides} sides, e = {restitution}: {lost:.2e} lost, {:.2e} turns",
            turned / TAU - 2.0
        );
        assert!(rise < 1e-9, "{sides} {restitution}: {rise}");
        (lost, turned / TAU - 2.0)
    };
    for sides in [48, 96] {
        let (lost, ahead) = circled(sides, 1.0);
        assert!(
            lost.abs() < 1e-11 && ahead.abs() < 0.1,
            "{sides}: {lost} {ahead}"
        );
    }
    let lost = [48, 96].map(|sides| circled(sides, 0.0).0);
    assert!(lost[0] < 0.2 && lost[1] < 0.7 * lost[0], "{lost:?}");
}

/// Through the lowest point, where a ball crosses several flat triangles in a step: it rises on the other side to
/// nearly the same height.
#[test]
fn balls_swing_through_the_lowest_point_of_a_bowl() {
    let angle: f64 = 0.6;
    for (sides, restitution) in [(64, 0.0), (64, 0.5), (96, 0.0), (96, 0.5), (96, 1.0)] {
        let mut world = in_bowl(sides, angle, 0.0, restitution);
        let (mut there, mut back) = (0.0_f64, 0.0_f64);
        // Half a period of a small swing takes 1.33 s, and one of this angle 1.02 times as long.
        let (lost, rise) = run(&mut world, 2.8, |time, place| match time < 2.0 {
            true => there = there.min(place.x),
            false => back = back.max(place.x),
        });
        let high = LENGTH * angle.sin();
        println!(
            "{sides} sides, e = {restitution}: {lost:.2e} lost, {there:.3} and {back:.3} of {high:.3} m"
        );
        assert!(rise < 1e-9, "{sides} {restitution}: {rise}");
        assert!(
            there < -0.95 * high && back > 0.9 * high,
            "{sides} {restitution}: {there} {back}"
        );
    }
}
