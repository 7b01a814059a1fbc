//! Vector-Jacobian product of the spherical harmonics, by hand.

use super::{POLYNOMIALS, power};

/// Gradient of [`super::harmonics`] with respect to `d`: each power rule, term by term.
///
/// The polynomials are differentiated in all of space; a caller that normalized `d` continues through the normalization.
///
/// # Panics
/// Where `degree` is above 4, or `g_out` doesn't have (degree + 1)^2 entries.
pub fn harmonics(d: [f64; 3], degree: usize, g_out: &[f64]) -> [f64; 3] {
    assert_eq!(g_out.len(), (degree + 1) * (degree + 1), "g_out and the harmonics: one each a harmonic");
    let mut g_d = [0.0; 3];
    for n in 0..(degree + 1) * (degree + 1) {
        for &(coefficient, exponents) in POLYNOMIALS[n] {
            for a in 0..3 {
                if exponents[a] == 0 {
                    continue;
                }
                let mut slope = coefficient * f64::from(exponents[a]);
                for b in 0..3 {
                    slope *= power(d[b], if a == b { exponents[b] - 1 } else { exponents[b] });
                }
                g_d[a] += g_out[n] * slope;
            }
        }
    }
    g_d
}
