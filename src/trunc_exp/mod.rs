//! Density as e^x with a gradient that can't overflow.
//!
//! Instant-NGP's density activation, as torch-ngp and nerfstudio call it: forward e^x, backward with the argument held to
//! [-15, 15]. The gradient is a surrogate and says so (VR6): outside that range it isn't the derivative.

use crate::maths::exp;

#[cfg(test)]
mod tests;

/// Where the surrogate gradient stops growing.
pub const LIMIT: f64 = 15.0;

/// sigma = e^x.
///
/// ```
/// assert_eq!(nerf_oracle::trunc_exp::forward(0.0), 1.0);
/// ```
pub fn forward(x: f64) -> f64 {
    exp(x)
}

/// g e^clamp(x, -15, 15): the derivative inside [-15, 15], a bounded stand-in outside.
///
/// ```
/// use nerf_oracle::trunc_exp::backward;
/// assert_eq!(backward(0.0, 2.0), 2.0);
/// assert_eq!(backward(800.0, 1.0), backward(15.0, 1.0));
/// ```
pub fn backward(x: f64, g: f64) -> f64 {
    g * exp(x.clamp(-LIMIT, LIMIT))
}
