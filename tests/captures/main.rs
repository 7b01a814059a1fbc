//! Captures as COLMAP, LLFF and nerfstudio write them: the same cameras whatever the layout is, and what is derived from the points.

mod files;
mod lenses;
#[path = "../shared/mod.rs"]
mod shared;

use std::fs;
use std::path::Path;

use files::{Lens, NAMES, SIZE, binary, llff, opencv, pictures, pinhole, pose, text};
use glam::DVec2;
use nerf_oracle::evaluation::{camera_rays, evaluate};
use nerf_oracle::random::{Key, Purpose};
use nerf_oracle::ray::camera_ray;
use nerf_oracle::scene::{self, Options, Scene, random_pixel};
use nerf_oracle::training::Model;
use nerf_oracle::training::compact::{CompactModel, Overrides};
use nerf_oracle::training::nerf::{NerfModel, NerfSettings};
use serde_json::{Value, json};
use shared::shared;

/// A folder with pictures, to which `write` adds the cameras.
fn capture(write: impl FnOnce(&Path)) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    pictures(&folder.path().join("images"), SIZE);
    write(folder.path());
    folder
}

fn load(path: &Path) -> Scene {
    scene::load(path.to_str().unwrap(), &Options::default()).unwrap()
}

/// The message that refuses a capture.
fn refusal(path: &Path) -> String {
    scene::load(path.to_str().unwrap(), &Options::default()).unwrap_err().to_string()
}

/// nerfstudio's JSON: intrinsics in each frame, names without their folder or ending, poses with OpenGL axes.
fn nerfstudio(folder: &Path, change: impl FnOnce(&mut Value)) {
    let frame = |n: usize| {
        let flip = |row: [f64; 4]| [row[0], -row[1], -row[2], row[3]];
        json!({
            "file_path": NAMES[n].trim_end_matches(".png"), "transform_matrix": pose(n).map(flip), "w": SIZE[0], "h": SIZE[1],
            "fl_x": files::FOCAL, "fl_y": files::FOCAL, "cx": 6.0, "cy": 4.0, "colmap_im_id": n + 1,
        })
    };
    let mut json = json!({
        "camera_model": "OPENCV", "frames": [frame(3), frame(1), frame(0), frame(2)], "ply_file_path": "sparse_pc.ply",
        "applied_transform": [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0]],
    });
    change(&mut json);
    fs::write(folder.join("transforms.json"), json.to_string()).unwrap();
}

/// That two scenes have the same frames: rays to 1e-9, pictures to the bit.
fn assert_same(one: &Scene, other: &Scene) {
    assert_eq!((one.train.len(), one.val.len()), (other.train.len(), other.val.len()));
    for (a, b) in one.train.iter().chain(&one.val).zip(other.train.iter().chain(&other.val)) {
        assert!(a.name.starts_with(&b.name), "{} {}", a.name, b.name);
        assert_eq!(a.image, b.image, "{}", a.name);
        for (x, y) in camera_rays(&a.camera).unwrap().iter().zip(camera_rays(&b.camera).unwrap()) {
            assert!((x.o - y.o).length() < 1e-9 && (x.d - y.d).length() < 1e-9, "{}", a.name);
        }
    }
}

#[test]
fn the_same_capture_in_every_layout_has_the_same_rays() {
    let scene = load(capture(|root| binary(&root.join("sparse/0"), &pinhole(), 0.0)).path());
    assert_eq!((scene.train.len(), scene.val.len(), scene.size()), (3, 1, (12, 8)));
    assert_eq!((scene.val[0].name.as_str(), &scene.warnings), ("a.png", &vec![]));
    // Its axes and its place, by hand: the first camera stands 4 before the origin and looks along z.
    let first = scene.val[0].camera;
    let ray = camera_ray(&first, DVec2::new(6.0, 4.0)).unwrap();
    assert!(
        (ray.o - glam::DVec3::new(0.0, 0.0, -4.0)).length() < 1e-12
            && (ray.d - glam::DVec3::Z).length() < 1e-12
    );
    assert!(scene.focus.length() < 1e-9);
    for write in [
        (|root: &Path| binary(&root.join("sparse"), &pinhole(), 0.0)) as fn(&Path),
        |root| binary(&root.join("colmap/sparse/0"), &pinhole(), 0.0),
        |root| text(&root.join("sparse/0"), &pinhole()),
        |root| llff(root, 1.0),
        |root| llff(root, 8.0),
        |root| nerfstudio(root, |_| ()),
    ] {
        assert_same(&scene, &load(capture(write).path()));
    }
    let bent = [binary as fn(&Path, &Lens, f64), |root, lens, _| text(root, lens)]
        .map(|write| load(capture(|root| write(&root.join("sparse/0"), &opencv(), 0.0)).path()));
    assert_same(&bent[0], &bent[1]);
    assert_ne!(bent[0].train[0].camera, scene.train[0].camera);
    // All programs' files at once: COLMAP's points are worth more than LLFF's bounds.
    let both = capture(|root| {
        llff(root, 1.0);
        binary(&root.join("sparse/0"), &pinhole(), 0.0);
    });
    assert!(load(both.path()).cloud.is_some());
}

/// mip-NeRF 360's layout: smaller copies beside the pictures, whose sides were rounded.
#[test]
fn intrinsics_follow_the_size_that_pictures_have() {
    let folder = capture(|root| binary(&root.join("sparse/0"), &pinhole(), 0.0));
    let whole = load(folder.path());
    pictures(&folder.path().join("images_4"), [3, 2]);
    pictures(&folder.path().join("images_5"), [2, 2]);
    for (name, size) in [("images_4", (3, 2)), ("images_5", (2, 2))] {
        let small = load(&folder.path().join(name));
        assert_eq!(small.size(), size);
        for (frame, large) in small.train.iter().zip(&whole.train) {
            let scale = DVec2::new(12.0 / size.0 as f64, 8.0 / size.1 as f64);
            for uv in [DVec2::new(0.5, 0.5), DVec2::new(1.7, 0.3)] {
                let ray = camera_ray(&frame.camera, uv).unwrap();
                let same = camera_ray(&large.camera, uv * scale).unwrap();
                assert!((ray.d - same.d).length() < 1e-12 && ray.o == same.o);
            }
        }
        // The points are as far off as in the pictures that the model was made of.
        assert!(small.cloud.unwrap().reprojection.unwrap().pixels < 1e-9);
    }
    assert_eq!(load(folder.path()).size(), (12, 8), "the largest where nothing is said");
    fs::rename(folder.path().join("images"), folder.path().join("my photos")).unwrap();
    fs::remove_dir_all(folder.path().join("images_4")).unwrap();
    fs::remove_dir_all(folder.path().join("images_5")).unwrap();
    assert_eq!(load(folder.path()).size(), (12, 8), "a folder of any name");
    pictures(&folder.path().join("my photos"), [8, 12]);
    let turned = "size of a.png: found 8x12; expected the shape of 12x8";
    assert!(refusal(folder.path()).contains(turned));
    fs::remove_dir_all(folder.path().join("sparse")).unwrap();
    llff(folder.path(), 1.0);
    assert!(refusal(&folder.path().join("my photos")).contains(turned));
    let empty = folder.path().join("empty");
    fs::create_dir(&empty).unwrap();
    assert!(refusal(&empty).contains("a folder without transforms.json"));
}

/// Copies that were numbered anew, as in LLFF's scenes, are those of the same place in the order.
#[test]
fn copies_with_names_of_their_own_are_taken_in_order() {
    let folder = capture(|root| binary(&root.join("sparse/0"), &pinhole(), 0.0));
    let whole = load(folder.path());
    let images = folder.path().join("images");
    for (n, name) in NAMES.iter().enumerate() {
        fs::rename(images.join(name), images.join(format!("image{n:03}.png"))).unwrap();
    }
    let scene = load(folder.path());
    assert_same(&whole, &scene);
    assert!(scene.warnings[0].contains("image000.png for a.png"), "{:?}", scene.warnings);
    fs::remove_file(images.join("image002.png")).unwrap();
    assert!(refusal(folder.path()).contains("none of 4 pictures, a.png the first"));
}

#[test]
fn near_far_and_box_come_from_the_points_but_not_from_strays() {
    let folder = capture(|root| binary(&root.join("sparse/0"), &pinhole(), 0.0));
    let scene = load(folder.path());
    // The points' corner is 1.73 from the origin, the cameras 4.
    assert!(scene.near > 0.5 * (4.0 - 1.74) && scene.near < 4.0 - 1.0, "{}", scene.near);
    assert!(scene.far > 4.0 + 1.0 && scene.far < 1.5 * (4.0 + 1.74), "{}", scene.far);
    let (low, high) = scene.bounds.unwrap();
    assert!(
        low.max_element() < -1.0
            && low.min_element() > -2.0
            && high.min_element() > 1.0
            && high.max_element() < 2.0
    );
    for field in ["near", "far", "bounds"] {
        assert!(scene.reasons[field].as_str().unwrap().contains("points"), "{field}");
    }
    // One point of 125 goes far astray.
    let file = folder.path().join("sparse/0/points3D.bin");
    let mut bytes = fs::read(&file).unwrap();
    bytes[16..24].copy_from_slice(&1e6f64.to_le_bytes());
    fs::write(&file, bytes).unwrap();
    let stray = load(folder.path());
    assert!(stray.far < 1.1 * scene.far && stray.near > 0.9 * scene.near, "{} {}", stray.near, stray.far);
    assert!((stray.bounds.unwrap().1 - high).length() < 0.1);
    assert!(stray.warnings[0].contains("pixels off on average"), "{:?}", stray.warnings);
}

/// Models without any points are read, and one with a single point has a box all the same.
#[test]
fn few_points_are_no_trouble() {
    let folder = capture(|root| text(&root.join("sparse/0"), &pinhole()));
    let keep = |n: usize| {
        let file = |name: &str| folder.path().join("sparse/0").join(name);
        let points = fs::read_to_string(file("points3D.txt")).unwrap();
        let points: Vec<&str> = points.lines().take(1 + n).collect();
        fs::write(file("points3D.txt"), points.join("\n")).unwrap();
        let images = fs::read_to_string(file("images.txt")).unwrap();
        let few = |(k, line): (usize, &str)| match k {
            0 | 1 | 3 | 5 | 7 => line.to_string(),
            _ => line.split(' ').take(3 * n).collect::<Vec<_>>().join(" "),
        };
        let images: Vec<String> = images.lines().enumerate().map(few).collect();
        fs::write(file("images.txt"), images.join("\n")).unwrap();
        load(folder.path())
    };
    let one = keep(1);
    let (low, high) = one.bounds.unwrap();
    assert!((high - low).min_element() > 0.1 && one.near < one.far && one.cloud.unwrap().points.len() == 1);
    let none = keep(0);
    assert_eq!((none.cloud, none.bounds), (None, None));
    // By the cameras' focus, 4 away; half a picture is 6 wide, a focal length 10.
    let sine = 6.0 / 6.0f64.hypot(10.0);
    assert!((none.near - 4.0 * (1.0 - sine)).abs() < 1e-9 && (none.far - 8.0).abs() < 1e-9);
}

#[test]
fn cameras_that_do_not_fit_their_points_are_doubted() {
    let fit = |off: f64| {
        let scene = load(capture(|root| binary(&root.join("sparse/0"), &pinhole(), off)).path());
        (scene.cloud.unwrap().reprojection.unwrap(), scene.warnings)
    };
    let (right, warnings) = fit(0.0);
    assert_eq!((right.sights, right.behind, right.stated), (500, 0, 0.25));
    assert!(right.pixels < 1e-12 && warnings.is_empty(), "{warnings:?}");
    let (wrong, warnings) = fit(-3.0);
    assert!((wrong.pixels - 3.0).abs() < 1e-12);
    assert!(warnings[0].contains("3.00 pixels off on average, 0.25 as the file says"), "{warnings:?}");
    let options = Options { near: Some(3.9), far: Some(4.1), ..Options::default() };
    let folder = capture(|root| binary(&root.join("sparse/0"), &pinhole(), 0.0));
    let scene = scene::load(folder.path().to_str().unwrap(), &options).unwrap();
    assert!(scene.warnings[0].contains("nearer than 3.900 or farther than 4.100"), "{:?}", scene.warnings);
    let boxed = capture(|root| {
        nerfstudio(root, |json| {
            json["aabb_scale"] = json!(0.2);
            for frame in json["frames"].as_array_mut().unwrap() {
                frame["transform_matrix"][0][3] =
                    json!(frame["transform_matrix"][0][3].as_f64().unwrap() + 5.0);
            }
        })
    });
    let scene = load(boxed.path());
    assert!(
        scene.warnings.iter().any(|w| w.contains("box") && w.contains("isn't used")),
        "{:?}",
        scene.warnings
    );
}

/// nerfstudio writes its points beside its cameras: they say how far samples must reach, as COLMAP's own do.
#[test]
fn points_of_a_ply_are_as_good_as_those_of_colmap() {
    let folder = capture(|root| {
        nerfstudio(root, |_| ());
        let header = "ply\nformat ascii 1.0\nelement vertex 125\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
        let lines: String = files::points().iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
        fs::write(root.join("sparse_pc.ply"), format!("{header}{lines}")).unwrap();
    });
    let scene = load(folder.path());
    let colmap = load(capture(|root| binary(&root.join("sparse/0"), &pinhole(), 0.0)).path());
    let close = |a: f64, b: f64| (a - b).abs() < 0.05 * b;
    assert!(close(scene.near, colmap.near) && close(scene.far, colmap.far), "{} {}", scene.near, scene.far);
    let ((low, high), (l, h)) = (scene.bounds.unwrap(), colmap.bounds.unwrap());
    assert!((low - l).length() < 1e-6 && (high - h).length() < 1e-6);
    fs::write(folder.path().join("sparse_pc.ply"), "ply\n").unwrap();
    assert!(refusal(folder.path()).contains("sparse_pc.ply: header: found none in 4 bytes"));
}

/// Photographs of several sizes and cameras are learned from: every pixel's ray is its own camera's.
#[test]
fn sizes_may_differ_from_frame_to_frame() {
    let folder = capture(|root| {
        nerfstudio(root, |json| {
            // 6x8 of the second, from the left.
            json["frames"][1]["w"] = json!(6);
        });
        let picture = image::open(root.join("images/b.png")).unwrap().crop_imm(0, 0, 6, 8);
        picture.save(root.join("images/b.png")).unwrap();
    });
    let scene = load(folder.path());
    let sizes: Vec<usize> = scene.train.iter().map(|frame| frame.camera.width).collect();
    assert_eq!(sizes, [6, 12, 12]);
    let key = Key::new(0, Purpose::Rays);
    for ray in 0..2000 {
        let [frame, j, i] = random_pixel(&scene.train, &key, 1, ray);
        assert!(j < 8 && i < sizes[frame]);
    }
    let settings =
        NerfSettings { rays: 64, samples: 8, ..NerfSettings::new(scene.near, scene.far, [0.0; 3]) };
    let mut models: [Box<dyn Model>; 2] = [
        Box::new(CompactModel::new(&scene, &Overrides::default()).unwrap()),
        Box::new(NerfModel::new(settings)),
    ];
    for model in &mut models {
        let losses: Vec<f64> = (1..=30).map(|step| model.step(&scene, step).unwrap().loss).collect();
        assert!(losses[29] < losses[0], "{losses:?}");
        let scores = evaluate(&**model, &scene.train, [0.0; 3], false, |_, _| Ok(())).unwrap();
        assert_eq!(scores.views.len(), 3);
    }
    let half = Options { shrink: Some(2), ..Options::default() };
    let half = scene::load(folder.path().to_str().unwrap(), &half).unwrap();
    assert_eq!(half.train[0].image.as_ref().unwrap().size(), (4, 3));
}

/// Masked pixels are neither drawn nor measured.
#[test]
fn masks_leave_pixels_out() {
    let folder = capture(|root| {
        nerfstudio(root, |json| {
            for frame in json["frames"].as_array_mut().unwrap() {
                frame["mask_path"] = json!("masks/left.png");
            }
        });
        fs::create_dir(root.join("masks")).unwrap();
        let left = |i: u32, _| image::Luma([if i < 6 { 1u8 } else { 0 }]);
        image::GrayImage::from_fn(12, 8, left).save(root.join("masks/left.png")).unwrap();
    });
    let scene = load(folder.path());
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let key = Key::new(0, Purpose::Rays);
    let drawn: Vec<[usize; 3]> = (0..4000).map(|ray| random_pixel(&scene.train, &key, 1, ray)).collect();
    assert!(drawn.iter().all(|[_, _, i]| *i < 6));
    let different: std::collections::BTreeSet<_> = drawn.iter().collect();
    assert_eq!(different.len(), 3 * 6 * 8, "all others are drawn");
    // Another picture under the mask is another scene for the digest, but no other result.
    let mut model = CompactModel::new(&scene, &Overrides::default()).unwrap();
    let score = |model: &CompactModel, scene: &Scene| {
        evaluate(model, &scene.val, [0.0; 3], false, |_, _| Ok(())).unwrap().views[0].mse
    };
    model.step(&scene, 1).unwrap();
    let before = score(&model, &scene);
    for name in NAMES {
        let path = folder.path().join("images").join(name);
        let mut picture = image::open(&path).unwrap().into_rgb8();
        picture
            .enumerate_pixels_mut()
            .filter(|(i, _, _)| *i >= 6)
            .for_each(|(_, _, p)| *p = image::Rgb([255; 3]));
        picture.save(&path).unwrap();
    }
    let other = load(folder.path());
    assert_ne!(other.digest(), scene.digest());
    let mut again = CompactModel::new(&other, &Overrides::default()).unwrap();
    again.step(&other, 1).unwrap();
    assert_eq!(score(&again, &other), before);
    let half = Options { shrink: Some(4), ..Options::default() };
    let half = scene::load(folder.path().to_str().unwrap(), &half).unwrap();
    let mask = half.train[0].image.as_ref().unwrap().mask().unwrap().clone();
    assert_eq!(
        (0..mask.len()).filter(|&n| mask.counts(n)).collect::<Vec<_>>(),
        [0, 3],
        "a column of 4x4 squares"
    );
    image::GrayImage::new(12, 8).save(folder.path().join("masks/left.png")).unwrap();
    assert!(refusal(folder.path()).contains("mask: found black alone"));
    image::GrayImage::new(6, 8).save(folder.path().join("masks/left.png")).unwrap();
    assert!(refusal(folder.path()).contains("mask: found 6x8; expected 12x8"));
    fs::remove_file(folder.path().join("masks/left.png")).unwrap();
    assert!(refusal(folder.path()).contains("mask_path of a"));
}

#[test]
fn a_phone_capture_of_colmap() {
    let Some(path) = shared("beer_colmap") else { return };
    let scene = load(&path);
    assert_eq!((scene.train.len(), scene.val.len(), scene.size()), (62, 9, (720, 1280)));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let cloud = scene.cloud.unwrap();
    let fit = cloud.reprojection.unwrap();
    assert_eq!(cloud.points.len(), 4414);
    assert!(fit.pixels < 1.5 * 0.64 && fit.behind == 0, "{fit:?}");
}

#[test]
fn a_forward_facing_capture_of_llff() {
    let Some(path) = shared("fern_llff") else { return };
    let scene = load(&path);
    assert_eq!((scene.train.len(), scene.val.len(), scene.size()), (17, 3, (504, 378)));
    let camera = scene.train[0].camera;
    assert!((camera.k.fx - 3260.526 / 8.0).abs() < 1e-3 && camera.k.cx == 252.0);
    // The least depth of all is 16.985, the largest 80.002.
    assert!((scene.near - 0.9 * 16.985).abs() < 1e-3 && scene.far > 80.0 && scene.far < 110.0);
}

/// Cameras that all look one way: the paper's network has its positions in normalized device coordinates, unless it is told otherwise.
#[test]
fn a_forward_facing_capture_is_learned_in_normalized_device_coordinates() {
    let Some(path) = shared("fern_llff") else { return };
    let scene = load(&path);
    let mut settings =
        NerfSettings { rays: 64, samples: 16, ..NerfSettings::new(scene.near, scene.far, [0.0; 3]) };
    settings.choose_space(&scene);
    let cube = settings.cube.expect("all rays go one way");
    assert!(cube.view.near > 0.5 * scene.near && cube.view.near < scene.near, "{cube:?}");
    let mut model = NerfModel::new(settings);
    let losses: Vec<f64> = (1..=30).map(|step| model.step(&scene, step).unwrap().loss).collect();
    assert!(losses[29] < losses[0], "{losses:?}");
    assert_eq!(model.settings()["space"], "ndc");
}
