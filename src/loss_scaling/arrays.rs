//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{LossScale, unscaled, updated};
use crate::contract::arrays::{Arrays, array, arrays, number, scalar, values};
use crate::convention::Conventions;

/// The scale of a case.
pub(crate) fn loss_scale(a: &Arrays) -> LossScale {
    LossScale {
        scale: number(a, "scale"),
        tracker: number(a, "growth_tracker") as u64,
        growth_factor: number(a, "growth_factor"),
        backoff_factor: number(a, "backoff_factor"),
        growth_interval: number(a, "growth_interval") as u64,
    }
}

/// Whether an overflow was found.
pub(crate) fn found(a: &Arrays) -> bool {
    number(a, "found_inf") != 0.0
}

/// A scale and a tracker as the outputs.
pub(crate) fn forward(scale: f64, tracker: f64) -> Arrays {
    arrays([("scale_out", scalar(scale)), ("growth_tracker_out", scalar(tracker))])
}

pub(super) fn loss_scale_update(a: &Arrays, c: &Conventions) -> Arrays {
    let (scale, tracker) = updated(&loss_scale(a), found(a), c.loss_scale_floor, c.loss_scale_ceiling);
    forward(scale, tracker as f64)
}

/// Whether an overflow was found, and gradients, as the outputs.
pub(crate) fn gradients(found: bool, unscaled: Vec<f64>) -> Arrays {
    let found = scalar(if found { 1.0 } else { 0.0 });
    arrays([("found_inf", found), ("unscaled", array(&[unscaled.len()], unscaled))])
}

pub(super) fn unscale_gradients(a: &Arrays, _: &Conventions) -> Arrays {
    let scaled = values(a, "gradients");
    let unscaled = unscaled(&scaled, number(a, "scale"));
    // Nobody looks at the gradients of a step that is skipped: any number stands for them.
    gradients(unscaled.is_none(), unscaled.unwrap_or_else(|| vec![0.0; scaled.len()]))
}
