//! The table of numerical extremes as text, as CSV, and as one HTML page that says what
//! precision can be trusted and why.

use super::html;
use super::page::{Figure, signs};
use crate::output::csv_line;
use crate::table::{Align, columns, number};
use maud::{Markup, PreEscaped, html};
use serde::Serialize;
use stratcore::literature::Effort;
use stratcore::stability::{Measured, Row, Verdict};

/// The page's file.
pub const PAGE: &str = "stability.html";

/// The table and how it was made.
#[derive(Debug, Clone, Serialize)]
pub struct Table {
    /// The command that makes this again.
    pub command: String,
    /// Whether every family that was asked for is there.
    pub complete: bool,
    /// Seed of all randomness.
    pub seed: u64,
    /// How much was spent.
    pub effort: Effort,
    /// Every row, family by family.
    pub rows: Vec<TableRow>,
    /// What the page says of each family.
    #[serde(skip)]
    families: Vec<Measured>,
}

/// A row with its family's name.
#[derive(Debug, Clone, Serialize)]
pub struct TableRow {
    family: &'static str,
    #[serde(flatten)]
    row: Row,
}

impl Table {
    /// An empty table.
    pub fn new(command: String, seed: u64, effort: Effort) -> Self {
        Self { command, complete: false, seed, effort, rows: Vec::new(), families: Vec::new() }
    }

    /// Adds a family.
    pub fn add(&mut self, measured: Measured) {
        let family = measured.name;
        self.rows.extend(measured.rows.iter().map(|row| TableRow { family, row: row.clone() }));
        self.families.push(measured);
    }

    /// Rows that fail.
    pub fn fails(&self) -> usize {
        self.rows.iter().filter(|row| row.row.verdict() == Verdict::Fail).count()
    }

    fn summary(&self) -> String {
        let fails = self.fails();
        format!("{} rows: {} pass, {fails} fail", self.rows.len(), self.rows.len() - fails)
    }
}

/// An error to two digits; a dash for what has no part in the row.
fn error(value: Option<f64>) -> String {
    match value {
        None => "–".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(x) if x.is_finite() => number(x, 2),
        Some(x) if x.is_nan() => "not a number".to_owned(),
        Some(_) => "infinite".to_owned(),
    }
}

/// The table as text: a line for each row, then what failed.
pub fn text(table: &Table) -> String {
    let head = ["", "quantity", "f32", "f64", "error", "limit", "floor", "verdict"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for TableRow { row, .. } in &table.rows {
        let numbers = [row.f32, row.f64, Some(row.error), Some(row.limit), row.floor].map(error);
        let words = [row.name.to_owned(), row.quantity.to_owned()];
        let verdict = [row.verdict().to_string()];
        rows.push(words.into_iter().chain(numbers).chain(verdict).collect());
    }
    let mut text = columns(Align::Left, &rows) + "\n";
    for TableRow { family, row } in
        table.rows.iter().filter(|row| row.row.verdict() == Verdict::Fail)
    {
        text += &format!("{family}, {} fails: {}; {}\n", row.name, row.tried, row.note);
    }
    text + &table.summary() + "\n"
}

/// The table as CSV: one header, a line for each row, numbers in full.
pub fn csv(table: &Table) -> String {
    let mut text = "family,name,tried,quantity,f32,f64,error,limit,floor,verdict,note\n".to_owned();
    let optional = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
    for TableRow { family, row } in &table.rows {
        text += &csv_line(&[
            (*family).to_owned(),
            row.name.to_owned(),
            row.tried.clone(),
            row.quantity.to_owned(),
            optional(row.f32),
            optional(row.f64),
            row.error.to_string(),
            row.limit.to_string(),
            optional(row.floor),
            row.verdict().to_string(),
            row.note.clone(),
        ]);
    }
    text
}

/// The whole page.
pub fn render(table: &Table, figures: &[Figure]) -> String {
    const TITLE: &str = "What precision can be trusted";
    let lead = html! {
        "Numerical extremes, each tried: what f32 and f64 do there, how far this program is from \
         a reference of higher precision, and the floor below which a number means nothing."
    };
    let body = html! {
        @if !table.complete {
            p.warning { "This table is not complete: what is missing was not finished." }
        }
        p { strong { (table.summary()) "." } }
        (overview(table))
        (reading())
        @for family in &table.families { (section(family, figures)) }
        (html::made_again(&table.command, table.seed, false))
    };
    html::page(TITLE, &lead, &body)
}

/// A line for each family: what may be relied on.
fn overview(table: &Table) -> Markup {
    html! { .table { table {
        thead { tr { th { "Extremes" } th { "What to rely on" } th { "Rows" } } }
        tbody { @for family in &table.families {
            @let fails = family.rows.iter().filter(|r| r.verdict() == Verdict::Fail).count();
            tr {
                td { a href={ "#" (family.name) } { (family.title) } }
                td { (powers(family.advice)) }
                @if fails == 0 {
                    td.whole.holds { (family.rows.len()) " pass" }
                } @else {
                    td.whole.fails { (fails) " of " (family.rows.len()) " fail" }
                }
            }
        } }
    } } }
}

/// Text with true minus signs, and with what follows a caret raised.
fn powers(text: &str) -> Markup {
    let text = signs(text);
    let mut parts = text.split('^');
    let is_raised = |c: char| c.is_ascii_alphanumeric() || c == '\u{2212}' || c == '-';
    html! {
        (parts.next().unwrap_or_default())
        @for part in parts {
            @let (raised, rest) = part.split_at(part.find(|c| !is_raised(c)).unwrap_or(part.len()));
            sup { (raised) } (rest)
        }
    }
}

fn reading() -> Markup {
    html! {
        h2 { "How to read a row" }
        p {
            "Every number of a row is of one quantity, an error. " em { "f32" } " is that of the \
             beam, where a pixel is traced, and of plain f32 arithmetic elsewhere; "
            em { "f64" } " that of rays, or of plain f64 arithmetic; " em { "error" } " that of \
             the way this program goes. It is measured against whole numbers, sums without \
             rounding, closed forms, or the same samples in double-double arithmetic (106 bits), \
             and has to stay within the limit, which follows from the arithmetic and is not \
             fitted to what was measured. " em { "floor" } " is the least that the format of the \
             result allows. A dash stands where an arithmetic has no part."
        }
    }
}

fn section(family: &Measured, figures: &[Figure]) -> Markup {
    let mine = |figure: &&Figure| family.figures.iter().any(|f| f.name == figure.name);
    let alone = family.figures.len() == 1;
    html! {
        h2 id=(family.name) { (family.title) }
        .table { table {
            thead { tr {
                th { "Tried" } th { "f32" } th { "f64" } th { "Error" } th { "Limit" }
                th { "Floor" } th { "Verdict" }
            } }
            tbody { @for row in &family.rows { (line(row)) } }
        } }
        .figures { @for figure in figures.iter().filter(mine) {
            figure.wide[alone].narrow[alone] id=(figure.name) {
                (PreEscaped(&figure.inline))
                figcaption { (powers(&figure.caption)) }
            }
        } }
    }
}

fn line(row: &Row) -> Markup {
    let class = if row.verdict() == Verdict::Pass { "holds" } else { "fails" };
    html! { tr {
        td {
            strong { (powers(row.name)) } ": " (powers(row.quantity)) ". " (powers(&row.tried)) "."
            @if !row.note.is_empty() { p.note { (powers(&row.note)) } }
        }
        @for value in [row.f32, row.f64, Some(row.error), Some(row.limit), row.floor] {
            td.number { (signs(&error(value))) }
        }
        td class={ "whole " (class) } { (row.verdict()) }
    } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stratcore::stability::FAMILIES;

    fn table(error: f64) -> Table {
        let row = Row {
            name: "sums",
            tried: "N = 4, \"five\"".to_owned(),
            quantity: "relative error",
            f32: Some(f64::INFINITY),
            f64: None,
            error,
            limit: 1e-16,
            floor: Some(1e-17),
            note: "as told".to_owned(),
        };
        let mut table = Table::new("stratcli stability".to_owned(), 7, Effort::Quick);
        let family = &FAMILIES[0];
        table.add(Measured {
            name: family.name,
            title: family.title,
            advice: family.advice,
            rows: vec![row],
            figures: Vec::new(),
        });
        table
    }

    #[test]
    fn a_row_beyond_its_limit_is_shown_as_failing() {
        let (good, bad) = (table(0.0), table(2e-16));
        assert_eq!((good.fails(), bad.fails()), (0, 1));
        assert!(text(&good).ends_with("1 rows: 1 pass, 0 fail\n"), "{}", text(&good));
        let words = text(&bad);
        assert!(words.contains("sums fails: N = 4, \"five\"; as told"), "{words}");
        assert!(words.contains("infinite") && words.contains("–"), "{words}");
        let page = render(&bad, &[]);
        assert!(page.contains(r#"class="whole fails""#) && page.contains("1 of 1 fail"));
        assert!(!render(&good, &[]).contains(r#"class="whole fails""#));
        assert_eq!(
            powers("2^-53 of N^d.").into_string(),
            "2<sup>\u{2212}53</sup> of N<sup>d</sup>."
        );
        let csv = csv(&bad);
        assert!(
            csv.contains(",\"N = 4, \"\"five\"\"\",") && csv.contains(",fail,as told"),
            "{csv}"
        );
    }
}
