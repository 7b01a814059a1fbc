//! Captures that COLMAP has found the cameras of: a folder with `sparse/0`, or one like it, beside the pictures.

use std::path::{Path, PathBuf};

use super::cloud::{self, Cloud, Reprojection};
use super::layout::{Backdrop, settle};
use super::pictures::{self, Capture};
use super::{Frame, Options, Photo, Scene, check};
use crate::camera::{Camera, Intrinsics};
use crate::error::{Error, Result};
use faulty::faulty;
use model::{Model, View};

mod binary;
mod faulty;
mod lens;
mod model;
mod text;

/// Where the model lies in a capture's folder.
const MODELS: [&str; 5] = ["sparse/0", "sparse", "colmap/sparse/0", "colmap/sparse", ""];

/// The folder of the model, if there is one: the one with `cameras.bin` or `cameras.txt`.
fn model_folder(root: &Path) -> Option<PathBuf> {
    let has = |folder: &PathBuf| ["cameras.bin", "cameras.txt"].iter().any(|name| folder.join(name).exists());
    MODELS.iter().map(|name| root.join(name)).find(has)
}

/// The capture at a path, if it is COLMAP's.
pub(super) fn at(path: &Path) -> Option<Capture<'_>> {
    Capture::at(path, |folder| model_folder(folder).is_some())
}

/// Reads a capture.
pub(super) fn load(capture: &Capture, options: &Options) -> Result<Scene> {
    let folder = model_folder(capture.root).expect("a capture with a model");
    let is_binary = folder.join("cameras.bin").exists();
    let mut model = if is_binary { binary::read(&folder) } else { text::read(&folder) }?;
    let file = |name: &str| {
        folder.join(name).with_extension(if is_binary { "bin" } else { "txt" }).display().to_string()
    };
    let files = Files { cameras: file("cameras"), images: file("images"), points: file("points3D") };
    model.views.sort_by(|a, b| a.name.cmp(&b.name));
    let mut scene = Scene::empty(&capture.chosen.unwrap_or(capture.root).display().to_string(), options);
    if folder.ends_with("0") && folder.with_file_name("1").is_dir() {
        let more = "the model has other parts, which are not used: sparse/1.";
        scene.warnings.push(format!("{}: {more}", folder.display()));
    }
    let frames = frames(&model, capture, &files, &mut scene)?;
    scene.cloud = seen(&model, &frames, &files)?.useful(&mut scene.warnings);
    scene.hold_out(frames.into_iter().map(|(frame, _)| frame).collect(), options);
    check::frames(&files.cameras, &scene.train, &scene.val)?;
    settle(&mut scene, &files.images, Backdrop::World, options)?;
    Ok(scene)
}

/// The names of the model's files, for messages.
struct Files {
    cameras: String,
    images: String,
    points: String,
}

/// Every photograph whose picture is there, with its view.
fn frames<'a>(
    model: &'a Model,
    capture: &Capture,
    files: &Files,
    scene: &mut Scene,
) -> Result<Vec<(Frame, &'a View)>> {
    let remedy = "Give the folder that has both the pictures and sparse/0.";
    let file = &files.images;
    if model.views.is_empty() {
        return Err(faulty(file, "pictures", "none", "at least one", remedy));
    }
    let names: Vec<String> = model.views.iter().map(|view| view.name.clone()).collect();
    if let Some(view) = model.views.iter().find(|view| !pictures::stays_below(&view.name)) {
        let remedy =
            "Nothing outside of the capture is read: put the pictures below it and correct the names.";
        let expected = "a path below the folder of the pictures";
        return Err(faulty(file, "name of a picture", &view.name, expected, remedy));
    }
    if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(faulty(
            file,
            "pictures",
            format!("{} twice", twice[0]),
            "each once",
            "Write the model again.",
        ));
    }
    let paths = capture.named(&names, scene);
    let size = |view: &View| model.cameras.get(&view.camera).map(|lens| lens.size.map(|side| side as usize));
    let stated: Vec<_> = model.views.iter().map(size).collect();
    let photos = pictures::read(file, &paths, &stated, scene.background)?;
    let photos = pictures::all_masked(photos, &capture.masks(&paths, scene))?;
    let (mut frames, mut missing) = (vec![], vec![]);
    for (view, photo) in model.views.iter().zip(photos) {
        match photo {
            Some(photo) => frames.push((frame(model, view, photo, files)?, view)),
            None => missing.push(view.name.as_str()),
        }
    }
    pictures::missing(file, &missing, names.len(), remedy, scene)?;
    Ok(frames)
}

/// One photograph: its camera is scaled to the picture's size.
fn frame(model: &Model, view: &View, photo: Photo, files: &Files) -> Result<Frame> {
    let (id, name) = (view.camera, &view.name);
    let remedy = "Write the model again with COLMAP.";
    let Some(lens) = model.cameras.get(&id) else {
        let expected = format!("one of {}", files.cameras);
        return Err(faulty(&files.images, format!("camera of {name}"), id, &expected, remedy));
    };
    let (k, distortion) = lens.pinhole(&files.cameras, id)?;
    let ((height, width), [w, h]) = (photo.size(), lens.size.map(|side| side as f64));
    let (sx, sy) = (width as f64 / w, height as f64 / h);
    // Sides of smaller pictures are rounded, each by less than a pixel.
    if (width as f64 * h - height as f64 * w).abs() > w + h {
        let remedy = "Turn or crop it as it was when COLMAP saw it.";
        let (found, expected) = (format!("{width}x{height}"), format!("the shape of {w}x{h}"));
        return Err(faulty(&files.cameras, format!("size of {name}"), found, &expected, remedy));
    }
    let k = Intrinsics { fx: k.fx * sx, fy: k.fy * sy, cx: k.cx * sx, cy: k.cy * sy };
    let camera = Camera { width, height, k, c2w: view.pose(&files.images)?, distortion };
    Ok(Frame { name: name.clone(), camera, image: Some(photo) })
}

/// The points that these photographs show.
fn seen(model: &Model, frames: &[(Frame, &View)], files: &Files) -> Result<Cloud> {
    let mut cloud =
        Cloud { points: model.points.values().map(|point| point.place).collect(), ..Cloud::default() };
    let mut fit = Reprojection::default();
    for (frame, view) in frames {
        let camera = &frame.camera;
        // In pixels of the model, whatever size the picture is.
        let [w, h] = model.cameras[&view.camera].size.map(|side| side as f64);
        let scale = glam::DVec2::new(w / camera.width as f64, h / camera.height as f64);
        for sight in &view.sights {
            let point = model.points.get(&sight.point).ok_or_else(|| dangling(files, view, sight.point))?;
            fit.sights += 1;
            fit.stated += point.error;
            match cloud::project(camera, point.place) {
                None => fit.behind += 1,
                Some(uv) => {
                    fit.pixels += (uv * scale - sight.uv).length();
                    cloud.distances.push((point.place - camera.c2w.w_axis.truncate()).length());
                }
            }
        }
    }
    cloud.distances.sort_by(f64::total_cmp);
    fit.pixels /= (fit.sights - fit.behind) as f64;
    fit.stated /= fit.sights as f64;
    cloud.reprojection = (fit.sights > fit.behind).then_some(fit);
    Ok(cloud)
}

fn dangling(files: &Files, view: &View, point: u64) -> Error {
    let (field, found) = (format!("points of {}", view.name), format!("point {point}"));
    let expected = format!("one of {}", files.points);
    faulty(&files.images, field, found, &expected, "Copy all three files of one model.")
}
