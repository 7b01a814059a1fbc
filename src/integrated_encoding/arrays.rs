//! The oracle of this folder on named arrays, and what turns these into its types and back.

use ndarray::Ix2;

use super::backward;
use crate::contract::arrays::{Arrays, arrays, from_rows, input, number, rows};
use crate::convention::Conventions;
use crate::encoding::Encoding;

/// The encoding that the scalar `L` asks for.
pub(crate) fn settings(a: &Arrays, c: &Conventions) -> Encoding {
    Encoding { identity: c.integrated_identity, ..Encoding::new(number(a, "L") as usize, c) }
}

/// D of `means`.
pub(crate) fn dims(a: &Arrays) -> usize {
    input(a, "means").view().into_dimensionality::<Ix2>().expect("means are (M, D)").ncols()
}

/// Whether a cotangent is as wide as these conventions make the encoding.
pub(super) fn admits(a: &Arrays, c: &Conventions) -> bool {
    a.get("grad_encoding").is_none_or(|g| g.shape()[1] == settings(a, c).width(dims(a)))
}

/// `f(means, variances)` of each Gaussian, as the output.
pub(crate) fn forward(a: &Arrays, c: &Conventions, f: impl Fn(&[f64], &[f64]) -> Vec<f64>) -> Arrays {
    let (means, variances) = (rows(a, "means"), rows(a, "variances"));
    let out: Vec<Vec<f64>> = means.iter().zip(&variances).map(|(x, v)| f(x, v)).collect();
    arrays([("encoding", from_rows(&out, settings(a, c).width(dims(a))))])
}

/// `f(means, variances, cotangent)` of each Gaussian, as the gradients.
pub(crate) fn vjp(a: &Arrays, f: impl Fn(&[f64], &[f64], &[f64]) -> (Vec<f64>, Vec<f64>)) -> Arrays {
    let [means, variances, g] = ["means", "variances", "grad_encoding"].map(|name| rows(a, name));
    let one = |n: usize| f(&means[n], &variances[n], &g[n]);
    let (g_means, g_variances): (Vec<_>, Vec<_>) = (0..means.len()).map(one).unzip();
    arrays([
        ("grad_means", from_rows(&g_means, dims(a))),
        ("grad_variances", from_rows(&g_variances, dims(a))),
    ])
}

pub(super) fn integrated_encoding(a: &Arrays, c: &Conventions) -> Arrays {
    forward(a, c, |x, v| super::integrated_encoding(x, v, &settings(a, c)))
}

pub(super) fn integrated_encoding_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    vjp(a, |x, v, g| backward::integrated_encoding(x, v, &settings(a, c), g))
}
