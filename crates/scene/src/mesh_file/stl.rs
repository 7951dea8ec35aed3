//! STL, as text or binary: triangles without shared vertices.
//!
//! The parser is our own because messages need line numbers and the count in a binary file is not trusted. Normals are
//! not read, because the order of the corners determines them. The format states neither unit nor up axis.

use glam::Vec3;

use super::soup::{MAX_TRIANGLES, ReadError, Soup};
use super::{Format, encoding};
use crate::shown;

/// STL.
pub(super) const FORMAT: Format = Format {
    name: "stl",
    title: "STL",
    extensions: &["stl"],
    read,
};

/// Bytes before the count of triangles in a binary file.
const HEADER: usize = 80;

/// Bytes of a triangle in a binary file: the normal, three corners, and two bytes for attributes such as colour.
const TRIANGLE: usize = 50;

fn read(bytes: &[u8]) -> Result<Soup, ReadError> {
    let soup = match declared(bytes) {
        // Some binary files start with `solid` too, but only binary files have the length that their count gives.
        Some(count) if bytes.len() == HEADER + 4 + TRIANGLE * count => binary(bytes, count)?,
        _ if looks_like_text(bytes) => text(bytes)?,
        Some(count) => binary(bytes, count)?,
        None => {
            return Err(ReadError::new(format!(
                "has {} bytes and does not start with `solid`: it is no STL file, or cut off",
                bytes.len()
            )));
        }
    };
    if soup.triangles.is_empty() {
        return Err(ReadError::new("has no facets: is it an STL file?"));
    }
    Ok(soup)
}

/// The number of triangles that a binary file declares.
fn declared(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER..)?.first_chunk::<4>()?;
    usize::try_from(u32::from_le_bytes(*count)).ok()
}

fn looks_like_text(bytes: &[u8]) -> bool {
    let text = encoding::by_mark(bytes);
    let start = text.trim_ascii_start().first_chunk::<5>();
    let start = start.is_some_and(|start| start.eq_ignore_ascii_case(b"solid"));
    start && !text[..text.len().min(512)].contains(&0)
}

fn binary(bytes: &[u8], count: usize) -> Result<Soup, ReadError> {
    check_count(count)?;
    let triangles = &bytes[HEADER + 4..];
    let held = triangles.len() / TRIANGLE;
    if held < count {
        return Err(ReadError::new(format!(
            "says that it has {count} triangles and holds {held}: it is cut off, or no STL file"
        )));
    }
    // Some exporters append bytes of their own.
    let mut soup = Soup::default();
    for (number, triangle) in triangles.chunks_exact(TRIANGLE).take(count).enumerate() {
        let mut numbers = triangle[12..48].as_chunks::<4>().0.iter();
        let mut next = || numbers.next().map_or(f32::NAN, |&b| f32::from_le_bytes(b));
        for _ in 0..3 {
            let corner = Vec3::new(next(), next(), next());
            if !corner.is_finite() {
                return Err(ReadError::new(format!(
                    "triangle {} has a corner that is not finite: coordinates must be numbers",
                    number + 1
                )));
            }
            soup.vertices.push(corner);
        }
    }
    number_corners(&mut soup);
    Ok(soup)
}

fn text(bytes: &[u8]) -> Result<Soup, ReadError> {
    let decoded = encoding::by_mark(bytes);
    let mut words = Words {
        rest: &decoded,
        line: 1,
    };
    let mut soup = Soup::default();
    let mut is_ended = false;
    while let Some(word) = words.next() {
        match word.to_ascii_lowercase().as_slice() {
            b"solid" => {
                is_ended = false;
                words.skip_name();
            }
            b"endsolid" => {
                is_ended = true;
                words.skip_name();
            }
            b"facet" => words.skip_normal()?,
            b"endfacet" => {}
            b"outer" => corners(&mut words, &mut soup)?,
            _ => {
                let expected = "`facet`, `outer loop`, `endfacet` or `endsolid`";
                return Err(words.unexpected(word, expected));
            }
        }
        check_count(soup.vertices.len() / 3)?;
    }
    if !is_ended {
        return Err(ReadError::new(
            "ends without `endsolid`: it is cut off, export it again",
        ));
    }
    number_corners(&mut soup);
    Ok(soup)
}

/// The corners of a facet, after `outer`.
fn corners(words: &mut Words, soup: &mut Soup) -> Result<(), ReadError> {
    let first = soup.vertices.len();
    let word = words.next().unwrap_or_default();
    if !word.eq_ignore_ascii_case(b"loop") {
        return Err(words.unexpected(word, "`loop`"));
    }
    loop {
        let word = words.next().unwrap_or_default();
        match word.to_ascii_lowercase().as_slice() {
            b"vertex" => soup.vertices.push(vertex(words)?),
            b"endloop" => break,
            b"" => {
                return Err(ReadError::new(
                    "ends within a facet: it is cut off, export it again",
                ));
            }
            _ => return Err(words.unexpected(word, "`vertex` or `endloop`")),
        }
    }
    match soup.vertices.len() - first {
        3 => Ok(()),
        count => {
            let what = format!("the facet has {count} corners: it must have three");
            Err(ReadError::at(words.line, what))
        }
    }
}

fn vertex(words: &mut Words) -> Result<Vec3, ReadError> {
    let mut corner = Vec3::ZERO;
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let line = words.line;
        let word = words.next().filter(|word| {
            !word.eq_ignore_ascii_case(b"vertex") && !word.eq_ignore_ascii_case(b"endloop")
        });
        let word = word.ok_or_else(|| {
            let what = format!("the vertex has no {name}: it needs three coordinates");
            ReadError::at(line, what)
        })?;
        let word = String::from_utf8_lossy(word);
        let number = word.parse().ok().filter(|number: &f32| number.is_finite());
        corner[axis] = number.ok_or_else(|| {
            let word = shown::name(&word);
            let what = format!("{name} is `{word}`: it must be a finite number below 3.4e38");
            ReadError::at(words.line, what)
        })?;
    }
    Ok(corner)
}

/// The words of a text, separated by any blanks and line ends of any system.
struct Words<'a> {
    rest: &'a [u8],
    /// The line that the last word is in, from 1.
    line: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        let blanks = self.rest.iter().take_while(|b| b.is_ascii_whitespace());
        let (blanks, rest) = self.rest.split_at(blanks.count());
        self.line += encoding::line_ends(blanks);
        let length = rest.iter().take_while(|b| !b.is_ascii_whitespace()).count();
        let (word, rest) = rest.split_at(length);
        self.rest = rest;
        (length > 0).then_some(word)
    }

    /// Skips the name of a solid: it ends at the end of its line or at the first facet.
    fn skip_name(&mut self) {
        loop {
            let (after, line) = (self.rest, self.line);
            let word = self.next();
            let begins = word.is_some_and(|word| word.eq_ignore_ascii_case(b"facet"))
                && self
                    .peek()
                    .is_some_and(|word| word.eq_ignore_ascii_case(b"normal"));
            if word.is_none() || begins || self.line != line {
                (self.rest, self.line) = (after, line);
                return;
            }
        }
    }

    /// Skips the normal. It may be absent or not numeric, because it is not read.
    fn skip_normal(&mut self) -> Result<(), ReadError> {
        let begins_loop = |word: &[u8]| word.eq_ignore_ascii_case(b"outer");
        if self.peek().is_none_or(begins_loop) {
            return Ok(());
        }
        let word = self.next().unwrap_or_default();
        if !word.eq_ignore_ascii_case(b"normal") {
            return Err(self.unexpected(word, "`normal` or `outer loop`"));
        }
        for _ in 0..3 {
            if self.peek().is_none_or(begins_loop) {
                break;
            }
            self.next();
        }
        Ok(())
    }

    fn peek(&self) -> Option<&'a [u8]> {
        let (rest, line) = (self.rest, self.line);
        Words { rest, line }.next()
    }

    fn unexpected(&self, word: &[u8], expected: &str) -> ReadError {
        let word = shown::name(&String::from_utf8_lossy(word));
        ReadError::at(
            self.line,
            format!("`{word}` stands where {expected} is expected"),
        )
    }
}

fn number_corners(soup: &mut Soup) {
    let first_corners = (0..soup.vertices.len() as u32).step_by(3);
    soup.triangles = first_corners.map(|i| [i, i + 1, i + 2]).collect();
}

fn check_count(count: usize) -> Result<(), ReadError> {
    if count > MAX_TRIANGLES {
        return Err(ReadError::new(format!(
            "has more than {MAX_TRIANGLES} triangles: simplify the mesh before export"
        )));
    }
    Ok(())
}
