//! Vector-Jacobian product of the positional encoding, by hand.

use super::{Encoding, factor, wave};
use crate::math::Sum;

/// Gradient of [`super::positional_encoding`] with respect to `x`.
///
/// d sin(a x) / dx = a cos(a x), d cos(a x) / dx = -a sin(a x), with a = factor * f_k; the identity passes its gradient on.
/// The bands' terms grow like 2^k and cancel, so their sum is compensated.
///
/// # Panics
/// Where `g_out` isn't as long as the encoding of `x`.
pub fn positional_encoding(x: &[f64], encoding: &Encoding, g_out: &[f64]) -> Vec<f64> {
    let dims = x.len();
    assert_eq!(g_out.len(), encoding.width(dims), "g_out and the encoding of x: one each a column");
    let mut g_x = Vec::with_capacity(dims);
    for d in 0..dims {
        let mut g = Sum::default();
        for k in 0..encoding.levels {
            let f = encoding.band(k);
            let (sin, cos) = wave(encoding.frequency, f, x[d]);
            g.add(f * (g_out[encoding.column(dims, k, d, 0)] * cos));
            g.add(-f * (g_out[encoding.column(dims, k, d, 1)] * sin));
        }
        let identity = if encoding.identity { g_out[encoding.identity_column(dims, d)] } else { 0.0 };
        g_x.push(factor(encoding.frequency) * g.value() + identity);
    }
    g_x
}
