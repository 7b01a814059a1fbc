//! Honest sRGB curves in emulated arithmetic: three ways to write the constants, `pow` or e^(k ln x), either side at the threshold.

use super::THRESHOLD;
use super::arrays::{forward, vjp};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::Conventions;
use crate::math::{ln, pow};

/// Whether this machine takes the straight piece at x.
fn straight(x: f64, m: &Machine) -> bool {
    let threshold = m.round(THRESHOLD);
    if m.form % 3 == 1 { x < threshold } else { x <= threshold }
}

/// x^k.
fn power(x: f64, k: f64, m: &Machine) -> f64 {
    if m.stable { m.elementary(pow(x, k)) } else { m.exp(m.mul(k, m.elementary(ln(x)))) }
}

/// 1 / 2.4 divided here, or a constant.
fn exponent(m: &Machine) -> f64 {
    if m.form % 3 == 0 { m.div(1.0, m.round(2.4)) } else { m.round(5.0 / 12.0) }
}

/// 1.055 x^(1/2.4) - 0.055, or multinerf's (211 x^(5/12) - 11) / 200.
fn curved(x: f64, m: &Machine) -> f64 {
    let p = power(x, exponent(m), m);
    let (scale, offset) = (m.round(1.055), m.round(0.055));
    if m.form % 3 == 1 {
        m.div(m.sub(m.mul(211.0, p), 11.0), 200.0)
    } else if m.fused {
        m.round(scale * p - offset)
    } else {
        m.sub(m.mul(scale, p), offset)
    }
}

/// Its slope: as automatic differentiation has it, with constants of its own, or from what the forward pass returned.
fn slope_of_curved(x: f64, m: &Machine) -> f64 {
    match m.form % 3 {
        0 => {
            let k = exponent(m);
            m.mul(m.mul(m.round(1.055), k), power(x, m.sub(k, 1.0), m))
        }
        1 => m.mul(m.round(1.055 / 2.4), power(x, m.div(m.round(-1.4), m.round(2.4)), m)),
        _ => m.div(m.add(curved(x, m), m.round(0.055)), m.mul(m.round(2.4), x)),
    }
}

/// The curve.
pub(crate) fn linear_to_srgb(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    forward(a, |x| if straight(x, m) { m.mul(m.round(12.92), x) } else { curved(x, m) })
}

/// Its gradient.
pub(crate) fn linear_to_srgb_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |x, g| m.mul(g, if straight(x, m) { m.round(12.92) } else { slope_of_curved(x, m) }))
}
