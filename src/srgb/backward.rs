//! The slope of the sRGB curve, by hand.

use super::THRESHOLD;
use crate::math::pow;

/// 12.92 g for x <= 0.0031308, g (1.055 / 2.4) x^(1/2.4 - 1) above.
///
/// # Convention
/// At the threshold, which has no derivative, the slope is that of the straight piece. At 0 it is 12.92, where the power alone would
/// have an infinite one.
///
/// ```
/// use nerf_oracle::srgb::backward::linear_to_srgb;
/// assert_eq!(linear_to_srgb(0.0, 2.0), 25.84);
/// assert!((linear_to_srgb(1.0, 2.4) - 1.055).abs() < 1e-15);
/// ```
pub fn linear_to_srgb(x: f64, g: f64) -> f64 {
    if x <= THRESHOLD { 12.92 * g } else { g * (1.055 / 2.4) * pow(x, 1.0 / 2.4 - 1.0) }
}
