//! Registry row of importance sampling.

use super::{backward, bound, cases, honest, mistakes};
use crate::contract::component::{Arrays, Component, Pass, Port, array, arrays, number};
use crate::convention::Conventions;
use crate::volume_rendering::component::{row, size};

/// Samples of a piecewise-constant distribution.
pub const IMPORTANCE_SAMPLING: Component = Component {
    name: "importance_sampling",
    folder: "importance_sampling",
    formula: "F_k = sum_{j<k} (w_j + padding) / sum_j (w_j + padding), t = e_k + (u - F_k) / (F_{k+1} - F_k) (e_{k+1} - e_k)",
    source: "NeRF (Mildenhall et al. 2020) section 5.2",
    inputs: &[
        Port::smooth("edges", "R,E", "edges of the N = E - 1 bins of a ray, ascending"),
        Port::plain("weights", "R,N", "weights of the bins, not normalized; detached, as in the paper"),
        Port::plain("padding", "", "added to every weight; 0 as in the paper, 1e-5 as in its code"),
        Port::smooth("u", "R,M", "numbers in [0, 1], in any order"),
    ],
    outputs: &[Port::smooth("t", "R,M", "samples, in the order of u")],
    conventions: &[],
    forward: Pass { oracle: sample, bound: bound::sample, honest: honest::sample, wrong: mistakes::sample },
    vjp: Some(Pass {
        oracle: sample_vjp,
        bound: bound::sample_vjp,
        honest: honest::sample_vjp,
        wrong: mistakes::sample_vjp,
    }),
    cases: cases::importance_sampling,
    mistakes: mistakes::IMPORTANCE_SAMPLING,
};

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
pub(crate) fn ray(a: &Arrays, r: usize) -> Ray {
    Ray {
        edges: row(a, "edges", r),
        weights: row(a, "weights", r),
        padding: number(a, "padding"),
        u: row(a, "u", r),
    }
}

/// `f(ray)`, its samples or how far off they may be, as the output.
pub(crate) fn forward(a: &Arrays, f: impl Fn(&Ray) -> Vec<f64>) -> Arrays {
    let (rays, samples) = size(a, "u");
    arrays([("t", array(&[rays, samples], (0..rays).flat_map(|r| f(&ray(a, r))).collect()))])
}

/// `f(ray, cotangent)`, gradients of edges and u, as the gradient.
pub(crate) fn vjp(a: &Arrays, f: impl Fn(&Ray, &[f64]) -> (Vec<f64>, Vec<f64>)) -> Arrays {
    let (rays, samples) = size(a, "u");
    let (mut edges, mut u) = (vec![], vec![]);
    for r in 0..rays {
        let (g_edges, g_u) = f(&ray(a, r), &row(a, "grad_t", r));
        edges.extend(g_edges);
        u.extend(g_u);
    }
    let width = size(a, "edges").1;
    arrays([("grad_edges", array(&[rays, width], edges)), ("grad_u", array(&[rays, samples], u))])
}

fn sample(a: &Arrays, _: &Conventions) -> Arrays {
    forward(a, |ray| super::sample(&ray.edges, &ray.weights, ray.padding, &ray.u))
}

fn sample_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    vjp(a, |ray, g| backward::sample(&ray.edges, &ray.weights, ray.padding, &ray.u, g))
}
