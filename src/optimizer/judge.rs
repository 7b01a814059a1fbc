//! Somebody's Adam and AdamW, judged.

use super::component::{ADAM_STEP, ADAMW_STEP};
use crate::judge::door::front_door;

front_door! {
    /// Judges one step on one parameter: (param, grad, m, v, step, lr, beta1, beta2, eps, weight_decay) -> (param, m, v).
    ///
    /// ```
    /// use nerf_oracle::optimizer::judge;
    /// judge(|p, g, m, v, step, lr, beta1, beta2, eps, decay| {
    ///     let g = g + decay * p;
    ///     let (m, v) = (beta1 * m + (1.0 - beta1) * g, beta2 * v + (1.0 - beta2) * g * g);
    ///     // 1 - beta^t without cancellation.
    ///     let correction = |beta: f64| -(step as f64 * beta.ln()).exp_m1();
    ///     let (m_hat, v_hat) = (m / correction(beta1), v / correction(beta2));
    ///     (p - lr * m_hat / (v_hat.sqrt() + eps), m, v)
    /// })
    /// .in_f32()
    /// .assert_pass();
    /// ```
    each ADAM_STEP: judge as Parameter(
        params: f64,
        grad: f64,
        m: f64,
        v: f64,
        step: usize,
        lr: f64,
        beta1: f64,
        beta2: f64,
        eps: f64,
        weight_decay: f64,
    );
}

front_door! {
    /// Judges one step on P parameters at once: the same arguments, the first four with P numbers -> (params, m, v), P each.
    whole ADAM_STEP: judge_batch as Parameters(
        params: &[f64],
        grad: &[f64],
        m: &[f64],
        v: &[f64],
        step: usize,
        lr: f64,
        beta1: f64,
        beta2: f64,
        eps: f64,
        weight_decay: f64,
    );
}

front_door! {
    /// Judges one step of AdamW on one parameter: the same arguments -> (param, m, v).
    ///
    /// ```
    /// use nerf_oracle::optimizer::judge;
    /// judge::adamw(|p, g, m, v, step, lr, beta1, beta2, eps, decay| {
    ///     let (m, v) = (beta1 * m + (1.0 - beta1) * g, beta2 * v + (1.0 - beta2) * g * g);
    ///     let correction = |beta: f64| -(step as f64 * beta.ln()).exp_m1();
    ///     let (m_hat, v_hat) = (m / correction(beta1), v / correction(beta2));
    ///     ((1.0 - lr * decay) * p - lr * m_hat / (v_hat.sqrt() + eps), m, v)
    /// })
    /// .in_f32()
    /// .assert_pass();
    /// ```
    each ADAMW_STEP: adamw as DecayedParameter(
        params: f64,
        grad: f64,
        m: f64,
        v: f64,
        step: usize,
        lr: f64,
        beta1: f64,
        beta2: f64,
        eps: f64,
        weight_decay: f64,
    );
}

front_door! {
    /// Judges one step of AdamW on P parameters at once: the same arguments, the first four with P numbers -> (params, m, v), P each.
    whole ADAMW_STEP: adamw_batch as DecayedParameters(
        params: &[f64],
        grad: &[f64],
        m: &[f64],
        v: &[f64],
        step: usize,
        lr: f64,
        beta1: f64,
        beta2: f64,
        eps: f64,
        weight_decay: f64,
    );
}
