//! Registry row of the truncated exponential.

use super::{backward, bound, cases, honest, mistakes};
use crate::contract::component::{Arrays, Component, Pass, Port, array, arrays, values};
use crate::convention::Conventions;

/// Density from a network's last number, with a surrogate gradient.
pub const TRUNC_EXP: Component = Component {
    name: "trunc_exp",
    folder: "trunc_exp",
    formula: "sigma = e^x; the gradient is stated, not derived: grad_x = grad_sigma e^clamp(x, -15, 15)",
    source: "Instant-NGP (Mueller et al. 2022) src/testbed_nerf.cu network_to_density_derivative; torch-ngp activation.py",
    inputs: &[Port::smooth("x", "M", "what the network says about density")],
    outputs: &[Port::smooth("sigmas", "M", "densities, 1 / length")],
    conventions: &[],
    forward: Pass {
        oracle: trunc_exp,
        bound: bound::trunc_exp,
        honest: honest::trunc_exp,
        wrong: mistakes::trunc_exp,
    },
    vjp: Some(Pass {
        oracle: trunc_exp_vjp,
        bound: bound::trunc_exp_vjp,
        honest: honest::trunc_exp_vjp,
        wrong: mistakes::trunc_exp_vjp,
    }),
    cases: cases::trunc_exp,
    mistakes: mistakes::TRUNC_EXP,
};

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

fn trunc_exp(a: &Arrays, _: &Conventions) -> Arrays {
    forward(a, super::trunc_exp)
}

fn trunc_exp_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    vjp(a, backward::trunc_exp)
}
