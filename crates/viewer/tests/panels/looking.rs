//! The view, the layout of the window, and keys.

use std::path::Path;
use std::time::Duration;

use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use scene::Scene;
use sim_core::Method;
use viewer::session::{PRESETS, Session, State};

use crate::{Window, click, go_on, opened, stands, window};

#[test]
fn every_key_does_what_it_says() {
    let mut window = opened("cube-cow");
    window.run();
    let press = |window: &mut Window<'_>, key| {
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
fn buttons_of_the_bar_are_beside_each_other_however_narrow_it_is() {
    let names = [
        "▶ Start",
        "⏩ Step",
        "⟲ Reset",
        "Gallery",
        "Tour",
        "Live",
        "Plots",
        "Panel",
        "Keys",
    ];
    for width in [1360.0, 900.0, 700.0, 600.0, 320.0] {
        let scene = Scene::load("cube-cow").expect("in the gallery");
        let mut window = window(Session::new(scene).expect("a world"), [width, 500.0]);
        window.run();
        let places = names.map(|name| window.get_by_label(name).rect());
        for (i, a) in places.iter().enumerate() {
            assert!(a.right() <= width && a.width() > 20.0, "{} {a}", names[i]);
            for (j, b) in places[..i].iter().enumerate() {
                let both = a.intersect(*b);
                assert!(!both.is_positive(), "{width}: {} {}", names[i], names[j]);
            }
        }
    }
}

#[test]
fn all_keys_are_in_sight_in_a_low_window() {
    let scene = Scene::load("cube-cow").expect("in the gallery");
    let mut window = window(Session::new(scene).expect("a world"), [900.0, 600.0]);
    window.run();
    window.key_press(Key::H);
    window.run();
    let [first, last] =
        ["Keys and mouse", "Drag a number"].map(|text| window.get_by_label(text).rect());
    assert!(
        first.top() >= 0.0 && last.bottom() < 580.0,
        "{first} {last}"
    );
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
fn keys_fly_while_the_right_button_is_held() {
    let mut window = opened("cube-cow");
    window.run();
    let at = egui::pos2(500.0, 300.0);
    let button = |pressed| egui::Event::PointerButton {
        pos: at,
        button: egui::PointerButton::Secondary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    let before = window.state().1.camera;
    window.hover_at(at);
    window.event(button(true));
    window.step();
    window.key_down(Key::W);
    window.step();
    window.step();
    let (after, wireframe) = (window.state().1.camera, window.state().1.display.wireframe);
    assert!((after.eye() - before.eye()).dot(before.forward()) > 0.0);
    assert!(!wireframe, "W is a key of its own only without the button");
    window.key_up(Key::W);
    window.event(button(false));
    window.run();
    window.key_press(Key::W);
    window.run();
    assert!(window.state().1.display.wireframe);
}

#[test]
fn the_panel_is_as_wide_whatever_stands_in_it() {
    let place = |scene: &str, method: &'static Method, shown: bool| {
        let scene = Scene::load(scene).expect("in the gallery");
        let mut session = Session::new(scene).expect("a world");
        session.set_method(method);
        session.select(Some(0));
        session.compare.on = shown;
        session.display.bvh.shown = shown;
        session.display.descent = shown.then_some(0);
        let mut window = window(session, [1360.0, 880.0]);
        window.run();
        window.get_by_label("New").rect().left()
    };
    let methods = sim_core::METHODS.iter().copied();
    let verlet = Method::named("velocity-verlet").expect("it is in the table");
    let scenes = [
        "cube-cow",
        "tennis-racket",
        "chain",
        "top",
        "slope",
        "stiff-spring",
    ];
    let all: Vec<f32> = methods
        .map(|method| place("spring", method, false))
        .chain(scenes.map(|scene| place(scene, verlet, true)))
        .collect();
    assert!(all.iter().all(|left| *left == all[0]), "{all:?}");
    // With a variant that fails on its way.
    let scene = Scene::load("kepler").expect("in the gallery");
    let mut session = Session::new(scene).expect("a world");
    session.compare_with((PRESETS[0].settings)(session.world().settings()));
    session.start();
    let mut window = window(session, [1360.0, 880.0]);
    go_on(&mut window, 4.5);
    assert!(stands(&window, "stopped"));
    assert_eq!(window.get_by_label("New").rect().left(), all[0]);
}

#[test]
fn views_and_marks_are_switched_by_key_and_panel() {
    let mut window = opened("cube-cow");
    window.run();
    for (key, on) in [
        (
            Key::O,
            (|s: &Session| s.camera.parallel) as fn(&Session) -> bool,
        ),
        (Key::W, |s| s.display.wireframe),
        (Key::M, |s| s.display.names),
    ] {
        assert!(!on(&window.state().1));
        window.key_press(key);
        window.run();
        assert!(on(&window.state().1), "{key:?}");
    }
    for (label, on) in [
        (
            "Parallel",
            (|s: &Session| s.camera.parallel) as fn(&Session) -> bool,
        ),
        ("Edges", |s| s.display.wireframe),
        ("Names", |s| s.display.names),
        ("Numbers", |s| s.display.numbers),
    ] {
        assert!(on(&window.state().1), "{label}");
        click(&mut window, label);
        assert!(!on(&window.state().1), "{label}");
    }
    click(&mut window, "Top");
    assert!(window.state().1.camera.pitch > 1.5);
    for key in [Key::Questionmark, Key::F1] {
        window.key_press(key);
        window.run();
        assert!(window.query_by_label("Keys and mouse").is_some());
        window.key_press(Key::H);
        window.run();
        assert!(window.query_by_label("Keys and mouse").is_none());
    }
}

#[test]
fn what_the_tour_measures_comes_into_sight() {
    let scene = Scene::load("cube-cow").expect("in the gallery");
    let session = Session::new(scene).expect("a world");
    let mut window = window(session, [1360.0, 700.0]);
    window.run();
    let session = &mut window.state_mut().1;
    session.compare.on = true;
    let trial = session
        .trial_due(Duration::from_secs(9))
        .expect("it is due");
    // A millisecond goes by whenever somebody looks, so that little is measured.
    let time = std::cell::Cell::new(Duration::ZERO);
    session.accept_trial(trial.run(|| {
        time.set(time.get() + Duration::from_millis(1));
        time.get()
    }));
    window.run();
    let table = window.get_by_label("Spread").rect();
    assert!(table.bottom() < 640.0, "{table}");
}
