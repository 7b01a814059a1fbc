//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::backward;
use crate::contract::arrays::{Arrays, array, arrays, row, size, values};
use crate::convention::Conventions;

/// `f(weights, t)` of each ray, as the output.
pub(crate) fn forward(a: &Arrays, f: impl Fn(&[f64], &[f64]) -> f64) -> Arrays {
    let (rays, _) = size(a, "weights");
    let loss = (0..rays).map(|r| f(&row(a, "weights", r), &row(a, "t", r))).collect();
    arrays([("loss", array(&[rays], loss))])
}

/// `f(weights, t, cotangent)` of each ray, as the gradients.
pub(crate) fn vjp(a: &Arrays, f: impl Fn(&[f64], &[f64], f64) -> (Vec<f64>, Vec<f64>)) -> Arrays {
    let (rays, samples) = size(a, "weights");
    let g = values(a, "grad_loss");
    let ray = |r: usize| f(&row(a, "weights", r), &row(a, "t", r), g[r]);
    let (g_weights, g_t): (Vec<_>, Vec<_>) = (0..rays).map(ray).unzip();
    arrays([
        ("grad_weights", array(&[rays, samples], g_weights.concat())),
        ("grad_t", array(&[rays, samples + 1], g_t.concat())),
    ])
}

pub(super) fn distortion(a: &Arrays, _: &Conventions) -> Arrays {
    forward(a, super::distortion)
}

pub(super) fn distortion_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    vjp(a, backward::distortion)
}
