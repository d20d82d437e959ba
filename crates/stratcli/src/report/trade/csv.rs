//! A trade as tidy CSV: one line per sampler and N.

use std::fmt::Write;
use stratcore::trade::TradeResult;

const HEADER: &str = "scene,integrand,subjects,sampler,scramble,dim,n_used,trials,seed,mse,mse_lo,\
                      mse_hi,rmse,error95,ns_per_sample,ns_per_sample_lo,ns_per_sample_hi,\
                      generation_ns,fused,ns_per_estimate,efficiency,pareto";

/// Numbers in full; a missing value, or one without bound, is empty. The trade was made in a scene
/// or in an integrand.
pub fn rows(scene: Option<&str>, integrand: Option<&str>, result: &TradeResult) -> String {
    let quoted = |name: Option<&str>| match name {
        Some(name) => format!("\"{}\"", name.replace('"', "\"\"")),
        None => String::new(),
    };
    let cell = |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
    let (scene, integrand) = (quoted(scene), quoted(integrand));
    let mut text = format!("{HEADER}\n");
    for sampler in &result.samplers {
        for row in &sampler.rows {
            let (error, time) = (&row.error, &row.time);
            let numbers = [
                error.mse,
                error.mse_ci95[0],
                error.mse_ci95[1],
                error.rmse,
                error.error95,
                time.ns_per_sample.median,
                time.ns_per_sample.lower,
                time.ns_per_sample.upper,
                time.generation_ns.median,
            ];
            let _ = writeln!(
                text,
                "{scene},{integrand},{},{},{},{},{},{},{},{},{},{},{},{}",
                result.subjects,
                sampler.name,
                sampler.scramble,
                result.dim,
                error.n,
                result.trials,
                result.seed,
                numbers.map(cell).join(","),
                time.fused,
                cell(row.ns_per_estimate.median),
                row.efficiency.map_or(String::new(), cell),
                row.pareto,
            );
        }
    }
    text
}
