//! Rendering from densities, wrong on purpose.

use super::super::arrays::closed;
use super::catalogue::{DENSITY_CAPPED, EPS_ON_ALPHA, SCALED_EXPONENTIAL};
use super::march::{DEPTH_HELD, DIVISION_GUARDED, THIN_SKIPPED, unless_thin};
use super::other_alphas::{other_alphas, softmax};
use super::steps::wrong_deltas;
use super::{finished, recompose, render_all};
use crate::contract::arrays::{Arrays, input, row, rows3, size};
use crate::contract::case::Draw;
use crate::convention::{Conventions, ProductEps};
use crate::math::{exp, ln};
use crate::volume_rendering::{
    optical_depths, product, volume_render as oracle, volume_render_alpha as oracle_alpha,
};

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

/// Rendering from densities.
pub(crate) fn volume_render(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let a = &closed(a, c);
    let (count, samples) = size(a, "sigmas");
    let (mut all, mut rays, mut carried) = (vec![], vec![], 1.0);
    for r in 0..count {
        let (mut sigmas, mut deltas, rgbs) =
            (row(a, "sigmas", r), wrong_deltas(a, r, wrong), colors_of(a, r, wrong));
        if wrong.contains(&"densities_averaged") {
            (1..samples).for_each(|i| sigmas[i - 1] = 0.5 * (sigmas[i - 1] + sigmas[i]));
        }
        if let Some(least) = THIN_SKIPPED.among(wrong) {
            sigmas.iter_mut().for_each(|sigma| *sigma = unless_thin(*sigma, least));
        }
        for name in wrong {
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
        if let Some(most) = DEPTH_HELD.among(wrong) {
            let all = sigmas.iter_mut().zip(&mut deltas);
            all.filter(|(s, d)| product(**s, **d) > most).for_each(|(s, d)| (*s, *d) = (most, 1.0));
        }
        let mut alphas: Vec<f64> =
            optical_depths(&sigmas, &deltas).iter().map(|&x| -crate::math::expm1(-x)).collect();
        let mut ray = oracle(&sigmas, &rgbs, &deltas, c.product_eps);
        let (eps, scale) = (EPS_ON_ALPHA.among(wrong), SCALED_EXPONENTIAL.among(wrong));
        let touched = eps.is_some() || scale.is_some();
        if touched {
            for (alpha, x) in alphas.iter_mut().zip(optical_depths(&sigmas, &deltas)) {
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
                // What is wrong already isn't put right.
                .for_each(|(alpha, e)| *alpha = (*alpha + e).clamp(alpha.min(0.0), alpha.max(1.0)));
        }
        let other = other_alphas(&sigmas, &deltas, wrong);
        let touched = touched || other.is_some();
        alphas = other.unwrap_or(alphas);
        if touched || textbook {
            ray = oracle_alpha(&alphas, &rgbs, c.product_eps);
        }
        if let Some(eps) = eps {
            alphas.iter_mut().for_each(|alpha| *alpha += eps);
            ray = oracle_alpha(&alphas, &rgbs, ProductEps::TenToMinusTen);
        }
        if wrong.contains(&"delta_missing_in_alpha") {
            alphas = sigmas.iter().map(|sigma| -crate::math::expm1(-sigma)).collect();
            ray = recompose(ray, &alphas, &rgbs);
        }
        if wrong.contains(&"delta_missing_in_transmittance") {
            let in_front = |i: usize| sigmas[..i].iter().sum::<f64>();
            ray.transmittance = (0..=samples).map(|i| exp(-in_front(i))).collect();
            ray = recompose(ray, &alphas, &rgbs);
        }
        if wrong.contains(&"taken_off_the_sum") {
            let errors = if textbook { row(a, ALPHA_ERROR, r) } else { vec![0.0; samples] };
            let mut front = 0.0;
            for (i, x) in optical_depths(&sigmas, &deltas).into_iter().enumerate() {
                let nothing = if x.is_infinite() { f64::NAN } else { 0.0 };
                let left = if x > NOTHING_LEFT * front { nothing } else { front };
                front += x;
                ray.transmittance[i] = exp(-(left + errors[i] * front));
            }
            ray = recompose(ray, &alphas, &rgbs);
        }
        if wrong.contains(&"product_over_the_batch") {
            let own = ray.transmittance[samples];
            ray.transmittance.iter_mut().for_each(|t| *t *= carried);
            carried = ray.transmittance[samples];
            ray = recompose(ray, &alphas, &rgbs);
            ray.transmittance[samples] = own;
        }
        if wrong.contains(&"softmax_for_weights") {
            alphas = softmax(&optical_depths(&sigmas, &deltas));
            ray.transmittance.fill(1.0);
            ray = recompose(ray, &alphas, &rgbs);
        }
        if wrong.contains(&"density_with_step_before") {
            let mut depth = 0.0;
            for i in 1..samples {
                depth += product(sigmas[i], deltas[i - 1]);
                ray.transmittance[i] = exp(-depth);
            }
            ray = recompose(ray, &alphas, &rgbs);
        }
        if wrong.contains(&"exponent_without_minus") {
            alphas = optical_depths(&sigmas, &deltas).iter().map(|&x| -crate::math::expm1(x)).collect();
            ray = recompose(ray, &alphas, &rgbs);
        }
        if wrong.contains(&"depth_for_transmittance") {
            let mut depth = 0.0;
            for (i, x) in optical_depths(&sigmas, &deltas).into_iter().enumerate() {
                ray.transmittance[i] = depth;
                depth += x;
            }
            ray = recompose(ray, &alphas, &rgbs);
        }
        if wrong.contains(&"light_grows") {
            ray.transmittance.iter_mut().for_each(|t| *t = 1.0 / *t);
            ray = recompose(ray, &alphas, &rgbs);
        }
        if wrong.contains(&"optical_depth_for_alpha") {
            alphas = optical_depths(&sigmas, &deltas);
            ray = recompose(ray, &alphas, &rgbs);
        }
        if wrong.contains(&"light_at_the_middle") {
            let depths = optical_depths(&sigmas, &deltas);
            let front = |i: usize| depths[..i].iter().sum::<f64>() + 0.5 * depths[i];
            (0..samples).for_each(|i| ray.transmittance[i] = exp(-front(i)));
            ray = recompose(ray, &alphas, &rgbs);
        }
        if wrong.contains(&"cloud_of_a_shader") {
            let depths = optical_depths(&sigmas, &deltas);
            ray.transmittance.rotate_left(1.min(samples));
            let behind = ray.transmittance[samples.saturating_sub(1)];
            ray = recompose(ray, &depths, &rgbs);
            (ray.opacity, ray.transmittance) = (1.0 - behind, vec![behind; samples + 1]);
        }
        if wrong.contains(&"alphas_subtracted") {
            let front = |i: usize| alphas[..i].iter().sum::<f64>();
            (0..=samples).for_each(|i| ray.transmittance[i] = (1.0 - front(i)).max(0.0));
            ray = recompose(ray, &alphas, &rgbs);
        }
        if wrong.contains(&"source_without_density") {
            let of = |(alpha, sigma): (&f64, &f64)| if *sigma == 0.0 { 0.0 } else { alpha / sigma };
            alphas = alphas.iter().zip(&sigmas).map(of).collect();
            ray = recompose(ray, &alphas, &rgbs);
        }
        if let Some(least) = DIVISION_GUARDED.among(wrong) {
            let held: Vec<f64> = sigmas.iter().map(|sigma| sigma.max(least)).collect();
            ray.transmittance = oracle(&held, &rgbs, &deltas, c.product_eps).transmittance;
            let alpha = |i: usize| -crate::math::expm1(-product(held[i], deltas[i])) * (sigmas[i] / held[i]);
            alphas = (0..samples).map(alpha).collect();
            ray = recompose(ray, &alphas, &rgbs);
        }
        if wrong.contains(&"density_for_opacity") {
            alphas = sigmas;
            ray = recompose(ray, &alphas, &rgbs);
        }
        all.push(alphas);
        rays.push(ray);
    }
    finished(c, samples, &render_all(all, rays, |r| colors_of(a, r, wrong), c.product_eps, wrong), wrong)
}

/// A ray's colors as the mistakes have them.
fn colors_of(a: &Arrays, r: usize, wrong: &[&str]) -> Vec<[f64; 3]> {
    let mut rgbs = rows3(a, "rgbs", r);
    if wrong.contains(&"colors_averaged") {
        for i in 1..rgbs.len() {
            rgbs[i - 1] = [0, 1, 2].map(|k| 0.5 * (rgbs[i - 1][k] + rgbs[i][k]));
        }
    }
    rgbs
}

/// log(1 + exp(x)), which is never 0.
pub(super) fn softplus(x: f64) -> f64 {
    x.max(0.0) + ln(1.0 + exp(-x.abs()))
}
