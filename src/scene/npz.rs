//! Scenes in one `.npz`: the layouts of CS180 and of the tiny-NeRF notebook.

use std::path::Path;

use glam::DMat4;
use ndarray::{ArrayD, Axis, Ix3, Ix4};
use serde_json::Value;

use super::fields::listed;
use super::layout::{Backdrop, settle};
use super::{Frame, Options, Photo, Scene, check};
use crate::camera::{Camera, Intrinsics};
use crate::error::{Error, Input, Result};
use crate::files::npz::{Array, Npz};

/// The arrays of both layouts.
const CS180: [&str; 6] = ["images_train", "c2ws_train", "images_val", "c2ws_val", "c2ws_test", "focal"];
const TINY_NERF: [&str; 3] = ["images", "poses", "focal"];

/// How many frames of a tiny-NeRF file are for training: the notebook's own `images[:100]`.
const TINY_TRAIN: usize = 100;

/// Reads either layout: with `images_train` it is CS180's, with `images` and `poses` tiny-NeRF's.
pub(super) fn load(path: &Path, options: &Options) -> Result<Scene> {
    let file = path.display().to_string();
    let mut npz = Npz::open(path)?;
    let mut scene = Scene::empty(&file, options);
    match (npz.has("images_train"), npz.has("images") && npz.has("poses")) {
        (true, _) => cs180(&mut npz, &file, options, &mut scene)?,
        (false, true) => tiny_nerf(&mut npz, &file, options, &mut scene)?,
        (false, false) => {
            let found = format!("[{}]", npz.names().collect::<Vec<_>>().join(", "));
            let expected = "images_train, c2ws_train, ..., focal (CS180) or images, poses, focal (tiny-NeRF)";
            let remedy = "Rename the arrays, or give a folder of transforms.json.";
            return Err(Error::input(Input { file, field: "arrays", found, expected, remedy }));
        }
    }
    let known: &[&str] = if npz.has("images_train") { &CS180 } else { &TINY_NERF };
    let unused: Vec<&str> = npz.names().filter(|name| !known.contains(name)).collect();
    if !unused.is_empty() {
        scene.warnings.push(format!("{file}: arrays that are not used: {}.", listed(&unused)));
    }
    check::frames(&file, &scene.train, &scene.val)?;
    settle(&mut scene, &file, Backdrop::Plain, options)?;
    Ok(scene)
}

/// `images_train`, `c2ws_train`, `images_val`, `c2ws_val`, `c2ws_test` (OpenCV axes), `focal`.
fn cs180(npz: &mut Npz, file: &str, options: &Options, scene: &mut Scene) -> Result<()> {
    let focal = focal(npz, file)?;
    scene.train = split(npz, file, "train", focal)?;
    scene.val = split(npz, file, "val", focal)?;
    of_one_size(file, &scene.train, &scene.val)?;
    if npz.has("c2ws_test") {
        let poses = poses(npz, file, "c2ws_test")?;
        let Some(Camera { width, height, .. }) = scene.train.first().map(|frame| frame.camera) else {
            return Ok(());
        };
        for (i, c2w) in poses.into_iter().enumerate() {
            let camera = camera(width, height, focal, c2w);
            scene.test.push(Frame { name: format!("c2ws_test[{i}]"), camera, image: None });
        }
    }
    if options.holdout.is_some() {
        scene.warnings.push(format!("holdout is not used: {file} has a validation split of its own."));
    }
    scene.reasons.insert("val".into(), Value::from("the file's own split"));
    Ok(())
}

/// One focal length in pixels is stated: it means another view in pictures of another size.
fn of_one_size(file: &str, train: &[Frame], val: &[Frame]) -> Result<()> {
    let Some(first) = train.first() else { return Ok(()) };
    let size = |frame: &Frame| format!("{}x{}", frame.camera.width, frame.camera.height);
    match val.iter().find(|frame| size(frame) != size(first)) {
        None => Ok(()),
        Some(frame) => Err(Error::input(Input {
            file,
            field: &frame.name,
            found: size(frame),
            expected: format!("{} as {}", size(first), first.name),
            remedy: "Bring all pictures to the size that the focal length belongs to.",
        })),
    }
}

/// `images_NAME` with `c2ws_NAME`.
fn split(npz: &mut Npz, file: &str, name: &str, focal: f64) -> Result<Vec<Frame>> {
    let (images, poses) = (format!("images_{name}"), format!("c2ws_{name}"));
    frames(npz, file, (&images, &poses), focal, |c2w| c2w)
}

/// `images`, `poses` (OpenGL axes), `focal`. Frames from 100 on are for validation, or every Nth.
fn tiny_nerf(npz: &mut Npz, file: &str, options: &Options, scene: &mut Scene) -> Result<()> {
    let focal = focal(npz, file)?;
    let all = frames(npz, file, ("images", "poses"), focal, check::opengl_to_opencv)?;
    if options.holdout.is_some() || all.len() <= TINY_TRAIN {
        scene.hold_out(all, options);
        return Ok(());
    }
    scene.train = all;
    scene.val = scene.train.split_off(TINY_TRAIN);
    scene
        .reasons
        .insert("val".into(), Value::from(format!("frames {TINY_TRAIN} and later, as the notebook has it")));
    Ok(())
}

/// Images (F, H, W, 3) and their poses (F, 4, 4).
fn frames(
    npz: &mut Npz,
    file: &str,
    (images, poses_name): (&str, &str),
    focal: f64,
    axes: fn(DMat4) -> DMat4,
) -> Result<Vec<Frame>> {
    let poses = poses(npz, file, poses_name)?;
    let photos = images_of(npz, file, images)?;
    let count = photos.len();
    if poses.len() != count {
        let remedy = "Every image needs its pose, in the same order.";
        return Err(Error::input(Input {
            file,
            field: poses_name,
            found: poses.len(),
            expected: format!("{count}, as {images} has"),
            remedy,
        }));
    }
    let mut frames = Vec::with_capacity(count);
    for (i, (image, c2w)) in photos.into_iter().zip(poses).enumerate() {
        let (height, width) = image.size();
        let camera = camera(width, height, focal, axes(c2w));
        frames.push(Frame { name: format!("{images}[{i}]"), camera, image: Some(image) });
    }
    Ok(frames)
}

/// One focal length, the principal point in the middle.
fn camera(width: usize, height: usize, focal: f64, c2w: DMat4) -> Camera {
    let k = Intrinsics { fx: focal, fy: focal, cx: width as f64 / 2.0, cy: height as f64 / 2.0 };
    Camera { width, height, k, c2w, distortion: None }
}

/// Bytes, or floats in [0, 1].
fn images_of(npz: &mut Npz, file: &str, name: &str) -> Result<Vec<Photo>> {
    let array = npz.array(name)?;
    let shape = array.shape().to_vec();
    let remedy = "Stack the pictures as red, green, blue: bytes, or floats in [0, 1].";
    if shape.len() != 4 || shape[3] != 3 || shape[1] == 0 || shape[2] == 0 {
        let expected = "shape [frames, height, width, 3]";
        return Err(Error::input(Input {
            file,
            field: name,
            found: format!("shape {shape:?}"),
            expected,
            remedy,
        }));
    }
    let floats: ArrayD<f32> = match array {
        Array::U8(bytes) => {
            let (bytes, _) = bytes.into_raw_vec_and_offset();
            let pictures = bytes.chunks_exact(3 * shape[1] * shape[2]);
            return Ok(pictures
                .map(|p| Photo::opaque(shape[1], shape[2], p.as_chunks().0.to_vec()))
                .collect());
        }
        Array::F32(floats) => floats,
        Array::F16(floats) => floats.mapv(f32::from),
        Array::F64(floats) => floats.mapv(|x| x as f32),
        Array::I64(_) => {
            return Err(Error::input(Input {
                file,
                field: name,
                found: "wide integers",
                expected: "u8, f16, f32 or f64",
                remedy,
            }));
        }
    };
    if let Some(x) = floats.iter().find(|x| !(-1e-3..=1.001).contains(*x)) {
        return Err(Error::input(Input {
            file,
            field: name,
            found: x,
            expected: "colors in [0, 1]",
            remedy,
        }));
    }
    let stack = floats.into_dimensionality::<Ix4>().expect("four axes were just counted");
    Ok(stack.axis_iter(Axis(0)).map(|image| Photo::from(image.to_owned())).collect())
}

/// (F, 4, 4) camera-to-world matrices.
fn poses(npz: &mut Npz, file: &str, name: &str) -> Result<Vec<DMat4>> {
    let array = npz.array(name)?;
    let shape = array.shape().to_vec();
    if shape.len() != 3 || shape[1..] != [4, 4] {
        let remedy = "Give homogeneous camera-to-world matrices, one a frame.";
        return Err(Error::input(Input {
            file,
            field: name,
            found: format!("shape {shape:?}"),
            expected: "shape [frames, 4, 4]",
            remedy,
        }));
    }
    let array = array.to_f64().into_dimensionality::<Ix3>().expect("three axes were just counted");
    let poses = array.axis_iter(Axis(0)).enumerate();
    poses.map(|(i, matrix)| check::pose(file, &format!("{name}[{i}]"), matrix)).collect()
}

/// The focal length in pixels.
fn focal(npz: &mut Npz, file: &str) -> Result<f64> {
    let array = npz.array("focal")?;
    let values = array.to_f64();
    if values.len() != 1 {
        let remedy = "Give one focal length in pixels for all frames.";
        return Err(Error::input(Input {
            file,
            field: "focal",
            found: format!("shape {:?}", array.shape()),
            expected: "one number",
            remedy,
        }));
    }
    check::focal(file, "focal", values.iter().copied().next().unwrap_or(f64::NAN))
}
