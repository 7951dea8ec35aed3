//! Spheres, half-spaces, immovable bodies and impacts.

use super::*;
use crate::session::Contest;

/// A ball of radius 0.5 m at rest at the origin, a ball that moves towards it along x with 2 m/s, and a floor 1 m
/// below.
fn balls() -> Session {
    let text = "rate = 60
        collision = 'bvh'
        [[body]]
        name = 'floor'
        half-space = [0, 2, 0]
        position = [1e6, -1, 0]
        [[body]]
        name = 'ball'
        sphere = 0.5
        [[body]]
        name = 'mover'
        sphere = 0.5
        position = [-3, 0, 0]
        velocity = [2, 0, 0]
        restitution = 0.5
    ";
    let scene = Scene::parse(text, Path::new("balls.toml")).expect("the text is a scene");
    Session::new(scene).expect("the scene makes a world")
}

#[test]
fn rays_pick_spheres_and_pass_half_spaces() {
    let mut session = balls();
    for (from, direction, expected) in [
        (DVec3::new(-10.0, 0.3, 0.0), DVec3::X, Some(2)),
        (DVec3::new(10.0, 0.3, 0.0), DVec3::NEG_X, Some(1)),
        (DVec3::new(10.0, 0.3, 0.0), DVec3::X, None),
        (DVec3::new(-10.0, 0.6, 0.0), DVec3::X, None),
        (DVec3::new(0.0, 1e7, 0.499), DVec3::NEG_Y * 1e-3, Some(1)),
        (DVec3::new(0.0, 1e7, 0.501), DVec3::NEG_Y * 1e-3, None),
        (DVec3::ZERO, DVec3::Y, Some(1)),
        (DVec3::new(0.0, 9.0, 5.0), DVec3::NEG_Y, None),
    ] {
        session.pick(from, direction);
        assert_eq!(session.selection(), expected, "{from} {direction}");
    }
    session.select(Some(0));
    assert_eq!(session.selected().map(|b| b.name.as_str()), Some("floor"));
}

#[test]
fn half_spaces_do_not_blow_up_the_view() {
    let mut session = balls();
    assert!(session.camera.distance < 20.0);
    session.camera.distance = 1e5;
    session.frame();
    assert!(session.camera.distance < 20.0);
    session.select(Some(0));
    session.frame();
    assert!(
        session.camera.distance < 20.0,
        "the part of it that is drawn"
    );
    let top = session.top(session.selection().expect("selected"));
    assert!(top.length() < 10.0, "{top}");
    session.duplicate_selected();
    assert_eq!(session.world().len(), 4);
    for name in ["ball", "mover"] {
        let i = session.scene().bodies.iter().position(|b| b.name == name);
        session.select(i);
        session.delete_selected();
    }
    session.frame();
    assert!(session.camera.distance.is_finite());
    assert!(session.picture().models.is_empty());
}

#[test]
fn spheres_share_a_mesh_and_half_spaces_are_lines_on_their_front() {
    let mut session = balls();
    let picture = session.picture();
    let [ball, mover] = &picture.models[..] else {
        panic!("{} models", picture.models.len());
    };
    assert!(std::sync::Arc::ptr_eq(&ball.mesh, &mover.mesh));
    let on_floor = |session: &mut Session| {
        let lines = session.picture().lines;
        assert!(lines.iter().all(|line| (line.from.y + 1.0).abs() < 1e-9));
        lines.len()
    };
    assert!(on_floor(&mut session) > 10, "a grid");
    session.camera.orbit(0.0, -1.5);
    assert_eq!(on_floor(&mut session), 4, "an outline from below");
}

#[test]
fn a_closed_box_is_drawn_as_a_box() {
    let text = "rate = 60\n".to_owned()
        + &[
            [1, 0, 0],
            [-1, 0, 0],
            [0, 1, 0],
            [0, -1, 0],
            [0, 0, 1],
            [0, 0, -1],
        ]
        .map(|n| {
            let at = n.map(|part| -2 * part);
            format!("[[body]]\nname = '{n:?}'\nhalf-space = {n:?}\nposition = {at:?}\n")
        })
        .concat()
        + "[[body]]\nname = 'ball'\nsphere = 1";
    let scene = Scene::parse(&text, Path::new("box.toml")).expect("the text is a scene");
    let mut session = Session::new(scene).expect("the scene makes a world");
    let lines = session.picture().lines;
    assert!(lines.len() > 24, "{}", lines.len());
    for line in &lines {
        for end in [line.from, line.to] {
            assert!(end.abs().max_element() < 2.0 + 1e-9, "{end}");
        }
    }
}

#[test]
fn impacts_are_listed_while_they_are_shown() {
    let mut session = balls();
    session.start();
    for _ in 0..70 {
        advance(&mut session, FRAME, free());
    }
    assert_eq!(session.world().impacts(), 1);
    let picture = session.picture();
    let impact = session.world().last_impact().expect("one").clone();
    assert_eq!(impact.speeds, (2.0, 1.0));
    assert!(!picture.marks.is_empty());
    assert_eq!(picture.marks[0].from, impact.point);
    for _ in 0..60 {
        advance(&mut session, FRAME, free());
    }
    assert!(session.picture().marks.is_empty(), "it has faded");
    session.reset();
    session.display.impacts = false;
    session.start();
    for _ in 0..70 {
        advance(&mut session, FRAME, free());
    }
    assert_eq!(session.world().impacts(), 1);
    assert!(session.picture().marks.is_empty());
}

#[test]
fn energy_and_momentum_are_judged_by_what_was_hit() {
    let mut session = balls();
    session.start();
    advance(&mut session, FRAME, free());
    assert_eq!(session.drift().momentum, Some(0.0));
    assert!(!session.drift().dissipates, "nothing has met");
    for _ in 0..80 {
        advance(&mut session, FRAME, free());
    }
    let drift = session.drift();
    assert_eq!(drift.momentum, None, "a floor is there");
    assert!(drift.dissipates);
    // Half of the approach speed remains, so 3/4 of the energy of the relative motion is lost, and that is half of all.
    let change = drift.relative_energy.expect("a number");
    assert!((change + 0.375).abs() < 1e-12, "{change}");
}

#[test]
fn friction_may_take_energy_only_between_two_rough_bodies() {
    for (rough, expected) in [(&[][..], false), (&[1], false), (&[1, 2], true)] {
        let mut session = balls();
        session.select(Some(2));
        session.set_restitution(1.0);
        for &i in rough {
            session.select(Some(i));
            session.set_friction(0.5);
        }
        session.start();
        advance(&mut session, FRAME, free());
        assert!(!session.drift().dissipates, "nothing has met");
        for _ in 0..80 {
            advance(&mut session, FRAME, free());
        }
        assert_eq!(session.world().impacts(), 1);
        assert_eq!(session.drift().dissipates, expected, "{rough:?}");
    }
}

#[test]
fn immovable_bodies_are_made_and_unmade() {
    let mut session = balls();
    session.select(Some(1));
    session.set_immovable(true);
    session.set_restitution(0.25);
    session.set_restitution(1.5);
    assert!(complaint(&mut session, "restitution").is_some());
    let body = &session.scene().bodies[1];
    assert_eq!((body.immovable, body.restitution), (true, 0.25));
    session.start();
    for _ in 0..120 {
        advance(&mut session, FRAME, free());
    }
    assert_eq!(session.world().position(1), DVec3::ZERO);
    assert_eq!(session.world().velocity(2), DVec3::new(-0.5, 0.0, 0.0));
    session.reset();
    session.set_shape(scene::SceneShape::Sphere { radius: -1.0 });
    assert!(complaint(&mut session, "shape").is_some());
    session.set_shape(scene::SceneShape::Sphere { radius: 0.25 });
    assert_eq!(complaint(&mut session, "shape"), None);
    assert_eq!(session.contest(), Contest::NoPair, "no meshes to compare");
}

#[test]
fn friction_is_edited_and_kept_as_restitution_is() {
    let mut session = balls();
    session.select(Some(1));
    session.set_friction(0.3);
    for bad in [-0.1, f64::NAN] {
        session.set_friction(bad);
        assert!(complaint(&mut session, "friction").is_some(), "{bad}");
    }
    session.set_friction(f64::INFINITY);
    assert_eq!(complaint(&mut session, "friction"), None);
    session.set_friction(0.3);
    // The world is made again, with another shape and a copy of the body.
    session.set_shape(scene::SceneShape::Sphere { radius: 0.25 });
    session.duplicate_selected();
    let friction = |session: &Session| [0, 1, 2, 3].map(|i| session.world().friction(i));
    assert_eq!(friction(&session), [0.0, 0.3, 0.0, 0.3]);
    // Once physics has begun, an edit lasts until the reset.
    session.start();
    advance(&mut session, FRAME, free());
    session.set_friction(2.0);
    assert_eq!(friction(&session), [0.0, 0.3, 0.0, 2.0]);
    session.reset();
    assert_eq!(friction(&session), [0.0, 0.3, 0.0, 0.3]);
    assert_eq!(session.scene().bodies[3].friction, 0.3);
}

#[test]
fn shapes_are_added_where_nothing_is() {
    let mut session = balls();
    session.start();
    session.add("sphere", scene::SceneShape::Sphere { radius: 2.0 });
    assert_eq!(session.state(), State::Layout);
    for normal in [DVec3::Y, DVec3::NEG_X, DVec3::new(1.0, 2.0, 3.0)] {
        session.add("floor", scene::SceneShape::HalfSpace { normal });
    }
    assert_eq!(session.world().len(), 7);
    assert_eq!(session.selected().map(|b| b.name.as_str()), Some("floor 4"));
    let pairs = session.world().overlapping();
    // The sphere extends deeper than the old floor.
    assert_eq!(pairs, [(0, 3)]);
}
