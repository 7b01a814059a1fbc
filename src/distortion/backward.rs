//! Vector-Jacobian product of the distortion loss, by hand. `g` is the gradient of the total loss with respect to it.

use super::apart;
use crate::math::Sum;

/// Gradients with respect to `weights` and `t`.
///
/// g_w_i = g (2 sum_j w_j |m_i - m_j| + 2/3 w_i delta_i). With a_i = g w_i sum_j w_j sign(m_i - m_j), half of the gradient of m_i (each
/// pair counts twice), and b_i = g w_i^2 / 3, that of delta_i: an edge has a_{k-1} + b_{k-1} from the interval in front and a_k - b_k from
/// the one behind.
///
/// # Convention
/// Where intervals of no length share their middle, |m_i - m_j| has no derivative: 0 is taken, as PyTorch and JAX do. The form by running
/// sums takes 1 or -1 by the order, which is a subgradient too.
///
/// # Panics
/// Where there isn't one edge more than weights.
///
/// ```
/// use nerf_oracle::distortion::backward::distortion;
/// let (g_weights, g_t) = distortion(&[0.5, 0.0, 0.5], &[0.0, 0.0, 2.0, 2.0], 1.0);
/// assert_eq!(g_weights, [2.0, 2.0, 2.0]);
/// assert_eq!(g_t[1] + g_t[0], -0.5); // the point in front, moved on by 1: nearer by 1
/// ```
pub fn distortion(weights: &[f64], t: &[f64], g: f64) -> (Vec<f64>, Vec<f64>) {
    let n = weights.len();
    assert_eq!(n + 1, t.len(), "weights and t: one edge more than weights");
    let (mut g_weights, mut g_t) = (vec![0.0; n], vec![Sum::default(); n + 1]);
    for i in 0..n {
        let (mut distance, mut ahead) = (Sum::default(), Sum::default());
        for j in 0..n {
            let apart = apart(t, i, j);
            distance.add(weights[j] * apart.abs());
            if apart > 0.0 {
                ahead.add(weights[j]);
            } else if apart < 0.0 {
                ahead.add(-weights[j]);
            }
        }
        g_weights[i] = g * (2.0 * distance.value() + 2.0 / 3.0 * weights[i] * (t[i + 1] - t[i]));
        let (a, b) = (g * weights[i] * ahead.value(), g * weights[i] * weights[i] / 3.0);
        g_t[i].add(a - b);
        g_t[i + 1].add(a + b);
    }
    (g_weights, g_t.iter().map(Sum::value).collect())
}
