//! NumPy archives: what is written comes back, and what is damaged, foreign or hostile is refused without a panic.

use std::io::Write;
use std::path::Path;

use ndarray::ArrayD;
use nerf_oracle::files::npz::{self, Array, Arrays};
use nerf_oracle::scene::{self, Options};

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

/// A small CS180 scene.
fn cs180() -> Arrays {
    let pose = [0.0, 0.0, -1.0, 4.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let other = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 4.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let poses = ArrayD::from_shape_vec(vec![2, 4, 4], [pose, other].concat()).unwrap();
    let bytes = |n: usize| Array::U8(ArrayD::from_elem(vec![n, 5, 6, 3], 51));
    let arrays = [
        ("images_train", bytes(2)),
        ("c2ws_train", Array::F64(poses.clone())),
        ("images_val", bytes(2)),
        ("c2ws_val", Array::F64(poses)),
        ("focal", Array::F64(ArrayD::from_elem(vec![], 7.0))),
    ];
    arrays.into_iter().map(|(name, array)| (name.to_string(), array)).collect()
}

fn message(path: &Path) -> String {
    match scene::load(path.to_str().unwrap(), &Options::default()) {
        Err(error) => error.to_string(),
        Ok(_) => "loaded".into(),
    }
}

#[test]
fn a_small_scene_loads() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.npz");
    npz::write(&path, &cs180(), true).unwrap();
    let scene = scene::load(path.to_str().unwrap(), &Options::default()).unwrap();
    assert_eq!((scene.size(), scene.near, scene.far, scene.test.len()), ((6, 5), 2.0, 6.0, 0));
    assert_eq!(scene.train[1].image.as_ref().unwrap().at(4, 5)[2], 0.2);
    assert!(scene.focus.length() < 1e-12);
}

#[test]
fn bad_arrays_are_refused_by_name() {
    type Change = fn(&mut Arrays);
    fn number(arrays: &mut Arrays, name: &str, at: &[usize], value: f64) {
        let Some(Array::F64(array)) = arrays.get_mut(name) else { panic!("{name} is f64") };
        array[at] = value;
    }
    let cases: [(&[&str], Change); 13] = [
        (&["focal", "an array of this name", "c2ws_train"], |a| drop(a.remove("focal"))),
        (&["focal", "found 0", "positive"], |a| number(a, "focal", &[], 0.0)),
        (&["focal", "found -3", "positive"], |a| number(a, "focal", &[], -3.0)),
        (&["focal", "found NaN"], |a| number(a, "focal", &[], f64::NAN)),
        (&["focal", "shape [2]"], |a| drop(a.insert("focal".into(), Array::F64(ArrayD::zeros(vec![2]))))),
        (&["c2ws_train[1]", "NaN in row 0, column 3"], |a| number(a, "c2ws_train", &[1, 0, 3], f64::NAN)),
        (&["c2ws_train[0]", "R R^T off the identity"], |a| number(a, "c2ws_train", &[0, 0, 2], -1.5)),
        (&["c2ws_val[0]", "reflection"], |a| number(a, "c2ws_val", &[0, 0, 2], 1.0)),
        (&["c2ws_val", "shape [2, 3, 4]"], |a| {
            drop(a.insert("c2ws_val".into(), Array::F64(ArrayD::zeros(vec![2, 3, 4]))))
        }),
        (&["c2ws_train", "found 1", "expected 2"], |a| {
            let Array::F64(poses) = &a["c2ws_train"] else { return };
            let one = poses.slice_axis(ndarray::Axis(0), (0..1).into()).to_owned();
            a.insert("c2ws_train".into(), Array::F64(one));
        }),
        (&["images_train", "[2, 5, 6, 4]", "height, width, 3"], |a| {
            a.insert("images_train".into(), Array::U8(ArrayD::zeros(vec![2, 5, 6, 4])));
        }),
        (&["images_val[0]", "7x5", "6x5 as images_train[0]"], |a| {
            a.insert("images_val".into(), Array::U8(ArrayD::zeros(vec![2, 5, 7, 3])));
        }),
        (&["images_train", "found 255", "[0, 1]"], |a| {
            a.insert("images_train".into(), Array::F32(ArrayD::from_elem(vec![2, 5, 6, 3], 255.0)));
        }),
    ];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.npz");
    for (words, change) in cases {
        let mut arrays = cs180();
        change(&mut arrays);
        npz::write(&path, &arrays, false).unwrap();
        let message = message(&path);
        for word in words.iter().chain(&["scene.npz"]) {
            assert!(message.contains(word), "{word:?} isn't in: {message}");
        }
    }
}

#[test]
fn a_file_cut_anywhere_or_with_any_byte_changed_never_panics() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.npz");
    npz::write(&path, &cs180(), true).unwrap();
    let whole = std::fs::read(&path).unwrap();
    for length in (0..whole.len()).step_by(31) {
        std::fs::write(&path, &whole[..length]).unwrap();
        assert!(message(&path).contains("scene.npz: archive"), "cut to {length}: {}", message(&path));
    }
    for at in (0..whole.len()).step_by(5) {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x5a;
        std::fs::write(&path, &bytes).unwrap();
        // A date or a name may change without harm; it must load or say what is wrong.
        message(&path);
    }
    // One changed pixel of a stored picture is found by the checksum.
    npz::write(&path, &cs180(), false).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let pixel = bytes.windows(40).position(|window| window == [51; 40]).unwrap();
    bytes[pixel] = 52;
    std::fs::write(&path, &bytes).unwrap();
    assert!(message(&path).contains("scene.npz: array images_train"), "{}", message(&path));
    std::fs::write(&path, "PSNR is not an archive").unwrap();
    assert!(message(&path).contains("a whole .npz (zip) archive"));
}

/// An archive with one entry `images.npy`: header text and data as given.
fn crafted(path: &Path, header: &str, data: &[u8]) {
    let mut zip = zip::ZipWriter::new(std::fs::File::create(path).unwrap());
    zip.start_file("images.npy", zip::write::SimpleFileOptions::default()).unwrap();
    zip.write_all(b"\x93NUMPY\x01\x00").unwrap();
    zip.write_all(&(header.len() as u16).to_le_bytes()).unwrap();
    zip.write_all(header.as_bytes()).unwrap();
    zip.write_all(data).unwrap();
    zip.finish().unwrap();
}

#[test]
fn hostile_headers_are_refused_before_memory_is_spent() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hostile.npz");
    let header = |descr: &str, shape: &str| {
        format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n")
    };
    let nested = "(".repeat(20_000 / 2);
    for (header, word) in [
        (header("<f8", "(4611686018427387904, 4611686018427387904)"), "more elements than any memory"),
        (header("<f8", "(99999999999999999999999999,)"), "more elements than any memory"),
        (header("<f8", "(1000000000, 1000)"), "found 8000000000000 bytes"),
        (header("<f4", "(1,)"), "found more than 4 bytes"),
        (header("<f8", "(0, 4611686018427387904, 16)"), "more elements than any memory"),
        (header("|O", "(1,)"), "Python objects"),
        (header("<U3", "(1,)"), "expected 12 bytes"),
        (header("<c16", "(1,)"), "expected 16 bytes"),
        (header("<f8", "(-1,)"), "negative"),
        (nested, "nested too deep"),
        ("{".into(), "images"),
        (String::new(), "images"),
    ] {
        crafted(&path, &header, &[0; 8]);
        let error = npz::read(&path).unwrap_err().to_string();
        assert!(error.contains(word) && error.contains("hostile.npz"), "{word:?} isn't in: {error}");
    }
    crafted(&path, &header("<c8", "(1,)"), &[0; 8]);
    assert!(npz::read(&path).unwrap_err().to_string().contains("element type"));
}

#[test]
fn foreign_orders_and_types_are_understood() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.npz");
    crafted(
        &path,
        "{'descr': '>i2', 'fortran_order': True, 'shape': (2, 3), }",
        &[0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6],
    );
    let arrays = npz::read(&path).unwrap();
    assert_eq!(
        arrays["images"],
        Array::I64(ArrayD::from_shape_vec(vec![2, 3], vec![1, 3, 5, 2, 4, 6]).unwrap())
    );
}
