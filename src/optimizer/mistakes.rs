//! Adam's step, wrong on purpose. Without a mistake it equals the oracle.

use super::arrays::{each, settings};
use super::{Moments, adam_step as oracle, bias_correction};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::Conventions;

/// Mistakes of the optimizer.
pub const ADAM_STEP: &[Mistake] = &[
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
];

/// Adam's step.
pub fn adam_step(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (mut adam, mut step) = settings(a);
    if wrong.contains(&"step_from_zero") {
        step = (step - 1).max(1);
    }
    let decay = adam.weight_decay;
    let decoupled = wrong.contains(&"decoupled_decay");
    if decoupled {
        adam.weight_decay = 0.0;
    }
    let (uncorrected, inside) = (wrong.contains(&"no_bias_correction"), wrong.contains(&"eps_inside_root"));
    each(a, |before, grad| {
        let mut after = oracle(&adam, before, grad, step);
        if uncorrected || inside {
            let correction = |beta| if uncorrected { 1.0 } else { bias_correction(beta, step) };
            let (m, v) = (after.m / correction(adam.beta1), after.v / correction(adam.beta2));
            let root = if inside { (v + adam.eps).sqrt() } else { v.sqrt() + adam.eps };
            after = Moments { param: before.param - adam.lr * m / root, ..after };
        }
        if decoupled {
            after.param -= adam.lr * decay * before.param;
        }
        after
    })
}
