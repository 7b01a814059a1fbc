//! Error bounds of Adam's and AdamW's steps.
//!
//! Hyper-parameters are f64 in every number type. What is computed from them alone (1 - beta, the bias corrections, lr / correction)
//! is computed at least in f32, and rounded to the type where it is combined with an array.

use super::arrays::{each, settings, stays};
use super::{Adam, Moments, bias_correction};
use crate::contract::arithmetic::{Arithmetic, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, exact};
use crate::convention::{AdamEps, Conventions};
use crate::math::{expm1, ln};

/// Numbers computed from hyper-parameters alone.
pub(crate) struct Scalars {
    beta1: Bounded,
    beta2: Bounded,
    rest1: Bounded,
    rest2: Bounded,
    correction1: Bounded,
    correction2: Bounded,
    step_size: Bounded,
    /// lr sqrt(1 - b2^t) / (1 - b1^t).
    whole_rate: Bounded,
    lr: Bounded,
    eps: Bounded,
    decay: Bounded,
    /// lr weight_decay, and 1 less that.
    lr_decay: Bounded,
    kept: Bounded,
}

/// 1 - beta^step. Grade A: -expm1(step ln beta). Grade B: or the power is rounded before 1 - power cancels. Behind many steps the
/// power is nothing, and that way the more exact one.
fn correction(beta: f64, step: u64, s: &Arithmetic) -> Bounded {
    let y = bias_correction(beta, step);
    let stable = s.one_minus_exp(s.mul(exact(step as f64), s.elementary(-ln(beta), 0.0)));
    if s.grade == Grade::A {
        return stable;
    }
    // beta itself is rounded before the power: 1 + step roundings, as in repeated products.
    let power = 1.0 - y;
    let relative = expm1((step as f64 + 1.0) * s.u);
    let textbook = s.sub(exact(1.0), s.elementary(power, power * relative));
    stable.or(Bounded { y, e: textbook.e })
}

impl Scalars {
    pub(crate) fn new(adam: &Adam, step: u64, m: &Arithmetic) -> Scalars {
        let s = Arithmetic { u: m.u_sum, ..*m };
        // Rounded to the type where it is used.
        let to_type = |b: Bounded| if m.u == s.u { b } else { m.rounded(b.y, b.e) };
        let rounded = |x: f64| m.rounded(x, 0.0);
        let (correction1, correction2) = (correction(adam.beta1, step, &s), correction(adam.beta2, step, &s));
        let lr_decay = s.mul(s.rounded(adam.lr, 0.0), s.rounded(adam.weight_decay, 0.0));
        Scalars {
            beta1: rounded(adam.beta1),
            beta2: rounded(adam.beta2),
            rest1: rounded(1.0 - adam.beta1),
            rest2: rounded(1.0 - adam.beta2),
            step_size: to_type(s.div(s.rounded(adam.lr, 0.0), correction1)),
            whole_rate: to_type(s.div(s.mul(s.rounded(adam.lr, 0.0), s.sqrt(correction2)), correction1)),
            correction1: to_type(correction1),
            correction2: to_type(correction2),
            lr: rounded(adam.lr),
            eps: rounded(adam.eps),
            decay: rounded(adam.weight_decay),
            lr_decay: to_type(lr_decay),
            kept: to_type(s.sub(exact(1.0), lr_decay)),
        }
    }
}

/// b m + (1 - b) g, or m + (1 - b) (g - m).
fn mean(beta: Bounded, rest: Bounded, m: Bounded, g: Bounded, a: &Arithmetic) -> Bounded {
    let weighted = a.add(a.mul(beta, m), a.mul(rest, g));
    weighted.or(a.add(m, a.mul(rest, a.sub(g, m))))
}

/// lr sqrt(1 - b2^t) / (1 - b1^t) m' / (sqrt(v') + eps), in any order.
fn uncorrected(mean1: Bounded, mean2: Bounded, s: &Scalars, m: &Arithmetic) -> Bounded {
    let denominator = m.add(m.sqrt(mean2), s.eps);
    let quotient_first = m.mul(s.whole_rate, m.div(mean1, denominator));
    let product_first = m.div(m.mul(s.whole_rate, mean1), denominator);
    quotient_first.or(product_first).or(m.mul(m.div(s.whole_rate, denominator), mean1))
}

/// What is taken off a parameter, m and v.
fn update(
    [before1, before2, g]: [Bounded; 3],
    s: &Scalars,
    convention: AdamEps,
    m: &Arithmetic,
) -> [Bounded; 3] {
    let mean1 = mean(s.beta1, s.rest1, before1, g, m);
    // (1 - b2) (g g), or ((1 - b2) g) g: they underflow at different sizes of g.
    let kept = m.mul(s.beta2, before2);
    let square = m.mul(s.rest2, m.mul(g, g)).or(m.mul(m.mul(s.rest2, g), g));
    let mean2 = m.add(kept, square);
    if convention == AdamEps::Uncorrected {
        return [uncorrected(mean1, mean2, s, m), mean1, mean2];
    }
    let root = m.div(m.sqrt(mean2), m.sqrt(s.correction2)).or(m.sqrt(m.div(mean2, s.correction2)));
    let denominator = m.add(root, s.eps);
    let update = m.mul(s.step_size, m.div(mean1, denominator));
    let product_first = m.div(m.mul(s.step_size, mean1), denominator);
    let corrected = m.div(mean1, s.correction1);
    let textbook = m.mul(s.lr, m.div(corrected, denominator)).or(m.div(m.mul(s.lr, corrected), denominator));
    [update.or(product_first).or(textbook), mean1, mean2]
}

/// Parameter, m and v after a step, where all that goes into it may have errors of its own. `longest`: no honest step is longer.
pub(crate) fn moved(
    [param, before1, before2]: [Bounded; 3],
    grad: Bounded,
    adam: &Adam,
    s: &Scalars,
    (convention, longest): (AdamEps, f64),
    m: &Arithmetic,
) -> [Bounded; 3] {
    let g = if adam.weight_decay == 0.0 { grad } else { m.add(grad, m.mul(s.decay, param)) };
    let [update, mean1, mean2] = update([before1, before2, g], s, convention, m);
    [m.sub(param, no_longer(update, longest)), mean1, mean2]
}

/// The same of AdamW: what decays is taken off before the step, after it, or with it.
fn moved_and_decayed(
    [param, before1, before2]: [Bounded; 3],
    grad: Bounded,
    s: &Scalars,
    convention: AdamEps,
    m: &Arithmetic,
) -> [Bounded; 3] {
    let [update, mean1, mean2] = update([before1, before2, grad], s, convention, m);
    let shrunk = m.sub(m.mul(s.kept, param), update);
    let decayed = m.mul(s.lr_decay, param);
    let apart = m.sub(m.sub(param, update), decayed).or(m.sub(m.sub(param, decayed), update));
    // lr (m / (...) + weight_decay p).
    let direction = m.div(update, s.lr);
    let together = m.sub(param, m.mul(s.lr, m.add(direction, m.mul(s.decay, param))));
    [shrunk.or(apart).or(together).or(m.sub(param, m.add(update, decayed))), mean1, mean2]
}

/// A step of which it is known how long it may be.
fn no_longer(update: Bounded, longest: f64) -> Bounded {
    Bounded { y: update.y, e: update.e.min(update.y.abs() + longest) }
}

fn moments(
    before: Moments,
    grad: f64,
    adam: &Adam,
    s: &Scalars,
    convention: AdamEps,
    m: &Arithmetic,
) -> Moments {
    let known = [before.param, before.m, before.v].map(exact);
    let [param, mean1, mean2] = moved(known, exact(grad), adam, s, (convention, f64::INFINITY), m);
    Moments { param: param.e, m: mean1.e, v: mean2.e }
}

/// How far off what stays as it is may be.
const AS_IT_WAS: Moments = Moments { param: 0.0, m: 0.0, v: 0.0 };

/// Bound of [`super::adam_step`].
pub(crate) fn adam_step(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let (adam, step) = settings(a);
    let scalars = Scalars::new(&adam, step, m);
    each(a, |before, grad| match stays(grad, c) {
        true => AS_IT_WAS,
        false => moments(before, grad, &adam, &scalars, c.adam_eps, m),
    })
}

/// Bound of [`super::adamw_step`].
pub(crate) fn adamw_step(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let (adam, step) = settings(a);
    let scalars = Scalars::new(&adam, step, m);
    each(a, |before, grad| {
        if stays(grad, c) {
            return AS_IT_WAS;
        }
        let known = [before.param, before.m, before.v].map(exact);
        let [param, mean1, mean2] = moved_and_decayed(known, exact(grad), &scalars, c.adam_eps, m);
        Moments { param: param.e, m: mean1.e, v: mean2.e }
    })
}
