//! Inputs that follow the formats of today: a small map's tiles and summary.

use stratcore::map::{Header, MapPlan, MapStudy, Region, Shard, Tally, TileLog, read_tile};
use stratcore::scene::{Channel, load};
use stratcore::study::{Control, StudyPlan};
use stratcore::trace::TracedScene;

/// Valid inputs of the target; none for those whose corpus is written by hand.
pub fn of(target: &str) -> Vec<Vec<u8>> {
    match target {
        "tiles" => vec![map().0],
        "frames" => vec![map().1],
        "result" => vec![map().2],
        _ => Vec::new(),
    }
}

/// A file of tiles, the same as plan and numbers, and a summary.
fn map() -> (Vec<u8>, Vec<u8>, Vec<u8>) {
    let study = StudyPlan { counts: vec![1, 16], n_trials: 5, ..StudyPlan::paper() };
    let region = Region { x0: 70, y0: 60, x1: 72, y1: 61 };
    let plan = MapPlan { study, region, channel: Channel::Luminance, exact: false };
    let scene = TracedScene::new(load("room").expect("a built-in scene"));
    let identity = plan.identity(&scene).expect("a plan");
    let header = Header { hash: identity.hash(), shard: Shard::WHOLE, plan: identity };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.tiles");
    let log = TileLog::open(&path, &header, 1, false).expect("a new file");
    let study = MapStudy::new(&scene, &plan).expect("a plan");
    let moments = study.tile(region, Control::unwatched()).expect("a tile");
    log.append(0, &moments).expect("a writable file");
    let raw = std::fs::read(&path).expect("a file");

    let mut frames = serde_json::to_vec(&header.plan).expect("JSON");
    frames.extend(super::NEXT_FILE);
    frames.extend([0, moments.len() as u8]);
    for row in &moments {
        frames.extend(row.count.to_le_bytes());
        for number in [row.mean, row.variance, row.skewness, row.kurtosis] {
            frames.extend(number.to_le_bytes());
        }
    }

    let mut tally = Tally::new(&header.plan);
    for (at, pixel) in region.pixels().zip(read_tile(&header.plan, &moments)) {
        tally.add(at, &pixel);
    }
    let mut summary = serde_json::to_value(&header).expect("JSON");
    let numbers = serde_json::to_value(tally.summary()).expect("JSON");
    if let (Some(all), serde_json::Value::Object(more)) = (summary.as_object_mut(), numbers) {
        all.extend(more);
    }
    (raw, frames, summary.to_string().into_bytes())
}
