//! PLY, as text or binary in either byte order: the elements `vertex` and `face` of a file.
//!
//! The parser is our own because messages need line numbers and the counts in a header are not trusted: memory grows
//! only with the data that is read. Other elements and properties (colours, normals) are skipped. The format states
//! neither unit nor up axis.

use glam::DVec3;

use super::polygon::{MAX_CONCAVE_CORNERS, triangulate};
use super::soup::{MAX_TRIANGLES, MAX_VERTICES, ReadError, Soup};
use super::{Format, encoding};
use crate::shown;

/// PLY.
pub(super) const FORMAT: Format = Format {
    name: "ply",
    title: "PLY",
    extensions: &["ply"],
    read,
};

/// The only version that exists.
const VERSION: &str = "1.0";

fn read(bytes: &[u8]) -> Result<Soup, ReadError> {
    let bytes = encoding::by_mark(bytes);
    let (header, body) = Header::read(&bytes)?;
    let mut values = Values {
        encoding: header.encoding,
        rest: body,
        line: header.lines + 1,
    };
    let mut soup = Soup::default();
    let mut faces = Faces::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => vertices(element, &mut values, &mut soup)?,
            "face" => read_faces(element, &mut values, &mut faces)?,
            _ => skip(element, &mut values)?,
        }
    }
    // The faces may precede the vertices.
    let mut start = 0;
    for &(end, line) in &faces.ends {
        append(&mut soup, &faces.corners[start..end], line)?;
        start = end;
    }
    if soup.triangles.is_empty() {
        return Err(ReadError::new(
            "has no faces (an element `face`): export the mesh with polygons, not as points or strips",
        ));
    }
    Ok(soup)
}

/// The part of the file above `end_header`.
struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    lines: usize,
}

#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

struct Property {
    name: String,
    /// For a list, the type of its length.
    list: Option<Scalar>,
    scalar: Scalar,
}

#[derive(Clone, Copy)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &str) -> Option<Scalar> {
        Some(match name {
            "char" | "int8" => Scalar::I8,
            "uchar" | "uint8" => Scalar::U8,
            "short" | "int16" => Scalar::I16,
            "ushort" | "uint16" => Scalar::U16,
            "int" | "int32" => Scalar::I32,
            "uint" | "uint32" => Scalar::U32,
            "float" | "float32" => Scalar::F32,
            "double" | "float64" => Scalar::F64,
            _ => return None,
        })
    }
}

/// The corners of all faces, one face after the other.
#[derive(Default)]
struct Faces {
    corners: Vec<f64>,
    /// For each face its end in `corners` and, in a text file, its line.
    ends: Vec<(usize, Option<usize>)>,
}

impl Header {
    /// Reads the header. Returns it and the bytes after it.
    fn read(bytes: &[u8]) -> Result<(Header, &[u8]), ReadError> {
        let mut rest = bytes;
        // All lines of a header end like the first one. The bytes after the header may have any value.
        let line_end = encoding::line_end(&rest[..rest.len().min("ply\r\n".len())]);
        let (mut kind, mut elements) = (None, Vec::<Element>::new());
        let mut line = 0;
        loop {
            line += 1;
            let Some(end) = rest.iter().position(|&byte| byte == line_end) else {
                let what = "the header does not end: there is no line `end_header`";
                return Err(ReadError::at(line, what));
            };
            let text = String::from_utf8_lossy(&rest[..end]).into_owned();
            rest = &rest[end + 1..];
            let words: Vec<&str> = text.split_ascii_whitespace().collect();
            let wrong = || {
                let what = format!("`{}` is no line of a PLY header", shown::name(text.trim()));
                ReadError::at(line, what)
            };
            match words[..] {
                ["ply"] if line == 1 => {}
                _ if line == 1 => {
                    let what = "does not start with `ply`: is it a PLY file?";
                    return Err(ReadError::at(1, what));
                }
                [] | ["comment" | "obj_info", ..] => {}
                ["format", name, version] => {
                    let encoding = match name {
                        "ascii" => Encoding::Ascii,
                        "binary_little_endian" => Encoding::Little,
                        "binary_big_endian" => Encoding::Big,
                        _ => return Err(wrong()),
                    };
                    if version != VERSION {
                        let version = shown::name(version);
                        let what = format!("the version is `{version}`: only {VERSION} is known");
                        return Err(ReadError::at(line, what));
                    }
                    if kind.replace(encoding).is_some() {
                        let what = "the header has a second line `format`";
                        return Err(ReadError::at(line, what));
                    }
                }
                ["element", name, count] => {
                    let is_read = matches!(name, "vertex" | "face");
                    if is_read && elements.iter().any(|element| element.name == name) {
                        let what = format!("the header has a second element `{name}`");
                        return Err(ReadError::at(line, what));
                    }
                    elements.push(Element {
                        name: name.to_owned(),
                        count: count.parse().map_err(|_| wrong())?,
                        properties: Vec::new(),
                    });
                }
                ["property", .., name] => {
                    let (list, scalar) = match words[1..] {
                        ["list", length, scalar, _] => {
                            (Some(Scalar::named(length).ok_or_else(wrong)?), scalar)
                        }
                        [scalar, _] => (None, scalar),
                        _ => return Err(wrong()),
                    };
                    let property = Property {
                        name: name.to_owned(),
                        list,
                        scalar: Scalar::named(scalar).ok_or_else(wrong)?,
                    };
                    let element = elements.last_mut().ok_or_else(wrong)?;
                    element.properties.push(property);
                }
                ["end_header"] => break,
                _ => return Err(wrong()),
            }
        }
        let encoding = kind.ok_or_else(|| {
            ReadError::new("the header has no line `format`: it must say ascii or which binary")
        })?;
        let header = Header {
            encoding,
            elements,
            lines: line,
        };
        Ok((header, rest))
    }
}

/// The numbers after the header, one by one.
struct Values<'a> {
    encoding: Encoding,
    rest: &'a [u8],
    /// The line of the next word, in a text file.
    line: usize,
}

impl Values<'_> {
    fn next(&mut self, scalar: Scalar, of: &Element) -> Result<f64, ReadError> {
        match self.encoding {
            Encoding::Ascii => self.word(of),
            Encoding::Little | Encoding::Big => match scalar {
                Scalar::I8 => self
                    .bytes(of, i8::from_le_bytes, i8::from_be_bytes)
                    .map(f64::from),
                Scalar::U8 => self
                    .bytes(of, u8::from_le_bytes, u8::from_be_bytes)
                    .map(f64::from),
                Scalar::I16 => self
                    .bytes(of, i16::from_le_bytes, i16::from_be_bytes)
                    .map(f64::from),
                Scalar::U16 => self
                    .bytes(of, u16::from_le_bytes, u16::from_be_bytes)
                    .map(f64::from),
                Scalar::I32 => self
                    .bytes(of, i32::from_le_bytes, i32::from_be_bytes)
                    .map(f64::from),
                Scalar::U32 => self
                    .bytes(of, u32::from_le_bytes, u32::from_be_bytes)
                    .map(f64::from),
                Scalar::F32 => self
                    .bytes(of, f32::from_le_bytes, f32::from_be_bytes)
                    .map(f64::from),
                Scalar::F64 => self.bytes(of, f64::from_le_bytes, f64::from_be_bytes),
            },
        }
    }

    fn bytes<const N: usize, T>(
        &mut self,
        of: &Element,
        little: fn([u8; N]) -> T,
        big: fn([u8; N]) -> T,
    ) -> Result<T, ReadError> {
        let (value, rest) = self
            .rest
            .split_first_chunk()
            .ok_or_else(|| self.cut_off(of))?;
        self.rest = rest;
        Ok(match self.encoding {
            Encoding::Big => big(*value),
            Encoding::Little | Encoding::Ascii => little(*value),
        })
    }

    fn word(&mut self, of: &Element) -> Result<f64, ReadError> {
        let blanks = self
            .rest
            .iter()
            .take_while(|byte| byte.is_ascii_whitespace());
        let (blanks, rest) = self.rest.split_at(blanks.count());
        self.line += encoding::line_ends(blanks);
        let end = rest.iter().position(u8::is_ascii_whitespace);
        let (word, rest) = rest.split_at(end.unwrap_or(rest.len()));
        if word.is_empty() {
            return Err(self.cut_off(of));
        }
        self.rest = rest;
        let number = std::str::from_utf8(word)
            .ok()
            .and_then(|word| word.parse().ok());
        number.ok_or_else(|| {
            let word = shown::name(&String::from_utf8_lossy(word));
            let what = format!(
                "`{word}` is not a number, in an element `{}`",
                shown::name(&of.name)
            );
            ReadError::at(self.line, what)
        })
    }

    fn cut_off(&self, of: &Element) -> ReadError {
        ReadError::new(format!(
            "ends before the last of the {} elements `{}` that the header promises: it is cut off",
            of.count,
            shown::name(&of.name)
        ))
    }

    fn line(&self) -> Option<usize> {
        (self.encoding == Encoding::Ascii).then_some(self.line)
    }

    /// The numbers of a property: one, or those of a list.
    fn property(
        &mut self,
        property: &Property,
        of: &Element,
        mut take: impl FnMut(f64),
    ) -> Result<(), ReadError> {
        let Some(length) = property.list else {
            take(self.next(property.scalar, of)?);
            return Ok(());
        };
        let length = self.next(length, of)?;
        if !(0.0..=f64::from(u32::MAX)).contains(&length) || length.fract() != 0.0 {
            return Err(ReadError {
                line: self.line(),
                what: format!(
                    "a list `{}` has the length {}: it must be a whole number from 0",
                    shown::name(&property.name),
                    shown::number(length)
                ),
            });
        }
        for _ in 0..length as u64 {
            take(self.next(property.scalar, of)?);
        }
        Ok(())
    }
}

fn vertices(element: &Element, values: &mut Values, soup: &mut Soup) -> Result<(), ReadError> {
    for axis in ["x", "y", "z"] {
        let named = element.properties.iter().filter(|p| p.name == axis);
        let lists: Vec<bool> = named.map(|property| property.list.is_some()).collect();
        if lists.len() > 1 {
            let what = format!("its vertices have more than one property `{axis}`");
            return Err(ReadError::new(what));
        }
        if lists != [false] {
            let what = format!("its vertices have no property `{axis}`");
            return Err(ReadError::new(what));
        }
    }
    for number in 0..element.count {
        let mut position = DVec3::NAN;
        for property in &element.properties {
            values.property(property, element, |value| match property.name.as_str() {
                "x" => position.x = value,
                "y" => position.y = value,
                "z" => position.z = value,
                _ => {}
            })?;
        }
        let vertex = position.as_vec3();
        if !vertex.is_finite() {
            return Err(ReadError {
                line: values.line(),
                what: format!(
                    "vertex {number} is not finite: coordinates must be numbers below 3.4e38"
                ),
            });
        }
        if soup.vertices.len() == MAX_VERTICES {
            return Err(ReadError::new(format!(
                "has more than {MAX_VERTICES} vertices: simplify the mesh before export"
            )));
        }
        soup.vertices.push(vertex);
    }
    Ok(())
}

fn read_faces(element: &Element, values: &mut Values, faces: &mut Faces) -> Result<(), ReadError> {
    let is_corners = |property: &Property| {
        property.list.is_some()
            && matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
    };
    let lists = element.properties.iter().filter(|p| is_corners(p)).count();
    if element.count > 0 && lists == 0 {
        return Err(ReadError::new("its faces have no list `vertex_indices`"));
    }
    if lists > 1 {
        let what =
            "its faces have more than one list of corners (`vertex_indices`, `vertex_index`)";
        return Err(ReadError::new(what));
    }
    for _ in 0..element.count {
        let start = faces.corners.len();
        for property in &element.properties {
            let wanted = is_corners(property);
            values.property(property, element, |value| {
                if wanted && faces.corners.len() <= 3 * MAX_TRIANGLES {
                    faces.corners.push(value);
                }
            })?;
        }
        // A face of n corners gives n - 2 triangles, so there are at most three triangle corners for each corner.
        let corners = faces.corners.len();
        if corners > 3 * MAX_TRIANGLES {
            return Err(too_many());
        }
        let line = values.line();
        if corners - start < 3 {
            let n = corners - start;
            let what = format!("a face has {n} corners: it needs at least three");
            return Err(ReadError { line, what });
        }
        faces.ends.push((corners, line));
    }
    Ok(())
}

fn skip(element: &Element, values: &mut Values) -> Result<(), ReadError> {
    // Elements without properties have no data, whatever their count.
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            values.property(property, element, |_| {})?;
        }
    }
    Ok(())
}

/// Adds a face as triangles.
fn append(soup: &mut Soup, face: &[f64], line: Option<usize>) -> Result<(), ReadError> {
    let wrong = |what: String| ReadError { line, what };
    let n = face.len();
    let count = soup.vertices.len();
    let corners = face.iter().map(|&index| {
        let known = index >= 0.0 && index < count as f64 && index.fract() == 0.0;
        known.then_some(index as u32).ok_or_else(|| {
            let index = shown::number(index);
            wrong(format!(
                "a face uses vertex {index}, but there are {count} (from 0)"
            ))
        })
    });
    let corners = corners.collect::<Result<Vec<u32>, _>>()?;
    let at = |&i: &u32| soup.vertices[i as usize].as_dvec3();
    let places: Vec<DVec3> = corners.iter().map(at).collect();
    let mut cut = Vec::new();
    if !triangulate(&places, &mut cut) {
        return Err(wrong(format!(
            "a face with {n} corners is not convex: cut faces of more than {MAX_CONCAVE_CORNERS} \
             corners before export"
        )));
    }
    if soup.triangles.len() + cut.len() > MAX_TRIANGLES {
        return Err(too_many());
    }
    let triangles = cut.iter().map(|t| t.map(|corner| corners[corner]));
    soup.triangles.extend(triangles);
    Ok(())
}

fn too_many() -> ReadError {
    ReadError::new(format!(
        "has more than {MAX_TRIANGLES} triangles: simplify the mesh before export"
    ))
}
