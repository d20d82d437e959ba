//! The paper beside ours: each statement with what follows from the measurement.

use super::form_factor::SIDE;
use crate::report::summary::{Claims, FormFactor, FormFactorCase, Pixels, Summary, Verdict, paper};
use crate::table::{number, with_error};
use stratcore::theory::Class;

/// Every statement that the finished parts can judge.
pub fn verdicts(summary: &Summary) -> Vec<Verdict> {
    let mut list = Vec::new();
    if let Some(pixels) = &summary.pixels {
        list.extend(exponents(pixels, summary.protocol.noise_of_p));
    }
    for close_up in &summary.close_ups {
        let gap = close_up.exponent - close_up.paper;
        list.push(Verdict {
            what: format!("Fig. 5: p of a pixel, {}", close_up.class),
            paper: format!("{:.2}", close_up.paper),
            ours: with_error(close_up.exponent, close_up.std_error),
            verdict: format!(
                "no test: the nearest by rule among {}, {:+.2} away",
                close_up.candidates, gap
            ),
            holds: None,
        });
    }
    if let Some(form_factor) = &summary.form_factor {
        list.extend(four_dimensions(form_factor));
    }
    if let Some(claims) = &summary.claims {
        list.extend(closing_claims(claims));
    }
    list
}

fn judged(what: &str, paper: &str, ours: String, holds: bool, [yes, no]: [String; 2]) -> Verdict {
    let (what, paper) = (what.to_owned(), paper.to_owned());
    Verdict { what, paper, ours, verdict: if holds { yes } else { no }, holds: Some(holds) }
}

fn exponents(pixels: &Pixels, noise: f64) -> Vec<Verdict> {
    let Pixels { random, jittered, .. } = pixels;
    let [low, _, high] = jittered.percentiles;
    let margin = 3.0 * noise;
    let spans = (1.0 - margin..1.25).contains(&low) && (1.75..2.0 + margin).contains(&high);
    vec![
        judged(
            "Fig. 2: p under random, every pixel",
            "1",
            format!(
                "{}, sd {:.3} ({:.3} without tails)",
                with_error(random.mean, random.std_error),
                random.std_deviation,
                random.robust_deviation
            ),
            (random.mean - 1.0).abs() <= noise,
            ["agrees", "differs"].map(|w| format!("mean {w} to the noise of one fit, {noise:.3}")),
        ),
        judged(
            "Fig. 4: p under jittered",
            "1.0 to 2.0",
            format!("{low:.2} to {high:.2} (1st to 99th percentile)"),
            spans,
            [
                "spans the same range, give or take three times the noise".to_owned(),
                "spans another range: this picture holds other pixels".to_owned(),
            ],
        ),
    ]
}

fn four_dimensions(form_factor: &FormFactor) -> Vec<Verdict> {
    let mut list = vec![judged(
        "Form factor itself",
        "not given",
        format!("{:.7} ± {:.7}", form_factor.estimate, form_factor.std_error),
        form_factor.z.abs() < 3.0,
        ["agrees with", "differs from"].map(|word| {
            format!("{word} the closed form {:.7}: z = {:+.2}", form_factor.analytic, form_factor.z)
        }),
    )];
    let case = |occluder| form_factor.cases.iter().find(|c| c.occluder == occluder);
    let occluded = format!("with an occluder of side {SIDE}");
    for (case, values, name) in [
        (case(None), paper::FORM_FACTOR, "of the form factor"),
        (case(Some(SIDE)), paper::OCCLUDED, occluded.as_str()),
    ] {
        let Some(case) = case else { continue };
        for (i, which) in ["all N", "without N = 1"].into_iter().enumerate() {
            let what = format!("p {name}, {which}");
            list.extend(one_exponent(case, i, &what, values[i], form_factor.repeats));
        }
    }
    list
}

/// The paper made one run: it should lie within the scatter of one of ours.
fn one_exponent(
    case: &FormFactorCase,
    i: usize,
    what: &str,
    value: f64,
    repeats: u32,
) -> Option<Verdict> {
    let (mean, error, scatter) = (case.mean[i]?, case.std_error[i]?, case.scatter[i]?);
    let z = (value - mean) / scatter;
    Some(judged(
        what,
        &format!("{value:.3}"),
        format!("{mean:.4} ± {error:.4} over {repeats} runs; one run scatters by {scatter:.3}"),
        z.abs() < 1.96,
        ["within", "outside"].map(|word| {
            format!("{word} the 95 % range of one run: {z:+.1} times its scatter from our mean")
        }),
    ))
}

fn closing_claims(claims: &Claims) -> Vec<Verdict> {
    let mut list = Vec::new();
    if let Some(one) = claims.rows.iter().find(|row| row.n == 1) {
        let z = one.mean_ln_ratio / one.std_error;
        list.push(judged(
            "At N = 1 both samplers agree",
            "the same",
            format!("mean ln ratio {:+.4} ± {:.4}", one.mean_ln_ratio, one.std_error),
            z.abs() < 3.0,
            ["agree", "differ"].map(|word| format!("{word}: z = {z:+.1}")),
        ));
    }
    let beyond = &claims.beyond_one;
    let expected = beyond.expected_from_n1.max(beyond.expected_false_alarms);
    let again = claims.suspects.len();
    let confirmed = claims.suspects.iter().filter(|s| s.again_interval[0] > 1.0).count();
    list.push(judged(
        "Jittered is never worse than random",
        "no worse",
        format!(
            "looks worse in {} of {} pixels × N; up to {expected:.0} would by chance",
            beyond.looks_worse, beyond.compared
        ),
        beyond.looks_worse as f64 <= expected + 3.0 * expected.sqrt() && confirmed == 0,
        [
            match again {
                0 => "no more than chance".to_owned(),
                _ => format!("no more than chance; of {again} measured again none is worse"),
            },
            format!("more than chance, or worse when measured again: {confirmed} of {again}"),
        ],
    ));
    for gain in &claims.gains {
        let Some((&n, (&[low, median, high], &factor))) =
            gain.n.iter().zip(gain.quartiles.iter().zip(&gain.paper)).next_back()
        else {
            continue;
        };
        let ours =
            format!("{} (quartiles {} and {})", number(median, 3), number(low, 3), number(high, 3));
        let what = format!("Gain at N = {n}, {}", gain.class);
        let law = match gain.class {
            Class::Smooth => "N",
            Class::Edge => "√N",
            Class::Complex | Class::Exact => {
                let verdict = "no test: the paper says it of the worst case, and most of these \
                               pixels still gain";
                let (paper, verdict) = ("1".to_owned(), verdict.to_owned());
                list.push(Verdict { what, paper, ours, verdict, holds: None });
                continue;
            }
        };
        list.push(judged(
            &what,
            &format!("{law} = {factor}"),
            ours,
            (0.5..=2.0).contains(&(median / factor)),
            ["within", "not within"].map(|word| format!("median {word} a factor of two")),
        ));
    }
    list
}
