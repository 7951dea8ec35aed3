//! Makes external text safe to show on a terminal or in a window: it can contain neither control characters nor
//! bidirectional marks that reorder the text around them, cannot begin a new line, and is limited in length.

use std::fmt::Write;
use std::path::Path;

/// The most bytes of a name, a key or a word of a file.
const NAME: usize = 80;

/// The most bytes of a path.
const PATH: usize = 160;

/// The most bytes of a message.
const MESSAGE: usize = 960;

/// A name, a key or a word of a file: at most 80 bytes.
pub fn name(text: &str) -> String {
    shown(text, NAME)
}

/// A path: at most 160 bytes. Bytes that are not valid UTF-8 become replacement characters.
pub fn path(path: &Path) -> String {
    shown(&path.to_string_lossy(), PATH)
}

/// A whole message: at most 960 bytes.
pub fn message(text: &str) -> String {
    shown(text, MESSAGE)
}

/// A part of a message: at most 480 bytes.
pub fn part(text: &str) -> String {
    shown(text, MESSAGE / 2)
}

/// A number with at most a few digits more than it needs, never with hundreds of zeros.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() || (1e-6..1e16).contains(&value.abs()) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

/// Whether a character must be escaped.
pub fn is_unsafe(character: char) -> bool {
    character.is_control()
        || matches!(character,
            // Direction marks, line separators and invisible characters.
            '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}'
            | '\u{e0000}'..='\u{e007f}')
}

/// Escapes unsafe characters, and removes the middle of text longer than `most` bytes. Applied to its own result it
/// changes nothing.
fn shown(text: &str, most: usize) -> String {
    // Each character takes at least one byte, so only the first and last `most` characters can be kept.
    if text.len() <= most && !text.contains(is_unsafe) {
        return text.to_owned();
    }
    let mut whole = String::new();
    for character in text.chars() {
        escape(&mut whole, character);
        if whole.len() > most {
            break;
        }
    }
    if whole.len() <= most {
        return whole;
    }
    let half = (most - GAP.len()) / 2;
    let mut start = String::new();
    let mut piece = String::new();
    for character in text.chars() {
        piece.clear();
        escape(&mut piece, character);
        if start.len() + piece.len() > half {
            break;
        }
        start += &piece;
    }
    let mut end = Vec::new();
    let mut length = 0;
    for character in text.chars().rev() {
        let mut piece = String::new();
        escape(&mut piece, character);
        length += piece.len();
        if length > half {
            break;
        }
        end.push(piece);
    }
    end.reverse();
    start + GAP + &end.concat()
}

/// Replaces the removed middle.
const GAP: &str = " ... ";

fn escape(out: &mut String, character: char) {
    if is_unsafe(character) {
        // Writing to a String cannot fail.
        let _ = write!(out, "\\u{{{:x}}}", u32::from(character));
    } else {
        out.push(character);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_acts_is_shown_raw() {
        let hostile = "a\u{1b}]0;x\u{7}\n\r\t\0\u{9b}\u{202e}\u{2066}\u{2028}\u{200f}\u{7f}ü";
        let shown = message(hostile);
        assert!(!shown.contains(is_unsafe), "{shown}");
        assert!(shown.starts_with("a\\u{1b}]0;x\\u{7}\\u{a}") && shown.ends_with('ü'));
        assert_eq!(message(&shown), shown);
        assert_eq!(message("plain ä \\n"), "plain ä \\n");
    }

    #[test]
    fn long_text_loses_its_middle() {
        for unit in ["x", "\u{1b}", "ü", "𝄞"] {
            for count in [0, 1, 79, 80, 81, 1000, 65_536, 1_000_000] {
                let text = format!("a{}z", unit.repeat(count));
                let shown = name(&text);
                assert!(shown.len() <= NAME, "{}", shown.len());
                assert!(shown.starts_with('a') && shown.ends_with('z'), "{shown}");
                assert_eq!(
                    shown.contains(GAP),
                    text.len() > NAME || shown.len() < text.len()
                );
            }
        }
    }

    #[test]
    fn numbers_stay_short() {
        for (value, text) in [
            (1e300, "1e300"),
            (-1e-60, "-1e-60"),
            (0.25, "0.25"),
            (f64::INFINITY, "inf"),
            (0.0, "0"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
