//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::backward;
use crate::contract::arrays::{Arrays, array, arrays, input, number, scalar, values};
use crate::convention::Conventions;

/// The two arrays of a case.
pub(crate) fn pair(a: &Arrays) -> [Vec<f64>; 2] {
    ["prediction", "target"].map(|name| values(a, name))
}

/// A loss as the output.
pub(crate) fn forward(value: f64) -> Arrays {
    arrays([("value", scalar(value))])
}

/// Its gradient as the output.
pub(crate) fn vjp(a: &Arrays, gradient: Vec<f64>) -> Arrays {
    arrays([("grad_prediction", array(input(a, "prediction").shape(), gradient))])
}

pub(super) fn huber(a: &Arrays, c: &Conventions) -> Arrays {
    let [p, t] = pair(a);
    forward(super::huber(&p, &t, number(a, "delta"), c.huber_slope, c.loss_reduction))
}

pub(super) fn huber_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let ([p, t], g) = (pair(a), number(a, "grad_value"));
    vjp(a, backward::huber(&p, &t, number(a, "delta"), c.huber_slope, c.loss_reduction, g))
}

pub(super) fn charbonnier(a: &Arrays, c: &Conventions) -> Arrays {
    let [p, t] = pair(a);
    forward(super::charbonnier(&p, &t, number(a, "eps"), c.charbonnier_eps, c.loss_reduction))
}

pub(super) fn charbonnier_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let ([p, t], g) = (pair(a), number(a, "grad_value"));
    vjp(a, backward::charbonnier(&p, &t, number(a, "eps"), c.charbonnier_eps, c.loss_reduction, g))
}
