//! Screen-space blue noise by a shuffled Z-order: one (0,2)-sequence for all pixels.

use super::hash::{below, splitmix};
use super::owen::{NestedUniform, levels};
use super::zero_two::{Order, PaddedPoints, ZeroTwo};
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble};
use crate::rng::StreamKey;

/// A (0,2)-sequence dealt out to pixels in Z-order, N consecutive points to each. Every aligned
/// square of pixels, of any size, shares a net; so estimates of neighbours err in opposite
/// directions. The order of the four quarters of each square is drawn anew for every pair of
/// dimensions; within a pixel a pair's points are in a random order.
///
/// The points of one pixel are those of the scrambled sequence: its own variance is that of
/// `padded`. A pixel's coordinates are part of its points; all else is common to the picture.
/// A torus shift, though, is each pixel's own: it leaves a pixel its net, and the picture none.
#[derive(Debug, Clone, Copy)]
pub struct ZSobol;

/// log2 of the largest N: with 2 × 20 bits of pixel, an index has 64 bits.
const MOST_BITS: u32 = 24;

/// Base-4 digits of a pixel's place in Z-order.
const QUAD_LEVELS: u32 = StreamKey::MAX_PIXEL.trailing_zeros();

impl Sampler for ZSobol {
    fn facts(&self) -> Facts {
        Facts {
            name: "zsobol",
            summary: "(0,2)-sequence dealt to pixels in shuffled Z-order: blue-noise error on screen",
            source: "Ahmed & Wonka 2020",
            stream_id: 16,
            kind: Kind::Set,
            max_dim: usize::MAX,
            counts: Admissible::Rule("2^m, m up to 24"),
            scrambles: &[Scramble::OwenHash, Scramble::Owen, Scramble::TorusShift],
            is_random: true,
        }
    }
    fn admits(&self, n: u64, _dim: usize, _rectangular: bool) -> bool {
        n.is_power_of_two() && n <= 1 << MOST_BITS
    }
    fn neighbours(&self, n: u64, _dim: usize) -> (Option<u64>, Option<u64>) {
        let most = 1 << MOST_BITS;
        let below = (n >= 1).then(|| 1 << n.min(most).ilog2());
        (below, (n < most).then(|| n.next_power_of_two()))
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        let picture = StreamKey { pixel: [0, 0], ..set.key };
        let bits = picture.stream().scramble_bits();
        let n = set.key.n_samples;
        let place = z_order(set.key.pixel);
        let pair = |pair| {
            let key = splitmix(bits, pair);
            // The first pair keeps its order: the set is the same.
            let order = if pair == 0 || n == 1 {
                Order::Kept
            } else {
                let key = splitmix(splitmix(key, 3), place);
                Order::Nested(NestedUniform::new(key, levels(n)))
            };
            let start = shuffled(place, splitmix(key, 4)) * n;
            ZeroTwo::new(set.scramble, key, 32, set.dim, start, order)
        };
        let pairs = (0..set.dim.div_ceil(2) as u64).map(pair).collect();
        Box::new(PaddedPoints { pairs, dim: set.dim, scrambled: None })
    }
}

/// A pixel's place on the Z-curve.
fn z_order([x, y]: [u32; 2]) -> u64 {
    (0..QUAD_LEVELS).fold(0, |place, level| {
        let quarter = x >> level & 1 | (y >> level & 1) << 1;
        place | u64::from(quarter) << (2 * level)
    })
}

/// The place with the four quarters of every square in a random order.
fn shuffled(place: u64, key: u64) -> u64 {
    (0..QUAD_LEVELS).fold(0, |result, level| {
        let square = place >> (2 * level) >> 2;
        let mut bits = splitmix(splitmix(key, level.into()), square);
        let mut quarters = [0, 1, 2, 3];
        for i in (1..4).rev() {
            quarters.swap(i, below(i as u64 + 1, bits) as usize);
            bits = bits.rotate_left(21);
        }
        result | quarters[(place >> (2 * level) & 3) as usize] << (2 * level)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_stay_together() {
        assert_eq!(z_order([0b11, 0b01]), 0b0111);
        assert_eq!(z_order([(1 << 20) - 1; 2]), (1 << 40) - 1);
        for level in 0..6 {
            let (ours, theirs) = (shuffled(0b11_0110_1101, 5), shuffled(0b11_0110_0001, 5));
            let together = level >= 2;
            assert_eq!(ours >> (2 * level) == theirs >> (2 * level), together, "{level}");
        }
    }

    /// 24 orders of four quarters: 23 degrees of freedom, mean 23, standard deviation 6.8.
    /// P(> 70) is 10^-6.
    #[test]
    fn orders_of_quarters_are_equally_likely() {
        let mut counts = std::collections::HashMap::new();
        for key in 0..24_000 {
            let order = [0, 1, 2, 3].map(|quarter| shuffled(quarter, splitmix(3, key)) & 3);
            *counts.entry(order).or_insert(0.0) += 1.0;
        }
        assert_eq!(counts.len(), 24);
        let chi: f64 = counts.values().map(|c: &f64| (c - 1000.0).powi(2) / 1000.0).sum();
        assert!(chi < 70.0, "{chi}");
    }
}
