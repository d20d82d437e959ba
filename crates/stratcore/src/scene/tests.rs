//! What files may say, and what is said about files that say something else.

use super::library::{MODELS, SCENES, cube, icosphere, model, torus};
use super::*;
use std::fs;
use std::path::Path;

const CAMERA: &str = "[camera]\neye = [0, 0, 5]\nlook_at = [0, 0, 0]\nfov_y = 40\n\
                      resolution = [8, 8]\n";
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn load_in(folder: &Path, name: &str) -> Result<Scene, SceneError> {
    load(folder.join(name).to_str().unwrap())
}

#[test]
fn built_in_scenes_load_without_files() {
    for scene in SCENES {
        let loaded = load(scene.name).unwrap();
        assert_eq!(loaded.name, scene.name);
        assert_eq!(loaded.notes, Vec::<String>::new());
    }
    let triangles = |name: &str| load(name).unwrap().mesh.triangles.len();
    assert!(triangles("classic") >= 195_000);
    assert!(triangles("grass") >= 1_100_000);
}

#[test]
fn models_are_the_same_every_time() {
    for name in MODELS {
        let [once, again] = [model(name).unwrap().mesh, model(name).unwrap().mesh];
        assert_eq!(once.positions, again.positions);
        assert_eq!(once.triangles, again.triangles);
        assert_eq!(once.materials, again.materials);
    }
}

/// A closed, outward mesh: every edge is walked once in each direction, and the signed volume
/// of the tetrahedra under its faces is its volume.
#[test]
fn shapes_are_closed_and_turned_outward() {
    let ball = 4.0 / 3.0 * std::f64::consts::PI;
    let ring = 2.0 * (std::f64::consts::PI * 0.3).powi(2);
    for (mesh, volume, tolerance) in
        [(icosphere(4), ball, 0.01), (torus(0.3, 96, 48), ring, 0.01), (cube(), 8.0, 1e-15)]
    {
        let mut edges = std::collections::HashSet::new();
        for [a, b, c] in &mesh.triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                assert!(edges.insert(edge));
            }
        }
        assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))));
        let signed = |id| {
            let [a, b, c] = mesh.corners(id);
            a.dot(b.cross(c)) / 6.0
        };
        let enclosed: f64 = (0..mesh.triangles.len()).map(signed).sum();
        assert!((enclosed / volume - 1.0).abs() <= tolerance, "{enclosed} {volume}");
        for (id, normals) in mesh.corner_normals.iter().flatten().enumerate() {
            let plane = mesh.area_normal(id).normalize();
            assert!(normals.iter().all(|n| n.is_normalized() && n.dot(plane) > 0.98));
        }
    }
}

#[test]
fn a_scene_file_says_everything_or_the_least() {
    let mtl = "newmtl red\nKd 1 0 0\nnewmtl lamp\nKe 2 3 4\nKd 0 0 0\nmap_Kd x.png\n";
    let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nusemtl red\n\
               f 1/1 2/1 3/1 4/1\nusemtl lamp\nf -4 -3 -2\nl 1 2\n";
    let full = format!(
        "shading = \"flat\"\n{CAMERA}up = [1, 0, 0]\n[[mesh]]\npath = \"a.obj\"\n[[mesh]]\n\
         path = \"b.obj\"\n[background]\nradiance = [1, 2, 3]\n[light]\nkind = \"directional\"\n\
         towards = [0, 0, 2]\nirradiance = [4, 5, 6]\nambient = [0.1, 0.2, 0.3]\n"
    );
    let least = format!("{CAMERA}[[mesh]]\npath = \"b.obj\"\n");
    let files = [("a.obj", obj), ("b.obj", TRIANGLE), ("m.mtl", mtl)];
    let folder = folder(&[&files[..], &[("full.toml", &full), ("least.toml", &least)]].concat());
    let scene = load_in(folder.path(), "full.toml").unwrap();
    assert_eq!(scene.name, "full");
    assert_eq!(scene.camera.up, DVec3::X);
    assert_eq!((scene.ambient, scene.background), ([0.1, 0.2, 0.3], [1.0, 2.0, 3.0]));
    let towards = DVec3::Z;
    assert_eq!(scene.light, Light::Directional { towards, irradiance: [4.0, 5.0, 6.0] });
    // A quadrilateral of two triangles, one lamp, and the other file's triangle.
    let kd = |id: usize| scene.materials[scene.mesh.materials[id] as usize].kd;
    assert_eq!([kd(0), kd(1), kd(3)], [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.8; 3]]);
    assert_eq!(scene.materials[scene.mesh.materials[2] as usize].ke, [2.0, 3.0, 4.0]);
    assert_eq!(scene.mesh.corners(1), [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), DVec3::Y]);
    assert_eq!(scene.mesh.corners(3), [DVec3::ZERO, DVec3::X, DVec3::Y]);
    let scene = load_in(folder.path(), "least.toml").unwrap();
    assert_eq!((scene.light, scene.background), (Light::Headlight, [0.0; 3]));
    assert_eq!((scene.camera.up, scene.notes), (DVec3::Y, Vec::<String>::new()));
}

#[test]
fn numbers_keep_all_their_digits() {
    let obj = "v 0.1 1000000.0000001 -3e-7\nv 1 0 0\nv 0 1 0 2\nf 1 2 3\n";
    let folder = folder(&[("x.obj", obj)]);
    let [a, _, c] = load_in(folder.path(), "x.obj").unwrap().mesh.corners(0);
    assert_eq!((a, c), (DVec3::new(0.1, 1_000_000.000_000_1, -3e-7), DVec3::new(0.0, 0.5, 0.0)));
}

#[test]
fn a_bare_obj_is_framed() {
    let folder = folder(&[("x.obj", "v 3 0 0\nv 5 0 1\nv 3 4 0\nf 1 2 3\n")]);
    let scene = load_in(folder.path(), "x.obj").unwrap();
    assert_eq!((scene.camera.resolution, scene.light), ([256, 256], Light::Headlight));
    let [forward, right, up] = scene.camera.frame();
    let tan = (scene.camera.fov_y.to_radians() / 2.0).tan();
    for p in &scene.mesh.positions {
        let p = *p - scene.camera.eye;
        let depth = p.dot(forward);
        assert!(depth > 0.0);
        assert!((p.dot(right) / depth).abs() < tan && (p.dot(up) / depth).abs() < tan);
    }
}

#[test]
fn normals_count_only_where_they_are_asked_for() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 2\nvn 0 3 0\nvn 0 0 0\nf 1//1 2//2 3//3\n";
    let smooth = format!("shading = \"smooth\"\n{CAMERA}[[mesh]]\npath = \"x.obj\"\n");
    let both = format!("{smooth}[[mesh]]\npath = \"y.obj\"\n");
    let files = [("x.obj", obj), ("y.obj", TRIANGLE), ("s.toml", &smooth), ("both.toml", &both)];
    let folder = folder(&files);
    assert_eq!(load_in(folder.path(), "x.obj").unwrap().mesh.corner_normals, None);
    let z = DVec3::Z;
    let expected = [z, DVec3::Y, z];
    let scene = load_in(folder.path(), "s.toml").unwrap();
    assert_eq!(scene.mesh.corner_normals, Some(vec![expected]));
    assert_eq!(load("edges").unwrap().mesh.corner_normals, None);
    let round = model("edges").unwrap().mesh;
    assert_eq!(round.corner_normals.unwrap().len(), round.triangles.len());
    let scene = load_in(folder.path(), "both.toml").unwrap();
    assert_eq!(scene.mesh.corner_normals, Some(vec![expected, [z; 3]]));
}

#[test]
fn what_is_assumed_is_noted() {
    let obj = format!("mtllib gone.mtl\nusemtl red\n{TRIANGLE}v 2 2 2\nf 1 4 4\n");
    let folder = folder(&[("x.obj", &obj)]);
    let scene = load_in(folder.path(), "x.obj").unwrap();
    assert_eq!(scene.materials.len(), 1);
    assert_eq!(scene.materials[0].kd, [0.8; 3]);
    let notes = scene.notes.join("\n");
    for words in
        ["gone.mtl is missing", "2 triangles without a material", "1 triangles have no area"]
    {
        assert!(notes.contains(words), "{notes}");
    }
}

/// Every fault of a scene file: one line that names the file, the fault and the way out.
#[test]
fn faults_in_scene_files_are_told_in_one_line() {
    let mesh = "[[mesh]]\npath = \"ok.obj\"\n";
    let camera = |from: &str, to: &str| format!("{}{mesh}", CAMERA.replace(from, to));
    let with = |text: &str| format!("{CAMERA}{mesh}{text}");
    let cases: Vec<(String, &str)> = vec![
        (String::new(), "missing field `camera`"),
        ("[camera\n".to_owned(), "line 1"),
        (CAMERA.to_owned(), "missing field `mesh`"),
        (format!("mesh = []\n{CAMERA}"), "there is no [[mesh]]"),
        (with("[lens]\nradius = 1\n"), "missing field `focus_distance`; how far"),
        (with("[lens]\nradius = 0\nfocus_distance = 1\n"), "lens radius is 0"),
        (with("[lens]\nradius = 1\nfocus_distance = 1\nblades = 2\n"), "3 to 64"),
        (with("[filter]\nkind = \"sinc\"\n"), "unknown variant `sinc`"),
        (with("[filter]\nkind = \"tent\"\nradius = -1\n"), "filter radius is -1"),
        (with("[paths]\nbounces = 99\n"), "at most 8"),
        (with("[light]\nkind = \"area\"\n"), "missing field `shape`; an area light is a rectangle"),
        (with("[light]\nkind = \"area\"\nshape = \"disk\"\n"), "needs centre, normal and radius"),
        (with("[light]\nkind = \"area\"\nshape = \"mesh\"\nmaterial = \"sun\"\n"), "\"sun\""),
        (
            with("[light]\nkind = \"area\"\nshape = \"sphere\"\nradius = 1\nnormal = [0, 1, 0]\n"),
            "a key that is not its shape's",
        ),
        (with("[[light]]\nkind = \"headlight\"\n[[light]]\nkind = \"headlight\"\n"), "two lights"),
        (with("motion = [1, 0, 0]\n"), "no [shutter]"),
        (with("[light]\nkind = \"headlight\"\npower = 3\n"), "unknown field `power`"),
        (with("[light]\nkind = \"point\"\n"), "missing field `position`"),
        (
            with("[light]\nkind = \"directional\"\ntowards = [0,0,0]\nirradiance = [1,1,1]\n"),
            "light towards is [0.0, 0.0, 0.0]; it points from the scene to the light",
        ),
        (
            with("[light]\nkind = \"point\"\nposition = [nan,0,0]\nintensity = [1,1,1]\n"),
            "light position is [NaN",
        ),
        (with("[background]\nradiance = [0, -1, 0]\n"), "at least 0"),
        (with("[background]\nradiance = [0, inf, 0]\n"), "finite"),
        (format!("shading = \"phong\"\n{CAMERA}{mesh}"), "unknown variant `phong`"),
        (camera("eye = [0, 0, 5]", "eye = [0, 0, 0]"), "camera eye and look_at are the same"),
        (camera("eye = [0, 0, 5]", "eye = [0, nan, 5]"), "camera eye is [0.0, NaN, 5.0]"),
        (camera("eye = [0, 0, 5]", "eye = [0, 5, 0]"), "parallel to the view"),
        (camera("fov_y = 40", "fov_y = 0"), "between 0 and 180"),
        (camera("fov_y = 40", "fov_y = 180"), "between 0 and 180"),
        (camera("fov_y = 40", "fov_y = nan"), "between 0 and 180"),
        (camera("[8, 8]", "[0, 8]"), "1 to 2^20"),
        (camera("[8, 8]", "[8, 1048577]"), "1 to 2^20"),
        (camera("[8, 8]", "[8, -1]"), "line"),
        (with("[[mesh]]\npath = \"gone.obj\"\n"), "gone.obj: No such file"),
        (
            with("[[mesh]]\nbuiltin = \"teapot\"\n"),
            "\"teapot\"; there are classic, classic-mirrors, grass",
        ),
        (with("[[mesh]]\n"), "either a path or a builtin"),
    ];
    let folder = folder(&[("ok.obj", TRIANGLE)]);
    for (text, words) in cases {
        fs::write(folder.path().join("x.toml"), &text).unwrap();
        told_in_one_line(load_in(folder.path(), "x.toml"), words);
    }
}

#[test]
fn faults_in_meshes_are_told_in_one_line() {
    let v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let mtl = |line: &str| format!("mtllib {line}\n{TRIANGLE}");
    let cases: Vec<(String, &str)> = vec![
        (String::new(), "has no faces"),
        (v.to_owned(), "has no faces"),
        (format!("{v}l 1 2\n"), "has no faces"),
        (format!("{v}f 1 2 4\n"), "line 4: vertex index 4 is out of range: there are 3"),
        (format!("{v}f 1 2 0\n"), "vertex index 0 is out of range"),
        (format!("{v}f 1 2 -4\n"), "vertex index -4 is out of range"),
        (format!("{v}f 1 2 -9223372036854775808\n"), "out of range"),
        (format!("{v}f 1//1 2//1 3//1\n"), "normal index 1 is out of range: there are 0"),
        (format!("{v}f 1 2 x\n"), "\"x\" is not a vertex index"),
        (format!("{v}f 1 2\n"), "line 4: a face has 2 vertices"),
        (format!("{v}f\n"), "a face has 0 vertices"),
        ("v 0 0\n".to_owned(), "line 1: \"0 0\" should be three numbers"),
        ("v 0 0 zero\n".to_owned(), "\"zero\" is not a number"),
        ("v 0 nan 0\n".to_owned(), "NaN is not a number within"),
        ("v 0 1e400 0\n".to_owned(), "inf is not a number within"),
        ("v 0 1e16 0\n".to_owned(), "not a number within ±1e15"),
        ("v 0 1 0 0\n".to_owned(), "to infinity"),
        (format!("{v}vn 0 inf 0\nf 1 2 3\n"), "line 4: inf"),
        (mtl("bad.mtl"), "bad.mtl, line 2: \"0.5\" should be three numbers"),
        (mtl("negative.mtl"), "Kd is negative"),
        (mtl("nameless.mtl"), "a material needs a name"),
        (mtl("."), "cannot read"),
        ("v 1 1 1\nf 1 1 1\n".to_owned(), "the same point"),
    ];
    let folder = folder(&[
        ("bad.mtl", "newmtl a\nKd 0.5\n"),
        ("negative.mtl", "newmtl a\nKd 0.5 -1 0\n"),
        ("nameless.mtl", "newmtl\n"),
    ]);
    for (text, words) in cases {
        fs::write(folder.path().join("x.obj"), &text).unwrap();
        told_in_one_line(load_in(folder.path(), "x.obj"), words);
    }
    let smooth = format!("shading = \"smooth\"\n{CAMERA}[[mesh]]\npath = \"x.obj\"\n");
    fs::write(folder.path().join("x.toml"), smooth).unwrap();
    let partly = format!("{v}vn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 3\n");
    fs::write(folder.path().join("x.obj"), partly).unwrap();
    told_in_one_line(load_in(folder.path(), "x.toml"), "line 6: this face has no normals");
}

#[test]
fn names_that_are_no_scene_are_told_in_one_line() {
    told_in_one_line(
        load("teapot"),
        "\"teapot\"; there are classic, classic-shadows, grass, edges",
    );
    told_in_one_line(load(""), "no built-in scene");
    told_in_one_line(load("gone.toml"), "cannot read gone.toml: No such file");
    told_in_one_line(load("gone.OBJ"), "cannot read gone.OBJ");
    told_in_one_line(load("/"), "no built-in scene");
}

fn told_in_one_line(outcome: Result<Scene, SceneError>, words: &str) {
    let message = outcome.map(|scene| scene.name).unwrap_err().to_string();
    assert!(message.contains(words) && !message.contains('\n'), "{message}\nlacks: {words}");
}
