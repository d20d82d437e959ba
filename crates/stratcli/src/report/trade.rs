//! Error against time: the chart of a trade, and its page.

pub mod csv;
pub mod words;

use super::axis::{self, Axis, INK, MUTED, SMALL, plain};
use super::chart::{Style, label, styles};
use super::html;
use super::page;
use super::svg::{Rect, Stroke, Svg, Type};
use maud::{PreEscaped, html};
use stratcore::trade::{SamplerTrade, Target, TradeResult, TradeRow};

/// The page's file.
pub const PAGE: &str = "trade.html";

/// What the page is called.
pub const TITLE: &str = "Error against time";

/// RMS error against the time of one estimate, both on log axes; the Pareto front as a grey
/// band behind the curves, targets as dashed lines.
pub fn chart(title: &str, result: &TradeResult) -> Svg {
    const LEGEND_ROW: f64 = 19.0;
    let legend_height = LEGEND_ROW * result.samplers.len() as f64;
    let plot = Rect { x: 78.0, y: 52.0 + legend_height, w: 452.0, h: 330.0 };
    let mut svg = Svg::new(580.0, plot.y + plot.h + 56.0, title);
    svg.text([28.0, 30.0], plain(16.0, INK), title);
    let styles = styles(&result.samplers.iter().map(|sampler| sampler.name).collect::<Vec<_>>());
    for (i, (sampler, style)) in result.samplers.iter().zip(&styles).enumerate() {
        let y = 54.0 + LEGEND_ROW * i as f64;
        svg.line([28.0, y], [62.0, y], style.stroke(1.6));
        svg.marker([45.0, y], style.marker, style.colour);
        svg.text([72.0, y + 4.5], plain(13.0, INK), &label(sampler.name, sampler.scramble));
    }
    let shown: Vec<_> =
        result.samplers.iter().flat_map(|s| &s.rows).filter(|row| row.error.rmse > 0.0).collect();
    let targets: Vec<_> = result.choices.iter().map(|choice| choice.error).collect();
    let quartiles = |row: &&TradeRow| [row.ns_per_estimate.lower, row.ns_per_estimate.upper];
    let times = bounds(shown.iter().flat_map(quartiles));
    let errors = bounds(shown.iter().map(|row| row.error.rmse).chain(targets.iter().copied()));
    let (Some(times), Some(errors)) = (times, errors) else {
        svg.text([plot.x, plot.y + 40.0], plain(13.0, MUTED), "every estimate is exact");
        return svg;
    };
    let x = Axis::log(times, [plot.x, plot.x + plot.w]);
    let y = Axis::log(errors, [plot.y + plot.h, plot.y]);
    axis::draw(&mut svg, plot, &x, &y, ["time of one estimate, ns", "RMS error"]);
    front(&mut svg, &shown, &x, &y);
    for choice in &result.choices {
        let at = y.at(choice.error);
        svg.line(
            [plot.x, at],
            [plot.x + plot.w, at],
            Stroke { colour: "#8a8a8a", width: 0.9, dash: "4 4" },
        );
        let label = match choice.target {
            Target::Relative(share) => format!("{} %", crate::table::short(100.0 * share, 4)),
            Target::Absolute(error) => crate::table::short(error, 4),
        };
        let end = Type { anchor: "end", ..plain(SMALL, MUTED) };
        svg.text([plot.x + plot.w - 4.0, at - 5.0], end, &label);
    }
    for (sampler, style) in result.samplers.iter().zip(styles) {
        curve(&mut svg, sampler, style, &x, &y);
    }
    svg
}

/// The range with a margin; none for no value.
fn bounds(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let [lo, hi] =
        values.fold([f64::INFINITY, 0.0f64], |[lo, hi], value| [lo.min(value), hi.max(value)]);
    (lo <= hi).then_some([lo / 1.6, hi * 1.6])
}

/// Steps through the rows that no other row beats.
fn front(svg: &mut Svg, shown: &[&TradeRow], x: &Axis, y: &Axis) {
    let mut best: Vec<_> = shown.iter().filter(|row| row.pareto).collect();
    best.sort_by(|a, b| a.ns_per_estimate.median.total_cmp(&b.ns_per_estimate.median));
    let mut points: Vec<[f64; 2]> = Vec::new();
    for row in best {
        let at = [x.at(row.ns_per_estimate.median), y.at(row.error.rmse)];
        if let Some(last) = points.last().copied() {
            points.push([at[0], last[1]]);
        }
        points.push(at);
    }
    svg.path(&points, Stroke::solid("#d5d5d5", 5.0));
}

fn curve(svg: &mut Svg, sampler: &SamplerTrade, style: Style, x: &Axis, y: &Axis) {
    let rows: Vec<_> = sampler.rows.iter().filter(|row| row.error.rmse > 0.0).collect();
    let place = |row: &TradeRow| [x.at(row.ns_per_estimate.median), y.at(row.error.rmse)];
    let line: Vec<_> = rows.iter().map(|row| place(row)).collect();
    if line.len() > 1 {
        svg.path(&line, style.stroke(1.3));
    }
    for row in &rows {
        let at = place(row);
        let thin = Stroke::solid(style.colour, 0.9);
        let ends = row.error.mse_ci95.map(f64::sqrt);
        if ends.iter().all(|e| e.is_finite() && *e > 0.0) {
            svg.line([at[0], y.at(ends[0])], [at[0], y.at(ends[1])], thin);
        }
        let time = row.ns_per_estimate;
        svg.line([x.at(time.lower), at[1]], [x.at(time.upper), at[1]], thin);
    }
    for row in &rows {
        svg.marker(place(row), style.marker, style.colour);
    }
}

/// A page that carries everything: the sentences, the chart, the tables; `report` if the paper's
/// page lies beside it.
pub fn render(
    title: &str,
    chart: &Svg,
    sentences: &[String],
    method: &str,
    tables: &[(String, Vec<Vec<String>>)],
    report: bool,
) -> String {
    let lead = html! {
        "What each sampler's error costs in time, and which of them is the cheapest for a wanted \
         error."
    };
    let body = html! {
        @for sentence in sentences { p { (sentence) } }
        .figures { figure class="wide narrow" {
            (PreEscaped(chart.to_inline()))
            figcaption {
                "RMS error of one estimate against its time. Bars are the 95 % interval of \
                 the error and the quartiles of the time; the grey band is the Pareto \
                 front, and dashed lines are the targets. A target is reached where 95 of \
                 100 runs are off by no more: for one pixel at half this RMS error."
            }
        } }
        @for (title, rows) in tables {
            h2 { (title) }
            .table { table {
                @for row in rows.iter().take(1) {
                    thead { tr { @for cell in row { th { (cell) } } } }
                }
                tbody { @for row in rows.iter().skip(1) {
                    tr { @for cell in row { td.number { (cell) } } }
                } }
            } }
        }
        h2 { "Method" }
        p { (method) }
        @if report {
            p { "Beside this page: " a href=(page::NAME) { "the paper's own figures" } "." }
        }
    };
    html::page(&format!("{TITLE}: {title}"), &lead, &body)
}
