//! Padded (0,2)-sequences: what renderers ship for many dimensions.

use super::owen::levels;
use super::permutation::Permutation;
use super::sobol::MOST_POINTS;
use super::zero_two::{Order, PaddedPoints, ZeroTwo, pair_keys};
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble};

/// Two dimensions at a time from the (0,2)-sequence of Sobol', each pair scrambled on its own
/// and put in a random order of its own. Every pair is as good as the first; nothing is
/// stratified across pairs.
#[derive(Debug, Clone, Copy)]
pub struct Padded;

impl Sampler for Padded {
    fn facts(&self) -> Facts {
        Facts {
            name: "padded",
            summary: "(0,2)-sequences padded: 2-D Sobol' pairs, each in a random order",
            source: "Kollig & Keller 2002; Burley 2020",
            stream_id: 9,
            kind: Kind::Set,
            max_dim: usize::MAX,
            counts: Admissible::UpTo(MOST_POINTS),
            scrambles: &[
                Scramble::Owen,
                Scramble::OwenHash,
                Scramble::XorShift,
                Scramble::TorusShift,
            ],
            is_random: true,
        }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        let bits = set.key.stream().scramble_bits();
        let n = set.key.n_samples;
        let pair = |pair| {
            let [key, order_key] = pair_keys(bits, pair);
            // The first pair keeps its order: the set is the same.
            let order = match pair {
                0 => Order::Kept,
                _ => Order::Permuted(Permutation::new(n, order_key)),
            };
            ZeroTwo::new(set.scramble, key, levels(n), set.dim, 0, order)
        };
        let pairs = (0..set.dim.div_ceil(2) as u64).map(pair).collect();
        Box::new(PaddedPoints { pairs, dim: set.dim, scrambled: Some((set.scramble, levels(n))) })
    }
}
