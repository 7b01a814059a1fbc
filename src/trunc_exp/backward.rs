//! The surrogate gradient of the truncated exponential, by hand.

use super::LIMIT;
use crate::math::exp;

/// g e^clamp(x, -15, 15): the derivative inside [-15, 15], a bounded stand-in outside.
///
/// It is the derivative of a function that continues as a straight line at both ends, not of [`super::trunc_exp`]: a check by
/// differences must fail outside and compare with that function instead (VR6).
///
/// ```
/// use nerf_oracle::trunc_exp::backward::trunc_exp;
/// assert_eq!(trunc_exp(0.0, 2.0), 2.0);
/// assert_eq!(trunc_exp(800.0, 1.0), trunc_exp(15.0, 1.0));
/// ```
pub fn trunc_exp(x: f64, g: f64) -> f64 {
    g * exp(x.clamp(-LIMIT, LIMIT))
}
