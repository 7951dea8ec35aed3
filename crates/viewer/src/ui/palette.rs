//! The command palette: all commands, found by a part of their names.

use egui::{Id, Key, Modal, RichText, ScrollArea, TextEdit};
use sim_core::METHODS;

use super::{Ui, keys};
use crate::session::{LABS, Leaving, PRESETS, Session};
use crate::words::{Language, say};

/// The state of the palette between frames.
#[derive(Default)]
pub(super) struct Palette {
    pub(super) open: bool,
    search: String,
    marked: usize,
}

/// A command.
struct Command {
    /// The name in English.
    name: String,
    keys: &'static str,
    act: keys::Doing,
}

impl Command {
    fn new(name: impl Into<String>, act: impl Fn(&mut Ui, &mut Session) + 'static) -> Self {
        Self {
            name: name.into(),
            keys: "",
            act: Box::new(act),
        }
    }

    /// Whether all words occur in its name, in any language.
    fn matches(&self, words: &str) -> bool {
        let names = Language::ALL.map(|language| language.say(&self.name).to_lowercase());
        let words = words.to_lowercase();
        words
            .split_whitespace()
            .all(|word| names.iter().any(|name| name.contains(word)))
    }
}

/// All commands.
fn commands(has_chinese: bool) -> Vec<Command> {
    let mut all: Vec<Command> = keys::commands()
        .map(|(keys, name, act)| Command {
            keys,
            ..Command::new(name, act)
        })
        .collect();
    for language in Language::ALL {
        let name = match has_chinese {
            true => language.name(),
            false => "Chinese",
        };
        let name = format!("Language: {name}");
        all.push(Command::new(name, move |ui, _| ui.language = language));
    }
    for (index, preset) in PRESETS.iter().enumerate() {
        let name = format!("Compare: {}", preset.title);
        all.push(Command::new(name, move |_, session| {
            let own = *session.world().settings();
            session.compare_with((PRESETS[index].settings)(&own));
        }));
    }
    for method in METHODS {
        let name = format!("Integrator: {}", method.title);
        all.push(Command::new(name, move |_, session| {
            session.set_method(method)
        }));
    }
    let stops = LABS.iter().flat_map(|lab| lab.stops);
    for (number, stop) in stops.enumerate() {
        let name = format!("Tour: {}", stop.title);
        all.push(Command::new(name, move |ui, _| ui.tour.go(number)));
    }
    for entry in scene::SCENES {
        let name = format!("Scene: {}", entry.title());
        all.push(Command::new(name, |_, session| {
            session.leave(Leaving::Open(entry.name.into()));
        }));
    }
    all
}

pub(super) fn show(ctx: &egui::Context, state: &mut Ui, session: &mut Session) {
    if !state.palette.open {
        return;
    }
    let has_chinese = state.has_chinese == Some(true);
    let palette = &mut state.palette;
    let mut chosen = None;
    let modal = Modal::new(Id::unique("palette")).show(ctx, |ui| {
        ui.set_width(460.0_f32.min(ctx.content_rect().width() - 40.0));
        // These keys are read before the field receives them.
        let (up, down, enter) = ui.input_mut(|input| {
            (
                input.consume_key(egui::Modifiers::NONE, Key::ArrowUp),
                input.consume_key(egui::Modifiers::NONE, Key::ArrowDown),
                input.key_pressed(Key::Enter),
            )
        });
        let edit = TextEdit::singleline(&mut palette.search)
            .hint_text(say("what to do"))
            .desired_width(f32::INFINITY);
        let edit = ui.add(edit);
        edit.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::TextInput, true, say("Search the commands"))
        });
        edit.request_focus();
        let found: Vec<Command> = commands(has_chinese)
            .into_iter()
            .filter(|command| command.matches(&palette.search))
            .collect();
        if edit.changed() {
            palette.marked = 0;
        }
        palette.marked = palette.marked.saturating_sub(usize::from(up)) + usize::from(down);
        palette.marked = palette.marked.min(found.len().saturating_sub(1));
        let mut clicked = None;
        ScrollArea::vertical()
            .max_height(320.0)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                for (index, command) in found.iter().enumerate() {
                    let marked = index == palette.marked;
                    let row = ui
                        .horizontal(|ui| {
                            let row = ui.selectable_label(marked, say(&command.name));
                            ui.label(RichText::new(say(command.keys)).weak());
                            row
                        })
                        .inner;
                    if row.clicked() {
                        clicked = Some(index);
                    }
                    if marked && (up || down) {
                        row.scroll_to_me(None);
                    }
                }
                if found.is_empty() {
                    ui.label(RichText::new(say("Nothing has these words.")).weak());
                }
            });
        let taken = clicked.or(enter.then_some(palette.marked));
        chosen = taken.and_then(|index| found.into_iter().nth(index));
    });
    if chosen.is_some() || modal.should_close() {
        *palette = Palette::default();
    }
    if let Some(command) = chosen {
        (command.act)(state, session);
    }
}
