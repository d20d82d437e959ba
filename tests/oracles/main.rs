//! Lens, shutter, area lights, interreflection and filters against closed forms, and the whole
//! against another renderer.
//!
//! A study's grand mean over M trials is normal about the exact mean with variance s²/M. Each
//! oracle is asked for some rows; all standardised differences together must lie within 4.5,
//! which 1 of 147,000 normal ones does not.

mod filters;
mod mitsuba;
mod paths;

use std::f64::consts::PI;
use std::path::Path;
use stratcore::integrand::{Integrand, by_name};
use stratcore::scene::{Channel, load};
use stratcore::study::{Control, SamplerChoice, StudyPlan, study};
use stratcore::trace::{TracedScene, Tracer};

fn scene(toml: &str, obj: &str, mtl: &str) -> TracedScene {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("s.toml", toml);
    write("s.obj", &format!("mtllib s.mtl\n{obj}"));
    write("s.mtl", mtl);
    let path: &Path = &folder.path().join("s.toml");
    TracedScene::new(load(path.to_str().unwrap()).unwrap())
}

/// Camera at the origin that looks along -z: pixel (x, y) of 16 × 16, tan(fov/2) = 1.
fn camera(eye: [f64; 3], look_at: [f64; 3], up: [f64; 3]) -> String {
    format!(
        "[camera]\neye = {eye:?}\nlook_at = {look_at:?}\nup = {up:?}\nfov_y = 90.0\n\
         resolution = [16, 16]\n[[mesh]]\npath = \"s.obj\"\n"
    )
}

/// Standardised differences of the grand means of `random` and `jittered` from `exact`.
fn check(scene: &TracedScene, pixel: [u32; 2], axes: &[&str], exact: f64) {
    let integrand = scene.pixel(pixel, Channel::R);
    assert_eq!(integrand.axes(), axes);
    let per_axis: u64 = if axes.len() <= 3 { 4 } else { 2 };
    let strata = per_axis.pow(axes.len() as u32);
    let plan = StudyPlan {
        samplers: ["random", "jittered"].map(|name| SamplerChoice::named(name).unwrap()).to_vec(),
        counts: vec![1, strata],
        count_policy: stratcore::sampler::CountPolicy::Error,
        n_trials: 4000,
        seed: 1996,
    };
    let result = study(&integrand, pixel, &plan, Control::unwatched()).unwrap();
    for sampler in &result.samplers {
        for row in &sampler.rows {
            let std_error = (row.variance_of_mean / f64::from(plan.n_trials)).sqrt();
            let z = (row.grand_mean - exact) / std_error;
            assert!(
                z.abs() < 4.5,
                "{} N = {}: {} against {exact}, z = {z}",
                sampler.name,
                row.n,
                row.grand_mean
            );
        }
    }
}

/// Mean of `f` over [0, 1) by the midpoint rule.
fn mean(steps: u32, f: impl Fn(f64) -> f64) -> f64 {
    (0..steps).map(|i| f((f64::from(i) + 0.5) / f64::from(steps))).sum::<f64>() / f64::from(steps)
}

/// Form factor from a point to a parallel rectangle at height h, whose corner lies over the
/// point and whose sides are a and b (Howell, *A Catalog of Radiation Heat Transfer
/// Configuration Factors*, B-3).
fn corner_form_factor(a: f64, b: f64, h: f64) -> f64 {
    let (p, q) = ((a * a + h * h).sqrt(), (b * b + h * h).sqrt());
    (a / p * (b / p).atan() + b / q * (a / q).atan()) / (2.0 * PI)
}

fn form_factor(x: [f64; 2], z: [f64; 2], h: f64) -> f64 {
    let f = |a, b| corner_form_factor(a, b, h);
    f(x[1], z[1]) - f(x[0], z[1]) - f(x[1], z[0]) + f(x[0], z[0])
}

/// Between perpendicular squares and between disks, whatever places the points. 32 differences:
/// a false alarm once in 4,600 seeds.
#[test]
fn form_factors_are_met_without_bias() {
    for (name, params) in [
        ("form-factor-perpendicular", vec![("gap".to_owned(), 0.2)]),
        ("form-factor-perpendicular", vec![]),
        ("form-factor-disks", vec![]),
        ("form-factor-disks", vec![("radius".to_owned(), 3.0), ("distance".to_owned(), 0.5)]),
    ] {
        let f = by_name(name, Some(4), &params).unwrap();
        let exact = f.reference().unwrap().mean;
        let names = ["random", "jittered", "jittered-padded", "sobol"];
        let plan = StudyPlan {
            samplers: names.map(|name| SamplerChoice::named(name).unwrap()).to_vec(),
            counts: vec![1, 256],
            n_trials: 2000,
            ..StudyPlan::paper()
        };
        let result = study(&*f, [0, 0], &plan, Control::unwatched()).unwrap();
        for sampler in &result.samplers {
            for row in &sampler.rows {
                let std_error = (row.variance_of_mean / f64::from(plan.n_trials)).sqrt();
                let z = (row.grand_mean - exact) / std_error;
                assert!(
                    z.abs() < 4.5,
                    "{name} {params:?}, {}, N = {}: z = {z}",
                    sampler.name,
                    row.n
                );
            }
        }
    }
}

const FLOOR: &str = "v -50 0 -50\nv 50 0 -50\nv 50 0 50\nv -50 0 50\nusemtl white\nf 1 2 3 4\n";
const WHITE: &str = "newmtl white\nKd 1 1 1\n";

/// A camera half a unit over the floor that looks down: pixel offset (u, v) of pixel (px, py)
/// sees the floor at (x, z).
fn down(pixel: [u32; 2], u: f64, v: f64) -> [f64; 2] {
    let at = |p: u32, o: f64| ((f64::from(p) + o) / 8.0 - 1.0) * 0.5;
    // Forward is -y, up is -z, right is +x.
    [at(pixel[0], u), at(pixel[1], v)]
}

#[test]
fn a_half_plane_before_a_rectangle_casts_the_known_penumbra() {
    let toml = camera([0.0, 0.5, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, -1.0])
        + "[light]\nkind = \"area\"\nshape = \"rectangle\"\ncorner = [-1, 2, -1]\n\
           edges = [[2, 0, 0], [0, 0, 2]]\nradiance = [1, 1, 1]\n";
    let blocker = "v -90 1 -90\nv 0 1 -90\nv 0 1 90\nv -90 1 90\nf 5 6 7 8\n";
    let scene = scene(&toml, &format!("{FLOOR}{blocker}"), WHITE);
    for pixel in [[4, 6], [9, 8], [13, 2]] {
        let exact = mean(64, |u| {
            mean(64, |v| {
                let [x, z] = down(pixel, u, v);
                // The blocker's edge, seen from (x, 0, z), cuts the light's plane at -x.
                let lit = [(-x).max(-1.0) - x, 1.0 - x];
                form_factor(lit, [-1.0 - z, 1.0 - z], 2.0)
            })
        });
        check(&scene, pixel, &["pixel_x", "pixel_y", "light_u", "light_v"], exact);
    }
}

#[test]
fn disk_sphere_and_mesh_light_as_they_should() {
    let camera = camera([0.0, 0.5, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, -1.0]);
    let light = |text: &str| format!("{camera}[light]\nkind = \"area\"\n{text}\n");
    let axes = ["pixel_x", "pixel_y", "light_u", "light_v"];
    let pixel = [8, 8];
    let over = |f: &dyn Fn(f64, f64) -> f64| {
        mean(64, |u| {
            mean(64, |v| {
                let [x, z] = down(pixel, u, v);
                f(x, z)
            })
        })
    };
    // A parallel disk off the axis (Howell B-14).
    let disk = |x: f64, z: f64| {
        let (h, r, a2) = (1.5, 0.7, x * x + z * z);
        let (h2, r2) = (h * h, r * r);
        let sum = h2 + a2 + r2;
        0.5 * (1.0 - (h2 + a2 - r2) / (sum * sum - 4.0 * a2 * r2).sqrt())
    };
    let text = "shape = \"disk\"\ncentre = [0, 1.5, 0]\nnormal = [0, -2, 0]\nradius = 0.7\n\
                radiance = [1, 1, 1]";
    check(&scene(&light(text), FLOOR, WHITE), pixel, &axes, over(&disk));
    // A sphere wholly above the horizon: (R/d)² cos θ.
    let sphere = |x: f64, z: f64| {
        let d2: f64 = x * x + z * z + 1.5 * 1.5;
        0.49 / d2 * 1.5 / d2.sqrt()
    };
    let text = "shape = \"sphere\"\ncentre = [0, 1.5, 0]\nradius = 0.7\nradiance = [1, 1, 1]";
    check(&scene(&light(text), FLOOR, WHITE), pixel, &axes, over(&sphere));
    // Two triangles of a lamp.
    let lamp = "v -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\nusemtl lamp\nf 5 6 7 8\n";
    let mtl = format!("{WHITE}newmtl lamp\nKd 0 0 0\nKe 2 2 2\n");
    let exact = over(&|x, z| 2.0 * form_factor([-1.0 - x, 1.0 - x], [-1.0 - z, 1.0 - z], 2.0));
    let text = "shape = \"mesh\"\nmaterial = \"lamp\"";
    check(&scene(&light(text), &format!("{FLOOR}{lamp}"), &mtl), pixel, &axes, exact);
}

/// A bright half-plane x < 0.07 at depth 10 before a black sky, seen along -z.
const HALF_PLANE: &str = "v -900 -900 -10\nv 0.07 -900 -10\nv 0.07 900 -10\nv -900 900 -10\n\
                          usemtl lamp\nf 1 2 3 4\n";
const LAMP: &str = "newmtl lamp\nKd 0 0 0\nKe 1 1 1\n";

/// Where offset u of pixel column px meets depth 10.
fn across(px: u32, u: f64) -> f64 {
    10.0 * ((f64::from(px) + u) / 8.0 - 1.0)
}

fn along_z() -> String {
    camera([0.0; 3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0])
}

#[test]
fn a_lens_blurs_an_edge_by_its_chords() {
    let lens = "[lens]\nradius = 0.8\nfocus_distance = 4\n";
    let axes = ["pixel_x", "pixel_y", "lens_u", "lens_v"];
    // At depth 10 a lens offset l moves the hit by l (1 - 10/4).
    let blur = 0.8 * 1.5;
    let below = |t: f64| {
        let t = t.clamp(-1.0, 1.0);
        0.5 + (t * (1.0 - t * t).sqrt() + t.asin()) / PI
    };
    let blurred = scene(&(along_z() + lens), HALF_PLANE, LAMP);
    for px in [7, 8] {
        let exact = mean(4096, |u| below((0.07 - across(px, u)) / blur));
        check(&blurred, [px, 8], &axes, exact);
    }
    // A square aperture with its sides upright: the offset is uniform.
    let square = format!("{}{lens}blades = 4\nrotation = 45\n", along_z());
    let half = blur / 2f64.sqrt();
    let exact = mean(4096, |u| (((0.07 - across(8, u)) / half + 1.0) / 2.0).clamp(0.0, 1.0));
    check(&scene(&square, HALF_PLANE, LAMP), [8, 8], &axes, exact);
    // In focus the lens changes nothing.
    let sharp = scene(&(along_z() + &lens.replace('4', "10")), HALF_PLANE, LAMP);
    check(&sharp, [8, 8], &axes, 0.07 / 1.25);
}

#[test]
fn motion_blurs_an_edge_evenly() {
    let axes = ["pixel_x", "pixel_y", "time"];
    let moving = along_z() + "motion = [3, 0, 0]\n[shutter]\n";
    let covered = |px: u32| mean(4096, |u| (1.0 - (across(px, u) - 0.07) / 3.0).clamp(0.0, 1.0));
    for px in [8, 10] {
        check(&scene(&moving, HALF_PLANE, LAMP), [px, 8], &axes, covered(px));
    }
    // The same from a camera that moves the other way.
    let panned = along_z() + "[shutter]\ncamera_motion = [-3, 0, 0]\n";
    check(&scene(&panned, HALF_PLANE, LAMP), [8, 8], &axes, covered(8));
}

/// The lists of the fast path against the BVH, point by point.
#[test]
fn beam_and_rays_agree_under_area_lights() {
    let spread = |i: u32, axis: u32| {
        let ratio = [
            0.754_877_666_246_693,
            0.569_840_290_998_053,
            0.819_172_513_396_164,
            0.671_043_606_703_789,
        ];
        (0.5 + f64::from(i) * ratio[axis as usize]).fract()
    };
    let [beam, rays] = [Tracer::Beam, Tracer::Bvh]
        .map(|tracer| TracedScene::new(load("room").unwrap()).with_tracer(tracer));
    let mut shadowed = 0;
    for pixel in (0..256).step_by(16).flat_map(|x| (0..256).step_by(16).map(move |y| [x, y])) {
        let [beam, rays] = [&beam, &rays].map(|scene| scene.pixel(pixel, Channel::Luminance));
        assert_eq!((beam.dim(), beam.axes()), (4, rays.axes()));
        for i in 0..60 {
            let point = [0, 1, 2, 3].map(|axis| spread(i, axis));
            let [a, b] = [beam.eval(&point), rays.eval(&point)];
            assert!((a - b).abs() <= 1e-9 * b, "{pixel:?} {point:?}: {a} {b}");
            shadowed += u32::from(b < 0.02);
        }
    }
    assert!(shadowed > 500, "{shadowed}");
}

/// A filtered pixel behind a reference is still a weighted mean: a constant picture is exact.
#[test]
fn weights_survive_a_reference() {
    let filter = "[filter]\nkind = \"mitchell\"\n[background]\nradiance = [1, 1, 1]\n";
    let scene = scene(&(along_z() + filter), HALF_PLANE, LAMP);
    let pixel = scene.pixel([13, 3], Channel::R);
    let plan = StudyPlan { counts: vec![4, 16], n_trials: 5, ..StudyPlan::paper() };
    for integrand in [&pixel as &dyn Integrand, &&pixel] {
        let result = study(integrand, [13, 3], &plan, Control::unwatched()).unwrap();
        for row in result.samplers.iter().flat_map(|sampler| &sampler.rows) {
            assert!((row.grand_mean - 1.0).abs() < 1e-12, "{row:?}");
        }
    }
}
