//! Honest spherical harmonics in emulated arithmetic: monomials factor by factor, or from squares.

use super::POLYNOMIALS;
use super::arrays::{degree, forward, vjp, width};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::Conventions;

/// c x^i y^j z^k: the coefficient first (form 0), or last, after products of squares.
fn monomial(coefficient: f64, d: [f64; 3], exponents: [u32; 3], m: &Machine) -> f64 {
    let coefficient = m.round(coefficient);
    let times = |product: f64, x: f64, n: u32| (0..n).fold(product, |product, _| m.mul(product, x));
    if m.form % 2 == 0 {
        return (0..3).fold(coefficient, |product, a| times(product, d[a], exponents[a]));
    }
    let mut product = 1.0;
    for a in 0..3 {
        product = times(product, m.mul(d[a], d[a]), exponents[a] / 2);
        product = times(product, d[a], exponents[a] % 2);
    }
    m.mul(product, coefficient)
}

/// Spherical harmonics.
pub fn harmonics(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    forward(a, |d| {
        let one = |polynomial: &&[(f64, [u32; 3])]| {
            let terms: Vec<f64> = polynomial.iter().map(|&(c, e)| monomial(c, d, e, m)).collect();
            m.sum(&terms)
        };
        POLYNOMIALS[..width(a)].iter().map(one).collect()
    })
}

/// Their gradient.
pub fn harmonics_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |d, g| {
        std::array::from_fn(|axis| {
            let mut terms = vec![];
            for n in 0..(degree(a) + 1) * (degree(a) + 1) {
                for &(coefficient, mut exponents) in POLYNOMIALS[n] {
                    let factor = f64::from(exponents[axis]);
                    if factor > 0.0 {
                        exponents[axis] -= 1;
                        terms.push(m.mul(g[n], monomial(coefficient * factor, d, exponents, m)));
                    }
                }
            }
            m.sum(&terms)
        })
    })
}
