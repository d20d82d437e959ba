//! The jobs under way, and how what they send gets into the model.

mod patterns;
mod studies;

use crate::export::{self, Export};
use crate::jobs::{
    Drawn, InsideJob, Job, MapJob, PatternJob, PictureJob, PointsAsked, RightOfWay, SceneJob,
    SpectrumSoFar, Standing, StudyJob, TradeJob, Wake, WatchJob, inside, map, picture, scene,
    watch,
};
use crate::line;
use crate::model::{Model, Notice, Piece, Progress};
use crate::state::State;
use std::path::PathBuf;
use std::sync::Arc;
use stratcore::study::DiscrepancyCurve;
use stratcore::trace::TracedScene;

/// Everything that is being computed. A job that is replaced is cancelled.
pub struct Work {
    wake: Wake,
    way: RightOfWay,
    /// The scene that was asked for last, whether it could be opened or not.
    spec: String,
    scene: Option<SceneJob>,
    picture: Option<PictureJob>,
    studies: Vec<([u32; 2], StudyJob)>,
    map: Option<MapJob>,
    inside: Option<InsideJob>,
    theory: Option<StudyJob>,
    trade: Option<TradeJob>,
    drawn: Option<PatternJob<Drawn>>,
    spectra: Option<PatternJob<SpectrumSoFar>>,
    discrepancy: Option<PatternJob<Vec<DiscrepancyCurve>>>,
    saving: Option<Job<Result<String, String>>>,
    watch: Option<WatchJob>,
}

/// What the app has to do about something that came in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// Another scene is there.
    SceneLoaded,
    /// It could not be opened.
    SceneFailed,
    /// The scene's files have changed.
    FilesChanged,
}

/// Said where a worker panicked, which is a fault of the program.
const DIED: &str = "the computation broke off; this is a fault of the program, please report it";

impl Work {
    /// Nothing to do yet; `wake` is called whenever there is something to poll.
    pub fn new(wake: Wake) -> Self {
        Self {
            wake,
            way: RightOfWay::default(),
            spec: String::new(),
            scene: None,
            picture: None,
            studies: Vec::new(),
            map: None,
            inside: None,
            theory: None,
            trade: None,
            drawn: None,
            spectra: None,
            discrepancy: None,
            saving: None,
            watch: None,
        }
    }

    /// Loads a scene. What is on screen stays until the new one is there.
    pub fn load(&mut self, spec: &str, model: &mut Model) {
        model.loading = Some(spec.to_owned());
        model.scene_fault = None;
        self.spec = spec.to_owned();
        self.scene = Some(scene::load(spec, self.wake.clone()));
        self.watch = Some(watch::watch(spec, self.wake.clone()));
    }

    /// Loads the scene that was asked for last once more: its files may have been mended.
    pub fn reload(&mut self, model: &mut Model) {
        self.load(&self.spec.clone(), model);
    }

    /// Stops everything that belongs to the scene before.
    pub fn drop_scene(&mut self, model: &mut Model) {
        self.studies.clear();
        (self.picture, self.map, self.inside, self.trade) = (None, None, None, None);
        (model.map_progress, model.seen) = (Progress::Idle, None);
        (model.trade, model.ways) = (Piece::default(), None);
    }

    /// Renders the picture from its beginning.
    pub fn render(&mut self, state: &State, model: &mut Model) {
        let Some(traced) = traced(model) else { return };
        let (way, wake) = (self.way.clone(), self.wake.clone());
        model.picture_progress = Progress::Running(0.0);
        self.picture =
            Some(picture::render(&traced, state.picture.spp, state.study.seed, way, wake));
    }

    /// Looks into the first pixel.
    pub fn look_inside(&mut self, state: &State, model: &mut Model) {
        let (Some(traced), Some(&pixel)) = (traced(model), state.pixels.first()) else {
            (self.inside, model.seen) = (None, None);
            return;
        };
        let channel = line::channel(&state.study.channel);
        let asked = PointsAsked {
            pixel,
            channel,
            sampler: state.inside.sampler.clone(),
            n: state.inside.n,
            trial: state.inside.trial,
            seed: state.study.seed,
        };
        let known = model.seen.as_ref().filter(|seen| seen.shows(&asked));
        let known = known.map(|seen| seen.inside.clone());
        let (way, wake) = (self.way.clone(), self.wake.clone());
        self.inside = Some(inside::look(&traced, asked, known, way, wake));
    }

    /// Begins the map of the whole picture, or begins it anew.
    pub fn start_map(&mut self, state: &State, model: &mut Model) {
        let Some(traced) = traced(model) else { return };
        model.map.reset(traced.scene().camera.resolution, None);
        model.map_progress = Progress::Running(0.0);
        let channel = line::channel(&state.study.channel);
        let words = line::map_pixel(state);
        let plan_in = move |dim| line::study_plan(&words, dim);
        let (way, wake) = (self.way.clone(), self.wake.clone());
        self.map = Some(map::map(&traced, channel, plan_in, way, wake));
    }

    /// Stops the map; what is finished stays.
    pub fn cancel_map(&mut self, model: &mut Model) {
        self.map = None;
        model.map_progress.stop();
    }

    /// Writes a file.
    pub fn save(&mut self, export: anyhow::Result<Export>, path: PathBuf) {
        self.saving = Some(Job::spawn("save", self.wake.clone(), move |reporter| {
            reporter.send(export::save(export, path));
        }));
    }

    /// Puts what came in into the model.
    pub fn poll(&mut self, state: &State, model: &mut Model) -> Vec<Event> {
        let mut events = Vec::new();
        for loaded in take(&mut self.scene, || Err(DIED.to_owned())) {
            model.loading = None;
            match loaded {
                Ok(loaded) => {
                    model.loaded = Some(loaded);
                    events.push(Event::SceneLoaded);
                }
                Err(fault) => {
                    model.scene_fault = Some(fault);
                    events.push(Event::SceneFailed);
                }
            }
        }
        if self.watch.as_mut().is_some_and(|watch| !watch.poll().is_empty()) {
            events.push(Event::FilesChanged);
        }
        follow(&mut self.picture, &mut model.picture_progress, |patch| model.picture.add(&patch));
        follow(&mut self.map, &mut model.map_progress, |update| model.map.add(&update));
        self.poll_patterns(state, model);
        for seen in take(&mut self.inside, || Err(DIED.to_owned())) {
            match seen {
                Ok(seen) => (model.seen, model.inside_fault) = (Some(seen), None),
                Err(fault) => model.inside_fault = Some(fault),
            }
        }
        for saved in take(&mut self.saving, || Err(DIED.to_owned())) {
            let is_fault = saved.is_err();
            let text = saved.unwrap_or_else(|fault| fault);
            model.notice = Some(Notice { text, is_fault });
        }
        self.poll_studies(model);
        events
    }
}

fn traced(model: &Model) -> Option<Arc<TracedScene>> {
    model.loaded.as_ref().map(|loaded| loaded.traced.clone())
}

/// Adds what a job sent to what is known, and notes how far it is.
fn follow<U: Send + 'static>(
    job: &mut Option<Job<Result<U, String>>>,
    progress: &mut Progress,
    mut add: impl FnMut(U),
) {
    let Some(running) = job else { return };
    let is_news = running.standing() == Standing::Running;
    for update in running.poll() {
        match update {
            Ok(update) => add(update),
            Err(fault) => *progress = Progress::Failed(fault),
        }
    }
    if is_news && progress.is_running() {
        *progress = match running.standing() {
            Standing::Running => Progress::Running(running.share()),
            Standing::Done => Progress::Done,
            Standing::Died => Progress::Failed(DIED.to_owned()),
        };
    }
}

/// What a job sent; `died` stands for what a panic kept it from sending.
fn take<U: Send + 'static>(job: &mut Option<Job<U>>, died: impl Fn() -> U) -> Vec<U> {
    let Some(job) = job else { return Vec::new() };
    let was = job.standing();
    let mut updates = job.poll();
    if was == Standing::Running && job.standing() == Standing::Died {
        updates.push(died());
    }
    updates
}
