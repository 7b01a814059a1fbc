//! Error bounds of the spherical harmonics.
//!
//! However a polynomial is factored (3 x x - y y, 5 z z - 1, squares first), its expansion has the monomials of
//! [`super::POLYNOMIALS`], each with at most one rounding per factor, one for its coefficient and one per sum that it passes through: an
//! error of gamma_k times the sum of the monomials' sizes (Higham, section 5.1).

use super::arrays::{forward, vjp, width};
use super::{normalized, polynomial, power};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::gamma;
use crate::convention::{Conventions, HarmonicForm};

/// Roundings that a monomial of degree 4 at most can pass through: coefficient (also of a factored form) 2, powers 4, sums 2; where d is
/// normalized first, its length (squares, sums, root) and a quotient for each of 4 powers besides.
fn roundings(c: &Conventions) -> f64 {
    if c.harmonic_form == HarmonicForm::Normalized { 8.0 + 4.0 * 4.0 } else { 8.0 }
}

fn error(size: f64, roundings: f64, terms: f64, m: &Arithmetic) -> f64 {
    // What underflows on the way is multiplied by at most 7 later.
    let flushed = 8.0 * roundings * terms * m.tiny;
    if size > m.largest / 8.0 { f64::INFINITY } else { size * gamma(roundings, m.u) + flushed }
}

/// Bound of [`super::harmonics`].
pub(crate) fn harmonics(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    forward(a, |d| {
        let (u, _) = normalized(d, c.harmonic_form);
        let one = |n| {
            let (mut size, mut terms) = (0.0, 0.0);
            for &(coefficient, exponents) in polynomial(n, c.harmonic_form, c.harmonic_sign).0 {
                size += monomial(coefficient, u, exponents);
                terms += 1.0;
            }
            error(size, roundings(c), terms, m)
        };
        (0..width(a)).map(one).collect()
    })
}

/// |coefficient x^i y^j z^k|.
fn monomial(coefficient: f64, d: [f64; 3], [i, j, k]: [u32; 3]) -> f64 {
    (coefficient * power(d[0], i) * power(d[1], j) * power(d[2], k)).abs()
}

/// Sum of the terms' sizes and their number in the gradient along one axis.
fn slope(d: [f64; 3], g: &[f64], axis: usize, c: &Conventions) -> (f64, f64) {
    let (mut size, mut terms) = (0.0, 0.0);
    for (n, g) in g.iter().enumerate() {
        for &(coefficient, mut exponents) in polynomial(n, c.harmonic_form, c.harmonic_sign).0 {
            if exponents[axis] == 0 {
                continue;
            }
            let slope = coefficient * f64::from(exponents[axis]);
            exponents[axis] -= 1;
            size += (g * monomial(slope, d, exponents)).abs();
            terms += 1.0;
        }
    }
    (size, terms)
}

/// Bound of [`super::backward::harmonics`]: the terms of all harmonics are added in one sum, in any order, rounded term by term. Where d
/// is normalized, the part along d is taken off: the sizes of all three axes count, times 2, and a few roundings more.
pub(crate) fn harmonics_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    vjp(a, |d, g| {
        let (u, length) = normalized(d, c.harmonic_form);
        let axes = [0, 1, 2].map(|axis| slope(u, g, axis, c));
        if c.harmonic_form == HarmonicForm::Normalized {
            let (size, terms) = axes.iter().fold((0.0, 0.0), |(s, t), axis| (s + axis.0, t + axis.1));
            return [error(2.0 * size / length, roundings(c) + 10.0 + terms, terms, m); 3];
        }
        axes.map(|(size, terms)| error(size, roundings(c) + 2.0 + terms, terms, m))
    })
}
