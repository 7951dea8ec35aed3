//! The texts of the window in Chinese. `{}` stands for a part that differs; on the right it is `{0}`, or
//! `{0!}` where it is a text of this table itself.

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
