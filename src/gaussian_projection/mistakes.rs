//! The projection, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{form, forward, view, vjp};
use super::{Form, Splat, View, backward, clamped, in_camera, project, quadratic};
use crate::contract::arrays::{Arrays, threes};
use crate::convention::{Conventions, SplatCenter, SplatClamp};

mod catalogue;
mod choices;
pub(crate) mod gradient_laws;
mod gradients;
pub(crate) mod laws;
mod numbers;
mod views;

pub(crate) use catalogue::GAUSSIAN_PROJECTION;
use gradients::hand_written;
use numbers::{
    COMPENSATION_HELD, COVARIANCE_SCALED, DETERMINANT_HELD, OTHER_DILATION, OTHER_LIMIT, OTHER_SIGMAS,
    RADIUS_HELD,
};

/// What is multiplied from the left with Sigma, in rows, and t as the Jacobian has it.
fn wrong_transform(t: [f64; 3], view: &View, form: Form, wrong: &[&str]) -> [[f64; 3]; 2] {
    let has = |name: &str| wrong.contains(&name);
    let focal = match () {
        () if has("jacobian_without_focal") => [1.0, 1.0],
        () if has("one_focal") => [view.k.fx, view.k.fx],
        () if has("jacobian_to_clip_space") => [2.0 * view.k.fx / view.width, 2.0 * view.k.fy / view.height],
        () => [view.k.fx, view.k.fy],
    };
    let mut slopes = clamped(t, view, form);
    let half = [view.width / view.k.fx, view.height / view.k.fy].map(|whole| 0.5 * whole);
    let limits = match OTHER_LIMIT.among(wrong) {
        Some(k) => Some(half.map(|half| k * half)),
        None => has("angle_for_tangent").then(|| half.map(|half| 1.3 * 2.0 * libm::atan(half))),
    };
    if let Some(limits) = limits {
        slopes = [0, 1].map(|n| ((t[n] / t[2]).max(-limits[n]).min(limits[n]), false));
    }
    if has("y_not_clamped") {
        slopes[1] = (t[1] / t[2], false);
    }
    if has("limits_of_x_for_both") && form.clamp != SplatClamp::None {
        let [least, most] = super::limits(view.k.fx, view.k.cx, view.width, form.clamp);
        slopes[1] = ((t[1] / t[2]).max(least).min(most), false);
    }
    if has("slopes_exchanged") {
        slopes.swap(0, 1);
    }
    if has("translation_in_jacobian") {
        slopes = [0, 1].map(|n| (view.translation[n] / t[2], false));
    }
    let r = |i: usize, k: usize| match () {
        () if has("not_turned") => f64::from(u8::from(i == k)),
        () if has("turned_back") => view.rotation[k][i],
        () => view.rotation[i][k],
    };
    let row = |n: usize| {
        let far = if has("distance_in_jacobian") { distance(t) } else { t[2] };
        let scale = focal[n] / far;
        let along = match () {
            () if has("jacobian_without_depth") => 0.0,
            () if has("distance_in_jacobian") => scale * slopes[n].0 * t[2] / far,
            () if has("jacobian_signs") => -scale * slopes[n].0,
            () if has("jacobian_not_squared") => focal[n] * slopes[n].0,
            () if has("clamped_without_depth") => scale * slopes[n].0 / t[2],
            () => scale * slopes[n].0,
        };
        [0, 1, 2].map(|k| scale * r(n, k) - along * r(2, k))
    };
    [row(0), row(1)]
}

/// Of a product of variances, what may be left of the determinant of a line.
const FLAT: f64 = 1e-5;

/// How far away a mean is.
fn distance(t: [f64; 3]) -> f64 {
    (t[0] * t[0] + t[1] * t[1] + t[2] * t[2]).sqrt()
}

/// A splat with what is wrong about it; `middle` is the mean of all depths.
fn wrong_splat(
    mean: [f64; 3],
    sigma: [f64; 6],
    view: &View,
    middle: f64,
    form: Form,
    wrong: &[&str],
) -> Splat {
    let has = |name: &str| wrong.contains(&name);
    let r = view.rotation;
    let turned = [0, 1, 2].map(|i| [0, 1, 2].map(|k| r[k][i]));
    let view = &if has("rotation_transposed") { View { rotation: turned, ..*view } } else { *view };
    let back = |i: usize| -(0..3).map(|k| view.rotation[k][i] * view.translation[k]).sum::<f64>();
    let inverse = View {
        rotation: [0, 1, 2].map(|i| [0, 1, 2].map(|k| view.rotation[k][i])),
        translation: [0, 1, 2].map(back),
        ..*view
    };
    let view = if has("pose_inverted") { &inverse } else { view };
    let view = &if has("not_moved") { View { translation: [0.0; 3], ..*view } } else { *view };
    let [xx, xy, xz, yy, yz, zz] = sigma;
    let sigma = if has("covariance_by_columns") { [xx, xy, yy, xz, yz, zz] } else { sigma };
    let sigma = if has("covariance_in_another_order") { [xx, yy, yz, xy, zz, xz] } else { sigma };
    let sigma = sigma.map(|x| x * COVARIANCE_SCALED.among(wrong).unwrap_or(1.0));
    let (t, right) = (in_camera(mean, view), project(mean, sigma, view, form));
    let in_jacobian = if has("one_depth_for_all") { [t[0], t[1], middle] } else { t };
    let [p, q] = wrong_transform(in_jacobian, view, form, wrong);
    let mut before = [quadratic(p, sigma, p), quadratic(p, sigma, q), quadratic(q, sigma, q)];
    // J's rows are f_x / t_z (1, 0, -x) and f_y / t_z (0, 1, -y): -y goes with V_xz, -x with V_yz.
    if has("mixed_terms_exchanged") {
        let (v, slopes) = (in_axes(sigma, view), clamped(t, view, form));
        let scale = view.k.fx * view.k.fy / (t[2] * t[2]);
        before[1] += scale * (slopes[1].0 - slopes[0].0) * (v[2] - v[4]);
    }
    let own = OTHER_DILATION.among(wrong).unwrap_or(form.dilation.value());
    let h = if has("not_dilated") { 0.0 } else { own };
    let below = if has("dilated_across_alone") { 0.0 } else { h };
    let [a, b, c] =
        [before[0] + h, before[1] + if has("every_entry_dilated") { h } else { 0.0 }, before[2] + below];
    let held = |x: f64| x.max(form.dilation.value());
    let [a, b, c] =
        if has("held_up_by_the_dilation") { [held(before[0]), b, held(before[2])] } else { [a, b, c] };
    let det = a * c - b * b;
    let least = form.compensation.determinant();
    let ratio = ((before[0] * before[2] - before[1] * before[1]).max(least) / det.max(least)).max(0.0);
    let apart = (0.25 * (a - c) * (a - c) + b * b).max(form.radius.value()).sqrt();
    let lambda = 0.5 * (a + c) + if has("radius_of_the_short_axis") { -apart } else { apart };
    let mut deviation = match () {
        () if has("radius_of_variance") => lambda,
        () if has("radius_of_the_trace") => (a + c).sqrt(),
        () if has("radius_along_axes") => a.max(c).sqrt(),
        () => lambda.max(0.0).sqrt(),
    };
    if has("radius_not_dilated") {
        let [a, b, c] = before;
        deviation = (0.5 * (a + c) + (0.25 * (a - c) * (a - c) + b * b).max(form.radius.value()).sqrt())
            .max(0.0)
            .sqrt();
    }
    let [p, q, s] = if has("conic_not_dilated") { before } else { [a, b, c] };
    let under = (p * s - q * q).max(DETERMINANT_HELD.among(wrong).unwrap_or(f64::NEG_INFINITY));
    let slopes = clamped(t, view, form);
    let shift = if form.center == SplatCenter::Integer { 0.5 } else { 0.0 };
    let place = |n: usize, f: f64, center: f64| f * slopes[n].0 + center - shift;
    Splat {
        mean: match right.mean {
            _ if has("mean_in_the_camera") => [t[0], t[1]],
            _ if has("mean_clamped_too") => [place(0, view.k.fx, view.k.cx), place(1, view.k.fy, view.k.cy)],
            [x, y] if has("mean_in_clip_space") => {
                [2.0 * (x + shift) / view.width - 1.0, 2.0 * (y + shift) / view.height - 1.0]
            }
            [x, y] if has("center_swapped") => [x - view.k.cx + view.k.cy, y - view.k.cy + view.k.cx],
            [x, _] if has("one_focal_in_the_mean") => [x, view.k.fx * t[1] / t[2] + view.k.cy - shift],
            [x, y] if has("picture_upside_down") => [x, 2.0 * (view.k.cy - shift) - y],
            [x, y] if has("middle_of_the_picture") => {
                [x - view.k.cx + 0.5 * view.width, y - view.k.cy + 0.5 * view.height]
            }
            mean => mean,
        },
        covariance: [a, b, c],
        conic: match () {
            () if has("conic_sign") => [c / det, b / det, a / det],
            () if has("conic_not_divided") => [c, -b, a],
            () if has("determinant_with_plus") => [c, -b, a].map(|x| x / (a * c + b * b)),
            () if has("conic_not_swapped") => [a / det, -b / det, c / det],
            // What f32 makes of a determinant of 0 is anybody's guess.
            () if has("not_dilated") && under <= FLAT * p * s => [f64::NAN; 3],
            () => [s / under, -q / under, p / under],
        },
        depth: if has("distance_for_depth") { distance(t) } else { right.depth },
        radius: wrong_radius(deviation, wrong),
        compensation: match () {
            () if has("compensation_squared") => ratio,
            () if has("compensation_inverted") => ratio.sqrt().recip(),
            () if has("compensation_of_flat_ones") && ratio == 0.0 => 1.0,
            () => ratio.sqrt().max(COMPENSATION_HELD.among(wrong).unwrap_or(0.0)),
        }
        .max(form.compensation.value()),
    }
}

/// The radius of a deviation along the long axis.
fn wrong_radius(deviation: f64, wrong: &[&str]) -> f64 {
    let has = |name: &str| wrong.contains(&name);
    let radius = OTHER_SIGMAS.among(wrong).unwrap_or(3.0) * deviation;
    let radius = match () {
        () if has("radius_of_a_rounded_deviation") => 3.0 * deviation.ceil(),
        () if has("radius_not_rounded") => radius,
        () if has("radius_rounded_down") => radius.floor(),
        () if has("radius_rounded") => radius.round(),
        () => radius.ceil(),
    };
    radius.min(RADIUS_HELD.among(wrong).unwrap_or(f64::INFINITY))
}

/// Projections.
pub(crate) fn projection(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (view, form) = (view(a), form(c));
    let depths: Vec<f64> = threes(a, "means").into_iter().map(|mean| in_camera(mean, &view)[2]).collect();
    let middle = depths.iter().sum::<f64>() / depths.len() as f64;
    forward(a, c, |mean, sigma| match wrong {
        [] => project(mean, sigma, &view, form),
        wrong => wrong_splat(mean, sigma, &view, middle, form, wrong),
    })
}

/// R Sigma R^T.
fn in_axes(sigma: [f64; 6], view: &View) -> [f64; 6] {
    let r = view.rotation;
    [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| quadratic(r[i], sigma, r[j]))
}

/// Their gradients.
pub(crate) fn projection_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (view, form) = (view(a), form(c));
    vjp(a, c, |mean, sigma, g| match wrong {
        [] => backward::project(mean, sigma, &view, form, g),
        wrong => hand_written(mean, sigma, &view, form, g, wrong),
    })
}
