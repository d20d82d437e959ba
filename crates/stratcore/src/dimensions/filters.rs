//! What reconstruction filters do to the exponent p and the constant C of a pixel.

use super::choose::Kind;
use super::draw::Draws;
use super::expected::{Expected, within_cube};
use super::measure::compare;
use crate::error::StudyError;
use crate::fit::Fit;
use crate::integrand::Integrand;
use crate::literature::{Effort, Finding};
use crate::scene::{Channel, Filter, FilterMethod, FilterShape};
use crate::study::{Control, Row, SamplerChoice, StudyPlan, study};
use crate::trace::TracedScene;
use serde::Serialize;

/// One filter in one way on one pixel, under `jittered`.
#[derive(Debug, Clone, Serialize)]
pub struct FilterRow {
    /// Weights along each axis.
    pub shape: FilterShape,
    /// Half its width in pixels.
    pub radius: f64,
    /// How weights enter.
    pub method: FilterMethod,
    /// What the pixel without a filter holds.
    pub kind: Kind,
    /// The pixel of the scene `edges`.
    pub pixel: [u32; 2],
    /// Variance of one uniform point's share in the estimate: C of `random`.
    pub variance_of_one: f64,
    /// The same over that of the box.
    pub one_sample: f64,
    /// What was measured at each N.
    pub rows: Vec<Row>,
    /// The weighted fit through it.
    pub fit: Option<Fit>,
    /// p for large N: 3/2 where the weighed picture jumps, 2 where it does not.
    pub limit: f64,
    /// Variances found without trials.
    pub expected: Vec<Expected>,
    /// The exponent they fit to.
    pub at_these_n: Option<f64>,
    /// Variance at the largest N over that of the box, and its standard error.
    pub over_box: [f64; 2],
    /// Measured against expected.
    pub test: Option<Finding>,
}

const SHAPES: [FilterShape; 5] = [
    FilterShape::Box,
    FilterShape::Tent,
    FilterShape::Gaussian,
    FilterShape::Mitchell,
    FilterShape::Lanczos,
];
const METHODS: [FilterMethod; 3] =
    [FilterMethod::WeightedMean, FilterMethod::WeightedSum, FilterMethod::Importance];

/// The scene whose pixels are weighed.
pub const FILTERED_SCENE: &str = "edges";

/// Where [`FILTERED_SCENE`] has an edge at 62° with nothing else within the widest filter, and a
/// ramp.
const PIXELS: [(Kind, [u32; 2]); 2] = [(Kind::Edge, [216, 24]), (Kind::Smooth, [100, 150])];

/// Each shape at its usual radius, in each of the three ways, on an edge and on a ramp of the
/// built-in scene [`FILTERED_SCENE`].
///
/// # Errors
/// [`StudyError::Cancelled`] when cancelled.
pub fn filters(
    mut scene: TracedScene,
    seed: u64,
    effort: Effort,
    control: Control<'_>,
) -> Result<Vec<FilterRow>, StudyError> {
    let control = Control { progress: &|_| {}, clock: None, ..control };
    let mut rows: Vec<FilterRow> = Vec::new();
    for (kind, pixel) in PIXELS {
        let mut of_box = None;
        for shape in SHAPES {
            for method in METHODS {
                scene = scene.with_filter(Some(Filter::new(shape, shape.usual_radius(), method)));
                let integrand = scene.pixel(pixel, Channel::Luminance);
                let draws = Draws { integrand: &integrand, seed, pixel, control };
                let measured = row(shape, method, kind, draws, of_box.as_ref(), effort)?;
                of_box.get_or_insert_with(|| measured.clone());
                rows.push(measured);
            }
        }
    }
    Ok(rows)
}

fn row(
    shape: FilterShape,
    method: FilterMethod,
    kind: Kind,
    draws: Draws<'_>,
    of_box: Option<&FilterRow>,
    effort: Effort,
) -> Result<FilterRow, StudyError> {
    let Draws { integrand, seed, pixel, control } = draws;
    let (trials, differences) = match effort {
        Effort::Quick => (100, 1 << 14),
        Effort::Full => (1000, 1 << 17),
    };
    let counts: Vec<u64> = (3..=6).map(|m| 1 << (2 * m)).collect();
    let plan = StudyPlan {
        samplers: vec![SamplerChoice::JITTERED],
        counts: counts.clone(),
        n_trials: trials,
        seed,
        ..StudyPlan::paper()
    };
    let result = study(integrand, pixel, &plan, control)?.samplers.remove(0);
    let radius = shape.usual_radius();
    let mean_weight = Filter::new(shape, radius, method).mean_weight();
    let mean = result.rows.last().map_or(0.0, |row| row.grand_mean);
    let share = Share { weighed: integrand, mean, mean_weight };
    let share = Draws { integrand: &share, ..draws };
    let expected = |n: &u64| {
        let within = within_cube(share, (*n as f64).sqrt(), differences)?;
        let n_f = *n as f64;
        let (variance, std_error) = (within.value / n_f, within.std_error / n_f);
        Ok(Expected { n: *n, variance, std_error })
    };
    let expected: Vec<Expected> = counts.iter().map(expected).collect::<Result<_, StudyError>>()?;
    let one_sample = within_cube(share, 1.0, differences)?.value;
    // Importance changes sign where w does.
    let flips = method == FilterMethod::Importance
        && matches!(shape, FilterShape::Mitchell | FilterShape::Lanczos);
    let limit = if kind == Kind::Edge || flips { 1.5 } else { 2.0 };
    let compared = compare(&format!("{shape}, {method}"), &result, &expected);
    let last = |row: &[Row]| row.last().map(|row| (row.variance_of_mean, row.var_ln()));
    let over_box = match (last(&result.rows), of_box.and_then(|row| last(&row.rows))) {
        (Some((own, a)), Some((boxed, b))) => {
            let ratio = own / boxed;
            [ratio, ratio * (a + b).sqrt()]
        }
        _ => [1.0, 0.0],
    };
    Ok(FilterRow {
        shape,
        radius,
        method,
        kind,
        pixel,
        one_sample: one_sample / of_box.map_or(one_sample, |row| row.variance_of_one),
        variance_of_one: one_sample,
        fit: result.fit,
        rows: result.rows,
        limit,
        expected,
        at_these_n: compared.as_ref().map(|(at_these_n, _)| *at_these_n),
        over_box,
        test: compared.map(|(_, finding)| finding),
    })
}

/// What one point adds to an estimate, but for the mean: f where it is a plain mean, w (f - μ)
/// over the mean of w where it is a weighted one, whose variance this gives to first order.
struct Share<'a> {
    weighed: &'a dyn Integrand,
    mean: f64,
    mean_weight: f64,
}

impl Integrand for Share<'_> {
    fn dim(&self) -> usize {
        self.weighed.dim()
    }

    fn eval(&self, point: &[f64]) -> f64 {
        let mut value = [0.0];
        self.eval_block(point, &mut value);
        value[0]
    }

    fn eval_block(&self, points: &[f64], values: &mut [f64]) {
        self.weighed.eval_block(points, values);
        if !self.weighed.is_weighted() {
            return;
        }
        let mut weights = vec![0.0; values.len()];
        self.weighed.weigh_block(points, &mut weights);
        for (value, weight) in values.iter_mut().zip(weights) {
            *value = (*value - self.mean * weight) / self.mean_weight;
        }
    }
}
