//! Scenes that are very small, very large, very far from the origin, or seen very narrowly,
//! very widely and in very many pixels.

use super::studio::{
    all_pixels, ball_and_floor, both, differing_bits, farthest, larger, means, placed, scene,
};
use super::{Bench, Family, Row};
use crate::error::StudyError;
use crate::integrand::Integrand;
use crate::literature::{Curve, Figure, Slope};
use crate::scene::{
    Aperture, AreaLight, Camera, Channel, Distribution, Lens, Light, LightShape, Mesh, Scene,
};
use crate::study::{SamplerChoice, collect};
use crate::trace::TracedScene;
use crate::variance::Moments;
use glam::{DVec3, dvec3};

pub(super) const FAMILY: Family = Family {
    name: "scene",
    title: "Scale and place of a scene",
    advice: "Units do not matter: a scene that is scaled by a power of two gives the same bits, \
             in coordinates from 1e-18 to 1e15. Places matter as f64 numbers matter: \
             coordinates are f64 from the file on and are taken relative to the eye before \
             anything is rounded to f32, so a detail of 1e-3 at 1e7 units from the origin is \
             seen to a millionth of itself, where f32 coordinates lie one unit apart. Any field \
             of view from 0.001° to 179° and any pixel of a picture of 100,000² keep their \
             radiance and their variance.",
    measure,
};

fn measure(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    scaled(bench)?;
    moved(bench)?;
    fields_of_view(bench)?;
    resolutions(bench)
}

const JITTERED: SamplerChoice = SamplerChoice::JITTERED;
const POINT: DVec3 = dvec3(2.0, 4.0, 3.0);

/// The studio under each kind of light, and through a lens under a lamp, `scale` times as large.
fn scenes_at(scale: f64) -> Vec<Scene> {
    let (mesh, camera) = ball_and_floor();
    let (mesh, camera) = placed(&mesh, &camera, scale, DVec3::ZERO);
    let intensity = [20.0 * scale * scale; 3];
    let towards = dvec3(0.48, 0.64, 0.6);
    let lights = [
        Light::Headlight,
        Light::Point { position: POINT * scale, intensity },
        Light::Directional { towards, irradiance: [1.0; 3] },
    ];
    let mut scenes: Vec<_> =
        lights.into_iter().map(|light| scene(mesh.clone(), camera, light)).collect();
    let lamp = AreaLight {
        shape: LightShape::Rectangle {
            corner: dvec3(-1.0, 3.0, -1.0) * scale,
            edges: [DVec3::X * 2.0 * scale, DVec3::Z * 2.0 * scale],
        },
        radiance: [3.0; 3],
    };
    let lens = Lens { radius: 0.05 * scale, focus_distance: 4.0 * scale, aperture: Aperture::Disk };
    for lens in [None, Some(lens)] {
        let lights = vec![lamp.clone()];
        let distribution = Distribution { lens, lights, ..Distribution::default() };
        scenes.push(Scene { distribution, ..scene(mesh.clone(), camera, Light::Off) });
    }
    scenes
}

/// Means of every pixel of every scene at a scale, by the beam and by rays.
fn pictures(bench: &Bench<'_>, scale: f64) -> [Vec<f64>; 2] {
    let random = SamplerChoice::named("random").unwrap_or(JITTERED);
    let mut found = [Vec::new(), Vec::new()];
    for scene in scenes_at(scale) {
        let plain = scene.distribution.is_plain();
        let choice = if plain { JITTERED } else { random };
        let pixels: Vec<_> = all_pixels(&scene.camera).collect();
        for (found, traced) in found.iter_mut().zip(both(&scene)) {
            found.extend(means(bench, &traced, choice, 16, 1, pixels.iter().copied()));
        }
    }
    found
}

fn scaled(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    // Details of 2^-12 of a unit to start with, so that 60 doublings stay below 1e15.
    let base = 2f64.powi(-12);
    let steps: Vec<i32> = (-60..=60).step_by(bench.either(12, 1)).collect();
    let reference = pictures(bench, base);
    let bench_ref: &Bench<'_> = bench;
    let changed = collect(steps.clone(), |k| {
        bench_ref.check()?;
        let found = pictures(bench_ref, base * 2f64.powi(k));
        Ok::<_, StudyError>([0, 1].map(|tracer| differing_bits(&found[tracer], &reference[tracer])))
    })?;
    let total = (reference[0].len() * steps.len()) as f64;
    let [beam, rays] = [0, 1].map(|t| changed.iter().map(|c| c[t]).sum::<usize>() as f64 / total);
    bench.push(
        Row::new("scaled by powers of two", "share of pixels that change a bit", 0.0)
            .tried(format!(
                "coordinates times 2^k, k = -60 to 60 in {} steps, 256 pixels under a headlight, \
                 a point light, a directional light, a lamp, and a lens",
                steps.len()
            ))
            .f32(beam)
            .f64(rays)
            .error(beam.max(rays))
            .floor(0.0)
            .note(
                "scaling by a power of two is exact; what is compared, sorted or padded scales \
                 with it",
            ),
    );
    Ok(())
}

/// Coordinates rounded to f32 where they lie.
fn as_f32(mesh: &Mesh, camera: &Camera) -> (Mesh, Camera) {
    let round = |p: DVec3| p.as_vec3().as_dvec3();
    let mesh =
        Mesh { positions: mesh.positions.iter().map(|p| round(*p)).collect(), ..mesh.clone() };
    (mesh, Camera { eye: round(camera.eye), look_at: round(camera.look_at), ..*camera })
}

fn moved(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    // Features: the ball's facets are 0.15 wide, 1e-3 once scaled.
    let scale = 1e-3 / 0.15;
    let (mesh, camera) = ball_and_floor();
    let (mesh, camera) = placed(&mesh, &camera, scale, DVec3::ZERO);
    let pixels: Vec<_> = all_pixels(&camera).collect();
    let picture = |bench: &Bench<'_>, mesh: Mesh, camera: Camera| {
        both(&scene(mesh, camera, Light::Headlight))
            .map(|traced| means(bench, &traced, JITTERED, 256, 1, pixels.iter().copied()))
    };
    let reference = picture(bench, mesh.clone(), camera);
    let mut worst = [0.0f64; 2];
    let mut single_worst = 0.0f64;
    let mut curves = [Vec::new(), Vec::new()];
    for power in 0..=7 {
        bench.check()?;
        let by = dvec3(1.0, -0.7, 0.3) * 10f64.powi(power);
        let (mesh, camera) = placed(&mesh, &camera, 1.0, by);
        let found = picture(bench, mesh.clone(), camera);
        let off = [0, 1].map(|t| farthest(&found[t], &reference[t]));
        for (worst, off) in worst.iter_mut().zip(off) {
            *worst = larger(*worst, off);
        }
        let (mesh, camera) = as_f32(&mesh, &camera);
        // At 1e7 the eye is where it looks: there is no picture.
        let single = match camera.check() {
            Ok(()) => farthest(&picture(bench, mesh, camera)[1], &reference[1]),
            Err(_) => f64::INFINITY,
        };
        single_worst = single_worst.max(single);
        let distance = 10f64.powi(power);
        curves[0].push([distance, single.min(1.0), 0.0, 0.0]);
        if off[0] > 0.0 {
            curves[1].push([distance, off[0].max(off[1]), 0.0, 0.0]);
        }
    }
    // A coordinate at 1e7 is off by 2^-30, the eye and a vertex by both, on features that are
    // seen 3e-2 away in pixels of 0.058 rad: 2e-6 of a pixel; an edge of the whole contrast,
    // 0.6, and √2 long then moves a mean by 2e-6, several of them by more. Of 256 samples one
    // is worth 2e-3: a sample that near an edge is met once in some 1,000 pixels.
    let limit = 0.6 / 256.0;
    bench.push(
        Row::new("moved by 10^7 units", "largest change of a pixel's mean", limit)
            .tried("facets of 1e-3, moved by 1 to 10^7 units, 256 pixels of 256 samples")
            .f32(single_worst)
            .f64(worst[1])
            .error(worst[0].max(worst[1]))
            .floor(2e-6)
            .note(
                "f32: coordinates rounded to f32 where they lie, as a renderer does that knows no \
                 others; f64: by rays. Coordinates are relative to the eye before they are \
                 rounded: f64 at 1e7 is 2e-9, a millionth of a facet. The limit is one sample of \
                 256 on the other side of an edge",
            ),
    );
    let [of_f32, of_ours] = curves;
    bench.draw(Figure {
        name: "stability-moved",
        title: "A scene far from the origin",
        caption: "Largest change of a pixel's mean when a scene with details of 1e-3 is moved \
                  away from the origin. Dashed: the spacing of f64 numbers there, over the size \
                  of a detail."
            .to_owned(),
        axes: ["distance from the origin", "largest change of a pixel"],
        log_x: true,
        curves: vec![
            Curve { name: "f32 coordinates".to_owned(), points: of_f32 },
            Curve { name: "as used".to_owned(), points: of_ours },
        ],
        slopes: vec![Slope { name: "floor, f64", factor: 2f64.powi(-53) / 1e-3, power: 1.0 }],
    });
    Ok(())
}

/// A wall square to the view, 1 away: under a headlight its radiance is Kd / |D|, D the
/// direction of length 1 along the view.
fn wall(fov_y: f64, resolution: [u32; 2]) -> Scene {
    let far = 1e6;
    let corner = |x, y| dvec3(x * far, y * far, -1.0);
    let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let camera = Camera {
        eye: DVec3::ZERO,
        look_at: dvec3(0.0, 0.0, -1.0),
        up: DVec3::Y,
        fov_y,
        resolution,
    };
    scene(Mesh::loose([[a, b, c], [a, c, d]]), camera, Light::Headlight)
}

/// Of one pixel of a wall: largest relative error of a sample, and relative error of the
/// variance of its samples, for the beam and for rays. All at the f32 positions that the beam
/// uses.
fn wall_errors(scene: &Scene, pixel: [u32; 2]) -> [[f64; 2]; 2] {
    let kd = Channel::Luminance.of(scene.materials[0].kd);
    let [w, h] = scene.camera.resolution.map(f64::from);
    let tan = (scene.camera.fov_y.to_radians() / 2.0).tan();
    let points: Vec<[f64; 2]> = (0..256)
        .map(|i| {
            let at = |i: u32| f64::from(((f64::from(i) + 0.5) / 16.0 - 0.5) as f32) + 0.5;
            [at(i % 16), at(i / 16)]
        })
        .collect();
    let exact: Vec<f64> = points
        .iter()
        .map(|[u, v]| {
            let x = (2.0 * (f64::from(pixel[0]) + u) / w - 1.0) * tan * w / h;
            let y = (1.0 - 2.0 * (f64::from(pixel[1]) + v) / h) * tan;
            kd / (1.0 + x * x + y * y).sqrt()
        })
        .collect();
    let spread = Moments::of(&exact).variance;
    both(scene).map(|traced: TracedScene| {
        let mut found = vec![0.0; points.len()];
        traced.pixel(pixel, Channel::Luminance).eval_block(points.as_flattened(), &mut found);
        let off = found.iter().zip(&exact).map(|(a, b)| (a / b - 1.0).abs());
        let variance = Moments::of(&found).variance;
        [off.fold(0.0, larger), (variance / spread - 1.0).abs()]
    })
}

/// Worst of many: of [errors of a sample, of the variance] by [beam, rays].
fn worst_of(found: impl IntoIterator<Item = [[f64; 2]; 2]>) -> [[f64; 2]; 2] {
    found.into_iter().fold([[0.0; 2]; 2], |worst, found| {
        [0, 1].map(|t| [0, 1].map(|q| larger(worst[t][q], found[t][q])))
    })
}

fn fields_of_view(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    let angles = [0.001, 0.01, 0.1, 1.0, 10.0, 45.0, 90.0, 150.0, 170.0, 178.0, 179.0];
    let mut found = Vec::new();
    for angle in angles {
        bench.check()?;
        let scene = wall(angle, [64, 64]);
        found.extend([[32, 32], [0, 0], [63, 20]].map(|pixel| wall_errors(&scene, pixel)));
    }
    let worst = worst_of(found.iter().copied());
    bench.push(
        Row::new("field of view", "relative error of a sample", 1e-6)
            .tried("0.001° to 179°, middle, corner and side of 64 × 64 pixels")
            .f32(worst[0][0])
            .f64(worst[1][0])
            .error(worst[0][0])
            .floor(f64::from(f32::EPSILON) / 2.0)
            .note("against the closed form of a wall under a headlight"),
    );
    Ok(())
}

fn resolutions(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    let sides = [16u32, 256, 4096, 65_536, 100_000];
    let mut found = Vec::new();
    let mut curves = [Vec::new(), Vec::new()];
    for side in sides {
        bench.check()?;
        let scene = wall(60.0, [side, side]);
        let pixels = [[0, 0], [side - 1, side - 1], [side / 3, side / 5]];
        let here = worst_of(pixels.map(|pixel| wall_errors(&scene, pixel)));
        for (curve, here) in curves.iter_mut().zip(here) {
            if here[1] > 0.0 {
                curve.push([f64::from(side), here[1], 0.0, 0.0]);
            }
        }
        found.push(here);
    }
    let worst = worst_of(found);
    bench.push(
        Row::new("resolution", "relative error of a pixel's variance", 1e-4)
            .tried("three pixels of 16² to 100,000²")
            .f32(worst[0][1])
            .f64(worst[1][1])
            .error(worst[0][1])
            .floor(f64::from(f32::EPSILON))
            .note(
                "radiance changes by 1e-5 across a pixel of 100,000², 100 times what f32 could \
                 show of the radiance itself; the beam's values are relative to the pixel's \
                 middle and keep it",
            ),
    );
    let [beam, rays] = curves;
    bench.draw(Figure {
        name: "stability-resolution",
        title: "The variance of a pixel, by the resolution of its picture",
        caption: "Relative error of the variance of 256 samples in a pixel of a smooth wall."
            .to_owned(),
        axes: ["pixels along a side", "relative error of the variance"],
        log_x: true,
        curves: vec![
            Curve { name: "beam, f32".to_owned(), points: beam },
            Curve { name: "rays, f64".to_owned(), points: rays },
        ],
        slopes: vec![
            Slope { name: "f32", factor: f64::from(f32::EPSILON), power: 0.0 },
            Slope { name: "f64", factor: f64::EPSILON, power: 0.0 },
        ],
    });
    Ok(())
}
