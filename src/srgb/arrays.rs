//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::backward;
use crate::contract::arrays::{Arrays, array, arrays, values};
use crate::convention::Conventions;

/// `f(x)` for each number, as the output.
pub(crate) fn forward(a: &Arrays, f: impl Fn(f64) -> f64) -> Arrays {
    let srgb: Vec<f64> = values(a, "linear").into_iter().map(f).collect();
    arrays([("srgb", array(&[srgb.len()], srgb))])
}

/// `f(x, cotangent)` for each number, as the gradient.
pub(crate) fn vjp(a: &Arrays, f: impl Fn(f64, f64) -> f64) -> Arrays {
    let g_linear: Vec<f64> =
        values(a, "linear").into_iter().zip(values(a, "grad_srgb")).map(|(x, g)| f(x, g)).collect();
    arrays([("grad_linear", array(&[g_linear.len()], g_linear))])
}

pub(super) fn linear_to_srgb(a: &Arrays, _: &Conventions) -> Arrays {
    forward(a, super::linear_to_srgb)
}

pub(super) fn linear_to_srgb_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    vjp(a, backward::linear_to_srgb)
}
