//! Reading a world gives a valid world or an error, and never a panic, then or later.

use kit::random::Random;
use serde_json::{Value, json};
use sim_core::{Collision, Settings, World};

use super::snapshot::motley;

/// The number of changed worlds that are stepped: even a step that is refused as too much work takes time.
const STEPPED: usize = 60;

/// Steps a world in every mode: each step ends, successfully or with an error.
fn step_it(world: &World) {
    for collision in [Collision::Continuous, Collision::Bvh, Collision::Naive] {
        let mut world = world.clone();
        let settings = Settings {
            collision,
            ..*world.settings()
        };
        world.set_settings(settings).expect("settings");
        for _ in 0..2 {
            let before = world.state_hash();
            let done = world.step();
            if let Err(error) = done {
                assert_eq!(world.state_hash(), before, "{error}");
                break;
            }
            assert!(world.bodies().all(|body| body.position.is_finite()));
        }
    }
}

/// Calls the fallible functions of a world, and removes its bodies.
fn use_it(mut world: World) {
    let _ = (world.state_hash(), world.contacts().count());
    assert!(world.bodies().all(|body| body.position.is_finite()));
    while !world.is_empty() {
        let handle = world.handle(world.len() / 2);
        let body = world.index_of(handle).expect("it is there");
        world.remove(body).expect("it is there");
    }
}

/// The paths of all values.
fn places(value: &Value, here: &str, found: &mut Vec<String>) {
    found.push(here.to_owned());
    match value {
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                places(item, &format!("{here}/{i}"), found);
            }
        }
        Value::Object(fields) => {
            for (name, item) in fields {
                places(item, &format!("{here}/{name}"), found);
            }
        }
        _ => {}
    }
}

#[test]
fn a_text_with_a_wrong_value_is_refused_or_sound() {
    let whole = serde_json::to_value(motley()).expect("a value");
    let mut all = Vec::new();
    places(&whole, "", &mut all);
    // The thousands of vertices are all alike.
    let is_coordinate = |place: &String| place.starts_with("/shapes") && place.len() > 30;
    all.retain(|place| !is_coordinate(place));
    let (mut refused, mut random) = (0, Random::splitmix(5));
    let values = [
        json!(null),
        json!(-1),
        json!(0),
        json!(1),
        json!(3),
        json!(1e300),
        json!(-1e99),
        json!(1e-310),
        json!(u64::MAX),
        json!("inf"),
        json!([]),
        json!(true),
        json!([0, 0]),
        json!([5, 1]),
    ];
    for case in 0..250 {
        let place = &all[random.below(all.len())];
        let mut changed = whole.clone();
        let there = changed.pointer_mut(place).expect("a place");
        match (there, random.below(4)) {
            (Value::Array(items), 0) if !items.is_empty() => {
                items.remove(random.below(items.len()));
            }
            (Value::Array(items), 1) if !items.is_empty() => {
                let twice = items[random.below(items.len())].clone();
                items.push(twice);
            }
            (there, _) => *there = values[random.below(values.len())].clone(),
        }
        match serde_json::from_value::<World>(changed) {
            Ok(world) => {
                if case < STEPPED {
                    step_it(&world);
                }
                use_it(world);
            }
            Err(_) => refused += 1,
        }
    }
    assert!(all.len() > 300 && refused > 0, "{refused} {}", all.len());
}

#[test]
fn bytes_that_have_been_changed_are_refused_or_sound() {
    let bytes = postcard::to_allocvec(&motley()).expect("bytes");
    let (mut refused, mut read, mut random) = (0, 0, Random::splitmix(9));
    for case in 0..250 {
        let mut changed = bytes.clone();
        for _ in 0..1 + random.below(3) {
            let place = random.below(changed.len());
            changed[place] = match random.below(3) {
                0 => 0xff,
                1 => changed[place] ^ (1 << random.below(8)),
                _ => random.bits() as u8,
            };
        }
        if random.one_in(9) {
            changed.truncate(random.below(changed.len()));
        }
        match postcard::from_bytes::<World>(&changed) {
            Ok(world) => {
                read += 1;
                if case < STEPPED {
                    step_it(&world);
                }
                use_it(world);
            }
            Err(_) => refused += 1,
        }
    }
    assert!(refused > 0 && read > 0, "{refused} {read}");
}

#[test]
fn what_is_wrong_is_said() {
    let whole = serde_json::to_value(motley()).expect("a value");
    let turn = whole.pointer("/bodies/6/turn").expect("it turns").clone();
    for (place, value, said) in [
        ("/version", json!(99), "version 99"),
        ("/bodies/1/mass", json!(-1.0), "mass of body 1"),
        ("/bodies/1/shape", json!(9), "there is no shape 9"),
        ("/bodies/0/velocity", json!([1, 0, 0]), "a static body"),
        (
            "/shapes/2/sphere/radius",
            json!(3),
            "meet, and are not listed among the overlaps",
        ),
        (
            "/bodies/1/previous_position",
            json!([1e300, 0, 0]),
            "previous position",
        ),
        (
            "/bodies/6/turn/now/rotation",
            json!([0.5, 0.5, 0.5, 0.6]),
            "rotation of body 6 must be a quaternion of unit length",
        ),
        (
            "/bodies/6/turn/before/rotation",
            json!([0, 0, 0, 0]),
            "rotation of body 6 must be a quaternion of unit length",
        ),
        (
            "/bodies/6/turn/now/momentum",
            json!([1e300, 0, 0]),
            "angular momentum of body 6",
        ),
        (
            "/bodies/6/turn/inertia/moments",
            json!([1e-250, 1e-250, 1e-250]),
            "spin of body 6",
        ),
        (
            "/bodies/6/turn/inertia/moments",
            json!([1, 1, 3]),
            "none may be more than the two others",
        ),
        (
            "/bodies/6/turn/inertia/axes",
            json!([0, 0, 0, 2]),
            "not a unit quaternion",
        ),
        (
            "/bodies/6/turn/torque",
            json!([0, 1e101, 0]),
            "torque of body 6",
        ),
        (
            "/bodies/8/turn/torque",
            json!([0, 1, 0]),
            "body 8: nothing turns it",
        ),
        (
            "/bodies/0/turn",
            turn.clone(),
            "half-space, which cannot turn",
        ),
        ("/ignored/0", json!([1, 77]), "no body 77"),
        ("/forces/2/spring/bodies", json!([1, 1]), "two different"),
        ("/forces/2/spring/bodies", json!([1, 50]), "no body 50"),
        ("/slots/1/body", json!(2), "each body must have one slot"),
        ("/steps", json!(u64::MAX), "steps"),
        (
            "/overlaps",
            json!([{"bodies": [3, 3], "depth_at_start": null}]),
            "no overlap",
        ),
        ("/contacts/0/normal", json!([2, 0, 0]), "not of length 1"),
        ("/contacts/0/bodies", json!([0, 99]), "no body 99"),
        ("/contacts_of", json!([[0]]), "each contact must be listed"),
        ("/impacts", json!(u64::MAX), "counts"),
        ("/settings/dt", json!(0), "dt is 0"),
    ] {
        let mut changed = whole.clone();
        *changed
            .pointer_mut(place)
            .unwrap_or_else(|| panic!("no {place}")) = value;
        let error = serde_json::from_value::<World>(changed).expect_err(place);
        assert!(error.to_string().contains(said), "{place}: {error}");
    }
}
