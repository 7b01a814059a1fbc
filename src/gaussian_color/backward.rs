//! Vector-Jacobian product of a splat's color, by hand. `g` is the gradient of the loss with respect to the color.

use super::{Form, degree, direction, sum};
use crate::convention::{HarmonicForm, SplatColor};
use crate::spherical_harmonics::{backward, harmonics};

/// Gradients with respect to the mean and to the coefficients.
///
/// g_f_k = g Y_k, g_Y_k = g . f_k, from there through the harmonics and the direction's length to d, and g_mean = g_d: a splat that moves
/// is seen from elsewhere.
///
/// # Convention
/// Where a channel is clamped, its gradient is 0; at 0 itself, which is a kink, it is g, as PyTorch's `clamp_min` has it.
///
/// # Panics
/// Where the number of coefficients isn't 1, 4, 9, 16 or 25.
///
/// ```
/// use nerf_oracle::convention::{HarmonicSign::Alternating, SplatColor::Clamped};
/// use nerf_oracle::gaussian_color::{Form, backward};
/// let form = Form { sign: Alternating, color: Clamped };
/// let (g_mean, g_f) = backward::color([1.0, 2.0, 3.0], [0.0; 3], &[[0.0, 1.0, -2.0]], form, [1.0; 3]);
/// assert_eq!((g_mean, g_f[0][2]), ([0.0; 3], 0.0));
/// assert_eq!(g_f[0][0], 0.282_094_791_773_878_14);
/// ```
pub fn color(
    mean: [f64; 3],
    center: [f64; 3],
    coefficients: &[[f64; 3]],
    form: Form,
    g: [f64; 3],
) -> ([f64; 3], Vec<[f64; 3]>) {
    let (d, degree) = (direction(mean, center), degree(coefficients));
    let y = harmonics(d, degree, HarmonicForm::Normalized, form.sign);
    let (mut g, found) = (g, sum(&y, coefficients));
    for channel in 0..3 {
        if form.color == SplatColor::Clamped && found[channel] + 0.5 < 0.0 {
            g[channel] = 0.0;
        }
    }
    let (mut g_y, mut g_f) = (vec![], vec![]);
    for (y, f) in y.iter().zip(coefficients) {
        g_y.push(g[0] * f[0] + g[1] * f[1] + g[2] * f[2]);
        g_f.push(g.map(|g| g * y));
    }
    (backward::harmonics(d, degree, HarmonicForm::Normalized, form.sign, &g_y), g_f)
}
