//! Contacts at the borders of faces and at the start: blocking ones and passing ones.

use super::moving_oracle::assert_rounded_down;
use super::moving_oracle::inputs::lattice_vector;
use kit::meshes::{builtin, scaled};
use kit::rational::{Q, rational};
use proptest::prelude::*;
use sim_core::collide::touch::{first_touch, time_of_impact};
use sim_core::collide::{Feature, tree};
use sim_core::{Bvh, DQuat, DVec3, Mesh};

#[test]
fn what_touches_at_the_start_touches_at_once_or_parts() {
    let cube = builtin("cube.obj");
    let bvh = |m: &Mesh| Bvh::build(m);
    let diamond = |axis| {
        let turn = DQuat::from_axis_angle(axis, std::f64::consts::FRAC_PI_4);
        // Edges in front, rounded to the same distance in every direction.
        cube.transformed(turn, DVec3::splat(std::f64::consts::FRAC_1_SQRT_2))
            .expect("a mesh")
    };
    let (along_z, along_y) = (diamond(DVec3::Z), diamond(DVec3::Y));
    let reach = f64::from(along_z.bounds().max.x);
    let bar = |scale| bvh(&scaled(&cube, scale));
    let x = DVec3::X;
    let cases = [
        ("faces", bvh(&cube), bvh(&cube), x),
        (
            "overhanging faces",
            bvh(&cube),
            bvh(&cube),
            DVec3::new(1.0, 0.25, -0.5),
        ),
        (
            "crossed bars",
            bar(DVec3::new(1.0, 4.0, 1.0)),
            bar(DVec3::new(1.0, 1.0, 4.0)),
            x,
        ),
        (
            "crossed edges",
            bvh(&along_z),
            bvh(&along_y),
            x * (2.0 * reach),
        ),
        (
            "an edge on a face",
            bvh(&along_z),
            bvh(&cube),
            x * (reach + 0.5),
        ),
        (
            "a face on an edge",
            bvh(&cube),
            bvh(&along_y),
            x * (reach + 0.5),
        ),
    ];
    for (what, first, second, offset) in &cases {
        assert!(tree::intersect(first, second, *offset), "{what}");
        for motion in [-x, DVec3::new(-1.0, 0.3, 0.2)] {
            for (first, second, sign) in [(first, second, 1.0), (second, first, -1.0)] {
                let (offset, motion) = (sign * *offset, sign * motion);
                let touch = first_touch(first, second, offset, motion).expect(what);
                assert_eq!(
                    (touch.time, touch.normal),
                    (0.0, sign * x),
                    "{what} {motion}"
                );
                assert_eq!(time_of_impact(first, second, offset, motion), Some(0.0));
                let apart = offset + sign * x;
                let touch = first_touch(first, second, apart, motion - sign * x).expect(what);
                assert_eq!(touch.normal, sign * x, "{what} from afar");
            }
        }
        for motion in [
            x,
            0.25 * DVec3::Y,
            DVec3::ZERO,
            DVec3::new(1e-12, 0.0, 0.25),
        ] {
            assert_eq!(first_touch(first, second, *offset, motion), None, "{what}");
            assert_eq!(
                first_touch(second, first, -*offset, -motion),
                None,
                "{what}"
            );
            assert_eq!(time_of_impact(first, second, *offset, motion), Some(0.0));
        }
    }
}

/// Motion along a face has a contact but no entering one; just past the face there is none.
#[test]
fn sliding_is_an_impact_and_no_contact() {
    let cube = Bvh::build(&builtin("cube.obj"));
    let (from, along) = (DVec3::new(1.0, 3.0, 0.0), DVec3::new(0.0, -4.0, 0.0));
    assert_eq!(time_of_impact(&cube, &cube, from, along), Some(0.5));
    let wall = scaled(&builtin("cube.obj"), DVec3::new(1.0, 8.0, 8.0));
    assert_eq!(first_touch(&Bvh::build(&wall), &cube, from, along), None);
    let beside = DVec3::new(1.0_f64.next_up(), 3.0, 0.0);
    assert_eq!(time_of_impact(&cube, &cube, beside, along), None);
    let within = DVec3::new(1.0 - f64::EPSILON, 3.0, 0.0);
    let touch = first_touch(&cube, &cube, within, along).expect("in the way");
    assert!(matches!(
        touch.feature,
        Feature::FaceVertex { .. } | Feature::VertexFace { .. }
    ));
    assert_eq!((touch.time, touch.normal), (0.5, DVec3::Y));
}

/// The time at which the interiors of two boxes with these half extents begin to overlap, and along which axes.
fn boxes_overlap(reach: DVec3, offset: DVec3, motion: DVec3) -> Option<(Q, Vec<usize>)> {
    let zero = || rational(0.0);
    let (mut enter, mut leave, mut axes) = (None, None, vec![]);
    for axis in 0..3 {
        let [r, o, m] = [reach, offset, motion].map(|v| rational(v[axis]));
        if m == zero() {
            if o >= r || o <= -&r {
                return None;
            }
            continue;
        }
        let ends = [(-&r - &o) / &m, (&r - &o) / &m];
        let (from, to) = (
            ends[0].clone().min(ends[1].clone()),
            ends[0].clone().max(ends[1].clone()),
        );
        if enter.as_ref().is_none_or(|known| from > *known) {
            (enter, axes) = (Some(from), vec![axis]);
        } else if enter.as_ref() == Some(&from) {
            axes.push(axis);
        }
        leave = Some(leave.map_or(to.clone(), |known: Q| known.min(to)));
    }
    let (enter, leave) = enter.zip(leave)?;
    (enter < leave && enter <= rational(1.0) && leave > zero()).then_some((enter, axes))
}

/// The smallest gap that placed vertices represent.
const HAIR: f64 = 1.0 / (1_u64 << 40) as f64;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Boxes that mostly touch block each other only if their interiors would overlap.
    #[test]
    fn boxes_slip_past_each_other(
        sizes in prop::array::uniform3((1..=2i32, 1..=2i32)),
        cells in lattice_vector(3),
        way in prop_oneof![lattice_vector(3), lattice_vector(6).prop_map(|v| 2.0 * v)],
        nudge in prop_oneof![4 => Just(0.0), 1 => Just(1e-9), 1 => Just(-1e-9)],
        hair in prop_oneof![4 => Just(0.0), 1 => Just(HAIR), 1 => Just(-HAIR)],
    ) {
        let cube = builtin("cube.obj");
        let size = |of: fn((i32, i32)) -> i32| DVec3::from_array(sizes.map(|s| f64::from(of(s))));
        let (one, other) = (size(|s| s.0), size(|s| s.1));
        let [a, b] = [one, other].map(|s| Bvh::build(&scaled(&cube, s)));
        let offset = 0.5 * cells + DVec3::X * hair;
        let motion = way + DVec3::new(nudge, 0.0, 0.0);
        let overlap = boxes_overlap(0.5 * (one + other), offset, motion);
        let touch = first_touch(&a, &b, offset, motion);
        match overlap {
            // They overlap from the start.
            Some((time, _)) if time < rational(0.0) => {}
            None => prop_assert_eq!(touch, None),
            Some((time, axes)) => {
                assert_rounded_down(touch.map(|t| t.time), Some(time))?;
                let normal = touch.expect("a touch").normal;
                let fits = |&axis: &usize| normal == DVec3::AXES[axis] * -motion[axis].signum();
                prop_assert!(axes.iter().any(fits), "{normal} {axes:?}");
            }
        }
    }
}

/// Cubes with coplanar faces, side by side and passing each other.
#[test]
fn flush_cubes_slide_past_each_other() {
    let cube = Bvh::build(&builtin("cube.obj"));
    let touch = |offset, motion| first_touch(&cube, &cube, offset, motion);
    let v = DVec3::new;
    for z in [0.0, 0.25, 1.0, -1.0] {
        for (from, motion) in [
            (v(1.0, -3.0, z), v(0.0, 4.0, 0.0)),
            (v(1.0, -3.0, z), v(1e-9, 4.0, 0.0)),
            (v(1.0, -1.0, z), v(0.0, 1.0, 0.0)),
            (v(1.0, 0.0, z), v(0.0, 1.0, 0.0)),
            (v(1.0_f64.next_up(), -3.0, z), v(0.0, 4.0, 0.0)),
        ] {
            assert_eq!(touch(from, motion), None, "{from} {motion}");
        }
    }
    let pressed = touch(v(1.0, 0.0, 0.0), v(-1e-9, 1.0, 0.0)).expect("pressed on");
    assert_eq!((pressed.time, pressed.normal), (0.0, DVec3::X));
    // Slightly within the path of the other one.
    let ahead = touch(v(1.0, -3.0, 0.0), v(-1e-9, 4.0, 0.0)).expect("in the way");
    assert_eq!((ahead.time, ahead.normal), (0.5, DVec3::NEG_Y));
}
