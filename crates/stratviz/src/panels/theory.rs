//! Integrands with known answers: does theory hold?

use super::{curve, plot};
use crate::actions::{FEWER_DIMENSIONS, MORE_DIMENSIONS, Now};
use crate::command::Command;
use crate::state::{Page, TheoryWords};
use eframe::egui::{self, DragValue, RichText, Slider, Ui};
use stratcli::table::{short, with_error};
use stratcore::integrand::{CATALOGUE, IntegrandInfo, ParamInfo, Regularity};
use stratcore::study::SamplerResult;

/// Draws the theory page.
pub fn ui(ui: &mut Ui, now: &Now<'_>) -> Option<Command> {
    let Now { state, model, .. } = *now;
    let mut words = state.theory.clone();
    controls(ui, &mut words, model.regularity);
    let study = &model.theory;
    curve::heading(ui, &format!("{} in d = {}", state.theory.name, state.theory.dim), study);
    if let Some(result) = &study.result {
        if let Some(reference) = result.reference {
            let measured = result.samplers.last().and_then(|s| s.rows.last());
            let measured = measured.map_or_else(String::new, |row| {
                format!(", measured {:.6} with N = {}", row.grand_mean, row.n_used)
            });
            ui.label(format!("mean {:.6}{measured}", reference.mean));
        }
        for sampler in &result.samplers {
            let regularity = model.regularity.unwrap_or(Regularity::Unknown);
            if let Some(sentence) = sentence(sampler, result.dim, regularity) {
                ui.label(RichText::new(sentence).strong());
            }
        }
    }
    egui::Panel::bottom("theory exponents").resizable(true).default_size(150.0).show(ui, |ui| {
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            curve::exponents(ui, &[study], state.study.error);
        });
    });
    plot::ui(ui, "theory", &[study]);
    (words != state.theory).then_some(Command::SetTheory(words))
}

/// The parameter that makes an edge rough: its dimension k is d - 1 and this.
const ROUGHNESS: &str = "roughness";

fn controls(ui: &mut Ui, words: &mut TheoryWords, regularity: Option<Regularity>) {
    let info = |name: &str| CATALOGUE.iter().find(|info| info.name == name);
    ui.horizontal_wrapped(|ui| {
        let before = words.name.clone();
        egui::ComboBox::from_id_salt("integrand").selected_text(&words.name).show_ui(ui, |ui| {
            for info in CATALOGUE {
                let name = info.name.to_owned();
                ui.selectable_value(&mut words.name, name, info.name).on_hover_text(info.summary);
            }
        });
        let Some(info) = info(&words.name) else { return };
        if words.name != before {
            words.params.clear();
            words.dim = info.default_dim();
        }
        let label = ui.label("d");
        let [least, most] = TheoryWords::dimensions(info);
        let dims = ui.add(Slider::new(&mut words.dim, least..=most)).labelled_by(label.id);
        let hints = [MORE_DIMENSIONS, FEWER_DIMENSIONS].map(|action| action.hint(Page::Theory));
        dims.on_hover_text(hints.join("\n"));
        dimension_of_edge(ui, info, words, regularity);
        parameters(ui, info, words);
        ui.weak(info.summary);
    });
}

/// k: a control where the integrand leaves it open, else what is known of it.
fn dimension_of_edge(
    ui: &mut Ui,
    info: &IntegrandInfo,
    words: &mut TheoryWords,
    regularity: Option<Regularity>,
) {
    let Some(param) = info.params.iter().find(|param| param.name == ROUGHNESS) else {
        if let Some(Regularity::Discontinuous { discontinuity_dim }) = regularity {
            ui.label(format!("k = {}", short(discontinuity_dim, 4)));
        }
        return;
    };
    let flat = words.dim as f64 - 1.0;
    let before = flat + value_of(param, words);
    let mut k = before;
    let label = ui.label("k");
    let slider = Slider::new(&mut k, flat + param.min..=flat + param.max).step_by(0.05);
    ui.add(slider).labelled_by(label.id).on_hover_text("dimension of the edge");
    if k != before {
        // Written as people do, and so on the line that is copied.
        let roughness = (1000.0 * (k - flat)).round() / 1000.0;
        words.params.insert(param.name.to_owned(), roughness.clamp(param.min, param.max));
    }
}

fn value_of(param: &ParamInfo, words: &TheoryWords) -> f64 {
    words.params.get(param.name).copied().unwrap_or(param.default)
}

fn parameters(ui: &mut Ui, info: &IntegrandInfo, words: &mut TheoryWords) {
    for param in info.params.iter().filter(|param| param.name != ROUGHNESS) {
        let before = value_of(param, words);
        let mut value = before;
        let label = ui.label(param.name);
        let speed = (param.max - param.min).min(10.0) * 0.002;
        let control = DragValue::new(&mut value).range(param.min..=param.max).speed(speed);
        ui.add(control).labelled_by(label.id).on_hover_text(param.meaning);
        if value != before {
            words.params.insert(param.name.to_owned(), value);
        }
    }
}

/// Measured against predicted, for the samplers that theory speaks of.
fn sentence(sampler: &SamplerResult, dim: usize, regularity: Regularity) -> Option<String> {
    let (fit, predicted) = (sampler.fit?, sampler.predicted?);
    let measured = with_error(fit.exponent, fit.std_error);
    let formula = match (sampler.name, regularity) {
        ("jittered", Regularity::Discontinuous { discontinuity_dim: k }) => {
            format!("min(1 + 2/d, 2 - k/d) with d = {dim}, k = {}", short(k, 4))
        }
        ("jittered", Regularity::Smooth) => format!("1 + 2/d with d = {dim}"),
        ("random", _) => "1 in any dimension".to_owned(),
        _ => return None,
    };
    let name = sampler.name;
    Some(format!("{name}: p = {measured} against {} = {formula}", short(predicted, 4)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use stratcore::study::{Control, StudyPlan, study};

    #[test]
    fn the_formula_is_written_with_its_numbers() {
        let integrand = stratcore::integrand::by_name("step", Some(2), &[]).unwrap();
        let result = study(&*integrand, [0, 0], &StudyPlan::paper(), Control::unwatched()).unwrap();
        let sentences: Vec<_> =
            result.samplers.iter().filter_map(|s| sentence(s, 2, integrand.regularity())).collect();
        assert!(sentences[0].ends_with("against 1 = 1 in any dimension"), "{sentences:?}");
        assert!(
            sentences[1].ends_with("against 1.5 = min(1 + 2/d, 2 - k/d) with d = 2, k = 1"),
            "{sentences:?}"
        );
    }
}
