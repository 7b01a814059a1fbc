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

const GRADIENT_CLIPPED: Mistake = Mistake::new(
    "gradient_clipped",
    "g e^x, clipped to [-most, most]",
    "gradients of faint densities are as they should be, those of dense ones are too small",
    "clamp the exponent, g e^clamp(x, -15, 15), not the gradient",
    "a port to JAX: 15",
    1,
)
.of_gradient()
.with("most", 15.0, [1e-2, 3e6]);

const CLAMPED_ABOVE: Mistake = Mistake::new(
    "clamped_above",
    "e^min(x, most): a limit of one's own, from above alone",
    "no density is larger, and one that is has no gradient",
    "e^x, with the limits in the gradient alone",
    "safe_exp of a city's renderer: 10",
    1,
)
.with("most", 10.0, [2.0, 80.0]);

const SHIFTED: Mistake = Mistake::new(
    "argument_lowered",
    "e^(x - k), with a k of one's own",
    "densities begin e^k times fainter: networks trained with one shift are nothing to another",
    "e^x, or the same shift in the reference",
    "F2-NeRF in nerfstudio: 3",
    1,
)
.with("k", 3.0, [0.1, 20.0]);

const BOTH_ENDS: Mistake = Mistake::new(
    "clamped_at_both_ends",
    "e^clamp(x, -most, most), with a limit of one's own",
    "no density is larger, or smaller, and one that is has no gradient",
    "e^x, with the limits in the gradient alone",
    "never; cheap to keep",
    0,
)
.with("most", 10.0, [2.0, 80.0]);

const SHARP_SOFTPLUS: Mistake = Mistake::new(
    "sharp_softplus",
    "ln(1 + e^(k x)) / k, a softplus with a factor",
    "densities that grow with x, not e^x",
    "e^x: a network trained with one is nothing to the other",
    "softplus(beta=10) for a density; never seen here",
    0,
)
.with("k", 10.0, [1.5, 200.0]);

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
    GRADIENT_CLIPPED,
    CLAMPED_ABOVE,
    SHIFTED,
    BOTH_ENDS,
    SHARP_SOFTPLUS,
    Mistake::new(
        "rectified",
        "max(x, 0)",
        "densities that grow with x, not e^x; those that fall to 0 have no gradient",
        "e^x, or a ReLU in the reference too",
        "ReLU for the density, as in the first NeRF, where the exponential is asked for",
        0,
    ),
    Mistake::new(
        "sigmoid_for_density",
        "1 / (1 + e^-x)",
        "no density above 1: walls of fog",
        "e^x",
        "densities and opacities mixed up; never seen here",
        0,
    ),
    Mistake::new(
        "argument_squared",
        "x^2",
        "densities that don't grow fast enough, and grow below 0 too",
        "e^x",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "straight_above_zero",
        "x + 1 above 0, e^x below: elu(x) + 1",
        "densities that grow with x, not e^x",
        "e^x everywhere",
        "never; cheap to keep",
        0,
    ),
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
        let plain = argument(x, c.exponent, c.exponent_shift);
        match () {
            () if wrong.contains(&"rectified") => return plain.max(0.0),
            () if wrong.contains(&"sigmoid_for_density") => return 1.0 / (1.0 + exp(-plain)),
            () if wrong.contains(&"argument_squared") => return plain * plain,
            () if wrong.contains(&"straight_above_zero") && plain > 0.0 => return plain + 1.0,
            () => {}
        }
        if let Some(k) = SHARP_SOFTPLUS.among(wrong) {
            return (k * plain.max(0.0) + ln_1p(exp(-k * plain.abs()))) / k;
        }
        let x = SHIFTED.among(wrong).map_or(x, |k| x - k);
        if let Some(most) = BOTH_ENDS.among(wrong) {
            return exp(argument(x, c.exponent, c.exponent_shift).clamp(-most, most));
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
        if let Some(most) = GRADIENT_CLIPPED.among(wrong) {
            return (g * exp(shifted)).clamp(-most, most);
        }
        match wrong.first() {
            Some(&"gradient_not_clamped") => g * exp(shifted),
            Some(&"zero_outside") if shifted.abs() > LIMIT => 0.0,
            Some(&"value_clamped") => g * exp(shifted).min(LIMIT),
            _ => backward::trunc_exp(x, g, c.exponent_gradient, c.exponent_shift),
        }
    })
}
