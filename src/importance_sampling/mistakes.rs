//! Importance sampling, wrong on purpose. Without a mistake every function equals the oracle.

mod catalogue;
mod inputs;
pub(crate) mod laws;

use catalogue::{BLURRED, DENOMINATOR_EPS, EPS_AFTER_DIVISION, EPS_IN_SUM, PADDED};
pub(crate) use catalogue::{
    IMPORTANCE_SAMPLING, INTERIOR_ALONE, NO_LEADING_ZERO, NOT_NORMALIZED, NOTHING_OVER_NOTHING,
    SEARCHED_FROM_THE_LEFT,
};
pub(crate) use inputs::{EMPTY_AT_FAR, EMPTY_AT_NEAR};
use inputs::{MAX_FOR_SUM, MIXED, SNAPPED_BELOW, U_CUT, U_HELD, U_SQUEEZED};

use super::arrays::{Ray, forward, gradient, vjp};
use super::{SNAPPED, bin_of, cdf};
use crate::contract::arrays::{Arrays, size};
use crate::convention::Conventions;

/// The largest number below 1 that the code with doubled strata draws.
const BELOW_ONE: f64 = 1.0 - 1.0 / 8_388_608.0;

/// Changes to a ray's inputs, before anything is computed.
fn changed(ray: &Ray, wrong: &[&str]) -> Ray {
    let Ray { mut edges, mut weights, mut padding, mut u } = Ray {
        edges: ray.edges.clone(),
        weights: ray.weights.clone(),
        padding: ray.padding,
        u: ray.u.clone(),
    };
    if wrong.contains(&"interior_alone") && weights.len() > 2 {
        edges = edges.windows(2).map(|e| 0.5 * (e[0] + e[1])).collect();
        weights = weights[1..weights.len() - 1].to_vec();
    }
    if wrong.contains(&"first_bin_dropped") {
        edges[0] = edges[1];
    }
    if wrong.contains(&"edges_about_the_middles") && weights.len() > 1 {
        let middle = |k: usize| 0.5 * (ray.edges[k] + ray.edges[k + 1]);
        let half = 0.5 * (middle(1) - middle(0));
        let last = weights.len() - 1;
        edges = (0..=last).map(|k| middle(k) - half).chain([middle(last) + half]).collect();
    }
    if wrong.contains(&"weights_as_densities") {
        weights.iter_mut().zip(edges.windows(2)).for_each(|(w, e)| *w *= e[1] - e[0]);
    }
    if wrong.contains(&"padded_densities") {
        let padded =
            weights.iter().zip(edges.windows(2)).map(|(w, e)| (w + padding) * (e[1] - e[0]) - padding);
        weights = padded.collect();
    }
    if wrong.contains(&"weights_squared") {
        weights.iter_mut().for_each(|w| *w *= *w);
    }
    if wrong.contains(&"weights_over_widths") {
        weights.iter_mut().zip(edges.windows(2)).for_each(|(w, e)| *w /= (e[1] - e[0]).max(1e-10));
    }
    let last = weights.len() - 1;
    if wrong.contains(&"outer_bins_zeroed") {
        (weights[0], weights[last]) = (0.0, 0.0);
    }
    if wrong.contains(&"weights_averaged") {
        (0..last).for_each(|k| weights[k] = 0.5 * (weights[k] + weights[k + 1]));
    }
    if wrong.contains(&"weights_pooled") {
        let most = |k: usize| weights[k.saturating_sub(1)..(k + 2).min(last + 1)].iter().copied();
        weights = (0..=last).map(|k| most(k).fold(0.0, f64::max)).collect();
    }
    if let Some(share) = MIXED.among(wrong) {
        let whole: f64 = weights.iter().map(|w| w + padding).sum();
        let even = share / weights.len() as f64;
        weights.iter_mut().for_each(|w| *w = (1.0 - share) * (*w + padding) / whole + even);
        padding = 0.0;
    }
    if let Some(least) = MAX_FOR_SUM.among(wrong) {
        weights.iter_mut().for_each(|w| *w = w.max(least));
        padding = 0.0;
    }
    if wrong.contains(&"inner_weights_on_first_edges") && weights.len() > 2 {
        weights = weights[1..weights.len() - 1].to_vec();
        edges.truncate(weights.len() + 1);
    }
    let behind = wrong.contains(&"middles_with_weights_behind");
    if (behind || wrong.contains(&"middles_with_weights_before")) && weights.len() > 1 {
        edges = edges.windows(2).map(|e| 0.5 * (e[0] + e[1])).collect();
        weights = if behind { weights[1..].to_vec() } else { weights[..weights.len() - 1].to_vec() };
    }
    if wrong.contains(&"interpolated_in_disparity") {
        edges.iter_mut().for_each(|e| *e = 1.0 / *e);
    }
    u = drawn(u, wrong);
    if wrong.contains(&"weights_of_next_bin") {
        weights.rotate_left(1);
    }
    if wrong.contains(&"edges_from_zero") {
        edges.iter_mut().for_each(|e| *e -= ray.edges[0]);
    }
    if wrong.contains(&"last_bin_zeroed") {
        weights.iter_mut().last().into_iter().for_each(|w| *w = 0.0);
    }
    if wrong.contains(&"strata_doubled") {
        u = doubled(&u);
    }
    padding = PADDED.among(wrong).unwrap_or(padding);
    if wrong.contains(&"stratified_again") {
        let count = u.len() as f64;
        u = u.iter().enumerate().map(|(j, u)| (j as f64 + u) / count).collect();
    }
    if let Some(padding) = BLURRED.among(wrong) {
        weights = blurred(&weights).into_iter().map(|w| w + padding).collect();
    }
    // Several of these at once may leave fewer edges than weights have ends.
    let bins = weights.len().min(edges.len() - 1);
    weights.truncate(bins);
    edges.truncate(bins + 1);
    if bins == 0 {
        (edges, weights) = (ray.edges.clone(), ray.weights.clone());
    }
    Ray { edges, weights, padding, u }
}

/// What is taken for u.
fn drawn(u: Vec<f64>, wrong: &[&str]) -> Vec<f64> {
    let count = u.len();
    let one = |(j, u): (usize, f64)| match () {
        () if wrong.contains(&"u_ignored") => j as f64 / (count - 1).max(1) as f64,
        () if wrong.contains(&"middles_for_u") => (j as f64 + 0.5) / count as f64,
        () if wrong.contains(&"u_from_the_far_end") => 1.0 - u,
        () => match (U_CUT.among(wrong), U_HELD.among(wrong)) {
            (Some(k), _) => u.min(1.0 - k),
            (_, Some(k)) => u.clamp(k, 1.0 - k),
            _ => U_SQUEEZED.among(wrong).map_or(u, |k| u * (1.0 - 2.0 * k) + k),
        },
    };
    u.into_iter().enumerate().map(one).collect()
}

/// Half of the larger of a weight and the one before, and half of the larger of it and the next.
fn blurred(weights: &[f64]) -> Vec<f64> {
    let larger = |k: usize, n: usize| weights[k].max(weights[n]);
    let last = weights.len() - 1;
    (0..=last).map(|k| 0.5 * (larger(k.saturating_sub(1), k) + larger(k, (k + 1).min(last)))).collect()
}

/// The strata that were meant, twice as far apart.
fn doubled(u: &[f64]) -> Vec<f64> {
    let count = u.len() as f64;
    u.iter().enumerate().map(|(i, r)| ((2.0 * i as f64 + r) / count).min(BELOW_ONE)).collect()
}

/// F; `batch` is what the weights of all rays add up to.
fn cdf_of(ray: &Ray, batch: f64, wrong: &[&str]) -> Vec<f64> {
    let mut f = cdf(&ray.weights, ray.padding);
    if wrong.contains(&"not_normalized") {
        f.iter_mut().for_each(|f| *f *= total(ray));
    }
    if wrong.contains(&"sum_of_all_rays") {
        f.iter_mut().for_each(|f| *f *= total(ray) / batch);
    }
    if let Some(eps) = EPS_IN_SUM.among(wrong) {
        let whole = eps + ray.weights.iter().sum::<f64>();
        let mut sum = 0.0;
        for (f, w) in f[1..].iter_mut().zip(&ray.weights) {
            sum += w / whole;
            *f = sum;
        }
    }
    if let Some(eps) = EPS_AFTER_DIVISION.among(wrong) {
        f.iter_mut().enumerate().for_each(|(k, f)| *f += k as f64 * eps);
    }
    let nothing = ray.weights.iter().all(|w| w + ray.padding == 0.0);
    if wrong.contains(&"nothing_over_nothing") && nothing {
        f.fill(f64::NAN);
    }
    if wrong.contains(&"divided_by_the_integral") {
        let shares = ray.weights.iter().zip(ray.edges.windows(2));
        let integral: f64 = shares.map(|(w, e)| (w + ray.padding) * (e[1] - e[0])).sum();
        f.iter_mut().for_each(|f| *f *= total(ray) / integral);
    }
    if wrong.contains(&"sums_cut_at_one") {
        f.iter_mut().for_each(|f| *f = (*f * total(ray)).min(1.0));
    }
    if wrong.contains(&"rest_in_the_last_bin") {
        f.iter_mut().for_each(|f| *f = (*f * total(ray)).min(1.0));
        f.pop();
        f.push(1.0);
    }
    if wrong.contains(&"padding_not_in_the_sum") {
        let without: f64 = ray.weights.iter().sum();
        f.iter_mut().filter(|f| **f > 0.0).for_each(|f| *f *= total(ray) / without);
    }
    if wrong.contains(&"no_leading_zero") {
        f.remove(0);
    }
    f
}

/// What a ray's weights add up to.
fn total(ray: &Ray) -> f64 {
    ray.weights.iter().map(|w| w + ray.padding).sum()
}

/// Mistakes that leave `u` beyond the ends of F, or look for it in another way.
const SEARCHED: [&str; 13] = [
    "upper_edge_held_at_sample_count",
    "searched_from_the_left",
    "upper_edge_held_by_sample_count",
    "no_leading_zero",
    "not_normalized",
    "sum_of_all_rays",
    "divided_by_the_integral",
    "last_bin_zeroed",
    "index_not_moved_back",
    "sums_cut_at_one",
    "rest_in_the_last_bin",
    "padding_not_in_the_sum",
    "last_edge_out_of_reach",
];

/// The places in F between which `u` lies.
fn between(f: &[f64], u: f64, wrong: &[&str]) -> [usize; 2] {
    if EPS_IN_SUM.among(wrong).is_none() && !SEARCHED.iter().any(|name| wrong.contains(name)) {
        let k = bin_of(f, u);
        return [k, k + 1];
    }
    // As searchsorted and gather find them, both held inside.
    let left = wrong.contains(&"searched_from_the_left");
    let count = f.iter().filter(|&&f| if left { f < u } else { f <= u }).count();
    let upper = count + usize::from(wrong.contains(&"index_not_moved_back"));
    [upper.saturating_sub(1), upper].map(|k| k.min(f.len() - 1))
}

/// The place inside a bin, from 0 to 1, of the bin's share `f` at both ends.
fn place(f: [f64; 2], u: f64, c: &Conventions, wrong: &[&str]) -> f64 {
    let mut difference = f[1] - f[0];
    if let Some(faint) = c.pdf_division.faint().filter(|_| difference < SNAPPED) {
        difference = faint;
    }
    if difference == 0.0 || SNAPPED_BELOW.among(wrong).is_some_and(|least| difference < least) {
        difference = 1.0;
    }
    let difference = difference + DENOMINATOR_EPS.among(wrong).unwrap_or(0.0);
    let s = (u - f[0]) / difference;
    match () {
        () if wrong.contains(&"left_edge") => 0.0,
        () if wrong.contains(&"right_edge") => 1.0,
        () if wrong.contains(&"place_of_u") => u,
        () if wrong.contains(&"place_mirrored") => 1.0 - s,
        () if wrong.contains(&"measured_from_above") => s - 1.0,
        () if wrong.contains(&"middle_of_bin") => 0.5,
        () => s,
    }
}

/// What counts as u = 1: a rounding below it is meant, too.
const NEARLY_ONE: f64 = 1.0 - 1e-6;

fn one(ray: &Ray, f: &[f64], u: f64, c: &Conventions, wrong: &[&str]) -> f64 {
    // Wherever it is looked for.
    if f[0].is_nan() {
        return f64::NAN;
    }
    // One bin without the zero in front: nothing to look between.
    if f.len() < 2 {
        return ray.edges[0];
    }
    let [k, mut above] = between(f, u, wrong);
    if wrong.contains(&"no_leading_zero") && above == k && k > 0 {
        // The last place, or the last edge: it depends on what else is forgotten at the end.
        return f64::NAN;
    }
    if wrong.contains(&"upper_edge_held_by_sample_count") {
        above = above.min(ray.u.len() - 1);
    }
    if wrong.contains(&"upper_edge_held_at_sample_count") {
        above = above.min(ray.u.len());
    }
    if wrong.contains(&"summed_over_bins") && u == 0.0 {
        return ray.edges[0];
    }
    if wrong.contains(&"summed_over_bins") && f.last().is_some_and(|whole| u >= *whole) {
        return 0.0;
    }
    if wrong.contains(&"last_edge_out_of_reach") {
        above = above.min(f.len() - 2);
    }
    if wrong.contains(&"u_of_one_past_the_end") && u > NEARLY_ONE {
        return f64::NAN;
    }
    let (a, b) = (ray.edges[k], ray.edges[above]);
    let at_the_end = wrong.contains(&"left_edge_at_the_end") && u > NEARLY_ONE;
    if at_the_end || wrong.contains(&"last_bin_dropped") && k + 2 >= f.len() {
        return a;
    }
    let share = match () {
        () if wrong.contains(&"next_bins_share") => {
            let next = (k + 1).min(f.len() - 2);
            [f[k], f[k] + f[next + 1] - f[next]]
        }
        () => [f[k], f[above]],
    };
    let s = place(share, u, c, wrong);
    let (first, last, bins) = (ray.edges[0], ray.edges[ray.edges.len() - 1], ray.weights.len() as f64);
    match () {
        () if wrong.contains(&"index_for_place") => k as f64,
        () if wrong.contains(&"bin_width_forgotten") => a + s,
        () if wrong.contains(&"even_widths") => a + s / bins * (last - first),
        () if wrong.contains(&"bins_taken_as_even") => first + (k as f64 + s) / bins * (last - first),
        () if wrong.contains(&"bins_counted_by_samples") => {
            first + (k as f64 + s) / ray.u.len() as f64 * (last - first)
        }
        () => a + s * (b - a),
    }
}

/// f at x, between its values at the edges, as numpy.interp has it.
fn interpolated(edges: &[f64], f: &[f64], x: f64) -> f64 {
    let last = edges.len().min(f.len()) - 1;
    match edges.iter().rposition(|&e| e <= x) {
        None => f[0],
        Some(k) if k >= last => f[last],
        Some(k) => f[k] + (x - edges[k]) / (edges[k + 1] - edges[k]) * (f[k + 1] - f[k]),
    }
}

/// Samples.
pub(crate) fn sample(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let batch: f64 = (0..size(a, "weights").0).map(|r| total(&super::arrays::ray(a, r, c))).sum();
    let others = super::arrays::ray(a, 0, c);
    let shared = if wrong.contains(&"strata_doubled") { doubled(&others.u) } else { others.u.clone() };
    forward(a, c, |ray| {
        let first = |name: &str, own: &[f64], others: &[f64]| {
            if wrong.contains(&name) { others.to_vec() } else { own.to_vec() }
        };
        let ray = changed(
            &Ray {
                edges: first("first_rays_edges", &ray.edges, &others.edges),
                weights: first("first_rays_weights", &ray.weights, &others.weights),
                u: ray.u.clone(),
                ..*ray
            },
            wrong,
        );
        let f = cdf_of(&ray, batch, wrong);
        let u = if wrong.contains(&"one_u_for_all_rays") { &shared } else { &ray.u };
        let mut t: Vec<f64> = u.iter().map(|&u| one(&ray, &f, u, c, wrong)).collect();
        if wrong.contains(&"interpolated_in_disparity") {
            t.iter_mut().for_each(|t| *t = 1.0 / *t);
        }
        if wrong.contains(&"distribution_at_u") {
            t = u.iter().map(|&u| interpolated(&ray.edges, &f, u)).collect();
        }
        if wrong.contains(&"own_bin_alone") {
            let own = |j: usize| j + 1 < f.len() && f[j] <= u[j] && u[j] < f[j + 1];
            t.iter_mut().enumerate().filter(|(j, _)| !own(*j)).for_each(|(_, t)| *t = 0.0);
        }
        if ray.weights.iter().all(|w| w + ray.padding == 0.0) {
            let end = match () {
                () if wrong.contains(&"empty_rays_at_far") => ray.edges.last(),
                () if wrong.contains(&"empty_rays_at_near") => ray.edges.first(),
                () => None,
            };
            end.into_iter().for_each(|end| t.fill(*end));
        }
        if wrong.contains(&"sorted_within") {
            t.sort_by(f64::total_cmp);
        }
        t
    })
}

/// Their gradient.
pub(crate) fn sample_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    vjp(a, c, |ray, g| {
        let (mut g_edges, mut g_u) = gradient(ray, g, c);
        if wrong.contains(&"place_detached") {
            g_u.fill(0.0);
        }
        if wrong.contains(&"edges_half_each") {
            let f = cdf(&ray.weights, ray.padding);
            g_edges.fill(0.0);
            for (&u, g) in ray.u.iter().zip(g) {
                let k = bin_of(&f, u);
                g_edges[k] += 0.5 * g;
                g_edges[k + 1] += 0.5 * g;
            }
        }
        (g_edges, g_u)
    })
}
