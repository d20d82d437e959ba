//! `stability`: numerical extremes as a table, with what precision can be trusted and why.

use super::Outcome;
use super::reproduce::output::{create_folder, save_figure, write};
use crate::cli::{Common, StabilityArgs};
use crate::output::{json, note, print, print_json};
use crate::progress::Progress;
use crate::report::loglog;
use crate::report::page::Figure;
use crate::report::stability::{self, PAGE, Table};
use anyhow::{Context, Result};
use std::path::Path;
use stratcore::StudyError;
use stratcore::literature::Effort;
use stratcore::stability::{FAMILIES, Family, by_name};

pub fn run(args: &StabilityArgs, common: &Common) -> Result<Outcome> {
    let chosen = families(&args.only)?;
    let effort = if args.quick { Effort::Quick } else { Effort::Full };
    let mut table = Table::new(command(args, common), common.seed, effort);
    let mut figures = Vec::new();
    if let Some(folder) = &args.report {
        create_folder(folder)?;
        write_all(folder, &table, &figures)?;
    }
    let progress = Progress::new("families", chosen.len() as u64, common);
    let control = progress.control();
    let mut interrupted = false;
    for family in chosen {
        match family.measure(common.seed, effort, control) {
            Ok(measured) => {
                if let Some(folder) = &args.report {
                    for figure in &measured.figures {
                        let svg = loglog::draw(figure);
                        let caption = figure.caption.clone();
                        figures.push(save_figure(folder, figure.name, caption, &svg)?);
                    }
                }
                table.add(measured);
            }
            Err(StudyError::Cancelled) => {
                interrupted = true;
                break;
            }
            Err(error) => return Err(error).with_context(|| format!("family {}", family.name)),
        }
        (control.progress)(1);
        if let Some(folder) = &args.report {
            write_all(folder, &table, &figures)?;
        }
    }
    drop(progress);
    table.complete = !interrupted;
    let mut written = String::new();
    if let Some(folder) = &args.report {
        write_all(folder, &table, &figures)?;
        written = format!("{}\n", folder.join(PAGE).display());
    }
    if common.json {
        print_json(&table)?;
    } else {
        print(&(stability::text(&table) + &written))?;
    }
    if interrupted {
        note("interrupted: the families that were finished are kept");
        return Ok(Outcome::Interrupted);
    }
    Ok(if table.fails() > 0 { Outcome::ExpectationFailed } else { Outcome::Done })
}

fn families(names: &[String]) -> Result<Vec<&'static Family>> {
    if names.is_empty() {
        return Ok(FAMILIES.iter().collect());
    }
    let known = || FAMILIES.iter().map(|family| family.name).collect::<Vec<_>>().join(", ");
    names
        .iter()
        .map(|name| {
            by_name(name.trim()).with_context(|| {
                format!("--only: no family of extremes is called \"{name}\"; there are {}", known())
            })
        })
        .collect()
}

fn command(args: &StabilityArgs, common: &Common) -> String {
    let mut command = "stratcli stability".to_owned();
    if args.quick {
        command += " --quick";
    }
    if !args.only.is_empty() {
        command += &format!(" --only {}", args.only.join(","));
    }
    command + &format!(" --seed {}", common.seed)
}

fn write_all(folder: &Path, table: &Table, figures: &[Figure]) -> Result<()> {
    write(&folder.join(PAGE), stability::render(table, figures).as_bytes())?;
    write(&folder.join("stability.csv"), stability::csv(table).as_bytes())?;
    write(&folder.join("stability.json"), json(table)?.as_bytes())
}
