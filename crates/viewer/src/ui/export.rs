//! Saves the curves of the plots: as a table (CSV) or a picture (PNG).

use super::{plots::Plots, style};
use crate::picture;
use crate::render::offscreen;
use crate::session::Session;
use crate::words::say;

/// Size of a picture of plots, pixels.
const SIZE: [u32; 2] = [2000, 800];

pub(super) fn buttons(ui: &mut egui::Ui, plots: &Plots, session: &mut Session) {
    if ui
        .button(say("CSV"))
        .on_hover_text(say(
            "Write all figures of the kept states of all runs as a table, into the folder that the \
             program was started in",
        ))
        .clicked()
    {
        let text = session.csv();
        session.export("csv", text.as_bytes());
    }
    if ui
        .button(say("PNG"))
        .on_hover_text(say(
            "Write the plots as a picture, into the folder that the program was started in",
        ))
        .clicked()
    {
        match png(plots, session) {
            Ok(bytes) => session.export("png", &bytes),
            Err(error) => session.notices().error("export", error),
        }
    }
}

/// The plots as a picture.
fn png(plots: &Plots, session: &mut Session) -> Result<Vec<u8>, String> {
    let context = egui::Context::default();
    style::apply(&context);
    let image = offscreen::panel(&context, SIZE, |ui| plots.draw(ui, session));
    let image = image.map_err(|error| error.to_string())?;
    picture::png(&image).map_err(|error| format!("Cannot encode the picture: {error}"))
}
