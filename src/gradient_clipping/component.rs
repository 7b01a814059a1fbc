//! Registry rows of clipped gradients.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// By the common norm.
pub(crate) const CLIP_BY_GLOBAL_NORM: Component = Component {
    name: "clip_by_global_norm",
    folder: "gradient_clipping",
    code: include_str!("honest.rs"),
    formula: "g min(1, max_norm / norm), norm = sqrt(sum of g^2 over all tensors)",
    source: "Pascanu et al. 2013, algorithm 1; torch.nn.utils.clip_grad_norm_; optax.clip_by_global_norm",
    inputs: &[
        Port::plain("g_weights", "N,M", "gradient of a layer's weights"),
        Port::plain("g_bias", "N", "gradient of its bias"),
        Port::plain("max_norm", "", "the longest that both together may be"),
    ],
    outputs: &[
        Port::plain("g_weights_out", "N,M", "what is left of the weights' gradient"),
        Port::plain("g_bias_out", "N", "what is left of the bias' gradient"),
        Port::plain("norm", "", "the norm of both before they are clipped"),
    ],
    conventions: &["clip_eps"],
    forward: Direction {
        oracle: arrays::clip_by_global_norm,
        bound: bound::clip_by_global_norm,
        honest: honest::clip_by_global_norm,
        wrong: mistakes::clip_by_global_norm,
    },
    vjp: None,
    cases: cases::clip_by_global_norm,
    mistakes: mistakes::CLIP_BY_GLOBAL_NORM,
    special: Special {
        reads: &[("norm", &[])],
        large: cases::large_by_norm,
        laws: Some(mistakes::laws::OF_NORMS),
        ..Special::NONE
    },
};

/// By value.
pub(crate) const CLIP_BY_VALUE: Component = Component {
    name: "clip_by_value",
    folder: "gradient_clipping",
    code: include_str!("honest.rs"),
    formula: "min(max(g, -limit), limit)",
    source: "torch.nn.utils.clip_grad_value_; optax.clip",
    inputs: &[
        Port::plain("g", "...", "a gradient"),
        Port::plain("limit", "", "the largest size of a number in it"),
    ],
    outputs: &[Port::plain("g_out", "...", "what is left of it")],
    conventions: &[],
    forward: Direction {
        oracle: arrays::clip_by_value,
        bound: bound::clip_by_value,
        honest: honest::clip_by_value,
        wrong: mistakes::clip_by_value,
    },
    vjp: None,
    cases: cases::clip_by_value,
    mistakes: mistakes::CLIP_BY_VALUE,
    special: Special { large: cases::large_by_value, ..Special::NONE },
};
