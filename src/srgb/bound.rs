//! Error bounds of the sRGB curve.
//!
//! Where a number is within a rounding of the threshold, an honest implementation may take either piece: the bound covers both.

use super::THRESHOLD;
use super::arrays::{forward, vjp};
use crate::contract::arithmetic::{Arithmetic, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, exact};
use crate::convention::Conventions;
use crate::math::{expm1, ln, pow};

/// A constant as a program in this arithmetic has it.
fn constant(y: f64, m: &Arithmetic) -> Bounded {
    m.rounded(y, 0.0)
}

/// x^k with a rounded exponent: one elementary function, or in grade B e^(k ln x), as fast `powf` of GPUs has it.
fn power(x: f64, k: Bounded, m: &Arithmetic) -> Bounded {
    let y = pow(x, k.y);
    let direct = m.elementary(y, y * expm1(ln(x).abs() * k.e));
    match m.grade {
        Grade::A => direct,
        Grade::B => direct.or(m.exp(m.mul(k, m.elementary(ln(x), 0.0)))),
    }
}

/// 1 / 2.4, divided or written as a constant.
fn exponent(m: &Arithmetic) -> Bounded {
    m.div(exact(1.0), constant(2.4, m))
}

/// 1.055 x^(1/2.4) - 0.055.
fn curved(x: f64, m: &Arithmetic) -> Bounded {
    m.sub(m.mul(constant(1.055, m), power(x, exponent(m), m)), constant(0.055, m))
}

/// The slope of that: (1.055 / 2.4) x^(1/2.4 - 1), the exponent by a difference or a quotient; or (srgb + 0.055) / (2.4 x).
fn slope_of_curved(x: f64, m: &Arithmetic) -> Bounded {
    let difference = m.sub(exponent(m), exact(1.0));
    let quotient = m.div(constant(-1.4, m), constant(2.4, m));
    let by_power = m.mul(m.mul(constant(1.055, m), exponent(m)), power(x, difference.or(quotient), m));
    let from_output = m.div(m.add(curved(x, m), constant(0.055, m)), m.mul(constant(2.4, m), exact(x)));
    by_power.or(from_output)
}

/// The error of the piece that the oracle takes at x; near the threshold, how far the other piece may be.
fn either(x: f64, straight: Bounded, curved: impl Fn() -> Bounded, m: &Arithmetic) -> f64 {
    let near = (x - THRESHOLD).abs() <= m.u * THRESHOLD;
    if !near {
        return if x <= THRESHOLD { straight.e } else { curved().e };
    }
    let curved = curved();
    (straight.y - curved.y).abs() + straight.e.max(curved.e)
}

/// Bound of [`super::linear_to_srgb`].
pub(crate) fn linear_to_srgb(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    forward(a, |x| either(x, m.mul(constant(12.92, m), exact(x)), || curved(x, m), m))
}

/// Bound of [`super::backward::linear_to_srgb`].
pub(crate) fn linear_to_srgb_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    vjp(a, |x, g| {
        let times_g = |slope| m.mul(exact(g), slope);
        either(x, times_g(constant(12.92, m)), || times_g(slope_of_curved(x, m)), m)
    })
}
