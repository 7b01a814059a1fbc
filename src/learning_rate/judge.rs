//! Somebody's learning rates, judged.

use super::component::{LR_COSINE, LR_EXPONENTIAL, LR_LOG_LINEAR};
use crate::judge::door::front_door;

front_door! {
    /// Judges an exponential decay: (step, decay_steps, lr_init, decay) -> rate.
    ///
    /// ```
    /// use nerf_oracle::learning_rate;
    /// learning_rate::judge(|step, decay_steps, lr_init, decay| {
    ///     lr_init * decay.powf(step as f64 / decay_steps as f64)
    /// })
    /// .assert_pass();
    /// ```
    whole LR_EXPONENTIAL: judge as Exponential(step: usize, decay_steps: usize, lr_init: f64, decay: f64);
}

front_door! {
    /// Judges a cosine with its warm-up: (step, max_steps, lr_init, lr_final, warmup_steps) -> rate.
    ///
    /// ```
    /// use nerf_oracle::learning_rate::judge;
    /// judge::cosine(|step, max_steps, lr_init, lr_final, warmup_steps| {
    ///     if step < warmup_steps {
    ///         return lr_init * step as f64 / warmup_steps as f64;
    ///     }
    ///     let p = (step - warmup_steps) as f64 / (max_steps - warmup_steps) as f64;
    ///     lr_final + (lr_init - lr_final) * (1.0 + (std::f64::consts::PI * p).cos()) / 2.0
    /// })
    /// .assert_pass();
    /// ```
    whole LR_COSINE: cosine as Cosine(
        step: usize,
        max_steps: usize,
        lr_init: f64,
        lr_final: f64,
        warmup_steps: usize,
    );
}

front_door! {
    /// Judges a log-linear decay: (step, max_steps, lr_init, lr_final, delay_steps, delay_mult) -> rate.
    ///
    /// ```
    /// use nerf_oracle::learning_rate::judge;
    /// // Without a delay; with one it takes all six.
    /// judge::log_linear(|step, max_steps, lr_init, lr_final, _, _| {
    ///     let t = (step as f64 / max_steps as f64).min(1.0);
    ///     (lr_init.ln() * (1.0 - t) + lr_final.ln() * t).exp()
    /// })
    /// .takes(&["step", "max_steps", "lr_init", "lr_final"])
    /// .assert_pass();
    /// ```
    whole LR_LOG_LINEAR: log_linear as LogLinear(
        step: usize,
        max_steps: usize,
        lr_init: f64,
        lr_final: f64,
        delay_steps: usize,
        delay_mult: f64,
    );
}
