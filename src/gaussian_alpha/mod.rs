//! How opaque a splat is at a pixel: its opacity, less with the distance from its middle.
//!
//! 3D Gaussian Splatting (Kerbl et al. 2023), equations 3 and 4. Letters: `d` from the splat's mean to the pixel, (A, B, C) its conic.

use crate::convention::{AlphaCap, CapGradient, ConicGradient, Faint, PositivePower};
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

/// How code bases cut opacities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Form {
    /// The largest opacity.
    pub cap: AlphaCap,
    /// What becomes of opacities below 1 / 255.
    pub faint: Faint,
    /// What becomes of splats that grow with the distance.
    pub power: PositivePower,
    /// Whether an opacity at the cap has a gradient.
    pub cap_gradient: CapGradient,
    /// What the gradient of B is.
    pub conic_gradient: ConicGradient,
}

/// A splat in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// Its mean, in pixels.
    pub mean: [f64; 2],
    /// The inverse of its covariance: of x, of both, of y.
    pub conic: [f64; 3],
    /// Its opacity in its middle.
    pub opacity: f64,
}

/// min(cap, opacity exp(-1/2 (A d_x^2 + C d_y^2) - B d_x d_y)).
///
/// # Shapes
/// One pixel and one splat to an opacity.
///
/// # Units
/// Pixels; the opacity from 0 to 1.
///
/// # Convention
/// `form` says where opacities are capped, whether faint ones are skipped, and those whose exponent is above 0: a conic that isn't
/// positive, as rounding leaves it. The Gaussian isn't normalized: its largest value is 1, whatever its size.
///
/// ```
/// use nerf_oracle::gaussian_alpha::{Form, Splat, alpha};
/// let splat = Splat { mean: [2.0, 2.0], conic: [1.0, 0.0, 0.5], opacity: 0.5 };
/// assert_eq!(alpha([2.0, 2.0], &splat, Form::default()), 0.5);
/// assert_eq!(alpha([2.0, 4.0], &splat, Form::default()), 0.5 * nerf_oracle::math::exp(-1.0));
/// ```
pub fn alpha(pixel: [f64; 2], splat: &Splat, form: Form) -> f64 {
    let power = power(pixel, splat);
    let alpha = (splat.opacity * exp(power)).min(cap(form));
    if skipped(power, alpha, form) { 0.0 } else { alpha }
}

/// From the splat's mean to the pixel.
fn offset(pixel: [f64; 2], splat: &Splat) -> [f64; 2] {
    [pixel[0] - splat.mean[0], pixel[1] - splat.mean[1]]
}

/// The exponent.
fn power(pixel: [f64; 2], splat: &Splat) -> f64 {
    let ([x, y], [a, b, c]) = (offset(pixel, splat), splat.conic);
    -0.5 * (a * x * x + c * y * y) - b * x * y
}

/// The largest opacity: without a cap that of a splat that grows may be above 1.
fn cap(form: Form) -> f64 {
    if form.cap == AlphaCap::None { f64::INFINITY } else { form.cap.value() }
}

/// Whether the splat isn't seen at this pixel.
fn skipped(power: f64, alpha: f64, form: Form) -> bool {
    let grows = form.power == PositivePower::Skipped && power > 0.0;
    grows || form.faint == Faint::Skipped && alpha < 1.0 / 255.0
}
