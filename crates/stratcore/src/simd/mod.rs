//! Vector instructions, chosen at run time: the only module with `unsafe`.
//!
//! [`kernel`] holds the loops, on plain arrays. Here they are compiled once for each
//! instruction set and once without any: that plain twin is what tests compare with, and what
//! runs on a machine that has none of the others. All give the same bits.

#![expect(unsafe_code, reason = "calling a function compiled for a CPU feature is unsafe")]

mod kernel;
mod types;
mod vector;
#[cfg(target_arch = "x86_64")]
mod x86;

use crate::rng::Stream;

pub(crate) use types::{Entry, Facet32, Ground, Lanes4, Pixel32, Rect, Shading, Strata, Work};

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

/// Declares the kernels for one instruction set: the same bodies, `inline(always)`, under its
/// target features and with its vector.
macro_rules! compiled_for {
    ($module:ident, $features:literal, $vector:ty) => {
        mod $module {
            use super::kernel::{self, Directional, Group, Point, Polynomial, WideHeadlight};
            use super::vector::Vector;
            use super::{Pixel32, Shading, Strata, Stream, Work};

            #[cfg_attr(target_arch = "x86_64", target_feature(enable = $features))]
            pub(super) fn strata_sums(
                pixel: &Pixel32,
                strata: &Strata,
                streams: &[Stream],
                work: &mut Work<'_>,
                sums: &mut [f64],
            ) {
                type V = $vector;
                let mut groups: Vec<Group<V>> = streams.chunks(V::LANES).map(Group::new).collect();
                let g = &mut groups;
                match pixel.ground.shading {
                    Shading::Polynomial => {
                        kernel::strata_sums::<Polynomial, V>(pixel, strata, g, work);
                    }
                    Shading::WideHeadlight => {
                        kernel::strata_sums::<WideHeadlight, V>(pixel, strata, g, work);
                    }
                    Shading::Directional => {
                        kernel::strata_sums::<Directional, V>(pixel, strata, g, work);
                    }
                    Shading::Point => kernel::strata_sums::<Point, V>(pixel, strata, g, work),
                }
                for (sums, group) in sums.chunks_mut(V::LANES).zip(&groups) {
                    sums.copy_from_slice(&V::sum_store(group.sum)[..sums.len()]);
                }
            }
        }
    };
}

compiled_for!(baseline, "sse2", crate::simd::vector::Plain);
#[cfg(target_arch = "x86_64")]
compiled_for!(avx2, "avx2,fma", crate::simd::x86::Avx2);
#[cfg(target_arch = "x86_64")]
compiled_for!(avx512, "avx512f,avx512vl,avx512dq,avx2,fma", crate::simd::x86::Avx512);

/// Overwrites `sums[t]` with the sum over the samples that trial t draws from `streams[t]`: one
/// in each stratum.
pub(crate) fn strata_sums(
    isa: Isa,
    pixel: &Pixel32,
    strata: &Strata,
    streams: &[Stream],
    work: &mut Work<'_>,
    sums: &mut [f64],
) {
    match isa.0 {
        // SAFETY: SSE2 is part of x86-64; elsewhere the function asks for no feature.
        #[allow(unused_unsafe, reason = "safe to call where the feature is the target's own")]
        Kind::Baseline => unsafe { baseline::strata_sums(pixel, strata, streams, work, sums) },
        // SAFETY: `Kind::Avx2` is made by `Isa::available` alone, which saw the features.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx2 => unsafe { avx2::strata_sums(pixel, strata, streams, work, sums) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx512 => unsafe { avx512::strata_sums(pixel, strata, streams, work, sums) },
    }
}
