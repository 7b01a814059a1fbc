//! The registry row of the training step.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::arrays::number;
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::{Form, Special};

/// The conventions that each output depends on; the others depend on all.
const READS: &[(&str, &[&str])] = &[
    ("t", &["grid"]),
    ("deltas", &["grid", "delta", "last_delta"]),
    ("colors", &["grid", "delta", "last_delta", "frequency", "density", "skip_layer", "skip_order"]),
    ("grad", &["grid", "delta", "last_delta", "frequency", "density", "skip_layer", "skip_order"]),
];

/// Optimizers that don't decay weights.
const FORMS: &[Form] = &[Form {
    without: &["weight_decay"],
    takes: None,
    meaning: "0: weights don't decay",
    holds: |a, _| number(a, "weight_decay") == 0.0,
}];

/// The whole way from parameters to better ones.
pub(crate) const TRAINING_STEP: Component = Component {
    name: "training_step",
    folder: "training_step",
    code: include_str!("honest.rs"),
    formula: "C = volume_render(nerf_mlp(o + t d)), loss = mean (C - target)^2, its gradient, adam_step; S steps, each with rays, draws and a rate of its own",
    source: "NeRF (Mildenhall et al. 2020) sections 4 and 5.3; torch.optim.Adam",
    inputs: &PORTS,
    outputs: &[
        Port::plain("t", "R,N", "sample positions of the first step"),
        Port::plain("deltas", "R,N", "its step lengths"),
        Port::plain("colors", "R,3", "its colors, over nothing"),
        Port::plain("losses", "S", "mean squared error before each step"),
        Port::plain(
            "grad",
            "P",
            "gradient of the first loss: trunk0_w row by row, trunk0_b, trunk1_w, ..., sigma, feature, color0, color1",
        ),
        Port::plain("params_1", "P", "parameters after the first step, in the same order"),
        Port::plain("m_1", "P", "Adam's mean of gradients after the first step"),
        Port::plain("v_1", "P", "Adam's mean of squared gradients after the first step"),
        Port::plain("params_last", "P", "parameters after the last step"),
        Port::plain("m_last", "P", "mean of gradients after the last step"),
        Port::plain("v_last", "P", "mean of squared gradients after the last step"),
    ],
    conventions: &[
        "grid",
        "delta",
        "last_delta",
        "frequency",
        "density",
        "skip_layer",
        "skip_order",
        "adam_eps",
    ],
    forward: Direction {
        oracle: arrays::training_step,
        bound: bound::training_step,
        honest: honest::training_step,
        wrong: mistakes::training_step,
    },
    vjp: None,
    cases: cases::training_step,
    mistakes: mistakes::TRAINING_STEP,
    special: Special {
        reads: READS,
        untouched: &["t", "deltas", "colors"],
        reshape: cases::reshape,
        admits: cases::admits,
        forms: FORMS,
        ..Special::NONE
    },
};

const fn w(name: &'static str) -> Port {
    Port::plain(name, "out,in", "weights")
}

const fn b(name: &'static str) -> Port {
    Port::plain(name, "out", "biases")
}

const PORTS: [Port; 36] = [
    Port::plain("rays_o", "S,R,3", "origins of each step's rays"),
    Port::plain("rays_d", "S,R,3", "directions, along which t runs"),
    Port::plain("directions", "S,R,3", "viewing directions, as the field is given them"),
    Port::plain("u", "S,R,N", "numbers in [0, 1), one for every sample"),
    Port::plain("target", "S,R,3", "the photographs' colors"),
    Port::plain("near", "", "where rays begin"),
    Port::plain("far", "", "where rays end"),
    Port::plain("lr", "S", "learning rate of each step"),
    Port::plain("beta1", "", "decay of m"),
    Port::plain("beta2", "", "decay of v"),
    Port::plain("eps", "", "added to the root, outside of it; by convention before or after its correction"),
    Port::plain("weight_decay", "", "times the parameter, added to the gradient (coupled)"),
    w("trunk0_w"),
    b("trunk0_b"),
    w("trunk1_w"),
    b("trunk1_b"),
    w("trunk2_w"),
    b("trunk2_b"),
    w("trunk3_w"),
    b("trunk3_b"),
    w("trunk4_w"),
    b("trunk4_b"),
    w("trunk5_w"),
    b("trunk5_b"),
    w("trunk6_w"),
    b("trunk6_b"),
    w("trunk7_w"),
    b("trunk7_b"),
    w("sigma_w"),
    b("sigma_b"),
    w("feature_w"),
    b("feature_b"),
    w("color0_w"),
    b("color0_b"),
    w("color1_w"),
    b("color1_b"),
];
