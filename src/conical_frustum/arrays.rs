//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{Frustum, Gaussian, backward, conical_frustum as oracle};
use crate::contract::arrays::{Arrays, array, arrays, threes, values};
use crate::convention::Conventions;

/// The frustums of a case.
pub(crate) fn frustums(a: &Arrays) -> Vec<Frustum> {
    let (origins, directions) = (threes(a, "origins"), threes(a, "directions"));
    let [radii, starts, ends] = ["radii", "starts", "ends"].map(|name| values(a, name));
    let one = |n: usize| Frustum {
        origin: origins[n],
        direction: directions[n],
        radius: radii[n],
        start: starts[n],
        end: ends[n],
    };
    (0..origins.len()).map(one).collect()
}

/// The cotangents of a case.
pub(crate) fn cotangents(a: &Arrays) -> Vec<Gaussian> {
    let [t_mean, t_variance, r_variance] =
        ["t_mean", "t_variance", "r_variance"].map(|name| values(a, &format!("grad_{name}")));
    let (means, variances) = (threes(a, "grad_means"), threes(a, "grad_variances"));
    let one = |n: usize| Gaussian {
        t_mean: t_mean[n],
        t_variance: t_variance[n],
        r_variance: r_variance[n],
        mean: means[n],
        variance: variances[n],
    };
    (0..means.len()).map(one).collect()
}

/// Gaussians as the outputs.
pub(crate) fn forward(gaussians: &[Gaussian]) -> Arrays {
    let numbers = |f: fn(&Gaussian) -> f64| array(&[gaussians.len()], gaussians.iter().map(f).collect());
    let vectors =
        |f: fn(&Gaussian) -> [f64; 3]| array(&[gaussians.len(), 3], gaussians.iter().flat_map(f).collect());
    arrays([
        ("t_mean", numbers(|g| g.t_mean)),
        ("t_variance", numbers(|g| g.t_variance)),
        ("r_variance", numbers(|g| g.r_variance)),
        ("means", vectors(|g| g.mean)),
        ("variances", vectors(|g| g.variance)),
    ])
}

/// Frustums of gradients as the outputs.
pub(crate) fn vjp(gradients: &[Frustum]) -> Arrays {
    let numbers = |f: fn(&Frustum) -> f64| array(&[gradients.len()], gradients.iter().map(f).collect());
    let vectors =
        |f: fn(&Frustum) -> [f64; 3]| array(&[gradients.len(), 3], gradients.iter().flat_map(f).collect());
    arrays([
        ("grad_origins", vectors(|g| g.origin)),
        ("grad_directions", vectors(|g| g.direction)),
        ("grad_radii", numbers(|g| g.radius)),
        ("grad_starts", numbers(|g| g.start)),
        ("grad_ends", numbers(|g| g.end)),
    ])
}

pub(super) fn conical_frustum(a: &Arrays, c: &Conventions) -> Arrays {
    forward(&frustums(a).iter().map(|f| oracle(f, c.ray_shape)).collect::<Vec<_>>())
}

pub(super) fn conical_frustum_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let pairs = frustums(a).into_iter().zip(cotangents(a));
    vjp(&pairs.map(|(f, g)| backward::conical_frustum(&f, c.ray_shape, &g)).collect::<Vec<_>>())
}
