//! Point sets, and error against time: what is found as a whole.

use super::{Work, follow, traced};
use crate::jobs::{Traded, patterns, trade_job};
use crate::line;
use crate::model::Model;
use crate::state::State;
use stratcore::trade::Target;

impl Work {
    /// Draws, transforms and measures the sets of the patterns page, as far as that is not done
    /// or under way.
    pub fn patterns(&mut self, state: &State, model: &mut Model) {
        let (way, wake) = (&self.way, &self.wake);
        let words = line::points(state);
        if !model.drawn.is_of(&words) {
            model.drawn.begin(words.clone());
            self.drawn = Some(patterns::draw(move || line::points_plan(&words), wake.clone()));
        }
        let words = line::spectrum(state);
        if !model.spectra.is_of(&words) {
            model.spectra.begin(words.clone());
            model.spectra.result = None;
            let plan = move || line::spectra_plan(&words);
            self.spectra = Some(patterns::spectra(plan, way.clone(), wake.clone()));
        }
        let words = line::discrepancy(state);
        if !model.discrepancy.is_of(&words) {
            model.discrepancy.begin(words.clone());
            model.discrepancy.result = None;
            let plan = move || line::discrepancy_plan(&words);
            self.discrepancy = Some(patterns::discrepancy(plan, way.clone(), wake.clone()));
        }
    }

    /// Trades error for time, as the trade page says.
    pub fn trade(&mut self, state: &State, model: &mut Model) {
        let (Some(traced), Some(words)) = (traced(model), line::trade(state)) else { return };
        // Times are to be measured while nothing else runs.
        self.stop(model);
        model.trade.begin(words.clone());
        (model.trade.result, model.ways) = (None, None);
        let of_pixels = words.clone();
        let pixels = move |scene: &stratcore::trace::TracedScene| {
            line::trade_pixels(&of_pixels, scene.scene())
        };
        let plan_in = move |dim| line::trade_plan(&words, dim);
        self.trade = Some(trade_job(&traced, pixels, plan_in, &self.way, self.wake.clone()));
    }

    /// Finds the ways to the wanted error in what was measured.
    pub fn choose(&self, state: &State, model: &mut Model) {
        let Some(Traded { study, result, .. }) = &model.trade.result else { return };
        let wanted = state.study.error;
        let tried = result.choices.iter().find(|choice| choice.error == wanted).cloned();
        model.ways = Some(tried.unwrap_or_else(|| result.ways_to(Target::Absolute(wanted), study)));
    }

    /// Stops the trade.
    pub(super) fn stop_trade(&mut self, model: &mut Model) {
        self.trade = None;
        model.trade.progress.stop();
    }

    /// Stops studies, patterns and trades; what they found stays.
    pub fn stop(&mut self, model: &mut Model) {
        self.stop_studies(model);
        self.stop_trade(model);
        (self.drawn, self.spectra, self.discrepancy) = (None, None, None);
        for progress in [
            &mut model.drawn.progress,
            &mut model.spectra.progress,
            &mut model.discrepancy.progress,
        ] {
            progress.stop();
        }
    }

    pub(super) fn poll_patterns(&mut self, state: &State, model: &mut Model) {
        let drawn = &mut model.drawn;
        follow(&mut self.drawn, &mut drawn.progress, |set| drawn.result = Some(set));
        let spectra = &mut model.spectra;
        follow(&mut self.spectra, &mut spectra.progress, |update| {
            let known = spectra.result.get_or_insert_default();
            known.truncate(update.at);
            known.push(update.spectrum);
        });
        let discrepancy = &mut model.discrepancy;
        follow(&mut self.discrepancy, &mut discrepancy.progress, |curves| {
            discrepancy.result.get_or_insert_default().extend(curves);
        });
        let mut is_new = false;
        follow(&mut self.trade, &mut model.trade.progress, |traded| {
            (model.trade.result, is_new) = (Some(traded), true);
        });
        if is_new {
            self.choose(state, model);
        }
    }
}
