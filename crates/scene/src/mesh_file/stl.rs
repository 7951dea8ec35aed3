//! STL, as text or binary: triangles without any vertex in common.
//!
//! Read here, as messages need lines and a binary file must not be believed how much it holds. Normals
//! are not read: the order of the corners says the same. The format tells neither unit nor up axis.

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

/// Bytes of a triangle in a binary file: normal, three corners, and two for colours and the like.
const TRIANGLE: usize = 50;

fn read(bytes: &[u8]) -> Result<Soup, ReadError> {
    let soup = match declared(bytes) {
        // Some binary files start with `solid` too, but only these have the length that they say.
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

/// How many triangles a binary file says it has.
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
    // Some exporters add bytes of their own at the end.
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
    let mut soup = Soup::default();
    // Corners of the loop that is being read, from `outer loop` to `endloop`.
    let mut corners: Option<usize> = None;
    for (i, line) in decoded.split(|&byte| byte == b'\n').enumerate() {
        let line_number = i + 1;
        let text = String::from_utf8_lossy(line);
        let mut words = text.split_ascii_whitespace();
        let Some(keyword) = words.next() else {
            continue;
        };
        match (keyword.to_ascii_lowercase().as_str(), corners) {
            ("outer", None) => corners = Some(0),
            ("vertex", Some(count)) => {
                soup.vertices.push(vertex(line_number, words)?);
                corners = Some(count + 1);
            }
            ("endloop", Some(3)) => corners = None,
            ("endloop", Some(count)) => {
                let what = format!("the facet has {count} corners: it must have three");
                return Err(ReadError::at(line_number, what));
            }
            ("solid" | "endsolid" | "facet" | "endfacet", None) => {}
            (_, inside) => {
                let expected = match inside {
                    None => "`facet`, `outer loop`, `endfacet` or `endsolid`",
                    Some(_) => "`vertex` or `endloop`",
                };
                let word = shown::name(keyword);
                let what = format!("the line starts with `{word}`: expected {expected}");
                return Err(ReadError::at(line_number, what));
            }
        }
        check_count(soup.vertices.len() / 3)?;
    }
    if corners.is_some() {
        return Err(ReadError::new(
            "ends within a facet: it is cut off, export it again",
        ));
    }
    number_corners(&mut soup);
    Ok(soup)
}

fn vertex<'w>(line: usize, mut words: impl Iterator<Item = &'w str>) -> Result<Vec3, ReadError> {
    let mut corner = Vec3::ZERO;
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let word = words.next().ok_or_else(|| {
            let what = format!("the vertex has no {name}: it needs three coordinates");
            ReadError::at(line, what)
        })?;
        let number = word.parse().ok().filter(|number: &f32| number.is_finite());
        corner[axis] = number.ok_or_else(|| {
            let word = shown::name(word);
            let what = format!("{name} is `{word}`: it must be a finite number below 3.4e38");
            ReadError::at(line, what)
        })?;
    }
    Ok(corner)
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
