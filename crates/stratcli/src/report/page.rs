//! The report as one HTML page that carries everything it shows.

use super::html;
use super::summary::{ClaimRow, Claims, FormFactor, FormFactorCase, Pixels, Protocol, Summary};
use crate::table::number;
use maud::{Markup, html};

/// A figure, ready for the page.
pub struct Figure {
    /// Its file's name without ending.
    pub name: &'static str,
    /// The words below it.
    pub caption: String,
    /// The drawing as an HTML element.
    pub inline: String,
}

/// The page's heading.
const TITLE: &str = "Stratified sampling, measured again";

/// The page's file.
pub const NAME: &str = "report.html";

/// A finished page with a link to another one in its folder, before the footer; as it is where
/// the link is there already.
pub fn with_link(page: &str, file: &str, title: &str) -> String {
    let link = html! { p { "Beside this page: " a href=(file) { (title) } "." } }.into_string();
    if page.contains(&link) {
        return page.to_owned();
    }
    page.replacen("<footer>", &(link + "<footer>"), 1)
}

/// The whole page.
pub fn render(summary: &Summary, figures: &[Figure]) -> String {
    let Summary { protocol, .. } = summary;
    let show = |name: &str, class: &str| -> Markup {
        html! {
            @for figure in figures.iter().filter(|f| f.name == name) {
                (html::figure(figure, class))
            }
        }
    };
    let lead = html! {
        "D. P. Mitchell, " em { "Consequences of Stratified Sampling in Graphics" }
        " (SIGGRAPH 1996), reproduced on the ray-traced scene " (protocol.scene)
        ": each of the paper's numbers beside ours, with its uncertainty."
    };
    let body = html! {
        @if !summary.complete {
            p.warning { "This report is not complete: what is missing was not finished." }
        }
        h2 { "Paper beside ours" }
        (verdicts(summary))
        h2 { "The picture" }
        .figures { (show("fig1-picture", "wide narrow")) }
        h2 { "How fast the pixels converge" }
        p {
            "Each pixel is estimated " (protocol.trials) " times from N samples, for N = "
            (span(&protocol.counts)) ". The variance of those means falls as N"
            sup { "−p" } "; p is the slope of a least-square line in log space."
        }
        .figures {
            (show("fig2-random", "")) (show("fig4-jittered", ""))
            (show("fig4-map", "wide"))
        }
        @if let Some(pixels) = &summary.pixels { (classes(pixels, protocol)) }
        h2 { "One pixel, and three kinds of pixel" }
        .figures { (show("fig3-one-pixel", "wide narrow")) (show("fig5-close-ups", "wide")) }
        h2 { "Four dimensions: a form factor" }
        .figures {
            (show("form-factor", "")) (show("form-factor-occluded", ""))
            (show("form-factor-sides", "wide narrow"))
        }
        @if let Some(form_factor) = &summary.form_factor { (four_dimensions(form_factor)) }
        h2 { "The closing claims" }
        .figures { (show("claims-gain", "wide narrow")) }
        @if let Some(found) = &summary.claims { (claims(found)) }
        h2 { "Method" }
        (method(summary))
    };
    html::page(TITLE, &lead, &body)
}

/// `1, 4, 9, …, 256`
fn span(counts: &[u64]) -> String {
    let words: Vec<_> = counts.iter().map(u64::to_string).collect();
    match words.as_slice() {
        [a, b, c, _, .., last] => format!("{a}, {b}, {c}, …, {last}"),
        few => few.join(", "),
    }
}

/// Negative numbers with a true minus.
pub fn signs(text: &str) -> String {
    let minus = |digit: char| (format!("-{digit}"), format!("\u{2212}{digit}"));
    ('0'..='9').map(minus).fold(text.to_owned(), |text, (from, to)| text.replace(&from, &to))
}

/// A table in its frame; columns after the first `words` hold numbers.
pub(super) fn table(
    words: usize,
    head: &[&str],
    rows: impl Iterator<Item = Vec<String>>,
) -> Markup {
    let class = |i: usize| if i < words { "" } else { "number" };
    html! { .table { table {
        thead { tr { @for (i, cell) in head.iter().enumerate() { th class=(class(i)) { (cell) } } } }
        tbody { @for row in rows { tr {
            @for (i, cell) in row.iter().enumerate() {
                td class=(class(i)) { (signs(cell)) }
            }
        } } }
    } } }
}

fn verdicts(summary: &Summary) -> Markup {
    html! { .table { table {
        thead { tr { th { "What" } th { "Paper" } th { "Ours" } th { "Verdict" } } }
        tbody { @for v in &summary.verdicts { tr {
            td { (v.what) } td.whole { (v.paper) } td { (signs(&v.ours)) }
            td class=(match v.holds { Some(true) => "holds", Some(false) => "fails", None => "open" }) {
                (signs(&v.verdict))
            }
        } } }
    } } }
}

fn classes(pixels: &Pixels, protocol: &Protocol) -> Markup {
    let rows = pixels.classes.iter().map(|share| {
        vec![
            share.class.to_string(),
            share.class.predicted_exponent(2).map_or("none".to_owned(), |p| p.to_string()),
            share.pixels.to_string(),
            format!("{:.1} %", 100.0 * share.share),
            share.clear.to_string(),
        ]
    });
    html! {
        h3 { "Kinds of pixel" }
        p {
            (pixels.studied) " of " (protocol.pixels) " pixels were studied. A pixel is of the "
            "class whose predicted p is nearest to its p under jittered sampling; clearly so "
            "when its whole 95 % interval is and its variances follow one line (χ² below its "
            "99th percentile). Exact are pixels of one colour, where "
            "every estimate is the same number and p does not exist. "
            (pixels.partly_exact) " more have zero variance at some N, because every trial "
            "missed a small feature or an edge lies along the strata: they have a class here, "
            "but no place in the histograms."
        }
        (table(1, &["class", "predicted p", "pixels", "share", "of them clearly"], rows))
        p {
            "The standard deviation of p under random sampling is "
            (format!("{:.4}", pixels.random.std_deviation)) ", or "
            (format!("{:.4}", pixels.random.robust_deviation)) " without its tails (interquartile "
            "range over 1.349): a small feature that most trials miss makes a few fits far "
            "worse than their own standard error says. Noise alone gives "
            (format!("{:.4}", protocol.noise_of_p)) " for normal trial means; the fits' own "
            "standard errors, which know the trials' kurtosis, are "
            (format!("{:.4}", pixels.random.typical_std_error)) " (root mean square)."
        }
    }
}

fn four_dimensions(found: &FormFactor) -> Markup {
    let optional =
        |v: Option<f64>, digits: usize| v.map_or("–".to_owned(), |v| format!("{v:.digits$}"));
    let row = |case: &FormFactorCase| {
        let mut cells = vec![case.occluder.map_or("none".to_owned(), |side| side.to_string())];
        cells.push(optional(case.predicted, 2));
        for i in [0, 1] {
            cells.push(optional(case.exact[i], 4));
            cells.push(match (case.mean[i], case.std_error[i]) {
                (Some(mean), Some(error)) => format!("{mean:.4} ± {error:.4}"),
                _ => "–".to_owned(),
            });
            cells.push(optional(case.scatter[i], 3));
            cells.push(optional(case.one_run[i], 3));
        }
        cells
    };
    let head = [
        "occluder",
        "theory",
        "exact, all N",
        "mean, all N",
        "scatter",
        "one run",
        "exact, N > 1",
        "mean, N > 1",
        "scatter",
        "one run",
    ];
    html! {
        p {
            "Parallel unit squares, two apart and aligned; N = " (span(&found.counts)) ", M = 50, "
            "the whole experiment repeated with " (found.repeats) " seeds. The paper made one run: "
            "its values should lie within the scatter of one of ours, not within the error of "
            "our mean. The exact column is what the closed-form variances fit to: no noise, and "
            "still not the asymptotic 3/2 and 5/4, because N is finite."
        }
        (table(1, &head, found.cases.iter().map(row)))
        p {
            "The form factor itself: " (format!("{:.8} ± {:.8}", found.estimate, found.std_error))
            " against the closed form " (found.analytic) ", z = " (format!("{:+.2}", found.z)) "."
        }
    }
}

fn claims(found: &Claims) -> Markup {
    let row = |name: String, row: &ClaimRow| {
        vec![
            name,
            row.compared.to_string(),
            format!("{:+.4} ± {:.4}", row.mean_ln_ratio, row.std_error),
            row.looks_worse.to_string(),
            format!("{:.0}", row.expected_false_alarms),
            format!("{:.0}", row.expected_from_n1),
            row.looks_better.to_string(),
        ]
    };
    let rows = found.rows.iter().map(|r| row(r.n.to_string(), r));
    let all = std::iter::once(row("N > 1".to_owned(), &found.beyond_one));
    let head = [
        "N",
        "pixels",
        "mean ln ratio",
        "looks worse",
        "by chance",
        "by chance, from N = 1",
        "looks better",
    ];
    let suspects = found.suspects.iter().map(|s| {
        let [low, high] = s.again_interval;
        vec![
            format!("{}, {}", s.pixel[0], s.pixel[1]),
            s.n.to_string(),
            format!("{} (z = {:.1})", number(s.ratio, 3), s.z),
            format!("{} ({} to {})", number(s.again_ratio, 3), number(low, 3), number(high, 3)),
        ]
    });
    html! {
        p {
            "Jittered is never worse than random, and at N = 1 both are the same. For each "
            "pixel and N the ratio of the two variances is held against its own standard error; "
            "jittered " em { "looks worse" } " where the ratio is above 1 at the one-sided level of "
            (100.0 * found.level) " %. As many would look worse by chance if both were equal "
            "everywhere and trial means normal. Trial means of small features are not normal: "
            "N = 1, where both samplers are the same method, shows how often chance does it here."
        }
        (table(1, &head, rows.chain(all)))
        @if !found.suspects.is_empty() {
            h3 { "The worst, measured again" }
            p {
                "Where jittered looked worst at N > 1, measured once more with another seed and "
                (found.suspects[0].again_trials) " trials. Ratio of variances jittered / random; in "
                "brackets three standard errors either side."
            }
            (table(1, &["pixel", "N", "first", "again"], suspects))
        }
        h3 { "Gain by class" }
        (table(1, &["class", "pixels", "N", "the paper's factor", "median gain", "quartiles"],
            found.gains.iter().flat_map(|gain| {
                let last = gain.n.len().checked_sub(1)?;
                let [low, median, high] = gain.quartiles[last];
                Some(vec![
                    gain.class.to_string(), gain.pixels.to_string(), gain.n[last].to_string(),
                    number(gain.paper[last], 3), number(median, 3),
                    format!("{} to {}", number(low, 3), number(high, 3)),
                ])
            })))
    }
}

fn method(summary: &Summary) -> Markup {
    let p = &summary.protocol;
    let which = match p.lattice {
        Some(side) => format!("a lattice of {side} × {side} pixels, {} in all,", p.pixels),
        None => format!("every one of its {} pixels", p.pixels),
    };
    html! {
        p {
            "Scene " (p.scene) ", " (p.triangles) " triangles, " (p.resolution[0]) " × "
            (p.resolution[1]) " pixels, box filter, Rec. 709 luminance of linear RGB; " (which)
            " studied under " (p.samplers.join(" and ")) " sampling. For each N = "
            (span(&p.counts)) " there are M = " (p.trials) " independent trials, each with a fresh "
            "point set: uniform independent points, or one in each cell of a √N × √N grid. The "
            "variance of the mean has divisor M − 1; its 95 % interval comes from the chi-square "
            "distribution with degrees of freedom that account for the trials' kurtosis."
        }
        p {
            "The fit is the paper's: an unweighted line through (log N, log variance) of every "
            "row. The standard error of p comes from the known noise of each row, not from the "
            "residuals: " (format!("{:.4}", p.noise_of_p)) " for M = " (p.trials) " normal trials at "
            "these N. It holds what noise does, not what curvature does: at finite N a pixel with "
            "an edge and a gradient has no single slope."
        }
        p {
            "Seed " (p.seed) ". The same seed gives the same numbers on any number of threads. "
            "This report is made again by"
        }
        p { code { (summary.command) } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_linked_once() {
        let once = with_link("<main><footer></footer></main>", "other.html", "Other");
        assert!(once.contains(r#"<a href="other.html">Other</a>"#) && once.contains("<footer>"));
        assert_eq!(with_link(&once, "other.html", "Other"), once);
    }

    #[test]
    fn counts_are_told_in_short() {
        assert_eq!(span(&[1, 4]), "1, 4");
        assert_eq!(span(&[1, 4, 9, 16, 25]), "1, 4, 9, …, 25");
    }
}
