//! A film as a GIF.

use gif::{DisposalMethod, Encoder, Frame, Repeat};

use super::Film;

/// How closely colours are matched, from 1 (closest) to 30.
const SPEED: i32 = 10;

pub(super) fn encode(film: &Film) -> Result<Vec<u8>, String> {
    let told = |error: gif::EncodingError| format!("cannot encode the GIF: {error}");
    let side = |pixels: u32| {
        u16::try_from(pixels)
            .map_err(|_| format!("a GIF has no more than 65535 pixels a side, not {pixels}"))
    };
    let [width, height] = film.size;
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, side(width)?, side(height)?, &[]).map_err(told)?;
    encoder.set_repeat(Repeat::Infinite).map_err(told)?;
    for change in &film.changes {
        let (width, height) = change.pixels.dimensions();
        let mut pixels = change.pixels.as_raw().clone();
        let mut frame = Frame::from_rgba_speed(side(width)?, side(height)?, &mut pixels, SPEED);
        (frame.left, frame.top) = (side(change.at[0])?, side(change.at[1])?);
        frame.delay = film.delay;
        frame.dispose = DisposalMethod::Keep;
        encoder.write_frame(&frame).map_err(told)?;
    }
    drop(encoder);
    Ok(bytes)
}
