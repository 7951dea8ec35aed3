//! The gallery: the built-in scenes with pictures, in the order of the labs.

use std::collections::HashMap;

use egui::{ColorImage, Image, Key, RichText, ScrollArea, Sense, TextEdit, TextureHandle};
use scene::GalleryScene;

use crate::session::{BEYOND, LABS, Leaving, Session};
use crate::words::{Language, say};

/// Size of a picture, points; the files have two pixels per point.
const PICTURE: [f32; 2] = [216.0, 135.0];
/// Cards side by side at most.
const COLUMNS: usize = 3;

/// The state of the gallery between frames.
#[derive(Default)]
pub(super) struct Gallery {
    pub(super) open: bool,
    /// Whether it was open in the last frame too.
    stays: bool,
    search: String,
    pictures: HashMap<&'static str, TextureHandle>,
}

impl Gallery {
    /// The textures are lost when the context changes.
    pub(super) fn forget_pictures(&mut self) {
        self.pictures.clear();
    }
}

/// The picture of each scene, as a PNG file.
macro_rules! pictures {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_bytes!(concat!("../../../../assets/pictures/", $name, ".png")))),*]
    };
}

static PICTURES: &[(&str, &[u8])] = pictures![
    "cube-cow",
    "parabola",
    "five-hertz",
    "two-cubes",
    "bounce",
    "bullet",
    "cradle",
    "galperin",
    "closing-walls",
    "u-channel",
    "hundred-cubes",
    "herd",
    "stack",
    "slope",
    "dominoes",
    "conveyor",
    "wall",
    "funnel",
    "bin",
    "spring",
    "stiff-spring",
    "oscillator",
    "drag",
    "kepler",
    "pleiades",
    "tennis-racket",
    "cubes-turning",
    "wobbling-plate",
    "cube-cow-spin",
    "cows-turning",
    "nut-on-bolt",
    "top",
    "chain",
];

pub(super) fn show(ctx: &egui::Context, gallery: &mut Gallery, session: &mut Session) {
    let opens = gallery.open && !gallery.stays;
    gallery.stays = gallery.open;
    if !gallery.open {
        return;
    }
    if opens {
        gallery.search.clear();
    }
    let room = ctx.content_rect().size() - egui::vec2(60.0, 90.0);
    let mut open = true;
    let mut chosen = None;
    egui::Window::new(say("Gallery"))
        .id(egui::Id::unique("gallery"))
        .open(&mut open)
        .collapsible(false)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(ctx.content_rect().center())
        .default_size(egui::vec2(720.0, 640.0).min(room))
        .show(ctx, |ui| {
            let edit = TextEdit::singleline(&mut gallery.search)
                .hint_text(say("search for a name or word"))
                .desired_width(f32::INFINITY);
            let edit = ui.add(edit);
            edit.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::TextInput, true, say("Search the gallery"))
            });
            if opens {
                edit.request_focus();
            }
            let entered = edit.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            ScrollArea::vertical()
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    chosen = sections(ui, gallery, &session.scene().name);
                });
            if entered && !gallery.search.trim().is_empty() {
                let mut all = labs().into_iter().flat_map(|(_, scenes)| scenes);
                let first = all.find(|entry| matches(entry, &gallery.search));
                chosen = chosen.or(first.map(|entry| entry.name));
            }
        });
    if let Some(name) = chosen {
        session.leave(Leaving::Open(name.into()));
        open = false;
    }
    gallery.open = open && !ctx.input(|input| input.key_pressed(Key::Escape));
}

/// The labs with the scenes that match the search; returns the chosen scene, if any.
fn sections(ui: &mut egui::Ui, gallery: &mut Gallery, now: &str) -> Option<&'static str> {
    let mut chosen = None;
    let mut any = false;
    for (title, scenes) in labs() {
        let found = scenes
            .into_iter()
            .filter(|entry| matches(entry, &gallery.search));
        let found: Vec<&GalleryScene> = found.collect();
        if found.is_empty() {
            continue;
        }
        any = true;
        ui.add_space(6.0);
        ui.label(RichText::new(say(title)).heading());
        let fit = ((ui.available_width() / (PICTURE[0] + 14.0)) as usize).clamp(1, COLUMNS);
        for row in found.chunks(fit) {
            ui.columns(fit, |columns| {
                for (ui, entry) in columns.iter_mut().zip(row) {
                    // Columns would justify the text.
                    let ragged = egui::Layout::top_down(egui::Align::Min);
                    let card =
                        ui.with_layout(ragged, |ui| card(ui, gallery, entry, entry.name == now));
                    if card.inner {
                        chosen = Some(entry.name);
                    }
                }
            });
        }
    }
    if !any {
        ui.label(RichText::new(say("No scene has these words.")).weak());
    }
    chosen
}

/// One scene. Returns whether it was chosen.
fn card(ui: &mut egui::Ui, gallery: &mut Gallery, entry: &GalleryScene, now: bool) -> bool {
    let title = say(entry.title());
    let about = say(entry.about());
    let card = egui::Frame::new()
        .inner_margin(4.0)
        .corner_radius(6.0)
        .fill(match now {
            true => ui.visuals().selection.bg_fill,
            false => ui.visuals().faint_bg_color,
        })
        .show(ui, |ui| {
            ui.set_min_width(ui.available_width());
            if let Some(picture) = picture(ui.ctx(), gallery, entry.name) {
                let width = ui.available_width().min(PICTURE[0]);
                let size = egui::vec2(width, width * PICTURE[1] / PICTURE[0]);
                let image = Image::new(egui::load::SizedTexture::new(picture, size));
                ui.add(image.corner_radius(4.0));
            }
            let colour = match now {
                true => ui.visuals().selection.stroke.color,
                false => ui.visuals().strong_text_color(),
            };
            let text = RichText::new(&title).strong().color(colour);
            ui.add(egui::Label::new(text).truncate().selectable(false));
            let line = RichText::new(first_sentence(&about))
                .small()
                .color(match now {
                    true => colour,
                    false => ui.visuals().text_color(),
                });
            ui.add(egui::Label::new(line).wrap().selectable(false));
        })
        .response
        .interact(Sense::click())
        .on_hover_text(format!("{about}\n({})", entry.name));
    card.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &title));
    card.clicked()
}

fn picture(
    ctx: &egui::Context,
    gallery: &mut Gallery,
    name: &'static str,
) -> Option<egui::TextureId> {
    if let Some(known) = gallery.pictures.get(name) {
        return Some(known.id());
    }
    let (_, bytes) = PICTURES.iter().find(|(known, _)| *known == name)?;
    let image = image::load_from_memory(bytes).ok()?.to_rgba8();
    let size = [image.width() as usize, image.height() as usize];
    let image = ColorImage::from_rgba_unmultiplied(size, image.as_raw());
    let texture = ctx.load_texture(name, image, egui::TextureOptions::LINEAR);
    let id = texture.id();
    gallery.pictures.insert(name, texture);
    Some(id)
}

/// All scenes, by lab; scenes of no lab come last.
fn labs() -> Vec<(&'static str, Vec<&'static GalleryScene>)> {
    let named = |name: &&str| scene::SCENES.iter().find(|entry| entry.name == *name);
    let mut labs: Vec<(&str, Vec<&GalleryScene>)> = LABS
        .iter()
        .map(|lab| (lab.title, lab.scenes.iter().filter_map(named).collect()))
        .collect();
    let in_lab = |entry: &GalleryScene| LABS.iter().any(|lab| lab.scenes.contains(&entry.name));
    let beyond = scene::SCENES.iter().filter(|entry| !in_lab(entry));
    labs.push((BEYOND, beyond.collect()));
    labs
}

/// Whether all words occur in the name, title or text of a scene, in any language.
fn matches(entry: &GalleryScene, words: &str) -> bool {
    let mut text = entry.name.to_lowercase();
    for part in [entry.title(), entry.about()] {
        for language in Language::ALL {
            text.push(' ');
            text += &language.say(part).to_lowercase();
        }
    }
    let words = words.to_lowercase();
    words.split_whitespace().all(|word| text.contains(word))
}

/// The text before the first full stop that ends a sentence.
fn first_sentence(text: &str) -> &str {
    let ends = text.match_indices(['.', '。']).find_map(|(at, end)| {
        let after = &text[at + end.len()..];
        let ended = !end.is_ascii() || after.is_empty() || after.starts_with(' ');
        ended.then_some(at)
    });
    &text[..ends.unwrap_or(text.len())]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_has_a_picture_and_stands_once() {
        let mut names: Vec<&str> = Vec::new();
        for (_, scenes) in labs() {
            names.extend(scenes.iter().map(|entry| entry.name));
        }
        for entry in scene::SCENES {
            let count = names.iter().filter(|name| **name == entry.name).count();
            assert_eq!(count, 1, "{}", entry.name);
            let picture = PICTURES.iter().find(|(name, _)| *name == entry.name);
            let (_, bytes) = picture.expect(entry.name);
            let image = image::load_from_memory(bytes).expect(entry.name);
            let size = [image.width(), image.height()].map(|side| side as f32 / 2.0);
            assert_eq!(size, PICTURE, "{}", entry.name);
        }
        for lab in &LABS {
            for name in lab
                .scenes
                .iter()
                .chain(lab.stops.iter().map(|stop| &stop.scene))
            {
                assert!(
                    scene::SCENES.iter().any(|entry| entry.name == *name),
                    "{name}"
                );
            }
        }
    }

    #[test]
    fn scenes_are_found_by_words_in_either_language() {
        let found = |words: &str| -> Vec<&str> {
            let scenes = scene::SCENES.iter();
            let found = scenes.filter(|entry| matches(entry, words));
            found.map(|entry| entry.name).collect()
        };
        assert_eq!(found("").len(), scene::SCENES.len());
        assert_eq!(found("newton cradle"), ["cradle"]);
        assert_eq!(found("牛顿"), ["cradle"]);
        assert!(found("no such word").is_empty());
    }

    #[test]
    fn a_sentence_ends_at_its_stop() {
        let cases = [
            ("Flies 0.5 m. Then stops.", "Flies 0.5 m"),
            ("飞了 0.5 米。然后停下。", "飞了 0.5 米"),
            ("no end", "no end"),
        ];
        for (text, first) in cases {
            assert_eq!(first_sentence(text), first);
        }
    }
}
