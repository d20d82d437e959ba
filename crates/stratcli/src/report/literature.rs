//! The acceptance table of the literature as one HTML page, as CSV, and as text.

use super::html;
use super::page::{Figure, signs};
use crate::table::{Align, columns, number, short, with_error};
use maud::{Markup, html};
use serde::Serialize;
use stratcore::literature::{BOUND, Effort, Finding, Measured, Relation, Standing, Verdict};

/// The page's file.
pub const PAGE: &str = "literature.html";
/// The page's heading.
pub const TITLE: &str = "What the literature claims, measured";

/// The table and how it was made.
#[derive(Debug, Clone, Serialize)]
pub struct Table {
    /// The command that makes this again.
    pub command: String,
    /// Whether every claim is there.
    pub complete: bool,
    /// Seed of all randomness.
    pub seed: u64,
    /// How much was spent.
    pub effort: Effort,
    /// Standard errors that a row may be off, beyond its allowance.
    pub bound: f64,
    /// Rows by verdict.
    pub tally: Tally,
    /// Claims with their rows.
    pub claims: Vec<Measured>,
}

/// Rows by verdict.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// As expected.
    pub holds: usize,
    /// Not as expected.
    pub fails: usize,
    /// Without a verdict: quoted from memory.
    pub recalled: usize,
    /// Nothing to show.
    pub not_measured: usize,
}

impl Table {
    /// An empty table.
    pub fn new(command: String, seed: u64, effort: Effort) -> Self {
        let (tally, claims) = (Tally::default(), Vec::new());
        Self { command, complete: false, seed, effort, bound: BOUND, tally, claims }
    }

    /// Adds a claim.
    pub fn add(&mut self, measured: Measured) {
        for finding in &measured.findings {
            *match finding.verdict() {
                Verdict::Holds => &mut self.tally.holds,
                Verdict::Fails => &mut self.tally.fails,
                Verdict::Recalled => &mut self.tally.recalled,
                Verdict::NotMeasured => &mut self.tally.not_measured,
            } += 1;
        }
        self.claims.push(measured);
    }

    fn rows(&self) -> impl Iterator<Item = (&Measured, &Finding)> {
        self.claims.iter().flat_map(|claim| claim.findings.iter().map(move |f| (claim, f)))
    }

    fn summary(&self) -> String {
        let Tally { holds, fails, recalled, not_measured } = self.tally;
        format!(
            "{} claims, {} rows: {holds} hold, {fails} fail, {recalled} recalled, \
             {not_measured} not measured",
            self.claims.len(),
            holds + fails + recalled + not_measured
        )
    }
}

fn expected(finding: &Finding) -> String {
    let Some(value) = finding.expected else { return "–".to_owned() };
    let sign = match finding.relation {
        Relation::Equals => "",
        Relation::AtMost => "≤ ",
        Relation::AtLeast => "≥ ",
    };
    let allowed = match finding.allowance {
        0.0 => String::new(),
        allowance => format!(", allowing {}", short(allowance, 2)),
    };
    format!("{sign}{}{allowed}", plain(value))
}

/// A number that has no noise.
fn plain(value: f64) -> String {
    short(value, 5)
}

fn measured(finding: &Finding) -> String {
    match (finding.measured, finding.std_error) {
        (Some(value), Some(0.0)) => plain(value),
        // Far below one, decimals show nothing.
        (Some(value), Some(error)) if value.abs().max(error) < 1e-3 => {
            format!("{} ± {}", number(value, 3), number(error, 2))
        }
        (Some(value), Some(error)) => with_error(value, error),
        _ => "–".to_owned(),
    }
}

fn standing(standing: Standing) -> &'static str {
    match standing {
        Standing::Sure => "sure",
        Standing::Derived => "derived",
        Standing::Measured => "seen before",
        Standing::Abstract => "read in an abstract",
        Standing::Recalled => "quoted from memory",
    }
}

/// The table as text: a line for each row, then what failed and why.
pub fn text(table: &Table) -> String {
    let head = ["", "case", "quantity", "expected", "measured", "verdict"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for (claim, finding) in table.rows() {
        let verdict = finding.verdict().to_string();
        let (case, quantity) = (finding.case.clone(), finding.quantity.to_owned());
        let id = claim.id.to_owned();
        rows.push(vec![id, case, quantity, expected(finding), measured(finding), verdict]);
    }
    let mut text = columns(Align::Left, &rows) + "\n";
    for (claim, finding) in table.rows().filter(|(_, f)| f.verdict() == Verdict::Fails) {
        text += &format!("{} fails: {}; {}\n", claim.id, finding.case, reason(finding));
    }
    text + &table.summary() + "\n"
}

/// What a failing row is off by, and its remark.
fn reason(finding: &Finding) -> String {
    let mut words = match finding.z() {
        Some(z) if z > BOUND => format!("{z:.1} standard errors beyond what is allowed"),
        _ => "one of its comparisons is beyond the bound they share".to_owned(),
    };
    if !finding.note.is_empty() {
        words += &format!("; {}", finding.note);
    }
    words
}

/// The table as CSV: one header, a line for each row, numbers in full.
pub fn csv(table: &Table) -> String {
    let mut text = "id,claim,source,standing,case,quantity,relation,expected,allowance,measured,\
                    std_error,z,verdict,note\n"
        .to_owned();
    let optional = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
    for (claim, finding) in table.rows() {
        let relation = match finding.relation {
            Relation::Equals => "equals",
            Relation::AtMost => "at_most",
            Relation::AtLeast => "at_least",
        };
        let fields = [
            claim.id.to_owned(),
            claim.statement.to_owned(),
            claim.source.to_owned(),
            standing(claim.standing).to_owned(),
            finding.case.clone(),
            finding.quantity.to_owned(),
            relation.to_owned(),
            optional(finding.expected),
            finding.allowance.to_string(),
            optional(finding.measured),
            optional(finding.std_error),
            optional(finding.z()),
            finding.verdict().to_string(),
            finding.note.clone(),
        ];
        text += &fields.map(|field| quoted(&field)).join(",");
        text.push('\n');
    }
    text
}

/// A CSV field, in quotes where it needs them.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

/// The whole page; `report` if the paper's page lies beside it.
pub fn render(table: &Table, figures: &[Figure], report: bool) -> String {
    let lead = html! {
        "Each statement about samplers with its source, the number it leads one to expect, and \
         the number found here with its standard error."
    };
    let body = html! {
        @if !table.complete {
            p.warning { "This table is not complete: what is missing was not finished." }
        }
        p { strong { (table.summary()) "." } }
        .figures { @for figure in figures { (html::figure(figure, "")) } }
        h2 { "Overview" }
        (overview(table))
        h2 { "Claims" }
        (rule())
        @for claim in &table.claims { (section(claim)) }
        (html::made_again(&table.command, table.seed, report))
    };
    html::page(TITLE, &lead, &body)
}

/// A line for each claim, with how its rows ended.
fn overview(table: &Table) -> Markup {
    html! { .table { table {
        thead { tr { th { "" } th { "Claim" } th { "Source" } th { "Rows" } } }
        tbody { @for claim in &table.claims { tr {
            td.whole { a href={ "#" (claim.id) } { (claim.id) } }
            td { (signs(claim.statement)) }
            td { (claim.source) }
            (ending(&claim.findings))
        } } }
    } } }
}

/// How many rows hold of those that have a verdict.
fn ending(findings: &[Finding]) -> Markup {
    let count = |verdict| findings.iter().filter(|f| f.verdict() == verdict).count();
    let (holds, fails) = (count(Verdict::Holds), count(Verdict::Fails));
    let (class, words) = match (holds, fails) {
        (0, 0) => ("open", "no verdict".to_owned()),
        (_, 0) => ("holds", format!("{holds} hold")),
        _ => ("fails", format!("{fails} of {} fail", holds + fails)),
    };
    html! { td class={ "whole " (class) } { (words) } }
}

fn rule() -> Markup {
    html! {
        p {
            "A row holds where the measured number is within " (BOUND) " standard errors of the "
            "expected one, plus the allowance printed with it, and where every comparison behind "
            "it holds at a bound that they share. A true row is beyond that once in 2,150 times, so "
            "that one seed in ten shows a false failure somewhere. An allowance says how far a "
            "limit for large N may be from the truth at the N tried; where exact variances exist "
            "it is their own distance, and measured variances are held against them at each N."
        }
    }
}

fn section(claim: &Measured) -> Markup {
    html! {
        h3 id=(claim.id) { (claim.id) ". " (signs(claim.statement)) }
        p.source { (claim.source) " (" (standing(claim.standing)) ")" }
        .table { table {
            thead { tr {
                th { "Case" } th { "Quantity" } th { "Expected" } th { "Measured" } th { "Verdict" }
            } }
            tbody { @for finding in &claim.findings { (row(finding)) } }
        } }
    }
}

fn row(finding: &Finding) -> Markup {
    let verdict = finding.verdict();
    let class = match verdict {
        Verdict::Holds => "holds",
        Verdict::Fails => "fails",
        Verdict::Recalled | Verdict::NotMeasured => "open",
    };
    html! { tr {
        td { (signs(&finding.case))
            @if !finding.note.is_empty() { p.note { (signs(&finding.note)) } }
            @if !finding.checks.is_empty() {
                details { summary { (finding.checks.len()) " comparisons" }
                    @for check in &finding.checks {
                        div { (signs(&check.at)) ": " (signs(&ratio(check.ratio, check.std_error))) }
                    }
                }
            }
        }
        td { (signs(finding.quantity)) }
        td { (signs(&expected(finding))) }
        td.whole { (signs(&measured(finding))) }
        td class={ "whole " (class) } {
            (verdict)
            @if verdict == Verdict::Fails { p.note { (signs(&reason(finding))) } }
        }
    } }
}

fn ratio(value: f64, error: f64) -> String {
    if error == 0.0 { plain(value) } else { with_error(value, error) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(expected: f64) -> Table {
        let mut table = Table::new("stratcli reproduce --literature".to_owned(), 1, Effort::Quick);
        table.add(Measured {
            id: "M3",
            statement: "edges, \"jittered\": p = 3/2",
            source: "Mitchell 1996",
            standing: Standing::Sure,
            findings: vec![
                Finding::new("disk, N = 1 to 9", "p", expected).measured(1.501, 0.002),
                Finding::not_measured("CCVT", "not on the shelf"),
            ],
            figures: Vec::new(),
        });
        table
    }

    #[test]
    fn a_planted_wrong_expectation_is_shown_as_failing() {
        let right = table(1.5);
        assert_eq!(right.tally, Tally { holds: 1, not_measured: 1, ..Tally::default() });
        let wrong = table(2.0);
        assert_eq!(wrong.tally, Tally { fails: 1, not_measured: 1, ..Tally::default() });
        assert!(text(&wrong).contains("M3 fails: disk, N = 1 to 9; 249.5 standard errors"));
        let page = render(&wrong, &[], false);
        assert!(page.contains(r#"class="whole fails""#) && page.contains("1 of 1 fail"), "{page}");
        assert!(!render(&right, &[], false).contains(r#"class="whole fails""#));
        assert!(csv(&wrong).contains(",2,0,1.501,0.002,") && csv(&wrong).contains(",fails,"));
    }

    #[test]
    fn csv_fields_keep_their_commas_and_quotes() {
        assert!(
            csv(&table(1.5)).contains("M3,\"edges, \"\"jittered\"\": p = 3/2\",Mitchell 1996,")
        );
        assert_eq!(csv(&table(1.5)).lines().count(), 3);
    }
}
