//! Integrals over the strata of a grid, found by walking along the sides of patches.
//!
//! By Green's theorem ∫ f over a polygon is -∮ (∫ f ds' from s to the right end of the pixel) dt,
//! counter-clockwise. A piece of a side that lies in one stratum adds a part to that stratum
//! and, to every stratum right of it in its row, a polynomial in the place along s. Each row
//! then sums these polynomials from left to right, as coverage rasterisers do with areas. Both
//! parts are differences of polynomials in the place along the side, which are the same for
//! every grid.

use super::polygon::Polygon;
use super::polynomial::Polynomial;
use super::strata::Axis;
use crate::double::Double;
use crate::simd::{self, Isa, Loop};

/// Rows that are swept side by side.
pub(super) const LANES: usize = 4;

/// Strata that are held in memory at a time; room for `LANES` rows of any grid.
const BAND: usize = 1 << 14;

/// What pieces of sides add to the stratum that they lie in and to those right of it; or a
/// coefficient of the polynomial that this is along a side. With f = Σ gₐ(t) sᵃ:
#[derive(Debug, Clone, Copy, PartialEq)]
struct Crossing<const D: usize> {
    /// -∫ gₐ dt, which all strata to the right get times the integral of sᵃ over their width, and
    /// the piece's own one times that from 0 to its right end,
    right: [f64; D],
    /// less -∫ Σ gₐ sᵃ⁺¹ / (a + 1) dt, what lies left of the side.
    left: f64,
}

impl<const D: usize> Crossing<D> {
    const ZERO: Self = Self { right: [0.0; D], left: 0.0 };

    #[inline(always)]
    fn minus(&self, other: &Self) -> Self {
        let mut difference = *self;
        for a in 0..D {
            difference.right[a] -= other.right[a];
        }
        difference.left -= other.left;
        difference
    }
}

/// A side of a patch, from left to right.
pub(super) struct Side<const D: usize> {
    from: [f64; 2],
    to: [f64; 2],
    delta: [f64; 2],
    /// 1 / `delta`
    per: [f64; 2],
    /// Coefficients of the powers 1 to D of the place along the side, 0 at `from` and 1 at `to`,
    /// in the integrals from there.
    powers: [Crossing<D>; D],
    /// That of power D + 1, which `left` alone has.
    last: f64,
}

impl<const D: usize> Side<D> {
    /// The sides of a polygon in which `change` is added to the base, but for those that add
    /// nothing: along a row, or at the pixel's right end.
    pub fn of(polygon: &Polygon, change: &Polynomial<D>) -> impl Iterator<Item = Self> {
        let adds = |[from, to]: &[[f64; 2]; 2]| from[1] != to[1] && (from[0] < 0.5 || to[0] < 0.5);
        polygon.sides().filter(adds).map(|[from, to]| Self::new(from, to, change))
    }

    fn new(from: [f64; 2], to: [f64; 2], change: &Polynomial<D>) -> Self {
        let (from, to, sign) = if from[0] <= to[0] { (from, to, -1.0) } else { (to, from, 1.0) };
        let delta @ [ds, dt] = [to[0] - from[0], to[1] - from[1]];
        let per = delta.map(f64::recip);
        let mut side = Self { from, to, delta, per, powers: [Crossing::ZERO; D], last: 0.0 };
        // Coefficients of gₐ and of Σ gₐ sᵃ⁺¹ / (a + 1); the last one of the latter apart.
        let (mut left, mut last) = ([0.0; D], 0.0);
        for a in (0..D).rev() {
            let mut row = [0.0; D];
            for b in (0..D - a).rev() {
                for j in (1..D).rev() {
                    row[j] = row[j] * from[1] + row[j - 1] * dt;
                }
                row[0] = row[0] * from[1] + change.0[a][b];
            }
            let share = 1.0 / (a + 1) as f64;
            for j in 0..D {
                left[j] += share * row[j];
                side.powers[j].right[a] = sign * dt * row[j] / (j + 1) as f64;
            }
            last = last * from[0] + left[D - 1] * ds;
            for j in (1..D).rev() {
                left[j] = left[j] * from[0] + left[j - 1] * ds;
            }
            left[0] *= from[0];
        }
        for (j, (power, left)) in side.powers.iter_mut().zip(left).enumerate() {
            power.left = sign * dt * left / (j + 1) as f64;
        }
        side.last = sign * dt * last / (D + 1) as f64;
        side
    }

    /// The integrals up to a place along the side.
    #[inline(always)]
    fn up_to(&self, place: f64) -> Crossing<D> {
        let mut sums = Crossing { right: [0.0; D], left: self.last };
        for power in self.powers.iter().rev() {
            for a in 0..D {
                sums.right[a] = sums.right[a] * place + power.right[a];
            }
            sums.left = sums.left * place + power.left;
        }
        for a in 0..D {
            sums.right[a] *= place;
        }
        sums.left *= place;
        sums
    }
}

/// What was added in one stratum of each of some rows.
#[derive(Clone, Copy)]
struct Cells<const D: usize> {
    right: [[f64; LANES]; D],
    left: [f64; LANES],
}

impl<const D: usize> Cells<D> {
    const EMPTY: Self = Self { right: [[0.0; LANES]; D], left: [0.0; LANES] };
}

/// What all rows make of a column.
#[derive(Clone, Copy)]
struct Column<const D: usize> {
    /// N ∫ sᵃ from 0 to its right end.
    end: [f64; D],
    /// N ∫ sᵃ over its width.
    width: [f64; D],
    /// Twice the base's mean, by power of t.
    base: [f64; D],
}

/// Walks along sides; keeps its memory from grid to grid.
pub(super) struct Walker<const D: usize> {
    /// Column after column of the first rows, then of the next; zero but during a walk.
    cells: Vec<Cells<D>>,
    columns: Vec<Column<D>>,
    /// Places where a side passes from column to column and from row to row.
    places: [Vec<f64>; 2],
}

/// The rows of a grid that are walked at once.
struct Band<'a, const D: usize> {
    along_s: &'a Axis<D>,
    along_t: &'a Axis<D>,
    first: usize,
    end: usize,
}

/// The stratum that holds x.
#[inline(always)]
fn stratum(x: f64, count: usize) -> usize {
    (((x + 0.5) * count as f64) as i32).clamp(0, count as i32 - 1) as usize
}

/// The part of a side that lies in a band.
struct Part {
    /// Places along the side.
    enters: f64,
    leaves: f64,
    left: usize,
    right: usize,
    bottom: usize,
    top: usize,
}

impl Part {
    #[inline(always)]
    fn of<const D: usize>(side: &Side<D>, band: &Band<'_, D>) -> Option<Self> {
        let Band { along_s, along_t, first, end } = *band;
        let rises = side.delta[1] > 0.0;
        let [from, to] = [side.from[1], side.to[1]].map(|t| stratum(t, along_t.strata()));
        let (lowest, highest) = if rises { (from, to) } else { (to, from) };
        let (bottom, top) = (lowest.max(first), highest.min(end - 1));
        if bottom > top {
            return None;
        }
        let (mut enters, mut leaves, mut from_s, mut to_s) = (0.0, 1.0, side.from[0], side.to[0]);
        if bottom > lowest || top < highest {
            let reaches =
                |row: usize| ((along_t.lines()[row] - side.from[1]) * side.per[1]).clamp(0.0, 1.0);
            let below = if bottom > lowest { reaches(bottom) } else { f64::from(!rises) };
            let above = if top < highest { reaches(top + 1) } else { f64::from(rises) };
            (enters, leaves) = if rises { (below, above) } else { (above, below) };
            from_s = side.from[0] + enters * side.delta[0];
            to_s = side.from[0] + leaves * side.delta[0];
        }
        let [left, right] = [from_s, to_s].map(|s| stratum(s, along_s.strata()));
        Some(Self { enters, leaves, left, right: right.max(left), bottom, top })
    }
}

/// [`Walker::squared_means`], for an instruction set.
struct SquaredMeans<'a, const D: usize> {
    walker: &'a mut Walker<D>,
    sides: &'a [Side<D>],
    base: &'a Polynomial<D>,
    along: [&'a Axis<D>; 2],
    sum: &'a mut Double,
}

impl<const D: usize> Loop for SquaredMeans<'_, D> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { walker, sides, base, along: [along_s, along_t], sum } = self;
        let rows = along_t.strata();
        let at_once = (BAND / along_s.strata() / LANES).max(1) * LANES;
        walker.columns(base, along_s, along_t);
        for first in (0..rows).step_by(at_once) {
            let band = Band { along_s, along_t, first, end: rows.min(first + at_once) };
            for side in sides {
                walker.walk(&band, side);
            }
            walker.sweep(&band, sum);
        }
    }
}

impl<const D: usize> Walker<D> {
    /// For grids of no more than so many columns and rows.
    pub fn new([columns, rows]: [usize; 2]) -> Self {
        let blocks = (columns * rows.div_ceil(LANES)).min((BAND / LANES).max(columns));
        let places = |lines: usize| vec![0.0; lines.next_multiple_of(LANES) + 2];
        Self {
            cells: vec![Cells::EMPTY; blocks],
            columns: Vec::with_capacity(columns),
            places: [places(columns), places(rows)],
        }
    }

    /// Σ over the strata of η (η + 2ρ): η the mean of what the sides enclose in the stratum, ρ
    /// that of the base.
    pub fn squared_means(
        &mut self,
        sides: &[Side<D>],
        base: &Polynomial<D>,
        along: [&Axis<D>; 2],
    ) -> f64 {
        let mut sum = Double::default();
        simd::run(Isa::detect(), SquaredMeans { walker: self, sides, base, along, sum: &mut sum });
        sum.value()
    }

    #[inline(always)]
    fn columns(&mut self, base: &Polynomial<D>, along_s: &Axis<D>, along_t: &Axis<D>) {
        let rows = along_t.strata() as f64;
        let n = rows * along_s.strata() as f64;
        self.columns.clear();
        self.columns.extend((0..along_s.strata()).map(|i| {
            let (means, line) = (along_s.powers(i), along_s.lines()[i + 1]);
            let mut column = Column { end: [0.0; D], width: [0.0; D], base: [0.0; D] };
            let mut power = n;
            for (a, mean) in means.into_iter().enumerate() {
                power *= line;
                column.end[a] = power / (a + 1) as f64;
                column.width[a] = rows * mean;
                for b in 0..D - a {
                    column.base[b] += 2.0 * base.0[a][b] * mean;
                }
            }
            column
        }));
    }

    /// Adds a side to the strata of the band that it passes through, from line to line.
    #[inline(always)]
    fn walk(&mut self, band: &Band<'_, D>, side: &Side<D>) {
        let Some(part) = Part::of(side, band) else { return };
        let Part { enters, leaves, left, bottom, top, .. } = part;
        let (n_columns, n_rows) = (part.right - left, top - bottom);
        // Whole vectors: places beyond the last line are overwritten or not read.
        let cross = |axis: usize, places: &mut [f64], lines: &[f64]| {
            for (places, lines) in places.chunks_exact_mut(LANES).zip(lines.chunks_exact(LANES)) {
                for l in 0..LANES {
                    let place = (lines[l] - side.from[axis]) * side.per[axis];
                    // A short side's ends may be rounded to the wrong side of a line.
                    let place = if place > enters { place } else { enters };
                    places[l] = if place < leaves { place } else { leaves };
                }
            }
        };
        let padded = |n: usize| n.next_multiple_of(LANES);
        let [to_columns, to_rows] = &mut self.places;
        cross(0, to_columns, &band.along_s.lines()[left + 1..][..padded(n_columns)]);
        cross(1, &mut to_rows[1..], &band.along_t.lines()[bottom + 1..][..padded(n_rows)]);
        // No more lines to cross.
        to_columns[n_columns] = f64::INFINITY;
        (to_rows[0], to_rows[n_rows + 1]) = (f64::INFINITY, f64::INFINITY);

        let (mut row, mut next_row, up_or_down) = match side.delta[1] > 0.0 {
            true => (bottom - band.first, 1, 1),
            false => (top - band.first, n_rows, usize::MAX),
        };
        let mut column = left;
        let cells = &mut self.cells[..];
        let mut add = |row: usize, column: usize, piece: &Crossing<D>| {
            let cells = &mut cells[row / LANES * band.along_s.strata() + column];
            for a in 0..D {
                cells.right[a][row % LANES] += piece.right[a];
            }
            cells.left[row % LANES] += piece.left;
        };
        let mut before = if enters > 0.0 { side.up_to(enters) } else { Crossing::ZERO };
        for _ in 0..n_columns + n_rows {
            let (to_column, to_row) = (to_columns[column - left], to_rows[next_row]);
            let is_column = to_column < to_row;
            let here = side.up_to(if is_column { to_column } else { to_row });
            add(row, column, &here.minus(&before));
            before = here;
            // Which of the two comes next no processor guesses.
            column += usize::from(is_column);
            let step = if is_column { 0 } else { up_or_down };
            row = row.wrapping_add(step);
            next_row = next_row.wrapping_add(step);
        }
        add(row, column, &side.up_to(leaves).minus(&before));
    }

    /// Adds up the band's strata, row by row from left to right; their cells are zero then.
    #[inline(always)]
    fn sweep(&mut self, band: &Band<'_, D>, sum: &mut Double) {
        /// Columns whose terms, which may be equal and round alike, are added in f64.
        const COLUMNS: usize = 64;
        let blocks = self.cells.chunks_exact_mut(self.columns.len());
        let n = (band.along_s.strata() * band.along_t.strata()) as f64;
        for (first, cells) in (band.first..band.end).step_by(LANES).zip(blocks) {
            let powers = band.along_t.powers_from(first);
            let mut running = [[0.0; LANES]; D];
            for (cells, columns) in cells.chunks_mut(COLUMNS).zip(self.columns.chunks(COLUMNS)) {
                let mut in_rows = [0.0; LANES];
                for (cells, column) in cells.iter_mut().zip(columns) {
                    let Cells { right, left } = *cells;
                    let (mut eta, mut rho) = ([0.0; LANES], [0.0; LANES]);
                    for l in 0..LANES {
                        eta[l] = -n * left[l];
                    }
                    for a in 0..D {
                        for l in 0..LANES {
                            eta[l] += right[a][l] * column.end[a] + running[a][l] * column.width[a];
                            running[a][l] += right[a][l];
                            rho[l] += column.base[a] * powers[a][l];
                        }
                    }
                    for l in 0..LANES {
                        in_rows[l] += eta[l] * (eta[l] + rho[l]);
                    }
                    *cells = Cells::EMPTY;
                }
                *sum = *sum + in_rows.iter().sum::<f64>();
            }
        }
    }
}
