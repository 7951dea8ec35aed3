//! The panels, driven as a person would drive them: by what stands on them, and by keys.

use std::path::Path;
use std::time::Duration;

use egui::accesskit::Role;
use egui::{Key, Modifiers, TextureId, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use scene::Scene;
use sim_core::{Collision, Method};
use viewer::session::{Session, State};
use viewer::ui::Ui;

/// A window of a size on a session, without a picture in it.
fn window(session: Session, size: [f32; 2]) -> Harness<'static, (Ui, Session)> {
    Harness::builder()
        .with_size(Vec2::from(size))
        .with_context_setup(viewer::ui::apply_style)
        .with_max_steps(60)
        .build_ui_state(
            |root, (ui, session): &mut (Ui, Session)| {
                ui.show(root, session, TextureId::default());
            },
            (Ui::default(), session),
        )
}

fn opened(name: &str) -> Harness<'static, (Ui, Session)> {
    let scene = Scene::load(name).expect("in the gallery");
    let session = Session::new(scene).expect("a world");
    window(session, [1360.0, 1500.0])
}

/// Lets physics go on for a time, s, in frames of a sixtieth.
fn go_on(window: &mut Harness<'_, (Ui, Session)>, time: f64) {
    for _ in 0..(60.0 * time) as u32 {
        let (_, session) = window.state_mut();
        if let Some(job) = session.due(Duration::from_secs_f64(1.0 / 60.0)) {
            session.accept(job.run(|| Duration::ZERO));
        }
        while let Some(job) = session.variants_due() {
            session.accept_variants(job.run(|| Duration::ZERO));
        }
    }
    window.run();
}

fn click(window: &mut Harness<'_, (Ui, Session)>, label: &str) {
    {
        let mut named = window.query_all_by_label(label);
        // Not what only says the same.
        let button = named.find(|node| node.accesskit_node().role() != Role::Label);
        button.expect(label).click();
    }
    window.run();
}

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
fn every_key_does_what_it_says() {
    let mut window = opened("cube-cow");
    window.run();
    let press = |window: &mut Harness<'_, (Ui, Session)>, key| {
        window.key_press(key);
        window.run();
    };
    press(&mut window, Key::Space);
    assert_eq!(window.state().1.state(), State::Running);
    press(&mut window, Key::Space);
    assert_eq!(window.state().1.state(), State::Paused);
    press(&mut window, Key::R);
    press(&mut window, Key::PageDown);
    go_on(&mut window, 0.1);
    assert_eq!(window.state().1.world().steps(), 5);
    press(&mut window, Key::ArrowLeft);
    assert_eq!(window.state().1.world().steps(), 4);
    press(&mut window, Key::V);
    assert!(window.state().1.is_following());
    press(&mut window, Key::Home);
    assert!(!window.state().1.is_following());
    press(&mut window, Key::B);
    assert!(window.state().1.display.bvh.shown);
    assert!(window.query_by_label("PNG").is_some());
    press(&mut window, Key::G);
    assert!(window.query_by_label("PNG").is_none(), "plots are hidden");
    press(&mut window, Key::H);
    assert!(window.query_by_label("Keys and mouse").is_some());
    window.state_mut().1.reset();
    window.state_mut().1.select(Some(0));
    press(&mut window, Key::Delete);
    assert_eq!(window.state().1.world().len(), 1);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run();
    assert_eq!(window.state().1.world().len(), 2);
    window.key_press_modifiers(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
    window.run();
    assert_eq!(window.state().1.world().len(), 1);
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
fn edits_are_asked_for_before_they_are_lost() {
    let mut window = opened("cube-cow");
    window.run();
    click(&mut window, "sphere");
    window
        .state_mut()
        .1
        .leave(viewer::session::Leaving::Open("parabola".into()));
    window.run();
    assert!(
        window
            .query_by_label("Save the edits of cube-cow?")
            .is_some()
    );
    window.key_press(Key::Space);
    window.run();
    assert_eq!(
        window.state().1.state(),
        State::Layout,
        "keys wait for the answer"
    );
    click(&mut window, "Cancel");
    assert_eq!(window.state().1.world().len(), 3);
    window
        .state_mut()
        .1
        .leave(viewer::session::Leaving::Open("parabola".into()));
    window.run();
    click(&mut window, "Do not save");
    assert_eq!(window.state().1.scene().name, "parabola");
}

#[test]
fn nothing_breaks_in_windows_of_any_size() {
    let sizes = [
        [1360.0, 880.0],
        [900.0, 600.0],
        [300.0, 200.0],
        [60.0, 40.0],
    ];
    for name in ["cube-cow", "stiff-spring", "closing-walls", "drag"] {
        for size in sizes {
            let scene = Scene::load(name).expect("in the gallery");
            let mut session = Session::new(scene).expect("a world");
            session.select(Some(0));
            session.compare.on = true;
            window(session, size).run();
        }
    }
}

#[test]
fn names_cannot_reorder_or_act() {
    let hostile = "a\u{202e}b\u{1b}[31m";
    let text = format!(
        "title = {hostile:?}\nabout = {hostile:?}\nrate = 60\n[[body]]\nname = {hostile:?}\nmesh = \"cube.obj\"\n\
         [[body]]\nname = \"other\"\nmesh = \"cube.obj\"\nposition = [0.5, 0, 0]\n\
         [[force]]\nkind = \"anchor\"\nbody = {hostile:?}\nanchor = [0, 0, 0]\nstiffness = 1\n"
    );
    let text = text
        .replace("\\u{202e}", "\\u202e")
        .replace("\\u{1b}", "\\u001b");
    let scene = Scene::parse(&text, Path::new("h.toml")).expect("a scene");
    assert_eq!(scene.bodies[0].name, hostile);
    let mut session = Session::new(scene).expect("a world");
    session.select(Some(0));
    session.compare.on = true;
    let mut window = window(session, [1360.0, 2500.0]);
    window.run();
    let mut seen = 0;
    for node in window.root().children_recursive() {
        let texts = [node.accesskit_node().label(), node.value()];
        for text in texts.into_iter().flatten() {
            assert!(!text.contains(['\u{202e}', '\u{1b}']), "{text:?}");
            seen += usize::from(text.contains("a\\u{202e}b"));
        }
    }
    assert!(seen >= 4, "{seen}");
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
    window.run();
    assert!(window.query_by_label("Save run").is_some());
}

#[test]
fn the_cost_of_phases_is_measured_while_it_is_plotted() {
    let mut window = opened("cube-cow");
    window.run();
    click(&mut window, "▶ Start");
    go_on(&mut window, 0.1);
    let phases = |window: &Harness<'_, (Ui, Session)>| {
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
