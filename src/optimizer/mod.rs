//! Adam (Kingma and Ba 2015, algorithm 1), exactly as `torch.optim.Adam` defines it, and AdamW (Loshchilov and Hutter 2019).

use serde::{Deserialize, Serialize};

use crate::convention::AdamEps;
use crate::math::{expm1, ln};

pub(crate) mod arrays;
#[cfg(feature = "fast")]
pub mod fast;

pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// Adam's hyper-parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adam {
    /// Learning rate.
    pub lr: f64,
    /// Decay of the mean of gradients.
    pub beta1: f64,
    /// Decay of the mean of squared gradients.
    pub beta2: f64,
    /// Added to the root, outside of it.
    pub eps: f64,
    /// Times the parameter: added to the gradient by Adam (coupled, an L2 penalty, as in `torch.optim.Adam`), apart from it by AdamW.
    pub weight_decay: f64,
}

impl Default for Adam {
    /// PyTorch's, with the NeRF paper's learning rate.
    fn default() -> Self {
        Adam { lr: 5e-4, beta1: 0.9, beta2: 0.999, eps: 1e-8, weight_decay: 0.0 }
    }
}

/// One parameter with the two running means that belong to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    /// The parameter.
    pub param: f64,
    /// Mean of gradients.
    pub m: f64,
    /// Mean of squared gradients.
    pub v: f64,
}

/// One step for one parameter. `step` counts from 1.
///
/// g' = g + weight_decay p; m' = b1 m + (1 - b1) g'; v' = b2 v + (1 - b2) g'^2;
/// p' = p - lr / (1 - b1^step) m' / (sqrt(v') / sqrt(1 - b2^step) + eps).
///
/// # Convention
/// eps is added outside the root, and the bias corrections are applied to both means; another place of eps is another eps ([`eps`]). The first step is lr sign(g), whatever the
/// size of g, as long as it is well above eps.
///
/// ```
/// use nerf_oracle::optimizer::{Adam, Moments, adam_step};
/// let before = Moments { param: 1.0, m: 0.0, v: 0.0 };
/// let after = adam_step(&Adam { lr: 0.1, ..Adam::default() }, before, 4.0, 1);
/// assert!((after.param - 0.9).abs() < 1e-8);
/// ```
pub fn adam_step(adam: &Adam, before: Moments, grad: f64, step: u64) -> Moments {
    let Adam { lr, beta1, beta2, eps, weight_decay } = *adam;
    let g = grad + weight_decay * before.param;
    let m = beta1 * before.m + (1.0 - beta1) * g;
    let v = beta2 * before.v + (1.0 - beta2) * g * g;
    let (correction1, correction2) = (bias_correction(beta1, step), bias_correction(beta2, step));
    let denominator = v.sqrt() / correction2.sqrt() + eps;
    Moments { param: before.param - lr / correction1 * (m / denominator), m, v }
}

/// One step of AdamW (Loshchilov and Hutter 2019, algorithm 2, as `torch.optim.AdamW` defines it): Adam's step with the gradient alone,
/// and lr weight_decay p less, p as it was before the step. `step` counts from 1.
///
/// The decay goes through neither mean, and isn't divided by the root: every parameter shrinks by the same factor.
///
/// # Convention
/// That of eps is [`adam_step`]'s. The paper's lambda is lr weight_decay. (1 - lr weight_decay) p - the step (PyTorch) and p - lr (... +
/// weight_decay p) (optax) are the same number.
///
/// ```
/// use nerf_oracle::optimizer::{Adam, Moments, adamw_step};
/// let adam = Adam { lr: 0.125, weight_decay: 0.5, ..Adam::default() };
/// let after = adamw_step(&adam, Moments { param: 4.0, m: 0.0, v: 0.0 }, 0.0, 1);
/// assert_eq!((after.param, after.m), (3.75, 0.0));
/// ```
pub fn adamw_step(adam: &Adam, before: Moments, grad: f64, step: u64) -> Moments {
    let after = adam_step(&Adam { weight_decay: 0.0, ..*adam }, before, grad, step);
    Moments { param: after.param - adam.lr * adam.weight_decay * before.param, ..after }
}

/// The eps that stands beside the corrected root. lr sqrt(1 - b2^t) / (1 - b1^t) m / (sqrt(v) + eps), the paper's shorter form, is
/// [`adam_step`] with eps / sqrt(1 - b2^t) for eps.
///
/// ```
/// use nerf_oracle::convention::AdamEps;
/// use nerf_oracle::optimizer::{Adam, eps};
/// let adam = Adam { eps: 1e-4, beta2: 0.75, ..Adam::default() };
/// assert_eq!(eps(&adam, 1, AdamEps::Corrected), 1e-4);
/// assert!((eps(&adam, 1, AdamEps::Uncorrected) - 2e-4).abs() < 1e-18);
/// ```
pub fn eps(adam: &Adam, step: u64, convention: AdamEps) -> f64 {
    match convention {
        AdamEps::Corrected => adam.eps,
        AdamEps::Uncorrected => adam.eps / bias_correction(adam.beta2, step).sqrt(),
    }
}

/// 1 - beta^step. `1 - pow(beta, step)` cancels while beta^step is near 1: at beta = 0.999 the first steps lose 3 digits.
pub fn bias_correction(beta: f64, step: u64) -> f64 {
    -expm1(step as f64 * ln(beta))
}
