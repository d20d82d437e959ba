//! Watching and stopping long work: the progress bar on standard error, and Ctrl-C.

use crate::cli::Common;
use anyhow::{Context, Result};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use stratcore::study::Control;

/// Set by the first Ctrl-C.
static CANCEL: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C (and a request to terminate) stop the work and keep what is finished; a second
/// one ends the process at once.
pub fn catch_interrupts() -> Result<()> {
    ctrlc::set_handler(|| {
        if CANCEL.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })
    .context("cannot catch Ctrl-C")
}

/// A progress bar with the time left. It is drawn only where standard error is a terminal, and
/// is gone when dropped.
pub struct Progress {
    bar: ProgressBar,
    advance: Box<dyn Fn(u64) + Sync>,
}

impl Progress {
    /// A bar for `total` samples.
    pub fn new(what: &'static str, total: u64, common: &Common) -> Self {
        let shown = !common.quiet && std::io::stderr().is_terminal();
        let target =
            if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(total), target).with_message(what);
        if let Ok(style) =
            ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} %, {eta} left")
        {
            bar.set_style(style);
        }
        let advanced = bar.clone();
        Self { bar, advance: Box::new(move |samples| advanced.inc(samples)) }
    }

    /// What a study needs to be watched by this bar and stopped by Ctrl-C.
    pub fn control(&self) -> Control<'_> {
        Control { cancel: &CANCEL, progress: &*self.advance, clock: None }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
