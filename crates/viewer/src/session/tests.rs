use std::cell::Cell;
use std::path::Path;
use std::time::Duration;

use scene::Scene;
use sim_core::{BodyKind, Collision, DVec3, METHODS};

use super::{STEP_BUDGET, Session, State};

mod descent;
mod exact;
mod forces;
mod history;
mod import;
mod instant;
mod missed;
mod opening;
mod overlaps;
mod playback;
mod pull;
mod record;
mod shapes;
mod turning;
mod variants;
mod view;

const FRAME: Duration = Duration::from_millis(17);

/// Two cubes of edge 1 m: `mover` at x = -3 m moves towards `target` at the origin with 2 m/s.
fn session() -> Session {
    let text = r#"
        title = "Two cubes"
        rate = 60
        method = "symplectic-euler"
        [[body]]
        name = "mover"
        mesh = "cube.obj"
        position = [-3, 0, 0]
        velocity = [2, 0, 0]
        [[body]]
        name = "target"
        mesh = "cube.obj"
        mass = 3
    "#;
    let scene = Scene::parse(text, Path::new("two.toml")).expect("the text is a scene");
    Session::new(scene).expect("the scene makes a world")
}

/// A stopwatch that stands still: steps take no time.
fn free() -> impl Fn() -> Duration {
    || Duration::ZERO
}

/// A stopwatch that advances by `cost` at each reading: each step takes that long.
fn slow(cost: Duration) -> impl Fn() -> Duration {
    let time = Cell::new(Duration::ZERO);
    move || {
        time.set(time.get() + cost);
        time.get()
    }
}

/// A frame of the window: the due steps are taken at once.
fn advance(session: &mut Session, elapsed: Duration, stopwatch: impl Fn() -> Duration) {
    if let Some(job) = session.due(elapsed) {
        session.accept(job.run(stopwatch));
    }
}

fn positions(session: &Session) -> Vec<DVec3> {
    let world = session.world();
    (0..world.len()).map(|i| world.position(i)).collect()
}

fn complaint(session: &mut Session, about: &str) -> Option<String> {
    session
        .notices()
        .iter()
        .find(|notice| notice.about == about && notice.error)
        .map(|notice| notice.text.clone())
}

#[test]
fn begins_in_layout_and_stands_still_there() {
    let mut session = session();
    let before = positions(&session);
    advance(&mut session, Duration::from_secs(1), free());
    assert_eq!(session.state(), State::Layout);
    assert_eq!(positions(&session), before);
    session.pause();
    assert_eq!(session.state(), State::Layout);
}

#[test]
fn frames_of_any_length_take_the_steps_that_fit() {
    let mut session = session();
    session.start();
    let mut elapsed = Duration::ZERO;
    for ms in [17, 1, 40, 3, 90, 16, 33].into_iter().cycle().take(70) {
        let frame = Duration::from_millis(ms);
        advance(&mut session, frame, free());
        elapsed += frame;
    }
    let due = (elapsed.as_secs_f64() * 60.0).floor() as u64;
    assert_eq!(session.world().steps(), due);
    assert_eq!(session.figures().behind, Duration::ZERO);
}

#[test]
fn long_stall_is_dropped_and_told() {
    let mut session = session();
    session.start();
    advance(&mut session, Duration::from_secs(10), free());
    assert!(session.world().steps() <= 16, "caught up with the stall");
    let behind = session.figures().behind.as_secs_f64();
    let simulated = session.world().time();
    assert!((behind + simulated - 10.0).abs() < 2.0 / 60.0);
    assert!(session.figures().is_behind());
    for _ in 0..100 {
        advance(&mut session, FRAME, free());
    }
    assert!(!session.figures().is_behind(), "still told long after");
}

#[test]
fn slow_steps_leave_time_for_the_window() {
    let mut session = session();
    session.start();
    let cost = STEP_BUDGET * 2;
    for frame in 1..=10 {
        advance(&mut session, Duration::from_millis(200), slow(cost));
        assert_eq!(session.world().steps(), frame, "one step a frame");
    }
    let figures = session.figures();
    assert!(figures.is_behind());
    assert!(figures.behind > Duration::from_millis(1500));
    assert!((figures.cost.seconds().unwrap_or(0.0) - cost.as_secs_f64()).abs() < 1e-9);
    assert_eq!(figures.steps_per_frame, 1);
}

#[test]
fn window_goes_on_while_steps_are_under_way() {
    let mut session = session();
    session.start();
    let job = session.due(FRAME).expect("a step is due");
    assert!(session.awaits_steps());
    for _ in 0..5 {
        assert!(session.due(FRAME).is_none(), "one job at a time");
    }
    assert_eq!(session.figures().behind, FRAME * 5);
    assert_eq!(session.world().steps(), 0);
    session.accept(job.run(free()));
    assert_eq!(session.world().steps(), 1);
    assert!(session.due(FRAME).is_some());
}

#[test]
fn late_steps_do_not_undo_what_the_person_did() {
    type Act = fn(&mut Session);
    let acts: [Act; 6] = [
        Session::reset,
        Session::pause,
        |s| s.set_velocity(DVec3::Z),
        |s| s.set_collision(Collision::Naive),
        |s| s.open("two-cubes"),
        |s| {
            s.reset();
            s.start();
            assert!(s.due(FRAME).is_some());
        },
    ];
    for act in acts {
        let mut session = session();
        session.select(Some(0));
        session.start();
        let late = session.due(FRAME).expect("a step is due").run(free());
        act(&mut session);
        let (state, positions_then) = (session.state(), positions(&session));
        let velocity = session.world().velocity(0);
        session.accept(late);
        assert_eq!(session.state(), state);
        assert_eq!(session.world().steps(), 0);
        assert_eq!(positions(&session), positions_then);
        assert_eq!(session.world().velocity(0), velocity);
    }
}

#[test]
fn each_step_by_hand_is_one_step() {
    let mut session = session();
    session.step_once();
    advance(&mut session, Duration::from_secs(5), free());
    advance(&mut session, Duration::from_secs(5), free());
    assert_eq!(session.world().steps(), 1);
    session.start();
    advance(&mut session, Duration::from_millis(50), free());
    session.step_once();
    session.step_once();
    advance(&mut session, FRAME, free());
    // The picture continues from the state reached by single steps, so the next step is due at once.
    assert_eq!(session.world().steps(), 1 + (1 + 3) + 2);
    assert_eq!(session.state(), State::Paused);
}

#[test]
fn reset_returns_to_the_layout_in_every_order() {
    type Act = fn(&mut Session);
    let acts: [Act; 7] = [
        Session::start,
        Session::pause,
        |s| advance(s, Duration::from_millis(100), free()),
        |s| {
            s.step_once();
            advance(s, Duration::ZERO, free());
        },
        Session::toggle,
        |s| s.set_method(METHODS[3]),
        |s| s.set_rate(30.0),
    ];
    let layout = positions(&session());
    for a in acts {
        for b in acts {
            for c in acts {
                let mut session = session();
                for act in [a, b, c] {
                    act(&mut session);
                }
                session.reset();
                assert_eq!(session.state(), State::Layout);
                assert_eq!(positions(&session), layout);
                assert_eq!((session.world().steps(), session.world().time()), (0, 0.0));
                assert_eq!(session.world().impacts(), 0);
            }
        }
    }
}

#[test]
fn reset_forgets_edits_made_after_the_start() {
    let mut session = session();
    session.select(Some(0));
    session.start();
    advance(&mut session, Duration::from_millis(100), free());
    session.pause();
    session.set_position(DVec3::new(7.0, 8.0, 9.0));
    session.set_velocity(DVec3::Y);
    session.set_force(DVec3::Z);
    session.set_mass(9.0);
    assert_eq!(session.world().position(0), DVec3::new(7.0, 8.0, 9.0));
    session.start();
    advance(&mut session, FRAME, free());
    session.reset();
    let world = session.world();
    assert_eq!(world.position(0), DVec3::new(-3.0, 0.0, 0.0));
    assert_eq!(world.velocity(0), DVec3::new(2.0, 0.0, 0.0));
    assert_eq!((world.force(0), world.mass(0)), (DVec3::ZERO, 1.0));
    assert_eq!(session.selection(), Some(0), "the selection stays");
}

#[test]
fn reset_keeps_edits_of_the_layout() {
    let mut session = session();
    session.select(Some(1));
    session.set_position(DVec3::new(0.0, 5.0, 0.0));
    session.set_velocity(DVec3::X);
    session.set_mass(4.0);
    session.set_force(DVec3::Y);
    session.set_rotation(DVec3::new(0.0, 45.0, 0.0));
    session.set_scale(DVec3::splat(2.0));
    session.start();
    advance(&mut session, Duration::from_millis(200), free());
    session.reset();
    let body = &session.scene().bodies[1];
    assert_eq!(body.position, DVec3::new(0.0, 5.0, 0.0));
    assert_eq!(body.rotation.y, 45.0);
    let world = session.world();
    assert_eq!(world.position(1), body.position);
    assert_eq!((world.velocity(1), world.force(1)), (DVec3::X, DVec3::Y));
    assert_eq!(world.mass(1), 4.0);
    let width = world
        .mesh(1)
        .map(|m| m.bounds().half_extent().x)
        .unwrap_or(0.0);
    assert!((width - 2f64.sqrt()).abs() < 1e-6, "turned and scaled");
}

#[test]
fn reset_keeps_the_way_to_simulate() {
    let mut session = session();
    session.start();
    session.set_method(METHODS[3]);
    session.set_rate(120.0);
    session.set_collision(Collision::Naive);
    session.reset();
    let settings = session.world().settings();
    assert_eq!(settings.method.name, METHODS[3].name);
    assert_eq!(settings.dt, 1.0 / 120.0);
    assert_eq!(settings.collision, Collision::Naive);
}

#[test]
fn refused_values_change_nothing_and_are_explained() {
    let mut session = session();
    session.select(Some(0));
    for mass in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        session.set_mass(mass);
        let text = complaint(&mut session, "mass").expect("a message");
        assert!(text.contains("mover"), "{text}");
        assert_eq!(session.world().mass(0), 1.0);
        assert_eq!(session.scene().bodies[0].mass, 1.0);
    }
    session.set_position(DVec3::new(f64::NAN, 0.0, 0.0));
    session.set_velocity(DVec3::new(0.0, f64::INFINITY, 0.0));
    session.set_force(DVec3::splat(1e200));
    session.set_scale(DVec3::ZERO);
    session.set_rotation(DVec3::splat(f64::NAN));
    for about in ["velocity", "force", "scale", "rotation"] {
        assert!(complaint(&mut session, about).is_some(), "{about}");
    }
    let body = &session.scene().bodies[0];
    assert_eq!(body.position, DVec3::new(-3.0, 0.0, 0.0));
    assert_eq!((body.rotation, body.scale), (DVec3::ZERO, DVec3::ONE));
    session.set_mass(2.0);
    assert_eq!(complaint(&mut session, "mass"), None, "set right");
}

#[test]
fn senseless_rates_are_refused() {
    let mut session = session();
    for rate in [0.0, -60.0, 0.5, f64::NAN, f64::INFINITY, 1e6, 1e300] {
        session.set_rate(rate);
        assert!(complaint(&mut session, "settings").is_some(), "{rate}");
        assert_eq!(session.world().settings().dt, 1.0 / 60.0);
    }
    session.start();
    advance(&mut session, FRAME, free());
    assert_eq!(session.world().steps(), 1);
    for rate in [1.0, 1000.0, 100_000.0] {
        session.set_rate(rate);
        assert_eq!(session.world().settings().dt, 1.0 / rate);
        assert_eq!(complaint(&mut session, "settings"), None);
    }
}

#[test]
fn a_body_made_immovable_gets_its_mass_back() {
    let mut session = session();
    session.select(Some(1));
    session.set_immovable(true);
    assert_eq!(session.world().kind(1), BodyKind::Kinematic);
    session.set_immovable(false);
    assert_eq!(session.world().kind(1), BodyKind::Dynamic);
    assert_eq!(session.world().mass(1), 3.0);
}

#[test]
fn successes_go_by_themselves_and_failures_with_a_reset() {
    let mut session = session();
    session.select(Some(0));
    session.delete_selected();
    session.open("no such scene");
    assert_eq!(session.notices().iter().count(), 2);
    session.notices().pass(Duration::from_secs(4));
    assert!(session.notices().is_passing());
    session.notices().pass(Duration::from_secs(4));
    let left: Vec<&str> = session
        .notices()
        .iter()
        .map(|notice| notice.about)
        .collect();
    assert_eq!(left, ["open"]);
    session.reset();
    assert_eq!(session.notices().iter().count(), 0);
}

#[test]
fn the_set_up_changes_only_in_layout() {
    let mut session = session();
    session.select(Some(0));
    session.start();
    session.set_rotation(DVec3::splat(10.0));
    session.set_scale(DVec3::splat(2.0));
    session.delete_selected();
    session.duplicate_selected();
    assert_eq!(session.world().len(), 2);
    assert_eq!(session.scene().bodies[0].scale, DVec3::ONE);
    for about in ["rotation", "scale", "delete", "duplicate"] {
        assert!(complaint(&mut session, about).is_some(), "{about}");
    }
}

#[test]
fn bodies_can_be_copied_and_deleted_to_the_last() {
    let mut session = session();
    session.select(Some(0));
    session.duplicate_selected();
    assert_eq!(session.world().len(), 3);
    assert_eq!(session.selection(), Some(2));
    assert_eq!(session.scene().bodies[2].name, "mover 2");
    assert!(session.world().overlapping().is_empty());
    for _ in 0..3 {
        session.select(Some(0));
        session.delete_selected();
    }
    assert!(session.world().is_empty());
    session.frame();
    session.pick(DVec3::Z, DVec3::NEG_Z);
    session.start();
    advance(&mut session, FRAME, free());
    assert!(session.picture().models.is_empty());
    assert_eq!(session.bvh_depth(), 0);
    session.reset();
    assert_eq!(session.state(), State::Layout);
}

#[test]
fn ray_picks_the_nearest_body() {
    let mut session = session();
    let from = DVec3::new(-10.0, 0.1, 0.2);
    session.pick(from, DVec3::X);
    assert_eq!(session.selection(), Some(0));
    session.pick(-from, DVec3::NEG_X);
    assert_eq!(session.selection(), Some(1));
    session.pick(from, DVec3::Y);
    assert_eq!(session.selection(), None);
    session.pick(DVec3::NAN, DVec3::NAN);
    assert_eq!(session.selection(), None);
}

#[test]
fn velocity_arrow_of_the_selected_body_is_blue_and_outside() {
    let mut session = session();
    assert!(session.picture().arrows.is_empty());
    session.select(Some(1));
    assert!(session.picture().arrows.is_empty(), "it is at rest");
    session.select(Some(0));
    let picture = session.picture();
    let [arrow] = picture.arrows[..] else {
        panic!("{} arrows", picture.arrows.len());
    };
    assert!(arrow.colour[2] > 0.8 && arrow.colour[0] < 0.3);
    assert!((arrow.from.x - -2.5).abs() < 1e-6, "at the cube's face");
    assert!((arrow.to - arrow.from - DVec3::X).length() < 1e-9);
    let selected: Vec<bool> = picture.models.iter().map(|m| m.selected).collect();
    assert_eq!(selected, [true, false]);
}

#[test]
fn picture_lies_between_the_last_two_states_while_running() {
    let mut session = session();
    session.start();
    advance(&mut session, Duration::from_millis(25), free());
    let world = session.world();
    let (before, after) = (world.previous_position(0).x, world.position(0).x);
    let drawn = session.picture().models[0].position.x;
    assert!(before < drawn && drawn < after);
    session.pause();
    assert_eq!(session.picture().models[0].position.x, drawn, "held there");
    session.go_to(usize::MAX);
    assert_eq!(session.picture().models[0].position.x, after);
}

#[test]
fn boxes_follow_the_chosen_bodies_and_depths() {
    let mut session = session();
    session.display.bvh.shown = true;
    session.display.bvh.depth = 0;
    assert_eq!(session.picture().lines.len(), 24, "none is selected");
    session.select(Some(0));
    assert_eq!(session.picture().lines.len(), 12);
    session.display.bvh.every_body = true;
    assert_eq!(session.picture().lines.len(), 24);
    session.display.bvh.every_depth = true;
    assert!(session.picture().lines.len() > 24);
    session.display.bvh.every_depth = false;
    session.display.bvh.depth = usize::MAX;
    assert!(!session.picture().lines.is_empty(), "the deepest there is");
}

#[test]
fn drift_counts_errors_and_not_what_forces_do() {
    let mut session = session();
    session.select(Some(0));
    session.set_force(DVec3::new(0.0, -1.0, 0.0));
    session.set_method(METHODS[3]);
    session.start();
    for _ in 0..20 {
        advance(&mut session, FRAME, free());
    }
    let drift = session.drift();
    assert!(drift.energy.is_some_and(|change| change.abs() < 1e-12));
    assert!(drift.momentum.is_some_and(|change| change < 1e-12));
    assert!(session.path_error().is_some_and(|away| away < 1e-12));
    session.reset();
    session.set_method(METHODS[0]);
    session.start();
    for _ in 0..20 {
        advance(&mut session, FRAME, free());
    }
    let change = session.drift().energy;
    assert!(
        change.is_some_and(|change| change.abs() > 1e-4),
        "forward Euler errs"
    );
    // Forward Euler omits a half of F/m dt in each of its steps.
    let world = session.world();
    let missed = 0.5 * world.time() / 60.0;
    let away = session.path_error().unwrap_or(f64::NAN);
    assert!((away - missed).abs() < 1e-12, "{away} instead of {missed}");
}

#[test]
fn opens_imports_and_saves() {
    let folder = std::env::temp_dir().join(format!("cowbell-session-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for temporary files");
    let mesh = folder.join("tetra.obj");
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    std::fs::write(&mesh, text).expect("a file");

    let mut session = session();
    session.start();
    session.take_in(&mesh);
    assert_eq!(session.state(), State::Layout);
    assert_eq!(session.world().len(), 3);
    assert_eq!(session.selected().map(|b| b.name.as_str()), Some("tetra"));
    assert!(session.world().overlapping().is_empty());

    let file = folder.join("saved");
    session.save(&file, false);
    assert_eq!(complaint(&mut session, "save"), None);
    session.save(&file, false);
    assert_eq!(complaint(&mut session, "save"), None, "its own file");

    let mut other = self::session();
    let saved = file.with_extension("toml");
    other.save(&saved, false);
    assert!(complaint(&mut other, "save").is_some(), "not its file");
    other.take_in(&saved);
    assert_eq!(complaint(&mut other, "open"), None);
    assert_eq!(positions(&other), positions(&session));

    other.open("no such scene");
    assert!(complaint(&mut other, "open").is_some());
    other.take_in(Path::new("no such mesh.obj"));
    assert!(complaint(&mut other, "import").is_some());
    assert_eq!(
        positions(&other),
        positions(&session),
        "the old scene stays"
    );
    std::fs::remove_dir_all(&folder).expect("the folder is removed");
}

#[test]
fn a_scene_holds_once_where_it_ends() {
    let text =
        "rate = 7\nends = 1\n[[body]]\nname = 'stone'\nvelocity = [1, 0, 0]\nmesh = 'cube.obj'";
    let scene = Scene::parse(text, Path::new("end.toml")).expect("the text is a scene");
    let mut session = Session::new(scene).expect("a world");
    let go_on = |session: &mut Session| {
        (0..200).for_each(|_| advance(session, FRAME, free()));
    };
    session.start();
    go_on(&mut session);
    assert_eq!(
        (session.state(), session.world().steps()),
        (State::Paused, 7)
    );
    assert!(!session.is_between(), "its last state is in the picture");
    let told = session
        .notices()
        .iter()
        .any(|notice| notice.text.contains("ends here, at 1 s"));
    assert!(told);
    session.start();
    go_on(&mut session);
    assert_eq!(session.state(), State::Running);
    assert!(session.world().time() > 3.0);
    session.reset();
    session.start();
    go_on(&mut session);
    assert_eq!(session.world().steps(), 7, "and again after a reset");
}
