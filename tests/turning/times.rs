//! Times of impact of turning shapes, from closed forms, and against the exact test at many times.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::sync::Arc;

use kit::inputs::soup;
use kit::meshes::{builtin, cuboid, grid};
use kit::random::Random;
use sim_core::collide::turning::{
    Effort, Figure, Moving, Turning, TurningTouch, first_contact_counted,
};
use sim_core::collide::{Placement, naive, tree};
use sim_core::rotation::Flight;
use sim_core::{Bvh, DQuat, DVec3, Mesh, Vec3};

/// A shape with its motion.
struct Mover {
    figure: Solid,
    position: DVec3,
    velocity: DVec3,
    acceleration: DVec3,
    flight: Option<Flight>,
    axes: DQuat,
    centre: DVec3,
}

enum Solid {
    Mesh(Arc<Mesh>, Arc<Bvh>),
    Ball(f64),
    HalfSpace(DVec3),
}

impl Mover {
    fn new(figure: Solid, position: DVec3, velocity: DVec3) -> Mover {
        Mover {
            figure,
            position,
            velocity,
            acceleration: DVec3::ZERO,
            flight: None,
            axes: DQuat::IDENTITY,
            centre: DVec3::ZERO,
        }
    }

    fn mesh(mesh: &Arc<Mesh>, position: DVec3, velocity: DVec3) -> Mover {
        let tree = Arc::new(Bvh::build(mesh));
        Mover::new(Solid::Mesh(mesh.clone(), tree), position, velocity)
    }

    /// Rotates with a spin for a duration, as a body with these moments.
    fn turning(self, moments: DVec3, rotation: DQuat, spin: DVec3, duration: f64) -> Mover {
        let momentum = rotation * (moments * (rotation.inverse() * spin));
        Mover {
            flight: Some(
                Flight::new(moments, rotation, momentum, DVec3::ZERO, duration).expect("a flight"),
            ),
            ..self
        }
    }

    /// Rotates as a cube does, with equal moments.
    fn spinning(self, spin: DVec3, duration: f64) -> Mover {
        self.turning(DVec3::ONE, DQuat::IDENTITY, spin, duration)
    }

    fn moving(&self) -> Moving<'_> {
        Moving {
            figure: match &self.figure {
                Solid::Mesh(_, tree) => Figure::Mesh(tree),
                Solid::Ball(radius) => Figure::Ball(*radius),
                Solid::HalfSpace(normal) => Figure::HalfSpace(*normal),
            },
            centre: self.centre,
            position: self.position,
            velocity: self.velocity,
            acceleration: self.acceleration,
            turning: match &self.flight {
                Some(flight) => Turning::Flight(flight, self.axes),
                None => Turning::Still(DQuat::IDENTITY),
            },
        }
    }
}

/// Whether a search has ended before the time it was given.
fn is_cut(touch: Option<TurningTouch>) -> bool {
    touch.is_some_and(|touch| touch.distance > touch.near)
}

/// The result of a search. Exchanging the two shapes must give nearly the same result.
fn found(a: &Mover, b: &Mover, duration: f64) -> (Option<TurningTouch>, Effort) {
    let (touch, effort) = first_contact_counted(&a.moving(), &b.moving(), duration);
    let (other, _) = first_contact_counted(&b.moving(), &a.moving(), duration);
    if is_cut(touch) || is_cut(other) {
        return (touch, effort);
    }
    if let (Some(touch), Some(other)) = (touch, other) {
        assert!(
            (touch.time - other.time).abs() <= 1e-9 * duration,
            "{touch:?} {other:?}"
        );
        let apart = touch.points[1] - touch.points[0];
        assert!(touch.normal.dot(apart) >= 0.0, "{touch:?}");
    }
    assert_eq!(touch.is_some(), other.is_some(), "{touch:?} {other:?}");
    (touch, effort)
}

/// Whether meshes meet at a time, by the exact test: of all edges with all triangles, or by trees if there are many.
fn meet(a: &Mover, b: &Mover, t: f64) -> bool {
    let (Solid::Mesh(first, tree), Solid::Mesh(second, other)) = (&a.figure, &b.figure) else {
        panic!("meshes")
    };
    let (a, b) = (a.moving(), b.moving());
    let inverse = a.rotation_at(t).inverse();
    let offset = inverse * (b.origin_at(t) - a.origin_at(t));
    let turn = (inverse * b.rotation_at(t)).normalize();
    let at = Placement::turned(turn, offset).expect("a rotation");
    match first.triangles().len() * second.triangles().len() < 1 << 10 {
        true => naive::intersect(first, second, at),
        false => tree::intersect(tree, other, at),
    }
}

fn wall(normal: DVec3, position: DVec3) -> Mover {
    Mover::new(Solid::HalfSpace(normal), position, DVec3::ZERO)
}

/// A rod along x that is a segment: its triangles have zero width.
fn rod(half: f32) -> Arc<Mesh> {
    let x = Vec3::X * half;
    kit::meshes::mesh(vec![-x, Vec3::ZERO, x], vec![[0, 1, 2]])
}

fn check(name: &str, a: &Mover, b: &Mover, duration: f64, (exact, bar): (f64, f64)) {
    let (touch, effort) = found(a, b, duration);
    let touch = touch.unwrap_or_else(|| panic!("{name}: no contact"));
    let error = touch.time / exact - 1.0;
    println!("{name}: {:e} off {error:.1e}, {effort:?}", touch.time);
    assert!(
        error <= 4e-16 && error > -bar,
        "{name}: {touch:?} {error:e}"
    );
}

#[test]
fn a_rod_turns_onto_a_wall() {
    let floor = wall(DVec3::Y, -0.5 * DVec3::Y);
    let turning = |spin: f64, duration: f64| {
        Mover::mesh(&rod(1.0), DVec3::ZERO, DVec3::ZERO).spinning(spin * DVec3::Z, duration)
    };
    check("B1", &turning(PI / 6.0, 2.0), &floor, 2.0, (1.0, 1e-13));
    // A hundred turns in the second, after which it is as it was but for a quarter.
    let exact = 0.000_831_255_195_344_970_9;
    check(
        "B2",
        &turning(2.0 * PI * 100.25, 1.0),
        &floor,
        1.0,
        (exact, 1e-13),
    );
}

#[test]
fn an_edge_of_a_cube_turns_onto_a_wall_and_onto_a_face() {
    let cube = cuboid(DVec3::splat(0.5).as_vec3());
    let turning = Mover::mesh(&cube, DVec3::ZERO, DVec3::ZERO).spinning(DVec3::Z, 0.5);
    let exact = FRAC_PI_4 - (0.6 * 2_f64.sqrt()).acos();
    check(
        "B3",
        &turning,
        &wall(-DVec3::X, 0.6 * DVec3::X),
        0.5,
        (exact, 1e-13),
    );
    let still = Mover::mesh(&cube, 1.1 * DVec3::X, DVec3::ZERO);
    check("B3, faces", &turning, &still, 0.5, (exact, 3e-13));
    let other = Mover::mesh(&cube, 1.3 * DVec3::X, DVec3::ZERO).spinning(-DVec3::Z, 0.5);
    check(
        "B4",
        &turning,
        &other,
        0.5,
        (0.380_744_526_373_816_6, 3e-13),
    );
}

#[test]
fn faces_close_flat() {
    let cube = cuboid(DVec3::splat(0.5).as_vec3());
    let still = Mover::mesh(&cube, DVec3::ZERO, DVec3::ZERO);
    let turning = Mover::mesh(&cube, 1.1 * DVec3::X, -DVec3::X).spinning(DVec3::X, 0.4);
    check("B5", &still, &turning, 0.4, (0.1, 5e-13));
}

#[test]
fn a_rod_grazes_a_wall() {
    let graze = PI / 3.0 + 3_f64.sqrt() / 2.0;
    let coming = |d: f64, speed: f64, duration: f64| {
        let floor = Mover::new(Solid::HalfSpace(DVec3::Y), -d * DVec3::Y, speed * DVec3::Y);
        let rod =
            Mover::mesh(&rod(1.0), DVec3::ZERO, DVec3::ZERO).spinning(2.0 * DVec3::Z, duration);
        (rod, floor)
    };
    for (d, exact, bar) in [
        (graze + 1e-9, 1.685_609_419_354_080_8, 1e-12),
        (graze - 1e-9, 1.047_173_523_193_564, 1e-9),
    ] {
        let (rod, floor) = coming(d, 1.0, 2.0);
        check("B6", &rod, &floor, 2.0, (exact, bar));
    }
    // Missed by 1e-12 and not, up to half a turn later.
    for (beside, hits) in [(1e-12, false), (-1e-12, true)] {
        let (rod, floor) = coming(graze + beside, 1.0, 1.2);
        assert_eq!(found(&rod, &floor, 1.2).0.is_some(), hits, "{beside}");
    }
    let (rod, floor) = coming(1.5, 0.1, 6.0);
    check("B7", &rod, &floor, 6.0, (5.362_708_845_701_237, 1e-12));
}

#[test]
fn a_shallow_graze_is_found() {
    let depth = 1.0 - 1e-12;
    let floor = wall(DVec3::Y, -depth * DVec3::Y);
    let rod = Mover::mesh(&rod(1.0), DVec3::ZERO, DVec3::ZERO).spinning(DVec3::Z, 3.0);
    check("B8", &rod, &floor, 3.0, (1.570_794_912_581_334_2, 1e-6));
}

#[test]
fn a_peg_turns_in_its_hole() {
    let peg = Mover::mesh(&cuboid(Vec3::new(0.5, 0.5, 1.0)), DVec3::ZERO, DVec3::ZERO)
        .spinning(DVec3::Z, 1.0);
    let (inner, outer, high) = (0.625_f32, 1.0_f32, 0.5_f32);
    let walls = [
        [
            Vec3::new(-outer, inner, -high),
            Vec3::new(outer, outer, high),
        ],
        [
            Vec3::new(-outer, -outer, -high),
            Vec3::new(outer, -inner, high),
        ],
        [
            Vec3::new(inner, -inner, -high),
            Vec3::new(outer, inner, high),
        ],
        [
            Vec3::new(-outer, -inner, -high),
            Vec3::new(-inner, inner, high),
        ],
    ];
    let hole = Mover::mesh(&kit::meshes::boxes(&walls), DVec3::ZERO, DVec3::ZERO);
    check("B9", &peg, &hole, 1.0, (0.298_703_208_322_675_1, 3e-13));
}

#[test]
fn a_propeller_hits_or_lets_pass() {
    let blade = cuboid(Vec3::new(1.0, 1.0 / 16.0, 1.0 / 128.0));
    let (speed, radius, duration) = (500.0, 1.0 / 64.0, 1.0 / 60.0);
    let spin = 2.0 * PI * 60.0;
    let moments = DVec3::new(1.0 / 64.0, 4.0, 4.0 + 1.0 / 64.0 - 1e-4);
    let (mut hits, mut misses) = (0, 0);
    for phase in 0..64 {
        let start = PI * f64::from(phase) / 64.0;
        let flight = Mover::mesh(&blade, DVec3::ZERO, DVec3::ZERO).turning(
            moments,
            DQuat::from_rotation_z(start),
            spin * DVec3::Z,
            duration,
        );
        let arrival = 0.5 * duration;
        let place = DVec3::new(0.75, 0.0, speed * arrival);
        let ball = Mover::new(Solid::Ball(radius), place, -speed * DVec3::Z);
        // The angle from the blade to the ball as the ball passes.
        let there = (start + spin * arrival).rem_euclid(PI);
        let beside = there.min(PI - there);
        let (touch, _) = found(&flight, &ball, duration);
        if beside < 0.085 {
            let touch = touch.unwrap_or_else(|| panic!("{phase} missed"));
            assert!((touch.time - arrival).abs() < 2.0 * (radius + 1.0 / 128.0) / speed);
            hits += 1;
        } else if beside > 0.125 {
            assert!(touch.is_none(), "{phase}: {touch:?}");
            misses += 1;
        }
    }
    assert!(hits > 2 && misses > 50, "{hits} {misses}");
}

#[test]
fn cubes_slide_past_each_other_at_a_billionth() {
    let cube = cuboid(DVec3::splat(0.5).as_vec3());
    let still = Mover::mesh(&cube, DVec3::ZERO, DVec3::ZERO);
    for spin in [0.0, 1.0] {
        let place = DVec3::new(2.0, 1.0 + 1e-9, 0.0);
        let past = Mover::mesh(&cube, place, -10.0 * DVec3::X).spinning(spin * DVec3::Y, 0.4);
        let (touch, effort) = found(&still, &past, 0.4);
        assert!(touch.is_none(), "{touch:?}");
        println!("B11, {spin} rad/s: {effort:?}");
        assert!(effort.pieces < 20_000, "{effort:?}");
    }
}

#[test]
fn the_length_of_the_step_is_no_matter() {
    let floor = wall(DVec3::Y, -0.5 * DVec3::Y);
    for duration in [1e4, 2.0, 1.0 + 1e-3, 1.0 + 1e-9] {
        let rod = Mover::mesh(&rod(1.0), DVec3::ZERO, DVec3::ZERO)
            .spinning(PI / 6.0 * DVec3::Z, duration);
        check("B13", &rod, &floor, duration, (1.0, 1e-12));
    }
    let rod =
        Mover::mesh(&rod(1.0), DVec3::ZERO, DVec3::ZERO).spinning(PI / 6.0 * DVec3::Z, 1.0 - 1e-9);
    assert!(found(&rod, &floor, 1.0 - 1e-9).0.is_none());
}

#[test]
fn balls_meet_balls_and_walls_as_in_their_closed_forms() {
    let mut random = Random::splitmix(9);
    for case in 0..500 {
        let (radius, other) = (random.from(0.1, 1.0), random.from(0.1, 1.0));
        let from = 5.0 * random.direction();
        let velocity = -from + 1.5 * random.vector();
        let a = Mover::new(Solid::Ball(radius), DVec3::ZERO, DVec3::ZERO);
        let b = Mover::new(Solid::Ball(other), from, velocity);
        let (touch, _) = found(&a, &b, 2.0);
        // |r + t d| = R
        let (sum, approach, way) = (
            radius + other,
            -from.dot(velocity),
            velocity.length_squared(),
        );
        let depth = sum * sum * way - from.cross(velocity).length_squared();
        if depth > 1e-9 && approach > 0.0 {
            let exact = (from.length_squared() - sum * sum) / (approach + depth.sqrt());
            if exact < 1.9 {
                let touch = touch.unwrap_or_else(|| panic!("{case}"));
                assert!(touch.time <= exact * (1.0 + 1e-15), "{case}");
                assert!(
                    touch.time > exact - 1e-12 / depth.sqrt(),
                    "{case}: {touch:?} {exact}"
                );
            }
        } else if depth < -1e-9 {
            assert!(touch.is_none(), "{case}");
        }
        // Falling onto a floor: R = h - g t²/2.
        let height = radius + random.from(0.1, 3.0);
        let falls = Mover {
            acceleration: -9.81 * DVec3::Y,
            ..Mover::new(Solid::Ball(radius), height * DVec3::Y, DVec3::X)
        };
        let exact = (2.0 * (height - radius) / 9.81).sqrt();
        check(
            "fall",
            &falls,
            &wall(DVec3::Y, DVec3::ZERO),
            1.0,
            (exact, 1e-13),
        );
    }
}

/// A ring of so many quads by as many.
fn ring(n: u32) -> Arc<Mesh> {
    grid(n, true, |u, v| {
        let (u, v) = (u * std::f32::consts::TAU, v * std::f32::consts::TAU);
        let out = 1.0 + 0.35 * v.cos();
        Vec3::new(out * u.cos(), out * u.sin(), 0.35 * v.sin())
    })
}

/// A channel: a floor and two sides.
fn channel() -> Arc<Mesh> {
    kit::meshes::boxes(&[
        [Vec3::new(-1.0, -0.5, -0.5), Vec3::new(1.0, -0.3, 0.5)],
        [Vec3::new(-1.0, -0.25, -0.5), Vec3::new(1.0, 0.5, -0.3)],
        [Vec3::new(-1.0, -0.25, 0.3), Vec3::new(1.0, 0.5, 0.5)],
    ])
}

/// Some triangles without shared vertices.
fn scattered(random: &mut Random) -> Arc<Mesh> {
    let triangles: Vec<_> = (0..12)
        .map(|_| {
            let mut vector = || (0.5 * random.vector()).as_vec3().to_array();
            (
                vector(),
                [vector(), vector()].map(|arm| arm.map(|x| 4.0 * x)),
            )
        })
        .collect();
    Arc::new(soup(&triangles))
}

/// `COWBELL_TURNING_RUNS` sets the number of pairs, and `COWBELL_TURNING_SEED` their seed.
#[test]
fn turning_meshes_are_never_late_and_never_wrong() {
    let number = |name: &str| {
        std::env::var(name)
            .ok()
            .map(|n| n.parse::<u64>().expect("a number"))
    };
    let mut random = Random::splitmix(number("COWBELL_TURNING_SEED").unwrap_or(99));
    let meshes = [
        cuboid(Vec3::splat(0.5)),
        ring(8),
        channel(),
        cuboid(Vec3::new(2.0, 0.02, 0.02)),
        scattered(&mut random),
        builtin("cow.obj"),
    ]
    .map(|mesh| (Arc::new(Bvh::build(&mesh)), mesh));
    let runs = number("COWBELL_TURNING_RUNS").unwrap_or(100);
    let (mut tried, mut hits, mut missed, mut crossing, mut cut) = (0, 0, 0, 0, 0);
    let mut effort_of_all = Effort::default();
    for case in 0..runs {
        let duration = 1.0 / 60.0;
        let speed = 10_f64.powf(random.from(0.0, 3.0));
        let spin = [0.0, 1.0, 20.0, 300.0, 1e4][random.below(5)];
        let mut pair = [0, 1].map(|_| {
            let (tree, mesh) = &meshes[random.below(meshes.len())];
            let solid = Solid::Mesh(mesh.clone(), tree.clone());
            let mut mover = Mover::new(solid, DVec3::ZERO, DVec3::ZERO);
            mover.centre = 0.2 * random.vector();
            mover.axes = DQuat::from_scaled_axis(2.0 * random.vector());
            mover.acceleration = 10.0 * random.vector();
            let moments = DVec3::new(1.0, random.from(1.0, 1.4), random.from(1.2, 1.9));
            let rotation = DQuat::from_scaled_axis(3.0 * random.vector());
            mover.turning(moments, rotation, spin * random.vector(), duration)
        });
        // As far away as they move in part of the time, or at a random smaller distance.
        let way = random.direction();
        let distance = random.from(0.3, 3.0) + random.unit() * speed * duration;
        pair[1].position = distance * way + 0.3 * random.vector();
        pair[1].velocity = -speed * way + 0.3 * speed * random.vector();
        let [a, b] = &pair;
        if meet(a, b, 0.0) {
            continue;
        }
        tried += 1;
        let (touch, effort) = found(a, b, duration);
        effort_of_all.views += effort.views;
        effort_of_all.boxes += effort.boxes;
        effort_of_all.pieces += effort.pieces;
        let until = touch.map_or(duration, |touch| touch.time);
        for i in 0..=40 {
            let t = until * f64::from(i) / 40.0;
            if meet(a, b, t) {
                println!("{case}: meet at {t} of {touch:?}");
                missed += 1;
                break;
            }
        }
        if is_cut(touch) {
            cut += 1;
        } else if let Some(touch) = touch {
            hits += 1;
            // Soon after they cross, except for grazing contacts.
            let later = [1e-12, 1e-10, 1e-8, 1e-6].map(|part| touch.time + part * duration);
            crossing += u64::from(later.iter().any(|&t| meet(a, b, t)));
        }
    }
    println!(
        "{missed} of {tried} missed, {hits} hits, {crossing} cross soon after, {cut} ended early, {effort_of_all:?}"
    );
    assert_eq!(missed, 0);
    assert!(hits > runs / 10 && 10 * crossing >= 9 * hits);
    assert!(cut <= runs / 200, "{cut} of {runs}");
}

#[test]
fn what_comes_whirling_from_afar_costs_what_is_near() {
    let mesh = ring(8);
    let (away, speed, spin) = (27.0, 10.0, 100.0);
    let duration = 1.2 * away / speed;
    let way = DVec3::new(1.0, 0.05, 0.1).normalize();
    let still = Mover::mesh(&mesh, DVec3::ZERO, DVec3::ZERO);
    let coming = Mover::mesh(&mesh, -away * way, speed * way);
    let (touch, effort) = found(
        &still.spinning(spin * DVec3::new(0.6, 0.8, 0.0), duration),
        &coming.spinning(spin * DVec3::new(0.0, -0.6, 0.8), duration),
        duration,
    );
    println!("{touch:?}, {effort:?}");
    assert!(touch.is_some() && !is_cut(touch), "{touch:?}");
    assert!(effort.boxes + effort.pieces < 10_000, "{effort:?}");
}

#[test]
fn what_turns_above_a_floor_touches_it_when_its_lowest_corner_does() {
    let mut random = Random::splitmix(21);
    let mesh = channel();
    let (mut hits, duration) = (0, 0.5);
    for case in 0..300 {
        let normal = random.direction();
        let floor = Mover {
            acceleration: random.vector(),
            ..Mover::new(Solid::HalfSpace(normal), random.vector(), random.vector())
        };
        let mut body = Mover::mesh(&mesh, floor.position + 2.0 * normal, random.vector());
        body.acceleration = -9.81 * normal;
        body.centre = 0.3 * random.vector();
        let moments = DVec3::new(1.0, random.from(1.0, 1.4), random.from(1.2, 1.9));
        let spin = [3.0, 100.0][case % 2] * random.vector();
        let body = body.turning(
            moments,
            DQuat::from_scaled_axis(random.vector()),
            spin,
            duration,
        );
        let height = |t: f64| {
            let (body, floor) = (body.moving(), floor.moving());
            let (turn, from) = (body.rotation_at(t), body.origin_at(t) - floor.origin_at(t));
            let heights = mesh
                .vertices()
                .iter()
                .map(|v| normal.dot(turn * v.as_dvec3() + from));
            heights.fold(f64::INFINITY, f64::min)
        };
        let (touch, _) = found(&body, &floor, duration);
        let until = touch.map_or(duration, |touch| touch.time);
        for i in 0..=200 {
            assert!(height(until * f64::from(i) / 200.0) > 0.0, "{case}");
        }
        if let Some(touch) = touch {
            hits += 1;
            assert!(
                (height(touch.time) - touch.distance).abs() < 1e-14,
                "{case}"
            );
            assert!(touch.faces.iter().flatten().count() == 1);
        }
    }
    assert!(hits > 150, "{hits}");
}

#[test]
fn a_quarter_turn_is_seen_whole() {
    // A door closes onto a post, which stands in the middle of its path: at the end the door is beyond it.
    let door = Mover {
        centre: DVec3::new(-1.0, 0.0, 0.0),
        ..Mover::mesh(&cuboid(Vec3::new(1.0, 0.5, 0.01)), DVec3::ZERO, DVec3::ZERO)
    };
    let door = door.turning(DVec3::ONE, DQuat::IDENTITY, FRAC_PI_2 * DVec3::Y, 1.0);
    let post = Mover::mesh(
        &cuboid(Vec3::new(0.01, 1.0, 0.01)),
        DVec3::new(1.0, 0.0, -1.0),
        DVec3::ZERO,
    );
    assert!(!meet(&door, &post, 0.0) && !meet(&door, &post, 1.0));
    let (touch, _) = found(&door, &post, 1.0);
    let touch = touch.expect("a contact");
    assert!((touch.time - 0.5).abs() < 0.02, "{touch:?}");
}
