//! Error bound of a loss scale: the wider of the two ways, in f32 at least, and the rounding to the type; of gradients the same. Trackers are
//! counts.

use super::arrays::{forward, found, gradients, loss_scale};
use super::honest::{WAYS, divided, scaled};
use super::unscaled;
use crate::contract::arithmetic::{Arithmetic, Dtype};
use crate::contract::arrays::{Arrays, number, values};
use crate::convention::Conventions;

/// The same arithmetic in f32 at least.
fn fine(m: &Arithmetic) -> Arithmetic {
    let (tiny, largest) = (m.tiny.min(Dtype::F32.smallest_normal()), m.largest.max(Dtype::F32.largest()));
    Arithmetic { u: m.u_sum, tiny, largest, ..*m }
}

/// Bound of [`super::updated`].
pub(crate) fn loss_scale_update(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let (s, found, fine) = (loss_scale(a), found(a), fine(m));
    let one = |way| {
        let scale = scaled(&fine, &s, found, c, way);
        if m.u_sum < m.u { m.rounded(scale.y, scale.e).e } else { scale.e }
    };
    forward((0..WAYS).map(one).fold(0.0, f64::max), 0.0)
}

/// Bound of [`super::unscaled`]. What stands in the gradients of a step that is skipped is open.
pub(crate) fn unscale_gradients(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let (scaled, scale, fine) = (values(a, "gradients"), number(a, "scale"), fine(m));
    if unscaled(&scaled, scale).is_none() {
        return gradients(false, vec![f64::INFINITY; scaled.len()]);
    }
    let one = |g: f64, way| {
        let g = divided(&fine, g, scale, way);
        if m.u_sum < m.u { m.rounded(g.y, g.e).e } else { g.e }
    };
    let widest = |&g: &f64| (0..WAYS).map(|way| one(g, way)).fold(0.0, f64::max);
    gradients(false, scaled.iter().map(widest).collect())
}
