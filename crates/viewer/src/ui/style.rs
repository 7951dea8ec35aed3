//! Colours, sizes and distances of the control panel, dark and light.

use egui::{Color32, CornerRadius, FontId, TextStyle, Theme, Vec2, Visuals};

/// A colour with a meaning, in tones that are legible in the two themes.
#[derive(Clone, Copy)]
pub(super) struct Tone {
    dark: Color32,
    light: Color32,
}

impl Tone {
    const fn new(dark: [u8; 3], light: [u8; 3]) -> Self {
        Self {
            dark: Color32::from_rgb(dark[0], dark[1], dark[2]),
            light: Color32::from_rgb(light[0], light[1], light[2]),
        }
    }

    /// The tone over the picture, where text has a dark background in both themes.
    pub(super) const fn over_picture(self) -> Color32 {
        self.dark
    }

    /// The tone for a theme.
    pub(super) fn of(self, visuals: &Visuals) -> Color32 {
        match visuals.dark_mode {
            true => self.dark,
            false => self.light,
        }
    }
}

/// Running things, and the button to run them.
pub(super) const GREEN: Tone = Tone::new([116, 196, 138], [20, 104, 52]);
/// Paused or late things.
pub(super) const AMBER: Tone = Tone::new([232, 180, 92], [126, 78, 0]);
/// Refusals and failures.
pub(super) const RED: Tone = Tone::new([240, 120, 110], [176, 32, 24]);
/// The selection, as the edges of selected bodies.
pub(super) const BLUE: Tone = Tone::new([110, 168, 254], [22, 84, 184]);

/// The background of text over the picture.
pub(super) const OVER_PICTURE: Color32 = Color32::from_black_alpha(210);
/// The background of the numbers on the axes over the light picture, and their text colour.
pub(super) const OVER_AXES: Color32 = Color32::from_rgba_premultiplied(150, 150, 150, 150);
pub(super) const AXIS_INK: Color32 = Color32::from_gray(30);

/// The least contrast of text against its background: that of the accessibility guidelines for small text.
const CONTRAST: f32 = 4.5;
/// Least contrast of curves and dots.
const CURVE_CONTRAST: f32 = 3.0;

/// Sets the style of a new egui context: calm, with generous spacing, and with the system's fonts for scripts that
/// egui's own fonts lack.
pub fn apply(ctx: &egui::Context) {
    // Han characters in their Chinese rather than Japanese forms.
    let fonts = egui_system_font_provider::SystemFontProvider::new().with_locale(Some("zh-Hans"));
    ctx.add_font_provider(std::sync::Arc::new(fonts));
    ctx.set_theme(Theme::Dark);
    ctx.all_styles_mut(|style| {
        style.text_styles = [
            (TextStyle::Heading, FontId::proportional(14.5)),
            (TextStyle::Body, FontId::proportional(13.0)),
            (TextStyle::Button, FontId::proportional(13.0)),
            // Its digits have equal widths, and its zeros cannot be mistaken for eights.
            (TextStyle::Monospace, FontId::proportional(13.0)),
            (TextStyle::Small, FontId::proportional(11.0)),
        ]
        .into();
        let spacing = &mut style.spacing;
        spacing.item_spacing = Vec2::new(8.0, 6.0);
        spacing.button_padding = Vec2::new(8.0, 3.0);
        spacing.interact_size.y = 22.0;
        spacing.slider_width = 130.0;
        spacing.tooltip_width = 320.0;
        spacing.scroll = egui::style::ScrollStyle::thin();
        let widgets = &mut style.visuals.widgets;
        for widget in [
            &mut widgets.inactive,
            &mut widgets.hovered,
            &mut widgets.active,
            &mut widgets.open,
        ] {
            widget.corner_radius = CornerRadius::same(4);
        }
    });
    ctx.style_mut_of(Theme::Dark, |style| dark(&mut style.visuals));
    ctx.style_mut_of(Theme::Light, |style| light(&mut style.visuals));
}

fn dark(visuals: &mut Visuals) {
    visuals.panel_fill = Color32::from_rgb(29, 31, 35);
    visuals.window_fill = Color32::from_rgb(36, 38, 43);
    visuals.extreme_bg_color = Color32::from_rgb(20, 21, 24);
    visuals.selection.bg_fill = Color32::from_rgb(48, 84, 140);
    visuals.weak_text_color = Some(Color32::from_rgb(150, 155, 163));
    visuals.widgets.noninteractive.fg_stroke.color = Color32::from_rgb(196, 200, 206);
    visuals.widgets.inactive.fg_stroke.color = Color32::from_rgb(216, 219, 224);
    visuals.widgets.inactive.weak_bg_fill = Color32::from_rgb(50, 53, 60);
    visuals.widgets.inactive.bg_fill = Color32::from_rgb(58, 62, 70);
}

fn light(visuals: &mut Visuals) {
    visuals.panel_fill = Color32::from_rgb(243, 244, 246);
    visuals.window_fill = Color32::from_rgb(250, 250, 251);
    visuals.extreme_bg_color = Color32::WHITE;
    visuals.selection.bg_fill = Color32::from_rgb(176, 206, 250);
    visuals.selection.stroke.color = Color32::from_rgb(10, 40, 96);
    visuals.weak_text_color = Some(Color32::from_rgb(92, 97, 105));
    visuals.widgets.noninteractive.fg_stroke.color = Color32::from_rgb(48, 52, 58);
    visuals.widgets.inactive.fg_stroke.color = Color32::from_rgb(34, 37, 42);
    visuals.widgets.inactive.weak_bg_fill = Color32::from_rgb(224, 227, 232);
    visuals.widgets.inactive.bg_fill = Color32::from_rgb(206, 210, 217);
}

/// A colour of the picture for a curve or dot on the background of plots, darkened or lightened until it is visible.
pub(super) fn curve(colour: [f32; 3], visuals: &Visuals) -> Color32 {
    apart(colour, visuals.extreme_bg_color, CURVE_CONTRAST)
}

/// A colour of the picture for text on a panel.
pub(super) fn word(colour: [f32; 3], visuals: &Visuals) -> Color32 {
    apart(colour, visuals.panel_fill, CONTRAST)
}

fn apart([red, green, blue]: [f32; 3], from: Color32, least: f32) -> Color32 {
    let byte = |part: f32| (255.0 * part).round() as u8;
    let colour = Color32::from_rgb(byte(red), byte(green), byte(blue));
    let end = match luminance(from) < 0.18 {
        true => Color32::WHITE,
        false => Color32::BLACK,
    };
    let steps = (0..=20).map(|part| colour.lerp_to_gamma(end, part as f32 / 20.0));
    let mut seen = steps.filter(|&colour| contrast(colour, from) >= least);
    seen.next().unwrap_or(end)
}

/// The contrast ratio of two colours, from 1 to 21, by WCAG 2.
fn contrast(a: Color32, b: Color32) -> f32 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

fn luminance(colour: Color32) -> f32 {
    let [red, green, blue, _] = egui::Rgba::from(colour).to_array();
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

#[cfg(test)]
mod tests {
    use super::*;

    fn themes() -> [Visuals; 2] {
        let context = egui::Context::default();
        apply(&context);
        [Theme::Dark, Theme::Light].map(|theme| context.style_of(theme).visuals.clone())
    }

    #[test]
    fn all_text_is_told_from_what_is_behind_it() {
        for visuals in themes() {
            let plain = [
                visuals.text_color(),
                visuals.strong_text_color(),
                visuals.weak_text_color(),
                GREEN.of(&visuals),
                AMBER.of(&visuals),
                RED.of(&visuals),
                BLUE.of(&visuals),
            ];
            for text in plain {
                for behind in [visuals.panel_fill, visuals.window_fill] {
                    let told = contrast(text, behind);
                    assert!(told >= CONTRAST, "{text:?} on {behind:?}: {told}");
                }
            }
            let widgets = &visuals.widgets;
            for widget in [
                &widgets.inactive,
                &widgets.hovered,
                &widgets.active,
                &widgets.open,
            ] {
                for behind in [widget.weak_bg_fill, widget.bg_fill] {
                    let told = contrast(widget.text_color(), behind);
                    assert!(told >= CONTRAST, "{widget:?}: {told}");
                }
            }
            let told = contrast(visuals.selection.stroke.color, visuals.selection.bg_fill);
            assert!(told >= CONTRAST, "selection: {told}");
        }
    }

    #[test]
    fn text_over_the_picture_is_told_from_any_of_it() {
        let over = |below: Color32, ground: Color32| below.blend(ground);
        for below in [Color32::WHITE, Color32::BLACK, Color32::from_gray(128)] {
            let ground = over(below, OVER_PICTURE);
            for text in [Color32::WHITE, BLUE.over_picture()] {
                let told = contrast(text, ground);
                assert!(told >= CONTRAST, "{text:?} over {below:?}: {told}");
            }
        }
        // The backgrounds of numbers on axes: the sky, the ground, and the darkest bodies of the gallery.
        for below in [0.84, 0.66, 0.35] {
            let below = Color32::from_gray((255.0 * below) as u8);
            let told = contrast(AXIS_INK, over(below, OVER_AXES));
            assert!(told >= CONTRAST, "over {below:?}: {told}");
        }
    }

    #[test]
    fn every_colour_of_a_body_is_seen_in_plots_and_lists() {
        let colours = crate::picture::PALETTE;
        let extremes = [[0.0; 3], [1.0; 3], [0.93, 0.94, 0.96], [1.0, 1.0, 0.0]];
        for visuals in themes() {
            for colour in colours.into_iter().chain(extremes) {
                let told = contrast(curve(colour, &visuals), visuals.extreme_bg_color);
                assert!(told >= CURVE_CONTRAST, "{colour:?}: {told}");
                let told = contrast(word(colour, &visuals), visuals.panel_fill);
                assert!(told >= CONTRAST, "{colour:?}: {told}");
            }
        }
    }
}
