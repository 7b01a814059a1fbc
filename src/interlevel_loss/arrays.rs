//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{Form, Histogram, backward};
use crate::contract::arrays::{Arrays, array, arrays, number, row, size, values};
use crate::convention::Conventions;

/// How the loss is taken.
pub(crate) fn form(a: &Arrays, c: &Conventions) -> Form {
    let eps = c.interlevel_eps.value(number(a, "eps"));
    Form { eps, edges: c.outer_edges, reduction: c.interlevel_reduction }
}

/// `f(fine, proposal)` of each ray, as the output.
pub(crate) fn forward(a: &Arrays, f: impl Fn(Histogram, Histogram) -> f64) -> Arrays {
    let (rays, _) = size(a, "weights");
    let one = |r: usize| {
        let [weights, t, v, s] = histograms(a, r);
        f(Histogram { weights: &weights, t: &t }, Histogram { weights: &v, t: &s })
    };
    arrays([("loss", array(&[rays], (0..rays).map(one).collect()))])
}

/// `f(fine, proposal, cotangent)` of each ray, as the gradient.
pub(crate) fn vjp(a: &Arrays, f: impl Fn(Histogram, Histogram, f64) -> Vec<f64>) -> Arrays {
    let ((rays, intervals), g) = (size(a, "proposal_weights"), values(a, "grad_loss"));
    let one = |r: usize| {
        let [weights, t, v, s] = histograms(a, r);
        f(Histogram { weights: &weights, t: &t }, Histogram { weights: &v, t: &s }, g[r])
    };
    let gradients: Vec<Vec<f64>> = (0..rays).map(one).collect();
    arrays([("grad_proposal_weights", array(&[rays, intervals], gradients.concat()))])
}

/// Weights and edges of a ray, and those of its proposal.
fn histograms(a: &Arrays, r: usize) -> [Vec<f64>; 4] {
    ["weights", "t", "proposal_weights", "proposal_t"].map(|name| row(a, name, r))
}

pub(super) fn interlevel(a: &Arrays, c: &Conventions) -> Arrays {
    forward(a, |fine, proposal| super::interlevel(fine, proposal, form(a, c)))
}

pub(super) fn interlevel_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    vjp(a, |fine, proposal, g| backward::interlevel(fine, proposal, form(a, c), g))
}
