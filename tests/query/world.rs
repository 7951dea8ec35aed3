//! Queries about all bodies of a world, against a loop over them.

use kit::bodies::{at, immovable, wall};
use kit::random::Random;
use kit::shapes::{ball, cube};
use kit::worlds::world;
use sim_core::query::{self, Hit, Placed};
use sim_core::{Body, DVec3, Shape, World};

fn vector(random: &mut Random, most: f64) -> DVec3 {
    DVec3::from([(); 3].map(|()| random.from(-most, most)))
}

/// The best of all bodies by a measure; among equal ones, the lowest index.
fn best(
    world: &World,
    ask: impl Fn(Placed<'_>) -> Option<Hit>,
    measure: impl Fn(&Hit) -> f64,
) -> Option<(usize, Hit)> {
    let hits = (0..world.len()).filter_map(|body| Some((body, ask(world.placed(body)?)?)));
    hits.filter(|(body, _)| !is_left_out(*body))
        .min_by(|(_, one), (_, other)| measure(one).total_cmp(&measure(other)))
}

fn is_left_out(body: usize) -> bool {
    body % 17 == 3
}

/// Compares the answers of a world with those of a loop, and counts the hits.
fn compare(world: &World, random: &mut Random) -> [usize; 4] {
    let among = |body: usize| !is_left_out(body);
    let mut found = [0; 4];
    for round in 0..12 {
        let (from, to) = (vector(random, 12.0), vector(random, 6.0));
        let way = match round % 3 {
            0 => to - from,
            1 => DVec3::AXES[round % 2] * 20.0,
            _ => 0.01 * to,
        };
        let hit = world.cast_ray(from, way, among).expect("a ray");
        let expected = best(
            world,
            |shape| query::ray(shape, from, way).expect("a ray"),
            |h| h.time,
        );
        assert_eq!(hit, expected, "ray {from} {way}");
        found[0] += usize::from(hit.is_some());

        let near = world.nearest(from, among).expect("a point");
        let point = Placed::sphere(0.0, from).expect("a point");
        let expected = best(world, |shape| query::distance(shape, point), |h| h.distance);
        assert_eq!(near, expected, "nearest to {from}");
        found[1] += usize::from(near.is_some());

        let body = random.below(world.len());
        let small = Placed::sphere(0.4, from).expect("a ball");
        let shapes = [
            world
                .placed(body)
                .map(|shape| shape.at(from).expect("a place")),
            Some(small),
        ];
        for shape in shapes.into_iter().flatten() {
            let hit = world.cast_shape(shape, way, among).expect("a motion");
            let cast =
                |body: Placed<'_>| query::time_of_impact(body, shape, way).expect("a motion");
            let expected = best(world, cast, |h| h.time);
            assert_eq!(hit, expected, "cast {from} {way}");
            found[2] += usize::from(hit.is_some());

            let meeting = world.bodies_meeting(shape);
            let meets = |&body: &usize| {
                world
                    .placed(body)
                    .is_some_and(|placed| query::intersects(placed, shape))
            };
            assert_eq!(meeting, (0..world.len()).filter(meets).collect::<Vec<_>>());
            found[3] += meeting.len();
        }
    }
    found
}

/// A body of any kind at a random position, on a lattice with several bodies at equal distances.
fn some_body(random: &mut Random, round: usize) -> Body {
    let lattice = vector(random, 10.0).round();
    let place = if random.one_in(2) {
        lattice
    } else {
        vector(random, 10.0)
    };
    let shape = match random.below(8) {
        0 if round.is_multiple_of(3) => Shape::HalfSpace { normal: DVec3::Y },
        0..=3 => ball(random.from(0.0, 0.5)),
        4 => {
            return Body {
                position: place,
                ..Body::default()
            };
        }
        _ => cube(),
    };
    let body = at(&shape, place);
    match shape {
        Shape::HalfSpace { .. } => wall(DVec3::Y, DVec3::Y * -9.0, DVec3::ZERO),
        _ if random.one_in(4) => immovable(body),
        _ => Body {
            velocity: vector(random, 1.0),
            ..body
        },
    }
}

#[test]
fn worlds_answer_as_a_loop_over_their_bodies_does() {
    let mut random = Random::splitmix(1);
    let mut found = [0; 4];
    for round in 0..12 {
        let count = [0, 1, 20, 33, 200, 700][round % 6];
        let mut world = world((0..count).map(|_| some_body(&mut random, round)));
        // Moved, placed and added bodies are found at their new positions, even right after a query.
        for change in 0..5 {
            if world.is_empty() {
                assert_eq!(world.cast_ray(DVec3::ZERO, DVec3::X, |_| true), Ok(None));
                assert_eq!(world.nearest(DVec3::ZERO, |_| true), Ok(None));
                break;
            }
            let more = compare(&world, &mut random);
            found
                .iter_mut()
                .zip(more)
                .for_each(|(all, more)| *all += more);
            match change {
                0 => world.step().expect("a step"),
                1 => {
                    let body = random.below(world.len());
                    world
                        .set_position(body, vector(&mut random, 5.0))
                        .expect("a place");
                }
                2 => {
                    world.add(some_body(&mut random, round)).expect("a body");
                }
                _ => world = world.clone(),
            }
        }
    }
    assert!(found.iter().all(|&count| count > 100), "{found:?}");
}

#[test]
fn worlds_refuse_what_is_no_number() {
    let world = world([at(&ball(1.0), DVec3::ZERO)]);
    let bad = DVec3::X * f64::NAN;
    let shape = world.placed(0).expect("a ball");
    assert!(world.cast_ray(bad, DVec3::X, |_| true).is_err());
    assert!(world.cast_ray(DVec3::X, DVec3::ZERO, |_| true).is_err());
    assert!(world.cast_shape(shape, bad, |_| true).is_err());
    assert!(world.nearest(bad, |_| true).is_err());
}

/// Among a hundred thousand cubes, queries with a ray, a position or a point test only a few.
#[test]
fn what_is_asked_of_many_bodies_takes_few_of_them() {
    let cube = cube();
    let place = |i: usize| 2.0 * DVec3::from([i % 40, i / 40 % 40, i / 1600].map(|k| k as f64));
    let world = world((0..64_000).map(|i| immovable(at(&cube, place(i)))));
    let asked = std::cell::Cell::new(0_usize);
    let among = |_| {
        asked.set(asked.get() + 1);
        true
    };
    let mut hits = 0;
    for round in 0..40 {
        // The first few queries loop over all boxes.
        let is_few = |most: usize| assert!(round < 4 || asked.replace(0) < most, "{round}");
        asked.set(0);
        let from = DVec3::new(-5.0, 0.1 * f64::from(round) + 20.3, 30.2);
        let way = DVec3::new(90.0, 3.0, 2.0);
        hits += usize::from(world.cast_ray(from, way, among).expect("a ray").is_some());
        is_few(20);
        let near = world.nearest(from + 0.4 * way, among).expect("a point");
        assert!(near.is_some());
        is_few(40);
        let small = Placed::sphere(0.2, from).expect("a ball");
        let hit = world.cast_shape(small, way, among).expect("a motion");
        hits += usize::from(hit.is_some());
        is_few(100);
    }
    assert!(hits > 40, "{hits}");
}
