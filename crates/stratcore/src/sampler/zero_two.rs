//! The (0,2)-sequence of the first two Sobol' dimensions, and points made of several.

use super::hash::splitmix;
use super::owen::{DigitScramble, Indices, NestedUniform, own_bits, whole_vectors};
use super::permutation::Permutation;
use super::scramble::Scramble;
use super::target::{ByAxis, Target};
use crate::rng::Stream;
use crate::simd::{self, BLOCK, Isa, Loop};
use std::ops::Range;

/// The first coordinate of a point, as 32 digits with the leading one lowest: its matrix mirrors
/// the index.
#[inline(always)]
fn mirrored_x(index: u64) -> u32 {
    index as u32
}

/// The second coordinate likewise, from the lower and the upper half of the index.
///
/// Its matrix is Pascal's triangle modulo 2: digit i is the sum of index bits j with C(j, i) odd,
/// which are the j whose bits contain those of i (Lucas). Five steps add up all supersets. For
/// bits j ≥ 32 of the index the first 32 digits are those of bit j - 32.
#[inline(always)]
fn mirrored_y(low: u32, high: u32) -> u32 {
    let mut sums = low ^ high;
    sums ^= sums >> 1 & 0x5555_5555;
    sums ^= sums >> 2 & 0x3333_3333;
    sums ^= sums >> 4 & 0x0f0f_0f0f;
    sums ^= sums >> 8 & 0x00ff_00ff;
    sums ^= sums >> 16 & 0x0000_ffff;
    sums
}

/// A scrambled (0,2)-sequence, in an order of one's own: two coordinates of a point set.
pub(super) struct ZeroTwo {
    axes: [DigitScramble; 2],
    /// Key of the bits that truly scrambled points have of their own.
    own: u64,
    /// Index of the set's first point in the sequence.
    start: u64,
    order: Order,
}

/// In which order a set takes the points of a sequence.
pub(super) enum Order {
    /// In the sequence's.
    Kept,
    /// In any.
    Permuted(Permutation),
    /// In one that keeps aligned runs of 2^k points together.
    Nested(NestedUniform),
}

impl ZeroTwo {
    /// The sequence scrambled by `key`, from index `start` on, for a set of `dim` coordinates.
    /// True scrambling works on `levels` digits, which must tell the points apart.
    pub(super) fn new(
        scramble: Scramble,
        key: u64,
        levels: u32,
        dim: usize,
        start: u64,
        order: Order,
    ) -> Self {
        let axis = |axis| DigitScramble::new(scramble, splitmix(key, axis), levels, dim);
        Self { axes: [axis(0), axis(1)], own: splitmix(key, 2), start, order }
    }

    /// The same sequence scrambled by another key, in an order named by `order_key`.
    fn renew(&mut self, scramble: Scramble, [key, order_key]: [u64; 2], levels: u32, dim: usize) {
        if let Order::Permuted(order) = &mut self.order {
            order.renew(order_key);
        }
        for (axis, digits) in (0..).zip(&mut self.axes) {
            digits.renew(scramble, splitmix(key, axis), levels, dim);
        }
        self.own = splitmix(key, 2);
    }

    /// Makes ready what the coordinates of the set's points `first .. first + len`, at most a
    /// block, are made from.
    #[inline(always)]
    fn prepare(&self, first: u64, len: usize, room: &mut Room) {
        let Room { indices, digits: [xs, ys], own } = room;
        let whole = whole_vectors(len);
        for (at, index) in (first..).zip(&mut indices[..whole]) {
            *index = at;
        }
        match &self.order {
            Order::Kept => {}
            Order::Permuted(order) => {
                indices[..len].iter_mut().for_each(|index| *index = order.get(*index));
            }
            Order::Nested(order) => order.scramble(&mut indices[..len]),
        }
        for (index, x) in indices[..whole].iter_mut().zip(&mut *xs) {
            *index = index.wrapping_add(self.start);
            *x = mirrored_x(*index);
        }
        for (x, (index, y)) in xs[..whole].iter().zip(indices.iter().zip(ys)) {
            *y = mirrored_y(*x, (*index >> 32) as u32);
        }
        if self.axes.iter().any(DigitScramble::has_own_bits) {
            let of = match self.order {
                Order::Kept => Indices::From(indices[0]),
                _ => Indices::Listed(indices),
            };
            own_bits(self.own, of, len, own);
        }
    }
}

/// Of a block of points, both coordinates' digits with the leading one lowest, and the bits that
/// each has of its own.
struct Room {
    indices: [u64; BLOCK],
    digits: [[u32; BLOCK]; 2],
    own: [[u32; BLOCK]; 2],
}

/// Points whose coordinates come from a sequence for each two.
pub(super) struct PaddedPoints {
    pub(super) pairs: Vec<ZeroTwo>,
    pub(super) dim: usize,
    /// How many digits are scrambled, and how, where nothing but [`pair_keys`] comes from a key.
    pub(super) scrambled: Option<(Scramble, u32)>,
}

/// Keys of a pair of coordinates, and of their order.
pub(super) fn pair_keys(bits: u64, pair: u64) -> [u64; 2] {
    let key = splitmix(bits, pair);
    [key, splitmix(key, u64::MAX)]
}

impl ByAxis for PaddedPoints {
    fn dim(&self) -> usize {
        self.dim
    }
    fn write(&self, isa: Isa, first: u64, target: &mut Target<'_>) {
        for (pair, sequence) in self.pairs.iter().enumerate() {
            let axes = 2 * pair..self.dim.min(2 * pair + 2);
            simd::run(isa, PairLoop { sequence, first, target, axes });
        }
    }
    fn renew_axes(&mut self, stream: &Stream) -> bool {
        let Some((scramble, levels)) = self.scrambled else { return false };
        let bits = stream.scramble_bits();
        for (pair, sequence) in (0..).zip(&mut self.pairs) {
            sequence.renew(scramble, pair_keys(bits, pair), levels, self.dim);
        }
        true
    }
}

/// One or two coordinates of points `first ..`.
struct PairLoop<'a, 'b> {
    sequence: &'a ZeroTwo,
    first: u64,
    target: &'a mut Target<'b>,
    axes: Range<usize>,
}

impl Loop for PairLoop<'_, '_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { sequence, first, target, axes } = self;
        let mut room = Room { indices: [0; BLOCK], digits: [[0; BLOCK]; 2], own: [[0; BLOCK]; 2] };
        let mut made = [0.0; BLOCK];
        let n = target.len();
        for at in (0..n).step_by(BLOCK) {
            let made = &mut made[..BLOCK.min(n - at)];
            sequence.prepare(first + at as u64, made.len(), &mut room);
            let ready = sequence.axes.iter().zip(room.digits.iter().zip(&room.own));
            for (axis, (scramble, (digits, own))) in axes.clone().zip(ready) {
                scramble.coordinates(digits, own, made);
                target.put(axis, at, made.iter().copied());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sobol::sobol_matrices;
    use super::*;

    #[test]
    fn points_are_those_of_the_direction_numbers() {
        for i in 0..1000 {
            let index = splitmix(1, i) as u32;
            let by_columns = [0, 1].map(|dim| {
                (0..32)
                    .filter(|bit| index >> bit & 1 == 1)
                    .fold(0, |x, bit| x ^ sobol_matrices()[dim][bit])
            });
            let point = [mirrored_x(index.into()), mirrored_y(index, 0)];
            assert_eq!(point, by_columns);
        }
    }
}
