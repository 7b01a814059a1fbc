//! Importance sampling, wrong on purpose. Without a mistake every function equals the oracle.

mod catalogue;

use catalogue::{BLURRED, DENOMINATOR_EPS, EPS_AFTER_DIVISION, EPS_IN_SUM, PADDED};
pub(crate) use catalogue::{
    IMPORTANCE_SAMPLING, INTERIOR_ALONE, NO_LEADING_ZERO, NOT_NORMALIZED, NOTHING_OVER_NOTHING,
    SEARCHED_FROM_THE_LEFT,
};

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
    if wrong.contains(&"weights_of_next_bin") {
        weights.rotate_left(1);
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
    Ray { edges, weights, padding, u }
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
        let total: f64 = ray.weights.iter().map(|w| w + ray.padding).sum();
        f.iter_mut().for_each(|f| *f *= total);
    }
    if wrong.contains(&"sum_of_all_rays") {
        let total: f64 = ray.weights.iter().map(|w| w + ray.padding).sum();
        f.iter_mut().for_each(|f| *f *= total / batch);
    }
    if let Some(eps) = EPS_IN_SUM.among(wrong) {
        let total = eps + ray.weights.iter().sum::<f64>();
        let mut sum = 0.0;
        for (f, w) in f[1..].iter_mut().zip(&ray.weights) {
            sum += w / total;
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
    if wrong.contains(&"no_leading_zero") {
        f.remove(0);
        f.push(f[f.len() - 1]);
    }
    f
}

fn one(ray: &Ray, f: &[f64], u: f64, c: &Conventions, wrong: &[&str]) -> f64 {
    // Wherever it is looked for.
    if f[0].is_nan() {
        return f64::NAN;
    }
    let left = wrong.contains(&"searched_from_the_left");
    let held = wrong.contains(&"upper_edge_held_by_sample_count");
    let unlike = ["no_leading_zero", "not_normalized", "sum_of_all_rays", "last_bin_zeroed"];
    let searched =
        EPS_IN_SUM.among(wrong).is_some() || left || held || unlike.iter().any(|name| wrong.contains(name));
    let k = if searched {
        // As searchsorted does it, clamped at both ends.
        match f.iter().rposition(|&f| if left { f < u } else { f <= u }) {
            None => return ray.edges[0],
            Some(k) if k + 1 >= f.len() => return ray.edges[ray.edges.len() - 1],
            Some(k) => k,
        }
    } else {
        bin_of(f, u)
    };
    let above = if held { (k + 1).min(ray.u.len() - 1) } else { k + 1 };
    let (a, b) = (ray.edges[k], ray.edges[above]);
    if wrong.contains(&"last_bin_dropped") && k + 2 >= f.len() {
        return a;
    }
    let mut difference = f[above] - f[k];
    if let Some(faint) = c.pdf_division.faint().filter(|_| difference < SNAPPED) {
        difference = faint;
    }
    if difference == 0.0 {
        difference = 1.0;
    }
    let difference = difference + DENOMINATOR_EPS.among(wrong).unwrap_or(0.0);
    let s = match () {
        _ if wrong.contains(&"left_edge") => 0.0,
        _ if wrong.contains(&"right_edge") => 1.0,
        _ if wrong.contains(&"place_of_u") => u,
        _ if wrong.contains(&"place_mirrored") => 1.0 - (u - f[k]) / difference,
        _ if wrong.contains(&"middle_of_bin") => 0.5,
        _ => (u - f[k]) / difference,
    };
    let (first, last, bins) = (ray.edges[0], ray.edges[ray.edges.len() - 1], ray.weights.len() as f64);
    match () {
        () if wrong.contains(&"bin_width_forgotten") => a + s,
        () if wrong.contains(&"bins_taken_as_even") => first + (k as f64 + s) / bins * (last - first),
        () => a + s * (b - a),
    }
}

/// Samples.
pub(crate) fn sample(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let shared = super::arrays::ray(a, 0, c).u;
    let whole = |ray: Ray| ray.weights.iter().map(|w| w + ray.padding).sum::<f64>();
    let batch: f64 = (0..size(a, "weights").0).map(|r| whole(super::arrays::ray(a, r, c))).sum();
    forward(a, c, |ray| {
        let ray = changed(ray, wrong);
        let f = cdf_of(&ray, batch, wrong);
        let shared = if wrong.contains(&"strata_doubled") { doubled(&shared) } else { shared.clone() };
        let u = if wrong.contains(&"one_u_for_all_rays") { &shared } else { &ray.u };
        let mut t: Vec<f64> = u.iter().map(|&u| one(&ray, &f, u, c, wrong)).collect();
        if wrong.contains(&"own_bin_alone") {
            let own = |j: usize| j + 1 < f.len() && f[j] <= u[j] && u[j] < f[j + 1];
            t.iter_mut().enumerate().filter(|(j, _)| !own(*j)).for_each(|(_, t)| *t = 0.0);
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
