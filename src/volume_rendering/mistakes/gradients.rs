//! Gradients of renderings, wrong on purpose.

use super::arrays;
use super::hand_written::{OF_DENSITIES, OF_OPACITIES};
use crate::contract::arrays::{Arrays, array, row, rows3, size};
use crate::contract::component::number_of;
use crate::convention::Conventions;
use crate::math::{exp, expm1};
use crate::volume_rendering::{
    Rendering, optical_depths, product, volume_render as oracle, volume_render_alpha as oracle_alpha,
};

/// Below this 1 - exp(-x) is 0 in single precision.
const NO_ALPHA: f64 = 1.0 / 33_554_432.0;

/// The gradient of each sigma delta as a hand-written backward pass has it.
fn wrong_slopes(
    a: &Arrays,
    r: usize,
    ray: &Rendering,
    depths: &[f64],
    sigmas: &[f64],
    c: &Conventions,
    wrong: &[&str],
) -> Vec<f64> {
    let has = |name: &str| wrong.contains(&name);
    let n = depths.len();
    // The opacity's part apart from the others'.
    let apart = ["opacity_without_step", "opacity_shades_nothing", "opacity_without_light"];
    let apart = if apart.iter().any(|name| has(name)) { g_opacity(a, r, c) } else { 0.0 };
    let g: Vec<f64> = unshaded(a, r, &vec![1.0; n], c, wrong).into_iter().map(|g| g - apart).collect();
    let left = |i: usize| ray.transmittance[i + 1];
    let weigh = |j: usize| match () {
        () if has("light_lost_behind") => -expm1(-depths[j]) * g[j],
        () => ray.weights[j] * g[j],
    };
    let weighed: Vec<f64> = (0..n).map(weigh).collect();
    let light = ray.transmittance[n] * arrays::cotangent_over(a, r, c).transmittance;
    let given_up = number_of("backward_given_up", OF_DENSITIES, wrong);
    let eps = c.product_eps.value();
    let slope = |i: usize| {
        let seen = if has("hidden_in_front") { &weighed[..i] } else { &weighed[i + 1..] };
        let itself = if has("own_weight_hidden_too") { weighed[i] } else { 0.0 };
        let front = if has("hidden_on_both_sides") { weighed[..i].iter().sum() } else { 0.0 };
        let sum = seen.iter().sum::<f64>() + itself + front;
        let behind = if has("hidden_added") { light - sum } else { light + sum };
        let through = exp(-depths[i]);
        // What is added inside of the product isn't seen through the sample.
        let kept = if eps == 0.0 { 1.0 } else { through / (through + eps) };
        let (own, behind) = (kept * left(i) * g[i], kept * behind);
        let more = match () {
            () if has("opacity_shades_nothing") => apart * left(i),
            () if has("opacity_without_light") => apart,
            () => 0.0,
        };
        let lit = ray.transmittance[i];
        let (own, behind) = match () {
            () if has("front_for_behind") => (lit * g[i], behind),
            () if has("slope_taken_twice") => (own * through, behind),
            () if has("step_lost_in_slope") => (lit * exp(-sigmas[i]) * g[i], behind),
            () if has("alpha_for_density") => (lit * g[i], behind / (through + 1e-10)),
            () if has("opacity_for_its_slope") => {
                let hidden = if through > 0.0 { behind / through } else { 0.0 };
                (lit * g[i] * (1.0 - through), hidden * (1.0 - through))
            }
            () if has("nothing_learned_at_zero") && depths[i] == 0.0 => (0.0, behind),
            () => (own, behind),
        };
        let behind = match () {
            () if has("shade_gradient_forgotten") => 0.0,
            () if has("slope_for_both") => behind * through,
            () if has("ties_shared") && depths[i] < NO_ALPHA => 0.5 * behind,
            () => behind,
        };
        match () {
            () if has("last_sample_without_gradient") && i + 1 == n => 0.0,
            () if given_up.is_some_and(|least| lit < least) => 0.0,
            () => own - behind + more,
        }
    };
    let scale = if has("light_not_reset") { ray.transmittance[n] } else { 1.0 };
    (0..n).map(|i| scale * slope(i)).collect()
}

/// The opacity's cotangent.
fn g_opacity(a: &Arrays, r: usize, c: &Conventions) -> f64 {
    arrays::cotangent_over(a, r, c).opacity
}

/// The cotangent of the color as the mistakes have it.
fn g_color(a: &Arrays, r: usize, c: &Conventions, wrong: &[&str]) -> [f64; 3] {
    let ray = if wrong.contains(&"first_rays_cotangent") { 0 } else { r };
    let color = arrays::cotangent_over(a, ray, c).color;
    if wrong.contains(&"first_channel_for_all") { [color[0]; 3] } else { color }
}

/// What T_i times the cotangent of weight i is: the gradient of alpha_i without what sample i hides.
fn unshaded(a: &Arrays, r: usize, transmittance: &[f64], c: &Conventions, wrong: &[&str]) -> Vec<f64> {
    let g = arrays::cotangent_over(a, r, c);
    let of_color = if wrong.contains(&"weights_detached") { [0.0; 3] } else { g_color(a, r, c, wrong) };
    let one = |(i, rgb): (usize, &[f64; 3])| {
        let color: f64 = (0..3).map(|k| of_color[k] * rgb[k]).sum();
        transmittance[i] * (color + g.weights[i] + g.opacity)
    };
    rows3(a, "rgbs", r).iter().enumerate().map(one).collect()
}

/// The gradient of a ray's colors as a hand-written backward pass has it.
fn wrong_colors(a: &Arrays, r: usize, ray: &Rendering, c: &Conventions, wrong: &[&str]) -> Vec<f64> {
    let has = |name: &str| wrong.contains(&name);
    let (n, g) = (ray.weights.len(), g_color(a, r, c, wrong));
    let given_up = number_of("backward_given_up", OF_DENSITIES, wrong);
    let weight = |i: usize| match () {
        () if has("last_sample_without_gradient") && i + 1 == n => 0.0,
        () if given_up.is_some_and(|least| ray.transmittance[i] < least) => 0.0,
        () if has("light_not_reset") => ray.transmittance[n] * ray.weights[i],
        () if has("colors_by_light_behind") && ray.transmittance[i] > 0.0 => {
            ray.weights[i] * ray.transmittance[i + 1] / ray.transmittance[i]
        }
        () => ray.weights[i],
    };
    (0..n).flat_map(|i| g.map(|g| weight(i) * g)).collect()
}

/// Gradient from densities.
pub(crate) fn volume_render_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut gradients = arrays::render_vjp(a, c);
    if OF_DENSITIES.iter().any(|m| m.among(wrong).is_some()) {
        let a = &arrays::closed(a, c);
        let (rays, samples) = size(a, "sigmas");
        let (mut g_sigmas, mut g_deltas, mut g_rgbs) = (vec![], vec![], vec![]);
        for r in 0..rays {
            let (sigmas, deltas) = (row(a, "sigmas", r), row(a, "deltas", r));
            let ray = oracle(&sigmas, &rows3(a, "rgbs", r), &deltas, c.product_eps);
            let depths = optical_depths(&sigmas, &deltas);
            let slopes = |wrong: &[&str]| wrong_slopes(a, r, &ray, &depths, &sigmas, c, wrong);
            let g_x = slopes(wrong);
            // Where the opacity's part is apart, the step's own gradient has it as it should be.
            let step = wrong.contains(&"opacity_without_step");
            let more = if step { g_opacity(a, r, c) * ray.transmittance[samples] } else { 0.0 };
            let others: Vec<&str> =
                wrong.iter().copied().filter(|name| *name != "opacity_without_step").collect();
            let along = if step { slopes(&others) } else { g_x.clone() };
            g_sigmas.extend(g_x.iter().zip(&deltas).map(|(g, delta)| product(*g, *delta) + more));
            if wrong.contains(&"steps_of_those_behind") {
                // T_{i+1} g_i delta_i for the sample itself, and each step of those behind.
                let own = slopes(&["shade_gradient_forgotten"]);
                let weighed: Vec<f64> = unshaded(a, r, &ray.weights, c, &[])
                    .iter()
                    .zip(&deltas)
                    .map(|(w, d)| product(*w, *d))
                    .collect();
                let first = g_sigmas.len() - samples;
                for i in 0..samples {
                    g_sigmas[first + i] = product(own[i], deltas[i]) - weighed[i + 1..].iter().sum::<f64>();
                }
            }
            let by = if wrong.contains(&"step_gradient_by_step") { &deltas } else { &sigmas };
            g_deltas.extend(along.iter().zip(by).map(|(g, by)| product(*g, *by)));
            g_rgbs.extend(wrong_colors(a, r, &ray, c, wrong));
        }
        gradients.insert("grad_sigmas".into(), array(&[rays, samples], g_sigmas));
        gradients.insert("grad_deltas".into(), array(&[rays, samples], g_deltas));
        gradients.insert("grad_rgbs".into(), array(&[rays, samples, 3], g_rgbs));
        gradients = arrays::gradients_of_densities(a, c, gradients);
        if let Some(scale) = number_of("loss_scale_left_in", OF_DENSITIES, wrong) {
            gradients.values_mut().for_each(|g| g.mapv_inplace(|g| scale * g));
        }
    }
    gradients
}

/// B_i = alpha_i g_i + (1 - alpha_i) B_{i+1}: what lies behind, as the light sees it that reaches it; `through` is 1 - alpha.
fn seen_behind(alphas: &[f64], through: &[f64], g: &[f64], light: f64, wrong: &[&str]) -> Vec<f64> {
    let has = |name: &str| wrong.contains(&name);
    let n = alphas.len();
    let mut behind = vec![light; n + 1];
    for i in (0..n).rev() {
        let k = if has("last_alpha_forgotten") { i.saturating_sub(1) } else { i };
        let own = alphas[k] * g[i];
        behind[i] = through[k] * behind[i + 1] + if has("hidden_added") { -own } else { own };
    }
    behind
}

/// The gradient of each alpha as a hand-written backward pass has it, over the samples that it comes by.
fn wrong_alpha_slopes(
    a: &Arrays,
    r: usize,
    ray: &Rendering,
    alphas: &[f64],
    c: &Conventions,
    wrong: &[&str],
) -> Vec<f64> {
    let has = |name: &str| wrong.contains(&name);
    let (n, t, all) = (alphas.len(), &ray.transmittance, arrays::cotangent_over(a, r, c));
    let apart = ["opacity_shades_nothing", "opacity_undivided"].iter().any(|name| has(name));
    let apart = if apart { all.opacity } else { 0.0 };
    let ones = vec![1.0; size(a, "alphas").1];
    let g: Vec<f64> = unshaded(a, r, &ones, c, &[]).into_iter().take(n).map(|g| g - apart).collect();
    let through: Vec<f64> = alphas.iter().map(|alpha| 1.0 - alpha + c.product_eps.value()).collect();
    let behind = seen_behind(alphas, &through, &g, all.transmittance, wrong);
    let light = |i: usize| all.transmittance * through[i..].iter().product::<f64>();
    let (eps, least) =
        (number_of("eps_in_hidden", OF_OPACITIES, wrong), number_of("hidden_held", OF_OPACITIES, wrong));
    let slope = |i: usize| {
        let hidden = match () {
            () if has("accumulated_before_use") => behind[i],
            () if has("hidden_one_late") => {
                let next = (i + 1..n).find(|&j| alphas[j] > 0.0).unwrap_or(n - 1);
                behind[next + 1] - light(next + 1) + light(i + 1)
            }
            () => behind[i + 1],
        };
        // What is summed up from the end is seen through the sample itself: the sum is divided by 1 - alpha again.
        let of_sum = |sum: f64| match (eps, least) {
            _ if has("hidden_undivided") => sum,
            (Some(eps), _) => sum / (through[i] + eps),
            (_, Some(least)) => sum / through[i].max(least),
            _ => sum / through[i],
        };
        let own_too = if has("own_weight_hidden_too") { of_sum(alphas[i] * g[i]) } else { 0.0 };
        let divided = eps.is_some() || least.is_some() || has("hidden_undivided");
        let hidden = own_too + if divided { of_sum(hidden * through[i]) } else { hidden };
        let lost =
            has("shade_gradient_forgotten") || has("product_gradient_zero_at_opaque") && alphas[i] == 1.0;
        let lit = if has("light_behind_itself") { t[i] * through[i] } else { t[i] };
        let more = match () {
            () if has("opacity_shades_nothing") => apart * t[i],
            () if has("opacity_undivided") => apart * t[n],
            () => 0.0,
        };
        lit * (g[i] - if lost { 0.0 } else { hidden }) + more
    };
    (0..n).map(slope).collect()
}

/// How many samples of a ray a backward march of its own comes by.
fn stopped(transmittance: &[f64], wrong: &[&str]) -> usize {
    let n = transmittance.len() - 1;
    let behind = number_of("stopped_behind_the_sample", OF_OPACITIES, wrong);
    let before = number_of("stopped_before_the_sample", OF_OPACITIES, wrong);
    let spent = |i: &usize| {
        behind.is_some_and(|least| transmittance[*i] < least)
            || before.is_some_and(|least| transmittance[*i + 1] < least)
    };
    (0..n).find(spent).unwrap_or(n)
}

/// Gradient from opacities.
pub(crate) fn volume_render_alpha_vjp(given: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut gradients = arrays::render_alpha_vjp(given, c);
    let a = &arrays::counted(given, c);
    // Where alpha = 1, or everywhere, the gradient through the product is lost; that through the sample's own weight stays.
    let lost = ["shade_gradient_forgotten", "product_gradient_zero_at_opaque"];
    let by_hand = OF_OPACITIES.iter().any(|m| m.among(wrong).is_some());
    if by_hand || lost.iter().any(|name| wrong.contains(name)) {
        let (rays, samples) = size(a, "alphas");
        let (mut g_alphas, mut g_rgbs) = (vec![], vec![]);
        for r in 0..rays {
            let (alphas, colors) = (row(a, "alphas", r), rows3(a, "rgbs", r));
            let end = stopped(&oracle_alpha(&alphas, &colors, c.product_eps).transmittance, wrong);
            let ray = oracle_alpha(&alphas[..end], &colors[..end], c.product_eps);
            let slopes = wrong_alpha_slopes(a, r, &ray, &alphas[..end], c, wrong);
            let g_color = arrays::cotangent_over(a, r, c).color;
            // Nothing is known any more of what lies in front of an opaque sample.
            let opaque = alphas[..end].iter().rposition(|alpha| *alpha == 1.0);
            let opaque = opaque.filter(|_| wrong.contains(&"light_recovered_by_division"));
            let lost = |i: usize| if opaque.is_some_and(|last| i <= last) { f64::NAN } else { 0.0 };
            let least = number_of("thin_samples_learn_nothing", OF_OPACITIES, wrong);
            let thin = |i: usize| least.is_some_and(|least| alphas[i] < least);
            let slope = |(i, g): (usize, f64)| if thin(i) { 0.0 } else { g + lost(i) };
            g_alphas.extend(slopes.into_iter().enumerate().map(slope).chain(vec![0.0; samples - end]));
            let color = |(i, w): (usize, &f64)| g_color.map(|g| if thin(i) { 0.0 } else { w * g + lost(i) });
            g_rgbs.extend(ray.weights.iter().enumerate().flat_map(color));
            g_rgbs.extend(vec![0.0; 3 * (samples - end)]);
        }
        gradients.insert("grad_alphas".into(), array(&[rays, samples], g_alphas));
        gradients.insert("grad_rgbs".into(), array(&[rays, samples, 3], g_rgbs));
    }
    arrays::gradients_of_counted(given, c, gradients)
}
