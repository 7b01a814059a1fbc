//! Honest updates: the factor of the step, or a quotient with its inverse; in f32 at least, as every library keeps the scale. Gradients
//! divided by it, or times its inverse.

use super::LossScale;
use super::arrays::{forward, found, gradients, loss_scale};
use crate::contract::Dtype;
use crate::contract::arrays::{Arrays, number, values};
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::convention::{Conventions, LossScaleCeiling, LossScaleFloor};

/// The ways to a new scale.
pub(super) const WAYS: u64 = 2;

/// The scale after a step.
pub(super) fn scaled<O: Operations>(
    o: &O,
    s: &LossScale,
    found: bool,
    c: &Conventions,
    way: u64,
) -> O::Number {
    let scale = o.hyper(s.scale);
    let times = |factor: f64| {
        if way == 0 {
            return o.mul(scale, o.hyper(factor));
        }
        o.div(scale, o.div(o.exact(1.0), o.hyper(factor)))
    };
    if found {
        let shrunk = times(s.backoff_factor);
        return if c.loss_scale_floor == LossScaleFloor::One { o.max(shrunk, o.exact(1.0)) } else { shrunk };
    }
    if s.tracker + 1 < s.growth_interval {
        return scale;
    }
    let grown = times(s.growth_factor);
    match c.loss_scale_ceiling {
        LossScaleCeiling::None => grown,
        held => o.min(grown, o.exact(held.value())),
    }
}

/// The tracker after a step.
pub(super) fn tracked(s: &LossScale, found: bool) -> f64 {
    let counted = s.tracker + 1;
    if found || counted >= s.growth_interval { 0.0 } else { counted as f64 }
}

/// A gradient without the scale: a quotient, or a product with the inverse (`GradScaler.unscale_`).
pub(super) fn divided<O: Operations>(o: &O, g: f64, scale: f64, way: u64) -> O::Number {
    let (g, scale) = (o.exact(g), o.hyper(scale));
    if way == 0 { o.div(g, scale) } else { o.mul(g, o.div(o.exact(1.0), scale)) }
}

/// The same machine in f32 at least.
fn fine(m: &Machine) -> Machine {
    Machine { dtype: if m.dtype == Dtype::F64 { Dtype::F64 } else { Dtype::F32 }, ..*m }
}

/// Gradients of f32 at least, rounded to the type in the end.
pub(crate) fn unscale_gradients(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let (scaled, scale) = (values(a, "gradients"), number(a, "scale"));
    let one = |&g: &f64| m.round(divided(&fine(m), g, scale, (m.form + m.noise) % WAYS));
    gradients(scaled.iter().any(|g| !g.is_finite()), scaled.iter().map(one).collect())
}

/// An update on a machine of f32 at least.
pub(crate) fn loss_scale_update(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let fine = fine(m);
    let (s, found) = (loss_scale(a), found(a));
    forward(m.round(scaled(&fine, &s, found, c, (m.form + m.noise) % WAYS)), tracked(&s, found))
}
