//! Scenes from files: what is read, and what is refused in which words.

use std::path::{Path, PathBuf};

use ndarray::ArrayD;
use nerf_oracle::files::npz::{self, Array, Arrays};
use nerf_oracle::scene::{self, Options};

/// A path beside the project, or nothing with a word about it.
fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(name);
    if !path.exists() {
        println!("skipped: ../shared/data/{name} isn't there");
        return None;
    }
    Some(path)
}

#[test]
fn lego_as_cs180_has_it() {
    let Some(path) = shared("lego_200x200.npz") else { return };
    let scene = scene::load(path.to_str().unwrap(), &Options::default()).unwrap();
    assert_eq!((scene.train.len(), scene.val.len(), scene.test.len()), (100, 10, 60));
    assert_eq!((scene.size(), scene.near, scene.far), ((200, 200), 2.0, 6.0));
    assert!(scene.focus.length() < 1e-5);
    let camera = &scene.train[0].camera;
    assert_eq!((camera.k.cx, camera.k.fx), (100.0, 277.77775779844205));
}

#[test]
fn tiny_nerf_is_the_same_scene_in_other_axes() {
    let (Some(tiny), Some(lego)) = (shared("tiny_nerf_lego_100x100.npz"), shared("lego_200x200.npz")) else {
        return;
    };
    let tiny = scene::load(tiny.to_str().unwrap(), &Options::default()).unwrap();
    let lego = scene::load(lego.to_str().unwrap(), &Options::default()).unwrap();
    assert_eq!((tiny.train.len(), tiny.val.len(), tiny.near, tiny.far), (100, 6, 2.0, 6.0));
    let apart = (tiny.train[0].camera.c2w.to_cols_array().into_iter())
        .zip(lego.train[0].camera.c2w.to_cols_array())
        .map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f64::max) < 1e-6, "turned to OpenCV axes, the poses agree to f32");
}

#[test]
fn arrays_of_every_type_come_back_and_the_bytes_are_always_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let arrays: Arrays = [
        ("f64", Array::F64(ArrayD::from_shape_fn(vec![2, 3], |i| i[0] as f64 + 0.1 * i[1] as f64))),
        ("f32", Array::F32(ArrayD::from_elem(vec![4], 0.25))),
        ("f16", Array::F16(ArrayD::from_elem(vec![2, 1, 2], half::f16::from_f64(0.333)))),
        ("u8", Array::U8(ArrayD::from_elem(vec![0, 5], 1))),
        ("i64", Array::I64(ArrayD::from_elem(vec![], -7))),
    ]
    .into_iter()
    .map(|(name, array)| (name.to_string(), array))
    .collect();
    for compress in [false, true] {
        let (a, b) = (folder.path().join("a.npz"), folder.path().join("b.npz"));
        npz::write(&a, &arrays, compress).unwrap();
        npz::write(&b, &arrays, compress).unwrap();
        assert_eq!(npz::read(&a).unwrap(), arrays);
        assert_eq!(std::fs::read(&a).unwrap(), std::fs::read(&b).unwrap());
    }
}
