//! Lenses of captures: every camera model that is read, and a scene that is learned through a fisheye.

use std::fs;
use std::path::Path;

use glam::{DVec2, DVec3};
use nerf_oracle::camera::{self, Distortion};
use nerf_oracle::convention::PixelCenter;
use nerf_oracle::evaluation::{evaluate, render_view};
use nerf_oracle::random::{Key, Purpose};
use nerf_oracle::ray::{Ray, camera_ray, pixel_position};
use nerf_oracle::scene::{self, Medium, Options, builtin, random_pixel};
use nerf_oracle::training::Model;
use nerf_oracle::training::compact::{CompactModel, Overrides};
use serde_json::json;

use super::files::{FOCAL, Lens, NAMES, SIZE, binary, text};
use super::{capture, load, nerfstudio, refusal};

fn opencv(k: &[f64]) -> Option<camera::Lens> {
    Some(camera::Lens::Opencv(Distortion::from_opencv(k)))
}

fn fisheye(k: [f64; 4]) -> Option<camera::Lens> {
    Some(camera::Lens::Fisheye(k))
}

#[test]
fn every_camera_model_that_bends_rays_as_opencv_does_is_read() {
    const K: [f64; 4] = [9.0, 8.0, 5.0, 3.0];
    const SAME: [f64; 4] = [9.0, 9.0, 5.0, 3.0];
    #[rustfmt::skip]
    let models: [(u32, &str, &[f64], [f64; 4], Option<camera::Lens>); 12] = [
        (0, "SIMPLE_PINHOLE", &[9.0, 5.0, 3.0], SAME, None),
        (1, "PINHOLE", &[9.0, 8.0, 5.0, 3.0], K, None),
        (2, "SIMPLE_RADIAL", &[9.0, 5.0, 3.0, 0.1], SAME, opencv(&[0.1, 0.0, 0.0, 0.0])),
        (3, "RADIAL", &[9.0, 5.0, 3.0, 0.1, 0.2], SAME, opencv(&[0.1, 0.2, 0.0, 0.0])),
        (4, "OPENCV", &[9.0, 8.0, 5.0, 3.0, 0.1, 0.2, 0.01, 0.02], K, opencv(&[0.1, 0.2, 0.01, 0.02])),
        (4, "OPENCV", &[9.0, 8.0, 5.0, 3.0, 0.0, 0.0, 0.0, 0.0], K, None),
        (6, "FULL_OPENCV", &[9.0, 8.0, 5.0, 3.0, 0.1, 0.2, 0.01, 0.02, 0.0, 0.0, 0.0, 0.0], K, opencv(&[0.1, 0.2, 0.01, 0.02])),
        (6, "FULL_OPENCV", &[9.0, 8.0, 5.0, 3.0, 0.1, 0.2, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06], K, opencv(&[0.1, 0.2, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06])),
        (5, "OPENCV_FISHEYE", &[9.0, 8.0, 5.0, 3.0, 0.1, 0.2, 0.03, 0.04], K, fisheye([0.1, 0.2, 0.03, 0.04])),
        (8, "SIMPLE_RADIAL_FISHEYE", &[9.0, 5.0, 3.0, 0.1], SAME, fisheye([0.1, 0.0, 0.0, 0.0])),
        (9, "RADIAL_FISHEYE", &[9.0, 5.0, 3.0, 0.1, 0.2], SAME, fisheye([0.1, 0.2, 0.0, 0.0])),
        (10, "THIN_PRISM_FISHEYE", &[9.0, 8.0, 5.0, 3.0, 0.1, 0.2, 0.0, 0.0, 0.03, 0.04, 0.0, 0.0], K, fisheye([0.1, 0.2, 0.03, 0.04])),
    ];
    for (id, name, parameters, k, distortion) in models {
        let lens = || Lens { id, name, parameters: parameters.to_vec() };
        for scene in [
            load(capture(|root| binary(&root.join("sparse/0"), &lens(), 0.0)).path()),
            load(capture(|root| text(&root.join("sparse/0"), &lens())).path()),
        ] {
            let camera = scene.train[0].camera;
            let found = [camera.k.fx, camera.k.fy, camera.k.cx, camera.k.cy];
            assert_eq!((found, camera.distortion), (k, distortion), "{name}");
        }
    }
    let others: [(u32, &str, usize); 3] =
        [(7, "FOV", 5), (10, "THIN_PRISM_FISHEYE", 12), (11, "RAD_TAN_THIN_PRISM_FISHEYE", 16)];
    for (id, name, n) in others {
        let lens = || Lens { id, name, parameters: vec![9.0; n] };
        for folder in [
            capture(|root| binary(&root.join("sparse/0"), &lens(), 0.0)),
            capture(|root| text(&root.join("sparse/0"), &lens())),
        ] {
            let message = refusal(folder.path());
            for words in [format!("model of camera 7: found {name}"), "colmap image_undistorter".into()] {
                assert!(message.contains(&words), "{words:?} isn't in: {message}");
            }
        }
    }
}

/// The coefficients of the fisheye that these tests look through, and of a rational lens.
const BENT: [f64; 4] = [0.05, -0.02, 0.01, -0.004];
const RATIONAL: [f64; 8] = [0.2, -0.1, 0.01, -0.02, 0.05, 0.1, 0.02, -0.03];

fn lens(id: u32, name: &'static str, coefficients: &[f64]) -> Lens {
    let k = [FOCAL, FOCAL, 0.5 * SIZE[0] as f64, 0.5 * SIZE[1] as f64];
    Lens { id, name, parameters: [&k, coefficients].concat() }
}

/// Points that were projected by another formula are where the reader's cameras see them, and nerfstudio's file has the same rays.
#[test]
fn points_are_seen_where_the_lens_puts_them() {
    for (lens, model) in [
        (lens(5, "OPENCV_FISHEYE", &BENT), "OPENCV_FISHEYE"),
        (lens(6, "FULL_OPENCV", &RATIONAL), "FULL_OPENCV"),
    ] {
        let scene = load(capture(|root| binary(&root.join("sparse/0"), &lens, 0.0)).path());
        let fit = scene.cloud.as_ref().unwrap().reprojection.unwrap();
        assert!(fit.sights == 500 && fit.pixels < 1e-9, "{model}: {fit:?}");
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
        let straight = load(capture(|root| binary(&root.join("sparse/0"), &super::pinhole(), 0.0)).path());
        let apart = camera_ray(&scene.val[0].camera, DVec2::new(1.5, 1.5)).unwrap().d
            - camera_ray(&straight.val[0].camera, DVec2::new(1.5, 1.5)).unwrap().d;
        assert!(apart.length() > 1e-3, "{model}: the lens bends rays");
        let names: &[&str] = match model {
            "FULL_OPENCV" => &["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"],
            _ => &["k1", "k2", "k3", "k4"],
        };
        let same = load(
            capture(|root| {
                nerfstudio(root, |json| {
                    json["camera_model"] = json!(model);
                    names.iter().zip(&lens.parameters[4..]).for_each(|(name, k)| json[*name] = json!(k));
                })
            })
            .path(),
        );
        super::assert_same(&scene, &same);
        assert_eq!(scene.val[0].camera.distortion, same.val[0].camera.distortion);
    }
    // instant-ngp has a flag for it.
    let flagged =
        capture(|root| nerfstudio(root, |json| (json["is_fisheye"], json["k1"]) = (json!(true), json!(0.1))));
    assert_eq!(load(flagged.path()).val[0].camera.distortion, fisheye([0.1, 0.0, 0.0, 0.0]));
    let cubic = capture(|root| nerfstudio(root, |json| json["k3"] = json!(0.1)));
    assert_eq!(load(cubic.path()).val[0].camera.distortion, opencv(&[0.0, 0.0, 0.0, 0.0, 0.1]));
    // nerfstudio's own k4 isn't OpenCV's.
    let fourth = capture(|root| nerfstudio(root, |json| json["k4"] = json!(0.1)));
    assert!(refusal(fourth.path()).contains("k4 of a: found 0.1, which programs take for two things"));
}

/// The direction in camera space of a fisheye's pixel, by bisection; `None` from 90 degrees on.
fn straightened(k: [f64; 4], x: f64, y: f64) -> Option<DVec3> {
    let bent = |theta: f64| (0..4).fold(theta, |sum, i| sum + k[i] * theta.powi(2 * i as i32 + 3));
    let (mut low, mut high) = (0.0, std::f64::consts::FRAC_PI_2);
    let r = x.hypot(y);
    if bent(high) <= r {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if bent(middle) < r { low = middle } else { high = middle }
    }
    Some(DVec3::new(x / r * low.sin(), y / r * low.sin(), low.cos()))
}

/// The built-in spheres as a fisheye shows them, with cameras as nerfstudio writes them; what is beyond the circle is white.
fn spheres(folder: &Path, size: usize, focal: f64, model: &str) {
    let options = Options::default();
    let plain = scene::load(&format!("builtin:spheres,size={size},views=24"), &options).unwrap();
    let medium = Medium::named("spheres").unwrap();
    let mut frames = vec![];
    fs::create_dir_all(folder.join("images")).unwrap();
    for (n, frame) in plain.train.iter().enumerate() {
        let pose = frame.camera.c2w;
        let picture = image::RgbImage::from_fn(size as u32, size as u32, |i, j| {
            let [x, y] = [i, j].map(|n| (f64::from(n) + 0.5 - 0.5 * size as f64) / focal);
            let Some(d) = straightened(BENT, x, y) else { return image::Rgb([255; 3]) };
            let ray = Ray { o: pose.w_axis.truncate(), d: pose.transform_vector3(d) };
            image::Rgb(
                builtin::render(&medium, &ray, plain.near, plain.far, 64).color.map(|c| (255.0 * c) as u8),
            )
        });
        let name = format!("images/{n:02}.png");
        picture.save(folder.join(&name)).unwrap();
        let [x, y, z, o] = pose.to_cols_array_2d();
        let row = |i: usize| [x[i], -y[i], -z[i], o[i]];
        frames.push(
            json!({"file_path": name, "transform_matrix": [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]}),
        );
    }
    let [k1, k2, k3, k4] = BENT;
    let json = json!({
        "w": size, "h": size, "fl_x": focal, "fl_y": focal, "cx": 0.5 * size as f64, "cy": 0.5 * size as f64,
        "camera_model": model, "k1": k1, "k2": k2, "k3": k3, "k4": if model == "OPENCV" { 0.0 } else { k4 }, "frames": frames,
    });
    fs::write(folder.join("transforms.json"), json.to_string()).unwrap();
}

/// A field that is learned through the right lens shows a pinhole what is there; one that is learned through a wrong one doesn't.
#[test]
fn a_scene_is_learned_through_a_fisheye() {
    let black = Options { background: Some([0.0; 3]), ..Options::default() };
    let truth = scene::load("builtin:spheres,size=40,views=24", &black).unwrap();
    let psnr = |model: &str| {
        let folder = tempfile::tempdir().unwrap();
        spheres(folder.path(), 40, 30.0, model);
        let options = Options { near: Some(truth.near), far: Some(truth.far), ..Options::default() };
        let scene = scene::load(folder.path().to_str().unwrap(), &options).unwrap();
        let mut learned = CompactModel::new(&scene, &Overrides::default()).unwrap();
        (1..=300).for_each(|step| assert!(learned.step(&scene, step).unwrap().loss.is_finite()));
        evaluate(&learned, &truth.val, [0.0; 3], false, |_, _| Ok(())).unwrap().psnr
    };
    let (right, wrong) = (psnr("OPENCV_FISHEYE"), psnr("OPENCV"));
    assert!(
        right > 25.0 && right > wrong + 1.0,
        "{right:.2} dB through the fisheye, {wrong:.2} dB through another lens"
    );
}

/// A circular picture: beyond 90 degrees nothing is learned, measured or rendered, and it is said.
#[test]
fn beyond_the_circle_of_a_fisheye_there_is_nothing() {
    let folder = tempfile::tempdir().unwrap();
    spheres(folder.path(), 20, 5.0, "OPENCV_FISHEYE");
    let scene = load(folder.path());
    assert!(scene.warnings.iter().any(|w| w.contains("of 24 pictures have no ray")), "{:?}", scene.warnings);
    let mask = scene.train[0].image.as_ref().unwrap().mask().unwrap();
    for n in 0..400 {
        let [x, y] = [n % 20, n / 20].map(|n| (n as f64 + 0.5 - 10.0) / 5.0);
        assert_eq!(mask.counts(n), straightened(BENT, x, y).is_some(), "{x} {y}");
    }
    let key = Key::new(0, Purpose::Rays);
    for ray in 0..2000 {
        let [frame, j, i] = random_pixel(&scene.train, &key, 1, ray);
        camera_ray(&scene.train[frame].camera, pixel_position(i, j, PixelCenter::Half)).unwrap();
    }
    let mut model = CompactModel::new(&scene, &Overrides::default()).unwrap();
    (1..=20).for_each(|step| assert!(model.step(&scene, step).unwrap().loss.is_finite()));
    let scores = evaluate(&model, &scene.val, [0.0; 3], true, |_, _| Ok(())).unwrap();
    assert!(scores.psnr > 5.0, "white corners aren't measured: {}", scores.psnr);
    let view = render_view(&model, &scene.val[0].camera, [0.25, 0.5, 0.75]).unwrap();
    assert_eq!(([0, 1, 2].map(|k| view.rgb[[0, 0, k]]), view.opacity[[0, 0]]), ([0.25, 0.5, 0.75], 0.0));
    // A lens that sees nothing at all in its picture is wrong.
    let json = fs::read_to_string(folder.path().join("transforms.json")).unwrap();
    fs::write(folder.path().join("transforms.json"), json.replace("\"fl_x\":5.0", "\"fl_x\":0.01")).unwrap();
    assert!(refusal(folder.path()).contains("no pixel that counts and has a ray"));
}

/// COLMAP's masks, by its own names and by plain ones; those of smaller copies lie beside them.
#[test]
fn masks_of_colmap_leave_pixels_out() {
    let folder = capture(|root| binary(&root.join("sparse/0"), &super::pinhole(), 0.0));
    let masks = folder.path().join("masks");
    fs::create_dir(&masks).unwrap();
    let left = |i: u32, _| image::Luma([if i < 6 { 255u8 } else { 0 }]);
    let mask = image::GrayImage::from_fn(12, 8, left);
    mask.save(masks.join("a.png.png")).unwrap();
    mask.save(masks.join("b.png")).unwrap();
    let scene = load(folder.path());
    assert!(scene.warnings[0].contains("2 of 4 pictures have a mask"), "{:?}", scene.warnings);
    let count = |n: usize| {
        let frames = [&scene.val[..], &scene.train[..]].concat();
        frames[n].image.as_ref().unwrap().mask().map(|mask| mask.count())
    };
    assert_eq!([0, 1, 2, 3].map(count), [Some(48), Some(48), None, None]);
    NAMES[2..].iter().for_each(|name| mask.save(masks.join(name)).unwrap());
    assert!(load(folder.path()).warnings.is_empty());
    super::pictures(&folder.path().join("images_4"), [3, 2]);
    let small = load(&folder.path().join("images_4"));
    assert!(small.warnings[0].contains("0 of 4 pictures have a mask"), "{:?}", small.warnings);
    fs::create_dir(folder.path().join("masks_4")).unwrap();
    for name in NAMES {
        image::GrayImage::from_fn(3, 2, |i, _| image::Luma([255 * u8::from(i < 1)]))
            .save(folder.path().join("masks_4").join(name))
            .unwrap();
    }
    let small = load(&folder.path().join("images_4"));
    assert_eq!(small.train[0].image.as_ref().unwrap().mask().unwrap().count(), 2);
    // A folder of masks is never one of pictures.
    fs::rename(folder.path().join("images"), folder.path().join("photos")).unwrap();
    fs::remove_dir_all(folder.path().join("images_4")).unwrap();
    assert_eq!(load(folder.path()).train[0].image.as_ref().unwrap().at(0, 1)[0], 20.0 / 255.0);
}

/// Names in a model that lead elsewhere.
#[test]
fn pictures_outside_of_the_capture_are_not_read() {
    let secret = tempfile::tempdir().unwrap();
    super::pictures(secret.path(), SIZE);
    let away = secret.path().join("a.png").display().to_string();
    for name in [away.as_str(), "../images/a.png", "x/../../images/a.png", "..\\a.png", "."] {
        let folder = capture(|root| text(&root.join("sparse/0"), &super::pinhole()));
        let file = folder.path().join("sparse/0/images.txt");
        let images = fs::read_to_string(&file).unwrap().replace("7 a.png", &format!("7 {name}"));
        fs::write(&file, images).unwrap();
        let message = refusal(folder.path());
        assert!(
            message.contains("name of a picture: found") && message.contains("below"),
            "{name}: {message}"
        );
    }
}
