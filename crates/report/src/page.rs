//! The page: one HTML file that needs nothing else.

use cases::CASES;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::plots::{Figure, Plot};
use crate::results::Results;
use crate::scope::Scope;
use crate::stopwatch::WHAT_IS_TIMED;
use crate::table::Table;
use crate::tables;

/// A plot with its figures drawn.
pub(crate) type Drawn = (&'static Plot, Vec<Figure>);

const STYLE: &str = "
body { font: 16px/1.45 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem;
  color: #111; background: #fff }
h1, h2, h3 { line-height: 1.2 } h2 { margin-top: 3rem; border-top: 1px solid #ccc; padding-top: 1rem }
p { max-width: 46rem }
figure { margin: 1rem 0; break-inside: avoid } figure svg { width: 100%; height: auto }
figcaption { font-size: 0.9rem; color: #333; max-width: 60rem }
table { border-collapse: collapse; font-size: 0.85rem; margin: 1rem 0; font-variant-numeric: tabular-nums }
caption { text-align: left; font-weight: 600; padding: 0.3rem 0 }
th, td { text-align: left; vertical-align: top; padding: 0.15rem 0.5rem; border-bottom: 1px solid #ddd }
th { border-bottom: 2px solid #888 } tr { break-inside: avoid }
.wide { overflow-x: auto } .wide table { font-size: 0.75rem }
.pass, .fail, .figure { white-space: nowrap }
.pass { color: #005a32 } .fail { color: #a40000; font-weight: 600 }
.quick { border: 2px solid #a40000; padding: 0.5rem 1rem }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 0.2rem 1rem } dt { font-weight: 600 }
dd { margin: 0 } nav a { margin-right: 1rem }
@page { size: A4 landscape; margin: 12mm }
@media print { body { font-size: 10pt; margin: 0; max-width: none } h2 { break-before: page }
  .wide { overflow: visible } .wide table { font-size: 7pt } }
";

pub(crate) fn render(
    results: &Results,
    plots: &[Drawn],
    facts: &[(&str, String)],
    scope: Scope,
) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "Cowbell: speed against error" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { "Cowbell: speed against error" }
                p {
                    "What each method costs and what it gets wrong. Every figure on this page was \
                     measured by one run of the command below. Times are "
                    (WHAT_IS_TIMED)
                    ", medians \
                     of repeated runs after one to warm up, and include setting a run up; errors are \
                     those achieved, never those asked for."
                }
                @if scope == Scope::Quick {
                    p.quick {
                        "A quick run: few points, few repeats. It shows the form of the report; its \
                         times mean little."
                    }
                }
                nav {
                    @for (plot, _) in plots { a href={ "#" (plot.name) } { (plot.title) } }
                    a href="#hard-cases" { "Hard cases" }
                    a href="#contact" { "Contact" }
                    a href="#methods" { "Methods" }
                    a href="#machine" { "Machine" }
                }
                @for drawn in plots { (section(results, drawn)) }
                (hard_cases(results))
                (contact(results))
                h2 #methods { "Methods" }
                div.wide { (tables::methods().html()) }
                (machine(facts))
            }
        }
    };
    page.into_string()
}

fn section(results: &Results, (plot, figures): &Drawn) -> Markup {
    html! {
        h2 id=(plot.name) { (plot.title) }
        p { (plot.about) }
        @if plot.name == "work-precision" {
            div.wide { (tables::least_errors(results).html()) }
        }
        @for figure in figures {
            @if let Some(heading) = figure.heading { h3 { (heading) } }
            figure {
                (PreEscaped(alone(&figure.svg, &figure.name)))
                figcaption { (figure.caption) }
            }
        }
        @for table in tables_of(plot.name, results) { div.wide { (table.html()) } }
    }
}

/// The tables that belong to a plot.
fn tables_of(plot: &str, results: &Results) -> Vec<Table> {
    match plot {
        "work-precision" => vec![tables::beside_peers(results), tables::failed_runs(results)],
        "drift" => vec![tables::drift(results)],
        "stability" => vec![tables::stability(results)],
        "collisions" => vec![tables::collisions(results), tables::bounces(results)],
        "resting" => vec![tables::resting(results)],
        "turning" => vec![
            tables::tumbling(results),
            tables::racket(results),
            tables::first_contacts(results),
            tables::levers(results),
        ],
        _ => Vec::new(),
    }
}

/// A picture whose names do not meet those of another one on the page.
fn alone(svg: &str, name: &str) -> String {
    svg.replace("kuva-clip", &format!("{name}-clip"))
}

fn hard_cases(results: &Results) -> Markup {
    html! {
        h2 #hard-cases { "Hard cases" }
        p {
            "Cases with a known outcome. A cell is the verdict and the figure that decides it; the \
             tolerances and the reasons are in the table after it. A method that fails a case it was \
             not made for is shown as failing it; the table also has the verdict that each case's row \
             expects, to which the tests hold it."
        }
        div.wide { (tables::matrix(results).html()) }
        dl {
            @for case in &CASES {
                dt { (case.number) " " (case.title) }
                dd { (case.outcome) "." }
            }
        }
        div.wide { (tables::hard_cases(results).html()) }
    }
}

fn contact(results: &Results) -> Markup {
    html! {
        h2 #contact { "Naive against BVH" }
        p {
            "Every edge of one mesh against every triangle of the other, and the same question \
             through bounding volume hierarchies; building them is not part of the time. They meet: \
             30 % closer than where they first touch; they do not: 1 % farther. The benchmarks, "
            code { "cargo bench" }
            ", have more meshes."
        }
        (tables::contact(results).html())
    }
}

fn machine(facts: &[(&str, String)]) -> Markup {
    html! {
        h2 #machine { "Machine and versions" }
        dl { @for (name, value) in facts { dt { (name) } dd { (value) } } }
        p { "Beside this page are its tables as CSV and Markdown and its figures as SVG." }
    }
}
