//! Loading a scene and building its BVH.

use super::{Job, Wake};
use std::sync::Arc;
use stratcore::scene;
use stratcore::trace::TracedScene;

/// A scene that is ready to be looked at.
#[derive(Clone)]
pub struct Loaded {
    /// As it was asked for: a path or a built-in name.
    pub spec: String,
    /// With its BVH.
    pub traced: Arc<TracedScene>,
}

/// Sends the scene, or what is wrong with it.
pub type SceneJob = Job<Result<Loaded, String>>;

/// Pixels of the largest picture, 4096², which are up to 100 bytes each with their map.
const MAX_PIXELS: u64 = 1 << 24;

/// Starts to load a scene.
pub fn load(spec: &str, wake: Wake) -> SceneJob {
    let spec = spec.to_owned();
    Job::spawn("scene", wake, move |reporter| {
        let loaded = scene::load(&spec)
            .map_err(|error| error.to_string())
            .and_then(|scene| check_size(&spec, scene.camera.resolution).map(|()| scene))
            .map(|scene| Loaded { spec: spec.clone(), traced: Arc::new(TracedScene::new(scene)) });
        reporter.send(loaded);
    })
}

/// A window holds its picture whole.
fn check_size(spec: &str, [width, height]: [u32; 2]) -> Result<(), String> {
    if u64::from(width) * u64::from(height) <= MAX_PIXELS {
        return Ok(());
    }
    Err(format!(
        "{spec}: {width} × {height} pixels are more than the explorer holds, {MAX_PIXELS}; lower \
         the camera's resolution, or map it with stratcli, which takes any"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_no_memory_holds_is_refused_with_the_way_out() {
        assert_eq!(check_size("a.toml", [4096, 4096]), Ok(()));
        let error = check_size("a.toml", [1 << 20; 2]).unwrap_err();
        for word in ["a.toml", "1048576 × 1048576", "16777216", "resolution", "stratcli"] {
            assert!(error.contains(word), "{error}");
        }
    }
}
