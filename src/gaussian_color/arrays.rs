//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{Form, backward, color as oracle};
use crate::contract::arrays::{Arrays, array, arrays, input, rows3, threes};
use crate::convention::Conventions;

/// How colors are made of harmonics.
pub(crate) fn form(c: &Conventions) -> Form {
    Form { sign: c.harmonic_sign, color: c.splat_color }
}

/// Each splat's mean and coefficients.
fn splats(a: &Arrays) -> Vec<([f64; 3], Vec<[f64; 3]>)> {
    let means = threes(a, "means").into_iter().enumerate();
    means.map(|(n, mean)| (mean, rows3(a, "coefficients", n))).collect()
}

/// Where the camera is.
pub(crate) fn center(a: &Arrays) -> [f64; 3] {
    threes(a, "camera_center")[0]
}

/// `f(mean, center, coefficients)` of each splat, as the output.
pub(crate) fn forward(a: &Arrays, f: impl Fn([f64; 3], [f64; 3], &[[f64; 3]]) -> [f64; 3]) -> Arrays {
    let splats = splats(a);
    let colors = splats.iter().flat_map(|(mean, coefficients)| f(*mean, center(a), coefficients)).collect();
    arrays([("colors", array(&[splats.len(), 3], colors))])
}

/// `f(mean, center, coefficients, cotangent)` of each splat, as the gradients.
pub(crate) fn vjp(
    a: &Arrays,
    f: impl Fn([f64; 3], [f64; 3], &[[f64; 3]], [f64; 3]) -> ([f64; 3], Vec<[f64; 3]>),
) -> Arrays {
    let splats = splats(a).into_iter().zip(threes(a, "grad_colors"));
    let (g_means, g_f): (Vec<_>, Vec<_>) = splats.map(|((mean, f_k), g)| f(mean, center(a), &f_k, g)).unzip();
    arrays([
        ("grad_means", array(&[g_means.len(), 3], g_means.concat())),
        (
            "grad_coefficients",
            array(input(a, "coefficients").shape(), g_f.into_iter().flatten().flatten().collect()),
        ),
    ])
}

pub(super) fn color(a: &Arrays, c: &Conventions) -> Arrays {
    forward(a, |mean, center, f| oracle(mean, center, f, form(c)))
}

pub(super) fn color_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    vjp(a, |mean, center, f, g| backward::color(mean, center, f, form(c), g))
}
