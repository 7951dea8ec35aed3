//! The descent that is shown level by level.

use super::*;
use crate::session::{Contest, Leaving, stop};

fn cow() -> Session {
    let mut session =
        Session::new(Scene::load("cube-cow").expect("in the gallery")).expect("a world");
    session.select(Some(1));
    session
}

#[test]
fn boxes_apart_take_one_comparison() {
    let mut session = cow();
    let levels = session.descent();
    assert_eq!(
        (levels.len(), levels[0].compared, levels[0].meeting),
        (1, 1, 0)
    );
}

#[test]
fn the_last_level_has_the_leaves_that_the_query_tests() {
    let mut session = cow();
    // Moves the body into the cow.
    session.set_position(session.world().position(0) + DVec3::new(0.0, 0.5, 0.0));
    let levels = session.descent();
    assert!(levels.len() > 3 && levels[0].meeting == 1);
    for pair in levels.windows(2) {
        assert!(pair[1].compared >= pair[0].meeting.min(1));
        // Up to four children against up to four children.
        assert!(pair[1].compared <= 16 * pair[0].meeting);
    }
    let all: usize = levels.iter().map(|level| level.compared).sum();
    let (a, b) = (session.world().mesh(0), session.world().mesh(1));
    let naive = a.map_or(0, |m| m.triangles().len()) * b.map_or(0, |m| m.triangles().len());
    assert!(all < naive / 10, "{all} of {naive}");
    let plain = session.picture().lines.len();
    for level in 0..levels.len() {
        session.step_descent(1);
        assert_eq!(session.display.descent, Some(level));
        assert!(session.picture().lines.len() > plain);
    }
    session.step_descent(1);
    assert_eq!(session.display.descent, Some(levels.len() - 1), "it ends");
    session.step_descent(-1);
    assert_eq!(session.display.descent, Some(levels.len() - 2));
}

#[test]
fn the_descent_pair_by_pair_compares_what_the_levels_do() {
    let mut session = cow();
    assert_eq!(session.pairs().len(), 1, "apart");
    session.set_position(session.world().position(0) + DVec3::new(0.0, 0.5, 0.0));
    let (levels, pairs) = (session.descent(), session.pairs());
    let compared: usize = levels.iter().map(|level| level.compared).sum();
    let meeting: usize = levels.iter().map(|level| level.meeting).sum();
    assert_eq!(pairs.len(), compared);
    assert_eq!(pairs.iter().filter(|pair| pair.meet).count(), meeting);
    // If two boxes meet, the next comparison is between their children.
    let first = pairs.first().expect("one");
    assert!(first.meet && first.below > 0);
    let plain = session.picture().lines.len();
    session.step_pair(1);
    assert_eq!(session.picture().lines.len(), plain + 24, "two boxes");
    (0..pairs.len() + 5).for_each(|_| session.step_pair(1));
    assert_eq!(session.display.pair, Some(pairs.len() - 1), "it ends");
    session.step_descent(-1);
    assert_eq!(session.display.pair, None, "level by level again");
}

#[test]
fn what_turns_is_compared_as_it_is_turned() {
    let scene = Scene::load("cube-cow-spin").expect("in the gallery");
    let mut session = Session::new(scene).expect("a world");
    assert_eq!(session.contest(), Contest::Apart(0, 1));
    session.select(Some(1));
    session.set_position(session.world().position(0) + DVec3::new(0.0, 0.5, 0.0));
    assert_eq!(session.contest(), Contest::Pair(0, 1));
    session.compare.on = true;
    let trial = session.trial_due(FRAME).expect("it is due");
    session.accept_trial(trial.run(slow(Duration::from_millis(1))));
    let last = session.compare.last().expect("a figure");
    assert!(last.meet && last.agree && last.naive.is_some());
    assert!(!session.wants_trial(), "nothing has moved");
    let levels = session.descent();
    assert!(levels.len() > 3 && levels.last().is_some_and(|level| level.meeting > 0));
    // A rotation by 90 degrees about the body's own centre moves no centre but changes the question.
    session.set_rotation(DVec3::new(20.0, 30.0, 130.0));
    assert!(session.wants_trial());
}

#[test]
fn the_tour_has_a_descent_to_go_down() {
    let mut session = cow();
    let titled = |number: &usize| stop(*number).is_some_and(|(_, s)| s.title == "Why the BVH wins");
    let stop = (0..).find(titled).expect("it is in the tour");
    session.leave(Leaving::Tour { stop, attempt: 0 });
    let levels = session.descent();
    assert!(levels.len() > 3, "{levels:?}");
    assert!(session.world().overlapping().is_empty());
}
