//! The truncated exponential, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{forward, vjp};
use super::{LIMIT, argument, backward, density, shifted};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::math::{exp, ln_1p, pow};

const OWN_LIMITS: Mistake = Mistake::new(
    "limits_of_its_own",
    "g clamp(e^x, 1/most, most), with limits that nobody else has",
    "large densities learn more slowly than elsewhere, faint ones faster",
    "g e^clamp(x, -15, 15)",
    "1 public implementation: 1e-6 and 1e6",
    1,
)
.of_gradient()
.with("most", 1e6, [10.0, 1e30]);

const CLAMPED_ABOVE: Mistake = Mistake::new(
    "clamped_above",
    "e^min(x, most): a limit of one's own, from above alone",
    "no density is larger, and one that is has no gradient",
    "e^x, with the limits in the gradient alone",
    "safe_exp of a city's renderer: 10",
    1,
)
.with("most", 10.0, [2.0, 80.0]);

/// Mistakes of the truncated exponential.
pub(crate) const TRUNC_EXP: &[Mistake] = &[
    Mistake::new(
        "softplus",
        "ln(1 + e^x)",
        "densities that grow with x, not e^x: above 3 nearly x itself",
        "e^x, or softplus in the reference too: a network trained with one is nothing to the other",
        "softplus for the density, where the exponential is asked for",
        2,
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
    OWN_LIMITS,
    CLAMPED_ABOVE,
];

/// e^x.
pub(crate) fn trunc_exp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    forward(a, |x| {
        if wrong.contains(&"softplus") {
            let x = argument(x, c.exponent, c.exponent_shift);
            return x.max(0.0) + ln_1p(exp(-x.abs()));
        }
        if wrong.contains(&"base_two") {
            return pow(2.0, argument(x, c.exponent, c.exponent_shift));
        }
        if let Some(most) = CLAMPED_ABOVE.among(wrong) {
            return exp(argument(x, c.exponent, c.exponent_shift).min(most));
        }
        density(x, c.exponent, c.exponent_shift)
    })
}

/// Its surrogate gradient.
pub(crate) fn trunc_exp_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    vjp(a, |x, g| {
        let shifted = shifted(x, c.exponent_shift);
        if let Some(most) = OWN_LIMITS.among(wrong) {
            return g * exp(shifted).max(1.0 / most).min(most);
        }
        match wrong.first() {
            Some(&"gradient_not_clamped") => g * exp(shifted),
            Some(&"zero_outside") if shifted.abs() > LIMIT => 0.0,
            Some(&"value_clamped") => g * exp(shifted).min(LIMIT),
            _ => backward::trunc_exp(x, g, c.exponent_gradient, c.exponent_shift),
        }
    })
}
