//! Gradients of renderings, wrong on purpose.

use super::arrays;
use super::catalogue::SHADE_FORGOTTEN;
use crate::contract::arrays::{Arrays, array, input, row, rows3, size};
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::math::exp;
use crate::volume_rendering::{
    Rendering, optical_depths, product, volume_render as oracle, volume_render_alpha as oracle_alpha,
};

/// What hand-written backward passes get wrong between weights and densities.
pub(super) const HAND_WRITTEN: [Mistake; 6] = [
    SHADE_FORGOTTEN,
    Mistake::new(
        "front_for_behind",
        "T_i g_i - B_{i+1}: the light in front of a sample for that behind it",
        "gradients too large where it is dense",
        "T_{i+1} g_i - B_{i+1}: alpha has the slope 1 - alpha",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "own_weight_hidden_too",
        "T_{i+1} g_i - B_i: the sample itself among what it hides",
        "densities learn too slowly where a sample is bright itself",
        "the sum over what lies behind, the sample left out",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "hidden_in_front",
        "T_{i+1} g_i minus the sum over what lies in front",
        "the gradient of a ray that is looked through from behind",
        "the sum over what lies behind the sample",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "alpha_for_density",
        "the gradient of alpha, with 1e-10 in what it divides by, as that of sigma delta: its slope 1 - alpha is left out",
        "gradients too large where it is dense",
        "times exp(-sigma delta)",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "opacity_without_step",
        "g_A T_N for g_A T_N delta_i: the opacity's gradient without the step",
        "densities that follow the mask too fast or too slowly",
        "dA / dsigma_i = T_N delta_i",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// The gradient of each sigma delta as a hand-written backward pass has it.
fn wrong_slopes(
    a: &Arrays,
    r: usize,
    ray: &Rendering,
    depths: &[f64],
    c: &Conventions,
    wrong: &[&str],
) -> Vec<f64> {
    let has = |name: &str| wrong.contains(&name);
    let n = depths.len();
    let apart = has("opacity_without_step");
    let g =
        unshaded(a, r, &vec![1.0; n], c).into_iter().map(|g| if apart { g - g_opacity(a, r, c) } else { g });
    let g: Vec<f64> = g.collect();
    let weighed: Vec<f64> = (0..n).map(|i| ray.weights[i] * g[i]).collect();
    let light = ray.transmittance[n] * arrays::cotangent_over(a, r, c).transmittance;
    let slope = |i: usize| {
        let behind = weighed[i + 1..].iter().sum::<f64>() + light;
        let left = ray.transmittance[i + 1];
        match () {
            () if has("shade_gradient_forgotten") => left * g[i],
            () if has("front_for_behind") => ray.transmittance[i] * g[i] - behind,
            () if has("own_weight_hidden_too") => left * g[i] - behind - weighed[i],
            () if has("hidden_in_front") => left * g[i] - weighed[..i].iter().sum::<f64>() - light,
            () if has("alpha_for_density") => {
                ray.transmittance[i] * g[i] - behind / (exp(-depths[i]) + 1e-10)
            }
            () => left * g[i] - behind,
        }
    };
    (0..n).map(slope).collect()
}

/// The opacity's cotangent.
fn g_opacity(a: &Arrays, r: usize, c: &Conventions) -> f64 {
    arrays::cotangent_over(a, r, c).opacity
}

/// What T_i times the cotangent of weight i is: the gradient of alpha_i without what sample i hides.
fn unshaded(a: &Arrays, r: usize, transmittance: &[f64], c: &Conventions) -> Vec<f64> {
    let g = arrays::cotangent_over(a, r, c);
    let one = |(i, rgb): (usize, &[f64; 3])| {
        let color: f64 = (0..3).map(|k| g.color[k] * rgb[k]).sum();
        transmittance[i] * (color + g.weights[i] + g.opacity)
    };
    rows3(a, "rgbs", r).iter().enumerate().map(one).collect()
}

/// Gradient from densities.
pub(crate) fn volume_render_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut gradients = arrays::render_vjp(a, c);
    if HAND_WRITTEN.iter().any(|m| wrong.contains(&m.name)) {
        let (rays, samples) = size(a, "sigmas");
        let (mut g_sigmas, mut g_deltas) = (vec![], vec![]);
        for r in 0..rays {
            let (sigmas, deltas) = (row(a, "sigmas", r), row(a, "deltas", r));
            let ray = oracle(&sigmas, &rows3(a, "rgbs", r), &deltas, c.product_eps);
            let depths = optical_depths(&sigmas, &deltas);
            let g_x = wrong_slopes(a, r, &ray, &depths, c, wrong);
            // Where the opacity's part is apart, the step's own gradient has it as it should be.
            let apart = wrong.contains(&"opacity_without_step");
            let more = if apart { g_opacity(a, r, c) * ray.transmittance[samples] } else { 0.0 };
            let along = if apart { wrong_slopes(a, r, &ray, &depths, c, &[]) } else { g_x.clone() };
            g_sigmas.extend(g_x.iter().zip(&deltas).map(|(g, delta)| product(*g, *delta) + more));
            g_deltas.extend(along.iter().zip(&sigmas).map(|(g, sigma)| product(*g, *sigma)));
        }
        gradients.insert("grad_sigmas".into(), array(&[rays, samples], g_sigmas));
        gradients.insert("grad_deltas".into(), array(&[rays, samples], g_deltas));
        gradients = arrays::gradients_of_rectified(a, c, gradients);
    }
    gradients
}

/// Gradient from opacities.
pub(crate) fn volume_render_alpha_vjp(given: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut gradients = arrays::render_alpha_vjp(given, c);
    let a = &arrays::counted(given, c);
    // Where alpha = 1, or everywhere, the gradient through the product is lost; that through the sample's own weight stays.
    let everywhere = wrong.contains(&"shade_gradient_forgotten");
    if everywhere || wrong.contains(&"product_gradient_zero_at_opaque") {
        let (rays, samples) = size(a, "alphas");
        let mut g_alphas = input(&gradients, "grad_alphas").clone();
        for r in 0..rays {
            let alphas = row(a, "alphas", r);
            let ray = oracle_alpha(&alphas, &rows3(a, "rgbs", r), c.product_eps);
            let lost = unshaded(a, r, &ray.transmittance, c);
            for i in (0..samples).filter(|&i| everywhere || alphas[i] == 1.0) {
                g_alphas[[r, i]] = lost[i];
            }
        }
        gradients.insert("grad_alphas".into(), g_alphas);
    }
    arrays::gradients_of_counted(given, c, gradients)
}
