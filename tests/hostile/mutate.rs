//! A simple mutator: what hand and disk do to a file, and what a fuzzer would.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Numbers at which something begins or ends.
const NUMBERS: [&str; 26] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "7",
    "255",
    "256",
    "65536",
    "1048576",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967295",
    "4294967296",
    "8796093022208",
    "18446744073709551615",
    "1e15",
    "1.1e15",
    "1e308",
    "1e999",
    "1e-320",
    "nan",
    "inf",
    "0.1",
];

/// Mutations of a corpus: the same ones for the same seed.
pub struct Mutator<'a> {
    corpus: &'a [Vec<u8>],
    random: Xoshiro256PlusPlus,
    changes: usize,
}

impl<'a> Mutator<'a> {
    /// `corpus` has an entry; each mutation is up to so many changes to one.
    pub fn new(corpus: &'a [Vec<u8>], seed: u64, changes: usize) -> Self {
        Self { corpus, random: Xoshiro256PlusPlus::seed_from_u64(seed), changes }
    }

    /// The next input.
    pub fn next(&mut self) -> Vec<u8> {
        let mut data = self.entry().to_vec();
        for _ in 0..self.random.random_range(1..=self.changes) {
            self.change(&mut data);
            data.truncate(1 << 14);
        }
        data
    }

    fn entry(&mut self) -> &'a [u8] {
        &self.corpus[self.random.random_range(0..self.corpus.len())]
    }

    fn at(&mut self, data: &[u8]) -> usize {
        self.random.random_range(0..=data.len())
    }

    /// Two places, in order, mostly near one another.
    fn range(&mut self, data: &[u8]) -> std::ops::Range<usize> {
        let from = self.at(data);
        let reach = if self.random.random_bool(0.8) { 16 } else { data.len() };
        from..from + self.random.random_range(0..=(data.len() - from).min(reach))
    }

    fn change(&mut self, data: &mut Vec<u8>) {
        match self.random.random_range(0..10) {
            0 => {
                let at = self.at(data);
                if let Some(byte) = data.get_mut(at) {
                    *byte ^= 1 << self.random.random_range(0..8);
                }
            }
            1 => {
                let at = self.at(data);
                if let Some(byte) = data.get_mut(at) {
                    *byte = self.random.random();
                }
            }
            2 => drop(data.drain(self.range(data))),
            3 => {
                let (part, at) = (data[self.range(data)].to_vec(), self.at(data));
                data.splice(at..at, part);
            }
            // A part of another file, in place of one of this.
            4 => {
                let other = self.entry();
                let part = other[self.range(other)].to_vec();
                let place = self.range(data);
                data.splice(place, part);
            }
            // A line again, a few times, or elsewhere.
            5 => {
                let lines: Vec<_> = data.split_inclusive(|byte| *byte == b'\n').collect();
                if lines.is_empty() {
                    return;
                }
                let mut lines: Vec<_> = lines.into_iter().map(<[u8]>::to_vec).collect();
                let line = lines[self.random.random_range(0..lines.len())].clone();
                let times = if self.random.random_bool(0.1) { 40 } else { 1 };
                let at = self.random.random_range(0..=lines.len());
                lines.splice(at..at, std::iter::repeat_n(line, times));
                *data = lines.concat();
            }
            6 => {
                let mut lines: Vec<_> = data.split_inclusive(|byte| *byte == b'\n').collect();
                if !lines.is_empty() {
                    lines.remove(self.random.random_range(0..lines.len()));
                }
                *data = lines.concat();
            }
            _ => self.change_number(data),
        }
    }

    /// Another number in place of one.
    fn change_number(&mut self, data: &mut Vec<u8>) {
        let is_part = |byte: &u8| byte.is_ascii_digit() || b".+-".contains(byte);
        let starts: Vec<_> = (0..data.len())
            .filter(|&i| is_part(&data[i]) && (i == 0 || !is_part(&data[i - 1])))
            .collect();
        if starts.is_empty() {
            return;
        }
        let from = starts[self.random.random_range(0..starts.len())];
        let len = data[from..].iter().take_while(|byte| is_part(byte)).count();
        let number = match self.random.random_range(0..3) {
            0 => self.random.random_range(0..20).to_string(),
            1 => self.random.random_range(-4.0..4.0_f64).to_string(),
            _ => NUMBERS[self.random.random_range(0..NUMBERS.len())].to_owned(),
        };
        data.splice(from..from + len, number.into_bytes());
    }
}
