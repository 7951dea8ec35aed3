//! Colours, sizes and distances of the control panel.

use egui::{Color32, CornerRadius, FontId, TextStyle, Vec2};

/// Things that run, and the way to make them run.
pub(super) const GREEN: Color32 = Color32::from_rgb(116, 196, 138);
/// Things that are held still or late.
pub(super) const AMBER: Color32 = Color32::from_rgb(232, 180, 92);
/// Things refused or failed.
pub(super) const RED: Color32 = Color32::from_rgb(240, 120, 110);
/// The selection, like the edges drawn over it.
pub(super) const BLUE: Color32 = Color32::from_rgb(110, 168, 254);

/// Sets the style of a new egui context: dark, quiet, with room around things, and with the system's
/// fonts for writing that egui's own fonts lack.
pub fn apply(ctx: &egui::Context) {
    let fonts = egui_system_font_provider::SystemFontProvider::new();
    ctx.add_font_provider(std::sync::Arc::new(fonts));
    ctx.set_theme(egui::Theme::Dark);
    ctx.all_styles_mut(|style| {
        style.text_styles = [
            (TextStyle::Heading, FontId::proportional(14.5)),
            (TextStyle::Body, FontId::proportional(13.0)),
            (TextStyle::Button, FontId::proportional(13.0)),
            (TextStyle::Monospace, FontId::monospace(12.0)),
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
        let visuals = &mut style.visuals;
        visuals.panel_fill = Color32::from_rgb(29, 31, 35);
        visuals.window_fill = Color32::from_rgb(36, 38, 43);
        visuals.extreme_bg_color = Color32::from_rgb(20, 21, 24);
        visuals.selection.bg_fill = Color32::from_rgb(48, 84, 140);
        visuals.widgets.noninteractive.fg_stroke.color = Color32::from_rgb(196, 200, 206);
        visuals.widgets.inactive.fg_stroke.color = Color32::from_rgb(216, 219, 224);
        visuals.widgets.inactive.weak_bg_fill = Color32::from_rgb(50, 53, 60);
        visuals.widgets.inactive.bg_fill = Color32::from_rgb(58, 62, 70);
        for widget in [
            &mut visuals.widgets.inactive,
            &mut visuals.widgets.hovered,
            &mut visuals.widgets.active,
            &mut visuals.widgets.open,
        ] {
            widget.corner_radius = CornerRadius::same(4);
        }
    });
}
