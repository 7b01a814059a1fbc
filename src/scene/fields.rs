//! The fields of `transforms*.json` as Blender, instant-ngp, nerfstudio and the exporters around them write them: what each may hold, of
//! the file and of a frame alike. What isn't read is checked too; what nobody knows, or what would change the picture if it were read, is
//! named once.

use std::f64::consts::PI;

use serde_json::{Map, Value};

use crate::error::Result;
use crate::files::json::Holds::{self, *};
use crate::limits::{LENGTH, SIDE};

/// Any number that JSON has.
const NUMBER: Holds = Number(f64::MIN, f64::MAX);
/// Pixels from a corner of the picture: the principal point of a crop may lie outside.
const PIXEL: Holds = Number(-1e6, 1e6);
/// A lens' coefficient; those of real lenses are below 10.
const LENS: Holds = Number(-1e6, 1e6);
const ANGLE: Holds = Above(0.0, PI);
const FOCAL: Holds = Above(0.0, LENGTH);

/// Fields that decide where a pixel's ray goes, and the box around the scene.
#[rustfmt::skip]
const READ: &[(&str, Holds)] = &[
    ("w", Round(1.0, SIDE as f64)), ("h", Round(1.0, SIDE as f64)), ("fl_x", FOCAL), ("fl_y", FOCAL), ("cx", PIXEL), ("cy", PIXEL),
    ("camera_angle_x", ANGLE), ("camera_angle_y", ANGLE), ("k1", LENS), ("k2", LENS), ("k3", LENS), ("k4", LENS), ("k5", LENS),
    ("k6", LENS), ("p1", LENS), ("p2", LENS), ("ftheta_p0", LENS), ("ftheta_p1", LENS), ("ftheta_p2", LENS), ("ftheta_p3", LENS),
    ("ftheta_p4", LENS), ("rolling_shutter", Or(&Numbers(3, -1e6, 1e6), &Numbers(4, -1e6, 1e6))), ("camera_model", Text),
    ("mask_path", Text), ("is_fisheye", Flag), ("is_equirectangular", Flag), ("is_latlong", Flag), ("equirectangular", Flag), ("latlong", Flag),
    ("aabb_scale", Above(0.0, LENGTH)), ("scale", Above(0.0, LENGTH)),
    ("offset", Or(&Number(-LENGTH, LENGTH), &Numbers(3, -LENGTH, LENGTH))),
];

/// Fields that are left alone on purpose: how others sample, sharpen, orient, store depth, or number their frames.
#[rustfmt::skip]
const LEFT: &[(&str, Holds)] = &[
    ("aabb", Rows(2, 3)), ("render_aabb", Rows(2, 3)), ("up", Numbers(3, -LENGTH, LENGTH)), ("from_na", Flag),
    ("sharpness", NUMBER), ("sharpness_discard_threshold", NUMBER), ("sharpen", NUMBER), ("n_extra_learnable_dims", NUMBER),
    ("importance_sampling", Flag), ("fix_premult", Flag), ("white_transparent", Flag), ("black_transparent", Flag),
    ("enable_depth_loading", Flag), ("enable_ray_loading", Flag), ("integer_depth_scale", NUMBER), ("depth_unit_scale_factor", NUMBER),
    ("depth_path", Text), ("depth_file_path", Text), ("ply_file_path", Text), ("normal_path", Text), ("driver_parameters", Anything),
    ("applied_transform", Rows(3, 4)), ("applied_scale", Above(0.0, LENGTH)), ("orientation_override", Text),
    ("auto_scale_poses_override", Flag), ("crop", Anything), ("colmap_im_id", Round(0.0, 9e15)), ("colmap_id", Round(0.0, 9e15)),
    ("camera_id", Round(0.0, 9e15)), ("camera_idx", Round(0.0, 9e15)), ("cam_idx", Round(0.0, 9e15)), ("frame_id", Anything),
    ("rotation", NUMBER), ("timestamp", NUMBER), ("blur_score", NUMBER), ("name", Text), ("info", Anything), ("path", Anything),
];

/// Fields that would change what is learned if they were read: they are checked, and named in the warning.
const MISSED: &[(&str, Holds)] = &[
    ("train_filenames", List(&Text)),
    ("val_filenames", List(&Text)),
    ("test_filenames", List(&Text)),
    ("n_frames", Round(0.0, 9e15)),
    ("x_fov", Above(0.0, 180.0)),
    ("y_fov", Above(0.0, 180.0)),
    ("envmap", Text),
    ("normal_mts_args", Anything),
    ("transform_matrix_start", Rows(3, 4)),
    ("transform_matrix_end", Rows(3, 4)),
    ("time", NUMBER),
];

/// Checks every field of an object, but for those in `own`; `of` is " of frame a.png", or nothing. Adds the names of those that aren't
/// used to `unused`, each once.
pub(super) fn check(
    file: &str,
    of: &str,
    object: &Map<String, Value>,
    own: &[&str],
    unused: &mut Vec<String>,
) -> Result<()> {
    let find = |table: &[(&str, Holds)], name: &str| table.iter().find(|row| row.0 == name).map(|row| row.1);
    for (name, value) in object.iter().filter(|(name, _)| !own.contains(&name.as_str())) {
        let known = find(READ, name).or(find(LEFT, name));
        if known.is_none() && !unused.contains(name) {
            unused.push(name.clone());
        }
        let remedy = "Correct it, or leave the field out.";
        let holds = known.or(find(MISSED, name)).unwrap_or(Anything);
        holds.check(file, &format!("{name}{of}"), value, remedy)?;
    }
    Ok(())
}

/// Names as a message lists them, at most a dozen.
pub(crate) fn listed(names: &[impl AsRef<str>]) -> String {
    const MOST: usize = 12;
    let shown: Vec<&str> = names.iter().take(MOST).map(AsRef::as_ref).collect();
    let more = names.len().saturating_sub(MOST);
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    shown.join(", ") + &rest
}
