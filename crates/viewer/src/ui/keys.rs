//! Keys: one table that is handled, listed below the picture and explained in a window.

use egui::text::{LayoutJob, TextFormat};
use egui::{Key, Modifiers, Panel, RichText, TextStyle};

use super::Ui;
use crate::session::{Leaving, Session, Side};
use crate::words::say;

/// A key and its action.
struct Shortcut {
    keys: &'static [Key],
    label: &'static str,
    meaning: &'static str,
    act: fn(&mut Ui, &mut Session, Key),
}

static SHORTCUTS: [Shortcut; 25] = [
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
        keys: &[Key::O],
        label: "O",
        meaning: "parallel view",
        act: |_, session, _| session.camera.parallel ^= true,
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
        keys: &[Key::W],
        label: "W",
        meaning: "wireframe",
        act: |_, session, _| session.display.wireframe ^= true,
    },
    Shortcut {
        keys: &[Key::M],
        label: "M",
        meaning: "names",
        act: |_, session, _| session.display.names ^= true,
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
        keys: &[Key::J, Key::K],
        label: "J K",
        meaning: "pairs of boxes",
        act: |_, session, key| session.step_pair(if key == Key::J { -1 } else { 1 }),
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
        keys: &[Key::H, Key::Questionmark, Key::F1],
        label: "H ? F1",
        meaning: "all keys",
        act: |ui, _, _| ui.help ^= true,
    },
];

/// An action that can be stored.
pub(super) type Doing = Box<dyn Fn(&mut Ui, &mut Session)>;

/// The action of a key.
type Act = fn(&mut Ui, &mut Session);

/// A key that is pressed together with Ctrl, or with the command key on a Mac.
struct WithCtrl {
    modifiers: Modifiers,
    key: Key,
    label: &'static str,
    meaning: &'static str,
    act: Act,
}

impl WithCtrl {
    const fn new(key: Key, label: &'static str, meaning: &'static str, act: Act) -> Self {
        Self {
            modifiers: Modifiers::COMMAND,
            key,
            label,
            meaning,
            act,
        }
    }
}

static WITH_CTRL: [WithCtrl; 11] = [
    // Shortcuts with Shift come first, because those without Shift do not test it.
    WithCtrl {
        modifiers: Modifiers::COMMAND.plus(Modifiers::SHIFT),
        ..WithCtrl::new(Key::Z, "Ctrl + Shift + Z", "do again", |_, session| {
            session.redo();
        })
    },
    WithCtrl::new(Key::Z, "Ctrl + Z", "take an edit back", |_, session| {
        session.undo();
    }),
    WithCtrl::new(Key::Y, "Ctrl + Y", "do it again", |_, session| {
        session.redo()
    }),
    WithCtrl::new(Key::S, "Ctrl + S", "save the scene", |_, session| {
        session.save_own();
    }),
    WithCtrl::new(Key::N, "Ctrl + N", "new scene", |_, session| {
        session.leave(Leaving::New);
    }),
    WithCtrl::new(Key::O, "Ctrl + O", "open a file", |ui, _| ui.files.ask()),
    WithCtrl::new(Key::D, "Ctrl + D", "duplicate the body", |_, session| {
        session.duplicate_selected();
    }),
    WithCtrl::new(Key::P, "Ctrl + P", "find a command", |ui, _| {
        ui.palette.open = true;
    }),
    WithCtrl::new(Key::G, "Ctrl + G", "gallery of scenes", |ui, _| {
        ui.gallery.open ^= true;
    }),
    WithCtrl::new(Key::T, "Ctrl + T", "guided tour", |ui, _| {
        ui.tour.open ^= true
    }),
    WithCtrl::new(Key::Q, "Ctrl + Q", "close the window", |_, session| {
        session.leave(Leaving::Close);
    }),
];

static GESTURES: [(&str, &str); 8] = [
    ("Click", "select a body"),
    ("Drag left or right", "orbit"),
    ("Drag middle, Shift + drag", "pan"),
    (
        "Ctrl + drag a body",
        "pull it by a spring; let go to throw it",
    ),
    ("Wheel", "zoom to the pointer"),
    ("Right button + W A S D Q E", "fly; the mouse looks around"),
    ("Drop a file", "add a mesh or open a scene"),
    ("Drag a number", "change it; click to type"),
];

/// Scales the window; egui handles these keys.
const MAGNIFY: (&str, &str) = ("Ctrl + +, -, 0", "larger, smaller, as it was");

/// All actions: their keys, descriptions and functions.
pub(super) fn commands() -> impl Iterator<Item = (&'static str, &'static str, Doing)> {
    let plain = SHORTCUTS.iter().flat_map(|shortcut| {
        // Keys with several actions, such as the sides to look from, are one command for each.
        let keys = match shortcut.label {
            "1 2 3" | "[ ]" | "U I" | "J K" => shortcut.keys,
            _ => &shortcut.keys[..1],
        };
        keys.iter().map(move |&key| {
            let act: Doing = Box::new(move |ui, session| (shortcut.act)(ui, session, key));
            let name = match key {
                Key::Num1 => "look from the front",
                Key::Num2 => "look from the right",
                Key::Num3 => "look from the top",
                Key::U => "last impact",
                Key::I => "next impact",
                Key::J => "last pair of boxes",
                Key::K => "next pair of boxes",
                Key::OpenBracket => "boxes one level up",
                Key::CloseBracket => "boxes one level down",
                _ => shortcut.meaning,
            };
            (shortcut.label, name, act)
        })
    });
    let held = WITH_CTRL.iter().map(|held| {
        let act: Doing = Box::new(held.act);
        (held.label, held.meaning, act)
    });
    plain.chain(held)
}

/// Handles the pressed keys. While a field has the keyboard, only the keys with Ctrl that no field uses are handled:
/// the gallery closes by the key that opens it, although its search field has the keyboard.
pub(super) fn handle(ctx: &egui::Context, state: &mut Ui, session: &mut Session) {
    if session.leaving().is_some() || state.palette.open {
        return;
    }
    let is_typing = ctx.egui_wants_keyboard_input();
    for held in &WITH_CTRL {
        let is_free = matches!(held.key, Key::G | Key::T | Key::P | Key::Q);
        if is_typing && !is_free {
            continue;
        }
        if ctx.input_mut(|input| input.consume_key(held.modifiers, held.key)) {
            (held.act)(state, session);
        }
    }
    // While the right button is pressed, keys fly the camera.
    if is_typing || ctx.input(|i| i.pointer.secondary_down()) {
        return;
    }
    for shortcut in &SHORTCUTS {
        for &key in shortcut.keys {
            let presses = ctx.input(|i| {
                // Keys with Ctrl and Alt belong to the system and to egui.
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
                // A key and its meaning stay on one line.
                ui.add(egui::Label::new(line(ui, shortcut)).extend());
            }
        });
    });
}

/// A key and its meaning as one text, so that no line break separates them.
fn line(ui: &egui::Ui, shortcut: &Shortcut) -> LayoutJob {
    let font = TextStyle::Small.resolve(ui.style());
    let mut text = LayoutJob::default();
    for (part, colour) in [
        (say(shortcut.label), ui.visuals().strong_text_color()),
        (" ".to_owned(), ui.visuals().text_color()),
        (say(shortcut.meaning), ui.visuals().weak_text_color()),
    ] {
        text.append(&part, 0.0, TextFormat::simple(font.clone(), colour));
    }
    text
}

/// The window that lists everything.
pub(super) fn show_help(ctx: &egui::Context, open: &mut bool) {
    egui::Window::new(say("Keys and mouse"))
        .id(egui::Id::unique("all keys"))
        .open(open)
        .collapsible(false)
        .resizable(false)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(ctx.content_rect().center())
        .show(ctx, |ui| {
            // The reduced height fits all keys into a window of 600 points.
            ui.spacing_mut().interact_size.y = 16.0;
            let plain = SHORTCUTS.iter().map(|s| (s.label, s.meaning));
            let held = WITH_CTRL.iter().map(|held| (held.label, held.meaning));
            let all: Vec<_> = plain.chain(held).chain([MAGNIFY]).chain(GESTURES).collect();
            // In two columns, because there are many.
            let (left, right) = all.split_at(all.len().div_ceil(2));
            egui::Grid::new("keys")
                .num_columns(4)
                .spacing([18.0, 4.0])
                .show(ui, |ui| {
                    for (row, pair) in left.iter().enumerate() {
                        for (what, meaning) in [Some(pair), right.get(row)].into_iter().flatten() {
                            ui.label(RichText::new(say(what)).strong());
                            ui.label(say(meaning));
                        }
                        ui.end_row();
                    }
                });
            ui.separator();
            let about = format!("Cowbell {}, MIT or Apache-2.0", env!("CARGO_PKG_VERSION"));
            ui.label(RichText::new(say(about)).weak());
        });
}
