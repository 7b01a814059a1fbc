//! Intrinsics and lens of a `transforms.json`: a frame's own value before the file's, and only lenses that are modeled.

use serde_json::Value;

use super::check;
use super::transforms::Transforms;
use crate::camera::{Distortion, Intrinsics, Lens};
use crate::error::{Error, Input, Result};

/// Names of camera models that OpenCV's distortion covers.
const MODELLED: [&str; 7] =
    ["OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL", "perspective", "FULL_OPENCV"];

/// Names of those that its fisheye does.
const FISHEYES: [&str; 3] = ["OPENCV_FISHEYE", "RADIAL_FISHEYE", "SIMPLE_RADIAL_FISHEYE"];

/// A number of a frame, or of the file; what is there was checked to be one.
fn number(transforms: &Transforms, frame: &Value, key: &str) -> Option<f64> {
    frame[key].as_f64().or_else(|| transforms.json[key].as_f64())
}

/// Width and height, where both are stated.
pub(super) fn stated_size(transforms: &Transforms, frame: &Value) -> Option<[usize; 2]> {
    let side = |key| number(transforms, frame, key).map(|side| side as usize);
    Some([side("w")?, side("h")?])
}

/// Width, height and K. `size` is the picture's, where there is one.
///
/// fx is `fl_x`, or from `camera_angle_x`: w / 2 / tan(angle / 2). fy is `fl_y`, or from `camera_angle_y` where fx came from an
/// angle too, or fx. The principal point is `cx`, `cy`, or the middle. All of it is scaled to a picture that is a smaller copy.
pub(super) fn intrinsics(
    transforms: &Transforms,
    name: &str,
    frame: &Value,
    size: Option<(usize, usize)>,
) -> Result<(usize, usize, Intrinsics)> {
    let file = transforms.file();
    let get = |key: &str| number(transforms, frame, key);
    // Whichever of the two is there.
    let declared = [get("w"), get("h")].map(|side| side.map(|side| side as usize));
    let declared = match (declared, size) {
        ([None, None], _) => None,
        ([w, h], Some((width, height))) => Some((w.unwrap_or(width), h.unwrap_or(height))),
        ([w, h], None) => w.zip(h),
    };
    // Smaller copies: their sides are rounded, each by less than a pixel.
    let copy = |(w, h): (usize, usize), (whole_w, whole_h): (usize, usize)| {
        w < whole_w && h < whole_h && (w * whole_h).abs_diff(h * whole_w) <= whole_w + whole_h
    };
    if let (Some(size), Some(declared)) = (size, declared)
        && size != declared
        && !copy(size, declared)
    {
        let remedy = "Resize the pictures, or scale w, h, fl_x, fl_y, cx and cy to them.";
        let (found, expected) = (format!("{}x{}", size.0, size.1), format!("{}x{}", declared.0, declared.1));
        return Err(Error::input(Input {
            file,
            field: format!("size of {name}"),
            found,
            expected: format!("{expected} (w, h), or a smaller copy of it"),
            remedy,
        }));
    }
    let (width, height) = declared.or(size).unwrap_or((0, 0));
    if width == 0 || height == 0 {
        let remedy = "Give w and h in pixels.";
        return Err(Error::input(Input {
            file,
            field: format!("w and h of {name}"),
            found: "no size",
            expected: "a picture's size",
            remedy,
        }));
    }
    let from_angle =
        |key: &str, side: usize| get(key).map(|angle| 0.5 * side as f64 / libm::tan(0.5 * angle));
    let (field, fx) = match get("fl_x") {
        Some(fx) => ("fl_x", Some(fx)),
        None => ("camera_angle_x", from_angle("camera_angle_x", width)),
    };
    let Some(fx) = fx else {
        let remedy = "Give fl_x in pixels or camera_angle_x in radians.";
        return Err(Error::input(Input {
            file,
            field: "fl_x",
            found: "neither fl_x nor camera_angle_x",
            expected: "a focal length",
            remedy,
        }));
    };
    let fx = check::focal(&file, field, fx)?;
    let fy = match (get("fl_y"), field) {
        (Some(fy), _) => check::focal(&file, "fl_y", fy)?,
        (None, "camera_angle_x") => match from_angle("camera_angle_y", height) {
            Some(fy) => check::focal(&file, "camera_angle_y", fy)?,
            None => fx,
        },
        (None, _) => fx,
    };
    let (cx, cy) = (get("cx").unwrap_or(width as f64 / 2.0), get("cy").unwrap_or(height as f64 / 2.0));
    // What the file says is of its own size; pictures may be smaller copies (nerfstudio's `images_4`).
    let own = size.unwrap_or((width, height));
    let (sx, sy) = (own.0 as f64 / width as f64, own.1 as f64 / height as f64);
    Ok((own.0, own.1, Intrinsics { fx: sx * fx, fy: sy * fy, cx: sx * cx, cy: sy * cy }))
}

/// The lens: a fisheye where the model or a flag says so; else OpenCV's distortion, where any coefficient isn't 0.
///
/// # Errors
/// Where the file names a camera that isn't modeled, or has coefficients that its model doesn't have, or may mean two things: leaving
/// them out would bend every ray.
pub(super) fn lens(transforms: &Transforms, name: &str, frame: &Value) -> Result<Option<Lens>> {
    let refuse = |field: &str, found: String| {
        let remedy =
            "Undistort the pictures beforehand (colmap image_undistorter) and give a pinhole camera.";
        let expected = "a pinhole camera with OpenCV's k1, k2, p1, p2, k3 (and k4, k5, k6 as FULL_OPENCV), or a fisheye with k1 to k4";
        Err(Error::input(Input {
            file: transforms.file(),
            field: format!("{field} of {name}"),
            found,
            expected,
            remedy,
        }))
    };
    let is = |source: &Value, flag: &str| source[flag].as_bool() == Some(true);
    for source in [frame, &transforms.json] {
        let known = |model: &&str| MODELLED.contains(model) || FISHEYES.contains(model);
        if let Some(model) = source["camera_model"].as_str().filter(|model| !known(model)) {
            return refuse("camera_model", model.into());
        }
        for flag in ["is_equirectangular", "is_latlong", "equirectangular", "latlong"] {
            if is(source, flag) {
                return refuse(flag, "true".into());
            }
        }
        for key in ["ftheta_p0", "ftheta_p1", "rolling_shutter"] {
            let used = source[key].as_f64().is_some_and(|x| x != 0.0)
                || source[key].as_array().is_some_and(|list| list.iter().any(|x| x.as_f64() != Some(0.0)));
            if used {
                return refuse(key, source[key].to_string());
            }
        }
    }
    let get = |key: &str| number(transforms, frame, key).unwrap_or(0.0);
    let beyond = |keys: &[&'static str]| keys.iter().copied().find(|key| get(key) != 0.0);
    let model = frame["camera_model"].as_str().or_else(|| transforms.json["camera_model"].as_str());
    let flagged = is(frame, "is_fisheye") || is(&transforms.json, "is_fisheye");
    if flagged || model.is_some_and(|model| FISHEYES.contains(&model)) {
        return match beyond(&["p1", "p2", "k5", "k6"]) {
            Some(key) => refuse(key, format!("{} with a fisheye", get(key))),
            None => Ok(Some(Lens::Fisheye(["k1", "k2", "k3", "k4"].map(get)))),
        };
    }
    // nerfstudio's k4 belongs to r^8, OpenCV's to r^2 of the denominator.
    let rational = model == Some("FULL_OPENCV") || beyond(&["k5", "k6"]).is_some();
    if let (false, Some(key)) = (rational, beyond(&["k4"])) {
        return refuse(key, format!("{}, which programs take for two things", get(key)));
    }
    let lens = Distortion::from_opencv(&["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"].map(get));
    Ok((lens != Distortion::default()).then_some(Lens::Opencv(lens)))
}
