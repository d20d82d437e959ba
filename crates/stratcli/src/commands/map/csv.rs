//! A map as tidy tables: one row per pixel and sampler, or per pixel, sampler and N.

use std::fmt::{Display, Write};
use stratcore::map::{Identity, PixelReading, Region};

/// Which table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Table {
    /// Fits: a row per pixel and sampler.
    Fits,
    /// Points: a row per pixel, sampler and N.
    Points,
}

/// The first line.
pub fn header(table: Table) -> String {
    let common = "scene,x,y,channel,sampler,scramble,dim,trials,seed";
    match table {
        Table::Fits => format!(
            "{common},mean,p,p_se,p_lo,p_hi,log10_c,n_min,n_max,points,chi2,dof,class,flags\n"
        ),
        Table::Points => format!("{common},n_requested,n_used,mean,var,var_lo,var_hi\n"),
    }
}

/// The rows of a tile's pixels, row by row. What is not known is empty.
pub fn rows(table: Table, plan: &Identity, tile: Region, readings: &[Vec<PixelReading>]) -> String {
    let Identity { dim, trials, seed, .. } = plan;
    let scene = quoted(&plan.scene);
    let channel = serde_json::to_value(plan.channel).unwrap_or_default();
    let channel = channel.as_str().unwrap_or_default();
    let samplers: Vec<String> = plan
        .samplers
        .iter()
        .map(|s| format!("{channel},{},{},{dim},{trials},{seed}", quoted(&s.name), s.scramble))
        .collect();
    let mut text = String::new();
    for ([x, y], pixel) in tile.pixels().zip(readings) {
        for (i, reading) in pixel.iter().enumerate() {
            let start = text.len();
            let _ = write!(text, "{scene},{x},{y},{}", samplers[i]); // cannot fail
            match table {
                Table::Fits => fit(&mut text, plan, reading),
                Table::Points => {
                    let start = text.split_off(start);
                    for (row, moments) in reading.moments.iter().enumerate() {
                        text += &start;
                        let (n, used) = (plan.counts[row], plan.samplers[i].counts_used[row]);
                        let _ = write!(text, ",{n},{used}");
                        let [lo, hi] = reading.reading.noise[row].ci95(moments.variance);
                        for value in [moments.mean, moments.variance, lo, hi] {
                            number(&mut text, value);
                        }
                        text.push('\n');
                    }
                }
            }
        }
    }
    text
}

fn fit(text: &mut String, plan: &Identity, pixel: &PixelReading) {
    number(text, best_mean(plan, pixel));
    let reading = &pixel.reading;
    match &reading.fit {
        Some(fit) => {
            let [lo, hi] = fit.ci95;
            for value in [fit.exponent, fit.std_error, lo, hi, fit.log10_constant] {
                number(text, value);
            }
            let (n_min, n_max, points) = (fit.n_min, fit.n_max, fit.points);
            let _ = write!(text, ",{n_min},{n_max},{points}");
            number(text, fit.chi2);
            let _ = write!(text, ",{}", points - 2);
        }
        None => text.push_str(",,,,,,,,,,"),
    }
    text.push(',');
    if let Some(class) = reading.class {
        let _ = write!(text, "{class}");
    }
    let has_zero = pixel.moments.iter().any(|moments| moments.variance == 0.0);
    let flags = [
        (reading.exact, "exact"),
        (has_zero && !reading.exact, "partly-exact"),
        (reading.class.is_some() && !reading.class_is_sure, "class-unsure"),
        (pixel.is_missing(), "missing"),
        (pixel.is_computed(), "computed"),
    ];
    let flags: Vec<_> = flags.iter().filter(|(set, _)| *set).map(|(_, name)| *name).collect();
    let _ = writeln!(text, ",{}", flags.join("|"));
}

/// The pixel's best estimate: the mean of all trials at the largest N.
pub fn best_mean(plan: &Identity, pixel: &PixelReading) -> f64 {
    let largest = plan.counts.iter().zip(&pixel.moments).max_by_key(|(n, _)| **n);
    largest.map_or(f64::NAN, |(_, moments)| moments.mean)
}

/// A comma and the shortest text that is read back as the same number; only the comma for one
/// that is not finite.
fn number(text: &mut String, value: f64) {
    text.push(',');
    if value.is_finite() {
        text.push_str(zmij::Buffer::new().format_finite(value));
    }
}

/// As RFC 4180 wants a field that may hold commas.
fn quoted(field: impl Display) -> String {
    let field = field.to_string();
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_and_missing_ones_are_empty() {
        let mut text = String::new();
        for value in [0.1, 1e-300, -0.0, 123_456_789.123_456_78, f64::NAN, f64::INFINITY] {
            number(&mut text, value);
        }
        assert_eq!(text, ",0.1,1e-300,-0.0,123456789.12345678,,");
    }

    #[test]
    fn fields_with_commas_are_quoted() {
        assert_eq!(quoted("classic"), "classic");
        assert_eq!(quoted("a \"b\", c"), "\"a \"\"b\"\", c\"");
    }

    #[test]
    fn headers_have_as_many_fields_as_rows() {
        assert_eq!(header(Table::Fits).matches(',').count(), 9 + 12);
        assert_eq!(header(Table::Points).matches(',').count(), 9 + 5);
    }
}
