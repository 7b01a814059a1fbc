//! Adam's and AdamW's steps, wrong on purpose. Without a mistake they equal the oracle.

use super::arrays::{self, each, settings};
use super::{Moments, adam_step as oracle, bias_correction, eps};
use crate::contract::arrays::{Arrays, scalar, values};
use crate::contract::component::Mistake;
use crate::convention::Conventions;

const NO_BIAS_CORRECTION: Mistake = Mistake::new(
    "no_bias_correction",
    "m and v are used as they are",
    "the first steps are about 3 times too long (0.1 / sqrt(0.001))",
    "divide by 1 - beta^step",
    "hand-written optimizers",
    0,
);

const EPS_INSIDE_ROOT: Mistake = Mistake::new(
    "eps_inside_root",
    "sqrt(v + eps)",
    "small gradients take steps that are far too short: eps acts as its root, 1e-4",
    "sqrt(v) + eps",
    "hand-written optimizers",
    0,
);

const STEP_FROM_ZERO: Mistake = Mistake::new(
    "step_from_zero",
    "the corrections use step - 1 (with the first clamped to 1)",
    "early steps too long",
    "count steps from 1",
    "hand-written optimizers",
    0,
);

/// Mistakes of Adam.
pub(crate) const ADAM_STEP: &[Mistake] = &[
    NO_BIAS_CORRECTION,
    EPS_INSIDE_ROOT,
    Mistake::new(
        "decoupled_decay",
        "p is shrunk by lr * weight_decay (AdamW) where the penalty belongs to the gradient",
        "another optimizer: the decay isn't scaled by the root",
        "add weight_decay * p to the gradient, or compare with AdamW",
        "hand-written optimizers",
        0,
    ),
    STEP_FROM_ZERO,
    Mistake::new(
        "corrected_as_in_first_step",
        "1 - beta for 1 - beta^step in every step",
        "steps that grow up to 10 times too long (and 1 / sqrt(1000) of it): the corrections never fade",
        "raise beta to the number of the step",
        "a teaching library",
        1,
    ),
    Mistake::new(
        "corrected_twice",
        "corrected moments, and sqrt(1 - beta2^step) / (1 - beta1^step) in the rate besides",
        "first steps wrong by that factor",
        "either of the two",
        "an algorithm collection in Python",
        1,
    ),
];

/// Mistakes of AdamW.
pub(crate) const ADAMW_STEP: &[Mistake] = &[
    Mistake::new(
        "coupled_decay",
        "weight_decay p is added to the gradient: Adam with an L2 penalty",
        "another optimizer: weights with large gradients hardly decay",
        "take lr weight_decay p off the parameter; torch: AdamW, not Adam(weight_decay=...)",
        "torch.optim.Adam with a weight_decay that was meant for AdamW",
        1,
    ),
    Mistake::new(
        "decay_without_rate",
        "weight_decay p, not times lr",
        "a thousand times the decay: weights vanish within some hundred steps",
        "lr weight_decay p",
        "the paper's lambda, which isn't times its alpha, taken for PyTorch's",
        0,
    ),
    Mistake::new(
        "decay_of_new_parameter",
        "(1 - lr weight_decay) (p - step): what the step has made decays",
        "steps that are shorter by that factor: nothing shows",
        "the parameter before the step: decay first",
        "hand-written optimizers",
        0,
    ),
    Mistake::new(
        "decay_corrected",
        "lr weight_decay p / (1 - beta1^step): with the step size of the first mean",
        "ten times the decay in the first step",
        "lr as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "decay_under_the_root",
        "lr (m' + weight_decay p) / (sqrt(v') + eps)",
        "weights with large gradients hardly decay, though the means don't know of it",
        "the decay beside the quotient",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "decay_negated",
        "(1 + lr weight_decay) p",
        "weights grow without bounds",
        "(1 - lr weight_decay) p",
        "never; cheap to keep",
        0,
    ),
    NO_BIAS_CORRECTION,
    EPS_INSIDE_ROOT,
    STEP_FROM_ZERO,
];

/// AdamW's step: what is wrong with Adam's own, and what is wrong with the decay.
pub(crate) fn adamw_step(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if wrong.is_empty() {
        return arrays::adamw_step(a, c);
    }
    let (adam, step) = settings(a);
    let is = |name: &str| wrong.contains(&name);
    let (lr, decay) = (adam.lr, adam.weight_decay);
    if is("coupled_decay") {
        return adam_step(a, c, wrong);
    }
    let mut alone = a.clone();
    alone.insert("weight_decay".into(), scalar(0.0));
    let mut out = adam_step(&alone, c, wrong);
    let (before, m, v) = (values(a, "params"), values(&out, "m_out"), values(&out, "v_out"));
    let (correction1, correction2) = (bias_correction(adam.beta1, step), bias_correction(adam.beta2, step));
    let eps = eps(&adam, step, c.adam_eps);
    for (i, param) in out.get_mut("params_out").expect("an output").iter_mut().enumerate() {
        let p = before[i];
        match () {
            () if is("decay_without_rate") => *param -= decay * p,
            () if is("decay_of_new_parameter") => *param -= lr * decay * *param,
            () if is("decay_corrected") => *param -= lr * decay * p / correction1,
            () if is("decay_negated") => *param += lr * decay * p,
            () if is("decay_under_the_root") => {
                let root = (v[i] / correction2).sqrt() + eps;
                *param = p - lr * (m[i] / correction1 + decay * p) / root;
            }
            () => *param -= lr * decay * p,
        }
    }
    out
}

/// Adam's step.
pub(crate) fn adam_step(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (mut adam, mut step) = settings(a);
    let is = |name: &str| wrong.contains(&name);
    if is("step_from_zero") {
        step = (step - 1).max(1);
    }
    let decay = adam.weight_decay;
    if is("decoupled_decay") {
        adam.weight_decay = 0.0;
    }
    adam.eps = eps(&adam, step, c.adam_eps);
    let correction = |beta: f64| match () {
        () if is("no_bias_correction") => 1.0,
        () if is("corrected_as_in_first_step") => 1.0 - beta,
        () => bias_correction(beta, step),
    };
    let rewritten =
        ["no_bias_correction", "eps_inside_root", "corrected_as_in_first_step", "corrected_twice"];
    each(a, |before, grad| {
        let mut after = oracle(&adam, before, grad, step);
        if rewritten.into_iter().any(is) {
            let (m, v) = (after.m / correction(adam.beta1), after.v / correction(adam.beta2));
            let root = if is("eps_inside_root") { (v + adam.eps).sqrt() } else { v.sqrt() + adam.eps };
            let twice = bias_correction(adam.beta2, step).sqrt() / bias_correction(adam.beta1, step);
            let rate = if is("corrected_twice") { adam.lr * twice } else { adam.lr };
            after = Moments { param: before.param - rate * m / root, ..after };
        }
        if is("decoupled_decay") {
            after.param -= adam.lr * decay * before.param;
        }
        after
    })
}
