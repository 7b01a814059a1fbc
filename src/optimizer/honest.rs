//! Honest implementations of Adam's step in emulated arithmetic.

use super::arrays::{each, settings};
use super::{Moments, bias_correction};
use crate::contract::Dtype;
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::{AdamEps, Conventions};
use crate::math::pow;

/// Adam's step, as PyTorch's `lerp` and `addcdiv` compute it, or as written in the paper's algorithm, or in its shorter form.
pub(crate) fn adam_step(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let (adam, step) = settings(a);
    // What is computed from hyper-parameters alone is computed at least in f32.
    let s = Machine { dtype: if m.dtype == Dtype::F64 { Dtype::F64 } else { Dtype::F32 }, ..*m };
    let correction = |beta: f64| match m.stable {
        true => s.elementary(bias_correction(beta, step)),
        false => s.sub(1.0, s.elementary(pow(s.round(beta), step as f64))),
    };
    let (correction1, correction2) = (correction(adam.beta1), correction(adam.beta2));
    let step_size = m.round(s.div(s.round(adam.lr), correction1));
    let whole_rate = m.round(s.div(s.mul(s.round(adam.lr), s.sqrt(correction2)), correction1));
    let (rest1, rest2) = (m.round(1.0 - adam.beta1), m.round(1.0 - adam.beta2));
    each(a, |before, grad| {
        let Moments { param, m: mean1, v: mean2 } = before;
        let g = if adam.weight_decay == 0.0 {
            grad
        } else {
            m.add(grad, m.mul(m.round(adam.weight_decay), param))
        };
        let mean1 = match m.form % 2 {
            0 => m.add(mean1, m.mul(rest1, m.sub(g, mean1))),
            _ => m.add(m.mul(m.round(adam.beta1), mean1), m.mul(rest1, g)),
        };
        let square = if m.form % 3 == 0 { m.mul(m.mul(rest2, g), g) } else { m.mul(rest2, m.mul(g, g)) };
        let mean2 = m.add(m.mul(m.round(adam.beta2), mean2), square);
        if c.adam_eps == AdamEps::Uncorrected {
            let denominator = m.add(m.sqrt(mean2), m.round(adam.eps));
            let update = match m.form % 3 {
                0 => m.mul(whole_rate, m.div(mean1, denominator)),
                1 => m.div(m.mul(whole_rate, mean1), denominator),
                _ => m.mul(m.div(whole_rate, denominator), mean1),
            };
            return Moments { param: m.sub(param, update), m: mean1, v: mean2 };
        }
        let root = match m.form % 2 {
            0 => m.div(m.sqrt(mean2), m.sqrt(m.round(correction2))),
            _ => m.sqrt(m.div(mean2, m.round(correction2))),
        };
        let denominator = m.add(root, m.round(adam.eps));
        let update = match m.form % 3 {
            0 => m.div(m.mul(step_size, mean1), denominator),
            1 => m.mul(step_size, m.div(mean1, denominator)),
            _ => m.mul(m.round(adam.lr), m.div(m.div(mean1, m.round(correction1)), denominator)),
        };
        Moments { param: m.sub(param, update), m: mean1, v: mean2 }
    })
}
