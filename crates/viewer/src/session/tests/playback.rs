//! Going back, continuing, and slow motion.

use super::*;

/// A session that has run for so many frames of one step each.
fn run(frames: usize) -> Session {
    let mut session = session();
    session.start();
    for _ in 0..frames {
        advance(&mut session, FRAME, free());
    }
    session
}

#[test]
fn every_state_can_be_gone_back_to() {
    let mut session = run(100);
    let steps = session.world().steps() as usize;
    let hash = session.world().state_hash();
    let last = positions(&session);
    assert_eq!(session.playback().len(), steps + 1);
    session.go_to(0);
    assert_eq!(session.state(), State::Paused);
    assert_eq!((session.world().steps(), session.world().impacts()), (0, 0));
    session.step_back();
    assert_eq!(session.world().steps(), 0, "there is nothing before");
    session.go_to(7);
    session.step_back();
    assert_eq!(session.world().steps(), 6);
    session.step_once();
    assert_eq!(session.world().steps(), 7);
    assert!(session.due(FRAME).is_none(), "it was kept");
    session.go_to(usize::MAX);
    assert_eq!(session.world().state_hash(), hash);
    assert_eq!(positions(&session), last);
}

#[test]
fn going_on_from_the_past_gives_the_same_bits() {
    let mut session = run(100);
    let (steps, hash) = (session.world().steps(), session.world().state_hash());
    session.go_to(20);
    session.start();
    while session.world().steps() < steps {
        advance(&mut session, FRAME, free());
    }
    assert_eq!(session.world().state_hash(), hash);
    assert_eq!(session.playback().len() as u64, steps + 1);
}

#[test]
fn an_edit_in_the_past_leaves_no_future() {
    let mut session = run(50);
    session.go_to(20);
    session.select(Some(0));
    session.set_velocity(DVec3::Y);
    assert_eq!(session.playback().len(), 1);
    session.step_once();
    advance(&mut session, FRAME, free());
    assert_eq!(session.world().steps(), 21);
    assert_eq!(session.world().velocity(0), DVec3::Y);
    session.reset();
    assert_eq!((session.playback().len(), session.world().steps()), (1, 0));
}

#[test]
fn the_ring_forgets_the_oldest() {
    let mut session = session();
    session.set_rate(1000.0);
    session.start();
    for _ in 0..400 {
        advance(&mut session, FRAME, free());
    }
    let (kept, most) = (session.playback().len(), session.playback().capacity());
    assert_eq!(kept, most);
    assert!(session.world().steps() as usize > most);
    session.go_to(0);
    let first = session.world().steps();
    assert!(first > 0);
    let [begin, end] = session.playback().span();
    assert!(begin == session.world().time() && begin < end);
}

#[test]
fn the_line_of_time_knows_impacts_and_the_nearest_state() {
    let session = run(100);
    let playback = session.playback();
    let times: Vec<f64> = playback.impact_times().collect();
    // The gap of 2 m closes at 2 m/s.
    assert!(
        matches!(times[..], [time] if (time - 1.0).abs() < 1e-9),
        "{times:?}"
    );
    assert_eq!(playback.nearest(-1.0), 0);
    assert_eq!(playback.nearest(3.4 / 60.0), 3);
    assert_eq!(playback.nearest(3.6 / 60.0), 4);
    assert_eq!(playback.nearest(1e9), playback.len() - 1);
}

#[test]
fn speed_is_simulated_time_over_real_time() {
    for (speed, steps) in [(0.1, 12), (1.0, 120), (10.0, 1200)] {
        let mut session = session();
        session.set_speed(speed);
        session.start();
        for _ in 0..20 {
            advance(&mut session, Duration::from_millis(100), free());
        }
        assert_eq!(session.world().steps(), steps, "{speed}");
        assert_eq!(session.figures().behind, Duration::ZERO);
    }
    let mut session = session();
    for (wish, got) in [(0.0, 1e-3), (1e9, 10.0), (f64::NAN, 10.0)] {
        session.set_speed(wish);
        assert_eq!(session.speed(), got);
    }
}
