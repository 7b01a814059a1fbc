//! The truncated exponential, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{forward, vjp};
use super::{LIMIT, argument, backward, density};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::math::{exp, pow};

/// Mistakes of the truncated exponential.
pub const TRUNC_EXP: &[Mistake] = &[
    Mistake::new(
        "bias_inside",
        "e^(x - 1)",
        "densities start lower by a factor of e; training makes up for it, exchanged weights don't",
        "e^x; put an offset into the layer's bias",
        "nerfacc's examples, where it is meant",
        1,
    ),
    Mistake::new(
        "base_two",
        "2^x: exp2 taken for exp",
        "densities that follow the network's output too slowly",
        "exp, or exp2 of x log2(e)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "gradient_not_clamped",
        "g e^x, the plain derivative",
        "one large density makes a gradient of 1e20 and more, and the training is lost",
        "g e^clamp(x, -15, 15)",
        "torch.exp used as it is",
        2,
    )
    .of_gradient(),
    Mistake::new(
        "clamped_above_alone",
        "g e^min(x, 15)",
        "none above -15; below, empty space has no gradient to become anything again (e^-30 for e^-15)",
        "clamp at both ends, or say that this is the surrogate you mean",
        "later versions of torch-ngp, and codes made from them, where it is meant",
        2,
    )
    .of_gradient(),
    Mistake::new(
        "zero_outside",
        "the derivative of e^clamp(x, -15, 15): 0 outside",
        "densities that have left [-15, 15] never come back",
        "write the backward pass by hand: g e^clamp(x, -15, 15)",
        "clamp in front of exp, differentiated automatically",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "value_clamped",
        "g min(e^x, 15): the limit taken for one of the density",
        "gradients too small from x = 2.7 on",
        "clamp x, not e^x",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// e^x.
pub fn trunc_exp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    forward(a, |x| {
        let x = if wrong.contains(&"bias_inside") { x - 1.0 } else { x };
        if wrong.contains(&"base_two") { pow(2.0, argument(x, c.exponent)) } else { density(x, c.exponent) }
    })
}

/// Its surrogate gradient.
pub fn trunc_exp_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    vjp(a, |x, g| match wrong.first() {
        Some(&"gradient_not_clamped") => g * exp(x),
        Some(&"clamped_above_alone") => g * exp(x.min(LIMIT)),
        Some(&"zero_outside") if x.abs() > LIMIT => 0.0,
        Some(&"value_clamped") => g * exp(x).min(LIMIT),
        _ => backward::trunc_exp(x, g),
    })
}
