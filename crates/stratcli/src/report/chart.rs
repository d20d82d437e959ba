//! Convergence: variance of the mean against N, both on log axes.

use super::axis::{self, Axis, INK, MUTED, SMALL, centred, plain};
use super::svg::{Marker, Rect, Stroke, Svg};
use stratcore::StudyResult;
use stratcore::sampler::{SHELF, Scramble};
use stratcore::study::{Method, SamplerResult};
use stratcore::theory::Class;

/// Colour, marker and dash that stand for one sampler in every figure. The colours are those of
/// Okabe & Ito (*Color Universal Design*, 2008) but for yellow, which paper swallows; marker
/// and dash tell them apart in grey.
#[derive(Debug, Clone, Copy)]
pub struct Style {
    /// Colour, `#rrggbb`.
    pub colour: &'static str,
    /// Shape of data points.
    pub marker: Marker,
    /// Dash pattern of the fitted line.
    pub dash: &'static str,
}

impl Style {
    /// The style of a sampler, by its place on the shelf.
    pub fn of_sampler(name: &str) -> Self {
        Self::nth(SHELF.iter().position(|s| s.name() == name).unwrap_or(SHELF.len()))
    }

    /// One of 140 styles. No two of the first seven share a colour.
    pub fn nth(i: usize) -> Self {
        const COLOURS: [&str; 7] =
            ["#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"];
        const MARKERS: [Marker; 5] =
            [Marker::Circle, Marker::Square, Marker::Triangle, Marker::Diamond, Marker::Cross];
        const DASHES: [&str; 4] = ["7 4", "", "2 3", "9 3 2 3"];
        Self {
            colour: COLOURS[i % COLOURS.len()],
            marker: MARKERS[i % MARKERS.len()],
            dash: DASHES[i % DASHES.len()],
        }
    }

    /// The stroke of a fitted line.
    pub fn stroke(self, width: f64) -> Stroke {
        Stroke { colour: self.colour, width, dash: self.dash }
    }
}

/// Styles of samplers in one figure: their own, unless two of them would share a colour, or
/// marker and dash, which are all that grey leaves.
pub fn styles(names: &[&str]) -> Vec<Style> {
    let own: Vec<_> = names.iter().map(|name| Style::of_sampler(name)).collect();
    let alike =
        |a: &Style, b: &Style| a.colour == b.colour || (a.marker == b.marker && a.dash == b.dash);
    let shared = |i: usize| own[..i].iter().any(|other| alike(other, &own[i]));
    match (0..own.len()).any(shared) {
        true => (0..own.len()).map(Style::nth).collect(),
        false => own,
    }
}

/// A sampler with its scramble, if it has one: `sobol (owen)`.
pub fn label(sampler: &str, scramble: Scramble) -> String {
    match scramble {
        Scramble::None => sampler.to_owned(),
        _ => format!("{sampler} ({scramble})"),
    }
}

/// What the legend says of one sampler: `jittered p = 1.49 ± 0.03`, with one standard error.
pub fn legend(sampler: &SamplerResult) -> String {
    let mut text = label(sampler.name, sampler.scramble);
    if sampler.exact {
        return text + " exact: variance 0 at every N";
    }
    match &sampler.fit {
        Some(fit) => {
            text += &match sampler.method {
                Method::Exact => format!(" p = {:.4}, exact", fit.exponent),
                Method::Trials => format!(" p = {:.2} ± {:.2}", fit.exponent, fit.std_error),
            };
            let zeros = sampler.rows.len() - fit.points;
            if zeros > 0 {
                text += &format!(", exact at {zeros} of {} N", sampler.rows.len());
            }
            text
        }
        None => text + " has too few variances above 0 for a fit",
    }
}

/// The chart of one study, every sampler of it.
pub fn convergence(title: &str, result: &StudyResult) -> Svg {
    const LEGEND_ROW: f64 = 19.0;
    let legend_height = LEGEND_ROW * result.samplers.len() as f64;
    let (width, plot) = (540.0, Rect { x: 78.0, y: 52.0 + legend_height, w: 412.0, h: 320.0 });
    let mut svg = Svg::new(width, plot.y + plot.h + 56.0, title);
    svg.text([plot.x - 50.0, 30.0], plain(16.0, INK), title);
    for (i, (sampler, style)) in result.samplers.iter().zip(styles_of(result)).enumerate() {
        let y = 54.0 + LEGEND_ROW * i as f64;
        svg.line([plot.x - 50.0, y], [plot.x - 16.0, y], style.stroke(1.6));
        svg.marker([plot.x - 33.0, y], style.marker, style.colour);
        svg.text([plot.x - 6.0, y + 4.5], plain(13.0, INK), &legend(sampler));
    }
    convergence_into(&mut svg, plot, result);
    svg
}

/// Draws the same into an area of a larger drawing, without title and legend.
pub fn convergence_into(svg: &mut Svg, area: Rect, result: &StudyResult) {
    let rows = || result.samplers.iter().flat_map(|s| &s.rows);
    let measured = || rows().filter(|row| row.variance_of_mean > 0.0);
    if measured().next().is_none() {
        let middle = [area.x + area.w / 2.0, area.y + area.h / 2.0];
        svg.outline(area, Stroke::solid(axis::GRID, 1.0));
        svg.text(middle, centred(13.0, MUTED), "every estimate is the same number");
        return;
    }
    let n_range = bounds(rows().map(|row| row.n_used as f64)).map(f64::log10);
    let s_range = bounds(measured().flat_map(|row| row.ci95())).map(f64::log10);
    let (n_range, s_range) = (widen(n_range, 0.06), widen(s_range, 0.04));
    let x = Axis::log(n_range, [area.x, area.x + area.w]);
    let y = Axis::log(s_range, [area.y + area.h, area.y]);
    axis::draw(svg, area, &x, &y, ["samples in one estimate, N", "variance of the mean"]);
    reference_slopes(svg, result, &x, &y, s_range[0]);
    for (sampler, style) in result.samplers.iter().zip(styles_of(result)) {
        curve(svg, sampler, style, &x, &y);
    }
}

fn styles_of(result: &StudyResult) -> Vec<Style> {
    styles(&result.samplers.iter().map(|sampler| sampler.name).collect::<Vec<_>>())
}

/// Least and largest of values above zero.
pub(super) fn bounds(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, 0.0], |[lo, hi], v| [lo.min(v), hi.max(v)])
}

/// Powers of ten of a range with a margin: a share of its length, or of half a decade.
pub(super) fn widen([lo, hi]: [f64; 2], share: f64) -> [f64; 2] {
    let margin = share * (hi - lo).max(0.5);
    [lo - margin, hi + margin].map(|v| 10f64.powf(v))
}

/// The slopes of complex, edge and smooth integrands in this dimension, dashed, through the
/// first fitted point of the last sampler that has a fit.
fn reference_slopes(svg: &mut Svg, result: &StudyResult, x: &Axis, y: &Axis, floor: f64) {
    let Some((fit, rows)) =
        result.samplers.iter().rev().find_map(|s| Some((s.fit.as_ref()?, &s.rows)))
    else {
        return;
    };
    let Some(first) = rows.iter().find(|r| r.n_used == fit.n_min && r.variance_of_mean > 0.0)
    else {
        return;
    };
    let dashed = Stroke { colour: "#8a8a8a", width: 0.9, dash: "4 4" };
    let (n0, s0) = (first.n_used as f64, first.variance_of_mean);
    for class in [Class::Complex, Class::Edge, Class::Smooth] {
        let Some(p) = class.predicted_exponent(result.dim) else { continue };
        let n_floor = n0 * (s0 / floor).powf(1.0 / p);
        let end = (fit.n_max as f64).min(n_floor);
        let to = [x.at(end), y.at(s0 * (end / n0).powf(-p))];
        svg.line([x.at(n0), y.at(s0)], to, dashed);
        let label = format!("\u{2212}{}", fraction(class, result.dim));
        let beside =
            if end < n_floor { [to[0] + 7.0, to[1] + 4.0] } else { [to[0] + 5.0, to[1] - 6.0] };
        svg.text(beside, plain(SMALL, MUTED), &label);
    }
}

/// The predicted exponent of a class in `dim` dimensions as a fraction in lowest terms.
pub fn fraction(class: Class, dim: usize) -> String {
    let (mut top, mut bottom) = match class {
        Class::Smooth => (dim + 2, dim),
        Class::Edge => (dim + 1, dim),
        Class::Complex | Class::Exact => (1, 1),
    };
    if top % 2 == 0 && bottom % 2 == 0 {
        (top, bottom) = (top / 2, bottom / 2);
    }
    if top % bottom == 0 { format!("{}", top / bottom) } else { format!("{top}/{bottom}") }
}

fn curve(svg: &mut Svg, sampler: &SamplerResult, style: Style, x: &Axis, y: &Axis) {
    const CAP: f64 = 2.5;
    let thin = Stroke::solid(style.colour, 0.9);
    if let Some((fit, two)) = sampler.fit.zip(sampler.two_terms) {
        const STEPS: u32 = 48;
        let (from, to) = ((fit.n_min as f64).ln(), (fit.n_max as f64).ln());
        let points: Vec<_> = (0..=STEPS)
            .map(|i| (from + (to - from) * f64::from(i) / f64::from(STEPS)).exp())
            .map(|n| [x.at(n), y.at(two.variance_at(n))])
            .collect();
        svg.path(&points, style.stroke(1.5));
    } else if let Some(fit) = &sampler.fit {
        let end = |n: u64| [x.at(n as f64), y.at(fit.variance_at(n as f64))];
        svg.line(end(fit.n_min), end(fit.n_max), style.stroke(1.5));
    }
    for row in sampler.rows.iter().filter(|row| row.variance_of_mean > 0.0) {
        let at = x.at(row.n_used as f64);
        let [low, high] = row.ci95().map(|v| y.at(v));
        svg.line([at, low], [at, high], thin);
        for end in [low, high] {
            svg.line([at - CAP, end], [at + CAP, end], thin);
        }
    }
    for row in sampler.rows.iter().filter(|row| row.variance_of_mean > 0.0) {
        let at = [x.at(row.n_used as f64), y.at(row.variance_of_mean)];
        svg.marker(at, style.marker, style.colour);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stratcore::integrand::Integrand;
    use stratcore::study::{Control, StudyPlan, study};

    struct Step(f64);
    impl Integrand for Step {
        fn dim(&self) -> usize {
            2
        }
        fn eval(&self, x: &[f64]) -> f64 {
            f64::from(x[0] < self.0)
        }
    }

    fn drawn(edge: f64) -> String {
        let plan = StudyPlan::paper();
        let result = study(&Step(edge), [0, 0], &plan, Control::unwatched()).unwrap();
        convergence("a step", &result).to_svg()
    }

    #[test]
    fn the_chart_shows_every_row_the_slopes_and_the_legend() {
        let svg = drawn(0.3);
        assert_eq!(svg.matches("<circle").count(), 17); // 16 rows of random and the legend
        for label in [">\u{2212}1<", ">\u{2212}3/2<", ">\u{2212}2<", "jittered p = 1.", " ± 0.0"] {
            assert!(svg.contains(label), "{label} is not in {svg}");
        }
    }

    #[test]
    fn zero_variances_are_told_and_not_drawn() {
        assert!(drawn(0.5).contains("exact at 8 of 16 N"));
        let flat = drawn(2.0);
        assert!(flat.contains("every estimate is the same number"), "{flat}");
        assert!(!flat.contains("NaN") && !flat.contains("inf"));
    }

    #[test]
    fn slopes_are_written_as_fractions() {
        let words = |dim| [Class::Complex, Class::Edge, Class::Smooth].map(|c| fraction(c, dim));
        assert_eq!(words(1), ["1", "2", "3"]);
        assert_eq!(words(2), ["1", "3/2", "2"]);
        assert_eq!(words(4), ["1", "5/4", "3/2"]);
    }

    #[test]
    fn two_samplers_of_one_colour_take_other_styles() {
        let colours = |names: &[&str]| styles(names).iter().map(|s| s.colour).collect::<Vec<_>>();
        let own = |name| Style::of_sampler(name).colour;
        assert_eq!(colours(&["jittered", "random"]), [own("jittered"), own("random")]);
        for names in [["random", "poisson"], ["sobol", "sobol"]] {
            let found = colours(&names);
            assert_ne!(found[0], found[1], "{names:?}");
        }
        // Twenty places apart on the shelf: other colours, but one marker and one dash.
        for far in SHELF.iter().skip(20) {
            let i = SHELF.iter().position(|s| s.name() == far.name()).unwrap();
            let found = styles(&[SHELF[i - 20].name(), far.name()]);
            assert!(found[0].marker != found[1].marker, "{}", far.name());
        }
    }

    #[test]
    fn styles_differ_by_more_than_colour() {
        let key = |i| {
            let s = Style::nth(i);
            (format!("{:?}", s.marker), s.dash)
        };
        for i in 0..20 {
            assert!((0..i).all(|j| key(i) != key(j)), "{i}");
        }
    }
}
