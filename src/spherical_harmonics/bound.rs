//! Error bounds of the spherical harmonics.
//!
//! However a polynomial is factored (3 x x - y y, 5 z z - 1, squares first), its expansion has the monomials of
//! [`POLYNOMIALS`], each with at most one rounding per factor, one for its coefficient and one per sum that it passes through: an
//! error of gamma_k times the sum of the monomials' sizes (Higham, section 5.1).

use super::arrays::{degree, forward, vjp, width};
use super::{POLYNOMIALS, power};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::gamma;
use crate::convention::Conventions;

/// Roundings that a monomial of degree 4 at most can pass through: coefficient (also of a factored form) 2, powers 4, sums 2.
const ROUNDINGS: f64 = 8.0;

fn error(size: f64, roundings: f64, terms: f64, m: &Arithmetic) -> f64 {
    // What underflows on the way is multiplied by at most 7 later.
    let flushed = 8.0 * roundings * terms * m.tiny;
    if size > m.largest / 8.0 { f64::INFINITY } else { size * gamma(roundings, m.u) + flushed }
}

/// Bound of [`super::harmonics`].
pub fn harmonics(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    forward(a, |d| {
        let one = |polynomial: &&[(f64, [u32; 3])]| {
            let (mut size, mut terms) = (0.0, 0.0);
            for &(coefficient, exponents) in *polynomial {
                size += monomial(coefficient, d, exponents);
                terms += 1.0;
            }
            error(size, ROUNDINGS, terms, m)
        };
        POLYNOMIALS[..width(a)].iter().map(one).collect()
    })
}

/// |coefficient x^i y^j z^k|.
fn monomial(coefficient: f64, d: [f64; 3], [i, j, k]: [u32; 3]) -> f64 {
    (coefficient * power(d[0], i) * power(d[1], j) * power(d[2], k)).abs()
}

/// Bound of [`super::backward::harmonics`]: the terms of all harmonics are added in one sum, in any order, rounded term by term.
pub fn harmonics_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    vjp(a, |d, g| {
        std::array::from_fn(|axis| {
            let (mut size, mut terms) = (0.0, 0.0);
            for n in 0..(degree(a) + 1) * (degree(a) + 1) {
                for &(coefficient, mut exponents) in POLYNOMIALS[n] {
                    if exponents[axis] == 0 {
                        continue;
                    }
                    let slope = coefficient * f64::from(exponents[axis]);
                    exponents[axis] -= 1;
                    size += (g[n] * monomial(slope, d, exponents)).abs();
                    terms += 1.0;
                }
            }
            error(size, ROUNDINGS + 2.0 + terms, terms, m)
        })
    })
}
