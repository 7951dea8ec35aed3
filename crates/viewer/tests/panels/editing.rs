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

#[test]
fn what_is_no_number_is_told_until_a_number_is_typed() {
    let mut window = opened("cube-cow");
    window.state_mut().1.select(Some(0));
    window.run();
    let mut enter = |mass: &str, text: &str| {
        {
            let mut fields = window.query_all_by_role(Role::SpinButton);
            let field = fields.find(|node| node.value().as_deref() == Some(mass));
            field.expect("the field of the mass").click();
        }
        window.run();
        window.event(egui::Event::Text(text.to_owned()));
        window.key_press(Key::Enter);
        window.run();
        let told = "\"nan\" is not a number: write it like 1.5, -2e-3 or 1/60.";
        (stands(&window, told), window.state().1.world().mass(0))
    };
    assert_eq!(enter("6", "nan"), (true, 6.0));
    assert_eq!(enter("6", "2*3.5"), (false, 7.0));
}
