//! Keys: one table that is obeyed, listed below the picture and explained in a window.

use egui::text::{LayoutJob, TextFormat};
use egui::{Key, Modifiers, Panel, RichText, TextStyle};

use super::Ui;
use crate::session::{Session, Side};

/// A key and what it does.
struct Shortcut {
    keys: &'static [Key],
    label: &'static str,
    meaning: &'static str,
    act: fn(&mut Ui, &mut Session, Key),
}

static SHORTCUTS: [Shortcut; 21] = [
    Shortcut {
        keys: &[Key::Space],
        label: "Space",
        meaning: "start / pause",
        act: |_, session, _| session.toggle(),
    },
    Shortcut {
        keys: &[Key::ArrowRight, Key::Period],
        label: "Right or .",
        meaning: "single step",
        act: |_, session, _| session.step_once(),
    },
    Shortcut {
        keys: &[Key::ArrowLeft, Key::Comma],
        label: "Left or ,",
        meaning: "step back",
        act: |_, session, _| session.step_back(),
    },
    Shortcut {
        keys: &[Key::PageDown],
        label: "PgDn",
        meaning: "five steps",
        act: |_, session, _| super::time::five_steps(session),
    },
    Shortcut {
        keys: &[Key::U, Key::I],
        label: "U I",
        meaning: "impacts",
        act: |_, session, key| session.go_to_impact(key == Key::I),
    },
    Shortcut {
        keys: &[Key::R],
        label: "R",
        meaning: "reset",
        act: |_, session, _| session.reset(),
    },
    Shortcut {
        keys: &[Key::F],
        label: "F",
        meaning: "frame",
        act: |_, session, _| session.frame(),
    },
    Shortcut {
        keys: &[Key::V],
        label: "V",
        meaning: "follow",
        act: |_, session, _| session.follow(!session.is_following()),
    },
    Shortcut {
        keys: &[Key::Home],
        label: "Home",
        meaning: "home view",
        act: |_, session, _| session.go_home(),
    },
    Shortcut {
        keys: &[Key::Num1, Key::Num2, Key::Num3],
        label: "1 2 3",
        meaning: "sides",
        act: |_, session, key| {
            session.look_from(match key {
                Key::Num1 => Side::Front,
                Key::Num2 => Side::Right,
                _ => Side::Top,
            });
        },
    },
    Shortcut {
        keys: &[Key::B],
        label: "B",
        meaning: "BVH boxes",
        act: |_, session, _| session.display.bvh.shown ^= true,
    },
    Shortcut {
        keys: &[Key::OpenBracket, Key::CloseBracket],
        label: "[ ]",
        meaning: "box depth",
        act: |_, session, key| session.step_depth(if key == Key::OpenBracket { -1 } else { 1 }),
    },
    Shortcut {
        keys: &[Key::N],
        label: "N",
        meaning: "descent",
        act: |_, session, _| session.step_descent(1),
    },
    Shortcut {
        keys: &[Key::T],
        label: "T",
        meaning: "trails",
        act: |_, session, _| session.show_trails(!session.display.trails),
    },
    Shortcut {
        keys: &[Key::F12],
        label: "F12",
        meaning: "picture",
        act: |ui, session, _| session.shoot_still(ui.pixels),
    },
    Shortcut {
        keys: &[Key::Delete],
        label: "Del",
        meaning: "delete body",
        act: |_, session, _| session.delete_selected(),
    },
    Shortcut {
        keys: &[Key::Escape],
        label: "Esc",
        meaning: "deselect",
        act: |_, session, _| session.select(None),
    },
    Shortcut {
        keys: &[Key::P],
        label: "P",
        meaning: "side panel",
        act: |ui, _, _| ui.panel_hidden ^= true,
    },
    Shortcut {
        keys: &[Key::L],
        label: "L",
        meaning: "figures",
        act: |ui, _, _| ui.live_hidden ^= true,
    },
    Shortcut {
        keys: &[Key::G],
        label: "G",
        meaning: "plots",
        act: |ui, _, _| ui.plots_hidden ^= true,
    },
    Shortcut {
        keys: &[Key::H],
        label: "H",
        meaning: "all keys",
        act: |ui, _, _| ui.help ^= true,
    },
];

/// What a key does.
type Act = fn(&mut Session);

/// What is done with the control or command key held.
const WITH_CTRL: [(Modifiers, Key, Act); 4] = [
    // With Shift first, since without it does not look at Shift.
    (
        Modifiers::COMMAND.plus(Modifiers::SHIFT),
        Key::Z,
        Session::redo,
    ),
    (Modifiers::COMMAND, Key::Z, Session::undo),
    (Modifiers::COMMAND, Key::Y, Session::redo),
    (Modifiers::COMMAND, Key::S, Session::save_own),
];

static GESTURES: [(&str, &str); 9] = [
    ("Ctrl + Z", "take an edit back"),
    ("Ctrl + Shift + Z, Ctrl + Y", "do it again"),
    ("Ctrl + S", "save the scene"),
    ("Click", "select a body"),
    ("Drag left or right", "orbit"),
    ("Drag middle, Shift + drag", "pan"),
    ("Wheel", "zoom"),
    ("Drop a file", "add a mesh or open a scene"),
    ("Drag a number", "change it; click to type"),
];

/// Obeys the keys pressed, unless they are typed into a field.
pub(super) fn handle(ctx: &egui::Context, state: &mut Ui, session: &mut Session) {
    if ctx.egui_wants_keyboard_input() {
        return;
    }
    if session.leaving().is_some() {
        return;
    }
    for (modifiers, key, act) in WITH_CTRL {
        if ctx.input_mut(|input| input.consume_key(modifiers, key)) {
            act(session);
        }
    }
    for shortcut in &SHORTCUTS {
        for &key in shortcut.keys {
            let presses = ctx.input(|i| {
                // Ctrl and Alt belong to the system and to egui.
                let foreign = i.modifiers.ctrl || i.modifiers.alt || i.modifiers.command;
                if foreign { 0 } else { i.num_presses(key) }
            });
            for _ in 0..presses {
                (shortcut.act)(state, session, key);
            }
        }
    }
}

/// The line below the picture.
pub(super) fn show_line(root: &mut egui::Ui) {
    Panel::bottom("keys").show(root, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = egui::vec2(14.0, 1.0);
            ui.spacing_mut().interact_size.y = 12.0;
            for shortcut in &SHORTCUTS {
                // A key stays beside its meaning.
                ui.add(egui::Label::new(line(ui, shortcut)).extend());
            }
        });
    });
}

/// A key and its meaning as one text, so that they stay on one line.
fn line(ui: &egui::Ui, shortcut: &Shortcut) -> LayoutJob {
    let font = TextStyle::Small.resolve(ui.style());
    let mut text = LayoutJob::default();
    for (part, colour) in [
        (shortcut.label, ui.visuals().strong_text_color()),
        (" ", ui.visuals().text_color()),
        (shortcut.meaning, ui.visuals().weak_text_color()),
    ] {
        text.append(part, 0.0, TextFormat::simple(font.clone(), colour));
    }
    text
}

/// The window that lists everything.
pub(super) fn show_help(ctx: &egui::Context, open: &mut bool) {
    egui::Window::new("Keys and mouse")
        .open(open)
        .collapsible(false)
        .resizable(false)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(ctx.content_rect().center())
        .show(ctx, |ui| {
            egui::Grid::new("keys")
                .num_columns(2)
                .spacing([24.0, 4.0])
                .show(ui, |ui| {
                    let keys = SHORTCUTS.iter().map(|s| (s.label, s.meaning));
                    for (what, meaning) in keys.chain(GESTURES) {
                        ui.label(RichText::new(what).strong());
                        ui.label(meaning);
                        ui.end_row();
                    }
                });
        });
}
