//! The form factor's exponent against the side of the occluder.

use super::axis::{self, Axis, INK, MUTED, SMALL, plain};
use super::chart::Style;
use super::summary::{FormFactorCase, paper};
use super::svg::{Rect, Stroke, Svg};

/// Mean exponents, all N and without N = 1, each with its standard error and, thinner, the
/// scatter of one run; what the exact variances fit to; across, the paper's values and theory's.
pub fn draw(cases: &[FormFactorCase]) -> Svg {
    let (paper, predicted) = (paper::OCCLUDED, 1.25f64);
    let title = "Exponent against the side of the occluder";
    let area = Rect { x: 78.0, y: 92.0, w: 370.0, h: 270.0 };
    let mut svg = Svg::new(540.0, area.y + area.h + 56.0, title);
    svg.text([28.0, 30.0], plain(16.0, INK), title);
    let series = [(0, 2, "all N"), (1, 1, "without N = 1")];
    let sides = || cases.iter().filter(|case| case.occluder.is_some());
    let ends = sides().flat_map(|case| {
        [0, 1].into_iter().filter_map(|i| Some((case.mean[i]?, case.scatter[i]?)))
    });
    let [low, high] = ends
        .fold([predicted.min(paper[0]), predicted.max(paper[1])], |[a, b], (p, s)| {
            [a.min(p - s), b.max(p + s)]
        });
    let x = Axis::linear([0.0, 1.0], [area.x, area.x + area.w]);
    let y = Axis::linear([low - 0.02, high + 0.02], [area.y + area.h, area.y]);
    axis::draw(&mut svg, area, &x, &y, ["side of the occluder", "exponent p"]);
    let dotted = Stroke { colour: "#8a8a8a", width: 0.9, dash: "1.5 3" };
    svg.line([area.x, y.at(predicted)], [area.x + area.w, y.at(predicted)], dotted);
    let mut labels = vec![(predicted, format!("theory {predicted}"), None)];
    for (i, style, name) in series {
        let style = Style::nth(style);
        svg.line([area.x, y.at(paper[i])], [area.x + area.w, y.at(paper[i])], style.stroke(1.2));
        labels.push((paper[i], format!("paper {:.3}", paper[i]), Some(style)));
        let row = 54.0 + 19.0 * i as f64;
        svg.marker([36.0, row], style.marker, style.colour);
        let words = format!("{name}: mean; thin bar, scatter of one run; line, exact");
        svg.text([50.0, row + 4.5], plain(13.0, INK), &words);
        for case in sides() {
            let (Some(side), Some(mean), Some(error), Some(scatter)) =
                (case.occluder, case.mean[i], case.std_error[i], case.scatter[i])
            else {
                continue;
            };
            let at = x.at(side) + [-4.0, 4.0][i];
            let bar = |half: f64| [[at, y.at(mean - half)], [at, y.at(mean + half)]];
            let [from, to] = bar(scatter);
            svg.line(from, to, Stroke::solid(style.colour, 0.7));
            let [from, to] = bar(error);
            svg.line(from, to, Stroke::solid(style.colour, 3.0));
            svg.marker([at, y.at(mean)], style.marker, style.colour);
        }
        let exact = sides().filter_map(|case| Some([x.at(case.occluder?), y.at(case.exact[i]?)]));
        svg.path(&exact.collect::<Vec<_>>(), style.stroke(1.0));
    }
    // Labels in the right margin, moved down where they would touch.
    labels.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut below = f64::NEG_INFINITY;
    for (value, words, style) in labels {
        below = (y.at(value) + 4.0).max(below + 15.0);
        let at = area.x + area.w + 10.0;
        if let Some(Style { marker, colour, .. }) = style {
            svg.marker([at, below - 4.0], marker, colour);
        }
        svg.text([at + 8.0, below], plain(SMALL, MUTED), &words);
    }
    svg
}
