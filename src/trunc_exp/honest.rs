//! Honest truncated exponentials in emulated arithmetic: the argument clamped, or the value.

use super::arrays::{forward, vjp};
use super::{LIMIT, held};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::{Conventions, Exponent, ExponentGradient, ExponentShift};

/// x, or x - 1.
fn shifted(x: f64, c: &Conventions, m: &Machine) -> f64 {
    if c.exponent_shift == ExponentShift::One { m.sub(x, 1.0) } else { x }
}

/// e^x, or e^clamp(x, -15, 15).
pub(crate) fn trunc_exp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    forward(a, |x| {
        let x = shifted(x, c, m);
        m.exp(if c.exponent == Exponent::Clamped { x.clamp(-LIMIT, LIMIT) } else { x })
    })
}

/// Its surrogate gradient; in odd forms from the density that the forward pass has stored.
pub(crate) fn trunc_exp_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |x, g| {
        let x = shifted(x, c, m);
        let stored = m.form % 2 == 1 && c.exponent_gradient == ExponentGradient::BothEnds;
        let slope = if stored {
            m.exp(x).max(m.exp(-LIMIT)).min(m.exp(LIMIT))
        } else {
            m.exp(held(x, c.exponent_gradient))
        };
        m.mul(g, slope)
    })
}
