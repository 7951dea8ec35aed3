//! Draws the pictures that the window saves in a file, on any thread.

use super::{Film, Form};
use crate::picture::{self, Picture};
use crate::render::offscreen::Offscreen;
use crate::session::Shooting;

/// The bytes of a GIF, or of a PNG if there is only one picture; `None` if drawing was cancelled.
pub fn shoot(shooting: &Shooting) -> Result<Option<Vec<u8>>, String> {
    let mut studio = Offscreen::new().map_err(|error| error.to_string())?;
    let mut draw = |picture: &Picture| {
        let drawn = studio.shot(picture, shooting.size);
        shooting.reel.advance();
        drawn.map_err(|error| error.to_string())
    };
    if let [picture] = &shooting.pictures[..] {
        let png = picture::png(&draw(picture)?);
        return png
            .map(Some)
            .map_err(|error| format!("cannot encode the picture: {error}"));
    }
    let mut film = Film::new(shooting.delay);
    for picture in &shooting.pictures {
        if shooting.reel.is_cancelled() {
            return Ok(None);
        }
        film.push(draw(picture)?);
    }
    film.bytes(Form::Gif).map(Some)
}
