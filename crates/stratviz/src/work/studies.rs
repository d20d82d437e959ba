//! Studies of pixels and of the theory page's integrand.

use super::{DIED, Work, traced};
use crate::jobs::{Standing, StudyJob, Subject, study_job};
use crate::line;
use crate::model::{Model, Study};
use crate::state::State;
use stratcore::integrand;

impl Work {
    /// Studies the pixels of the state, but those whose study is what is asked for: finished, under
    /// way, or stopped by hand.
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
                && before.fault.is_none();
            if unchanged {
                studies.push(before);
                continue;
            }
            let mut study = before.successor(pixel, &state.study.samplers, terms);
            study.planned = words;
            study.until = state.study.until;
            let channel = line::channel(&state.study.channel);
            let subject = Subject::Pixel { traced: traced.clone(), pixel, channel };
            // Times that are taken beside a study are worth nothing.
            self.stop_trade(model);
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
        if before.planned == words && before.until == state.study.until {
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

    pub(super) fn poll_studies(&mut self, model: &mut Model) {
        for (pixel, job) in &mut self.studies {
            if let Some(study) = model.studies.iter_mut().find(|study| study.pixel == *pixel) {
                receive(job, study);
            }
        }
        self.studies.retain(|(_, job)| job.standing() == Standing::Running);
        if let Some(job) = &mut self.theory {
            receive(job, &mut model.theory);
        }
    }
}

/// A study's words without its samplers and trials: what two curves must share to be compared.
fn terms(words: &[String]) -> String {
    line::without(words, &["--samplers", "--trials"]).join(" ")
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
