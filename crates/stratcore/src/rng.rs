//! Random numbers that have an address instead of a history.
//!
//! A number depends on (seed, pixel, sampler, N, trial, index, dimension) and on nothing else:
//! not on the order of calls, the thread, or what was drawn before. Two published functions
//! do it:
//!
//! * **Philox4x32-10** (Salmon, Moraes, Dror & Shaw, *Parallel Random Numbers: As Easy as
//!   1, 2, 3*, SC 2011) turns a [`StreamKey`] into a [`Stream`]. It is a bijection of its
//!   128-bit counter, so two keys of one seed never share all four words.
//! * **pcg3d** (Jarzynski & Olano, *Hash Functions for GPU Rendering*, JCGT 9(3), 2020) turns
//!   (index, stream) into three words: two coordinates of 48 bits. It is a handful of integer
//!   operations per point, which lets eight or sixteen points be drawn at once.

use crate::error::StudyError;
use crate::simd::BLOCK;

/// Names one stream of random numbers: same key, same numbers, on any thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct StreamKey {
    /// The study's seed.
    pub seed: u64,
    /// Pixel (x, y), each below [`StreamKey::MAX_PIXEL`]; (0, 0) for an integrand without pixels.
    pub pixel: [u32; 2],
    /// Which sampler draws: its [`stream_id`](crate::sampler::Sampler::stream_id).
    pub sampler: u8,
    /// Points in one estimate, below [`StreamKey::MAX_SAMPLES`].
    pub n_samples: u64,
    /// Which independent repeat.
    pub trial: u32,
}

/// Trials whose streams are made together: enough for vectors, and few are made in vain.
pub(crate) const TOGETHER: usize = 8;

impl StreamKey {
    /// Pixels per axis that can be addressed: 2^20.
    pub const MAX_PIXEL: u32 = 1 << 20;
    /// Points per estimate stay below this: 2^44.
    pub const MAX_SAMPLES: u64 = 1 << 44;

    /// Refuses a key whose parts do not fit their fields: two keys would share a stream.
    ///
    /// # Errors
    /// [`StudyError::Unaddressable`] names the part.
    pub fn check(&self) -> Result<(), StudyError> {
        let pixel = self.pixel[0].max(self.pixel[1]);
        if pixel >= Self::MAX_PIXEL {
            let (value, limit) = (pixel.into(), (Self::MAX_PIXEL - 1).into());
            return Err(StudyError::Unaddressable { what: "a pixel coordinate", value, limit });
        }
        if self.n_samples >= Self::MAX_SAMPLES {
            let (value, limit) = (self.n_samples, Self::MAX_SAMPLES - 1);
            return Err(StudyError::Unaddressable { what: "the sample count N", value, limit });
        }
        Ok(())
    }

    /// The stream of this key.
    pub fn stream(&self) -> Stream {
        let words = philox4x32_10(self.counter(), [self.seed as u32, (self.seed >> 32) as u32]);
        Stream::new(words)
    }

    /// The streams of L trials from `first` on.
    #[inline(always)]
    pub(crate) fn streams_of_trials<const L: usize>(&self, first: u32) -> [Stream; L] {
        let words = self.words_of_trials::<L>(first);
        std::array::from_fn(|l| Stream::new(words.map(|word| word[l])))
    }

    /// The words that the streams of L trials from `first` on are made of, each by trial.
    #[inline(always)]
    pub(crate) fn words_of_trials<const L: usize>(&self, first: u32) -> [[u32; L]; 4] {
        let base = Self { trial: 0, ..*self }.counter();
        // The trial's 32 bits lie across two words of the counter.
        let [a, b, c, d] = base.map(u64::from);
        let mut counter = [[a; L], [b; L], [c; L], [d; L]];
        let [_, low, high, _] = &mut counter;
        for (at, (low, high)) in (0..).zip(low.iter_mut().zip(high)) {
            let trial = first.wrapping_add(at);
            *low |= u64::from(trial << 24);
            *high |= u64::from(trial >> 8);
        }
        let mut key = [self.seed as u32, (self.seed >> 32) as u32];
        for _ in 0..10 {
            counter = philox_round(counter, key);
            key = philox_next_key(key);
        }
        counter.map(|word| word.map(|word| word as u32))
    }

    /// The 128-bit Philox counter: x (20 bits), y (20), trial (32), N (44), sampler (8), from
    /// the top. The last 4 bits are zero.
    pub(crate) fn counter(&self) -> [u32; 4] {
        debug_assert!(self.check().is_ok());
        let packed = u128::from(self.pixel[0]) << 108
            | u128::from(self.pixel[1]) << 88
            | u128::from(self.trial) << 56
            | u128::from(self.n_samples) << 12
            | u128::from(self.sampler) << 4;
        [packed as u32, (packed >> 32) as u32, (packed >> 64) as u32, (packed >> 96) as u32]
    }
}

/// One stream: random access to pairs of uniform coordinates, and two words for scrambling.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stream {
    /// The two words that go into every draw, even by construction: pcg3d's first step makes
    /// them odd, and an odd multiplier keeps the index's low bits alive.
    pub(crate) words: [u32; 2],
    /// 64 bits of their own for scrambles and permutations.
    pub(crate) scramble: u64,
}

impl Stream {
    fn new(words: [u32; 4]) -> Self {
        let scramble = u64::from(words[2]) | u64::from(words[3]) << 32;
        Self { words: [words[0], words[1]].map(Self::even), scramble }
    }

    #[inline(always)]
    pub(crate) fn even(word: u32) -> u32 {
        word & !1
    }

    /// A stream of its own for 64 bits of a scramble.
    #[inline(always)]
    pub(crate) fn of_bits(bits: u64) -> Self {
        Self::new([bits as u32, (bits >> 32) as u32, 0, 0])
    }

    /// Two coordinates in [0, 1), multiples of 2^-48: pair number `index` of the stream.
    pub fn pair(&self, index: u64) -> [f64; 2] {
        unit_pair(self.draw(index))
    }

    /// Overwrites `pairs`, row-major, fewer than 2^32 of them, with the pairs from index `first`
    /// on, each as `map` has it.
    #[inline(always)]
    pub(crate) fn fill<const FMA: bool>(&self, first: u64, pairs: &mut [f64], map: impl PairMap) {
        /// Pairs behind the last whole block are made so many at a time, the last ones with
        /// some to spare.
        const SHORT: usize = 16;
        let (pairs, _) = pairs.as_chunks_mut();
        // The stream changes where the index outgrows 32 bits.
        let before = (1 << 32) - (first & 0xffff_ffff);
        let split = usize::try_from(before).unwrap_or(usize::MAX).min(pairs.len());
        let (head, tail) = pairs.split_at_mut(split);
        for (mut first, run) in [(first, head), (first + before, tail)] {
            let (blocks, rest) = run.as_chunks_mut();
            for block in blocks {
                self.fill_block::<FMA, BLOCK>(first, block, map);
                first += BLOCK as u64;
            }
            for rest in rest.chunks_mut(SHORT) {
                let mut block = [[0.0; 2]; SHORT];
                self.fill_block::<FMA, SHORT>(first, &mut block, map);
                rest.copy_from_slice(&block[..rest.len()]);
                first += SHORT as u64;
            }
        }
    }

    /// Every `step`-th draw from number `first` on, `len` of them, each word by draw.
    #[inline(always)]
    pub(crate) fn draws(&self, first: u64, step: u32, len: usize, words: &mut [[u32; BLOCK]; 3]) {
        let [a, b, c] = words;
        let (a, b, c) = (&mut a[..len], &mut b[..len], &mut c[..len]);
        let [low, second, third] = self.arguments(first);
        if u64::from(low) + u64::from(step) * len as u64 <= 1 << 32 {
            for l in 0..len {
                let index = low.wrapping_add((l as u32).wrapping_mul(step));
                [a[l], b[l], c[l]] = pcg3d([index, second, third]);
            }
        } else {
            // The stream changes where the index outgrows 32 bits.
            for l in 0..len {
                [a[l], b[l], c[l]] = self.draw(first + l as u64 * u64::from(step));
            }
        }
    }

    /// A block of known length: its loops are straight lines of vectors. All words are drawn
    /// first, in vectors of twice as many lanes as numbers have.
    #[inline(always)]
    fn fill_block<const FMA: bool, const LEN: usize>(
        &self,
        first: u64,
        pairs: &mut [[f64; 2]; LEN],
        map: impl PairMap,
    ) {
        let [low, second, third] = self.arguments(first);
        let mut words = [[0; LEN]; 3];
        let [a, b, c] = &mut words;
        for (lane, ((a, b), c)) in (0..u32::MAX).zip(a.iter_mut().zip(b).zip(c)) {
            [*a, *b, *c] = pcg3d([low.wrapping_add(lane), second, third]);
        }
        let [a, b, c] = &words;
        let words = a.iter().zip(b).zip(c);
        let first = first as f64;
        for (lane, (pair, ((a, b), c))) in (0..u32::MAX).zip(pairs.iter_mut().zip(words)) {
            *pair = map.map::<FMA>(first + f64::from(lane), unit_pair([*a, *b, *c]));
        }
    }

    /// Three random words: draw number `index` of the stream.
    pub fn draw(&self, index: u64) -> [u32; 3] {
        pcg3d(self.arguments(index))
    }

    #[inline(always)]
    fn arguments(&self, index: u64) -> [u32; 3] {
        // An index beyond 32 bits moves to another stream; twice its high part stays even.
        let high = ((index >> 32) as u32).wrapping_mul(2);
        [index as u32, self.words[0], self.words[1].wrapping_add(high)]
    }

    /// 64 random bits for a scramble or a permutation, independent of the draws.
    pub fn scramble_bits(&self) -> u64 {
        self.scramble
    }
}

/// What a pair of a stream becomes before it is stored, in a [`Loop`](crate::simd::Loop).
pub(crate) trait PairMap: Copy {
    /// Of the pair and its index, a whole number.
    fn map<const FMA: bool>(self, index: f64, pair: [f64; 2]) -> [f64; 2];
}

/// Two numbers of 48 bits from three words.
#[inline(always)]
pub(crate) fn unit_pair([a, b, c]: [u32; 3]) -> [f64; 2] {
    // The bits of a number in [1, 2): cheaper to make than a whole number is to convert.
    let unit = |hi: u32, lo: u32| {
        f64::from_bits(0x3ff << 52 | u64::from(hi) << 20 | u64::from(lo) << 4) - 1.0
    };
    [unit(a, c & 0xffff), unit(b, c >> 16)]
}

/// Philox4x32-10: ten rounds, as published.
pub fn philox4x32_10(counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    let mut counter = counter.map(|word| [u64::from(word)]);
    for _ in 0..10 {
        counter = philox_round(counter, key);
        key = philox_next_key(key);
    }
    counter.map(|[word]| word as u32)
}

/// One round of L counters, each of their four words by counter. Words are the lower halves of
/// these numbers: vectors multiply those, and nothing has to be moved.
#[inline(always)]
fn philox_round<const L: usize>(counter: [[u64; L]; 4], key: [u32; 2]) -> [[u64; L]; 4] {
    const MULTIPLIER: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
    let mut out = [[0; L]; 4];
    for l in 0..L {
        let a = u64::from(MULTIPLIER[0]) * u64::from(counter[0][l] as u32);
        let b = u64::from(MULTIPLIER[1]) * u64::from(counter[2][l] as u32);
        out[0][l] = (b >> 32) ^ counter[1][l] ^ u64::from(key[0]);
        out[1][l] = b;
        out[2][l] = (a >> 32) ^ counter[3][l] ^ u64::from(key[1]);
        out[3][l] = a;
    }
    out
}

#[inline(always)]
fn philox_next_key(key: [u32; 2]) -> [u32; 2] {
    const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
    [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])]
}

/// pcg3d: three words in, three words out, as published.
#[inline(always)]
pub fn pcg3d(v: [u32; 3]) -> [u32; 3] {
    let lcg = |x: u32| x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let [mut x, mut y, mut z] = v.map(lcg);
    x = x.wrapping_add(y.wrapping_mul(z));
    y = y.wrapping_add(z.wrapping_mul(x));
    z = z.wrapping_add(x.wrapping_mul(y));
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    x = x.wrapping_add(y.wrapping_mul(z));
    y = y.wrapping_add(z.wrapping_mul(x));
    z = z.wrapping_add(x.wrapping_mul(y));
    [x, y, z]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn philox_matches_the_published_vectors() {
        // Random123's kat_vectors, "philox4x32 10".
        assert_eq!(
            philox4x32_10([0; 4], [0; 2]),
            [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]
        );
        assert_eq!(
            philox4x32_10([u32::MAX; 4], [u32::MAX; 2]),
            [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]
        );
        assert_eq!(
            philox4x32_10(
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0]
            ),
            [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]
        );
    }

    #[test]
    fn every_part_of_the_key_changes_the_stream() {
        let key = StreamKey { seed: 1, pixel: [2, 3], sampler: 4, n_samples: 5, trial: 6 };
        let others = [
            StreamKey { seed: 2, ..key },
            StreamKey { seed: 1 | 1 << 40, ..key },
            StreamKey { pixel: [3, 3], ..key },
            StreamKey { pixel: [2, 2], ..key },
            StreamKey { sampler: 5, ..key },
            StreamKey { n_samples: 6, ..key },
            StreamKey { trial: 7, ..key },
        ];
        for other in others {
            assert_ne!(key.stream(), other.stream(), "{other:?}");
        }
    }

    #[test]
    fn streams_of_many_trials_are_those_of_each() {
        let key = StreamKey { seed: 3 << 40, pixel: [9, 8], sampler: 7, n_samples: 6, trial: 5 };
        for first in [0, 250, 65_530, u32::MAX - 15] {
            let streams = key.streams_of_trials::<16>(first);
            for (stream, trial) in streams.into_iter().zip(first..=first + 15) {
                assert_eq!(stream, StreamKey { trial, ..key }.stream(), "trial {trial}");
            }
        }
    }

    #[test]
    fn keys_out_of_range_are_refused() {
        let key = StreamKey { seed: 0, pixel: [0, 0], sampler: 0, n_samples: 1, trial: 0 };
        assert!(StreamKey { pixel: [1 << 20, 0], ..key }.check().is_err());
        assert!(StreamKey { n_samples: 1 << 44, ..key }.check().is_err());
    }

    #[test]
    fn a_pair_is_a_pure_function_of_its_index() {
        let stream =
            StreamKey { seed: 9, pixel: [1, 1], sampler: 0, n_samples: 4, trial: 0 }.stream();
        let forward: Vec<_> = (0..100).map(|i| stream.pair(i)).collect();
        for i in (0..100).rev() {
            assert_eq!(stream.pair(i), forward[i as usize]);
        }
        assert_ne!(stream.pair(7), stream.pair(7 + (1 << 32)));
    }

    #[test]
    fn extreme_words_stay_in_range() {
        assert_eq!(unit_pair([0; 3]), [0.0; 2]);
        assert_eq!(unit_pair([u32::MAX; 3]), [1.0 - 2f64.powi(-48); 2]);
        assert_eq!(unit_pair([1 << 31, 0, 1 << 16]), [0.5, 2f64.powi(-48)]);
    }

    /// Pearson's chi-square over 16 x 16 cells of a million pairs in one stream, and over the
    /// first pair of a million streams. 255 degrees of freedom: mean 255, standard deviation
    /// 22.6; the bounds are 5.5 standard deviations away, one false alarm in 10^7.
    #[test]
    fn pairs_are_uniform_within_and_across_streams() {
        let chi_square = |pairs: &mut dyn Iterator<Item = [f64; 2]>| {
            let mut cells = vec![0f64; 256];
            let mut n = 0.0;
            for [u, v] in pairs {
                cells[(u * 16.0) as usize * 16 + (v * 16.0) as usize] += 1.0;
                n += 1.0;
            }
            cells.iter().map(|c| (c - n / 256.0).powi(2) / (n / 256.0)).sum::<f64>()
        };
        let key = StreamKey { seed: 1996, pixel: [0, 0], sampler: 0, n_samples: 1, trial: 0 };
        let stream = key.stream();
        let within = chi_square(&mut (0..1_000_000).map(|i| stream.pair(i)));
        let across =
            chi_square(&mut (0..1_000_000).map(|t| {
                StreamKey { trial: t % 1000, pixel: [t / 1000, 7], ..key }.stream().pair(0)
            }));
        for value in [within, across] {
            assert!((130.0..380.0).contains(&value), "{value}");
        }
    }
}
