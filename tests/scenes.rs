//! Scenes from files: what is read, what is rejected, and with which message.

mod shared;

use std::path::Path;

use glam::{DMat4, DVec2, DVec3};
use nerf_oracle::Error;
use nerf_oracle::camera::{Distortion, Lens};
use nerf_oracle::files::npz;
use nerf_oracle::ray::camera_ray;
use nerf_oracle::scene::{self, Options, Scene};
use serde_json::{Value, json};
use shared::shared;

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
fn fox_has_a_lens_an_off_center_axis_and_every_eighth_frame_held_out() {
    let Some(path) = shared("fox_capture") else { return };
    let scene = scene::load(path.to_str().unwrap(), &Options::default()).unwrap();
    assert_eq!((scene.train.len(), scene.val.len(), scene.size()), (43, 7, (135, 240)));
    assert_eq!((scene.val[0].name.as_str(), scene.warnings.len()), ("images/0001.png", 0));
    let camera = &scene.train[0].camera;
    assert_eq!((camera.k.fx, camera.k.fy, camera.k.cx, camera.k.cy), (171.94, 171.81125, 69.31975, 120.6585));
    assert!(matches!(camera.distortion, Some(Lens::Opencv(Distortion { k1: 0.0578421, .. }))));
    // The nearest camera stands 3.77 from the focus, the farthest 6.32; half a picture is 120 pixels high.
    let sine = 120.0 / 171.8f64.hypot(120.0);
    assert!((scene.near - 3.77 * (1.0 - sine)).abs() < 0.01 && (scene.far - 2.0 * 6.32).abs() < 0.01);
}

/// Two cameras 4 from the origin, along x and along y, looking at it: rows of OpenGL poses.
const POSES: [[[f64; 4]; 4]; 2] = [
    [[0.0, 0.0, 1.0, 4.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
    [[-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 4.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
];

/// A folder with `transforms.json` and two 6x4 pictures, red with half opacity; `change` edits the JSON.
fn captured(change: impl FnOnce(&mut Value)) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut json = json!({ "fl_x": 8.0, "fl_y": 7.0, "cx": 2.5, "cy": 1.5, "w": 6, "h": 4, "frames": [
        { "file_path": "b.png", "transform_matrix": POSES[1] },
        { "file_path": "a.png", "transform_matrix": POSES[0] },
    ] });
    for name in ["a.png", "b.png"] {
        image::RgbaImage::from_pixel(6, 4, image::Rgba([255, 0, 0, 128]))
            .save(folder.path().join(name))
            .unwrap();
    }
    change(&mut json);
    std::fs::write(folder.path().join("transforms.json"), json.to_string()).unwrap();
    folder
}

fn load(path: &Path) -> Result<Scene, Error> {
    scene::load(path.to_str().unwrap(), &Options { holdout: Some(2), ..Options::default() })
}

/// That loading fails with a message that names each of `words`.
fn refused(path: &Path, words: &[&str]) {
    let error = load(path).map(|_| ()).expect_err(&format!("{words:?} should be refused"));
    let message = error.to_string();
    for word in words.iter().chain([&path.file_name().unwrap().to_str().unwrap()]) {
        assert!(message.contains(word), "{word:?} isn't in: {message}");
    }
}

#[test]
fn transforms_turn_axes_composite_and_sort() {
    let folder = captured(|_| ());
    let scene = load(folder.path()).unwrap();
    let (held, kept) = (&scene.val[0], &scene.train[0]);
    assert_eq!((held.name.as_str(), kept.name.as_str()), ("a.png", "b.png"), "sorted by file_path");
    let k = kept.camera.k;
    assert_eq!((k.fx, k.fy, k.cx, k.cy, kept.camera.distortion), (8.0, 7.0, 2.5, 1.5, None));
    // OpenCV axes: the third column looks at the origin, the second points down.
    assert_eq!(held.camera.c2w.z_axis.truncate(), -DVec3::X);
    assert_eq!(held.camera.c2w.y_axis.truncate(), -DVec3::Z);
    assert_eq!(held.camera.c2w.w_axis.truncate(), DVec3::X * 4.0);
    assert_eq!(kept.image.as_ref().unwrap().at(3, 5)[0], 128.0 / 255.0, "over black");
    let white = Options { background: Some([1.0; 3]), near: Some(1.0), ..Options::default() };
    let scene = scene::load(folder.path().to_str().unwrap(), &white).unwrap();
    assert!((scene.train[0].image.as_ref().unwrap().at(0, 0)[1] - 127.0 / 255.0).abs() < 1e-6, "over white");
    assert_eq!(scene.reasons["near"], "1.0000: given");
}

#[test]
fn a_frame_has_its_own_intrinsics_and_lens() {
    let folder = captured(|json| {
        json["frames"][0]["fl_x"] = json!(9.0);
        json["frames"][0]["k1"] = json!(0.1);
    });
    let scene = load(folder.path()).unwrap();
    assert_eq!((scene.train[0].camera.k.fx, scene.val[0].camera.k.fx), (9.0, 8.0));
    let lens = Lens::Opencv(Distortion { k1: 0.1, ..Distortion::default() });
    assert_eq!(scene.train[0].camera.distortion, Some(lens));
    assert_eq!(scene.val[0].camera.distortion, None);
}

#[test]
fn blender_gives_an_angle_and_a_file_a_split() {
    let folder = captured(|_| ());
    for (split, name) in [("train", "./a"), ("val", "./b"), ("test", "./b")] {
        let pose = POSES[usize::from(split != "train")];
        let json =
            json!({ "camera_angle_x": 0.5, "frames": [{ "file_path": name, "transform_matrix": pose }] });
        std::fs::write(folder.path().join(format!("transforms_{split}.json")), json.to_string()).unwrap();
    }
    let options = Options { near: Some(2.0), far: Some(6.0), ..Options::default() };
    let path = folder.path().to_str().unwrap();
    let scene = scene::load(path, &options).unwrap();
    assert_eq!((scene.train.len(), scene.val.len(), scene.test.len()), (1, 1, 1));
    let k = scene.train[0].camera.k;
    assert_eq!((k.fx, k.fy, k.cx, k.cy), (3.0 / 0.25f64.tan(), 3.0 / 0.25f64.tan(), 3.0, 2.0));
    assert!(scene.test[0].image.is_none());
    let scene = scene::load(path, &Options { test_images: true, ..options }).unwrap();
    assert!(scene.test[0].image.is_some());
}

/// Without a validation split all training frames are learned from, the test frames are measured on, and it is said; `--holdout` has the
/// last word, and so it has where the test split has no pictures.
#[test]
fn test_frames_are_measured_on_where_nothing_else_is() {
    let folder = captured(|_| ());
    let write = |split: &str, names: &[&str]| {
        let frame =
            |(n, name): (usize, &&str)| json!({ "file_path": name, "transform_matrix": POSES[n % 2] });
        let frames: Vec<Value> = names.iter().enumerate().map(frame).collect();
        let json = json!({ "camera_angle_x": 0.5, "frames": frames });
        std::fs::write(folder.path().join(format!("transforms_{split}.json")), json.to_string()).unwrap();
    };
    write("train", &["./a", "./b"]);
    write("test", &["./b"]);
    let plain = Options { near: Some(2.0), far: Some(6.0), ..Options::default() };
    let load = |options: &Options| scene::load(folder.path().to_str().unwrap(), options).unwrap();
    let scene = load(&plain);
    assert_eq!((scene.train.len(), scene.val.len(), scene.test.len()), (2, 1, 1));
    assert!(scene.val[0].image.is_some() && scene.test[0].image.is_none());
    assert!(
        scene.warnings[0].contains("1 test frames") && scene.warnings[0].contains("All 2"),
        "{:?}",
        scene.warnings
    );
    let held = load(&Options { holdout: Some(2), ..plain.clone() });
    assert_eq!((held.train.len(), held.val.len(), held.warnings.len()), (1, 1, 0));
    write("test", &["./nowhere"]);
    let held = load(&plain);
    assert_eq!((held.train.len(), held.val.len()), (1, 1));
}

/// A quarter of the pixels: the camera sees the centers of the squares, and an odd column is left over.
#[test]
fn a_scaled_scene_has_the_rays_of_its_squares() {
    for n in [2, 3] {
        let folder = captured(|json| json["k1"] = json!(0.05));
        let path = folder.path().to_str().unwrap();
        let options = Options { near: Some(2.0), far: Some(6.0), holdout: Some(2), ..Options::default() };
        let whole = scene::load(path, &options).unwrap();
        let small = scene::load(path, &Options { shrink: Some(n), ..options }).unwrap();
        assert_eq!(small.size(), (6 / n, 4 / n));
        let (large, camera) = (whole.train[0].camera, small.train[0].camera);
        let f = n as f64;
        assert_eq!(
            (camera.k.fx, camera.k.fy, camera.k.cx, camera.k.cy),
            (8.0 / f, 7.0 / f, 2.5 / f, 1.5 / f)
        );
        for (j, i) in (0..4 / n).flat_map(|j| (0..6 / n).map(move |i| (j as f64 + 0.5, i as f64 + 0.5))) {
            let ray = camera_ray(&camera, DVec2::new(i, j)).unwrap();
            let same = camera_ray(&large, DVec2::new(f * i, f * j)).unwrap();
            assert!((ray.d - same.d).length() < 1e-12 && ray.o == same.o);
        }
        let color = small.train[0].image.as_ref().unwrap().at(0, 0);
        assert_eq!(color, whole.train[0].image.as_ref().unwrap().at(0, 0), "all pixels are alike");
        assert!(small.reasons["scale"].as_str().unwrap().contains("6x4"));
    }
    let folder = captured(|_| ());
    let error =
        scene::load(folder.path().to_str().unwrap(), &Options { shrink: Some(9), ..Options::default() });
    assert!(error.unwrap_err().to_string().starts_with("scale: found 1/9"));
}

/// Saves a picture whose EXIF data say how it is to be turned, a TIFF of one field.
fn save_turned(path: &Path, picture: &image::RgbImage, orientation: u8) {
    use image::ImageEncoder;
    let mut exif = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0".to_vec();
    exif.extend([orientation, 0, 0, 0, 0, 0, 0, 0]);
    let mut png = image::codecs::png::PngEncoder::new(std::fs::File::create(path).unwrap());
    png.set_exif_metadata(exif).unwrap();
    let (width, height) = picture.dimensions();
    png.write_image(picture, width, height, image::ExtendedColorType::Rgb8).unwrap();
}

/// A phone that was held upright stores rows that lie: they are turned where the camera is stated upright, and nowhere else.
#[test]
fn photographs_are_turned_where_their_cameras_are() {
    let seen = image::RgbImage::from_fn(6, 4, |i, j| image::Rgb([40 * i as u8, 60 * j as u8, 7]));
    let pixel = |scene: &Scene, n: usize| scene.train[0].image.as_ref().unwrap().pixel(n);
    let folder = captured(|_| ());
    let both = |picture: &image::RgbImage, orientation| {
        for name in ["a.png", "b.png"] {
            save_turned(&folder.path().join(name), picture, orientation);
        }
    };
    let expected = |(i, j): (u32, u32)| seen.get_pixel(i, j).0.map(|byte| f32::from(byte) / 255.0);
    // To be turned by 90 degrees clockwise, counterclockwise; as stored.
    let turned =
        [(image::imageops::rotate270(&seen), 6), (image::imageops::rotate90(&seen), 8), (seen.clone(), 6)];
    for (stored, orientation) in turned {
        both(&stored, orientation);
        let scene = load(folder.path()).unwrap();
        for (n, (j, i)) in (0..4).flat_map(|j| (0..6).map(move |i| (j, i))).enumerate() {
            assert_eq!(pixel(&scene, n), expected((i, j)), "{orientation}: {i} {j}");
        }
    }
    // A square doesn't lie.
    let square = captured(|json| (json["w"], json["h"]) = (json!(4), json!(4)));
    let corner = image::imageops::crop_imm(&seen, 0, 0, 4, 4).to_image();
    for name in ["a.png", "b.png"] {
        save_turned(&square.path().join(name), &corner, 6);
    }
    assert_eq!(pixel(&load(square.path()).unwrap(), 1), expected((1, 0)));
    // Nothing says that it is to be turned.
    both(&image::imageops::rotate90(&seen), 1);
    refused(folder.path(), &["size of a.png", "4x6", "6x4"]);
}

#[test]
fn a_missing_picture_is_named_and_all_missing_is_an_error() {
    let folder = captured(|json| {
        json["frames"].as_array_mut().unwrap().push(json!({
            "file_path": "gone.png", "transform_matrix": POSES[0]
        }))
    });
    let scene = load(folder.path()).unwrap();
    assert_eq!(scene.train.len() + scene.val.len(), 2);
    assert!(scene.warnings[0].contains("gone.png"), "{:?}", scene.warnings);
    for name in ["a.png", "b.png"] {
        std::fs::remove_file(folder.path().join(name)).unwrap();
    }
    let message = load(folder.path()).unwrap_err().to_string();
    assert!(message.contains("none of 3 pictures, a.png the first"), "{message}");
}

#[test]
fn bad_transforms_are_refused_by_field() {
    type Change = fn(&mut Value);
    let cases: [(&[&str], Change); 14] = [
        (&["frames", "a list of frames"], |json| json["frames"] = json!([])),
        (&["frames[1].file_path"], |json| json["frames"][1]["file_path"] = json!(7)),
        (&["fl_x", "-8", "positive"], |json| json["fl_x"] = json!(-8.0)),
        (&["fl_y", "0", "positive"], |json| json["fl_y"] = json!(0)),
        (&["neither fl_x nor camera_angle_x"], |json| drop(json.as_object_mut().unwrap().remove("fl_x"))),
        (&["size of a.png", "6x4", "12x30"], |json| (json["w"], json["h"]) = (json!(12), json!(30))),
        (&["camera_model", "FISHEYE624", "undistort"], |json| json["camera_model"] = json!("FISHEYE624")),
        (&["k4 of a.png", "0.01"], |json| json["k4"] = json!(0.01)),
        (&["is_latlong of b.png"], |json| json["frames"][0]["is_latlong"] = json!(true)),
        (&["transform_matrix of b.png", "no matrix"], |json| {
            json["frames"][0]["transform_matrix"] = json!("I")
        }),
        (&["transform_matrix of b.png", "NaN in row 1, column 3"], |json| {
            json["frames"][0]["transform_matrix"][1][3] = json!(null);
        }),
        (&["transform_matrix of b.png", "R R^T off the identity by 3"], |json| {
            json["frames"][0]["transform_matrix"][2][1] = json!(2.0);
        }),
        (&["transform_matrix of b.png", "reflection"], |json| {
            json["frames"][0]["transform_matrix"][2][1] = json!(-1.0)
        }),
        (&["transform_matrix of b.png", "last row"], |json| {
            json["frames"][0]["transform_matrix"][3][3] = json!(2.0)
        }),
    ];
    for (words, change) in cases {
        let folder = captured(change);
        refused(&folder.path().join("transforms.json"), words);
    }
}

#[test]
fn damaged_json_and_pictures_are_refused_by_name() {
    let folder = captured(|_| ());
    let path = folder.path().join("transforms.json");
    std::fs::write(folder.path().join("a.png"), "not a picture").unwrap();
    let message = load(&path).unwrap_err().to_string();
    assert!(message.contains("a.png: picture"), "{message}");
    std::fs::write(&path, &std::fs::read(&path).unwrap()[..100]).unwrap();
    refused(&path, &["JSON", "EOF"]);
    let empty = tempfile::tempdir().unwrap();
    refused(empty.path(), &["a folder without transforms.json"]);
    refused(&empty.path().join("none"), &["nothing there"]);
}

#[test]
fn what_is_near_to_a_scene_is_told_how_it_becomes_one() {
    let folder = captured(|_| ());
    let outer = tempfile::tempdir().unwrap();
    let inner = outer.path().join("download").join("my capture");
    std::fs::create_dir_all(&inner).unwrap();
    refused(outer.path(), &["a folder without transforms.json", "Start with builtin:spheres"]);
    for name in ["a.png", "b.png"] {
        std::fs::copy(folder.path().join(name), inner.join(name)).unwrap();
    }
    refused(&inner, &["pictures (2), and nothing that says where they were taken from", "COLMAP"]);
    std::fs::copy(folder.path().join("transforms.json"), inner.join("transforms.json")).unwrap();
    let deeper = Path::new("download").join("my capture").display().to_string();
    refused(outer.path(), &[&format!("some below it: {deeper}"), &inner.display().to_string()]);
    // Files that are scenes, and what a download leaves in a folder.
    let files = tempfile::tempdir().unwrap();
    for (file, words) in [
        ("lego.zip", ["there is an archive in it: lego.zip", "Unpack it"]),
        ("transforms_test.json", ["there is transforms_test.json in it", "Give that file"]),
        ("lego.npz", ["there is lego.npz in it", "Give that file"]),
    ] {
        std::fs::write(files.path().join(file), "").unwrap();
        refused(files.path(), &words);
    }
    let images = inner.join("train");
    std::fs::create_dir(&images).unwrap();
    std::fs::copy(inner.join("a.png"), images.join("a.png")).unwrap();
    refused(&images, &["a folder above it has one", &inner.canonicalize().unwrap().display().to_string()]);
    let run = outer.path().join("run");
    std::fs::create_dir(&run).unwrap();
    std::fs::write(run.join("run.json"), "{}").unwrap();
    refused(&run, &["a run", "train takes the scene"]);
    let archive = outer.path().join("capture.zip");
    std::fs::write(&archive, "PK").unwrap();
    refused(&archive, &["a file of another kind: an archive", "Unpack it"]);
    let film = outer.path().join("capture.MP4");
    std::fs::write(&film, "film").unwrap();
    refused(&film, &["a film", "ffmpeg"]);
}

#[test]
fn cameras_in_one_place_need_near_and_far() {
    let folder = captured(|json| {
        json["frames"][1]["transform_matrix"] = json["frames"][0]["transform_matrix"].clone();
        json["frames"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "file_path": "./a.png", "transform_matrix": POSES[1] }));
    });
    let path = folder.path().join("transforms.json");
    refused(&path, &["near and far", "all stand in one place", "Give both"]);
    let options = Options { near: Some(1.0), far: Some(7.0), ..Options::default() };
    let scene = scene::load(path.to_str().unwrap(), &options).unwrap();
    // Halfway in 1 / distance: 1.75 before the camera, which stands 4 from the origin.
    assert!((scene.focus.length() - 2.25).abs() < 1e-12, "{}", scene.focus);
}

/// Cameras in a row that all look across it: their axes never meet.
fn row(count: usize, apart: f64) -> tempfile::TempDir {
    captured(|json| {
        let frame = |n: usize| {
            let mut pose = POSES[1];
            pose[0][3] = apart * n as f64;
            json!({ "file_path": "./a.png", "transform_matrix": pose })
        };
        json["frames"] = (0..count).map(frame).collect();
    })
}

/// Nothing says how far things are but how far the cameras stand apart; the camera looks along -y from y = 4.
#[test]
fn cameras_in_a_row_have_guesses_or_what_is_given() {
    let folder = row(9, 1.0);
    let path = folder.path().to_str().unwrap();
    let scene = scene::load(path, &Options::default()).unwrap();
    // The median of 0, 1, 1, 2, 2, 3, 3, 4, 4 is 2; one camera from the next 1, at most a tenth of that.
    assert_eq!((scene.near, scene.far), (0.2, 20.0));
    assert!(scene.focus.distance(DVec3::new(4.0, 2.0, 0.0)) < 1e-12, "{}", scene.focus);
    assert!(scene.warnings.iter().any(|w| w.contains("axes meet nowhere")), "{:?}", scene.warnings);
    assert!(scene.bounds.is_none());

    let options = Options { near: Some(1.0), far: Some(3.0), ..Options::default() };
    let given = scene::load(path, &options).unwrap();
    let (low, high) = given.bounds.expect("what the cameras see between near and far");
    assert!(low.x < 0.0 && high.x > 8.0 && low.y < 4.0 - 2.5 && high.y < 4.0, "{low} {high}");
    assert!(given.warnings.is_empty(), "{:?}", given.warnings);
}

/// A wide lens before the real world: near is where a ball begins that fills the picture.
#[test]
fn near_follows_the_lens_before_the_real_world() {
    let near = |opaque: bool| {
        let folder = captured(|json| json["fl_x"] = json!(2.0));
        if opaque {
            for name in ["a.png", "b.png"] {
                image::RgbImage::from_pixel(6, 4, image::Rgb([9, 9, 9]))
                    .save(folder.path().join(name))
                    .unwrap();
            }
        }
        scene::load(folder.path().to_str().unwrap(), &Options::default()).unwrap().near
    };
    // Half a picture is 3 pixels wide, 1.5 focal lengths; the cameras stand 4 from what they look at.
    let sine = 1.5 / (1.0 + 1.5f64 * 1.5).sqrt();
    assert!((near(true) - 4.0 * (1.0 - sine)).abs() < 1e-12, "{}", near(true));
    assert_eq!(near(false), 2.0, "customary for what is cut out");
}

/// Axes that hardly differ meet somewhere, but that says little of how near things are.
#[test]
fn near_is_small_where_axes_hardly_differ() {
    let near = |degrees: f64| {
        let folder = captured(|json| {
            for (n, frame) in json["frames"].as_array_mut().unwrap().iter_mut().enumerate() {
                let turn = DMat4::from_rotation_z((2.0 * n as f64 - 1.0) * degrees.to_radians());
                let pose = turn * DMat4::from_cols_array_2d(&POSES[1]).transpose();
                frame["transform_matrix"] = json!(pose.transpose().to_cols_array_2d());
            }
        });
        for name in ["a.png", "b.png"] {
            image::RgbImage::from_pixel(6, 4, image::Rgb([9, 9, 9])).save(folder.path().join(name)).unwrap();
        }
        let scene = scene::load(folder.path().to_str().unwrap(), &Options::default()).unwrap();
        assert!(scene.focus.length() < 1e-6, "{}", scene.focus);
        scene.near
    };
    assert!(
        (near(5.0) - 0.4).abs() < 1e-9 && (near(30.0) - 2.0).abs() < 1e-9,
        "{} {}",
        near(5.0),
        near(30.0)
    );
}

/// Pictures half as large as the file says, with Windows' paths from another machine, poses of three rows, and a byte order mark.
#[test]
fn what_means_the_same_is_read() {
    let folder = captured(|json| {
        (json["w"], json["h"], json["fl_x"], json["fl_y"]) = (json!(12), json!(8), json!(16.0), json!(14.0));
        (json["cx"], json["cy"]) = (json!(5.0), json!(3.0));
        for (frame, name) in json["frames"].as_array_mut().unwrap().iter_mut().zip(["b", "a"]) {
            frame["file_path"] = json!(format!("C:\\scans\\{name}.png"));
            frame["transform_matrix"].as_array_mut().unwrap().truncate(3);
        }
    });
    std::fs::create_dir(folder.path().join("images")).unwrap();
    for name in ["a.png", "b.png"] {
        std::fs::rename(folder.path().join(name), folder.path().join("images").join(name)).unwrap();
    }
    let file = folder.path().join("transforms.json");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, format!("\u{feff}{text}")).unwrap();
    let (scene, plain) = (load(folder.path()).unwrap(), load(captured(|_| ()).path()).unwrap());
    assert_eq!(
        (&scene.train[0].camera, &scene.val[0].camera),
        (&plain.train[0].camera, &plain.val[0].camera)
    );
}

/// A box that is small beside the cameras' distance, or elsewhere, is in other units.
#[test]
fn a_box_in_other_units_is_not_used() {
    let bounds = |scale: f64, moved: f64| {
        let folder = captured(|json| {
            json["aabb_scale"] = json!(2);
            json["scale"] = json!(scale);
            for frame in json["frames"].as_array_mut().unwrap() {
                for row in 0..3 {
                    let at = frame["transform_matrix"][row][3].as_f64().unwrap();
                    frame["transform_matrix"][row][3] = json!(at + moved);
                }
            }
        });
        let scene = scene::load(folder.path().to_str().unwrap(), &Options::default()).unwrap();
        let told = scene
            .warnings
            .iter()
            .any(|warning| warning.contains("aabb_scale") && warning.contains("isn't used"));
        assert_eq!(scene.bounds.is_none(), told, "{:?}", scene.warnings);
        scene.bounds.is_some()
    };
    assert!(bounds(0.33, 0.0));
    assert!(!bounds(10.0, 0.0), "0.2 wide, 4 away");
    assert!(!bounds(0.33, 50.0));
}

#[test]
fn arguments_that_make_no_sense_are_refused() {
    let options = Options::default;
    for (word, options) in [
        ("near: found", Options { near: Some(6.0), far: Some(2.0), ..options() }),
        ("near: found", Options { near: Some(f64::NAN), ..options() }),
        ("far: found", Options { far: Some(-1.0), ..options() }),
        ("holdout: found", Options { holdout: Some(1), ..options() }),
        ("near and far", Options { near: Some(7.0), ..options() }),
        ("builtin:cube", options()),
    ] {
        let name = if word.starts_with("builtin") { word } else { "builtin:blob" };
        let message = scene::load(name, &options).unwrap_err().to_string();
        assert!(message.contains(word), "{message}");
    }
}

/// The arrays that `inspect` wrote, as f64.
fn inspected(scene: &str, out: &Path) -> impl Fn(&str) -> ndarray::ArrayD<f64> + use<> {
    let program = std::process::Command::new(env!("CARGO_BIN_EXE_nerf-oracle"))
        .args(["inspect", scene, "--rays", "20", "--samples", "8", "--json", "--out", out.to_str().unwrap()])
        .output()
        .unwrap();
    assert!(program.status.success(), "{}", String::from_utf8_lossy(&program.stderr));
    let object: Value = serde_json::from_slice(&program.stdout).unwrap();
    assert_eq!((&object["near"], &object["far"]), (&json!(2.0), &json!(6.0)));
    let arrays = npz::read(&out.join("rays.npz")).unwrap();
    move |name| arrays[name].to_f64()
}

#[test]
fn inspect_writes_rays_that_project_back_to_their_pixels() {
    let folder = tempfile::tempdir().unwrap();
    let array = inspected("builtin:spheres", folder.path());
    let (o, d, t, points) = (array("rays_o"), array("rays_d"), array("t"), array("points"));
    let (c2ws, k, uv) = (array("c2ws"), array("intrinsics"), array("rays_uv"));
    assert_eq!((c2ws.shape(), points.shape()), (&[28, 4, 4][..], &[20, 8, 3][..]));
    for r in 0..20 {
        let f = array("rays_frame")[r] as usize;
        for n in 0..8 {
            let x: [f64; 3] = std::array::from_fn(|i| points[[r, n, i]]);
            assert!((0..3).all(|i| x[i] == o[[r, i]] + d[[r, i]] * t[[r, n]]), "a point is o + t d");
            let width = 4.0 / 8.0;
            let (low, high) = (2.0 + n as f64 * width, 2.0 + (n + 1) as f64 * width);
            assert!((low..high).contains(&t[[r, n]]), "one sample in each interval");
            // World to camera: R^T (x - o), then the pinhole.
            let seen: [f64; 3] =
                std::array::from_fn(|j| (0..3).map(|i| c2ws[[f, i, j]] * (x[i] - c2ws[[f, i, 3]])).sum());
            let u = k[[f, 0]] * seen[0] / seen[2] + k[[f, 2]];
            let v = k[[f, 1]] * seen[1] / seen[2] + k[[f, 3]];
            assert!((u - uv[[r, 0]]).abs() < 1e-10 && (v - uv[[r, 1]]).abs() < 1e-10, "({u}, {v})");
        }
    }
    // Every stage from the field on, by its formula.
    let (sigmas, deltas, alphas) = (array("sigmas"), array("deltas"), array("alphas"));
    let (through, weights, rgbs) = (array("transmittances"), array("weights"), array("rgbs"));
    for r in 0..20 {
        let (mut depth, mut color) = (0.0, [0.0; 3]);
        for n in 0..8 {
            let x: f64 = sigmas[[r, n]] * deltas[[r, n]];
            assert!((alphas[[r, n]] + (-x).exp_m1()).abs() < 1e-14);
            assert!((through[[r, n]] - f64::exp(-depth)).abs() < 1e-14);
            assert!((weights[[r, n]] - through[[r, n]] * alphas[[r, n]]).abs() < 1e-14);
            (0..3).for_each(|k| color[k] += weights[[r, n]] * rgbs[[r, n, k]]);
            depth += x;
        }
        assert!((array("opacities")[r] + (-depth).exp_m1()).abs() < 1e-14);
        assert!((0..3).all(|k| (array("colors")[[r, k]] - color[k]).abs() < 1e-14), "over black");
    }
    assert!(sigmas.iter().any(|sigma| *sigma > 1.0));
    let page = std::fs::read_to_string(folder.path().join("index.html")).unwrap();
    assert!(page.len() < 5_000_000 && page.contains("train[0]"));
    let picture = image::open(folder.path().join("outside.png")).unwrap().into_rgb8();
    let drawn = |channel: usize| {
        picture.pixels().filter(|p| p[channel] > p[(channel + 2) % 3].saturating_add(60)).count()
    };
    assert!(drawn(0) > 500 && drawn(2) > 500, "orange samples and blue rays are in the picture");
}

#[test]
fn inspect_shows_a_run_s_field_and_writes_points_for_others() {
    let folder = tempfile::tempdir().unwrap();
    let (run, out) = (folder.path().join("run"), folder.path().join("out"));
    let (run, dir) = (run.to_str().unwrap(), out.to_str().unwrap());
    let scene = "builtin:spheres,views=4,size=8";
    let of = |args: &[&str]| {
        let program =
            std::process::Command::new(env!("CARGO_BIN_EXE_nerf-oracle")).args(args).output().unwrap();
        assert!(program.status.success(), "{}", String::from_utf8_lossy(&program.stderr));
        String::from_utf8(program.stderr).unwrap()
    };
    of(&["train", scene, "--steps", "30", "--out", run]);
    let inspect = ["inspect", scene, "--run", run, "--rays", "6", "--samples", "4", "--ply", "--out", dir];
    let said = of(&inspect);
    assert!(!said.contains("other pictures"), "{said}");
    let arrays = npz::read(&out.join("rays.npz")).unwrap();
    assert_eq!(arrays["sigmas"].shape(), [6, 4]);
    assert!(std::fs::read_to_string(out.join("index.html")).unwrap().contains("\"bits\":"));
    for file in ["cameras.ply", "points.ply"] {
        assert!(
            std::fs::read(out.join(file))
                .unwrap()
                .starts_with(b"ply\nformat binary_little_endian 1.0\nelement vertex ")
        );
    }
    // Another scene than the run's is told.
    let other = [
        "inspect",
        "builtin:blob,views=4,size=8",
        "--run",
        run,
        "--rays",
        "2",
        "--samples",
        "2",
        "--out",
        dir,
    ];
    assert!(of(&other).contains("The run was trained on other pictures or cameras"));
}
