//! Changing the set-up.

use egui::accesskit::Role;
use egui::{Key, Modifiers, Vec2};
use egui_kittest::kittest::Queryable;
use viewer::session::State;

use crate::{Window, click, opened, stands};

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
fn closing_asks_and_each_answer_does_what_it_says() {
    let name = format!("cowbell-closing-{}.toml", std::process::id());
    let file = std::env::temp_dir().join(name);
    let close = |window: &mut Window<'_>| {
        window.key_press_modifiers(Modifiers::COMMAND, Key::Q);
        window.run();
    };
    let open = || {
        let mut window = opened("cube-cow");
        window.state_mut().1.save(&file, true);
        click(&mut window, "sphere");
        close(&mut window);
        assert!(!window.state().1.is_closing(), "it is asked first");
        window
    };
    let bodies = || {
        let text = std::fs::read_to_string(&file).expect("the scene's file");
        text.matches("[[body]]").count()
    };
    let mut window = open();
    click(&mut window, "Cancel");
    assert!(!window.state().1.is_closing() && window.state().1.is_changed());
    close(&mut window);
    click(&mut window, "Do not save");
    assert!(window.state().1.is_closing());
    assert_eq!(bodies(), 2);

    let mut window = open();
    // The panel has a button of this name too, which the question is over.
    window
        .query_all_by_label("Save")
        .last()
        .expect("an answer")
        .click();
    window.run();
    assert!(window.state().1.is_closing());
    assert_eq!(bodies(), 3);

    let mut window = open();
    window.key_press(Key::Escape);
    window.run();
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run();
    close(&mut window);
    assert!(window.state().1.is_closing(), "nothing is lost");
    let _ = std::fs::remove_file(&file);
}

#[test]
fn a_body_is_renamed_hidden_and_a_scene_begun() {
    let mut window = opened("cube-cow");
    window.state_mut().1.select(Some(1));
    window.run();
    click(&mut window, "Shown");
    let session = &mut window.state_mut().1;
    assert!(session.is_hidden(1));
    assert_eq!(session.picture().models.len(), 1);
    session.rename_selected("dice");
    assert!(session.is_hidden(1), "under its new name");
    session.rename_selected("cow");
    assert_eq!(session.scene().bodies[1].name, "dice");
    assert!(session.notices().iter().any(|notice| notice.error));
    session.rename_selected("  ");
    assert_eq!(session.scene().bodies[1].name, "dice");
    window.run();
    click(&mut window, "New");
    click(&mut window, "Do not save");
    assert!(window.state().1.world().is_empty());
    click(&mut window, "cow");
    assert_eq!(window.state().1.world().len(), 1);
}

#[test]
fn handles_move_turn_and_stretch_the_selected_body() {
    let mut window = opened("cube-cow");
    window.state_mut().1.select(Some(1));
    window.run();
    let drag = |window: &mut Window<'_>, label: &str, by: Vec2| {
        let at = window.get_by_label(label).rect().center();
        window.drag_at(at);
        window.run();
        for part in [0.5, 1.0] {
            window.hover_at(at + part * by);
            window.run();
        }
        window.drop_at(at + by);
        window.run();
    };
    let before = window.state().1.world().position(1);
    drag(&mut window, "Move along y", Vec2::new(0.0, -60.0));
    let moved = window.state().1.world().position(1) - before;
    assert!(
        moved.y > 0.05 && moved.x == 0.0 && moved.z == 0.0,
        "{moved}"
    );
    assert_eq!(window.state().1.scene().bodies[1].position, before + moved);
    let body = |window: &Window<'_>| window.state().1.scene().bodies[1].clone();
    let before = body(&window);
    click(&mut window, "Turn");
    drag(&mut window, "Turn about y", Vec2::new(0.0, -60.0));
    let after = body(&window);
    assert!(
        (after.rotation - before.rotation).y > 5.0,
        "{}",
        after.rotation
    );
    click(&mut window, "Stretch");
    drag(&mut window, "Stretch along y", Vec2::new(0.0, -60.0));
    let after = body(&window);
    assert!(after.scale.y > 1.2 * before.scale.y && after.scale.x == before.scale.x);
    window.key_press(Key::Space);
    window.run();
    assert!(
        !stands(&window, "Stretch along y"),
        "none while physics runs"
    );
    window.key_press(Key::R);
    window.run();
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run();
    assert!(
        body(&window).scale.y < 1.1 * before.scale.y,
        "it is taken back"
    );
}

/// Types a text into the field that shows a value.
fn write(window: &mut Window<'_>, shown: &str, text: &str) {
    {
        let mut fields = window.query_all_by_role(Role::SpinButton);
        let field = fields.find(|node| node.value().as_deref() == Some(shown));
        field.expect(shown).click();
    }
    window.run();
    window.event(egui::Event::Text(text.to_owned()));
    window.run();
}

/// Types a text into the field that shows a value, and ends it.
fn enter(window: &mut Window<'_>, shown: &str, text: &str) {
    write(window, shown, text);
    window.key_press(Key::Enter);
    window.run();
}

const NOT_A_NUMBER: &str = "\"nan\" is not a number: write it like 1.5, -2e-3 or 1/60.";

#[test]
fn what_is_no_number_is_told_until_a_number_is_typed() {
    let mut window = opened("cube-cow");
    window.state_mut().1.select(Some(0));
    window.run();
    let mut mass = |text: &str| {
        enter(&mut window, "6", text);
        let told = stands(&window, NOT_A_NUMBER);
        (told, window.state().1.world().mass(0))
    };
    assert_eq!(mass("nan"), (true, 6.0));
    assert_eq!(mass("2*3.5"), (false, 7.0));
}

#[test]
fn numbers_of_sliders_are_typed_as_in_fields() {
    let mut window = opened("cube-cow");
    let rate = |window: &Window<'_>| (1.0 / window.state().1.world().settings().dt).round();
    enter(&mut window, "60 Hz", "nan");
    assert!(stands(&window, NOT_A_NUMBER));
    enter(&mut window, "60 Hz", "1e9");
    let beyond = "\"1e9\" is not taken here: numbers from 1 to 100000 are.";
    assert!(stands(&window, beyond));
    assert_eq!(rate(&window), 60.0);
    enter(&mut window, "60 Hz", "2*500 Hz");
    assert!(!stands(&window, beyond));
    assert_eq!(rate(&window), 1000.0);
    // A run remembers every rate that it had: while one is typed there is none between.
    write(&mut window, "1000 Hz", "2");
    assert_eq!(rate(&window), 1000.0);
    window.key_press(Key::Enter);
    window.run();
    assert_eq!(rate(&window), 2.0);
    enter(&mut window, "2 Hz", "1/0.3");
    let dt = window.state().1.world().settings().dt;
    assert!((dt - 0.3).abs() < 1e-15, "{dt}");
    enter(&mut window, "×1.0", "100");
    assert!(stands(
        &window,
        "\"100\" is not taken here: numbers from 0.001 to 10 are."
    ));
    enter(&mut window, "×1.0", "1/4");
    assert_eq!(window.state().1.speed(), 0.25);
}
