//! How well a measured variance is known: its interval, and the noise and bias of its logarithm.
//!
//! For M trials of a population of excess kurtosis κ, Var(s²)/σ⁴ = 2/(M - 1) + κ/M, and s² is
//! close to a scaled chi-square with as many degrees of freedom as give it that variance (Box,
//! *Biometrika* 40, 1953). κ of one row is too noisy for an interval at any usual M, but the
//! rows of one study share it: it is pooled over them ([`pooled_noise`]). Where f takes two
//! values, single samples are Bernoulli trials and the binomial law is used instead.

use crate::variance::Moments;
use statrs::distribution::{Beta, ChiSquared, ContinuousCDF};

/// The law of a measured variance s² around the true one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Noise {
    /// The variance is computed, not sampled, or zero.
    None,
    /// s²/σ² is a chi-square of `dof` degrees of freedom over `dof`.
    ChiSquare {
        /// Degrees of freedom; M - 1 for normal trial means.
        dof: f64,
    },
    /// Each trial is one of two values.
    TwoValues {
        /// Trials that gave the rarer value.
        rarer: u64,
        /// Trials M.
        trials: u64,
    },
}

impl Noise {
    /// Variance of ln s². For two values that of ln q(1 - q) given the count, q under Jeffreys'
    /// prior.
    pub fn var_ln(&self) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::ChiSquare { dof } => Polygamma::of(0.5 * dof).trigamma,
            Self::TwoValues { rarer, trials } => {
                let (a, b) = jeffreys(rarer, trials);
                let trigamma = |x| Polygamma::of(x).trigamma;
                trigamma(a) + trigamma(b) - 4.0 * trigamma(a + b)
            }
        }
    }

    /// The logarithm of the variance without the bias of ln s²: ln s² is too low by
    /// ln(ν/2) - ψ(ν/2), about 1/ν, for ν degrees of freedom. `variance` is s² > 0.
    pub fn ln_variance(&self, variance: f64) -> f64 {
        match *self {
            Self::None => variance.ln(),
            Self::ChiSquare { dof } => variance.ln() + Polygamma::of(0.5 * dof).below_ln,
            Self::TwoValues { rarer, trials } => {
                let (a, b) = jeffreys(rarer, trials);
                let digamma = |x: f64| x.ln() - Polygamma::of(x).below_ln;
                let expected = digamma(a) + digamma(b) - 2.0 * digamma(a + b);
                squared_step(variance, rarer, trials).ln() + expected
            }
        }
    }

    /// Ends of the 95 % interval of the variance, of which s² is the measured value.
    pub fn ci95(&self, variance: f64) -> [f64; 2] {
        if variance == 0.0 {
            return [0.0; 2];
        }
        match *self {
            Self::None => [variance; 2],
            Self::ChiSquare { dof } => {
                let Ok(chi) = ChiSquared::new(dof) else { return [f64::NAN; 2] };
                [0.975, 0.025].map(|q| variance * dof / chi.inverse_cdf(q))
            }
            Self::TwoValues { rarer, trials } => {
                let (a, b) = jeffreys(rarer, trials);
                let Ok(beta) = Beta::new(a, b) else { return [f64::NAN; 2] };
                let [lo, hi] = [0.025, 0.975].map(|q| beta.inverse_cdf(q));
                let of_share = |q: f64| q * (1.0 - q);
                let most = if hi > 0.5 { 0.25 } else { of_share(hi) };
                let step = squared_step(variance, rarer, trials);
                // s², unbiased, may lie above the most that two values can vary.
                [step * of_share(lo).min(of_share(hi)), (step * most).max(variance)]
            }
        }
    }
}

/// Parameters of the share of the rarer value, given how often it was seen.
fn jeffreys(rarer: u64, trials: u64) -> (f64, f64) {
    (rarer as f64 + 0.5, trials.saturating_sub(rarer) as f64 + 0.5)
}

/// The squared difference of the two values, from s² and their counts.
fn squared_step(variance: f64, rarer: u64, trials: u64) -> f64 {
    let (c, m) = (rarer as f64, trials as f64);
    variance * m * (m - 1.0) / (c * (m - c))
}

/// The noise of each row (N, moments) of one sampler's study.
///
/// κ falls as 1/N where all strata matter alike, and as 1/√N where only those along an edge of
/// the plane do, being a sum over them. Each row's κ is therefore drawn to a trend
/// a/N + b/√N: the estimates G₂ are regressed on it with weights M/24 (their precision for
/// normal trials) and a normal prior of variance 1 on a and b; then the row's own deviation is
/// kept by the share t/(t + n), t = 1/4 and n = (24 + max(κ, 0)³)/M, for the estimate's noise
/// grows as κ³ where rare events make κ. With many trials each row speaks for itself, with ten
/// the trend does. The three constants were chosen by coverage over the pixel types of
/// METHOD.md, not by theory.
///
/// A row whose N = 1 and whose trials are two values is [`Noise::TwoValues`]. At larger N few
/// trials may show two of many possible values, so the rule is not used there; nor below five
/// trials, for any two numbers are two values.
pub fn pooled_noise(rows: &[(u64, Moments)]) -> Vec<Noise> {
    if rows.iter().all(|(_, moments)| is_noiseless(moments)) {
        return vec![Noise::None; rows.len()];
    }
    let kurtosis = pooled_kurtosis(rows);
    rows.iter().zip(kurtosis).map(|((n, moments), kurtosis)| noise(*n, moments, kurtosis)).collect()
}

/// Zero, or computed and not sampled.
fn is_noiseless(moments: &Moments) -> bool {
    moments.variance == 0.0 || moments.count == 0
}

fn noise(n: u64, moments: &Moments, kurtosis: f64) -> Noise {
    if is_noiseless(moments) {
        return Noise::None;
    }
    if n == 1
        && moments.count >= 5
        && let Some(rarer) = moments.rarer_of_two()
    {
        return Noise::TwoValues { rarer, trials: moments.count };
    }
    let m = moments.count as f64;
    let normal = 2.0 / (m - 1.0);
    // Two-point trials have the least variance there is; no interval should shrink to nothing
    // for an estimate that falls below even that.
    Noise::ChiSquare { dof: 2.0 / (normal + kurtosis / m).max(0.1 * normal) }
}

fn pooled_kurtosis(rows: &[(u64, Moments)]) -> Vec<f64> {
    const OWN: f64 = 0.25;
    let basis = |n: u64| [1.0 / n as f64, 1.0 / (n as f64).sqrt()];
    let known: Vec<_> = rows
        .iter()
        .map(|(n, moments)| (basis(*n), moments.count as f64, moments.excess_kurtosis()))
        .collect();
    // Normal equations of the ridge regression; the prior is the identity.
    let (mut aa, mut ab, mut bb, mut ya, mut yb) = (1.0, 0.0, 1.0, 0.0, 0.0);
    for ([a, b], count, own) in &known {
        let Some(kurtosis) = own else { continue };
        let weight = count / 24.0;
        aa += weight * a * a;
        ab += weight * a * b;
        bb += weight * b * b;
        ya += weight * a * kurtosis;
        yb += weight * b * kurtosis;
    }
    let determinant = aa * bb - ab * ab;
    let trend = [(ya * bb - yb * ab) / determinant, (yb * aa - ya * ab) / determinant];
    let pooled = |([a, b], count, own): ([f64; 2], f64, Option<f64>)| {
        let common = trend[0] * a + trend[1] * b;
        let noise = (24.0 + common.max(0.0).powi(3)) / count;
        common + OWN / (OWN + noise) * (own.unwrap_or(common) - common)
    };
    known.into_iter().map(pooled).collect()
}

/// The digamma and trigamma functions at x > 0.
struct Polygamma {
    /// ln x - ψ(x)
    below_ln: f64,
    /// ψ′(x)
    trigamma: f64,
}

impl Polygamma {
    /// Recurrence up to 8, then the asymptotic series (Abramowitz & Stegun 6.3.18, 6.4.12), to
    /// 1e-12 of each. The difference from the logarithm is what is wanted of ψ, so it is what is
    /// summed.
    fn of(x: f64) -> Self {
        let (mut at, mut sum, mut squares) = (x, 0.0, 0.0);
        while at < 8.0 {
            let inverse = 1.0 / at;
            sum += inverse;
            squares += inverse * inverse;
            at += 1.0;
        }
        if at > x {
            sum += (x / at).ln();
        }
        let r = 1.0 / at;
        let y = r * r;
        let of_psi = 1.0 / 12.0
            - y * (1.0 / 120.0
                - y * (1.0 / 252.0
                    - y * (1.0 / 240.0 - y * (1.0 / 132.0 - y * (691.0 / 32760.0)))));
        let of_slope = 1.0 / 6.0
            - y * (1.0 / 30.0
                - y * (1.0 / 42.0 - y * (1.0 / 30.0 - y * (5.0 / 66.0 - y * (691.0 / 2730.0)))));
        Self {
            below_ln: sum + 0.5 * r + y * of_psi,
            trigamma: squares + r + 0.5 * y + y * r * of_slope,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn polygamma_at_known_points() {
        const EULER: f64 = 0.577_215_664_901_532_9;
        // ψ(1) = -γ, ψ(1/2) = -γ - 2 ln 2, ψ(2) = 1 - γ.
        for (x, psi, slope) in [
            (1.0, -EULER, PI * PI / 6.0),
            (0.5, -EULER - 2.0 * 2f64.ln(), PI * PI / 2.0),
            (2.0, 1.0 - EULER, PI * PI / 6.0 - 1.0),
        ] {
            let found = Polygamma::of(x);
            assert!((found.trigamma / slope - 1.0).abs() < 1e-12, "{x}");
            assert!((found.below_ln / (x.ln() - psi) - 1.0).abs() < 1e-12, "{x}");
        }
        let far = Polygamma::of(1e6);
        assert!((far.trigamma * 1e6 - 1.0 - 0.5e-6).abs() < 1e-9);
        assert!((far.below_ln * 2e6 - 1.0).abs() < 1e-6);
        // Another implementation, on both sides of the border.
        for i in 1..400 {
            let x = 0.05 * f64::from(i);
            let other = x.ln() - statrs::function::gamma::digamma(x);
            assert!((Polygamma::of(x).below_ln / other - 1.0).abs() < 1e-9, "{x}");
        }
    }

    #[test]
    fn normal_interval_is_the_chi_square_one() {
        // 49 degrees of freedom: quantiles 31.555 and 70.222 (tables).
        let [lo, hi] = Noise::ChiSquare { dof: 49.0 }.ci95(1.0);
        assert!((lo - 49.0 / 70.222).abs() < 1e-4 && (hi - 49.0 / 31.555).abs() < 1e-4);
        assert_eq!(Noise::None.ci95(0.0), [0.0; 2]);
        assert_eq!(Noise::None.ci95(2.0), [2.0; 2]);
    }

    #[test]
    fn two_values_follow_the_binomial_law() {
        // 20 of 50: Jeffreys' 95 % interval of the share is 0.2723 to 0.5386 (Brown, Cai &
        // DasGupta's formula); the variance of a share beyond one half is at most 1/4.
        let noise = Noise::TwoValues { rarer: 20, trials: 50 };
        let s2 = 0.24 * 50.0 / 49.0;
        let [lo, hi] = noise.ci95(s2);
        assert!((lo - 0.2723 * 0.7277).abs() < 1e-3 && (hi - 0.25).abs() < 1e-12, "{lo} {hi}");
        // Var ln q(1-q) ≈ ((1-2q)/(q(1-q)))² q(1-q)/M = 0.0033 at q = 0.4, and more for curvature.
        assert!((0.003..0.006).contains(&noise.var_ln()), "{}", noise.var_ln());
        assert!((noise.ln_variance(s2) - 0.24f64.ln()).abs() < 0.05);
        let even = Noise::TwoValues { rarer: 25, trials: 50 };
        assert_eq!(even.ci95(0.25 * 50.0 / 49.0)[1], 0.25 * 50.0 / 49.0);
    }

    #[test]
    fn two_trials_of_anything_are_no_bernoulli_trials() {
        let rows = [(1, Moments::of(&[0.2, 0.7]))];
        assert_eq!(pooled_noise(&rows), [Noise::ChiSquare { dof: 1.0 }]);
        let rows = [(1, Moments::of(&[0.0, 1.0, 1.0, 0.0, 1.0]))];
        assert_eq!(pooled_noise(&rows), [Noise::TwoValues { rarer: 2, trials: 5 }]);
    }

    #[test]
    fn many_trials_speak_for_themselves_and_few_are_pooled() {
        let moments = |count, kurtosis| Moments {
            count,
            variance: 1.0,
            kurtosis,
            skewness: 0.3,
            ..Moments::default()
        };
        // One wild row among fifteen that look normal.
        let study = |count| -> Vec<(u64, Moments)> {
            (1..=16).map(|k| (k * k, moments(count, if k == 8 { 3.0 } else { -0.1 }))).collect()
        };
        let few = pooled_kurtosis(&study(10))[7];
        let many = pooled_kurtosis(&study(1_000_000))[7];
        assert!(few < 0.7, "{few}");
        assert!((many - 3.0).abs() < 0.01, "{many}");
    }

    #[test]
    fn a_rare_event_widens_the_rows_that_have_not_met_it() {
        let moments = |n: u64| Moments {
            count: 50,
            variance: 1.0,
            skewness: 6.0,
            kurtosis: 45.0 / n as f64,
            ..Moments::default()
        };
        let mut rows: Vec<_> = (1..=16).map(|k| (k * k, moments(k * k))).collect();
        rows[1].1.kurtosis = -0.5;
        let Noise::ChiSquare { dof } = pooled_noise(&rows)[1] else { unreachable!() };
        assert!(dof < 12.0, "{dof}");
    }
}
