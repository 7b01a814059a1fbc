//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::backward;
use crate::contract::arrays::{Arrays, array, arrays, values};
use crate::convention::Conventions;

/// `f(x)` for each number, as the output.
pub(crate) fn forward(a: &Arrays, f: impl Fn(f64) -> f64) -> Arrays {
    let sigmas: Vec<f64> = values(a, "x").into_iter().map(f).collect();
    arrays([("sigmas", array(&[sigmas.len()], sigmas))])
}

/// `f(x, cotangent)` for each number, as the gradient.
pub(crate) fn vjp(a: &Arrays, f: impl Fn(f64, f64) -> f64) -> Arrays {
    let g_x: Vec<f64> =
        values(a, "x").into_iter().zip(values(a, "grad_sigmas")).map(|(x, g)| f(x, g)).collect();
    arrays([("grad_x", array(&[g_x.len()], g_x))])
}

pub(super) fn trunc_exp(a: &Arrays, c: &Conventions) -> Arrays {
    forward(a, |x| super::density(x, c.exponent, c.exponent_shift))
}

pub(super) fn trunc_exp_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    vjp(a, |x, g| backward::trunc_exp(x, g, c.exponent_gradient, c.exponent_shift))
}
