//! Files of what is on screen, written off the UI thread.

use crate::line;
use crate::model::{Model, Progress, Study};
use crate::state::{Page, State};
use anyhow::{Result, bail};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stratcli::output::AtomicFile;
use stratcli::picture::Format;
use stratcli::report::spectrum::Spectra;
use stratcli::report::svg::Svg;
use stratcli::report::{PlotFile, chart, discrepancy, spectrum, trade};
use stratcore::StudyResult;
use stratcore::scene::Rgb;
use stratcore::study::Discrepancies;
use stratcore::trade::TradeResult;

/// A file that is ready to be written.
pub enum Export {
    /// The picture.
    Picture {
        /// Width and height.
        size: [u32; 2],
        /// Linear colours.
        rgb: Arc<Vec<Rgb>>,
        /// What they are multiplied by.
        gain: f64,
        /// The command that makes it.
        comment: String,
    },
    /// The curves.
    Curves {
        /// What is drawn above the chart.
        title: String,
        /// What was studied: the scene or the integrand.
        subject: String,
        /// `luminance`, `r`, `g` or `b`; empty for an integrand.
        channel: String,
        /// A result per pixel; at least one.
        results: Vec<StudyResult>,
    },
    /// Error against time.
    Trade {
        /// The scene.
        scene: String,
        /// What is drawn above the chart.
        title: String,
        /// What was found.
        result: Box<TradeResult>,
    },
    /// Spectra of point sets.
    Spectra(Spectra),
    /// Discrepancies of point sets.
    Discrepancies(Discrepancies),
}

impl Export {
    /// The picture as it is so far.
    pub fn picture(state: &State, model: &Model) -> Result<Self> {
        let layer = &model.picture;
        if layer.cells.is_empty() {
            bail!("there is no picture to save yet");
        }
        let gain = state.picture.exposure.exp2();
        let comment = line::line(&line::render(state));
        Ok(Self::Picture { size: layer.size, rgb: layer.cells.clone(), gain, comment })
    }

    /// The curves of the page that is shown; of the patterns, the spectra.
    pub fn curves(state: &State, model: &Model) -> Result<Self> {
        let studies = match state.page {
            Page::Pixel => &model.studies[..],
            Page::Theory => std::slice::from_ref(&model.theory),
            Page::Trade => return Self::trade(model),
            Page::Patterns => return Self::spectra(model),
        };
        let results: Vec<_> = studies.iter().filter_map(|s: &Study| s.result.clone()).collect();
        let Some(first) = results.first() else { bail!("there is no curve to save yet") };
        let [x, y] = first.pixel;
        let (subject, channel, title) = match (&model.loaded, state.page) {
            (Some(loaded), Page::Pixel) => {
                let name = loaded.traced.scene().name.clone();
                let channel = state.study.channel.clone();
                let title = format!("{name}, pixel {x},{y}, {channel}");
                (name, channel, title)
            }
            _ => {
                let name = state.theory.name.clone();
                let title = format!("{name}, d = {}", first.dim);
                (name, String::new(), title)
            }
        };
        Ok(Self::Curves { title, subject, channel, results })
    }

    fn trade(model: &Model) -> Result<Self> {
        let (Some(traded), Some(loaded)) = (&model.trade.result, &model.loaded) else {
            bail!("nothing was measured yet");
        };
        let scene = loaded.traced.scene().name.clone();
        let title = match &traded.pixels[..] {
            [[x, y]] => format!("{scene}, pixel {x},{y}"),
            pixels => format!("{scene}, {} pixels", pixels.len()),
        };
        Ok(Self::Trade { scene, title, result: Box::new(traded.result.clone()) })
    }

    fn spectra(model: &Model) -> Result<Self> {
        let Some(found) = &model.spectra.result else { bail!("there is no spectrum to save yet") };
        let plan = line::spectra_plan(&model.spectra.planned).map_err(anyhow::Error::msg)?;
        Ok(Self::Spectra(plan.report(found.clone())))
    }

    /// The discrepancies of the patterns page.
    pub fn discrepancies(model: &Model) -> Result<Self> {
        let Some(curves) = model.discrepancy.result.clone() else {
            bail!("there is no discrepancy to save yet");
        };
        let planned = &model.discrepancy.planned;
        let (plan, dim, _) = line::discrepancy_plan(planned).map_err(anyhow::Error::msg)?;
        let complete = model.discrepancy.progress == Progress::Done;
        let (seed, trials) = (plan.seed, plan.n_trials);
        Ok(Self::Discrepancies(Discrepancies { dim, seed, trials, curves, complete }))
    }

    /// Writes the file that `path` names, in the format of its ending.
    pub fn write(&self, path: &Path) -> Result<()> {
        match self {
            Self::Picture { size, rgb, gain, comment } => {
                let format = Format::of(path)?;
                let rgb: Vec<_> = rgb.iter().map(|rgb| rgb.map(|v| v * gain)).collect();
                AtomicFile::create(path)?.commit(&format.encode(*size, &rgb, comment)?)
            }
            Self::Curves { title, subject, channel, results } => write_table(
                path,
                || csv(subject, channel, results),
                || chart::convergence(title, &results[0]),
            ),
            Self::Trade { scene, title, result } => write_table(
                path,
                || trade::csv::rows(Some(scene), None, result),
                || trade::chart(title, result),
            ),
            Self::Spectra(spectra) => {
                write_table(path, || spectrum::csv(spectra), || spectrum::chart(spectra))
            }
            Self::Discrepancies(found) => {
                write_table(path, || discrepancy::csv(found), || discrepancy::chart(found))
            }
        }
    }
}

/// Writes the rows to a file that ends in `.csv`, the chart to any other.
fn write_table(
    path: &Path,
    rows: impl FnOnce() -> String,
    chart: impl FnOnce() -> Svg,
) -> Result<()> {
    let ending = path.extension().map(|e| e.to_ascii_lowercase());
    if ending.is_some_and(|e| e == "csv") {
        AtomicFile::create(path)?.commit(rows().as_bytes())
    } else {
        PlotFile::create(path)?.commit(&chart())
    }
}

/// Writes and tells how it went.
pub fn save(export: Result<Export>, path: PathBuf) -> Result<String, String> {
    let written = export.and_then(|export| export.write(&path));
    written.map(|()| format!("saved {}", path.display())).map_err(|error| format!("{error:#}"))
}

/// One line per sampler and N, each with the fit of its curve. What is missing is empty.
fn csv(subject: &str, channel: &str, results: &[StudyResult]) -> String {
    let mut text = "subject,x,y,channel,sampler,scramble,dim,n_requested,n_used,trials,seed,mean,\
                    var,var_lo,var_hi,p,p_se,p_lo,p_hi,log10_c\n"
        .to_owned();
    for result in results {
        let [x, y] = result.pixel;
        let StudyResult { dim, trials, seed, .. } = result;
        for sampler in &result.samplers {
            let fit = sampler.fit.as_ref().map_or_else(
                || ",,,,".to_owned(),
                |fit| {
                    let [lo, hi] = fit.ci95;
                    format!("{},{},{lo},{hi},{}", fit.exponent, fit.std_error, fit.log10_constant)
                },
            );
            let (name, scramble) = (quoted(sampler.name), sampler.scramble);
            for row in &sampler.rows {
                let [lo, hi] = row.ci95();
                let _ = writeln!(
                    text,
                    "{},{x},{y},{channel},{name},{scramble},{dim},{},{},{trials},{seed},{},{},{lo},{hi},{fit}",
                    quoted(subject),
                    row.n,
                    row.n_used,
                    row.grand_mean,
                    row.variance_of_mean,
                );
            }
        }
    }
    text
}

/// A CSV field (RFC 4180).
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stratcore::study::{Control, StudyPlan, study};

    #[test]
    fn the_csv_holds_every_number_to_the_last_bit() {
        let integrand = stratcore::integrand::by_name("disk", Some(2), &[]).unwrap();
        let result = study(&*integrand, [3, 4], &StudyPlan::paper(), Control::unwatched()).unwrap();
        let text = csv("a,b", "g", std::slice::from_ref(&result));
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 1 + 2 * 16);
        assert!(lines.iter().skip(1).all(|line| line.starts_with("\"a,b\",3,4,g,")));
        let fields: Vec<_> = lines[20].split(',').skip(1).collect();
        assert_eq!(fields.len(), lines[0].split(',').count());
        let row = &result.samplers[1].rows[3];
        assert_eq!(fields[11].parse::<f64>().unwrap(), row.grand_mean);
        assert_eq!(fields[12].parse::<f64>().unwrap(), row.variance_of_mean);
        assert_eq!(fields[15].parse::<f64>().unwrap(), result.samplers[1].fit.unwrap().exponent);
    }
}
