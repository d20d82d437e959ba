//! Where samples lie when strata are as fine as numbers are, and which variances are left of
//! the scene when they are as small as rounding.

use super::studio::larger;
use super::{Bench, Family, Row};
use crate::double::{Double, two_product};
use crate::error::StudyError;
use crate::integrand::Integrand;
use crate::literature::{Curve, Figure, Slope};
use crate::rng::Stream;
use crate::sampler::{Jittered, PointSet, Sampler, Scramble};
use crate::trial::trial_means;
use crate::variance::Moments;

pub(super) const FAMILY: Family = Family {
    name: "positions",
    title: "Sample positions and the smallest variances",
    advice: "Positions are f64: with k strata along an axis a point is off by no more than \
             k · 2^-53 widths of a stratum, and it never leaves its stratum. f32 positions have \
             24 bits in all: at k = 2^24 nothing is left of where a point lies in its stratum, \
             and from k = 2^21 on the variance of a slope is off by more than a percent of \
             itself. Trial means are f64 too, so variances can be trusted down to about 1e-30 of \
             the mean squared; what is smaller than 2e-31 of it is reported as exact and not \
             as a number, so that rounding never bends p.",
    measure,
};

/// One coordinate of a jittered point with what it should be: (cell + offset) / k.
struct Placed {
    x: f64,
    cell: u64,
    offset: f64,
}

fn measure(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    within_strata(bench);
    bench.check()?;
    small_variances(bench)
}

/// Points of every third run of strata: the first, some in the middle, the last.
fn placed(bench: &Bench<'_>, k: u64, dim: usize) -> Vec<Placed> {
    const RUN: u64 = 512;
    let n = if dim == 1 { k } else { k * k };
    let key = bench.key(Jittered.stream_id(), k as u32 % (1 << 20), n);
    let set = PointSet { key, dim, scramble: Scramble::None, rectangular: false };
    let (points, stream): (_, Stream) = (Jittered.points(&set), key.stream());
    let mut placed = Vec::new();
    for first in [0, n / 3, 2 * (n / 3), n.saturating_sub(RUN)] {
        let len = RUN.min(n - first);
        let mut run = vec![0.0; len as usize * dim];
        points.fill(first, &mut run);
        for (index, point) in (first..).zip(run.chunks(dim)) {
            let offsets = stream.pair(index);
            for (axis, (&x, offset)) in point.iter().zip(offsets).enumerate() {
                let cell = if axis == 0 { index % k } else { index / k };
                placed.push(Placed { x, cell, offset });
            }
        }
    }
    placed
}

/// x·k - cell without rounding: where in its stratum a coordinate lies, in widths.
fn place_within(x: f64, cell: u64, k: u64) -> Double {
    let (product, lost) = two_product(x, k as f64);
    Double::from(product) - cell as f64 + lost
}

/// What f32 makes of the same draw.
fn in_f32(p: &Placed, k: u64) -> f64 {
    f64::from((p.cell as f32 + p.offset as f32) / k as f32)
}

fn within_strata(bench: &mut Bench<'_>) {
    let mut errors = [0.0f64; 2];
    let mut outside = [0u64; 2];
    let mut at_finest = [0.0; 2];
    let mut worst_spread = 0.0f64;
    let mut collapse = None;
    let mut total = 0;
    let mut curves = [Vec::new(), Vec::new()];
    let ladder = (2..=26).flat_map(|power| {
        let k = 1u64 << power;
        // A power of two divides without rounding; its neighbour does not.
        [k - 1, k].into_iter().filter(|k| *k <= 1 << 26)
    });
    for k in ladder {
        for dim in [1, 2] {
            if dim == 2 && k > 1 << 21 {
                continue;
            }
            let points = placed(bench, k, dim);
            let mut here = [0.0f64; 2];
            // Sums of squares about the middle of the stratum: f64, f32, as drawn.
            let mut squares = [0.0; 3];
            for p in &points {
                for (which, x) in [p.x, in_f32(p, k)].into_iter().enumerate() {
                    let place = place_within(x, p.cell, k);
                    here[which] = here[which].max((place - p.offset).value().abs());
                    let place = place.value();
                    outside[which] += u64::from(!(0.0..=1.0).contains(&place));
                    squares[which] += (place - 0.5).powi(2);
                }
                squares[2] += (p.offset - 0.5).powi(2);
            }
            total += points.len() as u64;
            let spread = [0, 1].map(|which| (squares[which] / squares[2] - 1.0).abs());
            worst_spread = worst_spread.max(spread[0]);
            for which in [0, 1] {
                errors[which] = errors[which].max(here[which]);
                if dim == 1 && k.is_power_of_two() && here[which] > 0.0 {
                    curves[which].push([k as f64, here[which], 0.0, 0.0]);
                }
            }
            if spread[1] > 0.01 && collapse.is_none() {
                collapse = Some(k);
            }
            if k == 1 << 24 {
                at_finest = spread;
            }
        }
    }
    let finest = 2f64.powi(26);
    let tried = format!("4 to 2^26 strata an axis, {total} coordinates in 1 and 2 dimensions");
    bench.push(
        Row::new("position in its stratum", "largest error, in widths of a stratum", {
            // cell + offset and the quotient are rounded once each.
            2.0 * finest * 2f64.powi(-54)
        })
        .tried(&tried)
        .f32(errors[1])
        .f64(errors[0])
        .error(errors[0])
        .floor(finest * 2f64.powi(-54))
        .note("against whole numbers; f32 cannot number 2^26 strata, its points lie in others"),
    );
    bench.push(
        Row::new("points outside their stratum", "share of the coordinates", 0.0)
            .tried(&tried)
            .f32(outside[1] as f64 / total as f64)
            .f64(outside[0] as f64 / total as f64)
            .error(outside[0] as f64 / total as f64)
            .floor(0.0)
            .note("a point may lie on the upper end of its stratum, not beyond"),
    );
    let note = collapse.map_or(String::new(), |k| {
        format!(
            "the variance that a slope has, over that of the offsets as drawn; in f32 off by a \
             percent from k = {k} on (N = k² = {:.1e} in the plane); at 2^24 a point in \
             the far half lies at one end of its stratum or the other, and the variance is three \
             times the truth. An f64 position at 2^26 moves by 2^-27 widths, the variance by \
             less than 12 times that",
            (k * k) as f64
        )
    });
    bench.push(
        Row::new("collapse of strata", "relative error of the variance within strata", 1e-7)
            .tried("4 to 2^26 strata an axis; f32 and f64 as they are at 2^24, all runs together")
            .f32(at_finest[1])
            .f64(at_finest[0])
            .error(worst_spread)
            .note(note),
    );
    let [of_f64, of_f32] = curves;
    bench.draw(Figure {
        name: "stability-positions",
        title: "Error of a position, in widths of its stratum",
        caption: "Largest error of a jittered coordinate against strata along the axis. Dashed: \
                  half the spacing of f32 and f64 numbers below 1, the floor of each. At an error \
                  of 1 a point lies anywhere in its neighbours."
            .to_owned(),
        axes: ["strata along the axis", "error / width of a stratum"],
        log_x: true,
        curves: vec![
            Curve { name: "f32".to_owned(), points: of_f32 },
            Curve { name: "f64, as used".to_owned(), points: of_f64 },
        ],
        slopes: vec![
            Slope { name: "floor, f32", factor: 2f64.powi(-25), power: 1.0 },
            Slope { name: "floor, f64", factor: 2f64.powi(-54), power: 1.0 },
        ],
    });
}

/// 1 + slope · x.
struct Shallow {
    slope: f64,
}

impl Integrand for Shallow {
    fn dim(&self) -> usize {
        1
    }
    fn eval(&self, point: &[f64]) -> f64 {
        1.0 + self.slope * point[0]
    }
}

/// The means of one trial in f32, in f64 without compensation, and in double-double less 1.
fn means_of(slope: f64, points: &[f64]) -> (f32, f64, Double) {
    let n = points.len() as f64;
    let (mut single, mut plain, mut sum) = (0f32, 0.0, Double::default());
    for &x in points {
        single += 1.0 + slope as f32 * x as f32;
        plain += 1.0 + slope * x;
        let (product, lost) = two_product(slope, x);
        sum = sum + product + lost;
    }
    (single / points.len() as f32, plain / n, sum / n)
}

/// s² without any rule for what counts as zero, in double-double, of means given less a pivot.
fn variance_of(means: &[Double]) -> f64 {
    let m = means.len() as f64;
    let sum = means.iter().fold(Double::default(), |sum, x| sum + *x);
    let mean = sum / m;
    let squares = means.iter().fold(Double::default(), |sum, x| {
        let off = *x - mean;
        sum + off * off
    });
    (squares / (m - 1.0)).value()
}

/// Variances that fall as N^-3 through 1e-30 of the mean squared, against the same trials in
/// double-double: sampling noise is the same in both, so what differs is rounding.
fn small_variances(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    const TRIALS: u32 = 50;
    /// Where [`Moments`] says "exact", as a share of the mean squared.
    const EXACT: f64 = 4.0 * f64::EPSILON * f64::EPSILON;
    let slopes = [2f64.powi(-7), 2f64.powi(-36)];
    let largest = bench.either(18, 20);
    let mut curves = [Vec::new(), Vec::new()];
    // Worst relative errors of s² at or above 1e-30, and what is reported below the floor.
    let (mut worst, mut plain_worst, mut single_worst) = (0.0f64, 0.0f64, 0.0f64);
    let (mut numbers_below, mut zeros_above, mut rows) = (0, 0, 0);
    let mut bends = [None, None];
    for (column, slope) in (0..).zip(slopes) {
        for power in 0..=largest {
            bench.check()?;
            let n = 1u64 << power;
            let key = bench.key(Jittered.stream_id(), column, n);
            let set = PointSet { key, dim: 1, scramble: Scramble::None, rectangular: false };
            let integrand = Shallow { slope };
            let mut means = vec![0.0; TRIALS as usize];
            trial_means(&integrand, &Jittered, &set, 0, &mut means, bench.control.cancel);
            let mut points = vec![0.0; n as usize];
            let (mut singles, mut plains, mut exact) = (Vec::new(), Vec::new(), Vec::new());
            for trial in 0..TRIALS {
                let key = crate::rng::StreamKey { trial, ..key };
                Jittered.points(&PointSet { key, ..set }).fill(0, &mut points);
                let (single, plain, sum) = means_of(slope, &points);
                singles.push(Double::from(f64::from(single)) - 1.0);
                plains.push(Double::from(plain) - 1.0);
                exact.push(sum);
            }
            let truth = variance_of(&exact);
            let reported = Moments::of(&means).variance;
            // As it would be without the rule for zero.
            let raw =
                variance_of(&means.iter().map(|m| Double::from(*m) - 1.0).collect::<Vec<_>>());
            let single = variance_of(&singles);
            let off = |variance: f64| (variance / truth - 1.0).abs();
            if column == 1 {
                rows += 1;
                if truth >= 1e-30 {
                    worst = larger(worst, off(reported));
                    plain_worst = larger(plain_worst, off(variance_of(&plains)));
                    single_worst = larger(single_worst, off(variance_of(&singles)));
                    zeros_above += u32::from(reported == 0.0);
                }
                if truth < EXACT / 10.0 {
                    numbers_below += u32::from(reported != 0.0);
                }
            }
            let shown = if column == 0 { single } else { raw };
            if off(shown) >= 1.0 && bends[column as usize].is_none() {
                bends[column as usize] = Some((n, truth));
            }
            if shown > 0.0 {
                curves[column as usize].push([n as f64, shown, 0.0, 0.0]);
            }
        }
    }
    let tried = format!("f = 1 + x/2^36, jittered, N = 1 to 2^{largest}, {TRIALS} trials each");
    bench.push(
        Row::new("variance down to 1e-30", "relative error of s²", 0.08)
            .tried(&tried)
            .f32(single_worst)
            .f64(plain_worst)
            .error(worst)
            .floor(EXACT)
            .note(format!(
                "against the same trials in double-double, where s² is 1e-30 of the mean squared \
                 or more; {zeros_above} of {rows} rows are taken for exact; f32 sees no slope at \
                 all; f64 sums without compensation. A trial mean is rounded by 6e-17 in the \
                 root mean square, 0.06 of the deviation at 1e-30, which moves s² of 50 trials \
                 by 2 %; the limit is 3.5 times that, and its square"
            )),
    );
    let bend = |bend: Option<(u64, f64)>| {
        bend.map_or("not reached".to_owned(), |(n, variance)| {
            format!("N = {n}, where the truth is {variance:.1e}")
        })
    };
    bench.push(
        Row::new("p bends where rounding rules", "rows of rounding taken for a variance", 0.0)
            .tried(tried)
            .f64(numbers_below.into())
            .error(numbers_below.into())
            .floor(EXACT)
            .note(format!(
                "s² that is mostly rounding: in f32 (slope 2^-7) from {}; of f64 means from {}. \
                 There s² is reported as zero, \"exact\", and stays out of the fit: p does not \
                 bend",
                bend(bends[0]),
                bend(bends[1]),
            )),
    );
    let [of_f32, of_f64] = curves;
    let law = |slope: f64| slope * slope / 12.0;
    bench.draw(Figure {
        name: "stability-floor",
        title: "The floor: where rounding, not sampling, is measured",
        caption: "Variance of the mean of 1 + slope · x under jittered points, which falls as \
                  N^-3 (dashed) until rounding stops it. f32 throughout with slope 2^-7; f64 as \
                  used with slope 2^-36. Below the dashed floor this program reports zero."
            .to_owned(),
        axes: ["N", "variance of the mean / mean²"],
        log_x: true,
        curves: vec![
            Curve { name: "f32, slope 2^{-7}".to_owned(), points: of_f32 },
            Curve { name: "f64, slope 2^{-36}".to_owned(), points: of_f64 },
        ],
        slopes: vec![
            Slope { name: "N^{-3}", factor: law(slopes[0]), power: -3.0 },
            Slope { name: "N^{-3}", factor: law(slopes[1]), power: -3.0 },
            Slope { name: "floor", factor: EXACT, power: 0.0 },
        ],
    });
    Ok(())
}
