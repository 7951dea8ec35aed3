//! The gallery, the palette, the tour, and what is remembered.

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use viewer::session::{LABS, stop_count};
use viewer::words::Language;

use crate::{Window, click, has_chinese, opened, stands};

#[test]
fn the_gallery_finds_a_scene_and_opens_it() {
    let mut window = opened("cube-cow");
    window.run();
    window.key_press_modifiers(Modifiers::COMMAND, Key::G);
    window.run();
    assert!(stands(&window, "Kepler's ellipse"));
    // What is typed at once is searched for.
    window.event(egui::Event::Text("pi collisions".to_owned()));
    window.run();
    assert!(!stands(&window, "Kepler's ellipse"));
    click(&mut window, "Pi by collisions");
    assert_eq!(window.state().1.scene().name, "galperin");
    // The key that opens it closes it, though the search has the keyboard.
    let toggle = |window: &mut Window<'_>| {
        window.key_press_modifiers(Modifiers::COMMAND, Key::G);
        window.run();
    };
    toggle(&mut window);
    assert!(stands(&window, "Kepler's ellipse"));
    toggle(&mut window);
    assert!(!stands(&window, "Kepler's ellipse"));
    toggle(&mut window);
    click(&mut window, "A thrown cube");
    assert_eq!(window.state().1.scene().name, "parabola");
    window.key_press_modifiers(Modifiers::COMMAND, Key::G);
    window.run();
    window.event(egui::Event::Text("herd".to_owned()));
    window.run();
    window.key_press(Key::Enter);
    window.run();
    assert_eq!(window.state().1.scene().name, "herd");
}

#[test]
fn the_palette_finds_a_command_and_does_it() {
    let mut window = opened("cube-cow");
    window.run();
    let search = |window: &mut Window<'_>, words: &str| {
        window.key_press_modifiers(Modifiers::COMMAND, Key::P);
        window.run();
        window.get_by_label("Search the commands").type_text(words);
        window.run();
        window.key_press(Key::Enter);
        window.run();
    };
    search(&mut window, "integrator backward");
    assert_eq!(
        window.state().1.world().settings().method.name,
        "backward-euler"
    );
    search(&mut window, "wireframe");
    assert!(window.state().1.display.wireframe);
    search(&mut window, "look from the top");
    assert!(window.state().1.camera.pitch > 1.5);
    for (command, told) in [
        ("last impact", "No earlier impact is kept."),
        ("next impact", "No later impact is kept."),
    ] {
        search(&mut window, command);
        assert!(stands(&window, told), "{command}");
    }
    if !has_chinese(&mut window) {
        return;
    }
    search(&mut window, "中文");
    assert!(window.query_by_label("▶ 开始").is_some());
}

#[test]
fn the_tour_goes_through_all_labs_and_sets_up_what_it_says() {
    let mut window = opened("cube-cow");
    window.run();
    window.key_press_modifiers(Modifiers::COMMAND, Key::T);
    window.run();
    let mut stops = 0;
    for lab in &LABS {
        for stop in lab.stops {
            stops += 1;
            assert!(
                window.query_by_label(stop.watch).is_some(),
                "{}",
                stop.title
            );
            for attempt in stop.attempts {
                click(&mut window, attempt.title);
                let session = &window.state().1;
                assert_eq!(session.scene().name, stop.scene);
                assert!(!session.is_changed(), "{}: nothing to lose", attempt.title);
            }
            assert!(window.query_by_label(stop.answer).is_none());
            click(&mut window, "Answer");
            assert!(
                window.query_by_label(stop.answer).is_some(),
                "{}",
                stop.title
            );
            if stops < stop_count() {
                click(&mut window, "Next ▶");
            }
        }
    }
    assert_eq!(stops, stop_count());
}

#[test]
fn what_is_preferred_comes_back() {
    let mut window = opened("cube-cow");
    if !has_chinese(&mut window) {
        return;
    }
    click(&mut window, "中文");
    window.key_press(Key::G);
    window.key_press(Key::O);
    window.run();
    click(&mut window, "☀");
    let (ui, session) = window.state();
    let preferred = ui.preferences(&window.ctx, session);
    assert_eq!(preferred.language, Language::Chinese);
    assert!(preferred.light && preferred.parallel && !preferred.plots);
    let mut again = opened("bullet");
    let context = again.ctx.clone();
    let (ui, session) = again.state_mut();
    ui.prefer(&context, session, &preferred);
    again.run();
    let (ui, session) = again.state();
    assert_eq!(ui.preferences(&again.ctx, session), preferred);
    assert!(again.query_by_label("▶ 开始").is_some());
    assert!(again.query_by_label("PNG").is_none());
}
