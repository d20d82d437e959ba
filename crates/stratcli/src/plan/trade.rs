//! What `trade` asks for.

use super::{duration_ns, pixel, study_plan, targets};
use crate::cli::{Common, TradeArgs};
use anyhow::{Context, Result, ensure};
use stratcore::map::Region;
use stratcore::scene::Scene;
use stratcore::study::StudyPlan;
use stratcore::trade::TradePlan;

/// The plan of a trade among integrands with `dim` dimensions.
pub fn trade_plan(args: &TradeArgs, common: &Common, dim: usize) -> Result<TradePlan> {
    Ok(TradePlan {
        study: study_plan(&args.protocol, common, dim)?,
        targets: targets(&args.targets)?,
        eval_cost: args.eval_cost.as_deref().map(duration_ns).transpose()?,
    })
}

/// The region that `--at` or `--region` names, up to but without its end, and the pixels of it
/// that are measured.
///
/// # Errors
/// What lies outside of the picture.
pub fn trade_pixels(args: &TradeArgs, scene: &Scene) -> Result<([u32; 4], Vec<[u32; 2]>)> {
    let [width, height] = scene.camera.resolution;
    let region = match (&args.at, &args.region) {
        (Some(at), _) => {
            let [x, y] = pixel(at)?;
            ensure!(
                x < width && y < height,
                "--at {at}: outside the picture of {}, which is {width} × {height}",
                scene.name
            );
            [x, y, x + 1, y + 1]
        }
        (None, Some(text)) => {
            let region: Region = text.parse().context("--region")?;
            region.check([width, height]).context("--region")?;
            region.into()
        }
        (None, None) => [0, 0, width, height],
    };
    Ok((region, lattice(region, args.lattice)))
}

/// Samples that measuring the errors takes.
///
/// # Errors
/// What the plan's samplers refuse.
pub fn trade_samples(plan: &StudyPlan, dim: usize, subjects: usize) -> Result<u64> {
    let per_trial = plan.counts_used(dim)?.iter().flatten().fold(0u64, |s, n| s.saturating_add(*n));
    Ok(per_trial.saturating_mul(plan.n_trials.into()).saturating_mul(subjects as u64))
}

/// At most `side` × `side` pixels, evenly over a region.
fn lattice([x0, y0, x1, y1]: [u32; 4], side: u32) -> Vec<[u32; 2]> {
    let along = |from: u32, to: u32| -> Vec<u32> {
        let (length, cells) = (to - from, side.min(to - from));
        let middle = |i: u32| (2 * u64::from(i) + 1) * u64::from(length) / (2 * u64::from(cells));
        (0..cells).map(|i| from + middle(i) as u32).collect()
    };
    let columns = along(x0, x1);
    along(y0, y1).into_iter().flat_map(|y| columns.iter().map(move |&x| [x, y])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_lies_evenly_in_its_region() {
        assert_eq!(lattice([3, 4, 4, 5], 16), [[3, 4]]);
        assert_eq!(lattice([0, 0, 3, 1], 16), [[0, 0], [1, 0], [2, 0]]);
        let cells = lattice([10, 20, 110, 220], 4);
        assert_eq!((cells.len(), cells[0], cells[15]), (16, [22, 45], [97, 195]));
    }
}
