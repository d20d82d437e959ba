//! The page.

use super::*;
use crate::report::html;
use crate::report::page::{Figure, signs};
use maud::{Markup, html};
use stratcore::dimensions::LATTICE;
use stratcore::literature::BOUND;

/// The whole page; `report` if the paper's page lies beside it.
pub fn render(document: &Document, figures: &[Figure], report: bool) -> String {
    let lead = html! {
        "Lens, area light and shutter add dimensions to a pixel. What each way of stratifying \
         them is worth, measured on pictures, beside what theory says of the axes that each pixel \
         needs."
    };
    let body = html! {
        @if !document.complete {
            p.warning { "This page is not complete: what is missing was not finished." }
        }
        p { strong { (document.summary()) "." } " " (HELD) "." }
        h2 { "Every combination" }
        (overview(document))
        (rule(document))
        @for table in &document.pixels { (section(table, figures)) }
        @if !document.filters.is_empty() { (filters(document)) }
        (html::made_again(&document.command, document.seed, report))
    };
    html::page(TITLE, &lead, &body)
}

/// A line for each pixel, a column for each sampler.
fn overview(document: &Document) -> Markup {
    let names = document
        .pixels
        .first()
        .map_or(Vec::new(), |table| table.samplers.iter().map(|row| row.name).collect::<Vec<_>>());
    html! { .table { table {
        thead { tr {
            th { "Axes" } th { "d" } th { "k" } th { "Pixel" }
            @for name in &names { th { (name) } }
        } }
        tbody { @for table in &document.pixels { tr {
            td { a href={ "#" (table.figure.name) } { (table.features) } }
            td { (table.dim) }
            td { (k(table)) }
            td.whole { (table.kind) }
            @for row in &table.samplers {
                td class={ "whole " (class(row.test.as_ref())) } {
                    @match row.fit {
                        Some(fit) => { (with_error(fit.exponent, fit.std_error)) }
                        None => { "–" }
                    }
                    p.note { "limit " (limit_words(row)) }
                }
            }
        } } }
    } } }
}

fn class(test: Option<&Finding>) -> &'static str {
    match test.map(Finding::verdict) {
        Some(Verdict::Holds) => "holds",
        Some(Verdict::Fails) => "fails",
        _ => "open",
    }
}

fn rule(document: &Document) -> Markup {
    let trials = document.pixels.first().map_or(0, |table| table.trials);
    html! {
        p {
            "Pixels are chosen by rule among a lattice of " (LATTICE) " × " (LATTICE) ". Edge: of "
            "those where radiance jumps, the one whose least needed feature (square, lens, light, "
            "time) moves most of the variance. Smooth: of those without jumps the same, but for "
            "features with less than 1 % of the variance. M = " (trials) " trials."
        }
        p {
            "Limits are for large N. k is d − 1 wherever radiance jumps: an edge that depends on "
            "few axes runs along all others, and a full grid cuts as many of its strata. Padded "
            "sets leave what a pixel needs of several pairs together, hypercubes what it needs of "
            "two axes, orthogonal arrays what it needs of three, as random points do: p falls to "
            "1. Nets profit where an edge depends on few axes."
        }
        p {
            "Exponents at these N are those of variances found without trials, from differences "
            "of radiance within strata. A prediction holds where p is within " (BOUND) " standard "
            "errors of that and every variance is, at a bound that they share; else where the "
            "last variance is no smaller than what the sampler must leave, or p no smaller than "
            "its bound. A true one fails once in 2,150 times."
        }
    }
}

fn section(table: &PixelTable, figures: &[Figure]) -> Markup {
    let [x, y] = table.pixel;
    html! {
        h3 id=(table.figure.name) {
            (table.features) ": " (table.kind) " (" (table.scene) ", pixel " (x) "," (y) ")"
        }
        p.source { (signs(&needs(table))) "; shares of the variance overlap" }
        @if let Some(far) = table.far {
            p { "jittered at N = " (far.strata[0]) sup { (table.dim) } " to " (far.strata[1])
                sup { (table.dim) } ", from differences alone: p = "
                (with_error(far.exponent.value, far.exponent.std_error)) "." }
        }
        .figures { @for figure in figures.iter().filter(|f| f.name == table.figure.name) {
            (html::figure(figure, ""))
        } }
        .table { table {
            thead { tr {
                th { "Sampler" } th { "N" } th { "Limit" } th { "At these N" } th { "p (95 %)" }
                th { "Prediction" }
            } }
            tbody { @for row in &table.samplers { tr {
                td { (row.name)
                    @if let Some(limit) = row.limit { p.note { (limit.source) } }
                    @if let Some(test) = &row.test {
                        @if test.quantity != "p" || test.verdict() == Verdict::Fails {
                            p.note { (signs(&reason(test))) }
                        }
                    }
                }
                td.whole { (span(row.fit.as_ref())) }
                td { (limit_words(row)) }
                td { (exponent(row.at_these_n)) }
                td.whole { (measured(row.fit.as_ref())) }
                td class={ "whole " (class(row.test.as_ref())) } { (verdict(row.test.as_ref())) }
            } } }
        } }
    }
}

fn filters(document: &Document) -> Markup {
    let rows = filter_rows(document);
    html! {
        h2 { "Filters" }
        p {
            "Two pixels of the scene edges under each filter, jittered over the filter's support: "
            "an edge at 62° and a ramp. A wider filter spreads the same points over more of the "
            "picture. Importance sampling draws them by |w|; with a negative lobe their sign "
            "jumps, and a ramp converges like an edge."
        }
        .table { table {
            @for row in rows.iter().take(1) {
                thead { tr { @for cell in row { th { (cell) } } } }
            }
            tbody { @for (row, found) in rows.iter().skip(1).zip(&document.filters) { tr {
                @for cell in row.iter().take(row.len() - 1) { td.whole { (signs(cell)) } }
                td class={ "whole " (class(found.test.as_ref())) } {
                    (verdict(found.test.as_ref()))
                }
            } } }
        } }
    }
}
