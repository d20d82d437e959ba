//! The jobs under way, and how what they send gets into the model.

use crate::export::{self, Export};
use crate::jobs::{
    InsideJob, Job, MapJob, PictureJob, PointsAsked, RightOfWay, SceneJob, Standing, StudyJob,
    Subject, TradeJob, Wake, WatchJob, inside, map, picture, scene, study_job, trade_job, watch,
};
use crate::line;
use crate::model::{Model, Notice, Progress, Study, Trade};
use crate::state::State;
use std::path::PathBuf;
use std::sync::Arc;
use stratcore::integrand;
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
    trade: Option<([u32; 2], TradeJob)>,
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
        model.trade = Trade::default();
    }

    /// Renders the picture from its beginning.
    pub fn render(&mut self, state: &State, model: &mut Model) {
        let Some(traced) = traced(model) else { return };
        let (way, wake) = (self.way.clone(), self.wake.clone());
        model.picture_progress = Progress::Running(0.0);
        self.picture =
            Some(picture::render(&traced, state.picture.spp, state.study.seed, way, wake));
    }

    /// Studies the pixels of the state, those that are not under way under the same terms.
    pub fn study(&mut self, state: &State, model: &mut Model) {
        let Some(traced) = traced(model) else { return };
        self.studies.retain(|(pixel, _)| state.pixels.contains(pixel));
        let mut studies = Vec::with_capacity(state.pixels.len());
        for &pixel in &state.pixels {
            let words = line::pixel(state, pixel, state.study.trials);
            let before = model.studies.iter().position(|study| study.pixel == pixel);
            let before = before.map(|at| model.studies.swap_remove(at)).unwrap_or_default();
            let terms = terms(&words);
            let unchanged = before.pixel == pixel
                && before.terms == terms
                && before.planned == words
                && before.until == state.study.until
                && before.fault.is_none()
                && !before.stopped;
            if unchanged {
                studies.push(before);
                continue;
            }
            let mut study = before.successor(pixel, &state.study.samplers, terms);
            study.planned = words;
            study.until = state.study.until;
            let channel = line::channel(&state.study.channel);
            let subject = Subject::Pixel { traced: traced.clone(), pixel, channel };
            self.studies.retain(|(other, _)| *other != pixel);
            self.studies.push((pixel, self.begin(subject, &study)));
            studies.push(study);
        }
        model.studies = studies;
    }

    /// Studies the integrand of the theory page.
    pub fn theory(&mut self, state: &State, model: &mut Model) {
        let theory = &state.theory;
        let words = line::integrand(theory, &state.study, state.study.trials);
        let before = &model.theory;
        if before.planned == words && before.until == state.study.until && !before.stopped {
            return;
        }
        let mut study = before.successor([0, 0], &state.study.samplers, terms(&words));
        study.planned = words;
        study.until = state.study.until;
        let params: Vec<_> =
            theory.params.iter().map(|(name, value)| (name.clone(), *value)).collect();
        let integrand = integrand::by_name(&theory.name, Some(theory.dim), &params);
        model.regularity = integrand.ok().map(|integrand| integrand.regularity());
        let subject = Subject::Integrand { name: theory.name.clone(), dim: theory.dim, params };
        self.theory = Some(self.begin(subject, &study));
        model.theory = study;
    }

    fn begin(&self, subject: Subject, study: &Study) -> StudyJob {
        let words = study.planned.clone();
        let plan_in = move |dim| line::study_plan(&words, dim);
        study_job(subject, plan_in, study.until, &self.way, self.wake.clone())
    }

    /// Stops the studies; what they found stays.
    pub fn stop_studies(&mut self, model: &mut Model) {
        self.studies.clear();
        self.theory = None;
        for study in model.studies.iter_mut().chain([&mut model.theory]) {
            study.stopped |= study.running;
            study.running = false;
        }
    }

    /// Trades error for time in the first pixel.
    pub fn trade(&mut self, state: &State, model: &mut Model) {
        let (Some(traced), Some(&pixel)) = (traced(model), state.pixels.first()) else { return };
        // Times are to be measured while nothing else runs.
        self.stop_studies(model);
        model.trade = Trade { running: true, ..Trade::default() };
        let words = line::trade(state, pixel);
        let plan_in = move |dim| line::study_plan(&words, dim);
        let subject = (pixel, line::channel(&state.study.channel));
        let (error, wake) = (state.study.error, self.wake.clone());
        self.trade = Some((pixel, trade_job(&traced, subject, plan_in, error, &self.way, wake)));
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
        let plan = line::study_plan(&line::map_pixel(state), 2);
        match plan {
            Ok(plan) => {
                let channel = line::channel(&state.study.channel);
                let (way, wake) = (self.way.clone(), self.wake.clone());
                model.map_progress = Progress::Running(0.0);
                self.map = Some(map::map(&traced, channel, plan, way, wake));
            }
            Err(fault) => model.map_progress = Progress::Failed(fault),
        }
    }

    /// Stops the map; what is finished stays.
    pub fn cancel_map(&mut self, model: &mut Model) {
        self.map = None;
        if let Progress::Running(share) = model.map_progress {
            model.map_progress = Progress::Stopped(share);
        }
    }

    /// Writes a file.
    pub fn save(&mut self, export: anyhow::Result<Export>, path: PathBuf) {
        self.saving = Some(Job::spawn("save", self.wake.clone(), move |reporter| {
            reporter.send(export::save(export, path));
        }));
    }

    /// Puts what came in into the model.
    pub fn poll(&mut self, model: &mut Model) -> Vec<Event> {
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
        for patch in take(&mut self.picture, || Err(DIED.to_owned())) {
            model.picture_progress = match patch {
                Ok(patch) => {
                    model.picture.add(&patch);
                    Progress::Running(patch.progress)
                }
                Err(fault) => Progress::Failed(fault),
            };
        }
        finish(&self.picture, &mut model.picture_progress);
        for update in take(&mut self.map, || Err(DIED.to_owned())) {
            model.map_progress = match update {
                Ok(update) => {
                    model.map.add(&update);
                    Progress::Running(update.progress)
                }
                Err(fault) => Progress::Failed(fault),
            };
        }
        finish(&self.map, &mut model.map_progress);
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
        if let Some((pixel, job)) = &mut self.trade {
            for measured in job.poll() {
                match measured {
                    Ok(trade) => model.trade.result = Some((*pixel, trade)),
                    Err(fault) => model.trade.fault = Some(fault),
                }
            }
            model.trade.running = job.standing() == Standing::Running;
            if job.standing() == Standing::Died {
                model.trade.fault = Some(DIED.to_owned());
            }
        }
        for (pixel, job) in &mut self.studies {
            if let Some(study) = model.studies.iter_mut().find(|study| study.pixel == *pixel) {
                receive(job, study);
            }
        }
        self.studies.retain(|(_, job)| job.standing() == Standing::Running);
        if let Some(job) = &mut self.theory {
            receive(job, &mut model.theory);
        }
        events
    }
}

fn traced(model: &Model) -> Option<Arc<TracedScene>> {
    model.loaded.as_ref().map(|loaded| loaded.traced.clone())
}

/// A study's words without its samplers and trials: what two curves must share to be compared.
fn terms(words: &[String]) -> String {
    let mut terms = Vec::new();
    let mut words = words.iter();
    while let Some(word) = words.next() {
        if matches!(word.as_str(), "--samplers" | "--trials") {
            words.next();
        } else {
            terms.push(word.as_str());
        }
    }
    terms.join(" ")
}

fn receive(job: &mut StudyJob, study: &mut Study) {
    for update in job.poll() {
        match update {
            Ok((result, time)) => {
                study.first_curve.get_or_insert(time);
                study.result = Some(result);
            }
            Err(fault) => study.fault = Some(fault),
        }
    }
    study.running = job.standing() == Standing::Running;
    if job.standing() == Standing::Died {
        study.fault = Some(DIED.to_owned());
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

fn finish<U: Send + 'static>(job: &Option<Job<U>>, progress: &mut Progress) {
    let is_done = job.as_ref().is_some_and(|job| job.standing() == Standing::Done);
    if is_done && matches!(progress, Progress::Running(_)) {
        *progress = Progress::Done;
    }
}
