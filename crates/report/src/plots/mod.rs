//! Every plot of the page. A new one is a file here and a line in [`PLOTS`].

mod collisions;
mod drift;
mod panel;
mod resting;
mod stability;
mod style;
mod turning;
mod work_precision;

use crate::results::Results;

/// A section of the page.
pub(crate) struct Plot {
    /// Anchor on the page, and start of file names.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// What is drawn and how to read it.
    pub(crate) about: &'static str,
    pub(crate) draw: fn(&Results) -> Vec<Figure>,
}

pub(crate) static PLOTS: [&Plot; 6] = [
    &work_precision::PLOT,
    &drift::PLOT,
    &stability::PLOT,
    &collisions::PLOT,
    &resting::PLOT,
    &turning::PLOT,
];

/// A picture with what is said of it.
#[derive(Clone, Debug)]
pub(crate) struct Figure {
    /// Name of its file, without `.svg`.
    pub(crate) name: String,
    /// Above it, where a group of figures begins.
    pub(crate) heading: Option<&'static str>,
    pub(crate) caption: String,
    pub(crate) svg: String,
}
