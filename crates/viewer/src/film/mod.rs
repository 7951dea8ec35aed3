//! Moving pictures as files. Of each frame only its changes are stored, and the film is written as a GIF or an animated
//! PNG.

mod apng;
mod command;
mod gif;
mod shooting;

use image::{Rgba, RgbaImage};

pub use command::write;
pub use shooting::shoot;

/// The most frames of a film.
pub const MOST_FRAMES: usize = 3000;

/// A sequence of frames.
#[derive(Debug)]
pub struct Film {
    size: [u32; 2],
    /// How long a frame is shown, hundredths of a second.
    delay: u16,
    last: Option<RgbaImage>,
    changes: Vec<Change>,
}

/// The difference of a frame from the one before it.
#[derive(Debug)]
struct Change {
    /// The upper left corner, pixels.
    at: [u32; 2],
    /// The rectangle around the changes; unchanged pixels in it are transparent.
    pixels: RgbaImage,
}

/// The file format of a film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// 256 colours for the changes from frame to frame.
    Gif,
    /// All colours (APNG).
    Png,
}

impl Form {
    /// The format by the extension of a path.
    pub fn of(path: &std::path::Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "gif" => Some(Self::Gif),
            "png" | "apng" => Some(Self::Png),
            _ => None,
        }
    }
}

impl Film {
    /// A film without frames; each frame is shown for `delay` hundredths of a second.
    pub fn new(delay: u16) -> Self {
        Self {
            size: [0, 0],
            delay,
            last: None,
            changes: Vec::new(),
        }
    }

    /// Adds a frame of the size of the first.
    pub fn push(&mut self, image: RgbaImage) {
        let change = match &self.last {
            None => {
                self.size = [image.width(), image.height()];
                Change {
                    at: [0, 0],
                    pixels: image.clone(),
                }
            }
            Some(last) => changed(last, &image),
        };
        self.changes.push(change);
        self.last = Some(image);
    }

    /// The number of frames.
    pub fn len(&self) -> usize {
        self.changes.len()
    }

    /// Whether there are no frames.
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// The bytes of a file.
    pub fn bytes(&self, form: Form) -> Result<Vec<u8>, String> {
        match form {
            Form::Gif => gif::encode(self),
            Form::Png => apng::encode(self),
        }
    }
}

fn changed(last: &RgbaImage, next: &RgbaImage) -> Change {
    let differing = next.enumerate_pixels().filter(|&(x, y, pixel)| {
        let known = last.get_pixel_checked(x, y);
        known != Some(pixel)
    });
    let bounds = differing.fold(None, |bounds: Option<[u32; 4]>, (x, y, _)| match bounds {
        None => Some([x, y, x, y]),
        Some([left, top, right, bottom]) => {
            Some([x.min(left), y.min(top), x.max(right), y.max(bottom)])
        }
    });
    // A frame without changes still takes its time.
    let [left, top, right, bottom] = bounds.unwrap_or([0, 0, 0, 0]);
    let [width, height] = [right - left + 1, bottom - top + 1];
    let pixels = RgbaImage::from_fn(width, height, |x, y| {
        let (x, y) = (left + x, top + y);
        let pixel = next.get_pixel(x, y);
        match last.get_pixel_checked(x, y) == Some(pixel) {
            true => Rgba([0; 4]),
            false => *pixel,
        }
    });
    Change {
        at: [left, top],
        pixels,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A red dot on grey, at a place.
    fn dot(x: u32) -> RgbaImage {
        let mut image = RgbaImage::from_pixel(40, 30, Rgba([120, 120, 120, 255]));
        image.put_pixel(x, 7, Rgba([250, 10, 20, 255]));
        image
    }

    fn film() -> Film {
        let mut film = Film::new(4);
        for x in [3, 5, 5, 20] {
            film.push(dot(x));
        }
        film
    }

    #[test]
    fn only_what_changes_is_kept() {
        let film = film();
        let sizes: Vec<_> = film.changes.iter().map(|c| c.pixels.dimensions()).collect();
        assert_eq!(sizes, [(40, 30), (3, 1), (1, 1), (16, 1)]);
        assert_eq!(film.changes[1].at, [3, 7]);
        assert_eq!(film.changes[1].pixels.get_pixel(1, 0).0[3], 0, "it stays");
    }

    #[test]
    fn a_gif_shows_each_frame_again() {
        let film = film();
        let bytes = film.bytes(Form::Gif).expect("a file");
        let mut options = ::gif::DecodeOptions::new();
        options.set_color_output(::gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&bytes[..]).expect("a GIF");
        let mut shown = RgbaImage::new(40, 30);
        for x in [3, 5, 5, 20] {
            let frame = decoder
                .read_next_frame()
                .expect("a frame")
                .expect("one more");
            assert_eq!(frame.delay, 4);
            let pixels = frame.buffer.chunks_exact(4);
            for (n, pixel) in pixels.enumerate().filter(|(_, p)| p[3] > 0) {
                let (column, row) = (
                    n as u32 % u32::from(frame.width),
                    n as u32 / u32::from(frame.width),
                );
                let pixel = Rgba([pixel[0], pixel[1], pixel[2], 255]);
                shown.put_pixel(
                    u32::from(frame.left) + column,
                    u32::from(frame.top) + row,
                    pixel,
                );
            }
            for (found, wanted) in shown.iter().zip(dot(x).iter()) {
                assert!(found.abs_diff(*wanted) <= 4, "{found} for {wanted}");
            }
        }
        assert!(decoder.read_next_frame().expect("the end").is_none());
    }

    #[test]
    fn a_rare_colour_stays_the_same_among_many() {
        let violet = [148, 13, 217];
        let mut film = Film::new(4);
        for step in 0..12 {
            let mut image = RgbaImage::from_fn(84, 48, |x, y| {
                let shade = (x + y + 3 * step) % 256;
                Rgba([shade as u8, (255 - shade) as u8, (x * 255 / 160) as u8, 255])
            });
            for (x, y) in (0..4).flat_map(|x| (0..4).map(move |y| (x, y))) {
                image.put_pixel(
                    20 + 5 * step + x,
                    40 + y,
                    Rgba([violet[0], violet[1], violet[2], 255]),
                );
            }
            film.push(image);
        }
        let bytes = film.bytes(Form::Gif).expect("a file");
        let mut options = ::gif::DecodeOptions::new();
        options.set_color_output(::gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&bytes[..]).expect("a GIF");
        let mut step = 0;
        while let Some(frame) = decoder.read_next_frame().expect("a frame") {
            let (x, y) = (
                21 + 5 * step - u32::from(frame.left),
                41 - u32::from(frame.top),
            );
            let at = 4 * (y * u32::from(frame.width) + x) as usize;
            for (found, wanted) in frame.buffer[at..].iter().zip(violet) {
                assert!(
                    found.abs_diff(wanted) <= 16,
                    "frame {step}: {:?}",
                    &frame.buffer[at..at + 4]
                );
            }
            step += 1;
        }
        assert_eq!(step, 12);
    }

    #[test]
    fn an_animated_png_has_all_frames_and_begins_with_the_first() {
        let bytes = film().bytes(Form::Png).expect("a file");
        let decoder = ::png::Decoder::new(std::io::Cursor::new(&bytes[..]));
        let mut reader = decoder.read_info().expect("a PNG");
        let animation = reader.info().animation_control().expect("it is animated");
        assert_eq!((animation.num_frames, animation.num_plays), (4, 0));
        let mut first = vec![0; reader.output_buffer_size().expect("a size")];
        reader.next_frame(&mut first).expect("a frame");
        assert_eq!(first, dot(3).into_raw());
        for _ in 1..4 {
            let mut frame = vec![0; reader.output_buffer_size().expect("a size")];
            reader.next_frame(&mut frame).expect("a frame");
            let control = reader.info().frame_control().expect("of the frame");
            assert_eq!((control.delay_num, control.delay_den), (4, 100));
        }
    }
}
