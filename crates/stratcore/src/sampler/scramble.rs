//! Scrambles: how a point set is made random when its construction is not, or once more.

use super::hash::{splitmix, unit};
use super::{BELOW_ONE, PointSet, Points};
use crate::error::StudyError;
use crate::rng::Stream;
use crate::simd::{self, Isa, Loop};

/// How a point set is made random when its construction is not, or made random once more.
/// Always named beside the sampler, never implied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scramble {
    /// The points as constructed.
    None,
    /// One random vector added to all points, modulo 1 (Cranley & Patterson 1976). Every
    /// sampler takes it; it also moves the strata of those that have them.
    TorusShift,
    /// A torus shift, then each coordinate x becomes 1 - |2x - 1|, which makes any integrand
    /// periodic (Hickernell 2002). For lattices.
    Tent,
    /// One random digital vector XORed to all points: a shift of the base-2 digits.
    XorShift,
    /// A random lower triangular matrix times the base-2 digits, then an XOR shift (Matoušek
    /// 1998). Mean and variance are those of [`Scramble::Owen`], but repeats of the variance
    /// have heavy tails.
    LmsShift,
    /// One random permutation for each digit position of each coordinate, in its own base.
    DigitPermutation,
    /// Owen's nested uniform scrambling (1995): the permutation of a digit is drawn afresh for
    /// each value of the digits before it.
    Owen,
    /// Nested scrambling of 32 digits by a hash (Laine & Karras 2011, Burley 2020).
    OwenHash,
}

impl Scramble {
    /// All there are.
    pub const ALL: [Self; 8] = [
        Self::None,
        Self::TorusShift,
        Self::Tent,
        Self::XorShift,
        Self::LmsShift,
        Self::DigitPermutation,
        Self::Owen,
        Self::OwenHash,
    ];

    /// As typed on the command line and printed in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::TorusShift => "torus-shift",
            Self::Tent => "tent",
            Self::XorShift => "xor-shift",
            Self::LmsShift => "lms-shift",
            Self::DigitPermutation => "digit-permutation",
            Self::Owen => "owen",
            Self::OwenHash => "owen-hash",
        }
    }
}

impl std::fmt::Display for Scramble {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

impl std::str::FromStr for Scramble {
    type Err = StudyError;

    /// # Errors
    /// [`StudyError::UnknownScramble`] lists the names that exist.
    fn from_str(name: &str) -> Result<Self, StudyError> {
        Self::ALL.into_iter().find(|s| s.name() == name).ok_or_else(|| {
            let known = Self::ALL.map(Self::name).join(", ");
            StudyError::UnknownScramble { name: name.to_owned(), known }
        })
    }
}

/// Any points, shifted on the torus and perhaps folded.
pub(super) struct Shifted {
    points: Box<dyn Points>,
    /// The shift, over and over, for [`REPEATS`] points.
    shifts: Vec<f64>,
    fold: bool,
    /// Whether the points are the same under every key; if so, all of them once they were asked
    /// for under a second one.
    fixed: bool,
    kept: Vec<f64>,
    n: u64,
}

/// Most coordinates that are kept.
const MOST_KEPT: usize = 1 << 14;

/// Points that are shifted at a time.
const REPEATS: usize = 32;

impl Shifted {
    /// The scramble is [`Scramble::TorusShift`] or [`Scramble::Tent`]; `fixed` are points that are
    /// the same under every key.
    pub(super) fn new(points: Box<dyn Points>, set: &PointSet, fixed: bool) -> Self {
        let mut shifts = vec![0.0; REPEATS * set.dim];
        shift(&mut shifts, &set.key.stream());
        let (fold, n) = (set.scramble == Scramble::Tent, set.key.n_samples);
        Self { points, shifts, fold, fixed, kept: Vec::new(), n }
    }
}

/// The shift of a stream, over and over.
fn shift(shifts: &mut [f64], stream: &Stream) {
    // No sampler uses the last number of its stream's scramble bits.
    let key = splitmix(stream.scramble_bits(), u64::MAX);
    let dim = shifts.len() / REPEATS;
    for (axis, shift) in (0..).zip(&mut shifts[..dim]) {
        *shift = unit(splitmix(key, axis));
    }
    for repeat in 1..REPEATS {
        shifts.copy_within(..dim, repeat * dim);
    }
}

impl Points for Shifted {
    fn fill_with(&self, isa: Isa, first: u64, points: &mut [f64]) {
        if self.kept.is_empty() {
            self.points.fill_with(isa, first, points);
        } else {
            let at = first as usize * (self.shifts.len() / REPEATS);
            points.copy_from_slice(&self.kept[at..][..points.len()]);
        }
        simd::run(isa, ShiftLoop { shifts: &self.shifts, points, fold: self.fold });
    }
    fn renew(&mut self, stream: &Stream) -> bool {
        let renewed = self.points.renew(stream);
        if renewed {
            shift(&mut self.shifts, stream);
            let coordinates = (self.n as usize).saturating_mul(self.shifts.len() / REPEATS);
            if self.fixed && self.kept.is_empty() && coordinates <= MOST_KEPT {
                self.kept.resize(coordinates, 0.0);
                self.points.fill(0, &mut self.kept);
            }
        }
        renewed
    }
}

struct ShiftLoop<'a> {
    shifts: &'a [f64],
    points: &'a mut [f64],
    fold: bool,
}

impl Loop for ShiftLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for run in self.points.chunks_mut(self.shifts.len()) {
            for (x, shift) in run.iter_mut().zip(self.shifts) {
                let moved = *x + shift;
                *x = if moved >= 1.0 { moved - 1.0 } else { moved };
            }
        }
        if self.fold {
            for x in self.points {
                *x = (1.0 - (2.0 * *x - 1.0).abs()).min(BELOW_ONE);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back_and_are_those_of_the_files() {
        for scramble in Scramble::ALL {
            assert_eq!(scramble.name().parse(), Ok(scramble));
            let written = serialised_name(scramble);
            assert_eq!(written, scramble.name());
        }
        let error = "owenn".parse::<Scramble>().unwrap_err().to_string();
        assert!(error.contains("\"owenn\"") && error.contains("owen-hash"), "{error}");
    }

    /// The name serde gives a variant, by way of the one serialiser at hand.
    fn serialised_name(scramble: Scramble) -> String {
        #[derive(serde::Serialize)]
        struct Named {
            scramble: Scramble,
        }
        let text = toml::to_string(&Named { scramble }).unwrap();
        text.trim().trim_start_matches("scramble = ").trim_matches('"').to_owned()
    }

    struct Extremes;
    impl Points for Extremes {
        fn fill_with(&self, _isa: Isa, _first: u64, points: &mut [f64]) {
            for (x, value) in points.iter_mut().zip([0.0, BELOW_ONE, 0.5, f64::MIN_POSITIVE]) {
                *x = value;
            }
        }
    }

    #[test]
    fn extreme_points_stay_in_the_unit_interval() {
        for shift in [0.0, f64::MIN_POSITIVE, 0.5, BELOW_ONE] {
            for fold in [false, true] {
                let (points, shifts, kept) = (Box::new(Extremes), vec![shift], Vec::new());
                let shifted = Shifted { points, shifts, fold, fixed: false, kept, n: 4 };
                let mut points = [0.0; 4];
                shifted.fill(0, &mut points);
                assert!(points.iter().all(|x| (0.0..1.0).contains(x)), "{shift}: {points:?}");
            }
        }
    }
}
