//! The Kronecker sequence R_d.

use super::hash::unit;
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble};
use crate::rng::{Stream, StreamKey};
use crate::simd::Isa;

/// Multiples of a fixed vector modulo 1: (φ^-1, φ^-2, …, φ^-d), where φ solves φ^(d+1) = φ + 1,
/// from the centre of the cube on. In one dimension φ is the golden ratio, in two the plastic
/// number.
#[derive(Debug, Clone, Copy)]
pub struct Rd;

impl Sampler for Rd {
    fn facts(&self) -> Facts {
        Facts {
            name: "rd",
            summary: "R_d: Kronecker sequence of the generalised golden ratio, any N",
            source: "Kronecker; Roberts 2018",
            stream_id: 12,
            kind: Kind::Sequence,
            // Beyond, the steps of several axes differ by little and the axes move together.
            max_dim: 32,
            counts: Admissible::UpTo(StreamKey::MAX_SAMPLES - 1),
            scrambles: &[Scramble::TorusShift, Scramble::None],
            is_random: false,
        }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        Box::new(KroneckerPoints { steps: steps(set.dim) })
    }
}

/// φ^-1 … φ^-d as fractions of 64 bits, by bisection of a^d + a^(d+1) = 1.
fn steps(dim: usize) -> Vec<u64> {
    let times = |a: u64, b: u64| ((u128::from(a) * u128::from(b)) >> 64) as u64;
    let powers = |a: u64| std::iter::successors(Some(a), move |power| Some(times(*power, a)));
    let mut root = 0;
    for bit in (0..64).rev() {
        let larger = root | 1 << bit;
        let mut last_two = powers(larger).skip(dim - 1);
        let fits = match (last_two.next(), last_two.next()) {
            (Some(a), Some(b)) => a.checked_add(b).is_some(),
            _ => false,
        };
        if fits {
            root = larger;
        }
    }
    powers(root).take(dim).collect()
}

struct KroneckerPoints {
    steps: Vec<u64>,
}

impl Points for KroneckerPoints {
    fn fill_with(&self, _isa: Isa, first: u64, points: &mut [f64]) {
        const CENTRE: u64 = 1 << 63;
        for (index, point) in (first..).zip(points.chunks_exact_mut(self.steps.len())) {
            for (x, step) in point.iter_mut().zip(&self.steps) {
                *x = unit(index.wrapping_mul(*step).wrapping_add(CENTRE));
            }
        }
    }
    fn renew(&mut self, _stream: &Stream) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_powers_of_the_generalised_golden_ratio() {
        // The golden ratio (1 + √5)/2 and the plastic number 1.32471795724474602596…
        let golden = 2f64.powi(64) / 1.618_033_988_749_895;
        assert!((steps(1)[0] as f64 - golden).abs() < 1e4);
        let plastic: f64 = 1.324_717_957_244_746;
        for (step, power) in steps(2).into_iter().zip([1, 2]) {
            assert!((step as f64 * 2f64.powi(-64) - plastic.powi(-power)).abs() < 1e-15);
        }
        for dim in 1..=32 {
            let a = steps(dim)[0] as f64 * 2f64.powi(-64);
            let d = dim as i32;
            assert!((a.powi(d) + a.powi(d + 1) - 1.0).abs() < 1e-14, "{dim}");
        }
    }
}
