//! Forces that every world refuses.

use cases::hard_cases::stiff_spring;
use kit::worlds::step;
use sim_core::{DVec3, Force, Settings, WorldError};

use crate::worlds::method;

#[test]
fn forces_out_of_range_are_refused_by_field_and_disturb_nothing() {
    let world = stiff_spring::world(method("backward-euler"), 1.0 / 60.0);
    let mut world = world.expect("a world");
    let before = world.forces().to_vec();
    for bad in [f64::NAN, f64::INFINITY, -1.0, 1e101] {
        let anchor = |anchor, rest_length, stiffness, damping| Force::Anchor {
            body: 0,
            point: None,
            anchor,
            rest_length,
            stiffness,
            damping,
        };
        let forces = [
            ("stiffness", anchor(DVec3::ZERO, 0.0, bad, 0.0)),
            ("damping", anchor(DVec3::ZERO, 0.0, 1.0, bad)),
            ("rest_length", anchor(DVec3::ZERO, bad, 1.0, 0.0)),
            ("anchor", anchor((bad * 1e101) * DVec3::Y, 0.0, 1.0, 0.0)),
            (
                "coefficient",
                Force::LinearDrag {
                    body: None,
                    coefficient: bad,
                },
            ),
            (
                "coefficient",
                Force::QuadraticDrag {
                    body: Some(0),
                    coefficient: bad,
                },
            ),
            (
                "strength",
                Force::Attraction {
                    body: None,
                    centre: DVec3::ZERO,
                    strength: bad,
                },
            ),
            ("constant", Force::Gravitation { constant: bad }),
            (
                "acceleration",
                Force::Gravity {
                    acceleration: (bad * 1e101) * DVec3::Z,
                },
            ),
        ];
        for (field, force) in forces {
            for refused in [
                world.add_force(force.clone()).map(|_| ()),
                world.replace_force(0, force.clone()),
            ] {
                let Err(WorldError::Force { error, .. }) = refused else {
                    panic!("{field} {bad} is taken");
                };
                assert_eq!(error.field(), field);
            }
        }
    }
    let spring = |i, j| Force::Spring {
        bodies: [i, j],
        points: None,
        rest_length: 0.0,
        stiffness: 1.0,
        damping: 0.0,
    };
    assert!(matches!(
        world.add_force(spring(0, 1)),
        Err(WorldError::NoBody { body: 1, bodies: 1 })
    ));
    assert!(matches!(
        world.add_force(spring(0, 0)),
        Err(WorldError::Force { .. })
    ));
    assert!(matches!(
        world.remove_force(2),
        Err(WorldError::NoForce {
            index: 2,
            forces: 2
        })
    ));
    for tolerance in [0.0, -1.0, f64::NAN, 2.0] {
        let settings = Settings {
            tolerance,
            ..*world.settings()
        };
        assert!(world.set_settings(settings).is_err());
    }
    assert_eq!(world.forces(), before);
    step(&mut world, 1);
}
