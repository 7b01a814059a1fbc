//! Rays, wrong on purpose. Every function takes the names of its mistakes; without any it equals the oracle.
//!
//! In `image_rays` a grid of uv without the half pixel, and rays that agree with it, are the convention `pixel_center`; the mistake
//! `no_half_pixel` reports the center (or reports no uv) and shoots through the corner. Directions that are not normalized are the
//! convention `directions`; a norm that is taken over the wrong axis is a mistake.

mod catalogue;
pub(crate) mod laws;
mod pictures;

use glam::{DMat3, DMat4, DVec2, DVec3};
use ndarray::Axis;

use catalogue::{EPS_IN_NORM, SCALED_AND_MOVED};
pub(crate) use catalogue::{IMAGE_RAYS, PIXEL_TO_RAY};

use super::arrays::{self, bundle, picture, positions};
use super::{Ray, camera_direction, pixel_position};
use crate::camera::arrays::{intrinsics, pose};
use crate::camera::mistakes::{flip, inverse, with_transposed_rotation, wrong_point};
use crate::camera::{Intrinsics, rotate};
use crate::contract::arrays::{Arrays, array, twos, values};
use crate::convention::{Axes, Conventions, Directions};

/// One ray as the mistakes have it, not yet divided by its norm.
fn wrong_ray(k: &Intrinsics, c2w: &DMat4, uv: DVec2, c: &Conventions, wrong: &[&str]) -> Ray {
    let c2w = &if wrong.contains(&"inverse_pose") { inverse(c2w) } else { *c2w };
    let turned = if wrong.contains(&"rotation_transposed") { with_transposed_rotation(c2w) } else { *c2w };
    let camera = match c.axes {
        Axes::Opencv => wrong_point(k, uv, 1.0, wrong),
        Axes::Opengl if wrong.is_empty() => camera_direction(k, uv, c.axes),
        Axes::Opengl => wrong_point(k, uv, 1.0, wrong) * DVec3::new(1.0, -1.0, -1.0),
    };
    let camera =
        if wrong.contains(&"focal_length_deep") { camera * DVec3::new(k.fx, k.fy, k.fx) } else { camera };
    let camera = if wrong.contains(&"depth_left_out") { camera * DVec3::new(1.0, 1.0, 0.0) } else { camera };
    let camera = if c.directions == Directions::UnitInCamera { camera / camera.length() } else { camera };
    let o = c2w.w_axis.truncate();
    let mut ray = Ray { o, d: rotate(&turned, flip(camera, wrong)) };
    if let Some(k) = SCALED_AND_MOVED.among(wrong) {
        ray.o = k * ray.o + 0.5;
    }
    for name in wrong {
        match *name {
            "origin_minus_rt" => ray.o = -rotate(&with_transposed_rotation(c2w), ray.o),
            "origin_minus_turned" => ray.o = -rotate(c2w, ray.o),
            "origin_negated" => ray.o = -ray.o,
            "origin_on_the_plane" => ray.o += ray.d,
            "not_turned" => ray.d = flip(camera, wrong),
            "pose_ignored" => ray = Ray { o: DVec3::ZERO, d: flip(camera, wrong) },
            "not_turned_but_taken_off" => ray.d = flip(camera, wrong) - ray.o,
            "origin_normalized" => ray.o /= ray.o.length(),
            "origin_minus_inverse_rt" => ray.o = -(DMat3::from_mat4(*c2w).inverse() * ray.o),
            "translation_in_direction" if ray.o == o => ray.d += o,
            "translation_in_direction" => ray.d += o - ray.o,
            _ => {}
        }
    }
    ray
}

/// Directions divided by their norms, or by those of other rays.
fn normalize(rays: &mut [Ray], c: &Conventions, wrong: &[&str]) {
    if wrong.contains(&"divided_by_depth_in_the_world") {
        rays.iter_mut().for_each(|ray| ray.d /= ray.d.z);
        return;
    }
    if wrong.contains(&"each_coordinate_by_its_norm") {
        let squares = rays.iter().fold(DVec3::ZERO, |sum, ray| sum + ray.d * ray.d);
        let norms = DVec3::from(squares.to_array().map(f64::sqrt));
        rays.iter_mut().for_each(|ray| ray.d /= norms);
        return;
    }
    if c.directions != Directions::Unit || wrong.contains(&"focal_length_deep") {
        return;
    }
    let norms: Vec<f64> = rays.iter().map(|ray| ray.d.length()).collect();
    let mixed = wrong.contains(&"norm_without_axis") && rays.len() == 3;
    let all = norms.iter().map(|norm| norm * norm).sum::<f64>().sqrt();
    for (ray, &norm) in rays.iter_mut().zip(&norms) {
        let [x, y, z] = ray.d.abs().to_array();
        let norm = match () {
            () if wrong.contains(&"norm_of_all_rays") => all,
            () if wrong.contains(&"sum_for_norm") => x + y + z,
            () if wrong.contains(&"norm_of_two") => x.hypot(y),
            () if wrong.contains(&"largest_for_norm") => x.max(y).max(z),
            () => norm + EPS_IN_NORM.among(wrong).unwrap_or(0.0),
        };
        ray.d = if mixed { ray.d / DVec3::new(norms[0], norms[1], norms[2]) } else { ray.d / norm };
    }
}

/// Directions divided by the norm over their column, coordinate by coordinate.
fn normalize_columns(rays: &mut [Ray], columns: usize) {
    for column in 0..columns {
        let own = rays.iter().skip(column).step_by(columns);
        let squares = own.fold(DVec3::ZERO, |sum, ray| sum + ray.d * ray.d);
        let norms = DVec3::from(squares.to_array().map(f64::sqrt));
        rays.iter_mut().skip(column).step_by(columns).for_each(|ray| ray.d /= norms);
    }
}

/// Pixel to ray.
pub(crate) fn pixel_to_ray(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (k, c2w) = (intrinsics(&values(a, "K")), values(a, "c2w"));
    let own = |m: usize| if wrong.contains(&"first_pose_for_all") { 0 } else { m };
    let ray = |(m, uv): (usize, [f64; 2])| wrong_ray(&k, &pose(&c2w, own(m)), DVec2::from(uv), c, wrong);
    let mut rays: Vec<Ray> = twos(a, "uv").into_iter().enumerate().map(ray).collect();
    normalize(&mut rays, c, wrong);
    bundle(&rays, &[rays.len(), 3])
}

/// Its gradient.
pub(crate) fn pixel_to_ray_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if !wrong.contains(&"norm_detached") || c.directions != Directions::Unit {
        return arrays::pixel_to_ray_vjp(a, c);
    }
    // As undivided directions have it, each cotangent over its ray's length.
    let (k, c2w) = (intrinsics(&values(a, "K")), values(a, "c2w"));
    let mut a = a.clone();
    for (m, uv) in twos(&a, "uv").into_iter().enumerate() {
        let length = wrong_ray(&k, &pose(&c2w, m), DVec2::from(uv), c, &[]).d.length();
        let g = a.get_mut("grad_rays_d").expect("a cotangent");
        g.index_axis_mut(Axis(0), m).mapv_inplace(|g| g / length);
    }
    arrays::pixel_to_ray_vjp(&a, &Conventions { directions: Directions::Depth, ..*c })
}

/// The rays of a picture. A grid whose rows and columns are exchanged shows it in uv.
pub(crate) fn image_rays(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (height, width, mut k, c2w) = picture(a);
    if wrong.contains(&"one_angle_for_both_axes") {
        k.fy *= height as f64 / width as f64;
    }
    let shape = height as f64 / width as f64;
    // The field of view across.
    let angle = 2.0 * libm::atan(0.5 * width as f64 / k.fx);
    let of_angle = |angle: f64| 0.5 * width as f64 / libm::tan(0.5 * angle);
    match () {
        () if wrong.contains(&"right_angles") => {
            (k.fx, k.fy) = (0.5 * width as f64, 0.5 * height as f64);
            (k.cx, k.cy) = (k.fx, k.fy);
        }
        () if wrong.contains(&"focal_floored") => (k.fx, k.fy) = (libm::floor(k.fx), libm::floor(k.fy)),
        () if wrong.contains(&"focal_of_half_the_width") => {
            (k.fx, k.fy) = (0.5 * width as f64, 0.5 * width as f64)
        }
        () if wrong.contains(&"focal_rounded") => (k.fx, k.fy) = (libm::rint(k.fx), libm::rint(k.fy)),
        () if wrong.contains(&"center_halved") => (k.cx, k.cy) = (0.5 * k.cx, 0.5 * k.cy),
        () if wrong.contains(&"half_angle_forgotten") => {
            (k.fx, k.fy) = (of_angle(2.0 * angle), of_angle(2.0 * angle))
        }
        () if wrong.contains(&"angle_in_whole_degrees") => {
            let focal = of_angle(libm::rint(angle.to_degrees()).to_radians());
            (k.fx, k.fy) = (focal, focal);
        }
        () if wrong.contains(&"focal_by_the_height") => (k.fx, k.fy) = (shape * k.fx, shape * k.fy),
        () if wrong.contains(&"width_stretched") => k.fx *= shape,
        () if wrong.contains(&"width_squeezed") => k.fx /= shape,
        () => {}
    }
    let mut uv = positions(a, c);
    let (mut rows, mut columns) = (height, width);
    if wrong.contains(&"grid_size_swapped") {
        uv = (0..height * width).map(|n| pixel_position(n % height, n / height, c.pixel_center)).collect();
    }
    for (n, uv) in uv.iter_mut().enumerate() {
        let (column, row) = ((n % width) as f64, (n / width) as f64);
        if wrong.contains(&"pixels_to_the_edges") && width > 1 && height > 1 {
            let steps = DVec2::new(width as f64 / (width - 1) as f64, height as f64 / (height - 1) as f64);
            *uv = DVec2::new(column, row) * steps;
        }
        if wrong.contains(&"pixels_in_the_unit_square") {
            *uv /= DVec2::new(width as f64, height as f64);
        }
        if wrong.contains(&"rows_as_far_as_columns") && height > 1 {
            uv.y += row * ((width as f64 - 1.0) / (height as f64 - 1.0) - 1.0);
        }
        if wrong.contains(&"half_pixel_across_alone") {
            *uv = DVec2::new(column + 0.5, row);
        }
        if wrong.contains(&"half_pixel_upward") {
            *uv = DVec2::new(column + 0.5, row - 0.5);
        }
    }
    if wrong.contains(&"center_of_picture") {
        (k.cx, k.cy) = (0.5 * width as f64, 0.5 * height as f64);
    }
    if wrong.contains(&"center_of_last_pixel") {
        (k.cx, k.cy) = (0.5 * (width as f64 - 1.0), 0.5 * (height as f64 - 1.0));
    }
    if wrong.contains(&"picture_refolded") {
        uv = (0..height * width).map(|n| uv[n % height * width + n / height]).collect();
    }
    if wrong.contains(&"picture_transposed") {
        uv = (0..height * width).map(|n| uv[n % height * width + n / height]).collect();
        (rows, columns) = (width, height);
    }
    let mut rays: Vec<Ray> = uv.iter().map(|&uv| wrong_ray(&k, &c2w, uv, c, wrong)).collect();
    match wrong.contains(&"norm_down_the_columns") {
        true => normalize_columns(&mut rays, columns),
        false => normalize(&mut rays, c, wrong),
    }
    // Their uv are those of the right order.
    let at = |n: usize| match () {
        () if wrong.contains(&"picture_upside_down") => (height - 1 - n / width) * width + n % width,
        () if wrong.contains(&"picture_mirrored") => n / width * width + width - 1 - n % width,
        () if wrong.contains(&"rows_of_another_width") => n % width * height + n / width,
        () => n,
    };
    let rays: Vec<Ray> = (0..rays.len()).map(|n| rays[at(n)]).collect();
    let mut out = bundle(&rays, &[rows, columns, 3]);
    let swapped = wrong.contains(&"row_column_swapped");
    let said = uv.iter().flat_map(|uv| if swapped { [uv.y, uv.x] } else { uv.to_array() });
    out.insert("uv".into(), array(&[rows, columns, 2], said.collect()));
    out
}
