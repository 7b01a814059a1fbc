//! Registry row of the truncated exponential.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// Density from a network's last number, with a surrogate gradient.
pub(crate) const TRUNC_EXP: Component = Component {
    name: "trunc_exp",
    folder: "trunc_exp",
    code: include_str!("honest.rs"),
    formula: "sigma = e^x, or e^clamp(x, -15, 15) by convention; the gradient is stated, not derived: grad_x = grad_sigma e^clamp(x, -15, 15), by convention e^min(x, 15)",
    source: "Instant-NGP (Mueller et al. 2022) src/testbed_nerf.cu network_to_density_derivative; torch-ngp activation.py",
    inputs: &[Port::smooth("x", "M", "what the network says about density")],
    outputs: &[Port::smooth("sigmas", "M", "densities, 1 / length")],
    conventions: &["exponent", "exponent_gradient", "exponent_shift"],
    forward: Direction {
        oracle: arrays::trunc_exp,
        bound: bound::trunc_exp,
        honest: honest::trunc_exp,
        wrong: mistakes::trunc_exp,
    },
    vjp: Some(Direction {
        oracle: arrays::trunc_exp_vjp,
        bound: bound::trunc_exp_vjp,
        honest: honest::trunc_exp_vjp,
        wrong: mistakes::trunc_exp_vjp,
    }),
    cases: cases::trunc_exp,
    mistakes: mistakes::TRUNC_EXP,
    special: Special { large: cases::large, ..Special::NONE },
};
