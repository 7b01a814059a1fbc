//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{backward, contract};
use crate::contract::arrays::{Arrays, array, arrays, threes};
use crate::convention::Conventions;

/// `f(x)` for each point, as the output.
pub(crate) fn forward(a: &Arrays, f: impl Fn([f64; 3]) -> [f64; 3]) -> Arrays {
    let points = threes(a, "x");
    arrays([("contracted", array(&[points.len(), 3], points.into_iter().flat_map(f).collect()))])
}

/// `f(x, cotangent)` for each point, as the gradient.
pub(crate) fn vjp(a: &Arrays, f: impl Fn([f64; 3], [f64; 3]) -> [f64; 3]) -> Arrays {
    let points = threes(a, "x");
    let g_x = points.iter().zip(threes(a, "grad_contracted")).flat_map(|(&x, g)| f(x, g)).collect();
    arrays([("grad_x", array(&[points.len(), 3], g_x))])
}

pub(super) fn contraction(a: &Arrays, c: &Conventions) -> Arrays {
    forward(a, |x| contract(x, c.contraction_norm, c.contraction_range))
}

pub(super) fn contraction_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    vjp(a, |x, g| backward::contract(x, g, c.contraction_norm, c.contraction_range))
}
