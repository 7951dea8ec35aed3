//! Scenes of the gallery with hostile values.

use scene::SCENES;

use crate::cases::Source;

/// Numbers at the limits of the allowed ranges, and just beyond.
const NUMBERS: [&str; 32] = [
    "0",
    "-0",
    "0.0",
    "-0.0",
    "nan",
    "-nan",
    "inf",
    "-inf",
    "1",
    "-1",
    "5e-324",
    "1e-300",
    "-1e-300",
    "1e-100",
    "1e-46",
    "1e-16",
    "1e-9",
    "0.1",
    "1e9",
    "1e15",
    "-1e15",
    "1e39",
    "1e99",
    "1e100",
    "-1e100",
    "1.1e100",
    "1e300",
    "1e400",
    "10000",
    "10001",
    "9223372036854775807",
    "-9223372036854775809",
];

/// Values of other types, wrong in nearly every place.
const VALUES: [&str; 24] = [
    "[]",
    "[[]]",
    "[[], []]",
    "[0, 0, 0]",
    "[1, 2]",
    "[1, 2, 3, 4]",
    "[nan, 0, 0]",
    "[1e100, -1e100, 1e100]",
    "[[-1e100, -1e100, -1e100], [1e100, 1e100, 1e100]]",
    "[[0, 0, 0], [0, 0, 0]]",
    "\"\"",
    "\" \"",
    "\"x\"",
    "\"\\u001b]0;x\\u0007\\n\\u202e\"",
    "[\"\"]",
    "[\"a\", \"a\"]",
    "[\"a\", \"b\", \"c\"]",
    "true",
    "false",
    "{}",
    "{ a = 1 }",
    "1979-05-27",
    "0x7fffffffffffffff",
    "'''\n'''",
];

/// Settings that every scene has.
const CHOICES: [&str; 16] = [
    "collision = \"naive\"",
    "collision = \"bvh\"",
    "method = \"radau5\"",
    "method = \"dop853\"",
    "method = \"backward-euler\"",
    "method = \"implicit-midpoint\"",
    "method = \"forward-euler\"",
    "method = \"symplectic-8\"",
    "rate = 1e9",
    "rate = 1e-3",
    "dt = 1e3",
    "tolerance = 1e-15",
    "turns = true",
    "immovable = true",
    "[[body]]",
    "[[force]]",
];

/// The text of a gallery scene of few bodies, with some lines changed as the bytes determine.
pub(crate) fn text(source: &mut Source<'_>) -> String {
    let known = |source: &mut Source<'_>| SCENES[source.below(SCENES.len())].text;
    let lines = |text: &'static str| {
        text.lines()
            .filter(|line| !line.starts_with('#'))
            .map(few_copies)
    };
    let mut all: Vec<String> = lines(known(source)).collect();
    for _ in 0..1 + source.below(4) {
        let place = source.below(all.len());
        let kind = source.below(12);
        let here = all[place].clone();
        let key = here.split('=').next().unwrap_or_default().to_owned();
        match kind {
            0..=4 => all[place] = with_number(&here, source),
            5 => all[place] = format!("{key}= {}", VALUES[source.below(VALUES.len())]),
            6 => all.insert(place, here),
            7 => drop(all.remove(place)),
            8 => {
                // A field of any body or force, possibly one that does not apply here.
                let other: Vec<String> = lines(known(source)).collect();
                let line = with_number(&other[source.below(other.len())], source);
                all.insert(place, line);
            }
            9 => {
                let end = all[place..].iter().position(String::is_empty);
                let block = all[place..end.map_or(all.len(), |end| place + end)].to_vec();
                all.extend(block);
            }
            10 => all.insert(place, CHOICES[source.below(CHOICES.len())].to_owned()),
            _ => all[place] = here.replacen(&key, &format!("x{key}"), 1),
        }
        if all.is_empty() {
            break;
        }
    }
    all.join("\n")
}

/// A line unchanged, or a line of copies with so few of them that steps are fast.
fn few_copies(line: &str) -> String {
    match line.strip_prefix("copies = ").map(str::parse::<usize>) {
        Some(Ok(copies)) => format!("copies = {}", copies.min(4)),
        _ => line.to_owned(),
    }
}

/// A line with one number in its value replaced.
fn with_number(line: &str, source: &mut Source<'_>) -> String {
    let is_between = |c: char| c == ' ' || c == ',' || c == '[' || c == ']';
    let value = line.find('=').map_or(line.len(), |at| at + 1);
    let mut numbers = Vec::new();
    let mut start = value;
    for piece in line[value..].split_inclusive(is_between) {
        let word = piece.trim_end_matches(is_between);
        if word.parse::<f64>().is_ok() {
            numbers.push(start..start + word.len());
        }
        start += piece.len();
    }
    let mut line = line.to_owned();
    if !numbers.is_empty() {
        let place = numbers[source.below(numbers.len())].clone();
        line.replace_range(place, NUMBERS[source.below(NUMBERS.len())]);
    }
    line
}
