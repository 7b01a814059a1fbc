//! Splats' opacities, wrong on purpose. Without a mistake every function equals the oracle.

use std::f64::consts::PI;

use super::arrays::{form, forward, six, total, vjp};
use super::{Form, Splat, alpha as oracle, backward, cap, offset, power, skipped};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::{AlphaCap, CapGradient, Conventions};
use crate::math::{exp, expm1};

pub(crate) mod laws;
mod numbers;

use numbers::{BELOW, CAPPED, CAPPED_BEFORE, CIRCLE, CUT, DILATED, FLOORED, SCALED, SQUARE};

const FAINT_OPACITY: Mistake = Mistake::new(
    "faint_opacity_skipped",
    "0 where the splat's own opacity is below k, and not where alpha is",
    "nothing but time lost: a faint splat's edge counts, a whole faint splat doesn't",
    "alpha below 1 / 255",
    "1 renderer in Python",
    1,
)
.with("k", 1.0 / 255.0, [1e-4, 0.5]);

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
        "middle_skipped",
        "0 where the exponent isn't below 0: the middle of a splat, too",
        "a hole of one pixel where a splat's middle is a pixel's",
        "skip exponents above 0 alone",
        "a port of splats to PyTorch for a course: exp(power) >= 1",
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
    Mistake::new(
        "gradient_of_the_capped",
        "gradients of an opacity above its cap (0.99, where there is none) as if it weren't, times what the cap leaves of it: by alpha and alpha / opacity",
        "what is opaque goes on learning, in steps of another size",
        "0 at the cap, or through it with what alpha was before",
        "1 splat renderer in Metal",
        1,
    )
    .of_gradient(),
    CUT,
    FLOORED,
    Mistake::new(
        "exponent_not_above_zero",
        "exp(min(-1/2 d^T conic d, 0))",
        "splats whose conic isn't positive any more cover the picture with their opacity",
        "skip what grows with the distance, or leave it",
        "a WGSL shader",
        1,
    ),
    SCALED,
    BELOW,
    CAPPED,
    CAPPED_BEFORE,
    CIRCLE,
    SQUARE,
    FAINT_OPACITY,
    DILATED,
    Mistake::new(
        "conic_in_another_order",
        "(A, B, C) read as (A, C, B): what lies between x and y stands last",
        "splats are wide along one axis, and lean the wrong way",
        "the conic in the order in which it was written",
        "a Vulkan rasterizer",
        1,
    ),
    Mistake::new(
        "mean_rounded",
        "the mean is rounded to a whole pixel",
        "splats jump from pixel to pixel as they move",
        "d from the mean as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "same_distance_twice",
        "dx in the place of dy",
        "splats are stripes",
        "dy = y - mean_y",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "cross_term_forgotten",
        "-1/2 (A dx^2 + C dy^2)",
        "slanted splats lie along the axes",
        "and B dx dy",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "cross_term_doubled",
        "B dx dy twice",
        "slanted splats are too thin, or grow without bound",
        "B dx dy once: 1/2 stands in front of both of the matrix's",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "cross_term_sign",
        "+ B dx dy",
        "slanted splats lean to the other side",
        "- B dx dy",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "pixels_half_off",
        "half a pixel is added to pixels that have their centers already",
        "the picture is shifted by half a pixel",
        "pixels as they are handed over",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "opacity_through_sigmoid",
        "sigmoid(opacity) of what is an opacity already",
        "nothing is fainter than 1/2",
        "the opacity as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "alpha_as_density",
        "1 - exp(-opacity Gaussian)",
        "nothing is more opaque than 0.63",
        "opacity times the Gaussian",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "distance_not_squared",
        "exp(-1/2 sqrt(d^T conic d))",
        "splats with a peak and long tails",
        "-1/2 d^T conic d",
        "never; cheap to keep",
        0,
    ),
];

/// An opacity with what is wrong about it.
fn wrong_alpha(pixel: [f64; 2], splat: &Splat, form: Form, wrong: &[&str]) -> f64 {
    let has = |name: &str| wrong.contains(&name);
    let pixel = if has("axes_swapped") { [pixel[1], pixel[0]] } else { pixel };
    let ([mut x, mut y], [mut a, mut b, mut c]) = (offset(pixel, splat), splat.conic);
    match () {
        () if has("mean_rounded") => [x, y] = [0, 1].map(|k| pixel[k] - libm::rint(splat.mean[k])),
        () if has("pixels_half_off") => [x, y] = [x + 0.5, y + 0.5],
        () if has("same_distance_twice") => y = x,
        () => {}
    }
    if has("conic_in_another_order") {
        (b, c) = (c, b);
    }
    if let Some(k) = DILATED.among(wrong) {
        let det = a * c - b * b;
        let (p, q, s) = (c / det + k, -b / det, a / det + k);
        let under = p * s - q * q;
        (a, b, c) = (s / under, -q / under, p / under);
    }
    let det = a * c - b * b;
    if has("covariance_for_conic") {
        (a, b, c) = (c / det, -b / det, a / det);
    }
    let cross = match () {
        () if has("cross_term_halved") => 0.5 * b,
        () if has("cross_term_forgotten") => 0.0,
        () if has("cross_term_doubled") => 2.0 * b,
        () if has("cross_term_sign") => -b,
        () => b,
    };
    let half = -0.5 * (a * x * x + c * y * y) - cross * x * y;
    let power = match () {
        () if has("half_forgotten") => 2.0 * half,
        () if has("distance_not_squared") => -0.5 * (-2.0 * half).max(0.0).sqrt(),
        () => half,
    };
    let power = SCALED.among(wrong).map_or(power, |k| 2.0 * k * power);
    let power = FLOORED.among(wrong).map_or(power, |k| power.max(-k));
    let power = if has("exponent_not_above_zero") { power.min(0.0) } else { power };
    let opacity = match () {
        () if has("opacity_forgotten") => 1.0,
        () if has("opacity_through_sigmoid") => 1.0 / (1.0 + exp(-splat.opacity)),
        () => splat.opacity,
    };
    let factor = if has("gaussian_normalized") { det.max(0.0).sqrt() / (2.0 * PI) } else { 1.0 };
    let gaussian = exp(power).min(CAPPED_BEFORE.among(wrong).unwrap_or(f64::INFINITY));
    let whole = opacity * gaussian * factor;
    let whole = if has("alpha_as_density") { -expm1(-whole) } else { whole };
    let alpha = whole.min(cap(form)).min(CAPPED.among(wrong).unwrap_or(f64::INFINITY));
    let sigmas = CUT.among(wrong).or(has("cut_at_three_sigmas").then_some(3.0));
    let cut = sigmas.is_some_and(|k| power < -0.5 * k * k) || BELOW.among(wrong).is_some_and(|k| alpha < k);
    let cut = cut || has("middle_skipped") && power >= 0.0;
    let cut = cut || FAINT_OPACITY.among(wrong).is_some_and(|k| splat.opacity < k);
    let outside = CIRCLE.among(wrong).is_some_and(|k| x.hypot(y) > radius(splat.conic, k))
        || SQUARE.among(wrong).is_some_and(|k| x.abs().max(y.abs()) > radius(splat.conic, k));
    if cut || outside || skipped(power, alpha, form) { 0.0 } else { alpha }
}

/// k deviations along the long axis of a conic, rounded up: those of its smaller eigenvalue.
fn radius([a, b, c]: [f64; 3], k: f64) -> f64 {
    let least = 0.5 * (a + c) - (0.25 * (a - c) * (a - c) + b * b).sqrt();
    (k / least.sqrt()).ceil()
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
    let has = |name: &str| wrong.contains(&name);
    let one = |pixel: [f64; 2], splat: &Splat, g: f64| {
        let mut all = six(&backward::alpha(pixel, splat, form(c), g));
        if has("gradient_of_the_capped") {
            all = six(&of_capped(pixel, splat, form(c), g));
        }
        if has("mean_gradient_negated") {
            (all[0], all[1]) = (-all[0], -all[1]);
        }
        if has("opacity_gradient_of_alpha") {
            all[5] *= splat.opacity;
        }
        if has("gradient_by_division") {
            all[5] = all[5] * splat.opacity / splat.opacity;
        }
        if has("power_held") {
            all[..5].fill(0.0);
        }
        all
    };
    let last = |parts: &[f64]| parts.last().copied().unwrap_or_default();
    if has("last_pixel_alone") { vjp(a, one, last) } else { vjp(a, one, total) }
}

/// The gradient of a capped opacity as if it weren't, by its value: alpha for opacity G.
fn of_capped(pixel: [f64; 2], splat: &Splat, form: Form, g: f64) -> Splat {
    let through = Form { cap_gradient: CapGradient::Through, ..form };
    let whole = splat.opacity * exp(power(pixel, splat));
    // A program that caps in its backward pass alone has the usual cap.
    let most = if form.cap == AlphaCap::None { 0.99 } else { cap(form) };
    let part = if whole > most { most / whole } else { 1.0 };
    backward::alpha(pixel, splat, through, part * g)
}
