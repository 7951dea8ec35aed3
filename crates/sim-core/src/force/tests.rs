use alloc::vec::Vec;
use glam::{DMat3, DVec3};
use proptest::prelude::*;

use super::*;

fn vector(size: f64) -> impl Strategy<Value = DVec3> {
    [-size..size, -size..size, -size..size].prop_map(DVec3::from)
}

fn on_body() -> impl Strategy<Value = Force> {
    let positive = || 0.0..10.0;
    prop_oneof![
        positive().prop_map(|coefficient| Force::LinearDrag {
            body: None,
            coefficient
        }),
        positive().prop_map(|coefficient| Force::QuadraticDrag {
            body: None,
            coefficient
        }),
        (
            vector(1.0),
            prop_oneof![Just(0.0), 0.1..2.0],
            positive(),
            positive()
        )
            .prop_map(|(anchor, rest_length, stiffness, damping)| Force::Anchor {
                body: 0,
                point: None,
                anchor,
                rest_length,
                stiffness,
                damping
            }),
        (vector(1.0), positive()).prop_map(|(centre, strength)| Force::Attraction {
            body: None,
            centre,
            strength
        }),
    ]
}

fn on_pair() -> impl Strategy<Value = Force> {
    let positive = || 0.0..10.0;
    prop_oneof![
        (prop_oneof![Just(0.0), 0.1..2.0], positive(), positive()).prop_map(
            |(rest_length, stiffness, damping)| Force::Spring {
                bodies: [0, 1],
                points: None,
                rest_length,
                stiffness,
                damping
            }
        ),
        positive().prop_map(|constant| Force::Gravitation { constant }),
    ]
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
        if let Force::Anchor { anchor: centre, .. } | Force::Attraction { centre, .. } = force {
            prop_assume!(position.distance(centre) > 0.3);
        }
        prop_assume!(velocity.length() > 0.1);
        let numeric = laws::differences(position, velocity, |position, velocity| {
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
        let numeric = laws::differences(position, velocity, |position, velocity| {
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
        if let Force::Anchor { anchor: centre, .. } | Force::Attraction { centre, .. } = body {
            prop_assume!(position.distance(centre) > 0.3);
        }
        if let Some(slope) = slope(&|x| body.body_potential(&at(x))) {
            let force = body.on_body(&at(position));
            prop_assert!((slope + force).length() < 1e-5 * (1.0 + force.length()), "{body:?}");
        }
        let at = |position| PairMotion { time: 0.0, mass: [mass, 2.0], position, velocity };
        // The spring pulls the first body towards the second: against the slope for the first, along it for the offset.
        let slope = slope(&|x| pair.pair_potential(&at(x))).expect("pairs have a potential");
        let force = pair.on_pair(&at(position));
        prop_assert!((slope - force).length() < 1e-5 * (1.0 + force.length()), "{pair:?}");
    }
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
