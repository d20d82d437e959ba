//! Z1 and Z2: sampling for the screen, and on the integrands of rendering.

use super::LiteratureError;
use super::constants::range;
use super::finding::{Finding, Relation};
use super::lab::{Lab, integrand, powers, with_checks};
use super::nets::against;
use crate::integrand::Integrand;
use crate::rng::StreamKey;
use crate::sampler::{PointSet, Sampler, Scramble, Sobol, ZSobol};
use crate::spectrum::of_picture;
use crate::trial::trial_means;
use std::sync::atomic::Ordering;

type Outcome = Result<(), LiteratureError>;

pub(super) fn screen_space(lab: &mut Lab<'_>) -> Outcome {
    let counts = [4, 16, 64];
    for name in ["gaussian", "disk"] {
        let f = integrand(name, 2, &[])?;
        let checks = against(lab, &*f, ["zsobol+owen-hash", "sobol+owen-hash"], &counts)?;
        let case = format!("one pixel, {name}, {}", range(&counts));
        lab.push(with_checks(Finding::new(case, "variance / that of sobol", 1.0), checks));
    }
    let f = integrand("gaussian", 2, &[])?;
    for (sampler, name, expected) in
        [(&ZSobol as &dyn Sampler, "zsobol", 0.25), (&Sobol, "sobol, each pixel for itself", 1.0)]
    {
        let [power, error] = low_frequency_power(lab, &*f, sampler)?;
        let case = format!("error image of 64 × 64 pixels, N = 4, {name}");
        let finding = Finding::new(case, "power at |ν| ≤ 4 / mean power", expected);
        let finding = finding.measured(power, error);
        lab.push(if expected < 1.0 {
            finding.being(Relation::AtMost).noting("\"low\" is taken as a quarter of white noise")
        } else {
            finding.noting("white noise has the same power at every frequency")
        });
    }
    Ok(())
}

/// Power of an error image at low frequencies, over its mean power, and the standard error.
fn low_frequency_power(
    lab: &mut Lab<'_>,
    f: &dyn Integrand,
    sampler: &dyn Sampler,
) -> Result<[f64; 2], LiteratureError> {
    const SIDE: u32 = 64;
    const LOWEST: i64 = 4;
    let images = lab.either(10, 100);
    let key = lab.key();
    let mean = f.reference().map_or(f64::NAN, |r| r.mean);
    let mut ratios = Vec::new();
    for trial in 0..images {
        let mut image = Vec::with_capacity((SIDE * SIDE) as usize);
        for pixel in (0..SIDE * SIDE).map(|i| [i % SIDE, i / SIDE]) {
            // The picture's own seed: a pixel is a place on the screen here.
            let seed = key.stream().scramble_bits();
            let set = PointSet {
                key: StreamKey { seed, pixel, sampler: sampler.stream_id(), n_samples: 4, trial },
                dim: 2,
                scramble: Scramble::OwenHash,
                rectangular: false,
            };
            let mut estimate = [0.0];
            trial_means(f, sampler, &set, trial, &mut estimate, lab.control().cancel);
            image.push(estimate[0] - mean);
        }
        if lab.control().cancel.load(Ordering::Relaxed) {
            return Err(crate::StudyError::Cancelled.into());
        }
        let spectrum = of_picture(&image, SIDE as usize);
        // Half of the frequencies: an image of real numbers has the same power at ν and -ν.
        for (a, b) in (0..=LOWEST).flat_map(|a| (-LOWEST..=LOWEST).map(move |b| (a, b))) {
            if a * a + b * b <= LOWEST * LOWEST && (a > 0 || b > 0) {
                ratios.extend(spectrum.at([a, b]));
            }
        }
    }
    let count = ratios.len() as f64;
    let mean = ratios.iter().sum::<f64>() / count;
    let squares: f64 = ratios.iter().map(|r| (r - mean).powi(2)).sum();
    Ok([mean, (squares / (count - 1.0) / count).sqrt()])
}

pub(super) fn lattices(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(2, 4..=10);
    for (name, dim, params) in
        [("disk", 2, &[][..]), ("half-space", 2, &[]), ("form-factor", 4, &[("occluder", 0.5)])]
    {
        let f = integrand(name, dim, params)?;
        let checks = against(lab, &*f, ["rank1+torus-shift", "sobol+owen"], &counts)?;
        let count = checks.len() as f64;
        let mean = (checks.iter().map(|c| c.ratio.ln()).sum::<f64>() / count).exp();
        let variance: f64 = checks.iter().map(|c| (c.std_error / c.ratio).powi(2)).sum();
        let case = format!("rank1+torus-shift, {name}, d = {dim}, {}", range(&counts));
        let quantity = "variance / that of sobol+owen, geometric mean";
        let finding = Finding::new(case, quantity, 2.0).being(Relation::AtMost);
        let note = "\"on a par\" is taken as no worse than twice";
        lab.push(finding.measured(mean, mean * variance.sqrt() / count).noting(note));
    }
    Ok(())
}
