//! `reproduce --literature`: what is claimed of samplers, claim by claim, as a table.
//!
//! The files are written anew after each claim, so that Ctrl-C keeps what was finished.

use super::output::{create_folder, link_from_report, save_figure, write};
use crate::cli::{Common, ReproduceArgs};
use crate::commands::Outcome;
use crate::output::{json, note, print, print_json};
use crate::progress::Progress;
use crate::report::literature::{self, PAGE, TITLE, Table};
use crate::report::loglog;
use crate::report::page::{self, Figure};
use anyhow::{Context, Result};
use std::path::Path;
use stratcore::StudyError;
use stratcore::literature::{Claim, Effort, LiteratureError, by_id, claims};

pub fn run(args: &ReproduceArgs, common: &Common) -> Result<Outcome> {
    let chosen: Vec<&Claim> = if args.claims.is_empty() {
        claims().collect()
    } else {
        args.claims
            .iter()
            .map(|id| by_id(id.trim()))
            .collect::<Result<_, _>>()
            .context("--claims")?
    };
    let effort = if args.quick { Effort::Quick } else { Effort::Full };
    let mut table = Table::new(command(args, common), common.seed, effort);
    let mut figures = Vec::new();
    create_folder(&args.out)?;
    write_all(&args.out, &table, &figures)?;
    let outcome = measure(&chosen, effort, args, common, &mut table, &mut figures)?;
    table.complete = outcome != Outcome::Interrupted;
    write_all(&args.out, &table, &figures)?;
    link_from_report(&args.out, PAGE, TITLE)?;
    if common.json {
        print_json(&table)?;
    } else {
        print(&format!("{}{}\n", literature::text(&table), args.out.join(PAGE).display()))?;
    }
    Ok(outcome)
}

fn measure(
    chosen: &[&Claim],
    effort: Effort,
    args: &ReproduceArgs,
    common: &Common,
    table: &mut Table,
    figures: &mut Vec<Figure>,
) -> Result<Outcome> {
    let progress = Progress::new("claims", chosen.len() as u64, common);
    let control = progress.control();
    for claim in chosen {
        match claim.measure(common.seed, effort, control) {
            Ok(measured) => {
                for figure in &measured.figures {
                    let svg = loglog::draw(figure);
                    let caption = figure.caption.clone();
                    figures.push(save_figure(&args.out, figure.name, caption, &svg)?);
                }
                table.add(measured);
                write_all(&args.out, table, figures)?;
            }
            Err(LiteratureError::Study(StudyError::Cancelled)) => {
                note("interrupted: the claims that were finished are kept");
                return Ok(Outcome::Interrupted);
            }
            Err(error) => return Err(error).with_context(|| format!("claim {}", claim.id)),
        }
        (control.progress)(1);
    }
    Ok(if table.tally.fails > 0 { Outcome::ExpectationFailed } else { Outcome::Done })
}

fn command(args: &ReproduceArgs, common: &Common) -> String {
    let mut command = "stratcli reproduce --literature".to_owned();
    if args.quick {
        command += " --quick";
    }
    if !args.claims.is_empty() {
        command += &format!(" --claims {}", args.claims.join(","));
    }
    command + &format!(" --seed {}", common.seed)
}

fn write_all(folder: &Path, table: &Table, figures: &[Figure]) -> Result<()> {
    let html = literature::render(table, figures, folder.join(page::NAME).exists());
    write(&folder.join(PAGE), html.as_bytes())?;
    write(&folder.join("literature.csv"), literature::csv(table).as_bytes())?;
    write(&folder.join("literature.json"), json(table)?.as_bytes())
}
