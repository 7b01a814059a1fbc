//! Fisheyes, wrong on purpose. Without a mistake every function equals the oracle.

mod catalogue;
pub(crate) mod laws;

use glam::DVec2;

use catalogue::{EPS_IN_RADIUS, FEW_STEPS, FEW_STEPS_OF_DIFFERENCES, FEW_STEPS_OF_NEWTON};
pub(crate) use catalogue::{FISHEYE_DISTORT, FISHEYE_UNDISTORT};

use super::arrays::{coefficients, undistorted};
use super::{backward, bent, distort};
use crate::contract::arrays::Arrays;
use crate::convention::Conventions;
use crate::lens::Distortion;
use crate::lens::arrays::{Pair, forward, in_order, vjp};

/// theta_d with every power of theta, and its slope.
fn every_power(k: [f64; 4], theta: f64) -> (f64, f64) {
    let t = theta;
    let value = t * (1.0 + t * (k[0] + t * (k[1] + t * (k[2] + t * k[3]))));
    (value, 1.0 + t * (2.0 * k[0] + t * (3.0 * k[1] + t * (4.0 * k[2] + t * 5.0 * k[3]))))
}

/// The other model's lens of these coefficients.
fn opencv(k: [f64; 4]) -> Distortion {
    Distortion::from_opencv(&k)
}

/// The coefficients as they are read.
fn read(k: [f64; 4], wrong: &[&str]) -> [f64; 4] {
    if wrong.contains(&"last_two_dropped") { [k[0], k[1], 0.0, 0.0] } else { k }
}

/// Distorted points.
pub(crate) fn fisheye_distort(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let k = read(coefficients(a), wrong);
    let has = |name: &str| wrong.contains(&name);
    let eps = EPS_IN_RADIUS.among(wrong).unwrap_or(0.0);
    forward(a, "points", "distorted", |p| {
        let point = DVec2::from(p);
        let r = point.length();
        if r == 0.0 {
            let nothing = has("not_a_number_in_the_middle") || has("radius_not_rooted");
            return if nothing { [f64::NAN; 2] } else { p };
        }
        let theta = if has("radius_for_angle") { r } else { libm::atan(r) };
        match () {
            () if has("opencv_lens") => opencv(k).distort(point),
            () if has("undone_instead") => undistorted(k, p),
            () if has("every_power") => point * (every_power(k, theta).0 / r),
            () if has("not_divided_by_radius") => point * bent(k, theta),
            () if has("scaled_by_polynomial") => point * (bent(k, theta) / theta),
            () if has("polynomial_of_radius") => point * (theta * bent(k, r) / (r * r)),
            () if has("radius_not_rooted") => point * (bent(k, libm::atan(r * r)) / (r * r)),
            () if has("quadrant_lost") && p[0] < 0.0 => -distort(k, point),
            () if eps > 0.0 => point * (bent(k, theta) / (r + eps)),
            () if has("radius_for_angle") => point * (bent(k, theta) / r),
            () => distort(k, point),
        }
        .to_array()
    })
}

/// Their gradient.
pub(crate) fn fisheye_distort_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let k = coefficients(a);
    let f = |p: Pair, g: Pair| {
        let (point, g) = (DVec2::from(p), DVec2::from(g));
        let r = point.length();
        let (mut g_p, mut g_k) = backward::distort(k, point, g);
        let has = |name: &str| wrong.contains(&name);
        if has("opencv_lens") {
            let (on_p, on_k) = crate::lens::backward::distort(&opencv(k), point, g);
            (g_p, g_k) = (on_p, [on_k[0], on_k[1], on_k[2], on_k[3]]);
        }
        match () {
            () if has("radius_not_differentiated") && r > 0.0 => g_p = g * (bent(k, libm::atan(r)) / r),
            () if has("gradient_not_a_number_in_the_middle") && r == 0.0 => g_p = DVec2::NAN,
            () => {}
        }
        if has("lens_held_constant") {
            g_k = [0.0; 4];
        }
        (g_p.to_array(), g_k)
    };
    vjp(a, "points", "distorted", f, in_order)
}

/// The angle with theta_d = theta (1 + k1 theta + ...).
fn every_power_undone(k: [f64; 4], theta_d: f64) -> f64 {
    (0..30).fold(theta_d, |theta, _| {
        let (value, slope) = every_power(k, theta);
        theta - (value - theta_d) / slope
    })
}

/// So many steps from theta_d on; a part of the last one where the number isn't whole.
fn stepped(theta_d: f64, steps: f64, step: impl Fn(f64) -> f64) -> f64 {
    let (mut theta, mut left) = (theta_d, steps);
    while left > 0.0 {
        theta += left.min(1.0) * (step(theta) - theta);
        left -= 1.0;
    }
    theta
}

/// The angle after few steps.
fn nearly_undone(k: [f64; 4], theta_d: f64, wrong: &[&str]) -> Option<f64> {
    let fixed_point = |theta: f64| theta_d / if theta == 0.0 { 1.0 } else { bent(k, theta) / theta };
    let newton = |theta: f64| {
        let t2 = theta * theta;
        let slope = 1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])));
        theta - (bent(k, theta) - theta_d) / slope
    };
    // Along the ray of a point there are radii alone.
    let difference = |r: f64| r + theta_d - bent(k, libm::atan(r));
    let by_fixed_point = FEW_STEPS.among(wrong).map(|steps| stepped(theta_d, steps, fixed_point));
    let by_newton = || FEW_STEPS_OF_NEWTON.among(wrong).map(|steps| stepped(theta_d, steps, newton));
    let by_differences =
        || FEW_STEPS_OF_DIFFERENCES.among(wrong).map(|steps| libm::atan(stepped(theta_d, steps, difference)));
    by_fixed_point.or_else(by_newton).or_else(by_differences)
}

/// Ideal points.
pub(crate) fn fisheye_undistort(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let k = read(coefficients(a), wrong);
    let has = |name: &str| wrong.contains(&name);
    let eps = EPS_IN_RADIUS.among(wrong).unwrap_or(0.0);
    forward(a, "distorted", "points", |p| {
        let target = DVec2::from(p);
        let theta_d = target.length();
        if theta_d == 0.0 {
            return if has("not_a_number_in_the_middle") { [f64::NAN; 2] } else { p };
        }
        let right = undistorted(k, p);
        let nearly = nearly_undone(k, theta_d, wrong);
        match () {
            () if has("handed_back_without_coefficients") && k == [0.0; 4] => target,
            () if has("opencv_lens") => opencv(k).undistort(target).unwrap_or(DVec2::NAN),
            () if nearly.is_some() => target * (libm::tan(nearly.expect("asked")) / theta_d),
            () if has("angle_bent_again") => target * (libm::tan(bent(k, theta_d)) / theta_d),
            () if has("divided_by_angle") => target * (right.length() / libm::atan(right.length())),
            () if eps > 0.0 => target * (right.length() / (theta_d + eps)),
            () if has("angle_for_radius") => target * (libm::atan(right.length()) / theta_d),
            () if has("polynomial_not_inverted") => target * (libm::tan(theta_d) / theta_d),
            () if has("distorted_again") => distort(k, target),
            () if has("every_power") => target * (libm::tan(every_power_undone(k, theta_d)) / theta_d),
            () => right,
        }
        .to_array()
    })
}

/// Their gradient.
pub(crate) fn fisheye_undistort_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let k = coefficients(a);
    let f = |target: Pair, g: Pair| {
        let (mut h, mut g_k) = backward::undistort(k, undistorted(k, target), g.into());
        let has = |name: &str| wrong.contains(&name);
        match () {
            () if has("handed_through") => h = g.into(),
            () if has("gradient_not_a_number_in_the_middle") && target == [0.0; 2] => h = DVec2::NAN,
            () => {}
        }
        if has("lens_held_constant") {
            g_k = [0.0; 4];
        }
        (h.to_array(), g_k)
    };
    vjp(a, "distorted", "points", f, in_order)
}
