//! Samplers compared over the maps of several scenes: one page that carries everything, and the
//! same in short as text.

use super::html;
use super::page::table;
use crate::table::{Align, columns, number};
use maud::{Markup, html};
use stratcore::map::{Comparison, Header, Summary};
use stratcore::theory::Class;

/// A scene's finished map.
pub struct Scene {
    /// Its plan.
    pub header: Header,
    /// Its numbers.
    pub summary: Summary,
    /// Its overview, as the address of an image.
    pub picture: String,
}

const CLASSES: [(Option<Class>, &str); 4] = [
    (Some(Class::Smooth), "smooth"),
    (Some(Class::Edge), "edge"),
    (Some(Class::Complex), "complex"),
    (None, "all pixels"),
];

/// The samplers of a scene's pixels of one class, at one N.
struct Standing {
    n: u64,
    pixels: u64,
    /// Sampler and median of its variance over the baseline's, the least first. The baseline is
    /// among them with 1.
    ranks: Vec<(String, f64)>,
}

impl Scene {
    fn name(&self) -> &str {
        &self.header.plan.scene
    }

    /// Comparisons over the pixels of a class.
    fn comparisons(&self, class: Option<Class>) -> Vec<&Comparison> {
        self.summary.comparisons.iter().filter(|comparison| comparison.class == class).collect()
    }

    /// Who stands where at the largest N that all samplers use; none where nothing is compared.
    fn standing(&self, class: Option<Class>) -> Option<Standing> {
        let comparisons = self.comparisons(class);
        let first = comparisons.first()?;
        let at = |c: &Comparison, n: u64| c.gains.iter().find(|gain| gain.n == n).cloned();
        let n = first
            .gains
            .iter()
            .rev()
            .map(|gain| gain.n)
            .find(|n| comparisons.iter().all(|c| at(c, *n).is_some()))?;
        let gains: Vec<_> = comparisons.iter().filter_map(|c| Some((c, at(c, n)?))).collect();
        let mut ranks = vec![(first.baseline.clone(), 1.0)];
        ranks.extend(
            gains.iter().filter_map(|(c, gain)| Some((c.sampler.clone(), gain.quartiles?[1]))),
        );
        ranks.sort_by(|a, b| a.1.total_cmp(&b.1));
        let pixels = gains.iter().map(|(_, gain)| gain.pixels).min()?;
        Some(Standing { n, pixels, ranks })
    }
}

/// Best sampler per scene and class.
pub fn text(scenes: &[Scene]) -> String {
    let rows = winners(scenes);
    let head = ["scene", "class", "pixels", "N", "best", "its variance", "next"].map(str::to_owned);
    let rows: Vec<_> = std::iter::once(head.to_vec()).chain(rows).collect();
    columns(Align::Left, &rows)
}

fn winners(scenes: &[Scene]) -> Vec<Vec<String>> {
    let of_scene = |scene: &Scene| -> Vec<Vec<String>> {
        let row = |(class, name): &(Option<Class>, &str)| {
            let standing = scene.standing(*class)?;
            let (best, ratio) = standing.ranks.first()?;
            let next = standing.ranks.get(1);
            Some(vec![
                scene.name().to_owned(),
                (*name).to_owned(),
                standing.pixels.to_string(),
                standing.n.to_string(),
                best.clone(),
                number(*ratio, 3),
                next.map_or(String::new(), |(name, ratio)| {
                    format!("{name}, {}", number(*ratio, 3))
                }),
            ])
        };
        CLASSES.iter().filter_map(row).collect()
    };
    scenes.iter().flat_map(of_scene).collect()
}

/// The whole page.
pub fn render(title: &str, scenes: &[Scene]) -> String {
    let lead = html! { (lead(scenes)) };
    let body = html! {
        h2 { "Which sampler wins where" }
        (best(scenes))
        h2 { "What scenes are made of" }
        (shares(scenes))
        @for scene in scenes { (one(scene)) }
        h2 { "Method" }
        (method(scenes))
    };
    html::page(&format!("{title}: samplers compared"), &lead, &body)
}

fn lead(scenes: &[Scene]) -> String {
    let names = scenes.iter().map(Scene::name).collect::<Vec<_>>().join(", ");
    let samplers = scenes.first().map_or(0, |scene| scene.header.plan.samplers.len());
    format!("How fast every pixel converges under {samplers} samplers. Scenes: {names}.")
}

fn best(scenes: &[Scene]) -> Markup {
    let head = ["scene", "class", "pixels", "N", "least variance", "its ratio", "next"];
    html! {
        p {
            "Medians, over the pixels of a class, of the variance under a sampler over that "
            "under the baseline (random, where it is among them) at the largest N that all use. "
            "The class of a pixel is read under jittered sampling."
        }
        (table(2, &head, winners(scenes).into_iter()))
    }
}

fn shares(scenes: &[Scene]) -> Markup {
    let row = |scene: &Scene| {
        let summary = &scene.summary;
        if summary.classes.is_empty() {
            return None;
        }
        let mut cells = vec![scene.name().to_owned(), summary.pixels.to_string()];
        cells.extend(summary.classes.iter().map(|c| format!("{:.1} %", 100.0 * c.share)));
        Some(cells)
    };
    let rows: Vec<_> = scenes.iter().filter_map(row).collect();
    html! {
        @if rows.is_empty() {
            p { "Classes are read under unscrambled jittered sampling, which is not among the samplers." }
        } @else {
            (table(1, &["scene", "pixels", "exact", "smooth", "edge", "complex"], rows.into_iter()))
        }
    }
}

fn one(scene: &Scene) -> Markup {
    let number_or_dash = |x: Option<f64>| x.map_or("–".to_owned(), |x| format!("{x:.3}"));
    let exponents = scene.summary.samplers.iter().map(|s| {
        let mut cells = vec![s.sampler.clone(), s.fitted.to_string(), s.exact.to_string()];
        cells.extend([number_or_dash(s.mean), number_or_dash(s.std_deviation)]);
        let quartiles = s.quartiles.map(|q| q.map(|p| format!("{p:.2}")).join(" to "));
        cells.push(quartiles.unwrap_or("–".to_owned()));
        cells
    });
    html! {
        h2 { (scene.name()) }
        figure {
            img src=(scene.picture) alt={ "The map of " (scene.name()) } style="width:100%;height:auto";
            figcaption {
                "The mean, p under each sampler in false colour on a fixed scale, the class, and "
                "the sampler of least variance."
            }
        }
        (table(1, &["sampler", "fitted", "exact", "mean p", "sd", "quartiles of p"], exponents))
        (ratios(scene))
    }
}

/// Median ratios at every N, over all pixels.
fn ratios(scene: &Scene) -> Markup {
    let rows = CLASSES.iter().flat_map(|(class, name)| {
        scene.comparisons(*class).into_iter().flat_map(move |c| {
            c.gains.iter().filter_map(move |gain| {
                let [low, median, high] = gain.quartiles?;
                Some(vec![
                    c.sampler.clone(),
                    (*name).to_owned(),
                    gain.n.to_string(),
                    gain.pixels.to_string(),
                    number(median, 3),
                    format!("{} to {}", number(low, 3), number(high, 3)),
                ])
            })
        })
    });
    let rows: Vec<_> = rows.collect();
    let baseline = scene.comparisons(None).first().map(|c| c.baseline.clone());
    html! {
        @if let Some(baseline) = baseline {
            details {
                summary { "Variance over that of " (baseline) ", at every N" }
                (table(2, &["sampler", "class", "N", "pixels", "median", "quartiles"], rows.into_iter()))
            }
        }
    }
}

fn method(scenes: &[Scene]) -> Markup {
    html! {
        p {
            "Each pixel is estimated M times from N samples, for each N and sampler, each time "
            "with a fresh point set; p is the slope of the variance of those means, −d ln "
            "variance / d ln N, by least squares. Plans, by whose hash a map is made again:"
        }
        (table(1, &["scene", "samplers", "N", "M", "seed", "plan"], scenes.iter().map(|scene| {
            let plan = &scene.header.plan;
            vec![
                plan.scene.clone(),
                plan.samplers.iter().map(|s| s.label()).collect::<Vec<_>>().join(", "),
                plan.counts.iter().map(u64::to_string).collect::<Vec<_>>().join(", "),
                plan.trials.to_string(),
                plan.seed.to_string(),
                scene.header.hash.clone(),
            ]
        })))
    }
}
