//! Refuses, before parsing, documents for which XML takes more than linear time and memory: elements with very many
//! attributes or namespaces, and very deep nesting.

use crate::mesh_file::soup::ReadError;

/// The most attributes of one element. The parser compares each with every other.
const MAX_ATTRIBUTES: usize = 64;

/// The most namespaces in scope at an element. The parser copies them to it.
const MAX_NAMESPACES: usize = 64;

/// How deep elements may nest.
const MAX_DEPTH: usize = 512;

/// Scans the tags of a document. The parser reports documents that are not well-formed.
pub(super) fn check(text: &str) -> Result<(), ReadError> {
    let mut namespaces = vec![0];
    let mut rest = text;
    while let Some(start) = rest.find('<') {
        let at = &rest[start..];
        let skipped = [
            ("<!--", "-->"),
            ("<![CDATA[", "]]>"),
            ("<?", "?>"),
            ("</", ">"),
        ];
        if let Some((open, close)) = skipped.iter().find(|(open, _)| at.starts_with(open)) {
            if *open == "</" {
                namespaces.pop();
            }
            let inside = &at[open.len()..];
            let Some(end) = inside.find(close) else {
                return Ok(());
            };
            rest = &inside[end + close.len()..];
            continue;
        }
        // The parser refuses a document type and stops there.
        if at.starts_with("<!") {
            return Ok(());
        }
        let Some(tag) = Tag::read(at) else {
            return Ok(());
        };
        let around = namespaces.last().copied().unwrap_or(0) + tag.namespaces;
        let excess = if tag.attributes > MAX_ATTRIBUTES {
            Some(format!("has more than {MAX_ATTRIBUTES} attributes"))
        } else if around > MAX_NAMESPACES {
            Some(format!(
                "has more than {MAX_NAMESPACES} namespaces around it"
            ))
        } else if namespaces.len() > MAX_DEPTH {
            Some(format!("nests deeper than {MAX_DEPTH}"))
        } else {
            None
        };
        if let Some(excess) = excess {
            let before = &text[..text.len() - at.len()];
            let line = 1 + before.bytes().filter(|&byte| byte == b'\n').count();
            return Err(ReadError::at(line, format!("an element {excess}")));
        }
        if !tag.empty {
            namespaces.push(around);
        }
        rest = &at[tag.length..];
    }
    Ok(())
}

/// A start tag.
struct Tag {
    length: usize,
    attributes: usize,
    namespaces: usize,
    /// Whether it ends in `/>`.
    empty: bool,
}

impl Tag {
    /// Reads up to the `>` that ends the tag. A `>` within quotes does not end it.
    fn read(text: &str) -> Option<Tag> {
        let bytes = text.as_bytes();
        let mut quote = None;
        let (mut attributes, mut namespaces) = (0, 0);
        for (i, &byte) in bytes.iter().enumerate() {
            match (quote, byte) {
                (Some(open), _) if open == byte => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'=') => attributes += 1,
                (None, b'x') if bytes[i..].starts_with(b"xmlns") => namespaces += 1,
                (None, b'>') => {
                    return Some(Tag {
                        length: i + 1,
                        attributes,
                        namespaces,
                        empty: bytes[i - 1] == b'/',
                    });
                }
                _ => {}
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_excess_is_refused() {
        let attributes = |n: usize| (0..n).map(|i| format!(" a{i}='='")).collect::<String>();
        let spaces = |n: usize| {
            (0..n)
                .map(|i| format!(" xmlns:a{i}='u'"))
                .collect::<String>()
        };
        let nested = |n: usize| "<a xmlns:b='u'>".repeat(n) + &"</a>".repeat(n);
        for good in [
            format!("<a{}/>", attributes(64)),
            format!("<a{}/>", spaces(64)),
            format!("<a>{}</a>", format!("<b{}></b>", spaces(64)).repeat(9)),
            nested(64),
            "<a>".repeat(512) + &"</a>".repeat(512),
            "<a>".to_owned() + &"<b/>".repeat(2000) + "</a>",
            "<!-- <a> -->".repeat(2000),
            "<?a <b>?><![CDATA[<a><a>]]>".repeat(2000),
            "<a b='>' c=\"/>\">".to_owned(),
            "<a b='".to_owned(),
            "<".to_owned(),
        ] {
            assert!(check(&good).is_ok(), "{good}");
        }
        for (bad, expected) in [
            (
                format!("\n<a{}/>", attributes(65)),
                "more than 64 attributes",
            ),
            (format!("<a>\n<b{}/></a>", spaces(65)), "more than 64"),
            (
                "\n".to_owned() + &nested(65),
                "more than 64 namespaces around it",
            ),
            ("\n".to_owned() + &"<a>".repeat(513), "deeper than 512"),
        ] {
            let error = check(&bad).expect_err(expected);
            assert!(error.what.contains(expected), "{}", error.what);
            assert_eq!(error.line, Some(2));
        }
    }
}
