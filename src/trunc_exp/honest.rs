//! Honest truncated exponentials in emulated arithmetic: the argument clamped, or the value.

use super::arrays::{forward, vjp};
use super::{LIMIT, argument};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::Conventions;

/// e^x, or e^clamp(x, -15, 15).
pub fn trunc_exp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    forward(a, |x| m.exp(argument(x, c.exponent)))
}

/// Its surrogate gradient; in odd forms from the density that the forward pass has stored.
pub fn trunc_exp_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |x, g| {
        let slope = if m.form % 2 == 0 {
            m.exp(x.clamp(-LIMIT, LIMIT))
        } else {
            m.exp(x).clamp(m.exp(-LIMIT), m.exp(LIMIT))
        };
        m.mul(g, slope)
    })
}
