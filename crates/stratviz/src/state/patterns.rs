//! What the patterns page shows.

use serde::{Deserialize, Serialize};
use stratcore::discrepancy::Measure;

/// Point sets, and what is measured of them. The samplers are those of the studies.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PatternWords {
    /// The sampler whose set is seen, with its scramble after a plus sign.
    pub sampler: String,
    /// N of the set and of the spectra.
    pub n: u64,
    /// Dimensions of the points.
    pub dim: usize,
    /// The two that are seen.
    pub axes: [usize; 2],
    /// Whether every two of them are seen in place of one pair.
    pub all_pairs: bool,
    /// The trial that is seen.
    pub trial: u32,
    /// Sets that spectra and discrepancies are the means of.
    pub sets: u32,
    /// Discrepancy that is measured.
    pub measure: String,
    /// Sample counts that it is measured at; empty for the default of `stratcli discrepancy`.
    pub counts: String,
}

impl Default for PatternWords {
    fn default() -> Self {
        Self {
            sampler: "jittered".to_owned(),
            n: 256,
            dim: 2,
            axes: [0, 1],
            all_pairs: false,
            trial: 0,
            sets: 50,
            measure: "edge".to_owned(),
            counts: String::new(),
        }
    }
}

impl PatternWords {
    /// The fewest and the most dimensions that are offered.
    pub const DIMENSIONS: [usize; 2] = [2, 16];

    /// The same in so many dimensions: with axes that they have, and a discrepancy that is
    /// defined there.
    pub fn in_dim(mut self, dim: usize) -> Self {
        self.dim = dim;
        self.all_pairs &= dim > 2;
        if self.axes.iter().any(|axis| *axis >= dim) {
            self.axes = [0, 1];
        }
        let is_defined = |measure: Measure| measure.check(dim).is_ok();
        if self.measure.parse().is_ok_and(|measure| !is_defined(measure)) {
            self.measure = Measure::Centred.name().to_owned();
        }
        self
    }

    /// The pair of axes after this one, or before it: 0,1 then 0,2 and so on, the first after
    /// the last.
    pub fn axes_beside(&self, forward: bool) -> [usize; 2] {
        let pairs: Vec<_> = self.pairs().collect();
        let [i, j] = self.axes;
        let at = pairs.iter().position(|pair| *pair == [i.min(j), i.max(j)]).unwrap_or(0);
        let step = if forward { 1 } else { pairs.len() - 1 };
        pairs[(at + step) % pairs.len()]
    }

    /// Every two dimensions, the smaller first.
    fn pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        let dim = self.dim.max(2);
        (0..dim).flat_map(move |i| (i + 1..dim).map(move |j| [i, j]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_of_axes_comes_by_in_both_directions() {
        let mut words = PatternWords { axes: [2, 1], ..PatternWords::default().in_dim(4) };
        words.axes = [2, 1];
        let mut seen = Vec::new();
        for _ in 0..6 {
            words.axes = words.axes_beside(true);
            seen.push(words.axes);
        }
        assert_eq!(seen, [[1, 3], [2, 3], [0, 1], [0, 2], [0, 3], [1, 2]]);
        assert_eq!(words.axes_beside(false), [0, 3]);
    }

    #[test]
    fn fewer_dimensions_have_other_axes_and_measures() {
        let words = PatternWords { axes: [3, 1], all_pairs: true, ..PatternWords::default() };
        let three = words.clone().in_dim(4);
        assert_eq!(
            (three.axes, three.all_pairs, three.measure.as_str()),
            ([3, 1], true, "centred")
        );
        let two = three.in_dim(2);
        assert_eq!((two.axes, two.all_pairs), ([0, 1], false));
    }
}
