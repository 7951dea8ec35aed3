//! Wavefront OBJ: the polygons of one text file.
//!
//! `tobj` parses the statements. It does not keep the line numbers that messages need, so a filter before it passes
//! only vertex positions and the position indices of faces, each checked. Thus no other file that the file names
//! (`mtllib`) is opened; lines, points, curves, normals and texture coordinates are left out; objects and groups become
//! one mesh. The fourth and later numbers of a vertex (weight, colour) are ignored.

use std::io::{self, BufRead, Read};

use glam::Vec3;
use tobj::LoadOptions;

use super::polygon::{MAX_CONCAVE_CORNERS, triangulate};
use super::soup::{MAX_TRIANGLES, ReadError, Soup};
use super::{Format, encoding};
use crate::shown;

/// Wavefront OBJ.
pub(super) const FORMAT: Format = Format {
    name: "obj",
    title: "Wavefront OBJ",
    extensions: &["obj"],
    read,
};

fn read(bytes: &[u8]) -> Result<Soup, ReadError> {
    let decoded = encoding::by_mark(bytes);
    let bytes = decoded.as_ref();
    let mut sieve = Sieve::new(bytes);
    let options = LoadOptions {
        ignore_lines: true,
        ignore_points: true,
        ..LoadOptions::default()
    };
    let no_materials = |_: &std::path::Path| Ok(Default::default());
    let loaded = tobj::load_obj_buf(&mut sieve, &options, no_materials);
    if let Some(error) = sieve.error {
        return Err(error);
    }
    let (highest, line) = sieve.highest_index;
    if highest > sieve.vertices {
        return Err(index_error(line, highest, sieve.vertices));
    }
    let (models, _) = loaded.map_err(|error| ReadError::new(error.to_string()))?;
    let mut soup = Soup::default();
    for model in models {
        append(&mut soup, &model.mesh)?;
    }
    if soup.triangles.is_empty() {
        return Err(ReadError::new(
            "has no faces (`f` lines): is it a Wavefront OBJ file with polygons?",
        ));
    }
    soup.unreferenced = sieve.vertices - soup.vertices.len();
    Ok(soup)
}

/// Adds the polygons of a model, cut into triangles.
fn append(soup: &mut Soup, mesh: &tobj::Mesh) -> Result<(), ReadError> {
    let first = soup.vertices.len() as u32;
    let positions = mesh.positions.chunks_exact(3);
    soup.vertices
        .extend(positions.map(|p| Vec3::new(p[0], p[1], p[2])));
    // Without arities every face is a triangle.
    let arities = if mesh.face_arities.is_empty() {
        vec![3; mesh.indices.len() / 3]
    } else {
        mesh.face_arities.clone()
    };
    let mut rest = mesh.indices.as_slice();
    let mut corners = Vec::new();
    let mut cut = Vec::new();
    for arity in arities {
        let (face, after) = rest.split_at(arity as usize);
        rest = after;
        corners.clear();
        corners.extend(
            face.iter()
                .map(|&i| soup.vertices[(first + i) as usize].as_dvec3()),
        );
        cut.clear();
        if !triangulate(&corners, &mut cut) {
            return Err(ReadError::new(format!(
                "has a face with {arity} corners that is not convex: cut faces of more than \
                 {MAX_CONCAVE_CORNERS} corners before export"
            )));
        }
        soup.triangles
            .extend(cut.iter().map(|t| t.map(|corner| first + face[corner])));
        if soup.triangles.len() > MAX_TRIANGLES {
            return Err(ReadError::new(format!(
                "has more than {MAX_TRIANGLES} triangles: simplify the mesh before export"
            )));
        }
    }
    Ok(())
}

fn index_error(line: usize, index: impl std::fmt::Display, vertices: usize) -> ReadError {
    let range = match vertices {
        0 => "there are no vertices (`v` lines) for it".to_owned(),
        _ => format!("the vertices are 1 to {vertices}, or -1 to -{vertices} from the last back"),
    };
    ReadError::at(line, format!("a face uses vertex {index}, but {range}"))
}

/// Whether the statement continues on the next line: blanks after the backslash are allowed.
fn goes_on(line: &[u8]) -> bool {
    line.trim_ascii_end().ends_with(b"\\")
}

/// A reader that turns an OBJ file into checked `v x y z` and `f i j k ...` lines.
struct Sieve<'a> {
    rest: &'a [u8],
    line_end: u8,
    /// The line last taken from `rest`, from 1.
    line: usize,
    /// The current statement, and how many of its bytes have been read.
    statement: Vec<u8>,
    consumed: usize,
    vertices: usize,
    /// The highest vertex index of all faces, from 1, and its line: a face may precede its vertices.
    highest_index: (usize, usize),
    error: Option<ReadError>,
}

impl<'a> Sieve<'a> {
    fn new(bytes: &'a [u8]) -> Sieve<'a> {
        Sieve {
            rest: bytes,
            line_end: encoding::line_end(bytes),
            line: 0,
            statement: Vec::new(),
            consumed: 0,
            vertices: 0,
            highest_index: (0, 0),
            error: None,
        }
    }

    /// Takes one line without its end.
    fn take_line(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.line += 1;
        let end = self.rest.iter().position(|&byte| byte == self.line_end);
        let line = &self.rest[..end.unwrap_or(self.rest.len())];
        self.rest = end.map_or(&[], |end| &self.rest[end + 1..]);
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }

    /// Fills `statement` with the next vertex or face; at the end of the file it stays empty.
    fn next_statement(&mut self) -> Result<(), ReadError> {
        self.statement.clear();
        self.consumed = 0;
        while let Some(line) = self.take_line() {
            let start = self.line;
            let keyword = line
                .split(u8::is_ascii_whitespace)
                .find(|word| !word.is_empty());
            if keyword == Some(b"call") {
                let what = "`call` puts the lines of another file here, and no other file is \
                            opened: write them into this one";
                return Err(ReadError::at(start, what));
            }
            if !matches!(keyword, Some(b"v" | b"f")) {
                self.skip_continuation(line);
                continue;
            }
            let mut whole = line.to_vec();
            while goes_on(&whole) {
                whole.truncate(whole.trim_ascii_end().len() - 1);
                whole.push(b' ');
                match self.take_line() {
                    Some(line) => whole.extend_from_slice(line),
                    None => break,
                }
            }
            // Comments may be in any encoding, so they are removed before the check.
            let end = whole.iter().position(|&byte| byte == b'#');
            // A word that is not valid UTF-8 is not a number; the message shows it.
            let text = String::from_utf8_lossy(&whole[..end.unwrap_or(whole.len())]);
            let words = text.split_ascii_whitespace().skip(1);
            return if keyword == Some(b"v") {
                self.vertex(start, words)
            } else {
                self.face(start, words)
            };
        }
        Ok(())
    }

    /// Skips the further lines of a statement that is left out. A comment cannot continue on another line.
    fn skip_continuation(&mut self, line: &[u8]) {
        let mut continued = !line.trim_ascii_start().starts_with(b"#") && goes_on(line);
        while continued {
            continued = self.take_line().is_some_and(goes_on);
        }
    }

    fn vertex<'w>(
        &mut self,
        line: usize,
        mut words: impl Iterator<Item = &'w str>,
    ) -> Result<(), ReadError> {
        self.statement.push(b'v');
        for axis in ["x", "y", "z"] {
            let Some(word) = words.next() else {
                let what = format!("the vertex has no {axis}: it needs three coordinates");
                return Err(ReadError::at(line, what));
            };
            if !word.parse::<f32>().is_ok_and(f32::is_finite) {
                let what = format!(
                    "{axis} of the vertex is `{}`: it must be a finite number below 3.4e38",
                    shown::name(word)
                );
                return Err(ReadError::at(line, what));
            }
            self.statement.push(b' ');
            self.statement.extend_from_slice(word.as_bytes());
        }
        self.statement.push(b'\n');
        self.vertices += 1;
        Ok(())
    }

    fn face<'w>(
        &mut self,
        line: usize,
        words: impl Iterator<Item = &'w str>,
    ) -> Result<(), ReadError> {
        self.statement.push(b'f');
        let mut corners = 0;
        for word in words {
            let index = word.split('/').next().unwrap_or(word);
            let number: i64 = index.parse().map_err(|_| {
                let what = format!(
                    "`{}` is not a corner of a face: expected a vertex index such as 7, -1 \
                     or 7/2/3",
                    shown::name(word)
                );
                ReadError::at(line, what)
            })?;
            let number = match number {
                1.. => number as usize,
                0 => return Err(index_error(line, 0, self.vertices)),
                // A negative index counts back from the last vertex.
                _ => usize::try_from(number.unsigned_abs())
                    .ok()
                    .and_then(|back| (self.vertices + 1).checked_sub(back))
                    .filter(|&index| index > 0)
                    .ok_or_else(|| index_error(line, number, self.vertices))?,
            };
            if number > self.highest_index.0 {
                self.highest_index = (number, line);
            }
            self.statement.push(b' ');
            self.statement
                .extend_from_slice(number.to_string().as_bytes());
            corners += 1;
        }
        if corners < 3 {
            let what = format!("the face has {corners} corners: it needs at least three");
            return Err(ReadError::at(line, what));
        }
        self.statement.push(b'\n');
        Ok(())
    }
}

impl Read for Sieve<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Sieve<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.consumed == self.statement.len()
            && let Err(error) = self.next_statement()
        {
            self.error = Some(error);
            return Err(io::ErrorKind::InvalidData.into());
        }
        Ok(&self.statement[self.consumed..])
    }

    fn consume(&mut self, amount: usize) {
        self.consumed += amount;
    }
}
