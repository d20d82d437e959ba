//! Where points must lie: in the cube, in their strata, in the elementary intervals of nets.

use crate::{Set, every_random_set, every_set};
use stratcore::sampler::{Admissible, SHELF, Scramble, by_name, strata_per_axis};

#[test]
fn coordinates_are_in_the_unit_interval_and_any_run_equals_the_whole() {
    for dim in [1, 2, 3, 5] {
        for n in [1, 13, 16, 150] {
            for set in every_set(n, dim) {
                let whole = set.points();
                assert!(whole.iter().all(|x| (0.0..1.0).contains(x)), "{set}");
                let n = set.n as usize;
                for (first, len) in [(0, 1), (n / 2, n - n / 2), (n / 3, n / 2), (n - 1, 1)] {
                    let run = set.fill(first as u64, len);
                    assert_eq!(run, whole[first * dim..(first + len) * dim], "{set} {first}");
                }
            }
        }
    }
}

/// The last points of the largest sets: products, tables and roundings at their extremes.
#[test]
fn the_largest_sets_end_inside_the_cube() {
    for sampler in SHELF {
        let admitted = [1 << 44, 1 << 32, 65_521 * 65_521, 1 << 24, 1 << 20, 4096, 1024, 64];
        let Some(n) = admitted.into_iter().map(|n: u64| n.min((1 << 44) - 1)).find(|n| {
            // Not a table of a thousand seconds.
            sampler.admits(*n, 2, false) && (sampler.name() != "annealed" || *n <= 64)
        }) else {
            panic!("{} has no large set", sampler.name());
        };
        for scramble in sampler.scrambles() {
            let set = Set::new(*sampler, *scramble, n, 2);
            let points = set.fill(n - 60, 60);
            assert!(points.iter().all(|x| (0.0..1.0).contains(x)), "{set}: {points:?}");
            // 32 meaningful bits: no two coordinates in 60 are equal, none is a multiple of
            // 2^-20; but for sets that are made of few coordinates.
            if !["grid"].contains(&sampler.name()) {
                for axis in 0..2 {
                    let mut axis: Vec<_> = points.iter().skip(axis).step_by(2).collect();
                    axis.sort_by(|a, b| a.total_cmp(b));
                    axis.dedup();
                    assert!(axis.len() >= 59, "{set}: {} different", axis.len());
                }
            }
        }
    }
}

/// What a sampler says of its N is what it does: a count that it has not lies between neighbours
/// that it has, with none nearer, and the words of `list samplers` name the largest.
#[test]
fn counts_are_as_stated() {
    let odd =
        [1 << 20, (1 << 31) + 1, 1 << 32, (1 << 32) + 1, (1 << 44) - 1, 1 << 44, u64::MAX - 1];
    for sampler in SHELF {
        let facts = sampler.facts();
        for dim in [1, 2, 3, 4, 5, 9, 64, 1024].into_iter().filter(|d| *d <= facts.max_dim) {
            for n in (0..200).chain(odd) {
                let what = format!("{} N = {n} d = {dim}", facts.name);
                let (below, above) = sampler.neighbours(n, dim);
                if !sampler.admits(n, dim, false) {
                    assert!(below.is_none_or(|b| b < n && sampler.admits(b, dim, false)), "{what}");
                    assert!(above.is_none_or(|a| a > n && sampler.admits(a, dim, false)), "{what}");
                    let nearer = (below.map_or(0, |b| b + 1)..n).rev().take(300);
                    assert!(nearer.into_iter().all(|n| !sampler.admits(n, dim, false)), "{what}");
                    let last = above.map_or(n, |a| a - 1);
                    let nearer = (n + 1..=last).take(300);
                    assert!(nearer.into_iter().all(|n| !sampler.admits(n, dim, false)), "{what}");
                }
            }
            if let Admissible::UpTo(most) = facts.counts
                && sampler.neighbours(0, dim).1.is_some()
            {
                assert!(sampler.admits(1, dim, true) && sampler.admits(most, dim, true));
                assert!(!sampler.admits(0, dim, true) && !sampler.admits(most + 1, dim, true));
            }
        }
        let words = facts.counts.to_string();
        assert!(!words.is_empty() && words.is_ascii(), "{}: {words}", facts.name);
    }
}

/// In many dimensions: coordinates in the cube, each of the axes with the mean 1/2. The mean over
/// M = 300 trials of a mean of N points has a standard error of its own; 5.5 of them, over some
/// 15,000 axes, are a false alarm for one seed in a thousand.
#[test]
fn many_dimensions_are_each_uniform() {
    const TRIALS: u32 = 300;
    for dim in [64, 1024] {
        for set in every_random_set(4, dim) {
            // An orthogonal array has too many points here.
            if set.n * dim as u64 > 1 << 17 || dim > 64 && set.scramble == Scramble::TorusShift {
                continue;
            }
            let mut sums = vec![[0.0; 2]; dim];
            for trial in 0..TRIALS {
                let points = Set { trial, ..set }.points();
                assert!(points.iter().all(|x| (0.0..1.0).contains(x)), "{set}");
                for (axis, sums) in sums.iter_mut().enumerate() {
                    let mean: f64 =
                        points.iter().skip(axis).step_by(dim).sum::<f64>() / set.n as f64;
                    sums[0] += mean;
                    sums[1] += mean * mean;
                }
            }
            let m = f64::from(TRIALS);
            for (axis, [sum, squares]) in sums.into_iter().enumerate() {
                let mean = sum / m;
                // A lattice is exact for a fold: no error but rounding.
                let error = ((squares / m - mean * mean).max(0.0) / (m - 1.0)).sqrt();
                let off = (mean - 0.5).abs();
                assert!(off < 5.5 * error + 1e-9, "{set}, axis {axis}: {mean} ± {error}");
            }
        }
    }
}

/// Asserts that each of `cells` holds `each` points; `cell` numbers them.
fn assert_filled(
    set: impl std::fmt::Display,
    cells: impl Iterator<Item = u64>,
    of: u64,
    each: u32,
) {
    let mut counts = vec![0; of as usize];
    for cell in cells {
        counts[cell as usize] += 1;
    }
    assert!(counts.iter().all(|count| *count == each), "{set}: {of} cells");
}

fn slab(x: f64, n: u64) -> u64 {
    (x * n as f64) as u64
}

#[test]
fn one_point_per_slab_on_every_axis() {
    let five =
        [("lhs", Scramble::None, 300), ("lhs", Scramble::None, 97), ("oa", Scramble::None, 169)];
    let two = [
        ("cmj", Scramble::None, 144),
        ("cmj", Scramble::None, 126),
        ("cmj", Scramble::None, 31),
        ("hammersley", Scramble::Owen, 128),
        ("hammersley", Scramble::DigitPermutation, 128),
    ];
    let choices = five.map(|c| (c, 5)).into_iter().chain(two.map(|c| (c, 2)));
    for ((sampler, scramble, n), dim) in choices {
        for trial in 0..20 {
            let set = Set { trial, ..Set::named(sampler, scramble, n, dim) };
            let points = set.points();
            for axis in 0..dim {
                let slabs = points.chunks(dim).map(|p| slab(p[axis], n));
                assert_filled(set, slabs, n, 1);
            }
        }
    }
}

#[test]
fn one_point_per_cell_of_the_grid() {
    for sampler in ["jittered", "cmj", "grid"] {
        for (n, dim) in [(144, 2), (126, 2), (31, 2), (25, 1)] {
            for trial in 0..20 {
                let set = Set { trial, ..Set::named(sampler, Scramble::None, n, dim) };
                let strata = strata_per_axis(n, dim);
                let points = set.points();
                let cells = points.chunks(dim).map(|p| {
                    p.iter().zip(&strata).rev().fold(0, |cell, (x, k)| cell * k + slab(*x, *k))
                });
                assert_filled(set, cells, n, 1);
            }
        }
    }
}

/// Each pair of axes fills its grid, a last axis its slabs, and no two pairs go together.
#[test]
fn padded_cells_fill_every_pair() {
    for (n, dim) in [(36, 2), (64, 4), (64, 5), (49, 3), (12, 5), (9, 1)] {
        for trial in 0..20 {
            let set = Set { trial, ..Set::named("jittered-padded", Scramble::None, n, dim) };
            let points = set.points();
            let [columns, rows] = [0, 1].map(|axis| strata_per_axis(n, 2)[axis]);
            for pair in 0..dim / 2 {
                let cells = points
                    .chunks(dim)
                    .map(|p| slab(p[2 * pair], columns) + columns * slab(p[2 * pair + 1], rows));
                assert_filled(set, cells, n, 1);
            }
            if dim % 2 == 1 {
                assert_filled(set, points.chunks(dim).map(|p| slab(p[dim - 1], n)), n, 1);
            }
        }
    }
}

/// Strength 2: each of the p × p cells of each pair of axes, up to the p + 1 axes there are.
#[test]
fn orthogonal_arrays_fill_every_plane() {
    for p in [2, 3, 5, 7, 11] {
        for dim in 2..=p as usize + 1 {
            let set = Set::named("oa", Scramble::None, p * p, dim);
            assert!(set.sampler.admits(p * p, dim, false));
            let points = set.points();
            for a in 0..dim {
                assert_filled(set, points.chunks(dim).map(|q| slab(q[a], p * p)), p * p, 1);
                for b in 0..a {
                    let cells = points.chunks(dim).map(|q| slab(q[a], p) * p + slab(q[b], p));
                    assert_filled(set, cells, p * p, 1);
                }
            }
        }
        assert!(!by_name("oa").unwrap().admits(p * p, p as usize + 2, false));
    }
    let oa = by_name("oa").unwrap();
    assert_eq!(oa.neighbours(30, 2), (Some(25), Some(49)));
    assert_eq!(oa.neighbours(30, 9), (None, Some(121)));
    assert_eq!(oa.neighbours(1 << 40, 2), (Some(65_521 * 65_521), None));
}

/// Asserts that `points` are a (t, m, d)-net in base 2: each elementary interval of volume
/// 2^(t - m) has 2^t points.
fn assert_net(set: Set, points: &[f64], dim: usize, t: u32) {
    let m = (points.len() / dim).ilog2();
    // All ways to share m - t halvings among the axes.
    let mut shapes = vec![Vec::new()];
    for axis in 0..dim {
        shapes = shapes
            .into_iter()
            .flat_map(|shape: Vec<u32>| {
                let rest = m.saturating_sub(t) - shape.iter().sum::<u32>();
                let range = if axis + 1 == dim { rest..=rest } else { 0..=rest };
                range.map(move |halvings| [shape.as_slice(), &[halvings]].concat())
            })
            .collect();
    }
    for shape in shapes {
        let cells = points.chunks(dim).map(|p| {
            p.iter()
                .zip(&shape)
                .fold(0, |cell, (x, halvings)| (cell << halvings) + slab(*x, 1 << halvings))
        });
        assert_filled(set, cells, 1 << m.saturating_sub(t), 1 << t.min(m));
    }
}

#[test]
fn sobol_points_are_nets_under_every_scramble() {
    let sobol = by_name("sobol").unwrap();
    for &scramble in sobol.scrambles().iter().filter(|s| **s != Scramble::TorusShift) {
        for (dim, t) in [(1, 0), (2, 0), (3, 1), (4, 3)] {
            for (n, aligned_run) in [(1, 1), (16, 16), (256, 64), (1024, 1024)] {
                let set = Set { trial: n as u32, ..Set::new(sobol, scramble, n, dim) };
                for run in set.points().chunks(aligned_run * dim) {
                    assert_net(set, run, dim, t);
                }
            }
        }
        // Deep trees: a set of 2^20 points, of which aligned runs are nets too.
        let set = Set::new(sobol, scramble, 1 << 20, 2);
        assert_net(set, &set.fill(77 << 12, 1 << 12), 2, 0);
    }
}

#[test]
fn two_dimensional_sequences_are_nets() {
    for n in [1, 2, 8, 64, 512] {
        for trial in 0..5 {
            let check = |sampler, scramble| {
                let set = Set { trial, ..Set::named(sampler, scramble, n, 2) };
                assert_net(set, &set.points(), 2, 0);
            };
            check("pmj02", Scramble::None);
            for scramble in [Scramble::Owen, Scramble::None] {
                check("hammersley", scramble);
            }
            for scramble in [Scramble::Owen, Scramble::OwenHash] {
                check("zsobol", scramble);
            }
            for scramble in [Scramble::Owen, Scramble::OwenHash, Scramble::XorShift] {
                check("padded", scramble);
            }
        }
    }
}

/// Every prefix of a power of two, and every aligned run, of one progressive sequence.
#[test]
fn pmj02_is_progressive() {
    let set = Set::named("pmj02", Scramble::None, 1024, 2);
    let points = set.points();
    for m in 0..=10 {
        for run in points.chunks(2 << m) {
            assert_net(set, run, 2, 0);
        }
    }
}

#[test]
fn every_pair_of_padded_axes_is_a_net() {
    for sampler in ["padded", "zsobol"] {
        for scramble in [Scramble::Owen, Scramble::OwenHash] {
            let set = Set::named(sampler, scramble, 256, 5);
            let points = set.points();
            for pair in 0..2 {
                let plane: Vec<_> =
                    points.chunks(5).flat_map(|p| [p[2 * pair], p[2 * pair + 1]]).collect();
                assert_net(set, &plane, 2, 0);
            }
            let line: Vec<_> = points.chunks(5).map(|p| p[4]).collect();
            assert_net(set, &line, 1, 0);
        }
    }
}

/// Aligned squares of pixels share a net, in every pair of dimensions.
#[test]
fn zsobol_squares_of_pixels_are_nets() {
    for scramble in [Scramble::Owen, Scramble::OwenHash] {
        for (n, side) in [(1, 4), (4, 2), (8, 8), (16, 4)] {
            let set = Set::named("zsobol", scramble, n, 4);
            for pair in 0..2 {
                let mut union = Vec::new();
                for y in 0..side {
                    for x in 0..side {
                        let pixel = [3 * side + x, 5 * side + y];
                        let points = Set { pixel, ..set }.points();
                        let plane = points.chunks(4).flat_map(|p| [p[2 * pair], p[2 * pair + 1]]);
                        union.extend(plane);
                    }
                }
                assert_net(set, &union, 2, 0);
            }
        }
    }
}

/// Runs of 2^a 3^b points of the Halton sequence, one in each 2^-a × 3^-b box.
#[test]
fn halton_boxes_are_filled() {
    for scramble in [Scramble::None, Scramble::Owen, Scramble::DigitPermutation] {
        for (a, b) in [(1, 1), (3, 2), (2, 4), (6, 1)] {
            let (columns, rows) = (u64::pow(2, a), u64::pow(3, b));
            let set = Set::named("halton", scramble, 3 * columns * rows, 2);
            for run in set.points().chunks(2 * (columns * rows) as usize) {
                // k/3^b is rounded: the least above keeps it in its own row.
                let cells =
                    run.chunks(2).map(|p| slab(p[0], columns) * rows + slab(p[1] + 1e-12, rows));
                assert_filled(set, cells, columns * rows, 1);
            }
        }
    }
}
