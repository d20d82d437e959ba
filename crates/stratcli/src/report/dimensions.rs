//! Pixels in two to seven dimensions, and filters, as one HTML page, as CSV, and as text.

use super::page::{self, Figure, signs};
use crate::table::{Align, columns, number, short, with_error};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde::Serialize;
use stratcore::dimensions::{Bound, FilterRow, LATTICE, PixelTable, SamplerRow};
use stratcore::fit::Fit;
use stratcore::literature::{BOUND, Effort, Finding, Verdict};

/// The page's file.
pub const PAGE: &str = "dimensions.html";
/// The page's heading.
pub const TITLE: &str = "Two to seven dimensions, measured";

/// What was measured, and how.
#[derive(Debug, Clone, Serialize)]
pub struct Document {
    /// The command that makes this again.
    pub command: String,
    /// Whether every combination is there.
    pub complete: bool,
    /// Seed of all randomness.
    pub seed: u64,
    /// How much was spent.
    pub effort: Effort,
    /// Tests that hold.
    pub holds: usize,
    /// Tests that fail.
    pub fails: usize,
    /// Each combination of features: a pixel with an edge and one without.
    pub pixels: Vec<PixelTable>,
    /// Filters on an edge and on a ramp.
    pub filters: Vec<FilterRow>,
}

impl Document {
    /// Without results.
    pub fn new(command: String, seed: u64, effort: Effort) -> Self {
        let (pixels, filters) = (Vec::new(), Vec::new());
        Self { command, complete: false, seed, effort, holds: 0, fails: 0, pixels, filters }
    }

    /// Counts what holds.
    pub fn judge(&mut self) {
        let of_pixels = self.pixels.iter().flat_map(|p| p.samplers.iter().map(|row| &row.test));
        let tests = of_pixels.chain(self.filters.iter().map(|row| &row.test)).flatten();
        let verdicts: Vec<Verdict> = tests.map(Finding::verdict).collect();
        let count = |verdict| verdicts.iter().filter(|v| **v == verdict).count();
        (self.holds, self.fails) = (count(Verdict::Holds), count(Verdict::Fails));
    }

    fn summary(&self) -> String {
        format!(
            "{} pixels, {} filters: {} predictions hold, {} fail",
            self.pixels.len(),
            self.filters.len(),
            self.holds,
            self.fails
        )
    }
}

fn limit_words(row: &SamplerRow) -> String {
    row.limit.map_or("–".to_owned(), |limit| {
        let sign = if limit.bound == Bound::AtLeast { "≥ " } else { "" };
        format!("{sign}{}", short(limit.exponent, 4))
    })
}

fn exponent(value: Option<f64>) -> String {
    value.map_or("–".to_owned(), |p| format!("{p:.2}"))
}

fn measured(fit: Option<&Fit>) -> String {
    fit.map_or("–".to_owned(), |f| {
        let [lo, hi] = f.ci95;
        format!("{:.2} ({lo:.2} to {hi:.2})", f.exponent)
    })
}

fn span(fit: Option<&Fit>) -> String {
    fit.map_or("–".to_owned(), |f| format!("{} to {}", f.n_min, f.n_max))
}

fn verdict(test: Option<&Finding>) -> String {
    test.map_or("–".to_owned(), |test| test.verdict().to_string())
}

/// What is predicted to be what, in words; for k nothing where nothing jumps.
fn needs(table: &PixelTable) -> String {
    let axes = table.needs.axes.iter().map(|axis| {
        format!("{} {} % {}", axis.name, short(100.0 * axis.share.value, 2), axis.behaviour)
    });
    axes.collect::<Vec<_>>().join(", ")
}

fn k(table: &PixelTable) -> String {
    table.discontinuity_dim.map_or("–".to_owned(), |k| k.to_string())
}

/// Everything as text.
pub fn text(document: &Document) -> String {
    let head = ["", "d", "k", "pixel", "sampler", "N", "limit", "at these N", "p (95 %)", ""];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for table in &document.pixels {
        let [x, y] = table.pixel;
        for (i, row) in table.samplers.iter().enumerate() {
            let once = |words: String| if i == 0 { words } else { String::new() };
            rows.push(vec![
                once(table.features.to_owned()),
                once(table.dim.to_string()),
                once(k(table)),
                once(format!("{} {x},{y}", table.kind)),
                row.name.to_owned(),
                span(row.fit.as_ref()),
                limit_words(row),
                exponent(row.at_these_n),
                measured(row.fit.as_ref()),
                verdict(row.test.as_ref()),
            ]);
        }
    }
    let mut text = columns(Align::Left, &rows);
    if !document.filters.is_empty() {
        text += &format!("\n{}", columns(Align::Left, &filter_rows(document)));
    }
    text += "\n";
    for test in failures(document) {
        text += &format!("fails: {}\n", reason(test));
    }
    text + HELD + "\n" + &document.summary() + "\n"
}

/// Against what a row is held: a limit may lie far beyond the N tried.
const HELD: &str = "held: p and each variance against those found without trials; padded and oa \
                    by the variance that they leave, sobol by its bound";

fn failures(document: &Document) -> impl Iterator<Item = &Finding> {
    let of_pixels = document.pixels.iter().flat_map(|p| p.samplers.iter().map(|row| &row.test));
    let tests = of_pixels.chain(document.filters.iter().map(|row| &row.test)).flatten();
    tests.filter(|test| test.verdict() == Verdict::Fails)
}

fn reason(test: &Finding) -> String {
    let pair = |value: Option<f64>, error: Option<f64>| match (value, error) {
        (Some(value), Some(error)) => with_error(value, error),
        _ => "–".to_owned(),
    };
    let expected = test.expected.unwrap_or(f64::NAN);
    let worst = test.checks.iter().max_by(|a, b| {
        let off =
            |check: &stratcore::literature::Check| (check.ratio - 1.0).abs() / check.std_error;
        off(a).total_cmp(&off(b))
    });
    let at = worst.map_or(String::new(), |check| {
        let found = with_error(check.ratio, check.std_error);
        format!("; farthest at {}: {found} times what is predicted", check.at)
    });
    let found = pair(test.measured, test.std_error);
    format!("{}: {} {found} against {expected:.3}{at}", test.case, test.quantity)
}

fn filter_rows(document: &Document) -> Vec<Vec<String>> {
    let head = [
        "filter",
        "radius",
        "way",
        "pixel",
        "C of random / box",
        "variance / box, N = 4096",
        "limit",
        "at these N",
        "p (95 %)",
        "",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for row in &document.filters {
        let [ratio, error] = row.over_box;
        rows.push(vec![
            row.shape.to_string(),
            number(row.radius, 2),
            row.method.to_string(),
            row.kind.to_string(),
            number(row.one_sample, 3),
            if ratio < 1000.0 {
                with_error(ratio, error)
            } else {
                format!("{} ± {}", number(ratio, 2), number(error, 2))
            },
            short(row.limit, 3),
            exponent(row.at_these_n),
            measured(row.fit.as_ref()),
            verdict(row.test.as_ref()),
        ]);
    }
    rows
}

/// One line for each N of each sampler and filter, numbers in full.
pub fn csv(document: &Document) -> String {
    let mut text =
        "scene,features,dim,k,kind,x,y,sampler,scramble,n,trials,variance_of_mean,lo,hi,\
                    expected_variance,expected_std_error,limit,limit_is,p,p_std_error\n"
            .to_owned();
    let optional = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
    for table in &document.pixels {
        for sampler in &table.samplers {
            for (i, row) in sampler.rows.iter().enumerate() {
                let expected = sampler.expected.get(i);
                let [lo, hi] = row.ci95();
                let limit_is = sampler.limit.map_or("", |limit| match limit.bound {
                    Bound::Equals => "equals",
                    Bound::AtLeast => "at_least",
                });
                let fields = [
                    table.scene.to_owned(),
                    format!("\"{}\"", table.features),
                    table.dim.to_string(),
                    table.discontinuity_dim.map_or(String::new(), |k| k.to_string()),
                    table.kind.to_string(),
                    table.pixel[0].to_string(),
                    table.pixel[1].to_string(),
                    sampler.name.to_owned(),
                    sampler.scramble.to_string(),
                    row.n_used.to_string(),
                    table.trials.to_string(),
                    row.variance_of_mean.to_string(),
                    lo.to_string(),
                    hi.to_string(),
                    optional(expected.map(|e| e.variance)),
                    optional(expected.map(|e| e.std_error)),
                    optional(sampler.limit.map(|limit| limit.exponent)),
                    limit_is.to_owned(),
                    optional(sampler.fit.map(|fit| fit.exponent)),
                    optional(sampler.fit.map(|fit| fit.std_error)),
                ];
                text += &fields.join(",");
                text.push('\n');
            }
        }
    }
    text
}

/// The whole page; `report` if the paper's page lies beside it.
pub fn render(document: &Document, figures: &[Figure], report: bool) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (TITLE) }
                style { (PreEscaped(include_str!("page.css"))) }
            }
            body { main {
                header {
                    h1 { (TITLE) }
                    p.lead { "Lens, area light and shutter add dimensions to a pixel. What each \
                              way of stratifying them is worth, measured on pictures, beside what \
                              theory says of the axes that each pixel needs." }
                }
                @if !document.complete {
                    p.warning { "This page is not complete: what is missing was not finished." }
                }
                p { strong { (document.summary()) "." } " " (HELD) "." }
                h2 { "Every combination" }
                (overview(document))
                (rule(document))
                @for table in &document.pixels { (section(table, figures)) }
                @if !document.filters.is_empty() { (filters(document)) }
                h2 { "Made again by" }
                p { code { (document.command) } }
                p { "Seed " (document.seed) ". The same seed gives the same numbers on any number \
                     of threads." }
                @if report { p { a href=(page::NAME) { "The paper's own figures" } " are beside \
                                                        this page." } }
                footer { "stratcli " (env!("CARGO_PKG_VERSION")) }
            } }
        }
    };
    page.into_string()
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
            figure {
                (PreEscaped(&figure.inline))
                figcaption { (figure.caption) }
            }
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

#[cfg(test)]
mod tests {
    use super::*;
    use stratcore::dimensions::{Estimate, Expected, Kind, Limit, Needs};
    use stratcore::literature::Figure as Plot;
    use stratcore::sampler::Scramble;

    /// One sampler whose p is this where 1.25 is predicted.
    fn document(p: f64) -> Document {
        let none = Estimate { value: 0.0, std_error: 0.0 };
        let needs = Needs {
            axes: Vec::new(),
            variance: none,
            beyond_axes: none,
            beyond_pairs: none,
            beyond_two: none,
        };
        let limit =
            Limit { exponent: 1.25, bound: Bound::Equals, floor: None, source: "Mitchell 1996" };
        let row = SamplerRow {
            name: "jittered",
            scramble: Scramble::None,
            rows: Vec::new(),
            fit: None,
            limit: Some(limit),
            expected: vec![Expected { n: 16, variance: 1.0, std_error: 0.0 }],
            at_these_n: Some(1.25),
            test: Some(Finding::new("jittered, N = 16 to 256", "p", 1.25).measured(p, 0.01)),
        };
        let figure = Plot {
            name: "lens-edge",
            title: "",
            caption: String::new(),
            axes: ["", ""],
            log_x: true,
            curves: Vec::new(),
            slopes: Vec::new(),
        };
        let mut document = Document::new("stratcli".to_owned(), 1996, Effort::Quick);
        document.pixels.push(PixelTable {
            scene: "room-point-lens",
            features: "pixel, lens",
            dim: 4,
            kind: Kind::Edge,
            pixel: [3, 4],
            trials: 50,
            needs,
            discontinuity_dim: Some(3),
            samplers: vec![row],
            far: None,
            figure,
        });
        document.judge();
        document
    }

    #[test]
    fn a_planted_wrong_exponent_is_shown_as_failing() {
        let (right, wrong) = (document(1.26), document(1.4));
        assert_eq!((right.holds, right.fails), (1, 0));
        assert_eq!((wrong.holds, wrong.fails), (0, 1));
        assert!(text(&right).contains("1 predictions hold, 0 fail"), "{}", text(&right));
        assert!(
            text(&wrong).contains("fails: jittered, N = 16 to 256: p 1.40 ± 0.01 against 1.250")
        );
        assert!(render(&wrong, &[], false).contains(r#"class="whole fails""#));
        assert!(!render(&right, &[], false).contains(r#"class="whole fails""#));
    }
}
