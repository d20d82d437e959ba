//! Mirrors, glass and interreflection against closed forms.

use super::{LAMP, along_z, camera, check, mean, scene};
use stratcore::integrand::Integrand;
use stratcore::scene::Channel;

/// Inside a closed box of emission E and reflectance ρ every path of b bounces sees
/// E (1 + ρ + … + ρ^b), whatever it hits.
#[test]
fn a_furnace_has_no_variance() {
    let cube = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n\
                usemtl oven\nf 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 4 3 7 8\nf 1 4 8 5\nf 2 3 7 6\n";
    let toml = camera([0.1, 0.2, 0.3], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0])
        + "[light]\nkind = \"area\"\nshape = \"rectangle\"\ncorner = [9, 9, 9]\n\
           edges = [[1, 0, 0], [0, 1, 0]]\nradiance = [0, 0, 0]\n[paths]\nbounces = 3\n";
    let oven = scene(&toml, cube, "newmtl oven\nKd 0.5 0.5 0.5\nKe 1 1 1\n");
    let pixel = oven.pixel([3, 5], Channel::R);
    assert_eq!(pixel.dim(), 10);
    for i in 0..1000u32 {
        let point: Vec<f64> = (0..10)
            .map(|axis| ((f64::from(i) + 0.5) * (0.618 + 0.1 * f64::from(axis))).fract())
            .collect();
        let seen = pixel.eval(&point);
        assert!((seen - 1.875).abs() < 1e-12, "{point:?}: {seen}");
    }
}

#[test]
fn a_perfect_mirror_and_clear_glass_lose_no_light() {
    let sky = "[background]\nradiance = [1, 1, 1]\n[paths]\nspecular_depth = 8\n\
               [light]\nkind = \"headlight\"\n";
    let pane = "v -9 -9 -5\nv 9 -9 -5\nv 9 9 -5\nv -9 9 -5\nusemtl m\nf 1 2 3 4\n";
    let toml = along_z() + sky;
    let mirror = scene(&toml, pane, "newmtl m\nKd 0 0 0\nKs 1 1 1\nillum 3\n");
    assert_eq!(mirror.pixel([8, 8], Channel::R).eval(&[0.5, 0.5]), 1.0);
    // One border: what is not reflected is let through.
    let glass = scene(&toml, pane, "newmtl m\nKd 0 0 0\nNi 1.5\nillum 7\n");
    let pixel = glass.pixel([11, 4], Channel::R);
    assert!((pixel.eval(&[0.5, 0.5]) - 1.0).abs() < 1e-15);
    assert_eq!(pixel.axes(), ["pixel_x", "pixel_y"]);
    // Without [paths] the same material is Lambertian.
    let plain = scene(&along_z(), pane, "newmtl m\nKd 0.5 0.5 0.5\nKs 1 1 1\nillum 3\n");
    let seen = plain.pixel([8, 8], Channel::R).eval(&[0.0, 0.0]);
    assert!((seen - 0.5).abs() < 1e-12, "{seen}");
}

/// A large square at depth z, to the left of x = `end`.
fn wall(end: f64, z: f64, first: u32) -> String {
    let [a, b, c, d] = [first, first + 1, first + 2, first + 3];
    format!(
        "v -900 -900 {z}\nv {end} -900 {z}\nv {end} 900 {z}\nv -900 900 {z}\nf {a} {b} {c} {d}\n"
    )
}

const PATHS: &str = "[paths]\nspecular_depth = 2\n";

/// The edge of a bright wall 10 behind the eye, in a mirror 5 before it: as if 20 away. A mirror
/// adds no dimension.
#[test]
fn a_mirror_shows_what_is_behind_the_eye() {
    let walls = format!("usemtl m\n{}usemtl lamp\n{}", wall(900.0, -5.0, 1), wall(0.7, 10.0, 5));
    let mtl = format!("{LAMP}newmtl m\nKd 0 0 0\nKs 0.5 0.5 0.5\nillum 3\n");
    let mirror = scene(&(along_z() + PATHS), &walls, &mtl);
    // Pixel 8 of 16 begins on the axis and is 2.5 wide there.
    check(&mirror, [8, 3], &["pixel_x", "pixel_y"], 0.5 * 0.7 / 2.5);
    assert_eq!(mirror.pixel([7, 3], Channel::R).eval(&[0.5, 0.5]), 0.5);
    assert_eq!(mirror.pixel([9, 3], Channel::R).eval(&[0.5, 0.5]), 0.0);
}

/// Fresnel's reflectance for unpolarised light that comes at this angle to a border with this
/// ratio of indices (behind over before).
fn fresnel(angle: f64, index: f64) -> f64 {
    let behind = (angle.sin() / index).asin();
    let [s, p] = if angle == 0.0 {
        [(index - 1.0) / (index + 1.0); 2]
    } else {
        [
            (angle - behind).sin() / (angle + behind).sin(),
            (angle - behind).tan() / (angle + behind).tan(),
        ]
    };
    0.5 * (s * s + p * p)
}

/// The edge of a bright wall 5 behind the face of a block of glass, which is 5 before the eye:
/// where Snell's law puts it, and as bright as Fresnel's equations let it through.
#[test]
fn glass_bends_an_edge() {
    const INDEX: f64 = 1.5;
    let walls = format!("usemtl m\n{}usemtl lamp\n{}", wall(900.0, -5.0, 1), wall(4.0, -10.0, 5));
    let mtl = format!("{LAMP}newmtl m\nKd 0 0 0\nNi {INDEX}\nillum 7\n");
    let glass = scene(&(along_z() + PATHS), &walls, &mtl);
    for pixel in [[11, 8], [11, 2]] {
        let tangent = |p: u32, offset: f64| (f64::from(p) + offset) / 8.0 - 1.0;
        let exact = mean(200, |v| {
            mean(2000, |u| {
                let [x, y] = [tangent(pixel[0], u), tangent(pixel[1], v)];
                let angle = x.hypot(y).atan();
                let bent = (angle.sin() / INDEX).asin().tan() / x.hypot(y);
                let seen = 5.0 * x + 5.0 * x * bent;
                if seen < 4.0 { 1.0 - fresnel(angle, INDEX) } else { 0.0 }
            })
        });
        assert!(exact > 0.2 && exact < 0.8, "{exact}");
        check(&glass, pixel, &["pixel_x", "pixel_y"], exact);
    }
}

/// From within glass a bright wall behind the eye is seen as far as the border reflects: by
/// Fresnel's equations up to the critical angle, wholly beyond it.
#[test]
fn glass_reflects_wholly_from_within() {
    // The border's normal points away from the eye.
    let border =
        "v -900 -900 -5\nv -900 900 -5\nv 900 900 -5\nv 900 -900 -5\nusemtl m\nf 1 2 3 4\n";
    let walls = format!("{border}usemtl lamp\n{}", wall(900.0, 10.0, 5));
    let mtl = format!("{LAMP}newmtl m\nKd 0 0 0\nNi 1.5\nillum 7\n");
    let within = scene(&(along_z() + PATHS), &walls, &mtl);
    let seen = |pixel, at: [f64; 2]| within.pixel(pixel, Channel::R).eval(&at);
    assert!((seen([15, 0], [0.5, 0.5]) - 1.0).abs() < 1e-15);
    for (pixel, tangent) in [([8, 8], 0.0), ([11, 8], 0.375), ([14, 8], 0.75)] {
        let exact = fresnel(f64::atan(tangent), 1.0 / 1.5);
        let found = seen(pixel, [0.0, 0.0]);
        assert!((found - exact).abs() < 1e-12, "{tangent}: {found} {exact}");
    }
}
