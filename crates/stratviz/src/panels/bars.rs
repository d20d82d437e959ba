//! Error bars of a curve, drawn as one item: a plot with hundreds of lines costs milliseconds.

use eframe::egui::{Color32, Shape, Stroke, Ui, Vec2, vec2};
use egui_plot::{PlotBounds, PlotGeometry, PlotItem, PlotItemBase, PlotPoint, PlotTransform};
use std::ops::RangeInclusive;

/// Half the width of a bar's caps, in points.
const CAP: f32 = 2.5;

/// Bars with caps.
pub struct Bars {
    base: PlotItemBase,
    colour: Color32,
    /// The two ends of each, in the plot's coordinates.
    ends: Vec<[[f64; 2]; 2]>,
}

impl Bars {
    /// Upright bars, each an x and the two ends of y; ends that are not finite are left out.
    pub fn upright(name: &str, colour: Color32, bars: impl Iterator<Item = [f64; 3]>) -> Self {
        let ends = bars.map(|[x, low, high]| [[x, low], [x, high]]);
        let is_finite = |ends: &[[f64; 2]; 2]| ends.as_flattened().iter().all(|v| v.is_finite());
        let ends = ends.filter(is_finite).collect();
        Self { base: PlotItemBase::new(name.to_owned()), colour, ends }
    }
}

impl PlotItem for Bars {
    fn shapes(&self, _ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let stroke = Stroke::new(1.0, self.colour);
        let cap: Vec2 = vec2(CAP, 0.0);
        for ends in &self.ends {
            let [a, b] = ends.map(|[x, y]| transform.position_from_point(&PlotPoint::new(x, y)));
            for line in [[a, b], [a - cap, a + cap], [b - cap, b + cap]] {
                shapes.push(Shape::line_segment(line, stroke));
            }
        }
    }

    fn initialize(&mut self, _x_range: RangeInclusive<f64>) {}

    fn color(&self) -> Color32 {
        self.colour
    }

    fn allow_hover(&self) -> bool {
        false
    }

    fn geometry(&self) -> PlotGeometry<'_> {
        PlotGeometry::None
    }

    fn bounds(&self) -> PlotBounds {
        let mut bounds = PlotBounds::NOTHING;
        for [x, y] in self.ends.as_flattened() {
            bounds.extend_with(&PlotPoint::new(*x, *y));
        }
        bounds
    }

    fn base(&self) -> &PlotItemBase {
        &self.base
    }

    fn base_mut(&mut self) -> &mut PlotItemBase {
        &mut self.base
    }
}
