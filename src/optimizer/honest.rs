//! Honest implementations of Adam's and AdamW's steps in emulated arithmetic.

use super::arrays::{each_moved, settings};
use super::{Moments, bias_correction};
use crate::contract::Dtype;
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::{AdamEps, Conventions};
use crate::math::pow;

/// Where weights decay.
#[derive(Clone, Copy, PartialEq)]
enum Decay {
    /// In the gradient.
    Coupled,
    /// Beside the step.
    Decoupled,
}

/// Adam's step, as PyTorch's `lerp` and `addcdiv` compute it, or as written in the paper's algorithm, or in its shorter form.
pub(crate) fn adam_step(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    stepped(a, c, m, Decay::Coupled)
}

/// AdamW's step: what decays is taken off before the step, after it, or with it.
pub(crate) fn adamw_step(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    stepped(a, c, m, Decay::Decoupled)
}

fn stepped(a: &Arrays, c: &Conventions, m: &Machine, decay: Decay) -> Arrays {
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
    let lr_decay = s.mul(s.round(adam.lr), s.round(adam.weight_decay));
    let kept = m.round(s.sub(1.0, lr_decay));
    let lr_decay = m.round(lr_decay);
    // The way to take both off a parameter: Adam takes the step alone.
    let less = |param: f64, update: f64| match (decay, (m.form + m.noise / 4) % 5) {
        (Decay::Coupled, _) => m.sub(param, update),
        (_, 0) => m.sub(m.mul(kept, param), update),
        (_, 1) => m.sub(param, m.add(update, m.mul(lr_decay, param))),
        (_, 2) => m.sub(m.sub(param, update), m.mul(lr_decay, param)),
        (_, 3) => m.sub(m.sub(param, m.mul(lr_decay, param)), update),
        _ => {
            let lr = m.round(adam.lr);
            let direction = m.add(m.div(update, lr), m.mul(m.round(adam.weight_decay), param));
            m.sub(param, m.mul(lr, direction))
        }
    };
    let (rest1, rest2) = (m.round(1.0 - adam.beta1), m.round(1.0 - adam.beta2));
    each_moved(a, c, |before, grad| {
        let Moments { param, m: mean1, v: mean2 } = before;
        let g = if adam.weight_decay == 0.0 || decay == Decay::Decoupled {
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
            return Moments { param: less(param, update), m: mean1, v: mean2 };
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
        Moments { param: less(param, update), m: mean1, v: mean2 }
    })
}
