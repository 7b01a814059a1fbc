//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::backward;
use crate::contract::arrays::{Arrays, array, arrays, number, row, size};
use crate::convention::Conventions;

/// What belongs to one ray.
pub(crate) struct Ray {
    /// e, (N + 1).
    pub edges: Vec<f64>,
    /// w, (N).
    pub weights: Vec<f64>,
    /// Added to each weight.
    pub padding: f64,
    /// (M).
    pub u: Vec<f64>,
}

/// Ray r of the arrays.
pub(crate) fn ray(a: &Arrays, r: usize, c: &Conventions) -> Ray {
    Ray {
        edges: row(a, "edges", r),
        weights: row(a, "weights", r),
        padding: c.pdf_padding.value(number(a, "padding")),
        u: row(a, "u", r),
    }
}

/// `f(ray)`, its samples or how far off they may be, as the output.
pub(crate) fn forward(a: &Arrays, c: &Conventions, f: impl Fn(&Ray) -> Vec<f64>) -> Arrays {
    let (rays, samples) = size(a, "u");
    arrays([("t", array(&[rays, samples], (0..rays).flat_map(|r| f(&ray(a, r, c))).collect()))])
}

/// `f(ray, cotangent)`, gradients of edges and u, as the gradient.
pub(crate) fn vjp(a: &Arrays, c: &Conventions, f: impl Fn(&Ray, &[f64]) -> (Vec<f64>, Vec<f64>)) -> Arrays {
    let (rays, samples) = size(a, "u");
    let (mut edges, mut u) = (vec![], vec![]);
    for r in 0..rays {
        let (g_edges, g_u) = f(&ray(a, r, c), &row(a, "grad_t", r));
        edges.extend(g_edges);
        u.extend(g_u);
    }
    let width = size(a, "edges").1;
    arrays([("grad_edges", array(&[rays, width], edges)), ("grad_u", array(&[rays, samples], u))])
}

pub(super) fn sample(a: &Arrays, c: &Conventions) -> Arrays {
    forward(a, c, |ray| drawn(ray, c))
}

/// One ray's samples.
pub(super) fn drawn(ray: &Ray, c: &Conventions) -> Vec<f64> {
    match c.pdf_division.faint() {
        None => super::sample(&ray.edges, &ray.weights, ray.padding, &ray.u),
        Some(faint) => super::sample_snapped(&ray.edges, &ray.weights, ray.padding, &ray.u, faint),
    }
}

pub(super) fn sample_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    vjp(a, c, |ray, g| gradient(ray, g, c))
}

/// The gradient of one ray's samples.
pub(super) fn gradient(ray: &Ray, g: &[f64], c: &Conventions) -> (Vec<f64>, Vec<f64>) {
    match c.pdf_division.faint() {
        None => backward::sample(&ray.edges, &ray.weights, ray.padding, &ray.u, g),
        Some(faint) => backward::sample_snapped(&ray.edges, &ray.weights, ray.padding, &ray.u, g, faint),
    }
}
