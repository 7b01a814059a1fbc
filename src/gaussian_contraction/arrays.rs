//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{Gaussian, backward, contract_gaussian};
use crate::contract::arrays::{Arrays, array, arrays, matrices3, threes};
use crate::convention::Conventions;

/// The Gaussians of two arrays.
pub(super) fn gaussians(a: &Arrays, means: &str, covariances: &str) -> Vec<Gaussian> {
    let pairs = threes(a, means).into_iter().zip(matrices3(a, covariances));
    pairs.map(|(mean, covariance)| Gaussian { mean, covariance }).collect()
}

/// Gaussians as two arrays.
pub(super) fn named(gaussians: &[Gaussian], means: &str, covariances: &str) -> Arrays {
    let mean = gaussians.iter().flat_map(|g| g.mean).collect();
    let covariance = gaussians.iter().flat_map(|g| g.covariance).flatten().collect();
    arrays([
        (means, array(&[gaussians.len(), 3], mean)),
        (covariances, array(&[gaussians.len(), 3, 3], covariance)),
    ])
}

/// `f(Gaussian)` of each, as the outputs.
pub(crate) fn forward(a: &Arrays, f: impl Fn(&Gaussian) -> Gaussian) -> Arrays {
    let all: Vec<Gaussian> = gaussians(a, "means", "covariances").iter().map(f).collect();
    named(&all, "contracted_means", "contracted_covariances")
}

/// `f(Gaussian, cotangents)` of each, as the gradients.
pub(crate) fn vjp(a: &Arrays, f: impl Fn(&Gaussian, &Gaussian) -> Gaussian) -> Arrays {
    let cotangents = gaussians(a, "grad_contracted_means", "grad_contracted_covariances");
    let pairs = gaussians(a, "means", "covariances").into_iter().zip(cotangents);
    let all: Vec<Gaussian> = pairs.map(|(x, g)| f(&x, &g)).collect();
    named(&all, "grad_means", "grad_covariances")
}

pub(super) fn contract_gaussians(a: &Arrays, c: &Conventions) -> Arrays {
    forward(a, |x| contract_gaussian(x, c.contraction_norm, c.contraction_range))
}

pub(super) fn contract_gaussians_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    vjp(a, |x, g| backward::contract_gaussian(x, g, c.contraction_norm, c.contraction_range))
}
