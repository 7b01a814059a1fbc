//! Registry rows of the optimizers.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::arrays::number;
use crate::contract::component::{Component, Direction, Entries, Port};
use crate::contract::special::{Form, Special};

/// Optimizers that don't decay weights.
const FORMS: &[Form] = &[Form {
    without: &["weight_decay"],
    takes: None,
    meaning: "0: weights don't decay",
    holds: |a, _| number(a, "weight_decay") == 0.0,
}];

/// The inputs of both optimizers: weights decay in different places.
const fn inputs(weight_decay: &'static str) -> [Port; 10] {
    [
        Port::plain("params", "P", "parameters"),
        Port::plain("grad", "P", "gradient"),
        Port::plain("m", "P", "mean of gradients"),
        Port::plain("v", "P", "mean of squared gradients"),
        Port::plain("step", "", "number of the step, from 1").of(Entries::Count),
        Port::plain("lr", "", "learning rate"),
        Port::plain("beta1", "", "decay of m"),
        Port::plain("beta2", "", "decay of v"),
        Port::plain(
            "eps",
            "",
            "added to the root, outside of it; by convention before or after its correction",
        ),
        Port::plain("weight_decay", "", weight_decay),
    ]
}

const OUTPUTS: &[Port] = &[
    Port::plain("params_out", "P", "parameters after the step"),
    Port::plain("m_out", "P", "m'"),
    Port::plain("v_out", "P", "v'"),
];

/// One step of Adam.
pub(crate) const ADAM_STEP: Component = Component {
    name: "adam_step",
    folder: "optimizer",
    code: include_str!("honest.rs"),
    formula: "m' = b1 m + (1 - b1) g, v' = b2 v + (1 - b2) g^2, p' = p - lr m' / (1 - b1^t) / (sqrt(v' / (1 - b2^t)) + eps)",
    source: "Kingma and Ba 2015, algorithm 1; torch.optim.Adam",
    inputs: &inputs("times the parameter, added to the gradient (coupled)"),
    outputs: OUTPUTS,
    conventions: &["adam_eps", "adam_zero"],
    forward: Direction {
        oracle: arrays::adam_step,
        bound: bound::adam_step,
        honest: honest::adam_step,
        wrong: mistakes::adam_step,
    },
    vjp: None,
    cases: cases::adam_step,
    mistakes: mistakes::ADAM_STEP,
    special: Special {
        forms: FORMS,
        large: cases::large,
        laws: Some(mistakes::laws::OF_ADAM),
        ..Special::NONE
    },
};

/// One step of AdamW.
pub(crate) const ADAMW_STEP: Component = Component {
    name: "adamw_step",
    folder: "optimizer",
    code: include_str!("honest.rs"),
    formula: "Adam's step of the gradient alone, and p' = ... - lr weight_decay p, p as it was before the step",
    source: "Loshchilov and Hutter 2019, algorithm 2, with lambda = lr weight_decay; torch.optim.AdamW; optax.adamw",
    inputs: &inputs("times lr and the parameter, taken off beside the step (decoupled)"),
    outputs: OUTPUTS,
    conventions: &["adam_eps", "adam_zero"],
    forward: Direction {
        oracle: arrays::adamw_step,
        bound: bound::adamw_step,
        honest: honest::adamw_step,
        wrong: mistakes::adamw_step,
    },
    vjp: None,
    cases: cases::adamw_step,
    mistakes: mistakes::ADAMW_STEP,
    special: Special { large: cases::large_decayed, laws: Some(mistakes::laws::OF_ADAMW), ..Special::NONE },
};
