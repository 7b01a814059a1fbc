//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{Adam, Moments};
use crate::contract::arrays::{Arrays, array, arrays, input, number, values};
use crate::convention::{AdamZero, Conventions};

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

/// A step of each parameter, but of those that stay by convention, as their gradient is 0.
pub(crate) fn each_moved(a: &Arrays, c: &Conventions, step: impl Fn(Moments, f64) -> Moments) -> Arrays {
    each(a, |before, grad| if stays(grad, c) { before } else { step(before, grad) })
}

/// Whether a parameter stays as it is, by convention.
pub(crate) fn stays(grad: f64, c: &Conventions) -> bool {
    c.adam_zero == AdamZero::Left && grad == 0.0
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

/// One step of either optimizer.
fn stepped(a: &Arrays, c: &Conventions, one: fn(&Adam, Moments, f64, u64) -> Moments) -> Arrays {
    let (adam, step) = settings(a);
    let adam = Adam { eps: super::eps(&adam, step, c.adam_eps), ..adam };
    each_moved(a, c, |before, grad| one(&adam, before, grad, step))
}

pub(super) fn adam_step(a: &Arrays, c: &Conventions) -> Arrays {
    stepped(a, c, super::adam_step)
}

pub(super) fn adamw_step(a: &Arrays, c: &Conventions) -> Arrays {
    stepped(a, c, super::adamw_step)
}
