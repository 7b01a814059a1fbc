//! The surrogate gradient of the truncated exponential, by hand.

use super::{held, shifted};
use crate::convention::{ExponentGradient, ExponentShift};
use crate::math::exp;

/// g e^clamp(x, -15, 15): the derivative inside [-15, 15], a bounded stand-in outside; by convention clamped from above alone, and of
/// x - 1.
///
/// It is the derivative of a function that continues as a straight line at both ends, not of [`super::trunc_exp`]: a check by
/// differences must fail outside and compare with that function instead (VR6).
///
/// ```
/// use nerf_oracle::convention::{ExponentGradient::{Above, BothEnds}, ExponentShift};
/// use nerf_oracle::trunc_exp::backward::trunc_exp;
/// let gradient = |x, g, held| trunc_exp(x, g, held, ExponentShift::None);
/// assert_eq!(gradient(0.0, 2.0, BothEnds), 2.0);
/// assert_eq!(gradient(800.0, 1.0, BothEnds), gradient(15.0, 1.0, Above));
/// assert!(gradient(-30.0, 1.0, Above) < 1e-6 * gradient(-30.0, 1.0, BothEnds));
/// ```
pub fn trunc_exp(x: f64, g: f64, gradient: ExponentGradient, shift: ExponentShift) -> f64 {
    g * exp(held(shifted(x, shift), gradient))
}
