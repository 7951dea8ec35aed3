//! The curves of the plots as files: a table (CSV) or a picture (PNG).

use super::plots::Plots;
use crate::session::Session;

pub(super) fn buttons(ui: &mut egui::Ui, plots: &Plots, session: &mut Session) {
    let _ = plots;
    if ui
        .button("CSV")
        .on_hover_text(
            "Write all figures of the kept states of all runs as a table, into the folder that the \
             program was started in",
        )
        .clicked()
    {
        let text = session.csv();
        session.export("csv", text.as_bytes());
    }
}
