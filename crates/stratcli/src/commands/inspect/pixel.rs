//! Which axes one pixel needs, and what that predicts for each sampler.

use crate::table::{Align, columns, short};
use anyhow::Result;
use serde::Serialize;
use stratcore::dimensions::{Bound, FAMILIES, Limit, Needs, limit, needs_of_pixel};
use stratcore::scene::Channel;
use stratcore::study::{Control, SamplerChoice};
use stratcore::trace::{Route, TracedScene};

#[derive(Serialize)]
pub struct PixelFacts {
    at: [u32; 2],
    path: Route,
    needs: Needs,
    /// Dimension k of what its luminance jumps across; null without jumps.
    discontinuity_dim: Option<usize>,
    predicted: Vec<SamplerPrediction>,
}

#[derive(Serialize)]
struct SamplerPrediction {
    sampler: &'static str,
    /// Null where theory says nothing.
    limit: Option<Limit>,
}

impl PixelFacts {
    /// Takes the pixel's luminance apart.
    pub fn of(scene: &TracedScene, at: [u32; 2], seed: u64, control: Control<'_>) -> Result<Self> {
        let integrand = scene.pixel(at, Channel::Luminance);
        let needs = needs_of_pixel(&integrand, at, seed, control)?;
        let predicted = |(sampler, _): &(&'static str, _)| {
            let SamplerChoice { scramble, .. } = SamplerChoice::named(sampler)?;
            Ok(SamplerPrediction { sampler, limit: limit(sampler, scramble, &needs) })
        };
        let predicted = FAMILIES.iter().map(predicted).collect::<Result<_>>()?;
        let (path, discontinuity_dim) = (integrand.route(), needs.discontinuity_dim());
        Ok(Self { at, path, needs, discontinuity_dim, predicted })
    }

    pub fn text(&self) -> String {
        let [x, y] = self.at;
        let needs = &self.needs;
        if needs.variance.value == 0.0 {
            return format!("pixel {x},{y}: {}; it is constant and needs no axis\n", self.path);
        }
        let percent = |value: f64| format!("{} %", short(100.0 * value, 3));
        let axes: Vec<_> = needs
            .axes
            .iter()
            .map(|axis| {
                let share = percent(axis.share.value);
                vec![axis.name.clone(), share, axis.behaviour.to_string()]
            })
            .collect();
        let k = self.discontinuity_dim.map_or("no jumps".to_owned(), |k| format!("k = {k}"));
        let share =
            |part: stratcore::dimensions::Estimate| percent(part.value / needs.variance.value);
        let predicted: Vec<_> = self
            .predicted
            .iter()
            .map(|p| {
                let words = p.limit.map_or(["no law".to_owned(), String::new()], |limit| {
                    let sign = if limit.bound == Bound::AtLeast { ">=" } else { "=" };
                    [format!("p {sign} {}", short(limit.exponent, 4)), limit.source.to_owned()]
                });
                let [exponent, source] = words;
                vec![p.sampler.to_owned(), exponent, source]
            })
            .collect();
        format!(
            "pixel {x},{y}: {}, {k}; share of the variance in what knows each axis (shares overlap)\n\
             {}  beyond one axis {}, beyond pairs of axes {}, beyond any two {}\n\
             predicted for large N\n{}",
            self.path,
            columns(Align::Left, &axes),
            share(needs.beyond_axes),
            share(needs.beyond_pairs),
            share(needs.beyond_two),
            columns(Align::Left, &predicted),
        )
    }
}
