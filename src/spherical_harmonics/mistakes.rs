//! Spherical harmonics, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{degree, forward, vjp};
use super::{POLYNOMIALS, backward, power};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::Conventions;

/// Mistakes of the spherical harmonics.
pub const SPHERICAL_HARMONICS: &[Mistake] = &[
    Mistake::new(
        "no_condon_shortley",
        "odd m without the sign (-1)^m",
        "a network trained with one sign renders wrong highlights with the other",
        "multiply odd m by -1",
        "between spherical-harmonics codes; Sloan 2008 discusses it",
        2,
    ),
    Mistake::new(
        "directions_in_unit_cube",
        "(d + 1) / 2 is handed to polynomials that want d in [-1, 1]",
        "the harmonics of another direction, far from orthonormal",
        "hand over the unit direction itself, or undo the shift inside",
        "instant-ngp's and tiny-cuda-nn's input range, ported without the shift",
        2,
    ),
    Mistake::new(
        "m_descending",
        "within a band from m = l down to -l",
        "x and y exchange their places in band 1",
        "m ascending: y, z, x",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "polar_axis_y",
        "y and z exchanged: the pole along y, as in graphics texts",
        "harmonics of the turned direction",
        "the pole along z",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "power_rule_forgotten",
        "the gradient of x^n is x^(n-1), without n",
        "gradients of directions too small from band 2 on",
        "n x^(n-1)",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
];

/// Spherical harmonics.
pub fn harmonics(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    forward(a, |mut d| {
        if wrong.contains(&"directions_in_unit_cube") {
            d = d.map(|x| 0.5 * (x + 1.0));
        }
        if wrong.contains(&"polar_axis_y") {
            d.swap(1, 2);
        }
        let mut out = super::harmonics(d, degree(a));
        for l in 0..=degree(a) {
            let band = &mut out[l * l..(l + 1) * (l + 1)];
            if wrong.contains(&"no_condon_shortley") {
                // Index i holds m = i - l.
                band.iter_mut().enumerate().filter(|(i, _)| (i + l) % 2 == 1).for_each(|(_, y)| *y = -*y);
            }
            if wrong.contains(&"m_descending") {
                band.reverse();
            }
        }
        out
    })
}

/// Their gradient.
pub fn harmonics_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    if !wrong.contains(&"power_rule_forgotten") {
        return vjp(a, |d, g| backward::harmonics(d, degree(a), g));
    }
    vjp(a, |d, g| {
        let mut g_d = [0.0; 3];
        for n in 0..(degree(a) + 1) * (degree(a) + 1) {
            for &(coefficient, exponents) in POLYNOMIALS[n] {
                for axis in (0..3).filter(|&axis| exponents[axis] > 0) {
                    let mut lowered = exponents;
                    lowered[axis] -= 1;
                    let product: f64 = (0..3).map(|b| power(d[b], lowered[b])).product();
                    g_d[axis] += g[n] * coefficient * product;
                }
            }
        }
        g_d
    })
}
