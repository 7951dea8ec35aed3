//! Writes a film as a GIF: one palette for all frames, so that colours are equal in all frames.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet, HashMap};

use gif::{DisposalMethod, Encoder, Frame, Repeat};

use super::Film;

/// The number of colours of the palette; the last of 256 entries marks unchanged pixels.
const COLOURS: usize = 255;
/// Colours whose components all differ by less than this count as one when the palette is chosen.
const APART: u8 = 4;

type Colour = [u8; 3];

pub(super) fn encode(film: &Film) -> Result<Vec<u8>, String> {
    let told = |error: gif::EncodingError| format!("cannot encode the GIF: {error}");
    let side = |pixels: u32| {
        u16::try_from(pixels)
            .map_err(|_| format!("a GIF has no more than 65535 pixels a side, not {pixels}"))
    };
    let [width, height] = film.size;
    let mut palette = Palette::of(film);
    let mut bytes = Vec::new();
    let table = palette.table();
    let mut encoder =
        Encoder::new(&mut bytes, side(width)?, side(height)?, &table).map_err(told)?;
    encoder.set_repeat(Repeat::Infinite).map_err(told)?;
    for change in &film.changes {
        let (width, height) = change.pixels.dimensions();
        let indices = change.pixels.pixels().map(|pixel| match pixel.0 {
            [.., 0] => COLOURS as u8,
            [red, green, blue, _] => palette.nearest([red, green, blue]),
        });
        let frame = Frame {
            delay: film.delay,
            dispose: DisposalMethod::Keep,
            transparent: Some(COLOURS as u8),
            left: side(change.at[0])?,
            top: side(change.at[1])?,
            width: side(width)?,
            height: side(height)?,
            buffer: Cow::Owned(indices.collect()),
            ..Frame::default()
        };
        encoder.write_frame(&frame).map_err(told)?;
    }
    drop(encoder);
    Ok(bytes)
}

/// The colours of a film.
struct Palette {
    colours: Vec<Colour>,
    known: HashMap<Colour, u8>,
}

impl Palette {
    fn of(film: &Film) -> Self {
        let mut exact: BTreeSet<Colour> = BTreeSet::new();
        let mut alike: BTreeMap<Colour, Alike> = BTreeMap::new();
        let pixels = film
            .changes
            .iter()
            .flat_map(|change| change.pixels.pixels());
        for pixel in pixels.filter(|pixel| pixel.0[3] > 0) {
            let [red, green, blue, _] = pixel.0;
            let colour = [red, green, blue];
            if exact.len() <= COLOURS {
                exact.insert(colour);
            }
            let bin = alike.entry(colour.map(|part| part / APART)).or_default();
            bin.count += 1;
            for (sum, part) in bin.sum.iter_mut().zip(colour) {
                *sum += u64::from(part);
            }
        }
        let colours = match exact.len() <= COLOURS {
            true => exact.into_iter().collect(),
            false => chosen(alike.into_values().collect()),
        };
        Self {
            colours,
            known: HashMap::new(),
        }
    }

    /// All 256 colours, in the format of a GIF.
    fn table(&self) -> Vec<u8> {
        let mut table: Vec<u8> = self.colours.iter().flatten().copied().collect();
        table.resize(3 * (COLOURS + 1), 0);
        table
    }

    fn nearest(&mut self, colour: Colour) -> u8 {
        let colours = &self.colours;
        *self.known.entry(colour).or_insert_with(|| {
            let away = |other: &Colour| -> i32 {
                let parts = other.iter().zip(colour);
                parts
                    .map(|(&a, b)| (i32::from(a) - i32::from(b)).pow(2))
                    .sum()
            };
            let places = colours.iter().enumerate();
            let nearest = places.min_by_key(|(_, other)| away(other));
            nearest.map_or(0, |(place, _)| place as u8)
        })
    }
}

/// Pixels of nearly one colour.
#[derive(Clone, Copy, Default)]
struct Alike {
    count: u64,
    /// The sums of the components.
    sum: [u64; 3],
}

impl Alike {
    fn mean(&self) -> Colour {
        // The mean of a component is no greater than its maximum, so it fits.
        self.sum.map(|sum| (sum / self.count.max(1)) as u8)
    }
}

/// Chooses a palette for more colours than fit into it. The colour space is repeatedly split where it is widest, with a
/// small preference for many pixels. So a rare colour, mostly a mark that must be visible, has an entry of its own as
/// long as no other colour is near it.
fn chosen(all: Vec<Alike>) -> Vec<Colour> {
    let mut cells = vec![Cell::of(all)];
    while cells.len() < COLOURS {
        let widest = cells
            .iter()
            .enumerate()
            .max_by(|(_, a), (_, b)| a.need.total_cmp(&b.need));
        let Some((place, _)) = widest.filter(|(_, cell)| cell.need > 0.0) else {
            break;
        };
        let Cell {
            alike,
            axis,
            middle,
            ..
        } = cells.swap_remove(place);
        let (low, high) = alike.into_iter().partition(|a| a.mean()[axis] <= middle);
        cells.extend([low, high].map(Cell::of));
    }
    let mean = |cell: &Cell| {
        let sum = |k: usize| cell.alike.iter().map(|a| a.sum[k]).sum();
        let count = cell.alike.iter().map(|a| a.count).sum();
        let sum = [sum(0), sum(1), sum(2)];
        Alike { count, sum }.mean()
    };
    cells.iter().map(mean).collect()
}

/// A region of the colour space.
struct Cell {
    alike: Vec<Alike>,
    /// The component along which the region is widest, and the middle there.
    axis: usize,
    middle: u8,
    /// The benefit of splitting the region; 0 for a single colour.
    need: f64,
}

impl Cell {
    fn of(alike: Vec<Alike>) -> Self {
        let ends = |k: usize| {
            let parts = alike.iter().map(|a| a.mean()[k]);
            parts.fold((u8::MAX, 0), |(least, most), part| {
                (least.min(part), most.max(part))
            })
        };
        let sides = [0, 1, 2].map(|k| {
            let (least, most) = ends(k);
            (most.saturating_sub(least), k, least)
        });
        let (side, axis, least) = sides.into_iter().max().unwrap_or_default();
        let count: u64 = alike.iter().map(|a| a.count).sum();
        Self {
            axis,
            middle: least + side / 2,
            need: f64::from(side) * (1.0 + count as f64).log2(),
            alike,
        }
    }
}
