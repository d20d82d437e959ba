//! A point set as it lies in the square.

use super::axis::{INK, MUTED, SMALL, centred, plain};
use super::svg::{Rect, Stroke, Svg, Type};

/// Two coordinates of a set, with the strata along them where there are any. The first of `axes`
/// runs to the right, the second upwards.
pub fn draw(
    title: &str,
    points: &[f64],
    dim: usize,
    axes: [usize; 2],
    strata: Option<&[u64]>,
) -> Svg {
    /// More lines than this are a grey area.
    const MOST_LINES: u64 = 128;
    let area = Rect { x: 56.0, y: 50.0, w: 480.0, h: 480.0 };
    let mut svg = Svg::new(area.x + area.w + 28.0, area.y + area.h + 56.0, title);
    svg.text([28.0, 30.0], plain(16.0, INK), title);
    let at = |x: f64, y: f64| [area.x + x * area.w, area.y + (1.0 - y) * area.h];
    let along = |axis: usize| strata.and_then(|strata| strata.get(axes[axis])).copied();
    let faint = Stroke::solid("#d5d5d5", 0.7);
    for k in [along(0), along(1)].into_iter().enumerate() {
        let (axis, Some(k)) = k else { continue };
        if k > MOST_LINES {
            continue;
        }
        for i in 1..k {
            let t = i as f64 / k as f64;
            match axis {
                0 => svg.line(at(t, 0.0), at(t, 1.0), faint),
                _ => svg.line(at(0.0, t), at(1.0, t), faint),
            }
        }
    }
    svg.outline(area, Stroke::solid(INK, 1.0));
    // Half of the mean distance between points, within what the eye can tell apart.
    let n = (points.len() / dim).max(1) as f64;
    let radius = (0.16 * area.w / n.sqrt()).clamp(0.8, 4.0);
    for point in points.chunks_exact(dim) {
        svg.disc(at(point[axes[0]], point[axes[1]]), radius, "#0072b2");
    }
    let set = Type { anchor: "end", ..plain(SMALL, INK) };
    for (t, words) in [(0.0, "0"), (0.5, "0.5"), (1.0, "1")] {
        let [x, y] = at(t, 0.0);
        svg.text([x, y + 17.0], centred(SMALL, INK), words);
        let [x, y] = at(0.0, t);
        svg.text([x - 7.0, y + 4.0], set, words);
    }
    let below = [area.x + area.w / 2.0, area.y + area.h + 40.0];
    svg.text(below, centred(SMALL + 0.5, MUTED), &format!("axis {}", axes[0]));
    let upwards = Type { upwards: true, ..centred(SMALL + 0.5, MUTED) };
    svg.text([area.x - 36.0, area.y + area.h / 2.0], upwards, &format!("axis {}", axes[1]));
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_is_a_dot_and_every_stratum_has_its_border() {
        let points = [0.1, 0.2, 0.3, 0.6, 0.7, 0.8, 0.9, 0.4, 0.0];
        let svg = draw("t", &points, 3, [2, 0], Some(&[4, 9, 3])).to_svg();
        assert_eq!(svg.matches("<circle").count(), 3);
        assert_eq!(svg.matches("#d5d5d5").count(), 2 + 3);
        // Third coordinate to the right, first upwards.
        assert!(svg.contains(r#"cx="200.00" cy="482.00""#), "{svg}");
        let many = draw("t", &points, 3, [0, 1], Some(&[1000, 1000, 1000])).to_svg();
        assert!(!many.contains("#d5d5d5"));
    }
}
