//! The texts of the window in Chinese. `{}` stands for a variable part; in the translation it is `{0}`, or `{0!}` if
//! the part is itself a text of this table.

mod display;
mod figures;
mod files;
mod gallery;
mod messages;
mod physics;
mod refusals;
mod tour;
mod window;

pub(super) const TEXTS: [&[(&str, &str)]; 9] = [
    display::TEXTS,
    figures::TEXTS,
    files::TEXTS,
    gallery::TEXTS,
    messages::TEXTS,
    physics::TEXTS,
    refusals::TEXTS,
    tour::TEXTS,
    window::TEXTS,
];
