//! The vector code, which has all the unsafe: every instruction set against the plain twin.

use glam::DVec3;
use std::sync::atomic::AtomicBool;
use stratcore::beam::PixelBeam;
use stratcore::integrand::Integrand as _;
use stratcore::rng::StreamKey;
use stratcore::sampler::{
    CountPolicy, Jittered, PointSet, Random, SHELF, Sampler, Scramble, count_used,
};
use stratcore::scene::{Camera, Channel, Light, Material, Mesh, Scene};
use stratcore::simd::Isa;
use stratcore::trace::TracedScene;

/// Numbers from bytes; zeros when there are no more.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    fn word(&mut self) -> u32 {
        u32::from_le_bytes(std::array::from_fn(|_| self.byte()))
    }

    /// Mostly between -8 and 8 in steps that meet; now and then any power of two up to 10^9.
    fn coordinate(&mut self) -> f64 {
        let byte = self.byte();
        let fine = f64::from(self.byte() as i8) / 16.0;
        match byte % 8 {
            0 => fine * 2f64.powi(i32::from(self.byte() % 60) - 30),
            1 => fine.round(),
            _ => fine + f64::from(byte) * 2f64.powi(-20),
        }
    }

    fn point(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| self.coordinate()))
    }
}

/// A point set, then a small scene's pixel.
pub fn points_and_beams(data: &[u8]) {
    let mut bytes = Bytes(data);
    points(&mut bytes);
    beam(&mut bytes);
}

fn points(bytes: &mut Bytes) {
    let sampler = SHELF[usize::from(bytes.byte()) % SHELF.len()];
    let scrambles = sampler.scrambles();
    let scramble = scrambles[usize::from(bytes.byte()) % scrambles.len()];
    let dim = 1 + usize::from(bytes.byte() % 12);
    // Some patterns are searched for, point against point.
    let asked = 1 + u64::from(bytes.word() % 300);
    let Ok(n) = count_used(sampler, asked, dim, CountPolicy::Snap) else { return };
    if n > 4096 {
        return;
    }
    let first = u64::from(bytes.word()) % n;
    let len = ((n - first) as usize).min(1 + usize::from(bytes.byte()));
    let key = StreamKey {
        seed: bytes.word().into(),
        pixel: [bytes.byte().into(), bytes.byte().into()],
        sampler: sampler.stream_id(),
        n_samples: n,
        trial: bytes.byte().into(),
    };
    let set = PointSet { key, dim, scramble, rectangular: false };
    let ready = sampler.points(&set);
    let fill = |isa| {
        let mut points = vec![f64::NAN; len * dim];
        ready.fill_with(isa, first, &mut points);
        points
    };
    let plain = fill(Isa::BASELINE);
    assert!(plain.iter().all(|x| (0.0..1.0).contains(x)), "{set:?}");
    for isa in Isa::available() {
        assert_eq!(fill(isa), plain, "{} {set:?}", isa.name());
    }
}

fn beam(bytes: &mut Bytes) {
    let corner = |bytes: &mut Bytes| bytes.point();
    let n_positions = 3 + usize::from(bytes.byte() % 12);
    let positions: Vec<_> = (0..n_positions).map(|_| corner(bytes)).collect();
    let n_triangles = 1 + usize::from(bytes.byte() % 96);
    let index = |bytes: &mut Bytes| u32::from(bytes.byte()) % n_positions as u32;
    let triangles: Vec<_> = (0..n_triangles).map(|_| [(); 3].map(|()| index(bytes))).collect();
    let materials = (0..n_triangles).map(|_| u32::from(bytes.byte() % 2)).collect();
    let colour = |bytes: &mut Bytes| [(); 3].map(|()| f64::from(bytes.byte()) / 128.0);
    let material = |bytes: &mut Bytes| Material {
        name: String::new(),
        kd: colour(bytes),
        ke: colour(bytes),
        ..Material::default()
    };
    let light = match bytes.byte() % 4 {
        0 => Light::Off,
        1 => Light::Headlight,
        2 => Light::Point { position: bytes.point(), intensity: [1.0, 2.0, 0.5] },
        _ => {
            let towards = bytes.point().try_normalize().unwrap_or(DVec3::Y);
            Light::Directional { towards, irradiance: [1.0; 3] }
        }
    };
    let camera = Camera {
        eye: bytes.point(),
        look_at: bytes.point(),
        up: DVec3::Y,
        fov_y: 1.0 + f64::from(bytes.byte()) * 0.69,
        resolution: [1 + u32::from(bytes.byte() % 8), 1 + u32::from(bytes.byte() % 8)],
    };
    if camera.check().is_err() {
        return;
    }
    let [width, height] = camera.resolution;
    let pixel = [u32::from(bytes.byte()) % width, u32::from(bytes.byte()) % height];
    let mesh = Mesh { positions, triangles, materials, corner_normals: None };
    let surfaces = vec![material(bytes), material(bytes)];
    let plain = Scene::plain(mesh, surfaces, camera, light);
    let scene = Scene { ambient: [0.1; 3], background: colour(bytes), ..plain };
    let traced = TracedScene::new(scene);
    let (n, trials) = (1 + u64::from(bytes.byte() % 90), 1 + usize::from(bytes.byte() % 40));
    let seed = bytes.word().into();
    let (scene, accel) = (traced.scene(), traced.accel());
    let beam = || PixelBeam::new(scene, accel, pixel, Channel::Luminance);
    if beam().is_none() {
        // A pixel right beside the light, which is left to rays.
        assert!(matches!(scene.light, Light::Point { .. }), "{scene:?}");
        return;
    }
    let means = |isa| {
        let beam = beam().expect("it was there before").with_isa(isa);
        let never = AtomicBool::new(false);
        let mut all = Vec::new();
        for (sampler, n) in [(&Jittered as &dyn Sampler, n), (&Random, n)] {
            let key =
                StreamKey { seed, pixel, sampler: sampler.stream_id(), n_samples: n, trial: 0 };
            let set = PointSet { key, dim: 2, scramble: Scramble::None, rectangular: true };
            let mut means = vec![0.0; trials];
            assert!(beam.trial_means(sampler, &set, 0, &mut means, &never));
            all.extend(means.iter().map(|mean| mean.to_bits()));
        }
        let positions: Vec<f64> = (0..34).map(|i| (f64::from(i) * 0.618).fract()).collect();
        let mut values = vec![0.0; 17];
        beam.eval_block(&positions, &mut values);
        all.extend(values.iter().map(|value: &f64| value.to_bits()));
        all
    };
    let plain = means(Isa::BASELINE);
    for isa in Isa::available() {
        assert_eq!(means(isa), plain, "{}: {:?}", isa.name(), traced.scene());
    }
}
