//! Vector-Jacobian product of the spherical harmonics, by hand.

use super::{normalized, polynomial, power};
use crate::convention::{HarmonicForm, HarmonicSign};

/// Gradient of [`super::harmonics`] with respect to `d`: each power rule, term by term.
///
/// The polynomials are differentiated in all of space; a caller that normalized `d` continues through the normalization, as
/// [`HarmonicForm::Normalized`] does: g_d = (g - (g . u) u) / |d| with u = d / |d|.
///
/// # Panics
/// Where `degree` is above 4, or `g_out` doesn't have (degree + 1)^2 entries.
pub fn harmonics(
    d: [f64; 3],
    degree: usize,
    form: HarmonicForm,
    sign: HarmonicSign,
    g_out: &[f64],
) -> [f64; 3] {
    assert_eq!(g_out.len(), (degree + 1) * (degree + 1), "g_out and the harmonics: one each a harmonic");
    let (u, length) = normalized(d, form);
    let mut g_u = [0.0; 3];
    for n in 0..(degree + 1) * (degree + 1) {
        let (polynomial, factor) = polynomial(n, form, sign);
        for &(coefficient, exponents) in polynomial {
            for a in 0..3 {
                if exponents[a] == 0 {
                    continue;
                }
                let mut slope = factor * coefficient * f64::from(exponents[a]);
                for b in 0..3 {
                    slope *= power(u[b], if a == b { exponents[b] - 1 } else { exponents[b] });
                }
                g_u[a] += g_out[n] * slope;
            }
        }
    }
    if form != HarmonicForm::Normalized {
        return g_u;
    }
    let radial = g_u[0] * u[0] + g_u[1] * u[1] + g_u[2] * u[2];
    [0, 1, 2].map(|a| (g_u[a] - radial * u[a]) / length)
}
