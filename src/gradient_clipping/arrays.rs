//! The oracle of this folder on named arrays, and what turns these into its types and back.

use crate::contract::arrays::{Arrays, array, arrays, input, number, scalar, values};
use crate::convention::Conventions;

/// The gradients of a layer.
pub(crate) fn tensors(a: &Arrays) -> [Vec<f64>; 2] {
    ["g_weights", "g_bias"].map(|name| values(a, name))
}

/// What is left of them, and the norm.
pub(crate) fn by_norm(a: &Arrays, [weights, bias]: [Vec<f64>; 2], norm: f64) -> Arrays {
    arrays([
        ("g_weights_out", array(input(a, "g_weights").shape(), weights)),
        ("g_bias_out", array(input(a, "g_bias").shape(), bias)),
        ("norm", scalar(norm)),
    ])
}

/// Each number by itself.
pub(crate) fn by_value(a: &Arrays, clip: impl Fn(f64) -> f64) -> Arrays {
    arrays([("g_out", input(a, "g").mapv(clip))])
}

pub(super) fn clip_by_global_norm(a: &Arrays, c: &Conventions) -> Arrays {
    let [weights, bias] = tensors(a);
    let (mut clipped, norm) =
        super::clip_by_global_norm(&[&weights, &bias], number(a, "max_norm"), c.clip_eps);
    let bias = clipped.remove(1);
    by_norm(a, [clipped.remove(0), bias], norm)
}

pub(super) fn clip_by_value(a: &Arrays, _: &Conventions) -> Arrays {
    let limit = number(a, "limit");
    by_value(a, |g| super::clip_by_value(g, limit))
}
