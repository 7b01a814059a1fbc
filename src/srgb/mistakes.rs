//! The sRGB curve, wrong on purpose. Without a mistake every function equals the oracle.

pub(crate) mod laws;

use super::arrays::{forward, vjp};
use super::{THRESHOLD, backward, linear_to_srgb as oracle};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::math::pow;

/// Where the way back, sRGB to linear, changes its piece.
const THRESHOLD_BACK: f64 = 0.04045;

/// Mistakes of the sRGB curve.
pub(crate) const LINEAR_TO_SRGB: &[Mistake] = &[
    Mistake::new(
        "gamma_2_2",
        "x^(1/2.2)",
        "close to sRGB in the middle, up to 0.03 too bright in the shadows, an infinite gradient at 0",
        "the two pieces of the standard",
        "ray tracers and differentiable renderers that say sRGB (three read)",
        3,
    ),
    Mistake::new(
        "threshold_of_the_way_back",
        "12.92 x for x <= 0.04045, the threshold of sRGB values",
        "shadows up to 2.3 times too bright, a step at 0.04045",
        "0.0031308 for linear values, 0.04045 for sRGB values",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "exponent_swapped",
        "1.055 x^2.4 - 0.055",
        "pictures far too dark, below 0 in the shadows",
        "1/2.4 toward sRGB, 2.4 back",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "way_back",
        "sRGB to linear: x / 12.92, ((x + 0.055) / 1.055)^2.4 above 0.04045",
        "pictures far too dark",
        "the other function",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "applied_twice",
        "the curve of what is sRGB already",
        "pictures washed out and too bright",
        "once, where linear light becomes a picture",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "offset_forgotten",
        "1.055 x^(1/2.4)",
        "everything but black too bright by 0.055, white above 1",
        "- 0.055 after the power",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "straight_piece_forgotten",
        "1.055 x^(1/2.4) - 0.055 for every x",
        "black is -0.055, and its gradient infinite",
        "12.92 x for x <= 0.0031308",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "scale_under_the_power",
        "(1.055 x)^(1/2.4) - 0.055",
        "pictures too dark by 3%, white is 0.968",
        "1.055 outside of the power",
        "a script for color correction",
        1,
    ),
    Mistake::new(
        "offset_in_the_exponent",
        "1.055 x^(1/2.4 - 0.055)",
        "pictures too bright, most of all in the shadows; white is 1.055",
        "close the bracket before - 0.055",
        "a virtual-world client's color utilities, where the bracket closes too late",
        1,
    ),
    Mistake::new(
        "exponent_rounded",
        "x^0.41666",
        "too bright by 9e-5 of the value in the shadows: nothing to see, a thousand roundings in single precision",
        "1/2.4, or 0.41666667",
        "ports of three.js, and what follows OpenGL's specification, which prints five digits (six read)",
        6,
    ),
    Mistake::new(
        "clamped",
        "clamped to [0, 1] first",
        "no gradient in highlights: a training can't darken what is too bright",
        "clamp where the picture is written, not in the loss",
        "relighting codes that clamp in front of the curve (four read), some where it is meant",
        4,
    ),
    Mistake::new(
        "gradient_clamped",
        "0 above 1: the gradient of a clamp in front of the curve",
        "a training can't darken what is too bright",
        "clamp where the picture is written, not in the loss",
        "relighting codes that clamp in front of the curve, differentiated automatically (three read)",
        3,
    )
    .of_gradient(),
    Mistake::new(
        "not_a_number_at_black",
        "both pieces differentiated, one selected: 0 times the power's infinite slope at 0",
        "one black pixel makes every parameter NaN",
        "clamp the power's argument from below at the threshold, inside of the selection",
        "torch.where without such a clamp, differentiated automatically (three read)",
        3,
    )
    .of_gradient(),
    Mistake::new(
        "straight_slope_missing",
        "0 for x <= 0.0031308",
        "what is black stays black",
        "12.92 there",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "slope_dropped",
        "grad_srgb handed through",
        "shadows learn up to 13 times too slowly, highlights too fast",
        "times the slope",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "exponent_not_lowered",
        "g (1.055 / 2.4) x^(1/2.4)",
        "shadows learn too slowly, highlights too fast",
        "x^(1/2.4 - 1)",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    PURE_POWER,
    OTHER_THRESHOLD,
    OTHER_SLOPE,
    Mistake::new(
        "television_curve",
        "4.5 x below 0.018, else 1.099 x^0.45 - 0.099: the curve of Rec. 709",
        "too dark in the shadows",
        "12.92 x below 0.0031308, else 1.055 x^(1/2.4) - 0.055",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "pieces_exchanged",
        "the power below the threshold, the straight piece above",
        "white is 12.92: pictures burn out",
        "the straight piece below",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "tone_mapped",
        "x / (1 + x) in front of the curve",
        "white is gray",
        "tone mapping where it is meant, the curve alone here",
        "never; cheap to keep",
        0,
    ),
];

const PURE_POWER: Mistake = Mistake::new(
    "power_alone",
    "x^k",
    "too dark in the shadows, or too bright; an infinite gradient at 0",
    "the curve of two pieces",
    "1/2.4 without the straight piece, square roots; never seen here",
    0,
)
.with("k", 0.4166666666666667, [0.2, 0.9]);
const OTHER_THRESHOLD: Mistake = Mistake::new(
    "another_threshold",
    "the pieces meet elsewhere than at 0.0031308",
    "a step in the shadows",
    "0.0031308",
    "never; cheap to keep",
    0,
)
.with("at", 0.031308, [1e-7, 0.5]);
const OTHER_SLOPE: Mistake = Mistake::new(
    "another_slope",
    "k x below the threshold, with a mistyped k",
    "a step in the shadows",
    "12.92 x",
    "never; cheap to keep",
    0,
)
.with("k", 12.32, [0.01, 100.0]);

/// The way back: sRGB to linear light.
fn way_back(x: f64) -> f64 {
    if x <= THRESHOLD_BACK { x / 12.92 } else { pow((x + 0.055) / 1.055, 2.4) }
}

/// 1.055 x^(1/2.4) - 0.055 with what is wrong in it.
fn curved(x: f64, wrong: &[&str]) -> f64 {
    let (mut scale, mut exponent, mut offset, mut inside) = (1.055, 1.0 / 2.4, 0.055, x);
    for name in wrong {
        match *name {
            "exponent_swapped" => exponent = 2.4,
            "exponent_rounded" => exponent = 0.41666,
            "offset_forgotten" => offset = 0.0,
            "scale_under_the_power" => (scale, inside) = (1.0, 1.055 * x),
            "offset_in_the_exponent" => (exponent, offset) = (exponent - 0.055, 0.0),
            _ => {}
        }
    }
    scale * pow(inside, exponent) - offset
}

/// The curve.
pub(crate) fn linear_to_srgb(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let has = |name: &str| wrong.contains(&name);
    forward(a, |x| {
        let x = if has("clamped") { x.clamp(0.0, 1.0) } else { x };
        let x = if has("applied_twice") { oracle(x) } else { x };
        let threshold = if has("threshold_of_the_way_back") { THRESHOLD_BACK } else { THRESHOLD };
        let threshold = OTHER_THRESHOLD.among(wrong).unwrap_or(threshold);
        let x = if has("tone_mapped") { x / (1.0 + x) } else { x };
        let straight = (x <= threshold) != has("pieces_exchanged");
        if has("television_curve") {
            if x < 0.018 { 4.5 * x } else { 1.099 * pow(x, 0.45) - 0.099 }
        } else if let Some(k) = PURE_POWER.among(wrong) {
            pow(x, k)
        } else if has("way_back") {
            way_back(x)
        } else if has("gamma_2_2") {
            pow(x, 1.0 / 2.2)
        } else if straight && !has("straight_piece_forgotten") {
            OTHER_SLOPE.among(wrong).unwrap_or(12.92) * x
        } else {
            curved(x, wrong)
        }
    })
}

/// Its gradient.
pub(crate) fn linear_to_srgb_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    vjp(a, |x, g| match wrong.first() {
        Some(&"gradient_clamped") if x > 1.0 => 0.0,
        Some(&"not_a_number_at_black") if x == 0.0 => f64::NAN,
        Some(&"straight_slope_missing") if x <= THRESHOLD => 0.0,
        Some(&"slope_dropped") => g,
        Some(&"exponent_not_lowered") if x > THRESHOLD => g * (1.055 / 2.4) * pow(x, 1.0 / 2.4),
        _ => backward::linear_to_srgb(x, g),
    })
}
