//! The camera, wrong on purpose. Every function takes the names of its mistakes; without any it equals the oracle.
//!
//! Two rows of the catalogue are not here because no case can show them: K read from the wrong array axes (cy = I / 2, with I the
//! number of images, which no row receives), and the sign pattern (+, -, -), which is the other value of the convention `axes`.

mod catalogue;

use glam::{DMat3, DMat4, DVec2, DVec3};

pub(crate) use catalogue::*;

use super::arrays::{self, intrinsics, pose};
use super::{Intrinsics, transform as oracle};
use crate::contract::arrays::{Arrays, array, arrays, threes, twos, values};
use crate::convention::Conventions;

/// Flips axes.
pub(crate) fn flip(x: DVec3, wrong: &[&str]) -> DVec3 {
    let Some(axes) = wrong.iter().find_map(|name| name.strip_prefix("flipped_")) else { return x };
    let sign = |axis: char| if axes.contains(axis) { -1.0 } else { 1.0 };
    DVec3::new(sign('x') * x.x, sign('y') * x.y, sign('z') * x.z)
}

/// K as the mistakes have it.
fn wrong_lens(mut k: Intrinsics, wrong: &[&str]) -> Intrinsics {
    for name in wrong {
        match *name {
            "center_swapped" => (k.cx, k.cy) = (k.cy, k.cx),
            "center_one_early" => (k.cx, k.cy) = (k.fy, k.cx),
            "center_floored" => (k.cx, k.cy) = (libm::floor(k.cx), libm::floor(k.cy)),
            "focal_ignored" => (k.fx, k.fy) = (1.0, 1.0),
            "pixels_as_they_are" => k = Intrinsics { fx: 1.0, fy: 1.0, cx: 0.0, cy: 0.0 },
            "one_focal_length" => k.fy = k.fx,
            "square_picture" => (k.fy, k.cy) = (k.fx, k.cx),
            "focals_swapped" => (k.fx, k.fy) = (k.fy, k.fx),
            "mean_focal_length" => (k.fx, k.fy) = (0.5 * (k.fx + k.fy), 0.5 * (k.fx + k.fy)),
            "intrinsics_not_rescaled" => {
                k = Intrinsics { fx: 2.0 * k.fx, fy: 2.0 * k.fy, cx: 2.0 * k.cx, cy: 2.0 * k.cy }
            }
            _ => {}
        }
    }
    if let Some(focal) = FOCAL_OF_ITS_OWN.among(wrong) {
        (k.fx, k.fy) = (focal, focal);
    }
    let scale = FOCAL_SCALED.among(wrong).unwrap_or(1.0);
    Intrinsics { fx: scale * k.fx, fy: scale * k.fy, ..k }
}

/// The pixel as the mistakes have it.
fn wrong_pixel(mut uv: DVec2, k: &Intrinsics, wrong: &[&str]) -> DVec2 {
    for name in wrong {
        match *name {
            "no_half_pixel" => uv -= 0.5,
            "half_pixel_twice" => uv += 0.5,
            "minus_half_pixel" => uv -= 1.0,
            "row_column_swapped" => uv = DVec2::new(uv.y, uv.x),
            "whole_pixels" => uv = uv.floor() + 0.5,
            "flipped_by_whole_pixels" => uv.y = 2.0 * k.cy - 1.0 - uv.y,
            _ => {}
        }
    }
    uv
}

/// The point at depth s behind a pixel, as the mistakes have it; the axes are left alone.
pub(crate) fn wrong_point(k: &Intrinsics, uv: DVec2, s: f64, wrong: &[&str]) -> DVec3 {
    let (k, uv) = (wrong_lens(*k, wrong), wrong_pixel(uv, k, wrong));
    if wrong.contains(&"K_transposed") {
        let (x, y) = (uv.x / k.fx, uv.y / k.fy);
        return s * DVec3::new(x, y, 1.0 - k.cx * x - k.cy * y);
    }
    if wrong.contains(&"K_for_inverse") {
        return s * DVec3::new(k.fx * uv.x + k.cx, k.fy * uv.y + k.cy, 1.0);
    }
    let scaled = |x: f64, y: f64| s * DVec3::new(x, y, 1.0);
    match () {
        () if wrong.contains(&"focal_multiplied") => scaled((uv.x - k.cx) * k.fx, (uv.y - k.cy) * k.fy),
        () if wrong.contains(&"center_taken_off_undivided") => scaled(uv.x / k.fx - k.cx, uv.y / k.fy - k.cy),
        () if wrong.contains(&"depth_alone_in_z") => {
            DVec3::new((uv.x - k.cx) / k.fx, (uv.y - k.cy) / k.fy, s)
        }
        () if wrong.contains(&"depth_in_the_pixel") => {
            DVec3::new((uv.x - s * k.cx) / k.fx, (uv.y - s * k.cy) / k.fy, s)
        }
        () if wrong.contains(&"divided_by_its_depth") => {
            DVec3::new((uv.x - k.cx) / k.fx / s, (uv.y - k.cy) / k.fy / s, s)
        }
        () if wrong.contains(&"pixel_scaled_alone") => super::pixel_to_camera(&k, s * uv, 1.0),
        () if wrong.contains(&"distance_for_depth") => s * super::pixel_to_camera(&k, uv, 1.0).normalize(),
        () => super::pixel_to_camera(&k, uv, s),
    }
}

/// The pose with R^T in the place of R.
pub(crate) fn with_transposed_rotation(c2w: &DMat4) -> DMat4 {
    let mut transposed = DMat4 { w_axis: glam::DVec4::W, ..*c2w }.transpose();
    transposed.w_axis = c2w.w_axis;
    transposed
}

/// The inverse of a pose, whatever its last row is.
pub(crate) fn inverse(c2w: &DMat4) -> DMat4 {
    let r = DMat3::from_mat4(*c2w).inverse();
    let mut out = DMat4::from_mat3(r);
    out.w_axis = (-(r * c2w.w_axis.truncate())).extend(1.0);
    out
}

/// Camera space to world space.
pub(crate) fn transform(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (c2w, x_c) = (values(a, "c2w"), threes(a, "x_c"));
    let point = |m: usize| {
        let mut c2w = pose(&c2w, if wrong.contains(&"first_pose_for_all") { 0 } else { m });
        let o = c2w.w_axis.truncate();
        let mut x = DVec3::from(x_c[m]);
        for name in wrong {
            match *name {
                "rotation_transposed" => c2w = with_transposed_rotation(&c2w),
                "inverse_pose" => c2w = inverse(&c2w),
                "rotation_inverted" => c2w = DMat4 { w_axis: c2w.w_axis, ..inverse(&c2w) },
                "translation_missing" => c2w.w_axis = glam::DVec4::W,
                "moved_before_turned" => (x, c2w.w_axis) = (x + o, glam::DVec4::W),
                "taken_off_before_turned" => (x, c2w.w_axis) = (x - o, glam::DVec4::W),
                "place_of_an_inverse" => {
                    let back = DMat3::from_mat4(c2w).transpose();
                    c2w.w_axis = (-(back * o)).extend(1.0);
                }
                "inverted_by_transpose" => {
                    c2w = with_transposed_rotation(&c2w);
                    (x, c2w.w_axis) = (x - o, glam::DVec4::W);
                }
                _ => {}
            }
        }
        let x_w = oracle(&c2w, flip(x, wrong));
        if wrong.contains(&"divided_by_depth") { (x_w / x_w.z).to_array() } else { x_w.to_array() }
    };
    arrays([("x_w", array(&[x_c.len(), 3], (0..x_c.len()).flat_map(point).collect()))])
}

/// Its gradient: no mistakes of its own.
pub(crate) fn transform_vjp(a: &Arrays, c: &Conventions, _: &[&str]) -> Arrays {
    arrays::transform_vjp(a, c)
}

/// Pixel and depth to camera space.
pub(crate) fn pixel_to_camera(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (k, uv, s) = (intrinsics(&values(a, "K")), twos(a, "uv"), values(a, "s"));
    // Three depths fit three coordinates; one fits all of them, and is right.
    let across = wrong.contains(&"depths_along_coordinates") && s.len() == 3;
    let point = |m: usize| {
        let one = across || wrong.contains(&"depth_forgotten");
        let x = wrong_point(&k, DVec2::from(uv[m]), if one { 1.0 } else { s[m] }, wrong);
        flip(if across { x * DVec3::new(s[0], s[1], s[2]) } else { x }, wrong).to_array()
    };
    let mut all: Vec<f64> = (0..s.len()).flat_map(point).collect();
    if wrong.contains(&"coordinates_refolded") {
        let unscaled: Vec<f64> = all.iter().enumerate().map(|(n, x)| x / s[n / 3]).collect();
        let n = s.len();
        all = (0..3 * n).map(|at| unscaled[3 * (at % n) + at / n] * s[at / 3]).collect();
    }
    let points = arrays([("x_c", array(&[s.len(), 3], all))]);
    arrays::in_axes(points, "x_c", c)
}

/// Its gradient: no mistakes of its own.
pub(crate) fn pixel_to_camera_vjp(a: &Arrays, c: &Conventions, _: &[&str]) -> Arrays {
    arrays::pixel_to_camera_vjp(a, c)
}
