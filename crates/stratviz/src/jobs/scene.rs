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

/// Starts to load a scene.
pub fn load(spec: &str, wake: Wake) -> SceneJob {
    let spec = spec.to_owned();
    Job::spawn("scene", wake, move |reporter| {
        let loaded = scene::load(&spec)
            .map(|scene| Loaded { spec: spec.clone(), traced: Arc::new(TracedScene::new(scene)) })
            .map_err(|error| error.to_string());
        reporter.send(loaded);
    })
}
