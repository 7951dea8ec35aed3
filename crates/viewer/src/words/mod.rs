//! The languages of the window. Every text is written in English where it is used. [`say`] translates it for the
//! screen, by a lookup in one table.

mod chinese;

use std::cell::Cell;
use std::collections::HashMap;
use std::sync::LazyLock;

/// A language of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Language {
    /// English.
    #[default]
    English,
    /// Simplified Chinese.
    Chinese,
}

impl Language {
    /// All languages.
    pub const ALL: [Language; 2] = [Language::English, Language::Chinese];

    /// The name of the language in the language itself.
    pub fn name(self) -> &'static str {
        match self {
            Language::English => "English",
            Language::Chinese => "中文",
        }
    }

    /// Translates a text to this language; a text that is not in the table stays unchanged.
    pub fn say(self, text: &str) -> String {
        self.translated(text).unwrap_or_else(|| text.to_owned())
    }

    /// The translation of a text to this language, if it differs and the table has it.
    pub fn translated(self, text: &str) -> Option<String> {
        match self {
            Language::English => None,
            Language::Chinese => CHINESE.get(text),
        }
    }
}

thread_local! {
    /// Each thread that draws panels has a language of its own, so that windows of tests do not influence each other.
    static LANGUAGE: Cell<Language> = const { Cell::new(Language::English) };
}

/// Sets the language for everything that this thread draws from now on.
pub fn speak(language: Language) {
    LANGUAGE.set(language);
}

/// The language of this thread.
pub fn spoken() -> Language {
    LANGUAGE.get()
}

/// Translates a text to the language of the window. A text with figures and names is found by the parts around these.
pub fn say(text: impl AsRef<str>) -> String {
    spoken().say(text.as_ref())
}

static CHINESE: LazyLock<Table> = LazyLock::new(|| Table::new(&chinese::TEXTS));

/// Texts and their translations.
struct Table {
    whole: HashMap<&'static str, &'static str>,
    /// Texts with `{}`. First come those that give a place and continue with a text of the table, and longer ones come
    /// before shorter ones, so that the most specific one is found.
    patterns: Vec<(Vec<&'static str>, &'static str)>,
}

impl Table {
    fn new(texts: &[&[(&'static str, &'static str)]]) -> Self {
        let mut table = Table {
            whole: HashMap::new(),
            patterns: Vec::new(),
        };
        for &(english, other) in texts.iter().copied().flatten() {
            if english.contains("{}") {
                let pieces = english.split("{}").collect();
                table.patterns.push((pieces, other));
            } else {
                table.whole.insert(english, other);
            }
        }
        let length = |pieces: &[&str]| pieces.iter().map(|piece| piece.len()).sum::<usize>();
        let is_place = |pieces: &[&str], other: &str| {
            matches!(pieces, [.., last, ""] if last.ends_with(": ")) && other.ends_with("!}")
        };
        table.patterns.sort_by_key(|(pieces, other)| {
            std::cmp::Reverse((is_place(pieces, other), length(pieces)))
        });
        table
    }

    fn get(&self, text: &str) -> Option<String> {
        if let Some(other) = self.whole.get(text) {
            return Some((*other).to_owned());
        }
        self.patterns
            .iter()
            .find_map(|(pieces, other)| Some(self.fill(other, &parts(text, pieces)?)))
    }

    /// Inserts parts into a text: `{0}` unchanged, `{0!}` translated too.
    fn fill(&self, text: &str, parts: &[&str]) -> String {
        let mut filled = String::new();
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('{') {
            filled += before;
            let (place, after) = after.split_once('}').unwrap_or((after, ""));
            let number = place.trim_end_matches('!').parse::<usize>();
            let part = number
                .ok()
                .and_then(|n| parts.get(n))
                .copied()
                .unwrap_or("");
            match place.ends_with('!') {
                true => filled += &self.get(part).unwrap_or_else(|| part.to_owned()),
                false => filled += part,
            }
            rest = after;
        }
        filled + rest
    }
}

/// The parts of a text between the pieces of a pattern, if the text matches it.
fn parts<'a>(text: &'a str, pieces: &[&str]) -> Option<Vec<&'a str>> {
    let (first, others) = pieces.split_first()?;
    let (last, between) = others.split_last()?;
    let mut rest = text.strip_prefix(first)?.strip_suffix(last)?;
    let mut parts = Vec::with_capacity(others.len());
    for piece in between {
        let (part, after) = rest.split_once(piece)?;
        parts.push(part);
        rest = after;
    }
    parts.push(rest);
    Some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_found_whole_and_by_their_pattern() {
        let table = Table::new(&[&[
            ("Start", "开始"),
            ("now", "现在"),
            ("{} and {} meet, as of {}.", "{2!},{0} 与 {1} 相交。"),
            ("{} meet.", "{0} 相交。"),
        ]]);
        let cases = [
            ("Start", Some("开始")),
            ("a and b meet, as of now.", Some("现在,a 与 b 相交。")),
            (
                "a and b meet, as of 2 s ago.",
                Some("2 s ago,a 与 b 相交。"),
            ),
            ("they meet.", Some("they 相交。")),
            ("They part.", None),
        ];
        for (english, other) in cases {
            assert_eq!(table.get(english).as_deref(), other, "{english}");
        }
    }

    #[test]
    fn every_text_is_there_once_and_is_chinese_with_all_its_parts() {
        let mut seen = std::collections::HashSet::new();
        for (english, chinese) in chinese::TEXTS.into_iter().flatten() {
            assert!(seen.insert(english), "twice: {english}");
            assert!(!english.is_empty() && !chinese.is_empty());
            let count = english.matches("{}").count();
            for part in 0..count {
                let named = [format!("{{{part}}}"), format!("{{{part}!}}")];
                let shown = named.iter().any(|name| chinese.contains(name));
                assert!(shown, "{english}: part {part} is lost");
            }
            assert_eq!(chinese.matches('{').count(), count, "{english}");
        }
    }

    #[test]
    fn what_tables_offer_is_in_every_language() {
        use crate::session::{BEYOND, CHARTS, LABS, PRESETS, Session};
        // A scene with turning bodies, so that all curves exist.
        let scene = scene::Scene::load("tennis-racket").expect("in the gallery");
        let session = Session::new(scene).expect("a session");
        let mut texts: Vec<&str> = vec![BEYOND];
        for method in sim_core::METHODS {
            texts.extend([method.title, method.stability]);
        }
        for force in &sim_core::FORCES {
            let about = force.description();
            texts.extend([about.title, about.law]);
            force
                .clone()
                .fields(|field| texts.extend([field.title, field.meaning]));
        }
        for entry in scene::SCENES {
            texts.extend([entry.title(), entry.about()]);
        }
        let curves: Vec<_> = CHARTS
            .iter()
            .flat_map(|chart| session.curves(chart))
            .collect();
        for chart in &CHARTS {
            texts.extend([chart.title, chart.meaning]);
        }
        let names = curves.iter().map(|curve| curve.name.as_str());
        texts.extend(names);
        for preset in &PRESETS {
            texts.extend([preset.title, preset.meaning]);
        }
        for lab in &LABS {
            texts.push(lab.title);
            for stop in lab.stops {
                texts.extend([stop.title, stop.watch, stop.question, stop.answer]);
                texts.extend(stop.attempts.iter().map(|attempt| attempt.title));
            }
        }
        // Components along an axis and the acceleration of gravity have a letter as their name.
        let missing: Vec<&str> = texts
            .into_iter()
            .filter(|text| text.len() > 1)
            .filter(|text| Language::Chinese.translated(text).is_none())
            .collect();
        assert_eq!(missing, Vec::<&str>::new());
    }
}
