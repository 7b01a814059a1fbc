//! From a scene's file to a training step: the fast path against the reference on every reader's scene, and a few
//! steps on real photographs.

mod shared;

use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3};
use ndarray::{Array2, Array3, Array4, Axis, stack};
use nerf_oracle::camera::Camera;
use nerf_oracle::evaluation::camera_rays;
use nerf_oracle::files::npz::{self, Array, Arrays};
use nerf_oracle::files::picture;
use nerf_oracle::scene::{self, Options, Scene};
use nerf_oracle::training::compact::{CompactModel, Overrides};
use nerf_oracle::training::nerf::{NerfModel, NerfSettings};
use nerf_oracle::training::{Model, Pixel};
use serde_json::{Value, json};
use shared::shared;

const WIDTH: usize = 12;
const HEIGHT: usize = 10;
const FOCAL: f64 = 15.0;

/// Four cameras around the origin, OpenGL axes: x right, y up, z backward.
fn poses() -> Vec<DMat4> {
    let eyes = [[4.0, 0.0, 1.0], [0.5, 4.0, 0.5], [-3.0, -3.0, 1.5], [2.5, -3.0, 2.0]];
    let pose = |eye: [f64; 3]| {
        let eye = DVec3::from(eye);
        let backward = eye.normalize();
        let right = DVec3::Z.cross(backward).normalize();
        let up = backward.cross(right);
        DMat4::from_cols(right.extend(0.0), up.extend(0.0), backward.extend(0.0), eye.extend(1.0))
    };
    eyes.map(pose).into()
}

/// What camera n sees: colors that differ from pixel to pixel, in whole 255ths.
fn picture(n: usize) -> Array3<f32> {
    Array3::from_shape_fn((HEIGHT, WIDTH, 3), |(j, i, k)| {
        ((40 * n + 17 * i + 9 * j + 60 * k) % 256) as f32 / 255.0
    })
}

fn rows(m: DMat4) -> Array2<f64> {
    let rows: Vec<f64> = m.transpose().to_cols_array().into();
    Array2::from_shape_vec((4, 4), rows).unwrap()
}

fn pictures() -> Array {
    let all: Vec<_> = (0..4).map(picture).collect();
    let all: Array4<f32> = stack(Axis(0), &all.iter().map(|p| p.view()).collect::<Vec<_>>()).unwrap();
    Array::F32(all.into_dyn())
}

fn matrices(poses: &[DMat4]) -> Array {
    let all: Vec<_> = poses.iter().map(|&pose| rows(pose)).collect();
    Array::F64(stack(Axis(0), &all.iter().map(|p| p.view()).collect::<Vec<_>>()).unwrap().into_dyn())
}

/// The same four photographs in every layout that can be read.
fn layouts(folder: &Path) -> Vec<PathBuf> {
    let focal = || Array::F64(ndarray::arr0(FOCAL).into_dyn());
    let opencv: Vec<DMat4> =
        poses().iter().map(|p| DMat4::from_cols(p.x_axis, -p.y_axis, -p.z_axis, p.w_axis)).collect();
    let (cs180, tiny) = (folder.join("cs180.npz"), folder.join("tiny.npz"));
    let (blender, ngp) = (folder.join("blender"), folder.join("ngp"));
    let arrays = ["train", "val"].into_iter().flat_map(|split| {
        [(format!("images_{split}"), pictures()), (format!("c2ws_{split}"), matrices(&opencv))]
    });
    npz::write(&cs180, &arrays.chain([("focal".into(), focal())]).collect(), false).unwrap();
    let arrays = [("images", pictures()), ("poses", matrices(&poses())), ("focal", focal())];
    npz::write(&tiny, &arrays.map(|(name, array)| (name.into(), array)).into(), false).unwrap();
    let frames: Vec<Value> = (0..4)
        .map(|n| {
            let path = format!("{n}.png");
            picture::write_png(&blender.join(&path), picture(n).view()).unwrap();
            picture::write_png(&ngp.join(&path), picture(n).view()).unwrap();
            let matrix: Vec<Vec<f64>> = rows(poses()[n]).outer_iter().map(|row| row.to_vec()).collect();
            json!({ "file_path": path, "transform_matrix": matrix })
        })
        .collect();
    let angle = 2.0 * (0.5 * WIDTH as f64 / FOCAL).atan();
    for split in ["train", "val"] {
        let json = json!({ "camera_angle_x": angle, "frames": frames });
        std::fs::write(blender.join(format!("transforms_{split}.json")), json.to_string()).unwrap();
    }
    let json = json!({
        "fl_x": FOCAL, "fl_y": 0.9 * FOCAL, "cx": 5.5, "cy": 5.25, "w": WIDTH, "h": HEIGHT, "frames": frames,
        "k1": 0.05, "k2": -0.01, "p1": 0.002, "p2": -0.001,
    });
    std::fs::write(ngp.join("transforms.json"), json.to_string()).unwrap();
    vec![cs180, tiny, blender, ngp]
}

fn load(path: &Path) -> Scene {
    scene::load(path.to_str().unwrap(), &Options { holdout: Some(4), ..Options::default() }).unwrap()
}

/// A model on either path, with the f32 path's initial parameters and a density head that isn't dead.
fn model(scene: &Scene, reference: bool) -> NerfModel {
    let settings = NerfSettings {
        rays: 4,
        samples: 16,
        seed: 1,
        ..NerfSettings::new(scene.near, scene.far, scene.background)
    };
    let mut start = NerfModel::new(settings).state();
    start.insert("sigma_b".into(), Array::F32(ndarray::arr1(&[0.3]).into_dyn()));
    let mut model = NerfModel::new(NerfSettings { reference, ..settings });
    model.restore(&start, "the start").unwrap();
    model
}

fn four_pixels(model: &dyn Model, camera: &Camera) -> Vec<Pixel> {
    let rays = camera_rays(camera).unwrap();
    model.render(&[rays[0], rays[41], rays[66], rays[WIDTH * HEIGHT - 1]])
}

/// Largest difference of two arrays over the largest entry of the second.
fn difference(got: &Array, want: &Array) -> f64 {
    let (got, want) = (got.to_f64(), want.to_f64());
    let largest = |values: ndarray::ArrayD<f64>| values.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    largest(got - &want) / largest(want).max(f64::MIN_POSITIVE)
}

/// The fields `m.*` of a state: after one step of Adam they are the gradient, times 1 - beta1.
fn gradients(state: &Arrays) -> impl Iterator<Item = (&String, &Array)> {
    state.iter().filter(|(name, _)| name.starts_with("m."))
}

#[test]
fn the_fast_path_agrees_with_the_reference_on_every_readers_scene() {
    let folder = tempfile::tempdir().unwrap();
    for path in layouts(folder.path()) {
        let scene = load(&path);
        let name = path.file_name().unwrap().to_str().unwrap();
        assert_eq!(scene.train[0].camera.distortion.is_some(), name == "ngp", "{name}");
        let (mut fast, mut reference) = (model(&scene, false), model(&scene, true));
        let camera = &scene.val[0].camera;
        let mut opacity = 0f32;
        for (got, want) in four_pixels(&fast, camera).iter().zip(four_pixels(&reference, camera)) {
            opacity = opacity.max(want.opacity);
            for (got, want) in got.rgb.iter().zip(want.rgb) {
                assert!((got - want).abs() < 1e-5, "{name}: color {got}, expected {want}");
            }
        }
        assert!(opacity > 0.1, "{name}: something has to be seen, not {opacity}");
        let (got, want) = (fast.step(&scene, 1).unwrap(), reference.step(&scene, 1).unwrap());
        assert!((got.loss - want.loss).abs() < 1e-5, "{name}: loss {}, expected {}", got.loss, want.loss);
        let (got, want) = (fast.state(), reference.state());
        assert_eq!(gradients(&want).count(), 24, "12 layers, weights and biases");
        for (array, want) in gradients(&want) {
            let difference = difference(&got[array], want);
            assert!(difference < 1e-4, "{name}: {array} is off by {difference:e} of its largest entry");
        }
    }
}

/// The same photographs with the same cameras are the same scene, whatever the file is.
#[test]
fn every_layout_means_the_same_rays() {
    let folder = tempfile::tempdir().unwrap();
    let paths = layouts(folder.path());
    let whole = load(&paths[0]);
    // `tiny.npz` holds back its first frame, `ngp` has a lens of its own.
    for (path, skip) in [(&paths[1], 1), (&paths[2], 0)] {
        let scene = load(path);
        for (frame, same) in scene.train.iter().zip(&whole.train[skip..]) {
            for (ray, want) in
                camera_rays(&frame.camera).unwrap().iter().zip(camera_rays(&same.camera).unwrap())
            {
                assert!((ray.o - want.o).length() < 1e-12 && (ray.d - want.d).length() < 1e-12, "{path:?}");
            }
            assert_eq!(frame.image, same.image, "{path:?}");
        }
    }
}

/// Mean squared error over every 97th pixel of the first validation view.
fn error(model: &dyn Model, scene: &Scene) -> f64 {
    let (frame, stride) = (&scene.val[0], 97);
    let rays: Vec<_> = camera_rays(&frame.camera).unwrap().into_iter().step_by(stride).collect();
    let pixels: Vec<[f32; 3]> = frame.image.as_ref().unwrap().colors().collect();
    let seen = model.render(&rays);
    let squares = seen.iter().zip(pixels.iter().step_by(stride)).flat_map(|(seen, pixel)| {
        let clear = 1.0 - seen.opacity;
        (0..3).map(move |k| f64::from(seen.rgb[k] + clear * scene.background[k] as f32 - pixel[k]).powi(2))
    });
    squares.sum::<f64>() / (3 * rays.len()) as f64
}

/// Steps 1 to `steps`: the error on a view that isn't learned from, before and after them.
fn learned(model: &mut dyn Model, scene: &Scene, steps: u64) -> (f64, f64) {
    let before = error(model, scene);
    for step in 1..=steps {
        assert!(model.step(scene, step).unwrap().loss.is_finite());
    }
    (before, error(model, scene))
}

#[test]
fn a_few_steps_on_photographs() {
    for (name, steps) in [("lego_200x200.npz", 60), ("tiny_nerf_lego_100x100.npz", 60), ("fox_capture", 60)] {
        let Some(path) = shared(name) else { continue };
        let scene = scene::load(path.to_str().unwrap(), &Options::default()).unwrap();
        let overrides = Overrides { rays: Some(128), ..Overrides::default() };
        let (before, after) = learned(&mut CompactModel::new(&scene, &overrides).unwrap(), &scene, steps);
        assert!(after < 0.7 * before, "{name}, compact: {before} before, {after} after {steps} steps");
    }
    let Some(path) = shared("lego_200x200.npz") else { return };
    let scene = scene::load(path.to_str().unwrap(), &Options::default()).unwrap();
    let settings =
        NerfSettings { rays: 64, samples: 32, ..NerfSettings::new(scene.near, scene.far, scene.background) };
    let (before, after) = learned(&mut NerfModel::new(settings), &scene, 40);
    assert!(after < 0.9 * before, "8x256: {before} before, {after} after 40 steps");
}
