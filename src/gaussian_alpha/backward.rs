//! Vector-Jacobian product of a splat's opacity at a pixel, by hand. `g` is the gradient of the loss with respect to it.

use super::{Form, Splat, cap, offset, power, skipped};
use crate::convention::{CapGradient, ConicGradient};
use crate::math::exp;

/// Gradients with respect to the splat's mean, conic and opacity; over several pixels they add up.
///
/// With G = e^power: g_opacity = g G, g_power = g opacity G, g_mean = g_power (A d_x + B d_y, B d_x + C d_y), and of the conic
/// -g_power (d_x^2 / 2, d_x d_y, d_y^2 / 2).
///
/// # Convention
/// 0 where the splat is skipped, and where its opacity is capped, unless the cap isn't differentiated
/// ([`CapGradient::Through`]). B stands in the conic's matrix twice: [`ConicGradient::Entry`] is the gradient of one of these.
///
/// ```
/// use nerf_oracle::gaussian_alpha::{Form, Splat, backward};
/// let splat = Splat { mean: [2.0, 2.0], conic: [1.0, 0.0, 0.5], opacity: 0.5 };
/// let g = backward::alpha([2.0, 2.0], &splat, Form::default(), 1.0);
/// assert_eq!((g.mean, g.opacity), ([0.0, 0.0], 1.0));
/// ```
pub fn alpha(pixel: [f64; 2], splat: &Splat, form: Form, g: f64) -> Splat {
    let ([x, y], [a, b, c]) = (offset(pixel, splat), splat.conic);
    let (power, cap) = (power(pixel, splat), cap(form));
    let alpha = splat.opacity * exp(power);
    let capped = alpha > cap && form.cap_gradient == CapGradient::Stopped;
    if capped || skipped(power, alpha.min(cap), form) {
        return Splat { mean: [0.0; 2], conic: [0.0; 3], opacity: 0.0 };
    }
    let g_power = g * alpha;
    let once = if form.conic_gradient == ConicGradient::Entry { 0.5 } else { 1.0 };
    Splat {
        mean: [g_power * (a * x + b * y), g_power * (b * x + c * y)],
        conic: [-0.5 * g_power * x * x, -once * g_power * x * y, -0.5 * g_power * y * y],
        opacity: g * exp(power),
    }
}
