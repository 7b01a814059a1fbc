//! Loss scaling: what a loss is multiplied by, so that its gradients in f16 aren't lost below the smallest numbers of that type.
//!
//! The scale is as large as overflows allow: it shrinks when one is found, and that step is skipped; after so many steps without one it
//! grows. Gradients are divided by it before anything else looks at them.

use crate::convention::{LossScaleCeiling, LossScaleFloor};

pub(crate) mod arrays;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// A scale and what changes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LossScale {
    /// What the loss is multiplied by.
    pub scale: f64,
    /// Steps without an overflow since it last changed.
    pub tracker: u64,
    /// What it is multiplied by after `growth_interval` of them, above 1.
    pub growth_factor: f64,
    /// What it is multiplied by after an overflow, below 1.
    pub backoff_factor: f64,
    /// The number of steps without an overflow after which it grows, at least 1.
    pub growth_interval: u64,
}

/// The scale and the tracker after a step (Micikevicius et al. 2018, section 3.2; `torch.amp.GradScaler.update`).
///
/// With an overflow: scale backoff_factor, and 0. Without: the tracker counts one more; where that makes `growth_interval`, scale
/// growth_factor, and 0.
///
/// # Convention
/// `floor` holds a scale that shrinks, `ceiling` one that grows; neither touches a scale that stays.
///
/// ```
/// use nerf_oracle::convention::{LossScaleCeiling, LossScaleFloor};
/// use nerf_oracle::loss_scaling::{LossScale, updated};
/// let torch = LossScale {
///     scale: 65536.0, tracker: 1998, growth_factor: 2.0, backoff_factor: 0.5, growth_interval: 2000,
/// };
/// let after = |s: &LossScale, found_inf| updated(s, found_inf, LossScaleFloor::None, LossScaleCeiling::None);
/// assert_eq!(after(&torch, false), (65536.0, 1999));
/// assert_eq!(after(&LossScale { tracker: 1999, ..torch }, false), (131072.0, 0));
/// assert_eq!(after(&torch, true), (32768.0, 0));
/// ```
pub fn updated(
    s: &LossScale,
    found_inf: bool,
    floor: LossScaleFloor,
    ceiling: LossScaleCeiling,
) -> (f64, u64) {
    if found_inf {
        let shrunk = s.scale * s.backoff_factor;
        return (if floor == LossScaleFloor::One { shrunk.max(1.0) } else { shrunk }, 0);
    }
    if s.tracker + 1 < s.growth_interval {
        return (s.scale, s.tracker + 1);
    }
    let grown = s.scale * s.growth_factor;
    (grown.min(ceiling.value()), 0)
}

/// The gradients of the loss from those of the scaled loss: g / scale; `None` where one of them isn't finite (Micikevicius et al. 2018,
/// section 3.2; `torch.amp.GradScaler.unscale_`).
///
/// `None` says that the step is skipped: parameters and the optimizer's moments stay as they are, its count of steps too, and
/// [`updated`] is told of an overflow. Any infinity and any NaN does that, of all parameters that are stepped together. Clips come after
/// this, before the step: a norm of scaled gradients is `scale` times too large.
///
/// # Units
/// Gradients times `scale`, which is above 0; gradients.
///
/// ```
/// use nerf_oracle::loss_scaling::unscaled;
/// assert_eq!(unscaled(&[1024.0, -3.0, 0.0], 1024.0), Some(vec![1.0, -3.0 / 1024.0, 0.0]));
/// assert_eq!(unscaled(&[1.0, f64::NEG_INFINITY], 2.0), None);
/// assert_eq!(unscaled(&[f64::NAN, 1.0], 2.0), None);
/// ```
pub fn unscaled(gradients: &[f64], scale: f64) -> Option<Vec<f64>> {
    let mut out = vec![];
    for &g in gradients {
        if !g.is_finite() {
            return None;
        }
        out.push(g / scale);
    }
    Some(out)
}
