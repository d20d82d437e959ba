//! Integrals over the strata of a grid, found by walking along the sides of patches.
//!
//! By Green's theorem ∫ f over a polygon is -∮ (∫ f ds' from s to the right end of the pixel) dt,
//! counter-clockwise. A piece of a side that lies in one stratum adds a part to that stratum
//! and, to every stratum right of it in its row, a polynomial in the place along s. Each row
//! then sums these polynomials from left to right, as coverage rasterisers do with areas.

use super::polygon::Polygon;
use super::polynomial::{Polynomial, horner};
use super::strata::Axis;

/// Strata that are held in memory at a time, one row at the least.
const BAND: u64 = 1 << 14;

/// A convex polygon and what is added to the base there.
pub(super) struct Step<const D: usize> {
    pub polygon: Polygon,
    pub change: Polynomial<D>,
}

/// Walks along patches; keeps its memory from grid to grid.
pub(super) struct Walker<'a, const D: usize> {
    /// Nodes and weights, exact along a side: for an integrand of degree D.
    rule: &'a [(f64, f64)],
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
#[derive(Clone, Copy)]
struct Band {
    columns: u64,
    rows: u64,
    first: u64,
    end: u64,
}

impl Band {
    fn height(&self) -> usize {
        (self.end - self.first) as usize
    }

    fn line(&self, index: u64, count: u64) -> f64 {
        index as f64 / count as f64 - 0.5
    }
}

/// The stratum that holds x.
fn stratum(x: f64, count: u64) -> u64 {
    // Saturates below at 0.
    (((x + 0.5) * count as f64) as u64).min(count - 1)
}

impl<'a, const D: usize> Walker<'a, D> {
    /// `rule` is the Gauss rule of D/2 + 1 nodes; no grid has more than `strata`.
    pub fn new(rule: &'a [(f64, f64)], strata: u64) -> Self {
        let room = (strata.min(BAND) * 2) as usize;
        Self {
            rule,
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
        along_s: &Axis<D>,
        along_t: &Axis<D>,
    ) -> f64 {
        let (columns, rows) = (along_s.strata(), along_t.strata());
        let at_once = (BAND / columns).clamp(1, rows);
        let mut sum = 0.0;
        for first in (0..rows).step_by(at_once as usize) {
            let band = Band { columns, rows, first, end: rows.min(first + at_once) };
            self.clear(&band);
            for step in steps {
                for [from, to] in step.polygon.sides() {
                    self.walk(&band, &step.change, from, to);
                }
            }
            sum += self.sweep(&band, base, along_s, along_t);
        }
        sum
    }

    fn clear(&mut self, band: &Band) {
        let reset = |cells: &mut Vec<f64>, columns: u64| {
            cells.clear();
            cells.resize(columns as usize * band.height(), 0.0);
        };
        reset(&mut self.own, band.columns);
        // What follows the last stratum of a row is never read, but it is written.
        self.following.iter_mut().for_each(|cells| reset(cells, band.columns + 1));
        self.running.iter_mut().for_each(|cells| reset(cells, 1));
        reset(&mut self.sums, 1);
    }

    /// Adds one side, cut where it passes from row to row.
    fn walk(&mut self, band: &Band, change: &Polynomial<D>, from: [f64; 2], to: [f64; 2]) {
        if from[1] == to[1] {
            return;
        }
        let sign = if from[1] < to[1] { -1.0 } else { 1.0 };
        let (low, high) = if from[1] < to[1] { (from, to) } else { (to, from) };
        let slope = (high[0] - low[0]) / (high[1] - low[1]);
        let first = stratum(low[1], band.rows).max(band.first);
        let end = (stratum(high[1], band.rows) + 1).min(band.end);
        for row in first..end {
            let bottom = low[1].max(band.line(row, band.rows));
            let top = high[1].min(band.line(row + 1, band.rows));
            if bottom >= top {
                continue;
            }
            let along = |t: f64| if t == high[1] { high[0] } else { low[0] + (t - low[1]) * slope };
            let (a, b) = ([along(bottom), bottom], [along(top), top]);
            self.walk_row(band, change, (row - band.first) as usize, sign, a, b);
        }
    }

    /// Adds a piece of a side within one row, cut where it passes from stratum to stratum.
    fn walk_row(
        &mut self,
        band: &Band,
        change: &Polynomial<D>,
        row: usize,
        sign: f64,
        a: [f64; 2],
        b: [f64; 2],
    ) {
        let (left, right) = if a[0] <= b[0] { (a, b) } else { (b, a) };
        let (first, last) = (stratum(left[0], band.columns), stratum(right[0], band.columns));
        let mut from = left;
        for column in first..=last {
            let to = if column == last {
                right
            } else {
                let s = band.line(column + 1, band.columns);
                let share = (s - left[0]) / (right[0] - left[0]);
                [s, left[1] + share * (right[1] - left[1])]
            };
            let line = band.line(column + 1, band.columns);
            let own = column as usize * band.height() + row;
            self.add(
                change,
                own,
                own + band.height(),
                line,
                sign * (to[1] - from[1]).abs(),
                from,
                to,
            );
            from = to;
        }
    }

    /// Adds a piece of a side within one stratum, whose right end is at `line`.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "one piece of a side, in the innermost loop")]
    fn add(
        &mut self,
        change: &Polynomial<D>,
        own: usize,
        next: usize,
        line: f64,
        rise: f64,
        from: [f64; 2],
        to: [f64; 2],
    ) {
        let mut inside = 0.0;
        let mut powers = [0.0; D];
        for (node, weight) in self.rule {
            let s = from[0] + node * (to[0] - from[0]);
            let t = from[1] + node * (to[1] - from[1]);
            let row = change.row(t);
            let integral: [f64; D] = std::array::from_fn(|a| row[a] * self.shares[a]);
            inside += weight * (line * horner(&integral, line) - s * horner(&integral, s));
            for a in 0..D {
                powers[a] += weight * row[a];
            }
        }
        self.own[own] += rise * inside;
        for (following, power) in self.following.iter_mut().zip(powers) {
            following[next] += rise * power;
        }
    }

    /// The sum over the band's strata, column after column.
    fn sweep(
        &mut self,
        band: &Band,
        base: &Polynomial<D>,
        along_s: &Axis<D>,
        along_t: &Axis<D>,
    ) -> f64 {
        let height = band.height();
        for (b, powers) in self.powers.iter_mut().enumerate() {
            powers.clear();
            powers.extend((band.first..band.end).map(|row| along_t.powers(row)[b]));
        }
        let powers = self.powers.each_ref().map(|powers| &powers[..height]);
        let running = self.running.each_mut().map(|running| &mut running[..height]);
        let sums = &mut self.sums[..height];
        let (rows, n) = (band.rows as f64, band.rows as f64 * band.columns as f64);
        for column in 0..band.columns {
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
