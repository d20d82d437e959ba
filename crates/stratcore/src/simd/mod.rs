//! Vector instructions, chosen at run time: the only module with `unsafe`.
//!
//! [`kernel`] holds the loops, on plain arrays. Here they are compiled once for each
//! instruction set and once without any: that plain twin is what tests compare with, and what
//! runs on a machine that has none of the others. All give the same bits.

#![expect(unsafe_code, reason = "calling a function compiled for a CPU feature is unsafe")]

mod kernel;
mod types;

use crate::rng::Stream;

pub(crate) use types::{
    Entry, Exact, Facet32, Ground, Lanes4, Pixel32, Rect, Shading, Strata, TrialStreams, Work,
};

/// An instruction set that this machine runs and for which the loops were compiled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Isa(Kind);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Baseline,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Isa {
    /// What the target has without asking: NEON on 64-bit ARM, SSE2 on x86-64.
    pub const BASELINE: Self = Self(Kind::Baseline);

    /// The best of this machine.
    pub fn detect() -> Self {
        Self::available().last().copied().unwrap_or(Self::BASELINE)
    }

    /// Those that this machine runs, the plain twin first and the best last.
    pub fn available() -> Vec<Self> {
        #[allow(unused_mut, reason = "other targets have the baseline alone")]
        let mut found = vec![Self::BASELINE];
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            found.push(Self(Kind::Avx2));
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
            {
                found.push(Self(Kind::Avx512));
            }
        }
        found
    }

    /// For reports: "avx2".
    pub fn name(self) -> &'static str {
        match self.0 {
            Kind::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => "avx512",
        }
    }
}

/// Declares one kernel for every instruction set: the same body, `inline(always)`, under
/// different target features.
macro_rules! compiled_for {
    ($module:ident, $features:literal, $lanes:literal) => {
        mod $module {
            use super::kernel::{self, Directional, Point, Polynomial, WideHeadlight};
            use super::{Pixel32, Shading, Strata, TrialStreams, Work};

            pub(super) const LANES: usize = $lanes;

            #[cfg_attr(target_arch = "x86_64", target_feature(enable = $features))]
            pub(super) fn strata_sums(
                pixel: &Pixel32,
                strata: &Strata,
                groups: &mut [TrialStreams<LANES>],
                work: &mut Work<'_>,
            ) {
                match pixel.ground.shading {
                    Shading::Polynomial => {
                        kernel::strata_sums::<Polynomial, LANES>(pixel, strata, groups, work);
                    }
                    Shading::WideHeadlight => {
                        kernel::strata_sums::<WideHeadlight, LANES>(pixel, strata, groups, work);
                    }
                    Shading::Directional => {
                        kernel::strata_sums::<Directional, LANES>(pixel, strata, groups, work);
                    }
                    Shading::Point => {
                        kernel::strata_sums::<Point, LANES>(pixel, strata, groups, work);
                    }
                }
            }
        }
    };
}

compiled_for!(baseline, "sse2", 8);
#[cfg(target_arch = "x86_64")]
compiled_for!(avx2, "avx2,fma", 8);
#[cfg(target_arch = "x86_64")]
compiled_for!(avx512, "avx512f,avx512vl,avx512dq,avx2,fma", 16);

/// Adds to `sums[t]` the values of the samples that trial t draws from `streams[t]`: one in
/// each stratum.
pub(crate) fn strata_sums(
    isa: Isa,
    pixel: &Pixel32,
    strata: &Strata,
    streams: &[Stream],
    work: &mut Work<'_>,
    sums: &mut [f64],
) {
    macro_rules! run {
        ($module:ident, $call:expr) => {{
            let mut groups: Vec<TrialStreams<{ $module::LANES }>> =
                streams.chunks($module::LANES).map(TrialStreams::new).collect();
            $call(&mut groups);
            for (sums, group) in sums.chunks_mut($module::LANES).zip(&groups) {
                for (sum, value) in sums.iter_mut().zip(&group.sum) {
                    *sum += value;
                }
            }
        }};
    }
    match isa.0 {
        // SAFETY: SSE2 is part of x86-64; elsewhere the function asks for no feature.
        #[cfg_attr(not(target_arch = "x86_64"), expect(unused_unsafe, reason = "no feature asked"))]
        Kind::Baseline => {
            run!(baseline, |g: &mut [_]| unsafe { baseline::strata_sums(pixel, strata, g, work) });
        }
        // SAFETY: `Kind::Avx2` is made by `Isa::available` alone, which saw the features.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx2 => {
            run!(avx2, |g: &mut [_]| unsafe { avx2::strata_sums(pixel, strata, g, work) })
        }
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx512 => {
            run!(avx512, |g: &mut [_]| unsafe { avx512::strata_sums(pixel, strata, g, work) });
        }
    }
}
