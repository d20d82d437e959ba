//! The table for programs.

use super::Document;
use stratcore::dimensions::Bound;

/// One line for each N of each sampler and filter, numbers in full.
pub fn csv(document: &Document) -> String {
    let mut text =
        "scene,features,dim,k,kind,x,y,sampler,scramble,n,trials,variance_of_mean,lo,hi,\
                    expected_variance,expected_std_error,limit,limit_is,p,p_std_error\n"
            .to_owned();
    let optional = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
    for table in &document.pixels {
        for sampler in &table.samplers {
            for (i, row) in sampler.rows.iter().enumerate() {
                let expected = sampler.expected.get(i);
                let [lo, hi] = row.ci95();
                let limit_is = sampler.limit.map_or("", |limit| match limit.bound {
                    Bound::Equals => "equals",
                    Bound::AtLeast => "at_least",
                });
                let fields = [
                    table.scene.to_owned(),
                    format!("\"{}\"", table.features),
                    table.dim.to_string(),
                    table.discontinuity_dim.map_or(String::new(), |k| k.to_string()),
                    table.kind.to_string(),
                    table.pixel[0].to_string(),
                    table.pixel[1].to_string(),
                    sampler.name.to_owned(),
                    sampler.scramble.to_string(),
                    row.n_used.to_string(),
                    table.trials.to_string(),
                    row.variance_of_mean.to_string(),
                    lo.to_string(),
                    hi.to_string(),
                    optional(expected.map(|e| e.variance)),
                    optional(expected.map(|e| e.std_error)),
                    optional(sampler.limit.map(|limit| limit.exponent)),
                    limit_is.to_owned(),
                    optional(sampler.fit.map(|fit| fit.exponent)),
                    optional(sampler.fit.map(|fit| fit.std_error)),
                ];
                text += &fields.join(",");
                text.push('\n');
            }
        }
    }
    text
}
