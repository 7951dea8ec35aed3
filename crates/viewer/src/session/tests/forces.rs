//! Tests forces, how they are drawn, and what is measured during a run.

use std::path::Path;
use std::time::Duration;

use scene::Scene;
use sim_core::{DVec3, Force, Method};

use super::super::{Contest, Remedy, Session, State};
use super::{FRAME, advance, complaint, free, positions, session, slow};

/// A gallery scene.
fn gallery(name: &str) -> Session {
    Session::new(Scene::load(name).expect("a gallery scene")).expect("a world")
}

#[test]
fn naive_and_bvh_are_compared_near_and_apart_and_only_on_request() {
    let mut session = session();
    assert!(session.trial_due(FRAME).is_none(), "off by default");
    session.compare.on = true;
    assert_eq!(session.contest(), Contest::Apart(0, 1));
    let trial = session.trial_due(FRAME).expect("apart, it costs as well");
    session.accept_trial(trial.run(slow(Duration::from_millis(1))));
    let apart = *session.compare.last().expect("a figure");
    assert!(!apart.meet && apart.naive.is_some_and(|cost| cost.tests == 2 * 18 * 12));

    session.select(Some(0));
    session.set_position(DVec3::new(-0.75, 0.75, 0.0));
    assert_eq!(session.contest(), Contest::Pair(0, 1));
    let trial = session.trial_due(Duration::from_secs(9));
    let trial = trial.expect("a trial is due");
    assert!(session.trial_due(FRAME).is_none(), "one at a time");
    session.accept_trial(trial.run(slow(Duration::from_millis(1))));
    let last = *session.compare.last().expect("a figure");
    assert!(last.meet && last.pair == (0, 1));
    let naive = last.naive.expect("cubes are small");
    assert!(naive.tests > 0 && last.tree.boxes > 0 && last.tree.seconds > 0.0);

    assert!(!session.wants_trial(), "nothing has moved");
    session.set_position(DVec3::new(-0.7, 0.7, 0.0));
    assert!(session.wants_trial());
    assert!(session.trial_due(FRAME).is_none(), "it rests first");
    let late = session.trial_due(Duration::from_secs(9)).expect("rested");
    session.reset();
    session.accept_trial(late.run(free()));
    assert_eq!(session.compare.last(), None, "of before the reset");
}

#[test]
fn a_blow_up_pauses_names_its_cause_and_selects_the_body() {
    let mut session = gallery("stiff-spring");
    session.set_method(Method::named("rk4").expect("a method"));
    session.start();
    for _ in 0..60 {
        advance(&mut session, FRAME, free());
    }
    assert_eq!(session.state(), State::Paused);
    assert_eq!(session.selection(), Some(0));
    let text = complaint(&mut session, "step").expect("a message");
    for part in ["`cube`", "RK4", "2.6225e-3 s"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    // 1 / 2.6225e-3 s is 381.3 Hz.
    let remedy = session.notices().iter().find_map(|notice| notice.remedy);
    assert_eq!(remedy, Some(Remedy::Rate(390.0)));
    assert!(positions(&session).iter().all(|at| at.is_finite()));
    session.reset();
    assert_eq!(session.state(), State::Layout);
    assert_eq!(complaint(&mut session, "step"), None);
    assert_eq!(session.world().position(0), DVec3::Y);
}

#[test]
fn forces_are_edited_in_the_layout_and_for_a_while_later() {
    let mut session = session();
    let gravity = Force::Gravity {
        acceleration: DVec3::NEG_Y,
    };
    session.add_force(gravity.clone());
    session.add_force(Force::Gravitation { constant: 2.0 });
    session.replace_force(1, Force::Gravitation { constant: 3.0 });
    assert_eq!(session.scene().forces, session.world().forces());
    session.replace_force(1, Force::Gravitation { constant: -1.0 });
    let text = complaint(&mut session, "forces").expect("a message");
    assert!(text.contains("constant is -1"), "{text}");
    let kept = [gravity, Force::Gravitation { constant: 3.0 }];
    assert_eq!(session.world().forces(), kept);

    session.start();
    advance(&mut session, FRAME, free());
    session.pause();
    session.remove_force(0);
    session.remove_force(7);
    assert!(complaint(&mut session, "forces").is_some());
    assert_eq!(session.world().forces().len(), 1);
    session.reset();
    assert_eq!(session.world().forces(), kept);
}

#[test]
fn deleting_a_body_takes_the_forces_that_name_it_along() {
    let mut session = session();
    let anchor = |body| Force::Anchor {
        body,
        point: None,
        anchor: DVec3::ZERO,
        rest_length: 0.0,
        stiffness: 1.0,
        damping: 0.0,
    };
    session.add_force(anchor(0));
    session.add_force(anchor(1));
    session.add_force(Force::Spring {
        bodies: [1, 0],
        points: None,
        rest_length: 3.0,
        stiffness: 1.0,
        damping: 0.0,
    });
    session.add_force(Force::Gravitation { constant: 1.0 });
    session.select(Some(0));
    session.delete_selected();
    let left = [anchor(0), Force::Gravitation { constant: 1.0 }];
    assert_eq!(session.scene().forces, left);
    assert_eq!(session.world().forces(), left);
    let told = session
        .notices()
        .iter()
        .any(|n| n.text.contains("2 forces"));
    assert!(told, "the person is told");
}

#[test]
fn drift_knows_potentials_and_claims_no_more() {
    let mut spring = gallery("spring");
    spring.set_method(Method::named("dop853").expect("a method"));
    spring.start();
    for _ in 0..100 {
        advance(&mut spring, FRAME, free());
        // Also close to a turning point.
        let drift = spring.drift();
        assert!(
            drift
                .relative_energy
                .is_some_and(|change| change.abs() < 1e-7)
        );
        assert_eq!(drift.momentum, None);
        assert!(spring.path_error().is_some_and(|away| away < 1e-6));
        assert!(!drift.dissipates);
    }
    let mut fall = session();
    fall.add_force(Force::Gravity {
        acceleration: DVec3::new(0.0, -9.81, 0.0),
    });
    fall.set_method(Method::named("rk4").expect("a method"));
    fall.start();
    for _ in 0..20 {
        advance(&mut fall, FRAME, free());
    }
    let drift = fall.drift();
    assert!(drift.energy.is_some_and(|change| change.abs() < 1e-12));
    assert!(drift.momentum.is_some_and(|change| change < 1e-12));
    assert!(fall.path_error().is_some_and(|away| away < 1e-12));
    let mut drag = gallery("drag");
    drag.start();
    advance(&mut drag, FRAME, free());
    let drift = drag.drift();
    assert!(drift.dissipates && drift.momentum.is_none());
}

/// A weight on a spring attached to an immovable body.
fn weight_at(anchor: &str, method: &str) -> Session {
    let text = format!(
        "rate = 60
        method = '{method}'
        [[body]]
        name = 'hook'
        sphere = 0
        {anchor}
        [[body]]
        name = 'weight'
        sphere = 0
        position = [1, 0, 0]
        [[force]]
        kind = 'spring'
        bodies = ['hook', 'weight']
        stiffness = 8"
    );
    let scene = Scene::parse(&text, Path::new("hook.toml")).expect("the text is a scene");
    let mut session = Session::new(scene).expect("the scene makes a world");
    session.start();
    for _ in 0..300 {
        advance(&mut session, FRAME, free());
    }
    session
}

#[test]
fn drift_tells_what_is_wrong_from_what_drives() {
    // The wall absorbs the momentum of the weight.
    let still = weight_at("immovable = true", "rk4").drift();
    assert_eq!((still.momentum, still.relative_momentum), (None, None));
    assert!(still.energy_is_error());
    assert!(
        still
            .relative_energy
            .is_some_and(|drift| drift.abs() < 1e-3)
    );
    // A moving hook pulls the weight along and adds energy.
    let moving = weight_at("immovable = true\nvelocity = [1, 0, 0]", "rk4").drift();
    assert!(moving.driven && !moving.energy_is_error());
    // Between free bodies momentum is conserved, whatever the energy does. Bodies at rest have no momentum as a scale,
    // so only the absolute error is known.
    let blown = weight_at("", "forward-euler").drift();
    assert!(
        blown.relative_energy.is_some_and(|drift| drift > 2.0),
        "{blown:?}"
    );
    assert!(blown.energy_is_error() && !blown.dissipates && !blown.driven);
    assert!(
        blown.momentum.is_some_and(|error| error < 1e-12),
        "{blown:?}"
    );
    assert_eq!(blown.relative_momentum, None);
}

#[test]
fn trails_are_kept_for_scenes_with_forces_and_bounded() {
    assert!(!session().display.trails);
    let mut session = gallery("kepler");
    assert!(session.display.trails);
    session.start();
    for _ in 0..100 {
        advance(&mut session, Duration::from_millis(200), free());
    }
    assert!(session.world().steps() > 1000);
    assert_eq!(session.trails.len(), 2 * 600);
    let with = session.picture().lines.len();
    assert!(with > 500, "{with}");
    session.show_trails(false);
    assert!(session.picture().lines.len() < 10);
    assert_eq!(session.trails.len(), 0);
    session.show_trails(true);
    session.reset();
    assert_eq!(session.trails.len(), 2, "they begin anew");
}

#[test]
fn trails_go_back_as_far_however_short_the_steps_are() {
    let mut session = gallery("kepler");
    let long = |session: &mut Session| {
        let lines = session.picture().lines;
        lines
            .iter()
            .map(|line| line.from.distance(line.to))
            .sum::<f64>()
    };
    let mut lengths = Vec::new();
    for rate in [60.0, 1000.0, 4000.0] {
        session.reset();
        session.set_rate(rate);
        session.start();
        for _ in 0..300 {
            advance(&mut session, FRAME, free());
        }
        assert!(session.trails.len() <= 2 * 601, "{}", session.trails.len());
        lengths.push(long(&mut session));
    }
    // The same ellipse for 5 s; more than 600 steps make no difference.
    for length in &lengths {
        assert!((length / lengths[0] - 1.0).abs() < 0.02, "{lengths:?}");
    }
}

#[test]
fn what_is_at_rest_is_told_and_grey_where_that_is_wished() {
    let mut session = gallery("bounce");
    session.start();
    for _ in 0..400 {
        advance(&mut session, FRAME, free());
    }
    let world = session.world();
    let resting: Vec<usize> = (0..world.len())
        .filter(|&i| session.is_at_rest(i))
        .collect();
    assert_eq!(resting.len(), 1, "the ball, not the floor");
    let before = session.picture().models[0].colour;
    session.display.rest = true;
    let after = session.picture().models[0].colour;
    let spread =
        |c: [f32; 3]| c.into_iter().fold(0.0, f32::max) - c.into_iter().fold(1.0, f32::min);
    assert!(spread(after) < 0.3 * spread(before), "{before:?} {after:?}");
    session.reset();
    session.start();
    advance(&mut session, FRAME, free());
    assert_eq!(session.picture().models[0].colour, before, "it flies");
}

#[test]
fn specks_are_dots_that_can_be_picked() {
    let mut session = gallery("pleiades");
    session.show_trails(false);
    assert_eq!(session.picture().lines.len(), 7);
    let at = session.world().position(3);
    let eye = at + DVec3::new(0.05, 0.05, 20.0);
    session.pick(eye, DVec3::NEG_Z);
    assert_eq!(session.selection(), Some(3));
    session.pick(eye + DVec3::X, DVec3::NEG_Z);
    assert_eq!(session.selection(), None);
}

#[test]
fn depth_steps_stay_within_the_tree() {
    let mut session = gallery("cube-cow");
    session.step_depth(1);
    assert_eq!(session.display.bvh.depth, 3, "no boxes are shown");
    session.display.bvh.shown = true;
    let deepest = session.bvh_depth() - 1;
    for _ in 0..40 {
        session.step_depth(1);
    }
    assert_eq!(session.display.bvh.depth, deepest);
    for _ in 0..40 {
        session.step_depth(-1);
    }
    assert_eq!(session.display.bvh.depth, 0);
}
