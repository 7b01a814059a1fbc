//! Registry row of the optimizer.

use super::{Adam, Moments, bound, cases, honest, mistakes};
use crate::contract::component::{Arrays, Component, Pass, Port, array, arrays, input, number, values};
use crate::convention::Conventions;

/// One step of Adam.
pub const ADAM_STEP: Component = Component {
    name: "adam_step",
    folder: "optimizer",
    formula: "m' = b1 m + (1 - b1) g, v' = b2 v + (1 - b2) g^2, p' = p - lr m' / (1 - b1^t) / (sqrt(v' / (1 - b2^t)) + eps)",
    source: "Kingma and Ba 2015, algorithm 1; torch.optim.Adam",
    inputs: &[
        Port::plain("params", "P", "parameters"),
        Port::plain("grad", "P", "gradient"),
        Port::plain("m", "P", "mean of gradients"),
        Port::plain("v", "P", "mean of squared gradients"),
        Port::plain("step", "", "number of the step, from 1"),
        Port::plain("lr", "", "learning rate"),
        Port::plain("beta1", "", "decay of m"),
        Port::plain("beta2", "", "decay of v"),
        Port::plain("eps", "", "added to the root, outside of it"),
        Port::plain("weight_decay", "", "times the parameter, added to the gradient (coupled)"),
    ],
    outputs: &[
        Port::plain("params_out", "P", "parameters after the step"),
        Port::plain("m_out", "P", "m'"),
        Port::plain("v_out", "P", "v'"),
    ],
    conventions: &[],
    forward: Pass {
        oracle: adam_step,
        bound: bound::adam_step,
        honest: honest::adam_step,
        wrong: mistakes::adam_step,
    },
    vjp: None,
    cases: cases::adam_step,
    mistakes: mistakes::ADAM_STEP,
};

/// The hyper-parameters and the number of the step.
pub(crate) fn settings(a: &Arrays) -> (Adam, u64) {
    let adam = Adam {
        lr: number(a, "lr"),
        beta1: number(a, "beta1"),
        beta2: number(a, "beta2"),
        eps: number(a, "eps"),
        weight_decay: number(a, "weight_decay"),
    };
    (adam, number(a, "step") as u64)
}

/// Applies `step` to each parameter: (before, gradient) -> after.
pub(crate) fn each(a: &Arrays, step: impl Fn(Moments, f64) -> Moments) -> Arrays {
    let (params, m, v) = (values(a, "params"), values(a, "m"), values(a, "v"));
    let grad = values(a, "grad");
    let after: Vec<Moments> =
        (0..params.len()).map(|i| step(Moments { param: params[i], m: m[i], v: v[i] }, grad[i])).collect();
    let output = |f: fn(&Moments) -> f64| array(input(a, "params").shape(), after.iter().map(f).collect());
    arrays([
        ("params_out", output(|after| after.param)),
        ("m_out", output(|after| after.m)),
        ("v_out", output(|after| after.v)),
    ])
}

fn adam_step(a: &Arrays, _: &Conventions) -> Arrays {
    let (adam, step) = settings(a);
    each(a, |before, grad| super::adam_step(&adam, before, grad, step))
}
