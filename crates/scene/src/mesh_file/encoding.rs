//! Converts the bytes of text files to UTF-8.

use std::borrow::Cow;

use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE};

use super::soup::ReadError;
use crate::shown;

/// Converts text whose encoding is known from its byte order mark or, for UTF-16 without one, from the zeros in its
/// first characters. Other bytes stay unchanged.
pub(super) fn by_mark(bytes: &[u8]) -> Cow<'_, [u8]> {
    let marked = Encoding::for_bom(bytes);
    let (encoding, text) = match (marked, bytes) {
        (Some((encoding, length)), _) => (encoding, &bytes[length..]),
        // Two characters of ASCII.
        (None, [1..128, 0, 1..128, 0, ..]) => (UTF_16LE, bytes),
        (None, [0, 1..128, 0, 1..128, ..]) => (UTF_16BE, bytes),
        _ => return Cow::Borrowed(bytes),
    };
    if encoding == UTF_8 {
        return Cow::Borrowed(text);
    }
    let (text, _) = encoding.decode_without_bom_handling(text);
    Cow::Owned(text.into_owned().into_bytes())
}

/// The number of line ends in a part of a text: line feeds or, on old systems, carriage returns alone.
pub(super) fn line_ends(text: &[u8]) -> usize {
    let ends = text
        .iter()
        .enumerate()
        .filter(|&(i, &byte)| byte == b'\n' || byte == b'\r' && text.get(i + 1) != Some(&b'\n'));
    ends.count()
}

/// The byte that ends the lines of a text: a line feed, or a carriage return if there is none.
pub(super) fn line_end(text: &[u8]) -> u8 {
    if text.contains(&b'\n') { b'\n' } else { b'\r' }
}

/// Decodes the text of an XML document. The encoding is given by its byte order mark, else by the zeros in its first
/// characters, else by its declaration; otherwise it is UTF-8.
pub(super) fn xml(bytes: &[u8]) -> Result<Cow<'_, str>, ReadError> {
    let (encoding, bytes) = match Encoding::for_bom(bytes) {
        Some((encoding, length)) => (encoding, &bytes[length..]),
        None if bytes.starts_with(b"<\0") => (UTF_16LE, bytes),
        None if bytes.starts_with(b"\0<") => (UTF_16BE, bytes),
        None => (declared(bytes)?, bytes),
    };
    encoding
        .decode_without_bom_handling_and_without_replacement(bytes)
        .ok_or_else(|| match std::str::from_utf8(bytes) {
            Err(error) if encoding == UTF_8 => {
                let before = &bytes[..error.valid_up_to()];
                let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
                ReadError::at(line, "is not UTF-8 text: save the COLLADA file as UTF-8")
            }
            _ => ReadError::new(format!(
                "is not {} text: save the COLLADA file as UTF-8",
                encoding.name()
            )),
        })
}

/// The encoding that `<?xml ... encoding="..."?>` names; UTF-8 without one.
fn declared(bytes: &[u8]) -> Result<&'static Encoding, ReadError> {
    let head = &bytes[..bytes.len().min(1024)];
    let head: String = head.iter().map(|&byte| char::from(byte)).collect();
    let declaration = head
        .strip_prefix("<?xml")
        .and_then(|rest| rest.split_once("?>"));
    let Some(value) = declaration
        .and_then(|(inside, _)| inside.split_once("encoding"))
        .and_then(|(_, rest)| rest.trim_start().strip_prefix('='))
    else {
        return Ok(UTF_8);
    };
    let label = value.trim_start().get(1..).unwrap_or_default();
    let label = label.split(['"', '\'']).next().unwrap_or_default();
    match Encoding::for_label(label.as_bytes()) {
        // The declaration itself is not in UTF-16, otherwise it could not have been read.
        Some(encoding) if encoding == UTF_16LE || encoding == UTF_16BE => Ok(UTF_8),
        Some(encoding) => Ok(encoding),
        None => Err(ReadError::at(
            1,
            format!(
                "the encoding `{}` is not known: save the COLLADA file as UTF-8",
                shown::name(label)
            ),
        )),
    }
}
