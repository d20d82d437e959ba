//! Plans at random: whatever is asked for, the answer holds together or the fault is said.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use stratcore::integrand::{CATALOGUE, Integrand, by_name};
use stratcore::map::{Header, MapPlan, MapStudy, Region, Shard, TileLog, TileSet, expected_costs};
use stratcore::sampler::{CountPolicy, SHELF, count_used};
use stratcore::scene::{Channel, load};
use stratcore::study::{Control, SamplerChoice, StudyPlan, study, with_threads};
use stratcore::trace::{TracedScene, Tracer};
use stratcore::{StudyError, StudyResult};

type Random = Xoshiro256PlusPlus;

fn one_of<'a, T>(random: &mut Random, choices: &'a [T]) -> &'a T {
    &choices[random.random_range(0..choices.len())]
}

fn plan(random: &mut Random) -> StudyPlan {
    let choice = |random: &mut Random| {
        let sampler = *one_of(random, SHELF);
        SamplerChoice { sampler, scramble: *one_of(random, sampler.scrambles()) }
    };
    let count = |random: &mut Random| match random.random_range(0..4) {
        0 => random.random_range(1..=16_u64).pow(2),
        1 => 1 << random.random_range(0..8),
        2 => random.random_range(1..=200),
        _ => random.random_range(0..=4),
    };
    let mut counts: Vec<_> = (0..random.random_range(1..=6)).map(|_| count(random)).collect();
    counts.sort_unstable();
    counts.dedup();
    StudyPlan {
        samplers: (0..random.random_range(1..=3)).map(|_| choice(random)).collect(),
        counts,
        count_policy: *one_of(random, &[CountPolicy::Error, CountPolicy::Snap, CountPolicy::Rect]),
        n_trials: *one_of(random, &[0, 1, 2, 3, 5, 17, 50]),
        seed: random.random(),
    }
}

/// Results that were obtained, and faults.
#[derive(Default)]
struct Count {
    done: usize,
    refused: usize,
}

/// The study on one thread and on three, and all that should be true of it.
fn check(integrand: &dyn Integrand, pixel: [u32; 2], plan: &StudyPlan, count: &mut Count) {
    let run = |threads| -> Result<StudyResult, StudyError> {
        with_threads(Some(threads), || study(integrand, pixel, plan, Control::unwatched()))
    };
    let found = run(1);
    assert_eq!(found, run(3), "{plan:?}");
    let result = match found {
        Ok(result) => result,
        Err(error) => {
            let words = error.to_string();
            assert!(!words.is_empty() && !words.contains('\n'), "{words:?}");
            count.refused += 1;
            return;
        }
    };
    count.done += 1;
    let json = serde_json::to_string(&result).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["trials"], plan.n_trials);
    assert_eq!(result.samplers.len(), plan.samplers.len());
    for (sampler, choice) in result.samplers.iter().zip(&plan.samplers) {
        let rows: Vec<_> = sampler.rows.iter().map(|row| row.n).collect();
        assert_eq!(rows, plan.counts);
        for row in &sampler.rows {
            let used = count_used(choice.sampler, row.n, integrand.dim(), plan.count_policy);
            assert_eq!(used, Ok(row.n_used));
            let [lo, hi] = row.ci95();
            let variance = row.variance_of_mean;
            assert!(row.grand_mean.is_finite() && variance >= 0.0, "{row:?}");
            // Equal but for rounding where an interval has no width.
            let slack = 1e-9 * variance;
            assert!(lo <= variance + slack && variance - slack <= hi, "{row:?}: {lo} {hi}");
        }
        if let Some(fit) = sampler.fit {
            assert!(fit.exponent.is_finite() && fit.std_error >= 0.0, "{fit:?}");
        }
        assert_eq!(sampler.exact, sampler.rows.iter().all(|row| row.variance_of_mean == 0.0));
    }
}

#[test]
fn random_plans_on_integrands_hold_together() {
    let random = &mut Random::seed_from_u64(1);
    let mut count = Count::default();
    for _ in 0..400 {
        let info = one_of(random, CATALOGUE);
        let dim = random.random_range(1..=6);
        let params: Vec<_> = info
            .params
            .iter()
            .map(|param| (param.name.to_owned(), random.random_range(param.min..=param.max)))
            .collect();
        match by_name(info.name, Some(dim), &params) {
            Ok(integrand) => check(&*integrand, [0, 0], &plan(random), &mut count),
            Err(error) => assert!(error.to_string().contains("d = "), "{error}"),
        }
    }
    assert!(count.done > 50 && count.refused > 50, "{} {}", count.done, count.refused);
}

#[test]
fn random_plans_on_pixels_hold_together() {
    let random = &mut Random::seed_from_u64(2);
    let mut count = Count::default();
    for name in ["room", "room-lens", "room-all", "room-bounce"] {
        let mut traced = TracedScene::new(load(name).unwrap());
        for tracer in [Tracer::Beam, Tracer::Bvh] {
            traced = traced.with_tracer(tracer);
            let [width, height] = traced.scene().camera.resolution;
            for _ in 0..12 {
                let pixel = [random.random_range(0..width), random.random_range(0..height)];
                let channel = *one_of(random, &[Channel::Luminance, Channel::R, Channel::B]);
                let integrand = traced.pixel(pixel, channel);
                check(&integrand, pixel, &plan(random), &mut count);
            }
        }
    }
    assert!(count.done > 10 && count.refused > 10, "{} {}", count.done, count.refused);
}

/// Shards of any plan, merged, have the tiles of the whole.
#[test]
fn random_maps_are_their_shards() {
    let random = &mut Random::seed_from_u64(3);
    let scene = TracedScene::new(load("room").unwrap());
    let folder = tempfile::tempdir().unwrap();
    let mut maps = 0;
    while maps < 6 {
        let study = plan(random);
        let [x0, y0] = [random.random_range(0..150), random.random_range(0..150)];
        let region = Region { x0, y0, x1: x0 + random.random_range(1..70), y1: y0 + 2 };
        let plan = MapPlan { study, region, channel: Channel::Luminance, exact: false };
        let Ok(identity) = plan.identity(&scene) else { continue };
        maps += 1;
        let of = random.random_range(1..=3);
        let costs = expected_costs(&scene, &plan);
        let map = MapStudy::new(&scene, &plan).unwrap();
        let tile = |tile| map.tile(identity.tiling().tile(tile), Control::unwatched()).unwrap();
        let path = |index: u32| folder.path().join(format!("{maps}-{index}.tiles"));
        for index in 1..=of {
            let shard = Shard::new(index, of).unwrap();
            let header = Header { hash: identity.hash(), shard, plan: identity.clone() };
            let tiles = shard.tiles(&costs);
            let log = TileLog::open(&path(index), &header, tiles.len(), false).unwrap();
            tiles.iter().for_each(|at| log.append(*at, &tile(*at)).unwrap());
        }
        let merged = TileSet::merge(&(1..=of).map(path).collect::<Vec<_>>()).unwrap();
        for at in 0..identity.tiling().n_tiles() {
            assert_eq!(merged.read(at).unwrap(), tile(at), "{identity:?}");
        }
    }
}
