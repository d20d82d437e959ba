//! Vector instructions, chosen at run time: the only module with `unsafe`.
//!
//! The loops are written once for any vector, in functions that must stay `inline(always)`; a
//! closure over vectors in `array::map` or `fold` need not be inlined, and runs without the
//! instruction set if it is not.
//! Here they are compiled once for each instruction set and once without any: that plain twin
//! is what tests compare with, and what runs on a machine that has none of the others. All give
//! the same bits. On 64-bit ARM the twin is what the compiler makes of it with NEON; there is no
//! code by hand for it.
//!
//! `draw` makes the points of many trials at once. `dissect` cuts the pixel into rectangles and
//! tiles; `raster` draws facets into a tile's blocks, of which `columns` finds the facets near a
//! block and `strip` where they meet its strata; `crowd` samples a tile of many. `visible` finds
//! the nearest of several facets, `shader` its radiance. `strata` and `scatter` sum over samples
//! with strata and without.

#![expect(unsafe_code, reason = "calling a function compiled for a CPU feature is unsafe")]

mod cells;
mod columns;
mod crowd;
mod dissect;
mod draw;
mod fill;
mod raster;
mod scatter;
mod shader;
mod strata;
mod strip;
mod types;
mod vector;
mod visible;
#[cfg(target_arch = "x86_64")]
mod x86;

use draw::{Group, Spread};
use std::sync::OnceLock;

pub(crate) use cells::{Cells, Sorted};
pub(crate) use columns::Columns;
pub(crate) use draw::Trials;
pub(crate) use fill::{BLOCK, Divisor, Loop, run};
pub(crate) use scatter::{Anywhere, Scattered};
pub(crate) use types::{
    Entry, Exact, Facet32, Ground, Lanes4, Pixel32, Rect, Shading, Strata, Work,
};
pub(crate) use visible::{DOUBT, W_SLACK};

/// An instruction set that this machine runs and for which the loops were compiled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Isa(Kind);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Baseline,
    /// The plain twin in vectors of the greatest length, wherever the tests run.
    #[cfg(test)]
    Wide,
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
        static BEST: OnceLock<Isa> = OnceLock::new();
        *BEST.get_or_init(|| Self::available().last().copied().unwrap_or(Self::BASELINE))
    }

    /// Those that this machine runs, the plain twin first and the best last.
    pub fn available() -> Vec<Self> {
        #[allow(unused_mut, reason = "other targets have the baseline alone")]
        let mut found = vec![Self::BASELINE];
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt")
        {
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

    /// Those of [`Self::available`], and the plain twin in the widest vectors.
    #[cfg(test)]
    pub(crate) fn all() -> Vec<Self> {
        [Self(Kind::Wide)].into_iter().chain(Self::available()).collect()
    }

    /// For reports: "avx2".
    pub fn name(self) -> &'static str {
        match self.0 {
            Kind::Baseline => "baseline",
            #[cfg(test)]
            Kind::Wide => "wide",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => "avx512",
        }
    }
}

/// Calls a kernel, for one vector, with the shader of the pixel; a narrow headlight has two, of
/// which the polynomial keeps more digits.
macro_rules! shaded {
    ($vector:ty, $headlight:ty, $module:ident::$kernel:ident($pixel:expr $(, $argument:expr)*)) => {
        match $pixel.ground.shading {
            Shading::Headlight => $module::$kernel::<$headlight, $vector>($pixel $(, $argument)*),
            Shading::Polynomial => $module::$kernel::<Polynomial, $vector>($pixel $(, $argument)*),
            Shading::WideHeadlight => {
                $module::$kernel::<WideHeadlight, $vector>($pixel $(, $argument)*)
            }
            Shading::Directional => $module::$kernel::<Directional, $vector>($pixel $(, $argument)*),
            Shading::Point => $module::$kernel::<Point, $vector>($pixel $(, $argument)*),
        }
    };
}

/// Declares the kernels for one instruction set: the same bodies, `inline(always)`, under its
/// target features and with its vector.
macro_rules! compiled_for {
    ($module:ident, $features:literal, $vector:ty) => {
        mod $module {
            use super::scatter::{Anywhere, Scattered};
            use super::shader::{Directional, Headlight, Point, Polynomial, WideHeadlight};
            use super::{
                Cells, Exact, Group, Pixel32, Shading, Sorted, Spread, Strata, Trials, Work,
            };
            use super::{dissect, scatter, strata};
            use crate::simd::strata::{Drawn, Room};
            use std::cell::RefCell;

            type V = $vector;

            thread_local! {
                /// Room for trials, kept from call to call.
                static GROUPS: RefCell<Vec<Group<V>>> = const { RefCell::new(Vec::new()) };
                static ROOM: RefCell<Room<V>> = RefCell::default();
            }

            #[cfg_attr(target_arch = "x86_64", target_feature(enable = $features))]
            pub(super) fn strata_sums(
                pixel: &Pixel32,
                grid: &Strata,
                trials: &Trials<'_>,
                sums: &mut [f64],
                work: &mut Work,
                exact: Exact<'_>,
            ) {
                let mut all = GROUPS.take();
                let spread = groups(trials, sums.len(), &mut all);
                let next = |work: &mut Work| next_pieces(pixel, grid, work);
                let mut room = ROOM.take();
                let cancel = trials.cancel;
                let drawn = Drawn { groups: &mut all, room: &mut room, spread, cancel };
                shaded!(V, Headlight, strata::strata_sums(pixel, grid, drawn, work, next, exact));
                if !room.is_large() {
                    ROOM.set(room);
                }
                Group::store(&all, sums);
                GROUPS.set(all);
            }

            #[cfg_attr(target_arch = "x86_64", target_feature(enable = $features))]
            pub(super) fn scattered_sums(
                pixel: &Pixel32,
                samples: Anywhere<'_>,
                trials: &Trials<'_>,
                sums: &mut [f64],
                room: &mut Scattered,
                exact: Exact<'_>,
            ) {
                let mut all = GROUPS.take();
                groups(trials, sums.len(), &mut all);
                let cancel = trials.cancel;
                shaded!(
                    V,
                    Polynomial,
                    scatter::scattered_sums(pixel, samples, &mut all, room, exact, cancel)
                );
                Group::store(&all, sums);
                GROUPS.set(all);
            }

            #[cfg_attr(target_arch = "x86_64", target_feature(enable = $features))]
            pub(super) fn values_at(
                pixel: &Pixel32,
                cells: &Cells,
                positions: [&[f32]; 2],
                values: &mut [f32],
                sorted: &mut Sorted,
                exact: Exact<'_>,
            ) {
                shaded!(
                    V,
                    Polynomial,
                    scatter::values_at(pixel, cells, positions, values, sorted, exact)
                );
            }

            #[cfg_attr(target_arch = "x86_64", target_feature(enable = $features))]
            pub(super) fn cells(pixel: &Pixel32, per_axis: u32) -> Cells {
                Cells::new(pixel, per_axis, |grid, work| next_pieces(pixel, grid, work))
            }

            /// The same for all kernels: compiled once.
            #[cfg_attr(target_arch = "x86_64", target_feature(enable = $features))]
            #[inline(never)]
            fn groups(
                trials: &Trials<'_>,
                n: usize,
                groups: &mut Vec<Group<V>>,
            ) -> Option<Spread<V>> {
                Group::all(trials, n, groups)
            }

            /// Large, and the same for all shaders: compiled once.
            #[cfg_attr(target_arch = "x86_64", target_feature(enable = $features))]
            #[inline(never)]
            fn next_pieces(pixel: &Pixel32, grid: &Strata, work: &mut Work) -> bool {
                dissect::next_pieces::<V>(pixel, grid, work)
            }
        }
    };
}

compiled_for!(baseline, "sse2", crate::simd::vector::Plain<8>);
#[cfg(test)]
compiled_for!(wide, "sse2", crate::simd::vector::Plain<{ crate::simd::vector::MAX_LANES }>);
#[cfg(target_arch = "x86_64")]
compiled_for!(avx2, "avx2,fma,bmi1,bmi2,lzcnt,popcnt", crate::simd::x86::Avx2);
#[cfg(target_arch = "x86_64")]
compiled_for!(
    avx512,
    "avx512f,avx512vl,avx512dq,avx2,fma,bmi1,bmi2,lzcnt,popcnt",
    crate::simd::x86::Avx512
);

/// Calls a kernel in the form compiled for an instruction set.
macro_rules! dispatch {
    ($isa:expr, $kernel:ident($($argument:expr),*)) => {
        match $isa.0 {
            // SAFETY: SSE2 is part of x86-64; elsewhere the function asks for no feature.
            #[allow(unused_unsafe, reason = "safe to call where the feature is the target's own")]
            Kind::Baseline => unsafe { baseline::$kernel($($argument),*) },
            // SAFETY: likewise.
            #[cfg(test)]
            #[allow(unused_unsafe, reason = "safe to call where the feature is the target's own")]
            Kind::Wide => unsafe { wide::$kernel($($argument),*) },
            // SAFETY: `Kind::Avx2` is made by `Isa::available` alone, which saw the features.
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => unsafe { avx2::$kernel($($argument),*) },
            // SAFETY: `Kind::Avx512` likewise.
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => unsafe { avx512::$kernel($($argument),*) },
        }
    };
}

/// Overwrites `sums[t]` with the sum over the samples of trial t of `trials`: one in each
/// stratum. Once cancelled, what is written means nothing.
pub(crate) fn strata_sums(
    isa: Isa,
    pixel: &Pixel32,
    strata: &Strata,
    trials: &Trials<'_>,
    sums: &mut [f64],
    work: &mut Work,
    exact: Exact<'_>,
) {
    dispatch!(isa, strata_sums(pixel, strata, trials, sums, work, exact));
}

/// The same for samples that may lie anywhere.
pub(crate) fn scattered_sums(
    isa: Isa,
    pixel: &Pixel32,
    samples: Anywhere<'_>,
    trials: &Trials<'_>,
    sums: &mut [f64],
    room: &mut Scattered,
    exact: Exact<'_>,
) {
    dispatch!(isa, scattered_sums(pixel, samples, trials, sums, room, exact));
}

/// Overwrites `values` with those at positions (s, t) about the pixel's centre; `sorted` is room
/// for that.
pub(crate) fn values_at(
    isa: Isa,
    pixel: &Pixel32,
    cells: &Cells,
    positions: [&[f32]; 2],
    values: &mut [f32],
    sorted: &mut Sorted,
    exact: Exact<'_>,
) {
    dispatch!(isa, values_at(pixel, cells, positions, values, sorted, exact));
}

/// Asks memory for an item that will be read soon, if there is such an item. A hint: nothing
/// waits for it, and nothing depends on it.
#[inline(always)]
pub(crate) fn prefetch<T>(items: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let item = items.as_ptr().wrapping_add(index);
        // SAFETY: part of x86-64; any address may be asked for, it is not read.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(item.cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (items, index);
}

/// What fills each cell of a grid over the pixel.
pub(crate) fn cells(isa: Isa, pixel: &Pixel32, per_axis: u32) -> Cells {
    dispatch!(isa, cells(pixel, per_axis))
}
