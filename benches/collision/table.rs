//! Tables, and figures in a readable form.

use std::fmt::Write;

pub(crate) struct Table {
    pub(crate) title: String,
    pub(crate) header: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn new(title: &str, header: &[&str]) -> Table {
        Table {
            title: title.into(),
            header: header.iter().map(|&cell| cell.into()).collect(),
            rows: Vec::new(),
        }
    }

    /// Aligned, so that it is readable in a terminal too.
    pub(crate) fn markdown(&self) -> String {
        let widths: Vec<usize> = (0..self.header.len())
            .map(|i| {
                let column = self.rows.iter().chain([&self.header]).map(|row| &row[i]);
                column.map(|cell| cell.chars().count()).max().unwrap_or(0)
            })
            .collect();
        let mut text = format!("### {}\n\n", self.title);
        let mut line = |cells: &[String]| {
            for (i, (cell, &width)) in cells.iter().zip(&widths).enumerate() {
                let pad = " ".repeat(width - cell.chars().count());
                // The first column has names, the others figures.
                let cell = if i == 0 {
                    format!("{cell}{pad}")
                } else {
                    format!("{pad}{cell}")
                };
                let _ = write!(text, "| {cell} ");
            }
            text.push_str("|\n");
        };
        line(&self.header);
        let rule = |(i, &width): (usize, &usize)| {
            if i == 0 {
                "-".repeat(width)
            } else {
                format!("{}:", "-".repeat(width - 1))
            }
        };
        line(&widths.iter().enumerate().map(rule).collect::<Vec<_>>());
        for row in &self.rows {
            line(row);
        }
        text
    }
}

/// A time in a suitable unit, with three digits.
pub(crate) fn time(seconds: f64) -> String {
    if seconds.is_nan() {
        return "-".into();
    }
    let (value, unit) = match seconds {
        s if s < 1e-6 => (s * 1e9, "ns"),
        s if s < 1e-3 => (s * 1e6, "µs"),
        s if s < 1.0 => (s * 1e3, "ms"),
        s => (s, "s"),
    };
    format!("{} {unit}", three_digits(value))
}

pub(crate) fn three_digits(value: f64) -> String {
    let digits = match value.abs() {
        v if v < 10.0 => 2,
        v if v < 100.0 => 1,
        _ => 0,
    };
    format!("{value:.digits$}")
}
