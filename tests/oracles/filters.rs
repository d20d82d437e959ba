//! Filters against integrals made here, from the published formulas.

use super::{LAMP, along_z, scene};
use std::f64::consts::PI;
use stratcore::scene::Channel;
use stratcore::study::{Control, SamplerChoice, StudyPlan, study};

/// A bright quadrant before a black sky: of the 16 × 16 pixels it covers columns up to 8.4 and
/// rows from 7.76 on.
const QUADRANT: &str = "v -900 -900 -10\nv 0.5 -900 -10\nv 0.5 0.3 -10\nv -900 0.3 -10\n\
                        usemtl lamp\nf 1 2 3 4\n";
const PIXEL: [u32; 2] = [8, 7];
/// Where the quadrant ends, from the pixel's middle: bright to the left, and below.
const ENDS: [f64; 2] = [-0.1, 0.26];

/// Mitchell and Netravali's cubic in its general form, B = C = 1/3.
fn cubic(x: f64) -> f64 {
    let (b, c, x) = (1.0 / 3.0, 1.0 / 3.0, x.abs());
    if x < 1.0 {
        ((12.0 - 9.0 * b - 6.0 * c) * x.powi(3) + (-18.0 + 12.0 * b + 6.0 * c) * x * x + 6.0
            - 2.0 * b)
            / 6.0
    } else if x < 2.0 {
        ((-b - 6.0 * c) * x.powi(3)
            + (6.0 * b + 30.0 * c) * x * x
            + (-12.0 * b - 48.0 * c) * x
            + 8.0 * b
            + 24.0 * c)
            / 6.0
    } else {
        0.0
    }
}

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) }
}

/// Share of the weights between two offsets, by the midpoint rule.
fn share(w: impl Fn(f64) -> f64, radius: f64, from: f64, to: f64) -> f64 {
    let integral = |from: f64, to: f64| {
        const STEPS: u32 = 20_000;
        let h = (to - from) / f64::from(STEPS);
        (0..STEPS).map(|i| h * w(from + (f64::from(i) + 0.5) * h)).sum::<f64>()
    };
    integral(from.max(-radius), to.min(radius)) / integral(-radius, radius)
}

/// The value of the pixel: filter and quadrant are products.
fn value(w: impl Fn(f64) -> f64, radius: f64) -> f64 {
    share(&w, radius, -radius, ENDS[0]) * share(&w, radius, ENDS[1], radius)
}

/// Each filter at its usual radius and at an odd one; the weighted mean's bias of O(1/N) is
/// tried at N = 4096, where it is a third of a standard error at most. 60 differences: a false
/// alarm once in 2,500 seeds at 4.5.
#[test]
fn each_filter_weighs_the_picture_as_published() {
    type Shape = fn(f64, f64) -> f64;
    let gaussian: Shape = |x, r| (-4.5 * (x / r).powi(2)).exp() - (-4.5f64).exp();
    let shapes: [(&str, [f64; 2], Shape); 5] = [
        ("box", [0.5, 0.8], |_, _| 1.0),
        ("tent", [1.0, 1.7], |x, r| 1.0 - x.abs() / r),
        ("gaussian", [1.5, 2.2], gaussian),
        ("mitchell", [2.0, 1.3], |x, r| cubic(2.0 * x / r)),
        ("lanczos", [3.0, 2.0], |x, r| sinc(x) * sinc(x / r)),
    ];
    for (kind, radii, w) in shapes {
        for radius in radii {
            let exact = value(|x| w(x, radius), radius);
            for (method, n, n_trials) in
                [("weighted-sum", 16, 4000), ("importance", 16, 4000), ("weighted-mean", 4096, 200)]
            {
                let filter = format!(
                    "[filter]\nkind = \"{kind}\"\nradius = {radius:?}\nmethod = \"{method}\"\n"
                );
                let scene = scene(&(along_z() + &filter), QUADRANT, LAMP);
                let plan = StudyPlan { counts: vec![n], n_trials, ..StudyPlan::paper() };
                let pixel = scene.pixel(PIXEL, Channel::R);
                let result = study(&pixel, PIXEL, &plan, Control::unwatched()).unwrap();
                for sampler in &result.samplers {
                    let row = &sampler.rows[0];
                    let std_error = (row.variance_of_mean / f64::from(n_trials)).sqrt();
                    let z = (row.grand_mean - exact) / std_error;
                    assert!(
                        z.abs() < 4.5,
                        "{kind} {radius} {method}, {}: {} against {exact}, z = {z}",
                        sampler.name,
                        row.grand_mean
                    );
                }
            }
        }
    }
}

/// A filter that overshoots: beside the bright side of an edge its mean is above 1, beside the
/// dark side below 0, by what the filter's integral says. Six differences: a false alarm once in
/// 25,000 seeds at 4.5.
#[test]
fn negative_lobes_overshoot() {
    const RADIUS: f64 = 3.0;
    let wall =
        "v -900 -900 -10\nv 0 -900 -10\nv 0 900 -10\nv -900 900 -10\nusemtl lamp\nf 1 2 3 4\n";
    // Pixels whose middles lie 1.5 to either side of the edge.
    let share = |to| share(|x| sinc(x) * sinc(x / RADIUS), RADIUS, -RADIUS, to);
    let pixels = [(6, share(1.5)), (9, share(-1.5))];
    assert!(pixels[0].1 > 1.017 && pixels[1].1 < -0.017);
    for method in ["weighted-mean", "weighted-sum", "importance"] {
        let filter = format!("[filter]\nkind = \"lanczos\"\nmethod = \"{method}\"\n");
        let scene = scene(&(along_z() + &filter), wall, LAMP);
        for (column, exact) in pixels {
            let plan = StudyPlan {
                samplers: vec![SamplerChoice::JITTERED],
                counts: vec![4096],
                n_trials: 50,
                ..StudyPlan::paper()
            };
            let pixel = [column, 7];
            let result = study(&scene.pixel(pixel, Channel::R), pixel, &plan, Control::unwatched());
            let row = &result.unwrap().samplers[0].rows[0];
            let std_error = (row.variance_of_mean / f64::from(plan.n_trials)).sqrt();
            let z = (row.grand_mean - exact) / std_error;
            assert!(
                z.abs() < 4.5,
                "{method}, column {column}: {} for {exact}, z = {z}",
                row.grand_mean
            );
        }
    }
}
