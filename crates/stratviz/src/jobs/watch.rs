//! Notices that the files of a scene were changed.

use super::{Job, Wake};
use std::path::Path;
use std::time::{Duration, SystemTime};

/// Sends `()` for each change.
pub type WatchJob = Job<()>;

/// Watches the scene file and the meshes and materials beside it. A built-in scene never
/// changes.
pub fn watch(spec: &str, wake: Wake) -> WatchJob {
    const EVERY: Duration = Duration::from_millis(400);
    let spec = spec.to_owned();
    Job::spawn("watch", wake, move |reporter| {
        let path = Path::new(&spec);
        if !path.is_file() {
            return;
        }
        let mut last = newest(path);
        while !reporter.is_cancelled() {
            std::thread::sleep(EVERY);
            let now = newest(path);
            if now.is_some() && now != last {
                last = now;
                reporter.send(());
            }
        }
    })
}

/// The time of the last change to the scene's file or to an OBJ or MTL file beside it.
fn newest(path: &Path) -> Option<SystemTime> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let beside = std::fs::read_dir(folder.unwrap_or(Path::new("."))).into_iter().flatten();
    let meshes = beside.flatten().map(|entry| entry.path()).filter(|path| {
        let ending = path.extension().map(|e| e.to_ascii_lowercase());
        ending.is_some_and(|e| e == "obj" || e == "mtl")
    });
    let changed = |path: &Path| path.metadata().and_then(|m| m.modified()).ok();
    meshes.filter_map(|path| changed(&path)).chain(changed(path)).max()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_changed_mesh_counts_as_a_change() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("a.toml");
        let mesh = folder.path().join("a.obj");
        std::fs::write(&scene, "").unwrap();
        let before = newest(&scene).unwrap();
        std::fs::write(&mesh, "").unwrap();
        let later = before + Duration::from_secs(5);
        std::fs::File::options().write(true).open(&mesh).unwrap().set_modified(later).unwrap();
        assert_eq!(newest(&scene), Some(later));
        assert_eq!(newest(Path::new("no/such.toml")), None);
    }
}
