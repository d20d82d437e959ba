//! Nested maps of the digits of many indices, and those digits mirrored.

use super::hash::{unit, whole};
use crate::rng::{Stream, unit_pair};
use crate::simd::{self, BLOCK, Isa, Loop};
use std::cell::RefCell;

/// Numbers that a vector has at the most.
pub(super) const LANES: usize = 8;

/// Kept by the thread from set to set.
struct Room {
    draws: [[u32; BLOCK]; 3],
    /// Of a block of maps: factors, next digits, and the digits before, moved up by one.
    factors: [f64; BLOCK],
    digits: [f64; BLOCK],
    before: [f64; BLOCK],
    /// By index.
    words: Vec<u64>,
    tails: Vec<f64>,
    turns: Vec<f64>,
}

impl Default for Room {
    fn default() -> Self {
        let (draws, numbers) = ([[0; BLOCK]; 3], [0.0; BLOCK]);
        let (words, tails, turns) = (Vec::new(), Vec::new(), Vec::new());
        Self { draws, factors: numbers, digits: numbers, before: numbers, words, tails, turns }
    }
}

impl Room {
    /// For so many indices at least.
    fn resize(&mut self, len: usize) {
        if self.words.len() < len {
            self.words.resize(len, 0);
            self.tails.resize(len, 0.0);
            self.turns.resize(len, 0.0);
        }
    }
}

/// What is mapped.
#[derive(Clone, Copy)]
pub(super) struct Nested {
    /// Of the draws.
    pub(super) stream: Stream,
    pub(super) base: usize,
    pub(super) digits: u32,
    /// Indices, from 0 on.
    pub(super) len: usize,
    /// Whether each index's tail is added.
    pub(super) has_tails: bool,
}

impl Nested {
    /// Overwrites `table` with the mirrored digits of each index. Behind the last there is room
    /// to the end of a vector.
    pub(super) fn fill(self, isa: Isa, table: &mut [f64]) {
        thread_local! {
            static ROOM: RefCell<Room> = RefCell::default();
        }
        table[0] = 0.0;
        ROOM.with_borrow_mut(|room| {
            room.resize(table.len());
            let of = Job { nested: self, table, room };
            // Each is compiled by itself: together they are a tenth slower.
            if self.base == 2 {
                simd::run(isa, BinaryLoop(of));
            } else {
                simd::run(isa, NestedLoop(of));
            }
        });
    }
}

struct Job<'a> {
    nested: Nested,
    table: &'a mut [f64],
    room: &'a mut Room,
}

/// Nested maps of the digits in a table, made point by point.
///
/// The digits after all that an index has are zeros; scrambled, they are a uniform number, the
/// index's tail. Once indices of one more digit come in, the tail's first digit is the constant of
/// the map that they share with the index that has a zero there, whose tail loses it; a second
/// number gives the factor likewise, digit by digit in base b - 1. Each new index begins a tail of
/// its own. So a draw for each index is all the randomness there is.
struct NestedLoop<'a>(Job<'a>);

impl Loop for NestedLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self(Job { nested, table, room }) = self;
        let Nested { stream, base, digits: levels, len, has_tails } = nested;
        let Room { draws, factors, digits, before, tails, turns, .. } = room;
        let (tails, turns) = (&mut tails[..table.len()], &mut turns[..table.len()]);
        let b = base as f64;
        let last = base.pow(levels - 1);
        for block in (0..len).step_by(BLOCK) {
            let made = BLOCK.min(len.next_multiple_of(LANES) - block);
            let (tails, turns) = (&mut tails[block..][..made], &mut turns[block..][..made]);
            stream.draws(block as u64, 1, made, draws);
            for l in 0..made {
                [tails[l], _] = unit_pair([draws[0][l], draws[1][l], draws[2][l]]);
            }
            // The last digit comes after no others.
            if block < last {
                for l in 0..made.min((last - block).next_multiple_of(LANES)) {
                    [_, turns[l]] = unit_pair([draws[0][l], draws[1][l], draws[2][l]]);
                }
            }
        }
        let mut width = 1;
        for _ in 0..levels {
            // Those with no other beside them keep the digit in the tail.
            let shared = width.min(len - width.min(len));
            // The last ones first. They are made to the end of a vector; what is too much is
            // written over by what comes next, or lies behind the table's end.
            for block in (0..shared).step_by(BLOCK).rev() {
                let known = BLOCK.min(shared - block);
                let made = known.next_multiple_of(LANES);
                let (factors, digits) = (&mut factors[..made], &mut digits[..made]);
                let before = &mut before[..made];
                {
                    let (tails, turns) = (&mut tails[block..][..made], &mut turns[block..][..made]);
                    let entries = &mut table[block..][..made];
                    for l in 0..made {
                        // Numbers that are not shared stay as they are: times 1, less 0. To leave
                        // them out would make masked stores, which take some CPUs tens of cycles.
                        let is_shared = (l as u64) < known as u64;
                        let (of_tail, of_turn) = if is_shared { (b, b - 1.0) } else { (1.0, 1.0) };
                        let (tail, turn) = (tails[l] * of_tail, turns[l] * of_turn);
                        let (digit, factor) = (tail.floor(), turn.floor());
                        digits[l] = digit;
                        factors[l] = factor + 1.0;
                        let moved = entries[l] * of_tail;
                        before[l] = moved;
                        tails[l] = tail - if is_shared { digit } else { 0.0 };
                        turns[l] = turn - if is_shared { factor } else { 0.0 };
                        entries[l] = moved + if is_shared { digit } else { 0.0 };
                    }
                }
                let mut at = block + width;
                for _ in 1..base {
                    if at >= len {
                        break;
                    }
                    let entries = &mut table[at..];
                    let made = made.min(entries.len());
                    let entries = &mut entries[..made];
                    for l in 0..made {
                        let next = digits[l] + factors[l];
                        let next = if next >= b { next - b } else { next };
                        digits[l] = next;
                        entries[l] = before[l] + next;
                    }
                    at += width;
                }
            }
            for (sum, tail) in table[shared..width].iter_mut().zip(&mut tails[shared..width]) {
                *sum *= b;
                *tail *= b;
            }
            width *= base;
        }
        if has_tails {
            for (sum, tail) in table.iter_mut().zip(tails) {
                *sum += *tail;
            }
        }
    }
}

/// The same in base 2, where a factor is 1 and a number's digits need no arithmetic.
struct BinaryLoop<'a>(Job<'a>);

impl Loop for BinaryLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self(Job { nested, table, room }) = self;
        let Nested { stream, digits, len, has_tails, .. } = nested;
        let Room { draws, words, .. } = room;
        let words = &mut words[..table.len()];
        for block in (0..len).step_by(BLOCK) {
            let made = BLOCK.min(len.next_multiple_of(LANES) - block);
            stream.draws(block as u64, 1, made, draws);
            let [high, low, _] = &*draws;
            for (word, (high, low)) in words[block..][..made].iter_mut().zip(high.iter().zip(low)) {
                *word = u64::from(*high) << 32 | u64::from(*low);
            }
        }
        for level in 0..digits {
            let width = 1 << level;
            if width >= len {
                break;
            }
            let (before, new) = words.split_at_mut(width);
            let new = &mut new[..width.min(len - width)];
            // The digits before this one, this one turned, and all others new.
            let digit = 1 << (63 - level);
            for (word, before) in new.iter_mut().zip(before) {
                *word = (*before ^ digit) & 0u64.wrapping_sub(digit) | *word >> (level + 1);
            }
        }
        let (scale, rest) = ((1u64 << digits) as f64, 64 - digits);
        for (sum, word) in table.iter_mut().zip(words) {
            *sum = if has_tails { unit(*word) * scale } else { whole(*word >> rest) };
        }
    }
}
