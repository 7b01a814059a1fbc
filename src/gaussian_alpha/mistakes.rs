//! Splats' opacities, wrong on purpose. Without a mistake every function equals the oracle.

use std::f64::consts::PI;

use super::arrays::{form, forward, six, total, vjp};
use super::{Form, Splat, alpha as oracle, backward, cap, offset, skipped};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::math::exp;

/// Mistakes of splats' opacities.
pub(crate) const GAUSSIAN_ALPHA: &[Mistake] = &[
    Mistake::new(
        "half_forgotten",
        "exp(-d^T conic d)",
        "splats are smaller by the root of 2",
        "-1/2 d^T conic d",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "cross_term_halved",
        "-1/2 (A dx^2 + B dx dy + C dy^2)",
        "slanted splats are too round",
        "B dx dy as a whole: it stands in the matrix twice",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "covariance_for_conic",
        "the conic is inverted once more, or the covariance was handed over",
        "small splats cover the picture, large ones vanish",
        "the inverse of the covariance",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "axes_swapped",
        "(row, column) for (x, y) of the pixel",
        "splats are drawn mirrored along the diagonal",
        "x along the width",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "opacity_forgotten",
        "the Gaussian alone",
        "every splat is opaque in its middle",
        "times the opacity",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "gaussian_normalized",
        "divided by 2 pi sqrt(det Sigma), as a probability is",
        "large splats are nearly invisible",
        "the Gaussian's largest value is 1",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "cut_at_three_sigmas",
        "0 where d^T conic d > 9",
        "splats end in a rim of up to 1% of their opacity",
        "cut where alpha falls below 1/255, or nowhere",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "mean_gradient_negated",
        "the gradient of the pixel as that of the mean",
        "means run away from where they should be",
        "d = pixel - mean: minus its gradient",
        "kernels that mix d = pixel - mean with d = mean - pixel",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "opacity_gradient_of_alpha",
        "g alpha as the gradient of the opacity",
        "faint splats stay faint: the factor opacity is too much",
        "g times the Gaussian",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "gradient_by_division",
        "g alpha / opacity",
        "NaN at an opacity of 0",
        "g times the Gaussian",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "power_held",
        "the gradient of the opacity alone: the Gaussian is held constant",
        "splats fade and brighten, and never move",
        "and through the exponent to mean and conic",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "last_pixel_alone",
        "gradients written, not added: the last pixel's remain",
        "noise that depends on the order of threads",
        "the sum over pixels, atomically where threads share a splat",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// An opacity with what is wrong about it.
fn wrong_alpha(pixel: [f64; 2], splat: &Splat, form: Form, wrong: &[&str]) -> f64 {
    let has = |name: &str| wrong.contains(&name);
    let pixel = if has("axes_swapped") { [pixel[1], pixel[0]] } else { pixel };
    let ([x, y], [mut a, mut b, mut c]) = (offset(pixel, splat), splat.conic);
    let det = a * c - b * b;
    if has("covariance_for_conic") {
        (a, b, c) = (c / det, -b / det, a / det);
    }
    let cross = if has("cross_term_halved") { 0.5 * b } else { b };
    let half = -0.5 * (a * x * x + c * y * y) - cross * x * y;
    let power = if has("half_forgotten") { 2.0 * half } else { half };
    let opacity = if has("opacity_forgotten") { 1.0 } else { splat.opacity };
    let factor = if has("gaussian_normalized") { det.max(0.0).sqrt() / (2.0 * PI) } else { 1.0 };
    let alpha = (opacity * exp(power) * factor).min(cap(form));
    let cut = has("cut_at_three_sigmas") && power < -4.5;
    if cut || skipped(power, alpha, form) { 0.0 } else { alpha }
}

/// Opacities.
pub(crate) fn alpha(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    forward(a, |pixel, splat| match wrong {
        [] => oracle(pixel, splat, form(c)),
        wrong => wrong_alpha(pixel, splat, form(c), wrong),
    })
}

/// Their gradients.
pub(crate) fn alpha_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let name = wrong.first().copied();
    let one = |pixel: [f64; 2], splat: &Splat, g: f64| {
        let mut all = six(&backward::alpha(pixel, splat, form(c), g));
        match name {
            Some("mean_gradient_negated") => (all[0], all[1]) = (-all[0], -all[1]),
            Some("opacity_gradient_of_alpha") => all[5] *= splat.opacity,
            Some("gradient_by_division") => all[5] = all[5] * splat.opacity / splat.opacity,
            Some("power_held") => all[..5].fill(0.0),
            _ => {}
        }
        all
    };
    let last = |parts: &[f64]| parts.last().copied().unwrap_or_default();
    if name == Some("last_pixel_alone") { vjp(a, one, last) } else { vjp(a, one, total) }
}
