//! A film as an animated PNG.

use png::{BitDepth, BlendOp, ColorType, Compression, DisposeOp, Encoder};

use super::Film;
use crate::session::TICKS;

pub(super) fn encode(film: &Film) -> Result<Vec<u8>, String> {
    let told = |error: png::EncodingError| format!("cannot encode the PNG: {error}");
    let [width, height] = film.size;
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Balanced);
    encoder.set_animated(film.len() as u32, 0).map_err(told)?;
    encoder
        .set_frame_delay(film.delay, TICKS as u16)
        .map_err(told)?;
    encoder.set_blend_op(BlendOp::Over).map_err(told)?;
    encoder.set_dispose_op(DisposeOp::None).map_err(told)?;
    let mut writer = encoder.write_header().map_err(told)?;
    for (n, change) in film.changes.iter().enumerate() {
        if n > 0 {
            let (width, height) = change.pixels.dimensions();
            let [x, y] = change.at;
            // The position is reset first, because every size is valid at the corner.
            writer.reset_frame_position().map_err(told)?;
            writer.set_frame_dimension(width, height).map_err(told)?;
            writer.set_frame_position(x, y).map_err(told)?;
        }
        writer
            .write_image_data(change.pixels.as_raw())
            .map_err(told)?;
    }
    writer.finish().map_err(told)?;
    Ok(bytes)
}
