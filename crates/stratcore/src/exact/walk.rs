//! Integrals over the strata of a grid, found by walking along the sides of patches.
//!
//! By Green's theorem ∫ f over a polygon is -∮ (∫ f ds' from s to the right end of the pixel) dt,
//! counter-clockwise. A piece of a side that lies in one stratum adds a part to that stratum
//! and, to every stratum right of it in its row, a polynomial in the place along s. Each row
//! then sums these polynomials from left to right, as coverage rasterisers do with areas.

use super::polygon::Polygon;
use super::polynomial::Polynomial;
use super::strata::Axis;
use crate::simd::{self, Isa, Loop};

/// Strata that are held in memory at a time, one row at the least.
const BAND: u64 = 1 << 14;

/// A convex polygon and what is added to the base there.
pub(super) struct Step<const D: usize> {
    pub polygon: Polygon,
    pub change: Polynomial<D>,
}

/// Walks along patches; keeps its memory from grid to grid.
pub(super) struct Walker<const D: usize> {
    /// The D/2 + 1 nodes and weights that are exact along a side, for an integrand of degree D.
    rule: [(f64, f64); D],
    /// 1 / (a + 1), which an integral makes of a power a.
    shares: [f64; D],
    /// What sides add to their own stratum; strata of one s are neighbours.
    own: Vec<f64>,
    /// What they add to all that follow in the row, by power of s.
    following: [Vec<f64>; D],
    /// Sums of `following` along each row so far.
    running: [Vec<f64>; D],
    /// Means of the powers of t in each row.
    powers: [Vec<f64>; D],
    sums: Vec<f64>,
}

/// The rows of a grid that are walked at once.
struct Band<'a, const D: usize> {
    along_s: &'a Axis<D>,
    along_t: &'a Axis<D>,
    first: u64,
    end: u64,
}

impl<const D: usize> Band<'_, D> {
    fn height(&self) -> usize {
        (self.end - self.first) as usize
    }
}

/// The stratum that holds x.
#[inline(always)]
fn stratum(x: f64, count: u64) -> u64 {
    // Saturates below at 0.
    (((x + 0.5) * count as f64) as u64).min(count - 1)
}

/// [`Walker::squared_means`], for an instruction set.
struct SquaredMeans<'a, const D: usize> {
    walker: &'a mut Walker<D>,
    steps: &'a [Step<D>],
    base: &'a Polynomial<D>,
    along: [&'a Axis<D>; 2],
    sum: &'a mut f64,
}

impl<const D: usize> Loop for SquaredMeans<'_, D> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { walker, steps, base, along: [along_s, along_t], sum } = self;
        let rows = along_t.strata();
        let at_once = (BAND / along_s.strata()).clamp(1, rows);
        *sum = 0.0;
        for first in (0..rows).step_by(at_once as usize) {
            let band = Band { along_s, along_t, first, end: rows.min(first + at_once) };
            walker.clear(&band);
            for step in steps {
                for [from, to] in step.polygon.sides() {
                    walker.walk(&band, &step.change, from, to);
                }
            }
            *sum += walker.sweep(&band, base);
        }
    }
}

impl<const D: usize> Walker<D> {
    /// `rule` is the Gauss rule of D/2 + 1 nodes; no grid has more than `strata`.
    pub fn new(rule: &[(f64, f64)], strata: u64) -> Self {
        let room = (strata.min(BAND) * 2) as usize;
        Self {
            rule: std::array::from_fn(|i| rule.get(i).copied().unwrap_or_default()),
            shares: std::array::from_fn(|a| 1.0 / (a + 1) as f64),
            own: Vec::with_capacity(room),
            following: std::array::from_fn(|_| Vec::with_capacity(room)),
            running: std::array::from_fn(|_| Vec::new()),
            powers: std::array::from_fn(|_| Vec::new()),
            sums: Vec::new(),
        }
    }

    /// Σ over the strata of η (η + 2ρ): η the mean of the steps in the stratum, ρ that of the
    /// base.
    pub fn squared_means(
        &mut self,
        steps: &[Step<D>],
        base: &Polynomial<D>,
        along: [&Axis<D>; 2],
    ) -> f64 {
        let mut sum = 0.0;
        simd::run(Isa::detect(), SquaredMeans { walker: self, steps, base, along, sum: &mut sum });
        sum
    }

    fn clear(&mut self, band: &Band<'_, D>) {
        let reset = |cells: &mut Vec<f64>, columns: u64| {
            cells.clear();
            cells.resize(columns as usize * band.height(), 0.0);
        };
        let columns = band.along_s.strata();
        reset(&mut self.own, columns);
        // What follows the last stratum of a row is never read, but it is written.
        self.following.iter_mut().for_each(|cells| reset(cells, columns + 1));
        self.running.iter_mut().for_each(|cells| reset(cells, 1));
        reset(&mut self.sums, 1);
    }

    /// Adds one side, cut where it passes from row to row.
    #[inline(always)]
    fn walk(&mut self, band: &Band<'_, D>, change: &Polynomial<D>, from: [f64; 2], to: [f64; 2]) {
        // Nothing lies right of the pixel's right end.
        if from[1] == to[1] || (from[0] == 0.5 && to[0] == 0.5) {
            return;
        }
        let sign = if from[1] < to[1] { -1.0 } else { 1.0 };
        let (low, high) = if from[1] < to[1] { (from, to) } else { (to, from) };
        let slope = (high[0] - low[0]) / (high[1] - low[1]);
        let rows = band.along_t.strata();
        let first = stratum(low[1], rows).max(band.first);
        let end = (stratum(high[1], rows) + 1).min(band.end);
        let along = |t: f64| if t == high[1] { high[0] } else { low[0] + (t - low[1]) * slope };
        let at = |t: f64| [along(t), t];
        let mut bottom = at(low[1].max(band.along_t.line(first)));
        for row in first..end {
            let top = at(high[1].min(band.along_t.line(row + 1)));
            if bottom[1] < top[1] {
                self.walk_row(band, change, (row - band.first) as usize, sign, [bottom, top]);
                bottom = top;
            }
        }
    }

    /// Adds a piece of a side within one row, cut where it passes from stratum to stratum.
    #[inline(always)]
    fn walk_row(
        &mut self,
        band: &Band<'_, D>,
        change: &Polynomial<D>,
        row: usize,
        sign: f64,
        [a, b]: [[f64; 2]; 2],
    ) {
        let (left, right) = if a[0] <= b[0] { (a, b) } else { (b, a) };
        let columns = band.along_s.strata();
        let (first, last) = (stratum(left[0], columns), stratum(right[0], columns));
        let mut from = left;
        for column in first..=last {
            let line = band.along_s.line(column + 1);
            let to = if column == last {
                right
            } else {
                let share = (line - left[0]) / (right[0] - left[0]);
                [line, left[1] + share * (right[1] - left[1])]
            };
            let own = column as usize * band.height() + row;
            let rise = sign * (to[1] - from[1]).abs();
            self.add(change, [own, own + band.height()], line, rise, [from, to]);
            from = to;
        }
    }

    /// Adds a piece of a side within one stratum, whose right end is at `line`.
    #[inline(always)]
    fn add(
        &mut self,
        change: &Polynomial<D>,
        [own, next]: [usize; 2],
        line: f64,
        rise: f64,
        [from, to]: [[f64; 2]; 2],
    ) {
        // Node by node within each step: they fit a vector.
        let n_nodes = D / 2 + 1;
        let (mut s, mut t) = ([0.0; D], [0.0; D]);
        for i in 0..n_nodes {
            let (node, _) = self.rule[i];
            s[i] = from[0] + node * (to[0] - from[0]);
            t[i] = from[1] + node * (to[1] - from[1]);
        }
        let (mut to_line, mut to_side) = ([0.0; D], [0.0; D]);
        for a in (0..D).rev() {
            let mut row = [0.0; D];
            for b in (0..D - a).rev() {
                for i in 0..n_nodes {
                    row[i] = row[i] * t[i] + change.0[a][b];
                }
            }
            let mut power = 0.0;
            for i in 0..n_nodes {
                let integral = row[i] * self.shares[a];
                to_line[i] = to_line[i] * line + integral;
                to_side[i] = to_side[i] * s[i] + integral;
                power += self.rule[i].1 * row[i];
            }
            self.following[a][next] += rise * power;
        }
        let mut inside = 0.0;
        for i in 0..n_nodes {
            inside += self.rule[i].1 * (line * to_line[i] - s[i] * to_side[i]);
        }
        self.own[own] += rise * inside;
    }

    /// The sum over the band's strata, column after column.
    #[inline(always)]
    fn sweep(&mut self, band: &Band<'_, D>, base: &Polynomial<D>) -> f64 {
        let (height, along_s, along_t) = (band.height(), band.along_s, band.along_t);
        for (b, powers) in self.powers.iter_mut().enumerate() {
            powers.clear();
            powers.extend((band.first..band.end).map(|row| along_t.powers(row)[b]));
        }
        let powers = self.powers.each_ref().map(|powers| &powers[..height]);
        let running = self.running.each_mut().map(|running| &mut running[..height]);
        let sums = &mut self.sums[..height];
        let (rows, n) =
            (along_t.strata() as f64, along_t.strata() as f64 * along_s.strata() as f64);
        for column in 0..along_s.strata() {
            let cells = column as usize * height..(column as usize + 1) * height;
            let own = &self.own[cells.clone()];
            let following = self.following.each_ref().map(|cells_of| &cells_of[cells.clone()]);
            let along = along_s.powers(column);
            let base: [f64; D] =
                std::array::from_fn(|b| (0..D - b).map(|a| base.0[a][b] * along[a]).sum());
            let along = along.map(|mean| mean * rows);
            for row in 0..height {
                let (mut eta, mut rho) = (own[row] * n, 0.0);
                for a in 0..D {
                    running[a][row] += following[a][row];
                    eta += running[a][row] * along[a];
                    rho += base[a] * powers[a][row];
                }
                sums[row] += eta * (eta + 2.0 * rho);
            }
        }
        sums.iter().sum()
    }
}
