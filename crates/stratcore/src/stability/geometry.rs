//! Triangles that meet, overlap, vanish, or crowd into one pixel.

use super::studio::{
    all_pixels, ball_and_floor, both, differing_bits, farthest, larger, means, scene,
};
use super::{Bench, Family, PLACEMENT, Row, watertight};
use crate::error::StudyError;
use crate::integrand::Integrand;
use crate::scene::{Camera, Channel, Light, Material, Mesh, Scene};
use crate::simd::Isa;
use crate::study::SamplerChoice;
use crate::trace::{PixelIntegrand, TracedScene};
use crate::variance::Moments;
use glam::{DVec3, dvec3};
use std::f64::consts::TAU;

pub(super) const FAMILY: Family = Family {
    name: "geometry",
    title: "Geometry",
    advice: "A closed mesh is closed: no sample slips between two triangles that share an edge \
             or a corner, by the beam or by rays, since the sign that decides is computed \
             without rounding where rounding could change it. Slivers, triangles without area \
             and doubles do no harm; of two triangles with the same corners the first in the \
             file is seen. Of others that lie in one plane rounding decides, the same way every \
             time: do not rely on which. A triangle in whose plane the eye lies is not seen.",
    measure,
};

fn measure(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    watertight::rows(bench)?;
    needles(bench)?;
    spoilt(bench)?;
    overlaps(bench)?;
    through_the_eye(bench)?;
    crowd(bench)?;
    empty(bench);
    Ok(())
}

const JITTERED: SamplerChoice = SamplerChoice::JITTERED;
/// Rounding of an f32 below 1.
const HALF_ULP: f64 = 1.0 / (1 << 25) as f64;

/// Looks from z = 4 at the square from (-1, -1, 0) to (1, 1, 0), which fills 16 × 16 pixels.
fn before_the_square(resolution: u32) -> Camera {
    Camera {
        eye: dvec3(0.0, 0.0, 4.0),
        look_at: DVec3::ZERO,
        up: DVec3::Y,
        fov_y: 2.0 * 0.25f64.atan().to_degrees(),
        resolution: [resolution; 2],
    }
}

/// A scene whose surfaces are 1 and whose background is 1,000: one sample that misses shows.
fn glowing(mesh: Mesh, camera: Camera) -> Scene {
    let mut scene = scene(mesh, camera, Light::Off);
    scene.materials[0].ke = [1.0; 3];
    scene.background = [1000.0; 3];
    scene
}

/// Needles 3 long and 2e-8 wide, side by side, that fill one column of pixels.
fn needles(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    const NEEDLES: u32 = 2000;
    let width = 2e-8;
    let mut columns: Vec<f64> = (0..=NEEDLES).map(|i| width * f64::from(i)).collect();
    columns.insert(0, -1.5);
    columns.push(1.5);
    let mut mesh = Mesh::default();
    for x in &columns {
        mesh.positions.extend([dvec3(*x, -1.5, 0.0), dvec3(*x, 1.5, 0.0)]);
    }
    for i in 0..columns.len() as u32 - 1 {
        let [a, b, c, d] = [2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1];
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh.materials = vec![0; mesh.triangles.len()];
    // Pixels of column 8 begin at x = 0 and are as wide as all needles.
    let half = 8.0 * width * f64::from(NEEDLES);
    let camera = Camera { fov_y: 2.0 * (half / 4.0).atan().to_degrees(), ..before_the_square(16) };
    let scene = glowing(mesh, camera);
    let pixels: Vec<_> = (0..16).map(|y| [8, y]).collect();
    let n = bench.either(1 << 10, 1 << 14);
    let mut missed = [0.0; 2];
    for (missed, traced) in missed.iter_mut().zip(both(&scene)) {
        bench.check()?;
        let found = means(bench, &traced, JITTERED, n, 4, pixels.iter().copied());
        *missed = found.iter().map(|mean| (mean - 1.0) / 999.0).sum::<f64>() / found.len() as f64;
    }
    bench.push(
        Row::new("needles", "share of samples that slip between", 0.0)
            .tried(format!(
                "{} triangles of aspect 1.5e8 side by side in 16 pixels, {} samples",
                2 * NEEDLES,
                64 * n
            ))
            .f32(missed[0])
            .f64(missed[1])
            .error(missed[0].max(missed[1]))
            .floor(0.0)
            .note("2,000 needles across each pixel, seen in 0.009°"),
    );
    Ok(())
}

/// Triangles without area, doubles, and corners that are no numbers change no picture.
fn spoilt(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    let (mesh, camera) = ball_and_floor();
    let mut bad = mesh.clone();
    let nowhere = bad.positions.len() as u32;
    bad.positions.extend([DVec3::NAN, DVec3::splat(f64::INFINITY)]);
    for id in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.triangles[id];
        // The double has the higher index and loses every tie.
        bad.triangles.extend([[a, b, c], [a, a, b], [b, b, b], [a, b, a]]);
        if id % 16 == 0 {
            bad.triangles.extend([[a, b, nowhere], [nowhere, nowhere + 1, c]]);
        }
    }
    bad.materials = vec![0; mesh.triangles.len()];
    bad.materials.resize(bad.triangles.len(), 1);
    let pixels: Vec<_> = all_pixels(&camera).collect();
    let mut changed = [0.0; 2];
    let light = Light::Point { position: dvec3(2.0, 4.0, 3.0), intensity: [20.0; 3] };
    let good = scene(mesh, camera, light);
    let mut spoilt = Scene { mesh: bad, ..good.clone() };
    spoilt.materials.push(Material { ke: [1e6; 3], ..Default::default() });
    for (changed, (good, spoilt)) in
        changed.iter_mut().zip(both(&good).into_iter().zip(both(&spoilt)))
    {
        bench.check()?;
        let [a, b] =
            [good, spoilt].map(|s| means(bench, &s, JITTERED, 16, 2, pixels.iter().copied()));
        *changed = farthest(&a, &b);
    }
    bench.push(
        // Values of up to 1 have six coefficients, each rounded to f32.
        Row::new("degenerate and duplicate triangles", "largest change of a mean", 6.0 * HALF_ULP)
            .tried(
                "each triangle of a scene doubled, with three of no area beside it, some with \
                 corners that are not finite; 256 pixels, a point light with shadows",
            )
            .f32(changed[0])
            .f64(changed[1])
            .error(changed[0].max(changed[1]))
            .floor(HALF_ULP)
            .note(
                "the doubles would glow by 10^6 if they were ever seen. Rays change no bit; the \
                 beam settles in f64 which of two equal triangles is seen, and then shades in f64 \
                 what it else shades in f32",
            ),
    );
    Ok(())
}

/// Coplanar triangles over one another: whichever way a sample is found, it sees the same one.
fn overlaps(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    const TRIANGLES: u64 = 40;
    // Of one slanted plane, so that nothing is round in binary; all contain the middle.
    let stream = bench.key(PLACEMENT, 7, 1).stream();
    let corners = (0..TRIANGLES).map(|i| {
        let [turn, size] = stream.pair(i);
        [0.0, 1.0, 2.0].map(|third: f64| {
            let (sin, cos) = (TAU * (turn + third / 3.0)).sin_cos();
            let [x, y] = [cos, sin].map(|c| (1.0 + 2.0 * size) * c);
            dvec3(x, y, 0.3 * x - 0.17 * y)
        })
    });
    let mut scene = scene(Mesh::loose(corners), before_the_square(16), Light::Off);
    // Each glows in its own way, by a number that f32 holds.
    scene.materials = (0..TRIANGLES)
        .map(|i| Material { ke: [1.0 + i as f64 / 64.0; 3], ..Material::default() })
        .collect();
    scene.mesh.materials = (0..TRIANGLES as u32).collect();
    let [beam, rays] = both(&scene);
    let pixels: Vec<_> = all_pixels(&scene.camera).collect();
    let per_pixel = bench.either(64, 4096);
    let stream = bench.key(PLACEMENT, 8, 1).stream();
    let (mut by_beam, mut by_rays, mut apart, mut total) = (0u64, 0u64, 0u64, 0u64);
    for (column, pixel) in (0u64..).zip(pixels) {
        bench.check()?;
        // At f32 positions about the middle, which the beam takes as they are.
        let points: Vec<f64> = (0..per_pixel)
            .flat_map(|i| stream.pair(column * per_pixel + i))
            .map(|x| f64::from((x - 0.5) as f32) + 0.5)
            .collect();
        let mut values = vec![0.0; points.len() / 2];
        let mut seen = vec![Vec::new(); values.len()];
        for isa in Isa::available() {
            let PixelIntegrand::Beam(pixel) = beam.pixel(pixel, Channel::R) else { continue };
            let pixel = pixel.with_isa(isa);
            pixel.eval_block(&points, &mut values);
            for ((seen, value), at) in seen.iter_mut().zip(&values).zip(points.chunks(2)) {
                seen.extend([*value, pixel.exact_sample(at[0], at[1]).1]);
            }
        }
        let frame = scene.camera.pixel(pixel);
        for (seen, at) in seen.iter().zip(points.chunks(2)) {
            by_beam += u64::from(seen.is_empty() || seen.iter().any(|value| *value != seen[0]));
            let direction = frame.direction(at[0], at[1]);
            let walked = rays.closest_hit(scene.camera.eye, direction);
            by_rays += u64::from(walked != rays.brute_force_hit(scene.camera.eye, direction));
            let shown = walked
                .map_or(scene.background[0], |hit| scene.materials[hit.triangle as usize].ke[0]);
            apart += u64::from(seen.first() != Some(&shown));
            total += 1;
        }
    }
    let share = |count: u64| count as f64 / total as f64;
    bench.push(
        Row::new("coplanar overlaps", "share of samples with two winners", 0.0)
            .tried(format!("{TRIANGLES} triangles of one slanted plane, {total} samples"))
            .f32(share(by_beam))
            .f64(share(by_rays))
            .error(share(by_beam + by_rays))
            .floor(0.0)
            .note(format!(
                "f32: the beam under each instruction set, and its f64 functions; f64: rays \
                 through the BVH and a loop over all triangles. Rounding decides which of two \
                 coplanar triangles is nearer, and beam and rays round in their own ways: they \
                 see different ones in {:.2} of the samples. Triangles with the same corners \
                 are equally near, and the first in the file is seen",
                share(apart)
            )),
    );
    Ok(())
}

/// Triangles whose plane the eye lies in, and triangles that reach behind the eye.
fn through_the_eye(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    let camera = before_the_square(16);
    let eye = camera.eye;
    let through = |a: DVec3, b: DVec3| [eye, eye + a, eye + b];
    let around = [
        // The eye as a corner, on an edge, and inside.
        through(dvec3(0.3, 0.2, -2.0), dvec3(-0.3, 0.1, -2.0)),
        [eye - DVec3::Z, eye + dvec3(0.1, 0.1, -3.0), eye + dvec3(-0.1, -0.1, 1.0)],
        [eye + dvec3(0.0, 1.0, 1.0), eye + dvec3(0.0, -1.0, 1.0), eye + dvec3(0.0, 0.0, -3.0)],
    ];
    // A floor from behind the eye to beyond the picture.
    let floor = [dvec3(-90.0, -0.5, 70.0), dvec3(90.0, -0.5, 70.0), dvec3(0.0, -0.5, -400.0)];
    let with = scene(Mesh::loose(around.into_iter().chain([floor])), camera, Light::Headlight);
    let without = scene(Mesh::loose([floor]), camera, Light::Headlight);
    let pixels: Vec<_> = all_pixels(&camera).collect();
    let mut changed = [0.0; 2];
    let mut floors = Vec::new();
    for (changed, (with, without)) in
        changed.iter_mut().zip(both(&with).into_iter().zip(both(&without)))
    {
        bench.check()?;
        let [a, b] =
            [with, without].map(|s| means(bench, &s, JITTERED, 16, 1, pixels.iter().copied()));
        *changed = differing_bits(&a, &b) as f64 / a.len() as f64;
        floors.push(b);
    }
    let seen = floors[1].iter().filter(|mean| **mean != Channel::Luminance.of(without.background));
    let seen = seen.count();
    bench.push(
        Row::new("triangles through the eye", "share of pixels that change a bit", 0.0)
            .tried(format!(
                "three triangles in whose plane the eye lies, before a floor that reaches behind \
                 it and is seen in {seen} of 256 pixels"
            ))
            .f32(changed[0])
            .f64(changed[1])
            .error(if seen == 0 { f64::NAN } else { changed[0].max(changed[1]) })
            .floor(0.0)
            .note("seen edge-on they cover nothing"),
    );
    Ok(())
}

/// 10^5 triangles in one pixel: what the beam makes of them against rays, on the same points.
fn crowd(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    const TRIANGLES: u64 = 100_000;
    let stream = bench.key(PLACEMENT, 9, 1).stream();
    let camera = before_the_square(16);
    // Pixel (8, 8) is the square from (0, -1/8) to (1/8, 0).
    let corners = (0..TRIANGLES).map(|i| {
        let [x, y] = stream.pair(4 * i).map(|c| c / 8.0);
        let [z, _] = stream.pair(4 * i + 1);
        let around = |j: u64| {
            let [dx, dy] = stream.pair(4 * i + j).map(|c| 0.004 * (c - 0.5));
            dvec3(x + dx, y - 0.125 + dy, 0.1 * z)
        };
        [around(2), around(3), dvec3(x, y - 0.125, 0.1 * z)]
    });
    let scene = scene(Mesh::loose(corners), camera, Light::Headlight);
    let n = bench.either(1 << 8, 1 << 12);
    let sobol = SamplerChoice::named("sobol")?;
    // By cells for the sequence, by tiles of strata for jittered points.
    let [beam, rays] = both(&scene).map(|traced| {
        [sobol, JITTERED].map(|choice| means(bench, &traced, choice, n, 16, [[8, 8]]))
    });
    let facets = TracedScene::new(scene).pixel([8, 8], Channel::Luminance).n_facets().unwrap_or(0);
    let off = beam.iter().zip(&rays).fold(0.0, |worst, (beam, rays)| {
        let (beam, rays) = (Moments::of(beam), Moments::of(rays));
        let off = |a: f64, b: f64| (a / b - 1.0).abs();
        larger(worst, larger(off(beam.variance, rays.variance), off(beam.mean, rays.mean)))
    });
    bench.push(
        // A sample within f32 rounding of an edge may fall on its other side; one of N moves
        // the variance by some 1/N of itself.
        Row::new("10^5 triangles in one pixel", "relative error of mean and s²", 1e-3)
            .tried(format!(
                "{facets} triangles in the beam, sobol and jittered, N = {n}, 16 trials, against rays"
            ))
            .f32(off)
            .error(off)
            .floor(f64::from(f32::EPSILON))
            .note(
                "the beam rounds a point to f32, rays do not: a sample within 3e-8 of an edge may \
                 fall on its other side",
            ),
    );
    Ok(())
}

fn empty(bench: &mut Bench<'_>) {
    let scene = scene(Mesh::default(), before_the_square(4), Light::Headlight);
    let background = Channel::Luminance.of(scene.background);
    let mut off = [0.0f64; 2];
    for (off, traced) in off.iter_mut().zip(both(&scene)) {
        let found = means(bench, &traced, JITTERED, 16, 8, all_pixels(&scene.camera));
        *off = found.iter().map(|mean| (mean / background - 1.0).abs()).fold(0.0, larger);
    }
    bench.push(
        Row::new("empty picture", "relative error of the background", f64::EPSILON)
            .tried("no triangle at all, 16 pixels")
            .f32(off[0])
            .f64(off[1])
            .error(off[0].max(off[1]))
            .floor(f64::EPSILON / 2.0)
            .note("every pixel is exact: its variance is zero"),
    );
}
