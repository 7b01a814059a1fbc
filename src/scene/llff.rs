//! Captures with `poses_bounds.npy`, as LLFF's tools write it beside `images`, `images_4` or `images_8`.

use std::path::Path;

use glam::DMat4;
use ndarray::{Array1, Array2, ArrayView1, Axis, Ix2, s};

use super::layout::{Backdrop, settle};
use super::pictures::{self, Capture};
use super::{Frame, Options, Photo, Scene, check};
use crate::camera::{Camera, Intrinsics};
use crate::error::{Error, Input, Result};
use crate::files::npz;
use crate::limits::{LENGTH, SIDE};

const FILE: &str = "poses_bounds.npy";

/// A row: 3x5, camera to world beside height, width and focal length, then near and far.
const ROW: usize = 17;

/// The capture at a path, if it is one of these.
pub(super) fn at(path: &Path) -> Option<Capture<'_>> {
    Capture::at(path, |folder| folder.join(FILE).exists())
}

/// Reads a capture.
pub(super) fn load(capture: &Capture, options: &Options) -> Result<Scene> {
    let path = capture.root.join(FILE);
    let file = path.display().to_string();
    let rows = rows(&path, &file)?;
    let paths: Vec<_> = capture.counted(rows.nrows())?.into_iter().map(Some).collect();
    let mut scene = Scene::empty(&capture.chosen.unwrap_or(capture.root).display().to_string(), options);
    let stated: Vec<_> =
        rows.rows().into_iter().map(|row| Some([row[9], row[4]].map(|side| side as usize))).collect();
    let photos = pictures::read(&file, &paths, &stated, scene.background)?;
    let (mut near, mut far, mut frames) = (f64::INFINITY, 0f64, vec![]);
    for (n, (row, photo)) in rows.axis_iter(Axis(0)).zip(photos.into_iter().flatten()).enumerate() {
        let name = paths[n].as_deref().and_then(Path::file_name).unwrap_or_default();
        let name = name.to_string_lossy().into_owned();
        let bounds = bounds(&file, &name, row)?;
        (near, far) = (near.min(bounds[0]), far.max(bounds[1]));
        let camera = camera(&file, &name, row, &photo)?;
        frames.push(Frame { name, camera, image: Some(photo) });
    }
    scene.hold_out(frames, options);
    check::frames(&file, &scene.train, &scene.val)?;
    settle(&mut scene, &file, Backdrop::Between { near, far }, options)?;
    Ok(scene)
}

/// (F, 17).
fn rows(path: &Path, file: &str) -> Result<Array2<f64>> {
    let array = npz::read_npy(path)?.to_f64();
    let found = format!("shape {:?}", array.shape());
    let shape =
        array.into_dimensionality::<Ix2>().ok().filter(|rows| rows.ncols() == ROW && rows.nrows() > 0);
    shape.ok_or_else(|| wrong(file, "array".into(), found, "shape [frames, 17]"))
}

/// Depths along the camera's axis between which everything lies.
fn bounds(file: &str, name: &str, row: ArrayView1<f64>) -> Result<[f64; 2]> {
    let [near, far] = [row[15], row[16]];
    if near > 0.0 && near < far && far <= LENGTH {
        return Ok([near, far]);
    }
    Err(wrong(file, format!("bounds of {name}"), format!("{near} to {far}"), "0 < near < far, at most 1e9"))
}

/// The axes are down, right, backward; the size is that of the photographs as they were taken.
fn camera(file: &str, name: &str, row: ArrayView1<f64>, photo: &Photo) -> Result<Camera> {
    let at = |i: usize, j: usize| row[5 * i + j];
    let mut matrix = Array2::eye(4);
    for i in 0..3 {
        let axes = Array1::from(vec![at(i, 1), -at(i, 0), at(i, 2), at(i, 3)]);
        matrix.slice_mut(s![i, ..]).assign(&axes);
    }
    let opengl: DMat4 = check::pose(file, &format!("pose of {name}"), matrix.view())?;
    let [h, w, focal] = [at(0, 4), at(1, 4), at(2, 4)];
    if ![h, w].iter().all(|side| (1.0..=SIDE as f64).contains(side)) {
        return Err(wrong(file, format!("size of {name}"), format!("{w}x{h}"), "height and width in pixels"));
    }
    check::focal(file, &format!("focal length of {name}"), focal)?;
    let (height, width) = photo.size();
    if (width as f64 * h - height as f64 * w).abs() > w + h {
        let (field, found) = (format!("size of {name}"), format!("{width}x{height}"));
        return Err(wrong(file, field, found, &format!("the shape of {w}x{h}")));
    }
    let (sx, sy) = (width as f64 / w, height as f64 / h);
    let k = Intrinsics { fx: focal * sx, fy: focal * sy, cx: width as f64 / 2.0, cy: height as f64 / 2.0 };
    Ok(Camera { width, height, k, c2w: check::opengl_to_opencv(opengl), distortion: None })
}

fn wrong(file: &str, field: String, found: String, expected: &str) -> Error {
    let remedy = "Write it again with LLFF's imgs2poses, for the pictures that lie beside it.";
    Error::input(Input { file, field, found, expected, remedy })
}
