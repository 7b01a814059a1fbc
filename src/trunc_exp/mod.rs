//! Density as e^x with a gradient that can't overflow.
//!
//! Instant-NGP's density activation, as torch-ngp and nerfstudio call it: forward e^x, backward with the argument clamped to
//! [-15, 15]. The gradient is a surrogate and says so (VR6): outside that range it isn't the derivative. Some clamp forward too
//! ([`Exponent::Clamped`]), some clamp the gradient from above alone ([`ExponentGradient`]), and some take 1 off first
//! ([`ExponentShift`]); each whatever the others do.

use crate::convention::{Exponent, ExponentGradient, ExponentShift};
use crate::math::exp;

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// Where the surrogate gradient stops following the derivative, on either side.
pub const LIMIT: f64 = 15.0;

/// sigma = e^x, not clamped: infinite from x = 709.8 on (88.8 in single, 11.1 in half precision).
///
/// # Units
/// `x` has none; the density is in 1 / length.
///
/// ```
/// assert_eq!(nerf_oracle::trunc_exp::trunc_exp(0.0), 1.0);
/// ```
pub fn trunc_exp(x: f64) -> f64 {
    exp(x)
}

/// The density by convention: e^x, or e^clamp(x, -15, 15), which lies between 3.1e-7 and 3.3e6; x or x - 1.
///
/// ```
/// use nerf_oracle::convention::{Exponent, ExponentShift};
/// use nerf_oracle::trunc_exp::{density, trunc_exp};
/// assert_eq!(density(20.0, Exponent::Free, ExponentShift::None), trunc_exp(20.0));
/// assert_eq!(density(20.0, Exponent::Clamped, ExponentShift::None), trunc_exp(15.0));
/// assert_eq!(density(1.0, Exponent::Free, ExponentShift::One), 1.0);
/// ```
pub fn density(x: f64, exponent: Exponent, shift: ExponentShift) -> f64 {
    trunc_exp(argument(x, exponent, shift))
}

/// What the exponential is taken of.
fn argument(x: f64, exponent: Exponent, shift: ExponentShift) -> f64 {
    let x = shifted(x, shift);
    match exponent {
        Exponent::Free => x,
        Exponent::Clamped => x.clamp(-LIMIT, LIMIT),
    }
}

/// x, or x - 1.
fn shifted(x: f64, shift: ExponentShift) -> f64 {
    match shift {
        ExponentShift::None => x,
        ExponentShift::One => x - 1.0,
    }
}

/// What the exponential in the gradient is taken of.
fn held(x: f64, gradient: ExponentGradient) -> f64 {
    match gradient {
        ExponentGradient::BothEnds => x.clamp(-LIMIT, LIMIT),
        ExponentGradient::Above => x.min(LIMIT),
        ExponentGradient::Above11 => x.min(11.0),
    }
}
