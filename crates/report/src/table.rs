//! Tables for the page, for people and for programs.

use maud::{Markup, html};

#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// Name of its file.
    pub(crate) name: &'static str,
    pub(crate) title: String,
    pub(crate) head: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn new(name: &'static str, title: impl Into<String>, head: &[&str]) -> Table {
        Table {
            name,
            title: title.into(),
            head: head.iter().map(|&cell| cell.into()).collect(),
            rows: Vec::new(),
        }
    }

    pub(crate) fn html(&self) -> Markup {
        html! {
            table {
                caption { (self.title) }
                thead { tr { @for cell in &self.head { th { (cell) } } } }
                tbody {
                    @for row in &self.rows {
                        tr { @for cell in row { td class=(class_of(cell)) { (cell) } } }
                    }
                }
            }
        }
    }

    /// Comma-separated values as RFC 4180 has them.
    pub(crate) fn csv(&self) -> String {
        let rows = [&self.head].into_iter().chain(&self.rows);
        let lines = rows.map(|row| {
            let cells: Vec<String> = row.iter().map(|cell| quoted(cell)).collect();
            cells.join(",") + "\n"
        });
        lines.collect()
    }

    pub(crate) fn markdown(&self) -> String {
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|c| c.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let rule = "|---".repeat(self.head.len()) + "|\n";
        let rows: String = self.rows.iter().map(|row| line(row)).collect();
        format!("### {}\n\n{}{rule}{rows}\n", self.title, line(&self.head))
    }
}

/// Verdicts are coloured, and written out for whoever sees no colours; figures stay on their line.
fn class_of(cell: &str) -> &'static str {
    match cell.split(' ').next() {
        Some("pass") => "pass",
        Some("FAIL" | "NO") => "fail",
        _ if cell.len() <= LONGEST_FIGURE => "figure",
        _ => "",
    }
}

/// Bytes of a figure with its unit, at most.
const LONGEST_FIGURE: usize = 12;

fn quoted(cell: &str) -> String {
    match cell.contains([',', '"', '\n']) {
        true => format!("\"{}\"", cell.replace('"', "\"\"")),
        false => cell.into(),
    }
}

/// A time with its unit: `1.43 ms`.
pub(crate) fn seconds(s: f64) -> String {
    let (value, unit) = match s {
        s if s < 1e-6 => (1e9 * s, "ns"),
        s if s < 1e-3 => (1e6 * s, "µs"),
        s if s < 1.0 => (1e3 * s, "ms"),
        s => (s, "s"),
    };
    let digits = match value {
        v if v < 9.995 => 2,
        v if v < 99.95 => 1,
        _ => 0,
    };
    format!("{value:.digits$} {unit}")
}

/// A figure of two digits, such as an error.
pub(crate) fn short(x: f64) -> String {
    match x {
        0.0 => "0".into(),
        x if x.is_nan() => "–".into(),
        x if x.is_infinite() => "∞".into(),
        x => format!("{x:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new("t", "A & B", &["a", "b"]);
        table.rows.push(vec!["x, \"y\"".into(), "<p|q>".into()]);
        table
    }

    #[test]
    fn what_has_a_meaning_in_a_format_is_escaped_there() {
        assert_eq!(table().csv(), "a,b\n\"x, \"\"y\"\"\",<p|q>\n");
        let html = table().html().into_string();
        assert!(
            html.contains("A &amp; B") && html.contains("&lt;p|q&gt;"),
            "{html}"
        );
        assert!(table().markdown().ends_with("| x, \"y\" | <p\\|q> |\n\n"));
    }

    #[test]
    fn times_have_three_digits_and_a_unit() {
        assert_eq!(seconds(1.4321e-3), "1.43 ms");
        assert_eq!(seconds(99.96e-6), "100 µs");
        assert_eq!(seconds(25.04e-9), "25.0 ns");
    }
}
