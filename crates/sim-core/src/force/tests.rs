use alloc::vec::Vec;
use glam::{DMat3, DVec3};
use proptest::prelude::*;

use super::*;

fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    [-size..size, -size..size, -size..size].prop_map(DVec3::from)
}

/// A force of a kind that is chosen, with numbers up to 10 and vectors up to 1.
fn with_numbers(force: &Force, mut numbers: impl Iterator<Item = f64>) -> Force {
    let mut next = || numbers.next().expect("endless numbers");
    let mut force = force.clone();
    force.fields(|field| match field.value {
        Value::Number { value, least, .. } => *value = 10.0 * next().max(least.max(-1.0)),
        Value::Vector(value) => *value = DVec3::new(next(), next(), next()),
        Value::Body(_)
        | Value::AnyBody(_)
        | Value::Bodies(_)
        | Value::AnyBodies(_)
        | Value::Point(_)
        | Value::Points(_) => {}
    });
    force
}

/// Forces on single bodies, or between two, with any numbers.
fn any_force(is_mutual: bool) -> impl Strategy<Value = Force> {
    let kinds: Vec<Force> = FORCES
        .iter()
        .filter(|force| force.is_mutual() == is_mutual)
        .cloned()
        .collect();
    // Springs without a rest length have a law of their own.
    let number = prop_oneof![1 => Just(0.0), 4 => -1.0..1.0];
    let numbers = proptest::collection::vec(number, 16);
    (proptest::sample::select(kinds), numbers)
        .prop_map(|(force, numbers)| with_numbers(&force, numbers.into_iter().cycle()))
}

fn on_body() -> impl Strategy<Value = Force> {
    any_force(false)
}

fn on_pair() -> impl Strategy<Value = Force> {
    any_force(true)
}

/// The largest difference of two Jacobians, relative to their size.
fn difference(a: Jacobians, b: Jacobians) -> f64 {
    let apart = |a: DMat3, b: DMat3| {
        let pairs = a.to_cols_array().into_iter().zip(b.to_cols_array());
        pairs
            .map(|(a, b)| (a - b).abs() / (1.0 + a.abs()))
            .fold(0.0, f64::max)
    };
    apart(a.position, b.position).max(apart(a.velocity, b.velocity))
}

proptest! {
    #[test]
    fn jacobians_of_single_bodies_are_the_slopes(
        force in on_body(), position in vector(3.0), velocity in vector(3.0), mass in 0.1..5.0,
    ) {
        let at = BodyMotion { time: 0.0, mass, position, velocity };
        if let Some(centre) = force.nature().tie.point() {
            prop_assume!(position.distance(centre) > 0.3);
        }
        prop_assume!(velocity.length() > 0.1);
        let numeric = vectors::differences(position, velocity, |position, velocity| {
            force.on_body(&BodyMotion { position, velocity, ..at })
        });
        let off = difference(force.body_jacobians(&at), numeric);
        prop_assert!(off < 1e-7, "{force:?}: {off}");
    }

    #[test]
    fn jacobians_of_pairs_are_the_slopes(
        force in on_pair(), position in vector(3.0), velocity in vector(3.0), m in 0.1..5.0,
    ) {
        prop_assume!(position.length() > 0.3);
        let at = PairMotion { time: 0.0, mass: [m, 2.0], position, velocity };
        let numeric = vectors::differences(position, velocity, |position, velocity| {
            force.on_pair(&PairMotion { position, velocity, ..at })
        });
        let slopes = force.pair_jacobians(&at);
        let off = difference(slopes, numeric);
        prop_assert!(off < 1e-7, "{force:?}: {off}");
        let (dx, dv) = (DVec3::new(velocity.z, velocity.x, velocity.y), DVec3::new(position.y, position.z, position.x));
        let product = slopes.position * dx + slopes.velocity * dv;
        let change = force.pair_change(&at, dx, dv);
        prop_assert!((change - product).length() < 1e-12 * (1.0 + product.length()) * 100.0);
    }

    #[test]
    fn forces_without_damping_are_the_slopes_of_their_potentials(
        body in on_body(), pair in on_pair(), position in vector(3.0), mass in 0.1..5.0,
    ) {
        prop_assume!(position.length() > 0.3);
        let h = 1e-5;
        let slope = |energy: &dyn Fn(DVec3) -> Option<f64>| -> Option<DVec3> {
            let axes = [DVec3::X, DVec3::Y, DVec3::Z];
            let slopes: Option<Vec<f64>> = axes
                .iter()
                .map(|&d| Some((energy(position + h * d)? - energy(position - h * d)?) / (2.0 * h)))
                .collect();
            slopes.map(|s| DVec3::new(s[0], s[1], s[2]))
        };
        let velocity = DVec3::ZERO;
        let at = |position| BodyMotion { time: 0.0, mass, position, velocity };
        if let Some(centre) = body.nature().tie.point() {
            prop_assume!(position.distance(centre) > 0.3);
        }
        if let Some(slope) = slope(&|x| body.body_potential(&at(x))) {
            // Weight is part of the constant acceleration.
            let force = match body {
                Force::Gravity { acceleration } => mass * acceleration,
                _ => body.on_body(&at(position)),
            };
            prop_assert!((slope + force).length() < 1e-5 * (1.0 + force.length()), "{body:?}");
        }
        let at = |position| PairMotion { time: 0.0, mass: [mass, 2.0], position, velocity };
        // The spring pulls the first body towards the second: against the slope for the first, along it for the offset.
        if let Some(slope) = slope(&|x| pair.pair_potential(&at(x))) {
            let force = pair.on_pair(&at(position));
            prop_assert!((slope - force).length() < 1e-5 * (1.0 + force.length()), "{pair:?}");
        }
    }

    #[test]
    fn power_is_what_natures_and_potentials_say(
        body in on_body(), pair in on_pair(), position in vector(3.0), velocity in vector(3.0), mass in 0.1..5.0,
    ) {
        prop_assume!(position.length() > 0.3);
        let at = BodyMotion { time: 0.0, mass, position, velocity };
        let still = BodyMotion { velocity: DVec3::ZERO, ..at };
        let (force, held) = (body.on_body(&at), body.on_body(&still));
        say_the_truth(&body, velocity, force, held, body.body_potential(&at).is_some())?;
        let at = PairMotion { time: 0.0, mass: [mass, 2.0], position, velocity };
        let still = PairMotion { velocity: DVec3::ZERO, ..at };
        // The force on the first body does work by the opposite of the relative velocity.
        let (force, held) = (pair.on_pair(&at), pair.on_pair(&still));
        say_the_truth(&pair, -velocity, force, held, pair.pair_potential(&at).is_some())?;
    }
}

/// Compares what a force says with the forces on a moving and on a still body.
fn say_the_truth(
    law: &Force,
    velocity: DVec3,
    force: DVec3,
    held: DVec3,
    has_potential: bool,
) -> Result<(), TestCaseError> {
    let nature = law.nature();
    prop_assert!(nature.depends_on_velocity || force == held, "{law:?}");
    // A potential has all the work of the force that does not depend on the velocity.
    let rest = if has_potential { force - held } else { force };
    let (power, rounding) = (rest.dot(velocity), 1e-9 * (1.0 + force.length() * 10.0));
    prop_assert!(nature.dissipates || power > -rounding, "{law:?}: {power} W");
    prop_assert!(nature.drives || power < rounding, "{law:?}: {power} W");
    Ok(())
}

#[test]
fn every_kind_shows_what_it_acts_on() {
    let mut kinds = Vec::new();
    for force in &FORCES {
        let mut shown = force.clone();
        let (mut names, mut bodies) = (Vec::new(), Vec::new());
        let (mut point, mut points) = (None, None);
        shown.fields(|mut field| {
            names.push(field.name);
            bodies.extend_from_slice(field.value.bodies());
            match field.value {
                Value::Point(at) => point = Some(*at.insert(DVec3::X)),
                Value::Points(at) => points = Some(*at.insert([DVec3::X, DVec3::Y])),
                Value::Vector(at) if field.name == "point" => point = Some(*at),
                Value::Number { .. }
                | Value::Vector(_)
                | Value::Body(_)
                | Value::AnyBody(_)
                | Value::Bodies(_)
                | Value::AnyBodies(_) => {}
            }
        });
        assert_eq!(bodies, force.bodies().collect::<Vec<_>>(), "{force:?}");
        assert_eq!(
            (shown.point(), shown.points()),
            (point, points),
            "{force:?}"
        );
        assert_eq!(force.check(), Ok(()));
        kinds.push(force.kind());
        names.push("kind");
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count, "{force:?}");
    }
    kinds.sort_unstable();
    kinds.dedup();
    assert_eq!(kinds.len(), FORCES.len());
}

#[test]
fn every_number_of_every_kind_is_checked() {
    for force in &FORCES {
        let mut count = 0;
        force.clone().fields(|_| count += 1);
        for wrong in 0..count {
            for bad in [f64::NAN, f64::INFINITY, -1e101] {
                let (mut place, mut name) = (0, None);
                let mut changed = force.clone();
                changed.fields(|field| {
                    if place == wrong {
                        name = Some(field.name);
                        match field.value {
                            Value::Number { value, .. } => *value = bad,
                            Value::Vector(value) => value.y = bad,
                            Value::Point(point) => *point = Some(DVec3::new(0.0, bad, 0.0)),
                            Value::Points(points) => {
                                *points = Some([DVec3::ZERO, DVec3::splat(bad)])
                            }
                            Value::Body(_)
                            | Value::AnyBody(_)
                            | Value::Bodies(_)
                            | Value::AnyBodies(_) => name = None,
                        }
                    }
                    place += 1;
                });
                let found = changed.check().err().map(|error| error.field());
                assert_eq!(found, name, "{changed:?}");
            }
        }
    }
}

#[test]
fn a_number_of_either_sign_has_a_range_too() {
    let signed = |mut value: f64| {
        let about = ["charge", "Charge", "C", ""];
        Field::number(about, -Value::LARGEST, &mut value).check()
    };
    assert_eq!(signed(-1e100), Ok(()));
    let error = signed(-1e101).expect_err("too large");
    assert_eq!(error.field(), "charge");
    assert!(matches!(error, ForceError::Signed { .. }));
}

#[test]
fn springs_are_defined_where_they_have_no_direction() {
    let spring = |rest_length| Force::Spring {
        bodies: [0, 1],
        points: None,
        rest_length,
        stiffness: 2.0,
        damping: 3.0,
    };
    let at = PairMotion {
        time: 0.0,
        mass: [1.0, 1.0],
        position: DVec3::ZERO,
        velocity: DVec3::X,
    };
    for rest_length in [0.0, 1.0] {
        let force = spring(rest_length);
        assert_eq!(force.on_pair(&at), 3.0 * DVec3::X);
        assert_eq!(force.pair_jacobians(&at).velocity, 3.0 * DMat3::IDENTITY);
        assert_eq!(force.pair_jacobians(&at).position, 2.0 * DMat3::IDENTITY);
    }
}
