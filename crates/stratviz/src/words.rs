//! A result in a sentence.

use stratcli::table::number;
use stratcore::fit::samples_needed;
use stratcore::study::{SamplerResult, StudyResult};
use stratcore::theory::Class;

/// What kind of pixel it is, what stratification gains there, and what an error of `error`
/// costs: "An edge: ...".
pub fn verdict(result: &StudyResult, error: f64) -> String {
    if result.samplers.iter().all(|sampler| sampler.exact) {
        return "Constant: every estimate is exact, so one sample is enough.".to_owned();
    }
    let jittered = result.samplers.iter().find(|s| s.class.is_some());
    let mut text = match jittered {
        Some(sampler) => {
            let class = kind(sampler, result.dim);
            let mut letters = class.chars();
            letters.next().map_or_else(String::new, |first| {
                first.to_uppercase().collect::<String>() + letters.as_str()
            }) + "."
        }
        None => "Add the sampler jittered to learn what kind of pixel this is.".to_owned(),
    };
    if let Some(cost) = cost(result, error) {
        text += " ";
        text += &cost;
    }
    text
}

fn kind(sampler: &SamplerResult, dim: usize) -> String {
    let gain = |class: Class| match class.predicted_exponent(dim).map_or(0.0, |p| p - 1.0) {
        0.0 => "no power of N".to_owned(),
        0.5 => "√N".to_owned(),
        1.0 => "N".to_owned(),
        power => format!("N^{}", stratcli::table::short(power, 3)),
    };
    let perhaps = if sampler.class_is_sure { "" } else { "perhaps " };
    match sampler.class {
        Some(class @ Class::Smooth) => {
            format!(
                "{perhaps}smooth: the variance under jittered is {} times below random",
                gain(class)
            )
        }
        Some(class @ Class::Edge) => {
            format!(
                "{perhaps}an edge: the variance under jittered is {} times below random",
                gain(class)
            )
        }
        Some(Class::Complex) => {
            format!(
                "{perhaps}complex: detail finer than the strata, where jittered gains {}",
                gain(Class::Complex)
            )
        }
        Some(Class::Exact) | None => "constant under jittered: its estimates are exact".to_owned(),
    }
}

/// Samples by each fitted line for a standard error of `error`, the fewest first.
fn cost(result: &StudyResult, error: f64) -> Option<String> {
    let mut costs: Vec<_> = result
        .samplers
        .iter()
        .filter_map(|sampler| Some((needed(sampler, error)?, sampler)))
        .collect();
    costs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (best, sampler) = costs.first()?;
    let samples = if *best <= 1.0 { "1 sample".to_owned() } else { count(*best) + " samples" };
    let mut text = format!("{samples} of {} for error {error}", sampler.name);
    if let Some((random, _)) =
        costs.iter().find(|(_, s)| s.name == "random" && sampler.name != "random")
    {
        text += &format!("; random needs {}", count(*random));
    }
    Some(text + ".")
}

/// A number of samples: whole, or rounded where it is large.
pub fn count(n: f64) -> String {
    if n < 1e4 { format!("{}", n.ceil()) } else { number(n, 2) }
}

/// Samples that bring the standard error of one estimate down to `error`, by the fitted line.
pub fn needed(sampler: &SamplerResult, error: f64) -> Option<f64> {
    if sampler.exact {
        return Some(1.0);
    }
    let fit = sampler.fit?;
    samples_needed(fit.exponent, fit.log10_constant, error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stratcore::study::{Control, StudyPlan, study};

    fn of(name: &str) -> String {
        let integrand = stratcore::integrand::by_name(name, Some(2), &[]).unwrap();
        let result = study(&*integrand, [0, 0], &StudyPlan::paper(), Control::unwatched()).unwrap();
        verdict(&result, 0.01)
    }

    #[test]
    fn verdicts_name_the_kind_the_gain_and_the_cost() {
        let edge = of("disk");
        assert!(edge.contains("n edge: the variance under jittered is √N times"), "{edge}");
        assert!(edge.contains("samples of jittered for error 0.01; random needs 2"), "{edge}");
        assert!(of("ramp").starts_with("Smooth: the variance under jittered is N times"));
        assert!(of("constant").starts_with("Constant"));
    }
}
