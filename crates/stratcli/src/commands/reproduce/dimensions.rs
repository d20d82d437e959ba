//! `reproduce --dimensions`: every combination of lens, area light and shutter, and filters.
//!
//! The files are written anew after each combination, so that Ctrl-C keeps what was finished.

use super::output::{create_folder, link_from_report, save_figure, write};
use crate::cli::{Common, ReproduceArgs};
use crate::commands::Outcome;
use crate::output::{json, note, print, print_json};
use crate::progress::Progress;
use crate::report::dimensions::{self, Document, PAGE, TITLE};
use crate::report::loglog;
use crate::report::page::{self, Figure};
use anyhow::Result;
use std::path::Path;
use stratcore::StudyError;
use stratcore::dimensions::{COMBINATIONS, FILTERED_SCENE, filters};
use stratcore::literature::Effort;
use stratcore::scene::load;
use stratcore::trace::TracedScene;

pub fn run(args: &ReproduceArgs, common: &Common) -> Result<Outcome> {
    let effort = if args.quick { Effort::Quick } else { Effort::Full };
    let quick = if args.quick { " --quick" } else { "" };
    let command = format!("stratcli reproduce --dimensions{quick} --seed {}", common.seed);
    let mut document = Document::new(command, common.seed, effort);
    let mut figures = Vec::new();
    create_folder(&args.out)?;
    write_all(&args.out, &document, &figures)?;
    let outcome = match measure(&args.out, common, &mut document, &mut figures) {
        Ok(()) if document.fails > 0 => Outcome::ExpectationFailed,
        Ok(()) => Outcome::Done,
        Err(error) if matches!(error.downcast_ref(), Some(StudyError::Cancelled)) => {
            note("interrupted: the combinations that were finished are kept");
            Outcome::Interrupted
        }
        Err(error) => return Err(error),
    };
    document.complete = outcome != Outcome::Interrupted;
    write_all(&args.out, &document, &figures)?;
    link_from_report(&args.out, PAGE, TITLE)?;
    if common.json {
        print_json(&document)?;
    } else {
        print(&format!("{}{}\n", dimensions::text(&document), args.out.join(PAGE).display()))?;
    }
    Ok(outcome)
}

fn measure(
    folder: &Path,
    common: &Common,
    document: &mut Document,
    figures: &mut Vec<Figure>,
) -> Result<()> {
    let progress = Progress::new("combinations", COMBINATIONS.len() as u64 + 1, common);
    let control = progress.control();
    for combination in COMBINATIONS {
        let scene = TracedScene::new(load(combination.scene)?);
        for table in combination.measure(&scene, document.seed, document.effort, control)? {
            let caption = table.figure.caption.clone();
            let svg = loglog::draw(&table.figure);
            figures.push(save_figure(folder, table.figure.name, caption, &svg)?);
            document.pixels.push(table);
        }
        document.judge();
        write_all(folder, document, figures)?;
        (control.progress)(1);
    }
    let scene = TracedScene::new(load(FILTERED_SCENE)?);
    document.filters = filters(scene, document.seed, document.effort, control)?;
    document.judge();
    (control.progress)(1);
    Ok(())
}

fn write_all(folder: &Path, document: &Document, figures: &[Figure]) -> Result<()> {
    let html = dimensions::render(document, figures, folder.join(page::NAME).exists());
    write(&folder.join(PAGE), html.as_bytes())?;
    write(&folder.join("dimensions.csv"), dimensions::csv(document).as_bytes())?;
    write(&folder.join("dimensions.json"), json(document)?.as_bytes())
}
