//! The implicit surface.

use cow::model::Model;
use glam::Vec3;

/// Points all over a box around the cow, m, in a fixed irregular order.
fn points() -> impl Iterator<Item = Vec3> {
    // Multiples of irrational numbers fill the unit cube evenly.
    (1..20_000).map(|i| {
        let unit = Vec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5) * i as f32;
        Vec3::new(-1.47, -0.02, -0.42) + unit.fract() * Vec3::new(2.55, 1.75, 0.84)
    })
}

#[test]
fn left_and_right_are_the_same() {
    let cow = Model::cow();
    for p in points() {
        assert_eq!(cow.distance(p), cow.distance(p * Vec3::new(1.0, 1.0, -1.0)));
    }
}

#[test]
fn parts_near_a_point_make_the_surface_near_it() {
    let cow = Model::cow();
    let reach = 0.03;
    let mut compared = 0;
    for (p, q) in points().zip(points().skip(7)) {
        let other = p + (q - p).normalize() * reach;
        let distance = cow.distance(other);
        if distance.abs() < 0.02 {
            assert_eq!(cow.near(p, reach).distance(other), distance, "at {other}");
            compared += 1;
        }
    }
    assert!(compared > 200, "only {compared} points near the surface");
}

#[test]
fn the_cow_stands_on_the_ground() {
    let cow = Model::cow();
    for hoof in [Vec3::new(-0.55, 0.0, 0.14), Vec3::new(0.69, 0.0, 0.21)] {
        assert!(cow.distance(hoof + Vec3::Y * 0.01) < 0.0);
        assert!(cow.distance(hoof - Vec3::Y * 0.01) > 0.0);
    }
}
