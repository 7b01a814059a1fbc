//! Honest spherical harmonics in emulated arithmetic: monomials factor by factor, or from squares.

use super::arrays::{forward, vjp, width};
use super::polynomial;
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::{Conventions, HarmonicForm};

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

/// d, or d / |d| by convention, with the length.
fn unit(d: [f64; 3], c: &Conventions, m: &Machine) -> ([f64; 3], f64) {
    if c.harmonic_form != HarmonicForm::Normalized {
        return (d, 1.0);
    }
    let length = m.sqrt(m.dot(&d, &d));
    (d.map(|x| m.div(x, length)), length)
}

/// Spherical harmonics.
pub(crate) fn harmonics(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    forward(a, |d| {
        let (d, _) = unit(d, c, m);
        let one = |n| {
            let (polynomial, factor) = polynomial(n, c.harmonic_form, c.harmonic_sign);
            let terms: Vec<f64> = polynomial.iter().map(|&(c, e)| monomial(factor * c, d, e, m)).collect();
            m.sum(&terms)
        };
        (0..width(a)).map(one).collect()
    })
}

/// Their gradient.
pub(crate) fn harmonics_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |d, g| {
        let (u, length) = unit(d, c, m);
        let g_u: [f64; 3] = std::array::from_fn(|axis| {
            let mut terms = vec![];
            for (n, &g) in g.iter().enumerate() {
                let (polynomial, sign) = polynomial(n, c.harmonic_form, c.harmonic_sign);
                for &(coefficient, mut exponents) in polynomial {
                    let factor = f64::from(exponents[axis]);
                    if factor > 0.0 {
                        exponents[axis] -= 1;
                        terms.push(m.mul(g, monomial(sign * coefficient * factor, u, exponents, m)));
                    }
                }
            }
            m.sum(&terms)
        });
        if c.harmonic_form != HarmonicForm::Normalized {
            return g_u;
        }
        let radial = m.dot(&g_u, &u);
        [0, 1, 2].map(|a| m.div(m.sub(g_u[a], m.mul(radial, u[a])), length))
    })
}
