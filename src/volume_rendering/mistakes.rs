//! Volume rendering, wrong on purpose. Every function takes the names of its mistakes; without any it equals the oracle.

use super::arrays::{self, renderings};
use super::{Rendering, volume_render_alpha as oracle_alpha};
use crate::contract::arrays::{Arrays, row, rows3, size};
use crate::convention::{Conventions, ProductEps};
use crate::math::exp;

mod background;
mod catalogue;
mod densities;
mod depth;
pub(crate) mod depth_laws;
pub(crate) mod gradient_laws;
mod gradients;
mod hand_written;
mod lists;
mod march;
mod march_laws;
mod other_alphas;
mod steps;
pub(crate) mod weight_laws;

pub(crate) use background::{COMPOSITE_BACKGROUND, composite_background, composite_background_vjp};
pub(crate) use catalogue::OWN_STEP;
use catalogue::{
    COLORS_GIVEN_UP, DIVIDED, EPS_IN_PRODUCT, GIVEN_UP, OVER_RAYS, OVER_RAYS_INCLUSIVE, UNIT_WEIGHTS,
    WEIGHTS_CUT, WEIGHTS_NORMALIZED,
};
pub(crate) use densities::{ALPHA_ERROR, rounds_alpha, volume_render};
pub(crate) use depth::{DEPTH, depth, depth_vjp};
pub(crate) use gradients::{volume_render_alpha_vjp, volume_render_vjp};
pub(crate) use lists::{VOLUME_RENDER, VOLUME_RENDER_ALPHA};
use march::{
    ALPHAS_HELD, BEFORE_THE_SAMPLE, CAPPED_ELSEWHERE, FAINT_UNCOLORED, GIVEN_UP_IN_THE_DARK, MADE_OPAQUE,
    THIN_ALPHAS, TOGETHER, WEIGHTS_HELD,
};
pub(crate) use march::{THIN_SKIPPED, unless_thin};

/// The squares of shorter weights have few digits in f32, or none: what is divided by their root isn't known. (In f64 it is left open, too.)
const UNDERFLOWS: f64 = 1e-19;

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
    if let Some(least) = WEIGHTS_HELD.among(wrong) {
        // What is more of them is all that changes: others may have added up something else.
        for (w, rgb) in rendering.weights.iter_mut().zip(rgbs).filter(|(w, _)| **w < least) {
            rendering.color = [0, 1, 2].map(|k| rendering.color[k] + (least - *w) * rgb[k]);
            rendering.opacity += least - *w;
            *w = least;
        }
    }
    if wrong.contains(&"weights_multiplied") {
        let mut product = 1.0;
        for (w, alpha) in rendering.weights.iter_mut().zip(alphas) {
            product *= alpha * (1.0 - alpha);
            *w = product;
        }
        composed(&mut rendering, rgbs);
    }
    ended(&mut rendering, rgbs, wrong);
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
    if wrong.contains(&UNIT_WEIGHTS.name) {
        let length = rendering.weights.iter().map(|w| w * w).sum::<f64>().sqrt();
        divide(&mut rendering, if length < UNDERFLOWS { f64::NAN } else { length });
    }
    if wrong.contains(&"colors_of_next_sample") {
        let next = |k: usize| rendering.weights.iter().zip(&rgbs[n.min(1)..]).map(|(w, c)| w * c[k]).sum();
        rendering.color = std::array::from_fn(next);
    }
    if let Some(eps) = DIVIDED.among(wrong) {
        rendering.color = rendering.color.map(|c| c / (rendering.opacity + eps));
    }
    let whole: f64 = alphas.iter().sum();
    let alike = |k: usize| alphas.iter().zip(rgbs).map(|(alpha, color)| alpha * color[k]).sum::<f64>();
    match () {
        () if wrong.contains(&"opacity_blended_twice") => {
            rendering.opacity = alphas.iter().rev().fold(0.0, |a, alpha| alpha * alpha + (1.0 - alpha) * a)
        }
        () if wrong.contains(&"blended_in_any_order") => {
            let by = if whole == 0.0 { 0.0 } else { rendering.opacity / whole };
            rendering.color = std::array::from_fn(|k| by * alike(k));
        }
        () if wrong.contains(&"colors_of_alphas") => rendering.color = std::array::from_fn(alike),
        () => {}
    }
    if wrong.contains(&"white_before_last") {
        rendering.color = rendering.color.map(|c| c + rendering.transmittance[n.saturating_sub(1)]);
    }
    if wrong.contains(&"color_by_opacity") {
        rendering.color = rendering.color.map(|c| c * rendering.opacity);
    }
    if wrong.contains(&"colors_with_gamma") {
        rendering.color = rendering.color.map(|c| crate::math::pow(c.max(0.0), 1.0 / 2.2));
    }
    if wrong.contains(&"light_behind_the_last_alone") {
        rendering.transmittance[n] = 1.0 - alphas.iter().rev().find(|alpha| **alpha > 0.0).unwrap_or(&0.0);
    }
    if wrong.contains(&"weights_are_alphas") {
        rendering.weights = alphas.to_vec();
    }
    rendering
}

/// What ends a march, or leaves samples out of what it adds up.
fn ended(rendering: &mut Rendering, rgbs: &[[f64; 3]], wrong: &[&str]) {
    let (n, light) = (rendering.weights.len(), rendering.transmittance.clone());
    // The first sample in front of which, or behind which, less than that is left.
    let spent = |left: f64| (0..n).find(|&i| light[i] < left);
    let spends = |left: f64| (0..n).find(|&i| light[i + 1] < left);
    // A march from behind ends in front.
    if let Some(left) = GIVEN_UP.among(wrong).filter(|_| wrong.contains(&"back_to_front")) {
        let hidden = rendering.weights.iter_mut().zip(&light).filter(|(_, light)| **light < left);
        hidden.for_each(|(w, _)| *w = 0.0);
        composed(rendering, rgbs);
        return;
    }
    if let Some(end) =
        GIVEN_UP.among(wrong).and_then(spent).or(BEFORE_THE_SAMPLE.among(wrong).and_then(spends))
    {
        rendering.transmittance[end..].fill(light[end]);
        rendering.weights[end..].fill(0.0);
        composed(rendering, rgbs);
    }
    if let Some(end) = GIVEN_UP_IN_THE_DARK.among(wrong).and_then(spent) {
        rendering.weights[end..].fill(0.0);
        composed(rendering, rgbs);
        rendering.transmittance[n] = 0.0;
    }
    if let Some(end) = COLORS_GIVEN_UP.among(wrong).and_then(spent) {
        let of = |k: usize| rendering.weights[..end].iter().zip(rgbs).map(|(w, color)| w * color[k]).sum();
        rendering.color = std::array::from_fn(of);
    }
    if let Some(end) = MADE_OPAQUE.among(wrong).and_then(spends) {
        rendering.weights[end + 1..].fill(0.0);
        composed(rendering, rgbs);
        rendering.color = rendering.color.map(|c| c / rendering.opacity);
        (rendering.opacity, rendering.transmittance[n]) = (1.0, 0.0);
    }
    if let Some(least) = FAINT_UNCOLORED.among(wrong) {
        let seen = rendering.weights.iter().zip(rgbs).filter(|(w, _)| **w > least);
        rendering.color = seen.fold([0.0; 3], |sum, (w, color)| [0, 1, 2].map(|k| sum[k] + w * color[k]));
    }
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
    let mut rays: Vec<Rendering> = rays.into_iter().enumerate().map(finish).collect();
    if let Some(left) = TOGETHER.among(wrong) {
        ended_together(&mut rays, rgbs, left, wrong.contains(&"back_to_front"));
    }
    rays
}

/// A march of all rays in step, which ends where less than that is left in each of them; a march from behind ends in front.
fn ended_together(
    rays: &mut [Rendering],
    rgbs: impl Fn(usize) -> Vec<[f64; 3]>,
    left: f64,
    from_behind: bool,
) {
    let samples = rays.first().map_or(0, |ray| ray.weights.len());
    let unseen: Vec<usize> =
        (0..samples).filter(|&i| rays.iter().all(|ray| ray.transmittance[i] < left)).collect();
    let Some(&end) = unseen.first() else { return };
    for (r, ray) in rays.iter_mut().enumerate() {
        unseen.iter().for_each(|&i| ray.weights[i] = 0.0);
        composed(ray, &rgbs(r));
        if !from_behind {
            let light = ray.transmittance[end];
            ray.transmittance[end..].fill(light);
        }
    }
}

/// Rendering from opacities.
pub(crate) fn volume_render_alpha(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let a = &arrays::counted(a, c);
    let (count, samples) = size(a, "alphas");
    let mut alphas: Vec<Vec<f64>> = (0..count).map(|r| row(a, "alphas", r)).collect();
    if let Some(least) = THIN_ALPHAS.among(wrong) {
        alphas.iter_mut().flatten().filter(|alpha| **alpha < least).for_each(|alpha| *alpha = 0.0);
    }
    if let Some(most) = CAPPED_ELSEWHERE.among(wrong) {
        alphas.iter_mut().flatten().for_each(|alpha| *alpha = alpha.min(most));
    }
    if let Some(k) = ALPHAS_HELD.among(wrong) {
        alphas.iter_mut().flatten().for_each(|alpha| *alpha = alpha.clamp(k, 1.0 - k));
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
    finished(c, samples, &render_all(alphas, rays, |r| rows3(a, "rgbs", r), c.product_eps, wrong), wrong)
}

/// Rays over their backdrop; colors that are clamped are so behind it.
fn finished(c: &Conventions, samples: usize, rays: &[Rendering], wrong: &[&str]) -> Arrays {
    let mut out = arrays::over(c, renderings(samples, rays));
    if wrong.contains(&"clamped") {
        out.get_mut("colors").expect("an output").mapv_inplace(|c| c.clamp(0.0, 1.0));
    }
    out
}
