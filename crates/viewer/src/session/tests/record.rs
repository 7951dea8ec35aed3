//! Recorded runs and their replays.

use super::*;
use crate::session::{Record, verify};
use sim_core::Force;

/// A run with an input of each kind.
fn eventful() -> Session {
    let mut session = session();
    session.select(Some(0));
    // In the layout state, where it is part of the scene.
    session.set_velocity(DVec3::new(3.0, 0.1, 0.0));
    session.start();
    let go_on = |session: &mut Session| {
        for _ in 0..10 {
            advance(session, FRAME, free());
        }
    };
    go_on(&mut session);
    session.set_velocity(DVec3::new(2.0, 0.2, 0.0));
    go_on(&mut session);
    session.set_immovable(true);
    session.set_mass(2.5);
    go_on(&mut session);
    session.set_rate(90.0);
    session.set_restitution(0.5);
    go_on(&mut session);
    session.add_force(Force::Gravity {
        acceleration: DVec3::new(0.0, -1.0, 0.0),
    });
    session.set_friction(0.25);
    go_on(&mut session);
    session.select(Some(1));
    session.set_position(DVec3::new(0.5, 0.0, 0.1));
    session.set_force(DVec3::X);
    session.separate();
    go_on(&mut session);
    session.set_collision(Collision::Bvh);
    go_on(&mut session);
    session
}

fn again(session: &Session) -> Record {
    let path = std::env::temp_dir().join(format!("cowbell-record-{}.run", std::process::id()));
    let text = session.record().text_at(&path).expect("it has a text");
    std::fs::write(&path, text).expect("written");
    let record = Record::read(&path);
    std::fs::remove_file(&path).expect("removed");
    record.unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_run_with_inputs_of_all_kinds_gives_the_same_states_again() {
    let session = eventful();
    let record = again(&session);
    assert_eq!(record.steps(), session.world().steps());
    assert_eq!(record.inputs, session.record().inputs);
    assert!(record.inputs.len() >= 10, "{}", record.inputs.len());
    let verdict = verify(record, |_| true).expect("it runs");
    assert_eq!(verdict.divergence, None);
    assert_eq!(verdict.world.state_hash(), session.world().state_hash());
}

#[test]
fn the_window_replays_it_and_holds_at_its_end() {
    let original = eventful();
    let mut session = Session::replaying(again(&original)).expect("a world");
    session.start();
    for _ in 0..400 {
        advance(&mut session, FRAME, free());
        if session.state() == State::Paused {
            break;
        }
    }
    assert_eq!(session.world().steps(), original.world().steps());
    assert_eq!(session.world().state_hash(), original.world().state_hash());
    assert_eq!(session.divergence(), None);
    assert!(
        session
            .notices()
            .iter()
            .any(|n| n.text.contains("same states"))
    );
    assert!(!session.is_changed(), "a replay is no edit");
}

#[test]
fn a_divergence_is_told_at_its_step() {
    let mut record = again(&eventful());
    record.hashes[17] ^= 1;
    let verdict = verify(record.clone(), |_| true).expect("it runs");
    assert_eq!(verdict.divergence.map(|d| d.step), Some(17));
    let mut session = Session::replaying(record).expect("a world");
    session.start();
    for _ in 0..60 {
        advance(&mut session, FRAME, free());
    }
    let divergence = *session.divergence().expect("it is found");
    assert_eq!(divergence.step, 17);
    let text = complaint(&mut session, "replay").expect("it is told");
    assert!(text.contains("step 17"), "{text}");
    // An edit turns the replay into a run of its own.
    session.select(Some(0));
    session.set_velocity(DVec3::Y);
    assert!(session.replay().is_none());
}

#[test]
fn going_back_and_on_in_another_way_records_the_other_way() {
    let mut session = session();
    session.start();
    for _ in 0..60 {
        advance(&mut session, FRAME, free());
    }
    session.go_to(20);
    session.select(Some(0));
    session.set_velocity(DVec3::new(1.0, 0.0, 0.5));
    session.start();
    for _ in 0..30 {
        advance(&mut session, FRAME, free());
    }
    let record = again(&session);
    assert_eq!(record.steps(), session.world().steps());
    assert_eq!(record.inputs.len(), 1);
    assert_eq!(record.inputs[0].0, 20);
    let verdict = verify(record, |_| true).expect("it runs");
    assert_eq!(verdict.divergence, None);
}
