//! What was computed: everything that panels draw and nobody saves.

use crate::jobs::{Drawn, Loaded, MapUpdate, Patch, Seen, Studied, Traded};
use crate::state::Page;
use std::sync::Arc;
use std::time::Duration;
use stratcli::report::spectrum::SamplerSpectrum;
use stratcore::integrand::Regularity;
use stratcore::scene::Rgb;
use stratcore::study::{DiscrepancyCurve, SamplerResult, StudyResult};
use stratcore::trade::Choice;

/// Results, and what became of the work on them.
#[derive(Default)]
pub struct Model {
    /// The scene that is open.
    pub loaded: Option<Loaded>,
    /// The scene that is being loaded.
    pub loading: Option<String>,
    /// Why the last scene could not be opened.
    pub scene_fault: Option<String>,
    /// The picture so far.
    pub picture: Layer<Rgb>,
    /// How far the picture is.
    pub picture_progress: Progress,
    /// One study per pixel, in the order of `State::pixels`.
    pub studies: Vec<Study>,
    /// Exponents of the whole picture.
    pub map: Layer<Option<Studied>>,
    /// How far the map is.
    pub map_progress: Progress,
    /// The inside of the first pixel.
    pub seen: Option<Seen>,
    /// Why there is no inside.
    pub inside_fault: Option<String>,
    /// The study of the theory page.
    pub theory: Study,
    /// What is known of its integrand.
    pub regularity: Option<Regularity>,
    /// Error against time.
    pub trade: Piece<Traded>,
    /// The cheapest ways to the wanted error, by what was measured.
    pub ways: Option<Choice>,
    /// One set of the chosen sampler.
    pub drawn: Piece<Drawn>,
    /// Spectra of the studied samplers, as far as they are known.
    pub spectra: Piece<Vec<SamplerSpectrum>>,
    /// Discrepancies of the studied samplers, as far as they are known.
    pub discrepancy: Piece<Vec<DiscrepancyCurve>>,
    /// What was done last, in words.
    pub notice: Option<Notice>,
    /// CPU time of the UI thread from the beginning of one frame to that of the next.
    pub frame_times: FrameTimes,
}

impl Model {
    /// Stops of exposure that make the picture's brightest value white; none for a black one.
    pub fn exposure_of_brightest(&self) -> Option<f64> {
        let values = self.picture.cells.iter().flatten().copied();
        let brightest = values.filter(|value| value.is_finite()).fold(0.0, f64::max);
        (brightest > 0.0).then(|| (-brightest.log2()).clamp(-20.0, 20.0))
    }

    /// Whether anything is under way that [`Stop`](crate::command::Command::Stop) stops.
    pub fn is_busy(&self) -> bool {
        Page::ALL.iter().any(|(page, _)| self.is_busy_on(*page))
    }

    /// Whether anything that this page shows is under way.
    pub fn is_busy_on(&self, page: Page) -> bool {
        let studies = || self.studies.iter().any(|study| study.running);
        match page {
            Page::Pixel => studies(),
            Page::Theory => self.theory.running,
            Page::Trade => studies() || self.trade.progress.is_running(),
            Page::Patterns => {
                let pieces =
                    [&self.drawn.progress, &self.spectra.progress, &self.discrepancy.progress];
                pieces.iter().any(|piece| piece.is_running())
            }
        }
    }
}

/// How far a piece of background work is.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Progress {
    /// Not begun, or dropped.
    #[default]
    Idle,
    /// Under way; the share that is done.
    Running(f32),
    /// Stopped; the share that is done.
    Stopped(f32),
    /// Finished.
    Done,
    /// Impossible, and why.
    Failed(String),
}

impl Progress {
    /// Whether it is under way.
    pub fn is_running(&self) -> bool {
        matches!(self, Self::Running(_))
    }

    /// It is no longer wanted: what is finished stays.
    pub fn stop(&mut self) {
        if let Self::Running(share) = *self {
            *self = Self::Stopped(share);
        }
    }
}

/// A sentence about what was done.
#[derive(Debug, Clone, PartialEq)]
pub struct Notice {
    /// The sentence.
    pub text: String,
    /// Whether it tells of a fault.
    pub is_fault: bool,
}

/// Something that is computed as a whole, and what became of it.
#[derive(Debug, Clone)]
pub struct Piece<T> {
    /// The words of the command line that were planned.
    pub planned: Vec<String>,
    /// What was found so far.
    pub result: Option<T>,
    /// How far it is.
    pub progress: Progress,
}

impl<T> Default for Piece<T> {
    fn default() -> Self {
        Self { planned: Vec::new(), result: None, progress: Progress::Idle }
    }
}

impl<T> Piece<T> {
    /// Whether this is what `words` ask for: finished, under way, or stopped by hand.
    pub fn is_of(&self, words: &[String]) -> bool {
        self.planned == words && !matches!(self.progress, Progress::Idle | Progress::Failed(_))
    }

    /// Is about to be computed anew. What is there stays to be seen until something comes.
    pub fn begin(&mut self, words: Vec<String>) {
        self.planned = words;
        self.progress = Progress::Running(0.0);
    }
}

/// The study of one pixel or integrand.
#[derive(Debug, Clone, Default)]
pub struct Study {
    /// The pixel; `[0, 0]` for an integrand.
    pub pixel: [u32; 2],
    /// The result with the trials so far.
    pub result: Option<StudyResult>,
    /// Curves of samplers that were studied before and are no longer, each with its trials.
    pub kept: Vec<(SamplerResult, u32)>,
    /// Whether it is under way.
    pub running: bool,
    /// Whether it was stopped by hand.
    pub stopped: bool,
    /// Why there is none.
    pub fault: Option<String>,
    /// Time from the click to the first curve, on the worker's clock.
    pub first_curve: Option<Duration>,
    /// What kept curves share with the result: the planned words but samplers and trials.
    pub terms: String,
    /// The words of the command line that were planned.
    pub planned: Vec<String>,
    /// The half width of every p's interval at which it stops.
    pub until: f64,
}

impl Study {
    /// A study that is about to begin in place of this one. Curves of samplers that are not in
    /// `samplers` stay where the `terms` are the same, so that they can be compared.
    pub fn successor(&self, pixel: [u32; 2], samplers: &[String], terms: String) -> Self {
        let mut kept = Vec::new();
        if self.pixel == pixel && self.terms == terms {
            let result = self.result.iter();
            let curves = result.flat_map(|r| r.samplers.iter().map(move |s| (s.clone(), r.trials)));
            kept = curves.chain(self.kept.iter().cloned()).collect();
            kept.retain(|(curve, _)| !samplers.iter().any(|name| is_named(curve, name)));
        }
        Self { pixel, kept, running: true, terms, ..Self::default() }
    }
}

/// Whether a curve is that of the sampler which the command line calls `name`.
fn is_named(curve: &SamplerResult, name: &str) -> bool {
    stratcore::study::SamplerChoice::named(name).is_ok_and(|choice| {
        choice.sampler.name() == curve.name && choice.scramble == curve.scramble
    })
}

/// A picture's worth of cells that arrive coarse to fine.
#[derive(Debug, Clone, Default)]
pub struct Layer<T> {
    /// Width and height.
    pub size: [u32; 2],
    /// Row by row from the top left; shared with a job that writes them to a file.
    pub cells: Arc<Vec<T>>,
    /// The version in which each row was last changed.
    pub row_versions: Vec<u64>,
    /// Counts the changes, and never starts again.
    version: u64,
}

impl<T: Copy> Layer<T> {
    /// Begins anew with the same value everywhere.
    pub fn reset(&mut self, size: [u32; 2], value: T) {
        self.version += 1;
        self.size = size;
        self.cells = Arc::new(vec![value; size[0] as usize * size[1] as usize]);
        self.row_versions = vec![self.version; size[1] as usize];
    }

    /// The cell of a pixel.
    pub fn at(&self, [x, y]: [u32; 2]) -> Option<&T> {
        let inside = x < self.size[0] && y < self.size[1];
        inside.then(|| self.cells.get((y * self.size[0] + x) as usize)).flatten()
    }

    /// Puts values on squares of `step` pixels.
    fn put(&mut self, values: impl Iterator<Item = ([u32; 2], T)>, step: u32) {
        self.version += 1;
        let [width, height] = self.size;
        let cells = Arc::make_mut(&mut self.cells);
        for ([x, y], value) in values {
            for row in y..(y + step).min(height) {
                self.row_versions[row as usize] = self.version;
                let line = row as usize * width as usize;
                let right = (x + step).min(width);
                cells[line + x as usize..line + right as usize].fill(value);
            }
        }
    }
}

impl Layer<Rgb> {
    /// Adds a part of the picture.
    pub fn add(&mut self, patch: &Patch) {
        self.put(patch.pixels.iter().copied().zip(patch.colours.iter().copied()), patch.step);
    }
}

impl Layer<Option<Studied>> {
    /// Adds a part of the map.
    pub fn add(&mut self, update: &MapUpdate) {
        self.put(update.pixels.iter().map(|(at, studied)| (*at, Some(*studied))), update.step);
    }
}

/// The last frame times.
#[derive(Debug, Clone, Default)]
pub struct FrameTimes {
    times: std::collections::VecDeque<[Duration; 2]>,
}

impl FrameTimes {
    /// Frames that are remembered.
    const MOST: usize = 120;

    /// Adds a frame: what the panels took, and the whole with tessellation and painting.
    pub fn push(&mut self, times: [Duration; 2]) {
        self.times.push_back(times);
        if self.times.len() > Self::MOST {
            self.times.pop_front();
        }
    }

    /// The longest of those remembered: of the panels, and of the whole frame.
    pub fn longest(&self) -> Option<[Duration; 2]> {
        let longest = |part: usize| self.times.iter().map(|times| times[part]).max();
        Some([longest(0)?, longest(1)?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_cells_fill_squares_and_fine_ones_replace_them() {
        let mut layer = Layer::default();
        layer.reset([5, 3], 0);
        let version = layer.version;
        layer.put([([0, 0], 7), ([4, 2], 8)].into_iter(), 2);
        assert_eq!(*layer.cells, [7, 7, 0, 0, 0, 7, 7, 0, 0, 0, 0, 0, 0, 0, 8]);
        layer.put(std::iter::once(([1, 1], 9)), 1);
        assert_eq!(layer.at([1, 1]), Some(&9));
        assert_eq!(layer.at([5, 0]), None);
        assert_eq!(layer.row_versions, [version + 1, version + 2, version + 1]);
    }

    #[test]
    fn curves_stay_when_the_sampler_changes_and_go_when_the_terms_do() {
        let integrand = stratcore::integrand::by_name("disk", None, &[]).unwrap();
        let plan = stratcore::StudyPlan::paper();
        let control = stratcore::study::Control::unwatched();
        let result = stratcore::study(&*integrand, [1, 2], &plan, control).unwrap();
        let terms = || "seed 1".to_owned();
        let study =
            Study { pixel: [1, 2], result: Some(result), terms: terms(), ..Study::default() };
        let names = |study: &Study| study.kept.iter().map(|(s, _)| s.name).collect::<Vec<_>>();

        let samplers = ["jittered".to_owned(), "sobol".to_owned()];
        let next = study.successor([1, 2], &samplers, terms());
        assert_eq!(names(&next), ["random"]);
        assert_eq!(names(&next.successor([1, 2], &["random".to_owned()], terms())), [""; 0]);
        assert_eq!(names(&study.successor([1, 2], &samplers, "seed 2".to_owned())), [""; 0]);
        assert_eq!(names(&study.successor([1, 3], &samplers, terms())), [""; 0]);
    }
}
