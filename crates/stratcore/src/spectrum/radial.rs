//! Spectra as functions of the distance from frequency zero.

use super::Spectrum;
use crate::variance::Moments;
use serde::Serialize;

/// Frequencies at about the same distance from zero.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Ring {
    /// Radius of the ring's middle, in the unit of the spectrum's step.
    pub frequency: f64,
    /// Mean power.
    pub power: f64,
    /// Standard error of that mean, from the scatter within the ring.
    pub std_error: f64,
    /// How far the power varies around the ring, s² / mean², in decibels. A spectrum that is
    /// the same in all directions reads -10 log₁₀ of its periodograms (0 for one): the
    /// scatter of periodograms alone.
    pub anisotropy_db: f64,
    /// Different frequencies in the ring; k and -k are one.
    pub frequencies: u32,
}

impl Spectrum {
    /// Rings of the width of one step (of the larger, if they differ), from the first around zero
    /// to the last that is whole. Rings with fewer than two frequencies are left out.
    ///
    /// Source: Ulichney, *Digital Halftoning*, 1987, "radially averaged power spectrum" and
    /// "anisotropy"; as used for point sets by Lagae & Dutré, *A comparison of methods for
    /// generating Poisson disk distributions*, 2008.
    pub fn radial(&self) -> Vec<Ring> {
        let width = self.step[0].max(self.step[1]);
        let reach = |axis: usize| ((self.size[axis].max(1) - 1) / 2) as f64 * self.step[axis];
        let n_rings = (reach(0).min(reach(1)) / width).round() as usize;
        let mut rings = vec![Vec::new(); n_rings + 1];
        let [columns, _] = self.size;
        for (i, power) in self.power.iter().enumerate() {
            let k = |index: usize, axis: usize| index as f64 - (self.size[axis] / 2) as f64;
            let [x, y] = [k(i % columns, 0), k(i / columns, 1)];
            // Of k and -k the one in the upper half.
            if y > 0.0 || y == 0.0 && x > 0.0 {
                let radius = (x * self.step[0]).hypot(y * self.step[1]) / width;
                if let Some(ring) = rings.get_mut(radius.round() as usize) {
                    ring.push(*power);
                }
            }
        }
        let filled = rings.iter().enumerate().filter(|(_, powers)| powers.len() >= 2);
        filled.map(|(i, powers)| Ring::new(i as f64 * width, powers)).collect()
    }
}

impl Ring {
    fn new(frequency: f64, powers: &[f64]) -> Self {
        let spread = Moments::of(powers);
        let (power, variance) = (spread.mean, spread.variance);
        Self {
            frequency,
            power,
            std_error: (variance / powers.len() as f64).sqrt(),
            anisotropy_db: 10.0 * (variance / (power * power)).log10(),
            frequencies: powers.len() as u32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Spectrum, of_points};
    use crate::discrepancy::test_points::{centred_grid, jittered, random};

    fn mean_of(sets: impl Iterator<Item = Vec<f64>>, cutoff: u32) -> Spectrum {
        Spectrum::mean(sets.map(|points| of_points(&points, 2, [0, 1], cutoff))).unwrap()
    }

    /// Powers of random points are exponential with mean 1; their mean over a ring of n
    /// frequencies and M sets has the error 1/√(nM). Five of them, over 24 rings: 10^-5.
    #[test]
    fn random_points_are_white_and_isotropic() {
        let trials = 40;
        let spectrum = mean_of((0..trials).map(|t| random(64, 2, t)), 24);
        assert_eq!(spectrum.periodograms(), trials);
        let rings = spectrum.radial();
        assert_eq!(rings.len(), 24);
        // (1, 0), (0, 1), (1, 1) and (-1, 1); the other four of radius 1 are their opposites.
        assert_eq!((rings[0].frequency, rings[0].frequencies), (1.0, 4));
        for ring in &rings {
            let sd = 1.0 / (f64::from(ring.frequencies) * f64::from(trials)).sqrt();
            assert!((ring.power - 1.0).abs() < 5.0 * sd, "{ring:?}");
        }
        // ln s² of n means of 40 exponentials scatters by √(2/n), a little more for their tails.
        let outer: Vec<_> = rings.iter().filter(|ring| ring.frequencies >= 40).collect();
        assert!(outer.len() > 10);
        for ring in outer {
            let scatter = 10.0 / 10f64.ln() * (2.4 / f64::from(ring.frequencies)).sqrt();
            let off = ring.anisotropy_db + 10.0 * f64::from(trials).log10();
            assert!(off.abs() < 5.0 * scatter, "{ring:?}");
        }
    }

    /// The offset of a jittered point in its cell is independent and uniform, so the mean power
    /// at k is 1 - sinc²(k_x/K) sinc²(k_y/K) for K × K cells.
    #[test]
    fn jittered_points_meet_their_closed_form() {
        let (cells, trials) = (8, 400u32);
        let spectrum = mean_of((0..trials).map(|t| jittered(cells, t)), 12);
        let sinc = |k: i64| {
            let x = std::f64::consts::PI * k as f64 / cells as f64;
            if k == 0 { 1.0 } else { x.sin() / x }
        };
        for y in 0..=12 {
            for x in -12..=12 {
                let expected = 1.0 - (sinc(x) * sinc(y)).powi(2);
                let found = spectrum.at([x, y]).unwrap();
                // About exponential: six errors of the mean, 25 × 13 times, is 10^-6. Off the
                // axes' multiples of K nothing vanishes.
                let bound = 6.0 * expected / f64::from(trials).sqrt();
                assert!((found - expected).abs() < bound || [x, y] == [0, 0], "{x} {y}: {found}");
            }
        }
    }

    #[test]
    fn a_comb_is_far_from_isotropic() {
        let rings = of_points(&centred_grid(5), 2, [0, 1], 12).radial();
        let tooth = rings.iter().find(|ring| ring.frequency == 5.0).unwrap();
        assert!(tooth.anisotropy_db > 5.0, "{tooth:?}");
    }
}
