//! Counts in equal bins: quantiles of any number of values in little memory.

use serde::{Deserialize, Serialize};

/// Counts of values in equal bins.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Histogram {
    /// Where the first bin begins.
    pub lo: f64,
    /// Width of a bin.
    pub bin: f64,
    /// Values in each bin.
    pub counts: Vec<u64>,
    /// Values below the first bin.
    pub below: u64,
    /// Values in no bin above.
    pub above: u64,
}

impl Histogram {
    /// `n` empty bins from `lo` on.
    pub fn new(lo: f64, bin: f64, n: usize) -> Self {
        Self { lo, bin, counts: vec![0; n], below: 0, above: 0 }
    }

    /// Counts a value; one that is not a number is not counted.
    pub fn add(&mut self, value: f64) {
        let at = (value - self.lo) / self.bin;
        if at < 0.0 {
            self.below += 1;
        } else if let Some(count) = self.counts.get_mut(at as usize) {
            *count += u64::from(!at.is_nan());
        } else {
            self.above += 1;
        }
    }

    /// Number of values.
    pub fn n(&self) -> u64 {
        self.below + self.above + self.counts.iter().sum::<u64>()
    }

    /// The value that a share `q` of all lie below, as if values were even within a bin; none
    /// where there are no values, or where it lies outside the bins.
    pub fn quantile(&self, q: f64) -> Option<f64> {
        let mut left = q * self.n() as f64 - self.below as f64;
        if self.n() == 0 || left < 0.0 {
            return None;
        }
        for (i, &count) in self.counts.iter().enumerate() {
            if count > 0 && left <= count as f64 {
                return Some(self.lo + self.bin * (i as f64 + left / count as f64));
            }
            left -= count as f64;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_right_to_a_bin() {
        let mut histogram = Histogram::new(0.0, 0.1, 100);
        assert_eq!(histogram.quantile(0.5), None);
        (0..1000).for_each(|i| histogram.add(f64::from(i) * 0.005));
        for q in [0.1, 0.25, 0.5, 0.9] {
            assert!((histogram.quantile(q).unwrap() - 5.0 * q).abs() <= 0.1, "{q}");
        }
        for value in [-1.0, 11.0, f64::INFINITY, f64::NAN] {
            histogram.add(value);
        }
        assert_eq!((histogram.below, histogram.above, histogram.n()), (1, 2, 1003));
        assert_eq!(histogram.quantile(0.0), None);
        assert_eq!(histogram.quantile(1.0), None);
    }
}
