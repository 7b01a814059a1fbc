//! Adam's step, wrong on purpose. Without a mistake it equals the oracle.

use super::arrays::{each, settings};
use super::{Moments, adam_step as oracle, bias_correction, eps};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::Conventions;

/// Mistakes of the optimizer.
pub(crate) const ADAM_STEP: &[Mistake] = &[
    Mistake::new(
        "no_bias_correction",
        "m and v are used as they are",
        "the first steps are about 3 times too long (0.1 / sqrt(0.001))",
        "divide by 1 - beta^step",
        "hand-written optimizers",
        0,
    ),
    Mistake::new(
        "eps_inside_root",
        "sqrt(v + eps)",
        "small gradients take steps that are far too short: eps acts as its root, 1e-4",
        "sqrt(v) + eps",
        "hand-written optimizers",
        0,
    ),
    Mistake::new(
        "decoupled_decay",
        "p is shrunk by lr * weight_decay (AdamW) where the penalty belongs to the gradient",
        "another optimizer: the decay isn't scaled by the root",
        "add weight_decay * p to the gradient, or compare with AdamW",
        "hand-written optimizers",
        0,
    ),
    Mistake::new(
        "step_from_zero",
        "the corrections use step - 1 (with the first clamped to 1)",
        "early steps too long",
        "count steps from 1",
        "hand-written optimizers",
        0,
    ),
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
