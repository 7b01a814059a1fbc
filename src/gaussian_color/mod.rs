//! The color of a splat from where it is seen: spherical harmonics of the direction from the camera to its mean.
//!
//! 3D Gaussian Splatting (Kerbl et al. 2023), section 4, after Plenoxels (Fridovich-Keil et al. 2022). Letters: `d` from the camera to the
//! mean, `Y_k` the harmonics of d / |d| ([`crate::spherical_harmonics`]), `f_k` their coefficients.

use crate::convention::{HarmonicForm, HarmonicSign, SplatColor};
use crate::spherical_harmonics::harmonics;

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

/// How colors are made of harmonics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    /// The sign of the harmonics of odd m.
    pub sign: HarmonicSign,
    /// What is made of the sum.
    pub color: SplatColor,
}

/// max(sum_k f_k Y_k(d / |d|) + 1/2, 0), d = mean - center.
///
/// # Shapes
/// A mean, the camera's center and (degree + 1)^2 coefficients of three channels, band by band, to a color.
///
/// # Units
/// Colors from 0; nothing keeps them below 1.
///
/// # Convention
/// The direction goes from the camera to the splat. `form` says the harmonics' sign, and whether 1/2 is added and the result clamped. A
/// mean in the camera's center has no direction.
///
/// # Panics
/// Where the number of coefficients isn't 1, 4, 9, 16 or 25.
///
/// ```
/// use nerf_oracle::convention::{HarmonicSign::Alternating, SplatColor::Clamped};
/// use nerf_oracle::gaussian_color::{Form, color};
/// let form = Form { sign: Alternating, color: Clamped };
/// // The first harmonic is 1 / sqrt(4 pi), whatever the direction.
/// let gray = color([1.0, 2.0, 3.0], [0.0; 3], &[[0.0, 1.0, -2.0]], form);
/// assert_eq!((gray[0], gray[2]), (0.5, 0.0));
/// assert!((gray[1] - 0.5 - 0.5 / std::f64::consts::PI.sqrt()).abs() < 1e-15);
/// ```
pub fn color(mean: [f64; 3], center: [f64; 3], coefficients: &[[f64; 3]], form: Form) -> [f64; 3] {
    let y = harmonics(direction(mean, center), degree(coefficients), HarmonicForm::Normalized, form.sign);
    sum(&y, coefficients).map(|sum| match form.color {
        SplatColor::Clamped => (sum + 0.5).max(0.0),
        SplatColor::Shifted => sum + 0.5,
        SplatColor::Sum => sum,
    })
}

/// From the camera to the mean.
fn direction(mean: [f64; 3], center: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| mean[k] - center[k])
}

/// The last band of these coefficients.
fn degree(coefficients: &[[f64; 3]]) -> usize {
    let found = (0..5).find(|degree| (degree + 1) * (degree + 1) == coefficients.len());
    found.expect("coefficients: 1, 4, 9, 16 or 25, those of whole bands")
}

/// sum_k f_k Y_k.
fn sum(y: &[f64], coefficients: &[[f64; 3]]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (y, f) in y.iter().zip(coefficients) {
        for channel in 0..3 {
            sum[channel] += y * f[channel];
        }
    }
    sum
}
