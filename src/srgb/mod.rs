//! Linear light to sRGB, the values that picture files hold.
//!
//! IEC 61966-2-1: a straight piece near black, a power above it. The pieces don't meet: at the threshold the power lies 2.9e-8
//! below the straight piece, and the slope falls from 12.92 to 12.70. The standard gives the threshold to the straight piece; code
//! that gives it to the power (`<` for `<=`) is as right as rounding lets anybody tell.

use crate::math::pow;

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

/// The largest linear value of the straight piece.
pub const THRESHOLD: f64 = 0.0031308;

/// 12.92 x for x <= 0.0031308, 1.055 x^(1/2.4) - 0.055 above.
///
/// # Units
/// `x` is linear light, 1 at the white of a picture; the result is an sRGB value, 1 there too.
///
/// # Convention
/// The standard speaks of [0, 1]. Above 1 the power goes on, as a rendering's highlights need a gradient: clamp where the picture is
/// written. Below 0 the straight piece goes on (kornia, multinerf and instant-ngp); CSS mirrors the curve there, others clamp. Light
/// isn't negative, and no case asks.
///
/// ```
/// use nerf_oracle::srgb::linear_to_srgb;
/// assert_eq!(linear_to_srgb(0.0), 0.0);
/// assert!((linear_to_srgb(1.0) - 1.0).abs() < 1e-15);
/// ```
pub fn linear_to_srgb(x: f64) -> f64 {
    if x <= THRESHOLD { 12.92 * x } else { 1.055 * pow(x, 1.0 / 2.4) - 0.055 }
}
