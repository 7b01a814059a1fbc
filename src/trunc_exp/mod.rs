//! Density as e^x with a gradient that can't overflow.
//!
//! Instant-NGP's density activation, as torch-ngp and nerfstudio call it: forward e^x, backward with the argument clamped to
//! [-15, 15]. The gradient is a surrogate and says so (VR6): outside that range it isn't the derivative. Some clamp forward too
//! ([`Exponent::Clamped`]); the gradient stays the surrogate.

use crate::convention::Exponent;
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

/// The density by convention: e^x, or e^clamp(x, -15, 15), which lies between 3.1e-7 and 3.3e6.
///
/// ```
/// use nerf_oracle::convention::Exponent;
/// use nerf_oracle::trunc_exp::{density, trunc_exp};
/// assert_eq!(density(20.0, Exponent::Free), trunc_exp(20.0));
/// assert_eq!(density(20.0, Exponent::Clamped), trunc_exp(15.0));
/// ```
pub fn density(x: f64, exponent: Exponent) -> f64 {
    trunc_exp(argument(x, exponent))
}

/// What the exponential is taken of.
fn argument(x: f64, exponent: Exponent) -> f64 {
    match exponent {
        Exponent::Free => x,
        Exponent::Clamped => x.clamp(-LIMIT, LIMIT),
    }
}
