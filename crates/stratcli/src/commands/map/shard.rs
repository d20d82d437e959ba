//! `--shard`

use anyhow::{Context, Result, ensure};
use stratcore::map::Shard;

/// `I/N`, or `slurm`: the task of a Slurm array that this process is.
pub fn read(text: &str) -> Result<Shard> {
    if text == "slurm" {
        return from_slurm(&|name| std::env::var(name).ok());
    }
    text.parse().context("--shard")
}

/// The array's tasks are numbered from its least in even steps; any other array would leave
/// shards out.
fn from_slurm(variable: &dyn Fn(&str) -> Option<String>) -> Result<Shard> {
    let number = |suffix: &str| -> Result<u32> {
        let name = format!("SLURM_ARRAY_TASK_{suffix}");
        let value = variable(&name).with_context(|| {
            format!("--shard slurm: {name} is not set; run it as a task of `sbatch --array`, or write I/N")
        })?;
        value.parse().with_context(|| format!("--shard slurm: {name} is \"{value}\", not a number"))
    };
    let (id, count, min, max) = (number("ID")?, number("COUNT")?, number("MIN")?, number("MAX")?);
    let step = match variable("SLURM_ARRAY_TASK_STEP") {
        Some(_) => number("STEP")?.max(1),
        None => 1,
    };
    let place = id.checked_sub(min).filter(|offset| offset % step == 0).map(|at| at / step);
    let is_whole = max.checked_sub(min).map(|span| span / step + 1) == Some(count);
    ensure!(
        is_whole && place.is_some(),
        "--shard slurm: task {id} is one of {count} between {min} and {max}: a part of an array, \
         which cannot tell how many shards there are; write I/N"
    );
    Ok(Shard::new(place.map_or(0, |at| at + 1), count)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(values: [&'static str; 4]) -> Result<Shard> {
        let names = ["ID", "COUNT", "MIN", "MAX"];
        from_slurm(&|name| {
            let at =
                names.iter().position(|suffix| name == format!("SLURM_ARRAY_TASK_{suffix}"))?;
            Some(values[at].to_owned()).filter(|value| !value.is_empty())
        })
    }

    #[test]
    fn a_task_of_a_whole_array_is_a_shard() {
        assert_eq!(array(["1", "8", "1", "8"]).unwrap(), Shard { index: 1, of: 8 });
        assert_eq!(array(["7", "8", "0", "7"]).unwrap(), Shard { index: 8, of: 8 });
    }

    #[test]
    fn a_task_of_anything_else_is_refused_with_the_way_out() {
        for values in [
            ["3", "2", "3", "7"],
            ["9", "8", "1", "8"],
            ["", "8", "1", "8"],
            ["x", "8", "1", "8"],
            ["0", "8", "1", "8"],
        ] {
            let error = format!("{:#}", array(values).unwrap_err());
            assert!(error.contains("--shard") || error.contains("I/N"), "{error}");
        }
    }
}
