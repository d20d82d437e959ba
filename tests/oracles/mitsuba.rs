//! Our room against Mitsuba's.

use stratcore::scene::load;
use stratcore::study::{Control, SamplerChoice, render};
use stratcore::trace::TracedScene;

const SIZE: usize = 64;
const REGIONS: usize = 8;
const RENDERS: u64 = 24;

/// What `contrib/reference/mitsuba_room.py` renders as well.
fn room(extra: &str) -> TracedScene {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("room.obj", include_str!("../reference/room.obj"));
    write("room.mtl", include_str!("../reference/room.mtl"));
    let scene = format!(
        "[camera]\neye = [0, 1, 4.2]\nlook_at = [0, 0.95, 0]\nfov_y = 38.0\n\
         resolution = [{SIZE}, {SIZE}]\n[[mesh]]\npath = \"room.obj\"\n[light]\n\
         kind = \"area\"\nshape = \"mesh\"\nmaterial = \"lamp\"\n{extra}"
    );
    write("room.toml", &scene);
    TracedScene::new(load(folder.path().join("room.toml").to_str().unwrap()).unwrap())
}

/// Mean and standard error of each channel of each region, from independent pictures.
fn regions(scene: &TracedScene) -> Vec<[[f64; 2]; 3]> {
    let mut sums = vec![[[0.0; 2]; 3]; REGIONS * REGIONS];
    let side = SIZE / REGIONS;
    for seed in 0..RENDERS {
        let sampler = SamplerChoice::named("random").unwrap();
        let picture = render(scene, sampler, 4, seed, Control::unwatched()).unwrap();
        let mut means = vec![[0.0; 3]; REGIONS * REGIONS];
        for (at, pixel) in picture.pixels.iter().enumerate() {
            let region = at / SIZE / side * REGIONS + at % SIZE / side;
            for (mean, value) in means[region].iter_mut().zip(pixel) {
                *mean += value / (side * side) as f64;
            }
        }
        for (sums, means) in sums.iter_mut().zip(&means) {
            for (sum, mean) in sums.iter_mut().zip(means) {
                *sum = [sum[0] + mean, sum[1] + mean * mean];
            }
        }
    }
    let n = RENDERS as f64;
    let moments = |[sum, squares]: [f64; 2]| {
        let mean = sum / n;
        [mean, ((squares / n - mean * mean).max(0.0) / (n - 1.0)).sqrt()]
    };
    sums.into_iter().map(|sums| sums.map(moments)).collect()
}

/// A region's z has both standard errors in it, each from 24 pictures, so it is Student's with
/// 23 to 46 degrees of freedom: |z| > 6 once in 240,000 at 23, and there are 576. The mean of z²
/// over a variant's 64 regions is 1.07 ± 0.2 in green; the bound is four of that.
#[test]
fn mitsuba_sees_the_same_room() {
    let reference = include_str!("../reference/mitsuba_room.csv");
    for (variant, extra) in [
        ("direct", ""),
        ("bounces", "[paths]\nbounces = 2\n"),
        ("lens", "[lens]\nradius = 0.09\nfocus_distance = 4.58\n"),
    ] {
        let ours = regions(&room(extra));
        let lines = reference.lines().filter(|line| line.starts_with(variant));
        let mut squares = 0.0;
        let mut compared = 0;
        for line in lines {
            let fields: Vec<f64> =
                line.split(',').skip(1).map(|field| field.parse().unwrap()).collect();
            let at = fields[1] as usize * REGIONS + fields[0] as usize;
            for channel in 0..3 {
                let [mean, std_error] = ours[at][channel];
                let [theirs, their_error] = [fields[2 + channel], fields[5 + channel]];
                let unsure = std_error.hypot(their_error);
                // Where neither met anything, or neither scatters beyond rounding.
                let z = (mean - theirs) / unsure.max(1e-6 * theirs).max(1e-12);
                assert!(
                    z.abs() < 6.0,
                    "{variant} {at} {channel}: {mean} against {theirs}, z = {z}"
                );
                if channel == 1 && unsure > 1e-6 * theirs {
                    squares += z * z;
                    compared += 1;
                }
            }
        }
        let mean_square = squares / f64::from(compared);
        assert!(compared >= 50, "{variant}: {compared}");
        assert!((0.27..1.87).contains(&mean_square), "{variant}: mean z² = {mean_square}");
    }
}
