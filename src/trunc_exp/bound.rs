//! Error bounds of the truncated exponential: one elementary function, and one product after it.

use super::arrays::{forward, vjp};
use super::{LIMIT, held};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, exact};
use crate::convention::{Conventions, Exponent, ExponentShift};

/// x, or x - 1 rounded.
fn shifted(x: f64, c: &Conventions, m: &Arithmetic) -> Bounded {
    match c.exponent_shift {
        ExponentShift::None => exact(x),
        ExponentShift::One => m.sub(exact(x), exact(1.0)),
    }
}

/// Bound of [`super::density`]: every type holds the limits, so that clamping costs nothing and moves no two numbers apart.
pub(crate) fn trunc_exp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    forward(a, |x| {
        let x = shifted(x, c, m);
        let clamped = Bounded { y: x.y.clamp(-LIMIT, LIMIT), ..x };
        m.exp(if c.exponent == Exponent::Clamped { clamped } else { x }).e
    })
}

/// Bound of [`super::backward::trunc_exp`].
pub(crate) fn trunc_exp_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    vjp(a, |x, g| {
        let x = shifted(x, c, m);
        m.mul(exact(g), m.exp(Bounded { y: held(x.y, c.exponent_gradient), ..x })).e
    })
}
