//! Bodies that turn: drawn as they are, kept, edited and run again.

use super::*;
use crate::session::{Record, verify};
use sim_core::DQuat;

/// A flat box about its middle axis, and a cow beside it whose origin is not its centre of mass.
fn turning() -> Session {
    let text = "rate = 60
        [[body]]
        name = 'box'
        mesh = 'cube.obj'
        scale = [1, 0.2, 0.5]
        turns = true
        spin = [0.001, 0, 5]
        [[body]]
        name = 'cow'
        mesh = 'cow.obj'
        position = [5, 1, 0]
        rotation = [0, 90, 0]
        turns = true
        spin = [0, 0, 2]
    ";
    let scene = Scene::parse(text, Path::new("turning.toml")).expect("the text is a scene");
    Session::new(scene).expect("the scene makes a world")
}

fn poses(session: &Session) -> Vec<(DVec3, DQuat)> {
    let world = session.world();
    (0..world.len())
        .map(|i| (world.origin(i), world.rotation(i)))
        .collect()
}

fn go_on(session: &mut Session, frames: u32) {
    for _ in 0..frames {
        advance(session, FRAME, free());
    }
}

#[test]
fn bodies_are_drawn_as_they_are_turned_and_states_keep_it() {
    let mut session = turning();
    let start = poses(&session);
    let near = |a: DVec3, b: DVec3| assert!(a.distance(b) < 1e-9, "{a} is not {b}");
    session.start();
    go_on(&mut session, 30);
    session.display.between = false;
    let now = poses(&session);
    assert!(now[0].1.angle_between(start[0].1) > 0.1);
    let picture = session.picture();
    for (model, &(place, rotation)) in picture.models.iter().zip(&now) {
        near(model.position, place);
        assert!(model.rotation.angle_between(rotation) < 1e-7);
    }
    // The box around it is that of its corners as they are turned.
    let bounds = session.bounds(0);
    let mesh = session.world().mesh(0).expect("a mesh").clone();
    let corners = mesh.vertices().iter().map(|v| now[0].1 * v.as_dvec3());
    near(corners.fold(DVec3::ZERO, DVec3::max), bounds.half);
    // A ray meets the turned surface: along the long axis, just inside its end.
    let end = now[0].0 + now[0].1 * DVec3::new(0.499, 0.0, 0.0);
    let hit = session.hit(end + 9.0 * DVec3::Z, DVec3::NEG_Z);
    assert_eq!(hit.map(|(_, i)| i), Some(0));
    session.go_to(0);
    assert_eq!(poses(&session), start);
}

#[test]
fn turning_is_switched_and_set() {
    let mut session = turning();
    session.select(Some(1));
    session.set_position(DVec3::new(6.0, 1.0, 0.0));
    assert!(
        session
            .world()
            .origin(1)
            .distance(DVec3::new(6.0, 1.0, 0.0))
            < 1e-12
    );
    session.set_mass(3.0);
    session.set_immovable(true);
    assert!(!session.world().kind(1).is_movable());
    session.set_immovable(false);
    assert_eq!(session.world().mass(1), 3.0);
    session.set_turns(false);
    assert!(!session.world().turns(1));
    session.set_turns(true);
    session.set_spin(DVec3::new(0.0, 3.0, 0.0));
    assert!(session.world().spin(1).distance(DVec3::new(0.0, 3.0, 0.0)) < 1e-12);
    let turn = session.scene().bodies[1].turn.expect("it turns");
    assert_eq!(turn.spin, DVec3::new(0.0, 3.0, 0.0));
    session.reset();
    assert!(session.world().spin(1).distance(turn.spin) < 1e-12);
}

#[test]
fn a_spin_that_is_set_is_recorded() {
    let mut session = turning();
    session.select(Some(0));
    session.start();
    go_on(&mut session, 10);
    session.set_spin(DVec3::new(1.0, 2.0, 3.0));
    go_on(&mut session, 10);
    let path = std::env::temp_dir().join(format!("cowbell-spin-{}.run", std::process::id()));
    let text = session.record().text_at(&path).expect("it has a text");
    std::fs::write(&path, text).expect("written");
    let record = Record::read(&path);
    std::fs::remove_file(&path).expect("removed");
    let record = record.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(record.inputs, session.record().inputs);
    let verdict = verify(record, |_| true).expect("it runs");
    assert_eq!(verdict.divergence, None);
}

#[test]
fn discrete_modes_turn_too() {
    let mut session = turning();
    session.set_collision(Collision::Bvh);
    session.start();
    go_on(&mut session, 3);
    assert_eq!(session.state(), State::Running);
    assert_eq!(complaint(&mut session, "step"), None);
    assert!(session.world().rotation(0).angle_between(DQuat::IDENTITY) > 0.1);
}
