//! Volume rendering, wrong on purpose. Every function takes the names of its mistakes; without any it equals the oracle.

use super::arrays::{self, renderings};
use super::{Rendering, volume_render as oracle, volume_render_alpha as oracle_alpha};
use crate::contract::arrays::{Arrays, input, row, rows3, size};
use crate::contract::case::Draw;
use crate::convention::{Conventions, ProductEps};
use crate::math::exp;

mod background;
mod catalogue;
mod depth;
mod gradients;
mod laws;
mod lists;
mod steps;

pub(crate) use background::{COMPOSITE_BACKGROUND, composite_background, composite_background_vjp};
use catalogue::{
    DENSITY_CAPPED, DIVIDED, EPS_IN_PRODUCT, EPS_ON_ALPHA, GIVEN_UP, LAST_OPAQUE, OVER_RAYS,
    OVER_RAYS_INCLUSIVE, SCALED_EXPONENTIAL, WEIGHTS_CUT, WEIGHTS_NORMALIZED,
};
pub(crate) use depth::{DEPTH, depth, depth_vjp};
pub(crate) use gradients::{volume_render_alpha_vjp, volume_render_vjp};
use laws::{other_alphas, softmax};
pub(crate) use lists::{VOLUME_RENDER, VOLUME_RENDER_ALPHA};
use steps::wrong_deltas;

/// What is so many times larger leaves nothing of what it is added to and taken off again, in single precision.
const NOTHING_LEFT: f64 = 3e7;

/// The error of the textbook form 1 - exp(-x), as a further input (R,N): the diagnosis propagates it through wrong code.
pub(crate) const ALPHA_ERROR: &str = "alpha_error";

/// The textbook's opacity is off by a rounding of 1 however small it is, which wrong code may magnify (C / A on a thin ray).
pub(crate) fn rounds_alpha(a: &mut Arrays, relative: f64, draw: &mut Draw) {
    let rounding = 0.25 * relative;
    let error = input(a, "sigmas").mapv(|_| if draw.below(2) == 0 { rounding } else { -rounding });
    a.insert(ALPHA_ERROR.into(), error);
}

/// Mistakes between opacities and outputs.
fn wrong_composite(
    mut rendering: Rendering,
    r: usize,
    alphas: &[f64],
    rgbs: &[[f64; 3]],
    wrong: &[&str],
) -> Rendering {
    let n = alphas.len();
    let mut t = rendering.transmittance.clone();
    for name in wrong {
        match *name {
            "inclusive_transmittance" => t.rotate_left(1),
            "inclusive_behind_the_first" => t[1..].rotate_left(1.min(n)),
            "nothing_hides" => t[..n].fill(1.0),
            "own_light_alone" => (0..n).for_each(|i| t[i] = 1.0 - alphas[i]),
            "neighbors_light_alone" => (1..n).for_each(|i| t[i] = 1.0 - alphas[i - 1]),
            "whole_rays_light" => t = vec![t[n]; n + 1],
            "rolled_transmittance" => t[0] = t[n],
            "rolled_backward" => {
                t = (0..=n).map(|i| t.get(i + 2).copied().unwrap_or(0.0)).collect();
                t[0] = 1.0;
                t[n] = rendering.transmittance[n];
            }
            "rolled_but_in_first_ray" if r > 0 => t[0] = t[n],
            "first_ray_unshaded" if r == 0 => t[..n].fill(1.0),
            "first_ray_unshaded" => t[0] = t[n],
            "first_transmittance_zero" => t[0] = 0.0,
            "opacity_in_front_as_transmittance" => t.iter_mut().for_each(|t| *t = 1.0 - *t),
            "transmittance_moved_twice" => {
                t.rotate_right(1);
                t[0] = 1.0;
            }
            "divided_by_own_factor" => {
                t = (0..n).map(|i| t[i + 1] / (1.0 - alphas[i])).chain([t[n]]).collect()
            }
            "opacity_as_transmittance" => t = (0..=n).map(|i| 1.0 - t[(i + 1).min(n)]).collect(),
            _ => {}
        }
    }
    if let Some(eps) = EPS_IN_PRODUCT.among(wrong) {
        (0..n).for_each(|i| t[i + 1] = t[i] * (1.0 - alphas[i] + eps));
        rendering.transmittance[n] = t[n];
    }
    let early = wrong.contains(&"transmittance_before_last").then(|| t[n.saturating_sub(1)]);
    let stopped = |alpha: f64| match () {
        _ if wrong.contains(&"alpha_forgotten") => 1.0,
        _ if wrong.contains(&"light_for_alpha") => 1.0 - alpha,
        _ => alpha,
    };
    if alphas.iter().any(|&alpha| stopped(alpha) != alpha) || t != rendering.transmittance {
        let behind = rendering.transmittance[n];
        rendering.weights = (0..n).map(|i| t[i] * stopped(alphas[i])).collect();
        composed(&mut rendering, rgbs);
        rendering.transmittance = t;
        rendering.transmittance[n] = behind;
    }
    if let Some(early) = early {
        rendering.transmittance[n] = early;
    }
    if wrong.contains(&"last_factor_once_more") {
        rendering.transmittance[n] *= 1.0 - alphas.last().unwrap_or(&0.0);
    }
    if let Some(most) = WEIGHTS_CUT.among(wrong) {
        rendering.weights.iter_mut().filter(|w| **w < most).for_each(|w| *w = 0.0);
        composed(&mut rendering, rgbs);
    }
    let spent = |left: f64| (0..n).find(|&i| rendering.transmittance[i] < left);
    if let Some(end) = GIVEN_UP.among(wrong).and_then(spent) {
        let behind = rendering.transmittance[end];
        rendering.transmittance[end..].fill(behind);
        rendering.weights[end..].fill(0.0);
        composed(&mut rendering, rgbs);
    }
    match () {
        () if wrong.contains(&"opacity_of_the_densest") => {
            rendering.opacity = alphas.iter().copied().fold(0.0, f64::max)
        }
        () if wrong.contains(&"alphas_summed") => rendering.opacity = alphas.iter().sum(),
        () if wrong.contains(&"opacity_of_the_heaviest") => {
            rendering.opacity = rendering.weights.iter().copied().fold(0.0, f64::max)
        }
        () => {}
    }
    if let Some(eps) = WEIGHTS_NORMALIZED.among(wrong) {
        let whole = rendering.opacity + eps;
        divide(&mut rendering, whole);
    }
    if wrong.contains(&"weights_of_unit_length") {
        let length = rendering.weights.iter().map(|w| w * w).sum::<f64>().sqrt();
        divide(&mut rendering, length);
    }
    if wrong.contains(&"colors_of_next_sample") {
        let next = |k: usize| rendering.weights.iter().zip(&rgbs[n.min(1)..]).map(|(w, c)| w * c[k]).sum();
        rendering.color = std::array::from_fn(next);
    }
    if let Some(eps) = DIVIDED.among(wrong) {
        rendering.color = rendering.color.map(|c| c / (rendering.opacity + eps));
    }
    if wrong.contains(&"clamped") {
        rendering.color = rendering.color.map(|c| c.clamp(0.0, 1.0));
    }
    rendering
}

/// Color and opacity of the weights.
fn composed(rendering: &mut Rendering, rgbs: &[[f64; 3]]) {
    let of = |k: usize| rendering.weights.iter().zip(rgbs).map(|(w, color)| w * color[k]).sum();
    rendering.color = std::array::from_fn(of);
    rendering.opacity = rendering.weights.iter().sum();
}

/// Smaller weights, and what is made of them.
fn divide(rendering: &mut Rendering, by: f64) {
    rendering.weights.iter_mut().for_each(|w| *w /= by);
    rendering.color = rendering.color.map(|c| c / by);
    rendering.opacity = rendering.weights.iter().sum();
}

/// Whether light is accumulated along the wrong axis.
fn along_rays(wrong: &[&str]) -> bool {
    [OVER_RAYS, OVER_RAYS_INCLUSIVE].iter().any(|m| wrong.contains(&m.name))
}

/// alpha_i and T_i of all rays, accumulated along the wrong axis where that is the mistake.
fn over_rays(alphas: &[Vec<f64>], rays: &mut [Rendering], wrong: &[&str]) {
    let own = wrong.contains(&OVER_RAYS_INCLUSIVE.name);
    for i in 0..alphas.first().filter(|_| along_rays(wrong)).map_or(0, Vec::len) {
        let mut t = 1.0;
        for (r, ray) in rays.iter_mut().enumerate() {
            let behind = t * (1.0 - alphas[r][i]);
            ray.transmittance[i] = if own { behind } else { t };
            t = behind;
        }
    }
}

/// Recomputes weights, color and opacity from T.
fn recompose(mut rendering: Rendering, alphas: &[f64], rgbs: &[[f64; 3]]) -> Rendering {
    rendering.weights = alphas.iter().zip(&rendering.transmittance).map(|(a, t)| a * t).collect();
    composed(&mut rendering, rgbs);
    rendering
}

fn render_all(
    alphas: Vec<Vec<f64>>,
    mut rays: Vec<Rendering>,
    rgbs: impl Fn(usize) -> Vec<[f64; 3]>,
    eps: ProductEps,
    wrong: &[&str],
) -> Vec<Rendering> {
    over_rays(&alphas, &mut rays, wrong);
    let finish = |(r, mut ray): (usize, Rendering)| {
        if wrong.contains(&"back_to_front") {
            let mut shown = 1.0;
            for (i, alpha) in alphas[r].iter().enumerate().rev() {
                ray.transmittance[i] = shown;
                shown *= 1.0 - alpha + eps.value();
            }
            ray = recompose(ray, &alphas[r], &rgbs(r));
        }
        if along_rays(wrong) {
            ray = recompose(ray, &alphas[r], &rgbs(r));
        }
        wrong_composite(ray, r, &alphas[r], &rgbs(r), wrong)
    };
    rays.into_iter().enumerate().map(finish).collect()
}

/// Rendering from densities.
pub(crate) fn volume_render(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (count, samples) = size(a, "sigmas");
    let (mut all, mut rays, mut carried) = (vec![], vec![], 1.0);
    for r in 0..count {
        let (mut sigmas, deltas) = (row(a, "sigmas", r), wrong_deltas(a, r, wrong));
        if wrong.contains(&"densities_averaged") {
            (1..samples).for_each(|i| sigmas[i - 1] = 0.5 * (sigmas[i - 1] + sigmas[i]));
        }
        for name in wrong {
            let softplus = |x: f64| x.max(0.0) + crate::math::ln(1.0 + exp(-x.abs()));
            match *name {
                "softplus_inside" => sigmas.iter_mut().for_each(|sigma| *sigma = softplus(*sigma)),
                "shifted_softplus_inside" => {
                    sigmas.iter_mut().for_each(|sigma| *sigma = softplus(*sigma - 1.0))
                }
                _ => {}
            }
        }
        if let Some(most) = DENSITY_CAPPED.among(wrong) {
            sigmas.iter_mut().for_each(|sigma| *sigma = sigma.min(most));
        }
        let mut alphas: Vec<f64> =
            super::optical_depths(&sigmas, &deltas).iter().map(|&x| -crate::math::expm1(-x)).collect();
        let mut ray = oracle(&sigmas, &rows3(a, "rgbs", r), &deltas, c.product_eps);
        let (eps, scale) = (EPS_ON_ALPHA.among(wrong), SCALED_EXPONENTIAL.among(wrong));
        let touched = eps.is_some() || scale.is_some();
        if touched {
            for (alpha, x) in alphas.iter_mut().zip(super::optical_depths(&sigmas, &deltas)) {
                let k = scale.unwrap_or(1.0);
                *alpha = 1.0 - k * exp(-x);
            }
        }
        let textbook = a.contains_key(ALPHA_ERROR);
        if textbook {
            // No digits are lost at x = 0: 1 - exp(-0) is 0.
            let errors = row(a, ALPHA_ERROR, r);
            alphas
                .iter_mut()
                .zip(errors)
                .filter(|(alpha, _)| **alpha != 0.0)
                .for_each(|(alpha, e)| *alpha = (*alpha + e).clamp(0.0, 1.0));
        }
        let other = other_alphas(&sigmas, &deltas, wrong);
        let touched = touched || other.is_some();
        alphas = other.unwrap_or(alphas);
        if touched || textbook {
            ray = oracle_alpha(&alphas, &rows3(a, "rgbs", r), c.product_eps);
        }
        if let Some(eps) = eps {
            alphas.iter_mut().for_each(|alpha| *alpha += eps);
            ray = oracle_alpha(&alphas, &rows3(a, "rgbs", r), ProductEps::TenToMinusTen);
        }
        if wrong.contains(&"delta_missing_in_alpha") {
            alphas = sigmas.iter().map(|sigma| -crate::math::expm1(-sigma)).collect();
            ray = recompose(ray, &alphas, &rows3(a, "rgbs", r));
        }
        if wrong.contains(&"delta_missing_in_transmittance") {
            let in_front = |i: usize| sigmas[..i].iter().sum::<f64>();
            ray.transmittance = (0..=samples).map(|i| exp(-in_front(i))).collect();
            ray = recompose(ray, &alphas, &rows3(a, "rgbs", r));
        }
        if wrong.contains(&"taken_off_the_sum") {
            let errors = if textbook { row(a, ALPHA_ERROR, r) } else { vec![0.0; samples] };
            let mut front = 0.0;
            for (i, x) in super::optical_depths(&sigmas, &deltas).into_iter().enumerate() {
                let nothing = if x.is_infinite() { f64::NAN } else { 0.0 };
                let left = if x > NOTHING_LEFT * front { nothing } else { front };
                front += x;
                ray.transmittance[i] = exp(-(left + errors[i] * front));
            }
            ray = recompose(ray, &alphas, &rows3(a, "rgbs", r));
        }
        if wrong.contains(&"product_over_the_batch") {
            let own = ray.transmittance[samples];
            ray.transmittance.iter_mut().for_each(|t| *t *= carried);
            carried = ray.transmittance[samples];
            ray = recompose(ray, &alphas, &rows3(a, "rgbs", r));
            ray.transmittance[samples] = own;
        }
        if wrong.contains(&"softmax_for_weights") {
            alphas = softmax(&super::optical_depths(&sigmas, &deltas));
            ray.transmittance.fill(1.0);
            ray = recompose(ray, &alphas, &rows3(a, "rgbs", r));
        }
        if wrong.contains(&"density_with_step_before") {
            let mut depth = 0.0;
            for i in 1..samples {
                depth += super::product(sigmas[i], deltas[i - 1]);
                ray.transmittance[i] = exp(-depth);
            }
            ray = recompose(ray, &alphas, &rows3(a, "rgbs", r));
        }
        if wrong.contains(&"exponent_without_minus") {
            alphas =
                super::optical_depths(&sigmas, &deltas).iter().map(|&x| -crate::math::expm1(x)).collect();
            ray = recompose(ray, &alphas, &rows3(a, "rgbs", r));
        }
        if wrong.contains(&"depth_for_transmittance") {
            let mut depth = 0.0;
            for (i, x) in super::optical_depths(&sigmas, &deltas).into_iter().enumerate() {
                ray.transmittance[i] = depth;
                depth += x;
            }
            ray = recompose(ray, &alphas, &rows3(a, "rgbs", r));
        }
        if wrong.contains(&"optical_depth_for_alpha") {
            alphas = super::optical_depths(&sigmas, &deltas);
            ray = recompose(ray, &alphas, &rows3(a, "rgbs", r));
        }
        if wrong.contains(&"density_for_opacity") {
            alphas = sigmas;
            ray = recompose(ray, &alphas, &rows3(a, "rgbs", r));
        }
        all.push(alphas);
        rays.push(ray);
    }
    arrays::over(
        c,
        renderings(samples, &render_all(all, rays, |r| rows3(a, "rgbs", r), c.product_eps, wrong)),
    )
}

/// Rendering from opacities.
pub(crate) fn volume_render_alpha(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let a = &arrays::counted(a, c);
    let (count, samples) = size(a, "alphas");
    let mut alphas: Vec<Vec<f64>> = (0..count).map(|r| row(a, "alphas", r)).collect();
    if wrong.contains(&LAST_OPAQUE.name) {
        alphas.iter_mut().filter_map(|ray| ray.last_mut()).for_each(|alpha| *alpha = 1.0);
    }
    if wrong.contains(&"alphas_as_densities") {
        alphas.iter_mut().flatten().for_each(|alpha| *alpha = -crate::math::expm1(-*alpha));
    }
    let one = |r: usize| {
        let (alphas, rgbs) = (&alphas[r], rows3(a, "rgbs", r));
        let mut ray = oracle_alpha(alphas, &rgbs, c.product_eps);
        let sums = || (0..=alphas.len()).map(|i| alphas[..i].iter().sum::<f64>());
        match () {
            () if wrong.contains(&"exponential_of_alphas") => {
                ray.transmittance = sums().map(|x| exp(-x)).collect()
            }
            () if wrong.contains(&"alphas_subtracted") => {
                ray.transmittance = sums().map(|x| (1.0 - x).max(0.0)).collect()
            }
            () => return ray,
        }
        recompose(ray, alphas, &rgbs)
    };
    let rays = (0..count).map(one).collect();
    arrays::over(
        c,
        renderings(samples, &render_all(alphas, rays, |r| rows3(a, "rgbs", r), c.product_eps, wrong)),
    )
}
