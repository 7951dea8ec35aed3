//! How a method or solver is drawn: told apart by marker and dashes where there is no colour.

use cases::solvers::{Kind, Solver};
use kuva::plot::scatter::MarkerShape;
use kuva::plot::{LegendEntry, LegendShape, LineStyle};
use sim_core::{METHODS, Method};

#[derive(Clone, Debug)]
pub(super) struct Style {
    pub(super) label: &'static str,
    pub(super) color: &'static str,
    pub(super) marker: MarkerShape,
    pub(super) line: LineStyle,
}

/// Colours that differ for colour-blind eyes too (Okabe, Ito 2008, "Color universal design"), the
/// yellow darker to be seen on white.
const COLORS: [&str; 8] = [
    "#000000", "#e69f00", "#56b4e9", "#d55e00", "#009e73", "#cc79a7", "#0072b2", "#b0a000",
];

const MARKERS: [MarkerShape; 10] = [
    MarkerShape::Circle,
    MarkerShape::Square,
    MarkerShape::Triangle,
    MarkerShape::Diamond,
    MarkerShape::TriangleDown,
    MarkerShape::Plus,
    MarkerShape::Hexagon,
    MarkerShape::Star,
    MarkerShape::Pentagon,
    MarkerShape::Cross,
];

impl Style {
    /// By the place in the table of methods, so that a new one has a style of its own.
    pub(super) fn of_method(method: &'static Method) -> Style {
        let place = METHODS
            .iter()
            .position(|m| *m == method)
            .unwrap_or(METHODS.len());
        let lines = [
            LineStyle::Solid,
            LineStyle::Dashed,
            LineStyle::DashDot,
            LineStyle::Dotted,
        ];
        Style {
            label: method.title,
            color: COLORS[place % COLORS.len()],
            marker: MARKERS[place % MARKERS.len()],
            line: lines[place % lines.len()].clone(),
        }
    }

    /// Marker by the method, line and colour by the crate.
    pub(super) fn of_solver(solver: &'static Solver) -> Style {
        let (color, line) = match solver.kind {
            Kind::OurDopri5 | Kind::OurDop853 => ("#0072b2", LineStyle::Solid),
            Kind::OdeSolversDopri5 | Kind::OdeSolversDop853 => ("#d55e00", LineStyle::Dashed),
            _ => ("#000000", LineStyle::Dotted),
        };
        let marker = match solver.kind {
            Kind::OurDopri5 | Kind::OdeSolversDopri5 | Kind::DifferentialEquationsDopri5 => {
                MarkerShape::Circle
            }
            Kind::OurDop853 | Kind::OdeSolversDop853 | Kind::DifferentialEquationsDop853 => {
                MarkerShape::Square
            }
            Kind::DifferentialEquationsRadau5 => MarkerShape::Star,
        };
        Style {
            label: solver.title,
            color,
            marker,
            line,
        }
    }

    pub(super) fn legend(&self) -> LegendEntry {
        LegendEntry {
            label: self.label.into(),
            color: self.color.into(),
            shape: LegendShape::Marker(self.marker),
            dasharray: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_methods_look_alike_without_colour() {
        let looks = METHODS.map(|method| {
            let style = Style::of_method(method);
            (format!("{:?}", style.marker), format!("{:?}", style.line))
        });
        for (i, look) in looks.iter().enumerate() {
            assert!(!looks[..i].contains(look), "{i}: {look:?}");
        }
    }
}
