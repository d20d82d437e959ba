//! Scene files and meshes, read and then looked at.

use super::{files, says_one_line};
use std::io::{self, BufRead};
use std::path::Path;
use stratcore::StudyError;
use stratcore::integrand::Integrand as _;
use stratcore::scene::{Channel, Scene, load_from};
use stratcore::study::{Control, ExactStudy, SamplerChoice, StudyPlan, study};
use stratcore::trace::{TracedScene, Tracer};

/// A scene file; its mesh and materials.
pub fn toml(data: &[u8]) {
    let [toml, obj, mtl] = files(data);
    // Meshes that are made by code are no input, and large.
    let has = |word: &[u8]| toml.windows(word.len()).any(|part| part == word);
    if [&b"classic"[..], b"grass", b"edges"].iter().any(|word| has(word)) {
        return;
    }
    look("scene.toml", toml, obj, mtl);
}

/// A mesh and its materials, bare and in a scene that shades smoothly.
pub fn obj(data: &[u8]) {
    const SMOOTH: &str = "shading = \"smooth\"\n[camera]\neye = [0.3, 0.2, 4]\n\
                          look_at = [0, 0, 0]\nfov_y = 40\nresolution = [2, 2]\n[[mesh]]\n\
                          path = \"mesh.obj\"\n[paths]\nspecular_depth = 2\n";
    let [obj, mtl] = files(data);
    look("mesh.obj", b"", obj, mtl);
    look("scene.toml", SMOOTH.as_bytes(), obj, mtl);
}

fn look(spec: &str, toml: &[u8], obj: &[u8], mtl: &[u8]) {
    let open = |path: &Path| -> io::Result<Box<dyn BufRead>> {
        let ending = path.extension().and_then(|ending| ending.to_str());
        let bytes = match ending {
            Some("toml") => toml,
            Some("obj") => obj,
            Some("mtl") => mtl,
            _ => return Err(io::ErrorKind::NotFound.into()),
        };
        Ok(Box::new(io::Cursor::new(bytes.to_vec())))
    };
    match load_from(spec, &open) {
        Ok(scene) => trace(scene),
        Err(error) => says_one_line(&error.to_string()),
    }
}

/// Two pixels by every way to trace them.
fn trace(scene: Scene) {
    if scene.mesh.triangles.len() > 256 || scene.distribution.dim() > 64 {
        return;
    }
    let [width, height] = scene.camera.resolution;
    let plan = StudyPlan {
        samplers: vec![SamplerChoice::named("random").expect("a sampler"); 1],
        counts: vec![1, 5],
        n_trials: 3,
        ..StudyPlan::paper()
    };
    let flat =
        StudyPlan { samplers: vec![SamplerChoice::JITTERED], counts: vec![4, 9], ..plan.clone() };
    let mut traced = TracedScene::new(scene);
    for tracer in [Tracer::Beam, Tracer::Bvh] {
        traced = traced.with_tracer(tracer);
        for pixel in [[width / 2, height / 2], [width - 1, 0]] {
            let integrand = traced.pixel(pixel, Channel::Luminance);
            let control = Control::unwatched();
            sound(study(&integrand, pixel, &plan, control));
            if integrand.dim() == 2 {
                sound(study(&integrand, pixel, &flat, control));
                let exact = ExactStudy::new(&flat, 1e-3).expect("a plan");
                sound(exact.pixel(&integrand, pixel, control));
            }
        }
    }
}

/// Numbers are finite, or the fault is said.
fn sound(found: Result<stratcore::StudyResult, StudyError>) {
    match found {
        Ok(result) => {
            for row in result.samplers.iter().flat_map(|sampler| &sampler.rows) {
                assert!(row.grand_mean.is_finite() && row.variance_of_mean >= 0.0, "{row:?}");
            }
        }
        Err(error) => says_one_line(&error.to_string()),
    }
}
