//! Vector-Jacobian product of the integrated encoding, by hand.

use super::attenuation;
use crate::encoding::{Encoding, factor, wave};
use crate::math::Sum;

/// Gradients of [`super::integrated_encoding`] with respect to means and variances.
///
/// With A = exp(-a^2 v / 2) and a = factor * f_k: a A (g_sin cos - g_cos sin) to the mean, -a^2/2 A (g_sin sin + g_cos cos) to the
/// variance; the identity passes its gradient on. The bands' terms may grow like 4^k and cancel, so their sums are compensated.
///
/// # Panics
/// Where the lengths differ, or `g_out` isn't as long as the encoding.
pub fn integrated_encoding(
    means: &[f64],
    variances: &[f64],
    encoding: &Encoding,
    g_out: &[f64],
) -> (Vec<f64>, Vec<f64>) {
    let dims = means.len();
    assert_eq!(dims, variances.len(), "means and variances: one each a dimension");
    assert_eq!(g_out.len(), encoding.width(dims), "g_out and the encoding: one each a column");
    let scale = factor(encoding.frequency);
    let (mut g_means, mut g_variances) = (Vec::with_capacity(dims), Vec::with_capacity(dims));
    for d in 0..dims {
        let (mut g_mean, mut g_variance) = (Sum::default(), Sum::default());
        for k in 0..encoding.levels {
            let f = encoding.band(k);
            let (sin, cos) = wave(encoding.frequency, f, means[d]);
            let left = attenuation(encoding, k, variances[d]);
            let g_sin = g_out[encoding.column(dims, k, d, 0)];
            let g_cos = g_out[encoding.column(dims, k, d, 1)];
            g_mean.add(f * left * (g_sin * cos));
            g_mean.add(-f * left * (g_cos * sin));
            g_variance.add(-0.5 * f * f * left * (g_sin * sin));
            g_variance.add(-0.5 * f * f * left * (g_cos * cos));
        }
        let identity = if encoding.identity { g_out[encoding.identity_column(dims, d)] } else { 0.0 };
        g_means.push(scale * g_mean.value() + identity);
        g_variances.push(scale * scale * g_variance.value());
    }
    (g_means, g_variances)
}
