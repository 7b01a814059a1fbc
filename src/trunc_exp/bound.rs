//! Error bounds of the truncated exponential: one elementary function, and one product after it.

use super::arrays::{forward, vjp};
use super::{LIMIT, argument};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::exact;
use crate::convention::Conventions;

/// Bound of [`super::density`].
pub fn trunc_exp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    forward(a, |x| m.exp(exact(argument(x, c.exponent))).e)
}

/// Bound of [`super::backward::trunc_exp`]: every type holds the limit, so that clamping costs nothing.
pub fn trunc_exp_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    vjp(a, |x, g| m.mul(exact(g), m.exp(exact(x.clamp(-LIMIT, LIMIT)))).e)
}
