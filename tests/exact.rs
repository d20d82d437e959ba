//! The whole experiment against what is known exactly: variances per N, exponents, means.
//!
//! Seeds are fixed, so each test passes always or never; "false alarms" says how often a
//! correct program would fail for a fresh seed.

use stratcore::fit::{Fit, fit};
use stratcore::integrand::{Integrand, by_name};
use stratcore::study::{Control, Row, SamplerChoice, SamplerResult, StudyPlan, study};
use stratcore::variance::Spread;

fn integrand(name: &str, dim: usize, params: &[(&str, f64)]) -> Box<dyn Integrand> {
    let params: Vec<_> = params.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    by_name(name, Some(dim), &params).unwrap()
}

fn measure(
    f: &dyn Integrand,
    sampler: &str,
    counts: &[u64],
    n_trials: u32,
    seed: u64,
) -> SamplerResult {
    let plan = StudyPlan {
        samplers: vec![SamplerChoice::named(sampler).unwrap()],
        counts: counts.to_vec(),
        n_trials,
        seed,
        ..StudyPlan::paper()
    };
    study(f, [0, 0], &plan, Control::unwatched()).unwrap().samplers.remove(0)
}

fn powers(ks: impl IntoIterator<Item = u64>, dim: usize) -> Vec<u64> {
    ks.into_iter().map(|k| k.pow(dim as u32)).collect()
}

#[test]
fn variances_per_n() {
    let cases: [(&str, &[(&str, f64)]); 7] = [
        ("ramp", &[]),
        ("step", &[]),
        ("half-space", &[("offset", 0.07)]),
        ("disk", &[]),
        ("gaussian", &[]),
        ("cosines", &[]),
        ("checkerboard", &[("frequency", 6.0)]),
    ];
    let strata: [&[u64]; 6] = [
        &[1, 7, 100, 3001, 100_000],
        &[1, 2, 5, 16, 100, 316],
        &[1, 2, 5, 10, 46],
        &[1, 2, 3, 5, 17],
        &[1, 2, 4, 10],
        &[1, 2, 3, 6],
    ];
    let (mut zs, mut means) = (Vec::new(), Vec::new());
    for (name, params) in cases {
        let start = std::time::Instant::now();
        for dim in 1..=6 {
            let f = integrand(name, dim, params);
            let reference = f.reference().unwrap().mean;
            for sampler in ["random", "jittered"] {
                for n in powers(strata[dim - 1].iter().copied(), dim) {
                    let Some(exact) = f.exact_variance(sampler, n) else { continue };
                    let n_trials = (1_000_000 / n).clamp(40, 1000) as u32;
                    let row = &measure(&*f, sampler, &[n], n_trials, 1996).rows[0];
                    if exact == 0.0 || row.variance_of_mean == 0.0 {
                        eprintln!(
                            "ZERO {name} {dim} {sampler} {n}: {exact} {}",
                            row.variance_of_mean
                        );
                        continue;
                    }
                    let z = ((row.variance_of_mean / exact).ln() + 0.5 * row.var_ln)
                        / row.var_ln.sqrt();
                    let zm = (row.grand_mean - reference) / (exact / f64::from(n_trials)).sqrt();
                    if z.abs() > 3.0 || zm.abs() > 3.0 {
                        eprintln!(
                            "{name} {dim} {sampler} {n}: z {z:.2} zm {zm:.2} varln {}",
                            row.var_ln
                        );
                    }
                    zs.push(z);
                    means.push(zm);
                }
            }
        }
        eprintln!("{name} {:?}", start.elapsed());
    }
    let n = zs.len() as f64;
    eprintln!(
        "{n} {} {}",
        zs.iter().map(|z| z * z).sum::<f64>() / n,
        means.iter().map(|z| z * z).sum::<f64>() / n
    );
}

fn exact_fit(f: &dyn Integrand, ks: impl Iterator<Item = u64>) -> Option<Fit> {
    let dim = f.dim();
    let rows: Vec<_> = ks
        .map(|k| {
            let n = k.pow(dim as u32);
            (
                n,
                Spread {
                    grand_mean: 0.0,
                    variance_of_mean: f.exact_variance("jittered", n).unwrap(),
                    ci95: [0.0; 2],
                    var_ln: 1.0,
                },
            )
        })
        .collect();
    fit(rows.iter().map(|(n, s)| (*n, s)))
}

#[test]
fn exponents() {
    for dim in 1..=5usize {
        let range = [1..=4096u64, 1..=256, 1..=40, 1..=16, 1..=10][dim - 1].clone();
        for from in [1u64, 2, 4] {
            let t = std::time::Instant::now();
            let r = from..=*range.end();
            let g = exact_fit(&*integrand("gaussian", dim, &[]), r.clone()).unwrap().exponent;
            let c = exact_fit(&*integrand("cosines", dim, &[]), r.clone()).unwrap().exponent;
            let rp = exact_fit(&*integrand("ramp", dim, &[]), r.clone()).unwrap().exponent;
            let h: Vec<_> = [-0.13, -0.05, 0.03, 0.07, 0.1, 0.17]
                .iter()
                .map(|o| {
                    exact_fit(&*integrand("half-space", dim, &[("offset", *o)]), r.clone())
                        .unwrap()
                        .exponent
                })
                .collect();
            eprintln!(
                "d {dim} from {from}: gauss {g:.4} cos {c:.4} ramp {rp:.4} /{:.4}; half {h:.4?} / {:.4} {:?}",
                1.0 + 2.0 / dim as f64,
                1.0 + 1.0 / dim as f64,
                t.elapsed()
            );
        }
    }
}

#[test]
fn koch() {
    let f = integrand("koch", 2, &[]);
    for (lo, hi) in [(1, 64u64), (2, 64), (2, 54), (3, 27), (3, 81), (7, 63)] {
        let t = std::time::Instant::now();
        let r = measure(&*f, "jittered", &powers(lo..=hi, 2), 300, 1);
        eprintln!("koch {lo}..{hi} {:?} {:?}", r.fit, t.elapsed());
    }
}

#[test]
fn se() {
    for (name, dim) in [
        ("gaussian", 2),
        ("ramp", 2),
        ("half-space", 2),
        ("koch", 2),
        ("checkerboard", 2),
        ("step", 2),
        ("disk", 3),
        ("form-factor", 4),
    ] {
        for sampler in ["jittered", "random"] {
            let f = integrand(name, dim, &[]);
            let t = std::time::Instant::now();
            let counts = if dim < 4 { powers(1..=16, 2) } else { powers(1..=4, 4) };
            if dim == 3 && sampler == "jittered" {
                continue;
            }
            let fits: Vec<_> =
                (0..500).map(|s| measure(&*f, sampler, &counts, 50, s).fit.unwrap()).collect();
            let n = fits.len() as f64;
            let m = fits.iter().map(|f| f.exponent).sum::<f64>() / n;
            let sd =
                (fits.iter().map(|f| (f.exponent - m).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
            let se = (fits.iter().map(|f| f.std_error.powi(2)).sum::<f64>() / n).sqrt();
            let chi = fits.iter().map(|f| f.chi2).sum::<f64>() / n;
            eprintln!(
                "{name} {sampler} p {m:.4} sd {sd:.4} se {se:.4} ratio {:.3} chi2 {chi:.2} {:?}",
                se / sd,
                t.elapsed()
            );
        }
    }
}

#[test]
fn ff() {
    let counts = powers(1..=10, 4);
    for side in [0.0, 0.5] {
        let f = integrand("form-factor", 4, &[("occluder", side)]);
        let t = std::time::Instant::now();
        let r: Vec<_> = (0..24).map(|s| measure(&*f, "jittered", &counts, 50, s)).collect();
        for g in [|r: &SamplerResult| r.fit, |r: &SamplerResult| r.fit_without_first] {
            let p: Vec<f64> = r.iter().map(|r| g(r).unwrap().exponent).collect();
            let n = p.len() as f64;
            let m = p.iter().sum::<f64>() / n;
            let sd = (p.iter().map(|x| (x - m).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
            eprintln!("ff {side} {m:.4} +- {:.4} sd {sd:.4} {:?}", sd / n.sqrt(), t.elapsed());
        }
    }
    let t = std::time::Instant::now();
    for side in
        [0.0, 0.05, 0.1, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.9, 0.95, 0.99, 0.999]
    {
        let f = integrand("form-factor", 4, &[("occluder", side)]);
        eprintln!(
            "{side}: mean {:.6} p {:.4} {:.4} ",
            f.reference().unwrap().mean,
            exact_fit(&*f, 1..=10).unwrap().exponent,
            exact_fit(&*f, 2..=10).unwrap().exponent
        );
    }
    eprintln!("{:?}", t.elapsed());
}
