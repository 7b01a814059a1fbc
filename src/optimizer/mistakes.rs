//! Adam's and AdamW's steps, wrong on purpose. Without a mistake they equal the oracle.

mod catalogue;
pub(crate) mod laws;
mod one_mean;

pub(crate) use catalogue::{ADAM_STEP, ADAMW_STEP};
use catalogue::{EPS_OF_ITS_OWN, GRADIENT_CLIPPED, GRADIENT_NORM_CLIPPED, MEANS_BEGIN_AT_EPS};

use super::arrays::{self, each_moved, settings, stays};
use super::{Adam, Moments, adam_step as oracle, bias_correction, eps};
use crate::contract::arrays::{Arrays, scalar, values};
use crate::convention::Conventions;

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
    let grad = values(a, "grad");
    let (correction1, correction2) = (bias_correction(adam.beta1, step), bias_correction(adam.beta2, step));
    let eps = eps(&adam, step, c.adam_eps);
    for (i, param) in out.get_mut("params_out").expect("an output").iter_mut().enumerate() {
        let p = before[i];
        match () {
            () if stays(grad[i], c) => {}
            () if is("decay_without_rate") && is("decay_negated") => *param += decay * p,
            () if is("decay_without_rate") => *param -= decay * p,
            () if is("gradient_decayed") => *param -= decay * grad[i],
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

/// What a mistake in the means makes of them: m', v', and those that the parameter moves by.
struct Means {
    kept: [f64; 2],
    used: [f64; 2],
}

/// The means after a gradient.
fn means(adam: &Adam, before: Moments, g: f64, step: u64, wrong: &[&str]) -> Means {
    let is = |name: &str| wrong.contains(&name);
    let (mut beta1, mut beta2) = (adam.beta1, adam.beta2);
    if is("betas_exchanged") {
        std::mem::swap(&mut beta1, &mut beta2);
    }
    let begun = MEANS_BEGIN_AT_EPS.among(wrong).filter(|_| step == 1);
    let (old_m, old_v) = (begun.unwrap_or(before.m), begun.unwrap_or(before.v));
    let mean = |beta: f64, old: f64, new: f64, exchanged: bool| {
        let beta = if exchanged { 1.0 - beta } else { beta };
        beta * old + (1.0 - beta) * new
    };
    let m = mean(beta1, old_m, g, is("mean_weights_exchanged"));
    let of_square = if is("square_of_mean") { m } else { g };
    let v = mean(beta2, old_v, of_square * of_square, is("square_weights_exchanged"));
    let [by1, by2] = corrections(adam, step, wrong);
    let used = match () {
        () if is("square_of_before") => [m / by1, before.v / by2],
        () if is("mean_of_before") => [before.m / by1, v / by2],
        () if is("means_before") => [before.m / by1, before.v / by2],
        () if is("gradient_for_mean") => [g, v / by2],
        () => [m / by1, v / by2],
    };
    Means { kept: if is("corrected_means_kept") { used } else { [m, v] }, used }
}

/// What the means are divided by.
fn corrections(adam: &Adam, step: u64, wrong: &[&str]) -> [f64; 2] {
    let is = |name: &str| wrong.contains(&name);
    let of = |beta: f64| match () {
        () if is("no_bias_correction") => 1.0,
        () if is("corrected_as_in_first_step") => 1.0 - beta,
        () if is("step_from_two") => bias_correction(beta, step + 1),
        () if is("beta_times_step") => 1.0 - beta * step as f64,
        () if is("correction_multiplied") => 1.0 / bias_correction(beta, step),
        () => bias_correction(beta, step),
    };
    match () {
        () if is("beta1_in_both_corrections") => [of(adam.beta1); 2],
        () if is("beta2_in_both_corrections") => [of(adam.beta2); 2],
        () if is("square_not_corrected") => [of(adam.beta1), 1.0],
        () if is("mean_not_corrected") => [1.0, of(adam.beta2)],
        () if is("betas_squared") => [adam.beta1, adam.beta2].map(|beta| bias_correction(beta, 2)),
        () if is("beta2_squared") => [of(adam.beta1), bias_correction(adam.beta2, 2)],
        () => [of(adam.beta1), of(adam.beta2)],
    }
}

/// Adam's step.
pub(crate) fn adam_step(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (mut adam, mut step) = settings(a);
    let is = |name: &str| wrong.contains(&name);
    if is("step_from_zero") {
        step = (step - 1).max(1);
    }
    if is("betas_of_its_own") {
        (adam.beta1, adam.beta2) = (0.9, 0.999);
    }
    let decay = adam.weight_decay;
    if is("decoupled_decay") {
        adam.weight_decay = 0.0;
    }
    adam.eps = EPS_OF_ITS_OWN.among(wrong).unwrap_or(adam.eps);
    adam.eps = if is("eps_forgotten") { 0.0 } else { eps(&adam, step, c.adam_eps) };
    // What is rewritten below, another count of steps, betas, eps and decay aside.
    let as_it_is = ["step_from_zero", "betas_of_its_own", "decoupled_decay"];
    let rewritten = wrong.iter().any(|name| !as_it_is.contains(name));
    let norm = values(a, "grad").iter().map(|g| g * g).sum::<f64>().sqrt();
    let shortened = GRADIENT_NORM_CLIPPED.among(wrong).filter(|k| norm > *k).map_or(1.0, |k| k / norm);
    each_moved(a, c, |before, grad| {
        let grad = shortened * grad;
        let grad = GRADIENT_CLIPPED.among(wrong).map_or(grad, |k| grad.clamp(-k, k));
        let mut after = oracle(&adam, before, grad, step);
        if rewritten {
            let Means { kept, used: [m, v] } =
                means(&adam, before, grad + adam.weight_decay * before.param, step, wrong);
            let root = match () {
                () if is("eps_inside_root") => (v + adam.eps).sqrt(),
                () if is("eps_inside_root_too") => (v + adam.eps).sqrt() + adam.eps,
                () => v.sqrt() + adam.eps,
            };
            let rate = adam.lr
                * match () {
                    () if is("corrected_twice") => {
                        bias_correction(adam.beta2, step).sqrt() / bias_correction(adam.beta1, step)
                    }
                    () if is("rate_over_root_of_step") => 1.0 / (step as f64).sqrt(),
                    () if is("uphill") => -1.0,
                    () => 1.0,
                };
            after = Moments { param: before.param - rate * m / root, m: kept[0], v: kept[1] };
        }
        if is("decoupled_decay") {
            after.param -= adam.lr * decay * before.param;
        }
        after
    })
}
