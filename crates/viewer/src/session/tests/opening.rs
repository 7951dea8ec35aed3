//! The view of a scene just opened, and the places of added bodies.

use super::*;
use crate::session::Leaving;
use scene::SceneShape;

fn gallery(name: &str, collision: Collision) -> Session {
    let mut scene = Scene::load(name).expect("a gallery scene");
    scene.collision = collision;
    Session::new(scene).expect("a world")
}

#[test]
fn looking_ahead_is_a_job_that_ends_in_time_and_shows_more() {
    let mut session = gallery("herd", Collision::Naive);
    let before = session.camera;
    let outlook = session.outlook().expect("gravity acts");
    assert!(session.outlook().is_none(), "once");
    // A step takes longer than the whole budget.
    let seen = outlook.run(slow(Duration::from_secs(2)));
    session.accept_outlook(&seen);
    assert_ne!(session.camera, before);
    assert_eq!(session.world().steps(), 0);
}

#[test]
fn the_person_keeps_the_view_that_they_have_turned_to() {
    let mut session = gallery("kepler", Collision::Continuous);
    let outlook = session.outlook().expect("a centre attracts");
    session.camera.orbit(0.3, 0.0);
    let turned = session.camera;
    session.accept_outlook(&outlook.run(free()));
    assert_eq!(session.camera, turned);

    let mut session = gallery("kepler", Collision::Continuous);
    let late = session.outlook().expect("a centre attracts");
    session.open("spring");
    let other = session.camera;
    session.accept_outlook(&late.run(free()));
    assert_eq!(session.camera, other, "of the scene before");
}

#[test]
fn what_a_stop_of_the_tour_sets_going_stays_in_view() {
    for (number, attempt) in [(0, 0), (0, 1), (2, 0), (2, 1), (5, 0)] {
        let mut session = session();
        session.leave(Leaving::Tour {
            stop: number,
            attempt,
        });
        advance(&mut session, FRAME, free());
        session.look_ahead(|| false);
        for _ in 0..600 {
            advance(&mut session, FRAME, free());
            let out = session.out_of_view(1.4);
            assert!(out.is_empty(), "{number}.{attempt}: {out:?}");
            if session.state() == State::Paused {
                break;
            }
        }
    }
}

#[test]
fn nothing_leaves_the_view_before_its_scene_ends() {
    let mut seen = 0;
    for entry in scene::SCENES {
        let scene = Scene::load(entry.name).expect("in the gallery");
        let Some(ends) = scene.ends else { continue };
        let mut session = Session::new(scene).expect("a world");
        session.look_ahead(|| false);
        session.start();
        while session.state() == State::Running {
            advance(&mut session, Duration::from_millis(100), free());
            let (time, out) = (session.shown_time(), session.out_of_view(1.4));
            assert!(
                out.is_empty(),
                "{} at {time} of {ends}: {out:?}",
                entry.name
            );
        }
        seen += 1;
    }
    assert!(seen >= 12);
}

#[test]
fn what_a_spring_pulls_down_comes_to_rest_in_view() {
    let mut session = gallery("stiff-spring", Collision::Continuous);
    session.look_ahead(|| false);
    session.start();
    (0..60).for_each(|_| advance(&mut session, FRAME, free()));
    let [middle, below] = [0.0, 0.5].map(|down| session.shown_position(0) - down * DVec3::Y);
    for point in [middle, below] {
        let place = session.camera.project(point, 1.4).expect("before the eye");
        assert!(place.iter().all(|part| part.abs() < 0.95), "{place:?}");
    }
}

#[test]
fn a_high_rate_looks_ahead_as_far() {
    let view = |rate: f64| {
        let mut scene = Scene::load("kepler").expect("a gallery scene");
        scene.dt = 1.0 / rate;
        let mut session = Session::new(scene).expect("a world");
        session.look_ahead(|| false);
        session.camera.distance
    };
    let (slow, fast) = (view(100.0), view(1000.0));
    assert!((fast / slow - 1.0).abs() < 0.05, "{fast} beside {slow}");
}

#[test]
fn a_new_floor_lies_right_under_what_is_there() {
    for name in ["cube-cow", "two-cubes"] {
        let mut session = gallery(name, Collision::Continuous);
        session.add("floor", SceneShape::HalfSpace { normal: DVec3::Y });
        let floor = session.world().len() - 1;
        let at = session.world().position(floor);
        assert!(session.world().overlapping().is_empty(), "{name}");
        assert!([at.x, at.z].iter().all(|part| part.to_bits() == 0), "{at}");
        let lowest = (0..floor)
            .map(|i| {
                session.world().position(i).y + session.bounds(i).centre.y
                    - session.bounds(i).half.y
            })
            .fold(f64::INFINITY, f64::min);
        let gap = lowest - at.y;
        assert!((0.0..1e-6).contains(&gap) || at.y == 0.0, "{name}: {gap}");
    }
}
