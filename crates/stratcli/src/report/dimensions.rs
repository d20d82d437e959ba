//! Pixels in two to seven dimensions, and filters, as one HTML page, as CSV, and as text.

mod csv;
mod page;

pub use csv::csv;
pub use page::render;

use crate::table::{Align, columns, number, short, with_error};
use serde::Serialize;
use stratcore::dimensions::{Bound, FilterRow, PixelTable, SamplerRow};
use stratcore::fit::Fit;
use stratcore::literature::{Effort, Finding, Verdict};

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
