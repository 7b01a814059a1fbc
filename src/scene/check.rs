//! What every scene must satisfy, whichever file it came from.

use glam::{DMat4, DVec2, DVec4};
use ndarray::{Array2, ArrayView2};

use super::{Frame, Options};
use crate::camera::{Camera, Lens};
use crate::error::{Error, Input, Result};
use crate::limits::LENGTH;
use crate::ray::camera_ray;

/// How far R R^T may be from the identity: three decimals, which is what hand-written poses have.
const RIGID: f64 = 1e-3;

/// Arguments that make no sense for any scene.
pub(super) fn options(options: &Options) -> Result<()> {
    for (argument, value) in [("near", options.near), ("far", options.far)] {
        if let Some(value) = value.filter(|value| !(0.0..=LENGTH).contains(value)) {
            return Err(Error::usage(argument, value, format!("a distance from 0 to {LENGTH}")));
        }
    }
    if let (Some(near), Some(far)) = (options.near, options.far)
        && near >= far
    {
        return Err(Error::usage("near", near, format!("less than far, which is {far}")));
    }
    if let Some(n) = options.holdout.filter(|n| *n < 2) {
        return Err(Error::usage("holdout", n, "2 or more, so that something is left to learn from"));
    }
    Ok(())
}

/// A pose from a 4x4 matrix, (row, column): finite, rigid, last row (0, 0, 0, 1).
pub(super) fn pose(file: &str, field: &str, matrix: ArrayView2<f64>) -> Result<DMat4> {
    let bad = |found: String, expected: &str| {
        let remedy = "Write camera-to-world matrices without scale; undo any normalization of the rotation.";
        Err(Error::input(Input { file, field, found, expected, remedy }))
    };
    if matrix.dim() != (4, 4) {
        return bad(format!("shape {:?}", matrix.shape()), "shape [4, 4]");
    }
    if let Some(((i, j), x)) = matrix.indexed_iter().find(|(_, x)| !(-LENGTH..=LENGTH).contains(*x)) {
        return bad(format!("{x} in row {i}, column {j}"), "finite numbers, none beyond 1e9");
    }
    let row: [f64; 4] = std::array::from_fn(|j| matrix[[3, j]]);
    if (0..4).any(|j| (row[j] - [0.0, 0.0, 0.0, 1.0][j]).abs() > RIGID) {
        return bad(format!("last row {row:?}"), "[0, 0, 0, 1]");
    }
    let column = |j| DVec4::from_array(std::array::from_fn(|i| matrix[[i, j]]));
    let c2w = DMat4::from_cols(column(0), column(1), column(2), column(3));
    let rotation = glam::DMat3::from_mat4(c2w);
    let off = (rotation * rotation.transpose() - glam::DMat3::IDENTITY).to_cols_array();
    let off = off.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    if off > RIGID {
        return bad(format!("a matrix with R R^T off the identity by {off:.3e}"), "a rotation");
    }
    if rotation.determinant() < 0.0 {
        return bad("a reflection (determinant -1)".into(), "a rotation (determinant 1)");
    }
    Ok(c2w)
}

/// OpenGL (Blender, tiny-NeRF) to OpenCV: the camera's y and z axes change sign; the camera stays where it is.
pub(super) fn opengl_to_opencv(c2w: DMat4) -> DMat4 {
    DMat4::from_cols(c2w.x_axis, -c2w.y_axis, -c2w.z_axis, c2w.w_axis)
}

/// A focal length: finite and positive.
pub(super) fn focal(file: &str, field: &str, value: f64) -> Result<f64> {
    if value > 0.0 && value <= LENGTH {
        return Ok(value);
    }
    let remedy = "Give the focal length in pixels.";
    Err(Error::input(Input { file, field, found: value, expected: "a positive number of pixels", remedy }))
}

/// At least one frame to learn from, and lenses that have rays.
pub(super) fn frames(file: &str, train: &[Frame], val: &[Frame]) -> Result<()> {
    if train.is_empty() {
        let remedy =
            "Add frames, or hold out fewer of them. A single photograph isn't enough where one is held out.";
        return Err(Error::input(Input {
            file,
            field: "frames",
            found: "no frame to learn from",
            expected: "at least one",
            remedy,
        }));
    }
    train.iter().chain(val).try_for_each(|frame| lens(file, frame))
}

/// A lens that has rays along the whole border of the picture: one that folds over does so from the border inward. A fisheye's circle may
/// end inside of it.
fn lens(file: &str, frame: &Frame) -> Result<()> {
    let Camera { width, height, distortion, .. } = frame.camera;
    if !matches!(distortion, Some(Lens::Opencv(_))) {
        return Ok(());
    }
    let sides = |side: usize| [0.5, 0.5 * side as f64, side as f64 - 0.5];
    for (u, v) in sides(width).into_iter().flat_map(|u| sides(height).map(|v| (u, v))) {
        let named = |error| match error {
            Error::Input(input) => {
                Error::Input(Input { file: file.into(), field: format!("lens of {}", frame.name), ..input })
            }
            other => other,
        };
        camera_ray(&frame.camera, DVec2::new(u, v)).map_err(named)?;
    }
    Ok(())
}

/// Three rows of a pose and the fourth, which is always the same; anything else as it is.
pub(super) fn whole(mut matrix: Array2<f64>) -> Array2<f64> {
    if matrix.dim() == (3, 4) {
        matrix.push_row(ndarray::aview1(&[0.0, 0.0, 0.0, 1.0])).expect("four columns");
    }
    matrix
}

/// A 4x4 array from JSON's nested rows, NaN where something isn't a number (so that [`pose`] names it).
pub(super) fn matrix(rows: &serde_json::Value) -> Option<Array2<f64>> {
    let rows = rows.as_array()?;
    let columns = rows.first()?.as_array()?.len();
    let mut flat = Vec::new();
    for row in rows {
        let row = row.as_array().filter(|row| row.len() == columns)?;
        flat.extend(row.iter().map(|x| x.as_f64().unwrap_or(f64::NAN)));
    }
    Array2::from_shape_vec((rows.len(), columns), flat).ok()
}
