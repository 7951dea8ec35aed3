//! Running, comparing, and what is made of a run.

use egui::Key;
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use sim_core::{Collision, Method};
use viewer::session::State;

use crate::{Window, click, go_on, opened};

#[test]
fn the_bar_starts_steps_resets_and_takes_back() {
    let mut window = opened("cube-cow");
    window.run();
    click(&mut window, "▶ Start");
    assert_eq!(window.state().1.state(), State::Running);
    go_on(&mut window, 0.5);
    click(&mut window, "⏸ Pause");
    let steps = window.state().1.world().steps();
    assert!(steps > 20);
    click(&mut window, "⏩ Step");
    go_on(&mut window, 0.1);
    assert_eq!(window.state().1.world().steps(), steps + 1);
    click(&mut window, "⟲ Reset");
    assert_eq!(window.state().1.state(), State::Layout);
    click(&mut window, "floor");
    assert_eq!(window.state().1.world().len(), 3);
    click(&mut window, "⮪");
    assert_eq!(window.state().1.world().len(), 2);
    click(&mut window, "⮫");
    assert_eq!(window.state().1.world().len(), 3);
}

#[test]
fn a_comparison_is_chosen_run_and_given_up() {
    let mut window = opened("five-hertz");
    window.run();
    click(&mut window, "Compare…");
    click(&mut window, "The four methods of the course");
    assert_eq!(window.state().1.variants().iter().len(), 4);
    click(&mut window, "▶ Start");
    go_on(&mut window, 4.1);
    click(&mut window, "⏸ Pause");
    let names = ["⏺ Backward Euler", "⏺ Classical RK4", "⏺ Exact"];
    for name in names {
        assert!(window.query_by_label(name).is_some(), "{name}");
    }
    for plot in ["Momentum", "Step cost", "Contacts", "Speed against error"] {
        click(&mut window, plot);
    }
    click(&mut window, "Compare nothing");
    assert!(window.state().1.variants().is_empty());
}

#[test]
fn the_next_variant_is_run_as_the_scene_is() {
    let mut window = opened("five-hertz");
    window.run();
    // The rate of the scene and that of the variant.
    let shown = |window: &Window<'_>, rate: &str| {
        let fields = window.query_all_by_role(Role::SpinButton);
        let fields = fields.filter(|node| node.value().as_deref() == Some(rate));
        fields.count()
    };
    assert_eq!(shown(&window, "5 Hz"), 2);
    window.state_mut().1.open("two-cubes");
    window.run();
    assert_eq!((shown(&window, "5 Hz"), shown(&window, "60 Hz")), (0, 2));
}

#[test]
fn what_went_wrong_is_set_right_by_a_button() {
    let mut window = opened("bullet");
    window.run();
    window.state_mut().1.set_collision(Collision::Bvh);
    click(&mut window, "▶ Start");
    go_on(&mut window, 0.5);
    click(&mut window, "⏸ Pause");
    click(&mut window, "Reset, and look within the step");
    let session = &window.state().1;
    assert_eq!(session.world().settings().collision, Collision::Continuous);
    assert_eq!(session.state(), State::Layout);

    let mut window = opened("stiff-spring");
    window.run();
    let explicit = Method::named("forward-euler").expect("it is in the table");
    window.state_mut().1.set_method(explicit);
    click(&mut window, "▶ Start");
    go_on(&mut window, 10.0);
    assert_eq!(window.state().1.state(), State::Paused, "it has blown up");
    let before = window.state().1.world().settings().dt;
    click(&mut window, "Reset, and step at 1,000 Hz");
    let after = window.state().1.world().settings().dt;
    assert!(after < before && (after - 1e-3).abs() < 1e-15, "{after}");
}

#[test]
fn keys_go_from_impact_to_impact_and_draw_the_picture() {
    let mut window = opened("cube-cow");
    window.run();
    click(&mut window, "▶ Start");
    go_on(&mut window, 1.5);
    click(&mut window, "⏸ Pause");
    for key in [Key::U, Key::I] {
        window
            .state_mut()
            .1
            .go_to(if key == Key::U { usize::MAX } else { 0 });
        window.key_press(key);
        window.run();
        let session = &window.state().1;
        let impact = session.playback().impact_times().next().expect("one");
        assert!((session.shown_time() - impact).abs() < 1e-9, "{key:?}");
    }
    assert!(window.query_by_label_contains("within a step").is_some());
    window.key_press(Key::F12);
    window.run();
    let session = &mut window.state_mut().1;
    let still = session.shooting_due().expect("a picture is wanted");
    assert_eq!(still.pictures.len(), 1);
    assert!(
        still.size[0] > 300 && still.size[1] > 100,
        "{:?}",
        still.size
    );
    session.accept_shooting(Ok(None));
}

#[test]
fn a_film_is_made_of_what_is_kept_and_can_be_given_up() {
    let mut window = opened("cube-cow");
    window.run();
    click(&mut window, "GIF");
    assert!(
        window.state_mut().1.shooting_due().is_none(),
        "nothing has run"
    );
    window.state_mut().1.notices().clear();
    click(&mut window, "▶ Start");
    go_on(&mut window, 1.0);
    click(&mut window, "GIF");
    let (_, session) = window.state_mut();
    let time = session.shown_time();
    let film = session.shooting_due().expect("a film is wanted");
    assert!(
        (24..=26).contains(&film.pictures.len()),
        "{}",
        film.pictures.len()
    );
    assert_eq!(film.size[0], 720);
    assert!(
        (session.shown_time() - time).abs() < 1e-9,
        "it is looked at as before"
    );
    click(&mut window, "✖");
    assert!(film.reel.is_cancelled());
    window.state_mut().1.accept_shooting(Ok(None));
    // A stretch of it: from a state that is marked, which is unmarked alike.
    let (_, session) = window.state_mut();
    let middle = session.playback().nearest(0.5);
    session.begin_film_at(middle);
    session.shoot_film([720, 450]);
    let stretch = session.shooting_due().expect("a film is wanted");
    let count = stretch.pictures.len();
    assert!((11..=14).contains(&count), "{count}");
    session.accept_shooting(Ok(None));
    session.begin_film_at(middle);
    assert_eq!(session.film_start(), None);
    session.shoot_film([720, 450]);
    let film = session.shooting_due().expect("a film is wanted");
    assert!(film.pictures.len() > 20);
    window.state_mut().1.accept_shooting(Ok(None));
    window.run();
    assert!(window.query_by_label("Save run").is_some());
}

#[test]
fn the_cost_of_phases_is_measured_while_it_is_plotted() {
    let mut window = opened("cube-cow");
    window.run();
    click(&mut window, "▶ Start");
    go_on(&mut window, 0.1);
    let phases = |window: &Window<'_>| {
        let samples = window.state().1.playback().samples();
        samples.filter(|sample| sample.phases.is_some()).count()
    };
    assert_eq!(phases(&window), 0, "nobody looks");
    click(&mut window, "Step cost");
    go_on(&mut window, 0.5);
    assert!(phases(&window) >= 29);
    for part in ["integrate", "broad", "narrow", "response", "step"] {
        assert!(window.query_by_label(part).is_some(), "{part}");
    }
    click(&mut window, "Step cost");
    let known = phases(&window);
    go_on(&mut window, 0.1);
    assert_eq!(phases(&window), known);
}

#[test]
fn the_descent_is_gone_through_pair_by_pair() {
    let mut window = opened("cube-cow");
    let session = &mut window.state_mut().1;
    session.select(Some(1));
    // Into the cow.
    let place = session.world().position(0) + sim_core::DVec3::new(0.0, 0.5, 0.0);
    session.set_position(place);
    window.run();
    let pairs = window.state_mut().1.pairs();
    for n in 1..=3 {
        window.key_press(Key::K);
        window.run();
        let told = format!(
            "Pair {n} of {}: ",
            viewer::number::count(pairs.len() as f64)
        );
        assert!(window.query_by_label_contains(&told).is_some(), "{told}");
        assert_eq!(window.state().1.display.pair, Some(n - 1));
    }
    window.key_press(Key::J);
    window.run();
    assert_eq!(window.state().1.display.pair, Some(1));
    // Level by level again.
    window.key_press(Key::N);
    window.run();
    assert_eq!(window.state().1.display.pair, None);
    assert!(window.query_by_label_contains("Level 1 of ").is_some());
}
