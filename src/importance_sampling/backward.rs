//! Vector-Jacobian product of importance sampling, by hand.

use super::{SNAPPED, bin_of, cdf};

/// Gradients of [`super::sample`] with respect to `edges` and `u`.
///
/// Inside a bin t = (1 - s) e_k + s e_{k+1}, so that dt / d e_k = 1 - s, dt / d e_{k+1} = s and dt / du = (e_{k+1} - e_k) / (F_{k+1} -
/// F_k); at a tie the bin is that of [`super::sample`]. The weights get none: the paper's code stops the gradient of the fine samples
/// altogether, so that the coarse network learns from its own colors alone; code that does differentiate through the positions of samples
/// (edges that a network proposes, warped rays) does so through `edges` and `u`.
///
/// # Panics
/// Where there is no bin, `edges` aren't one more than `weights`, or `g_t` and `u` differ in length.
pub fn sample(edges: &[f64], weights: &[f64], padding: f64, u: &[f64], g_t: &[f64]) -> (Vec<f64>, Vec<f64>) {
    assert!(!weights.is_empty(), "weights: at least one bin");
    assert_eq!(edges.len(), weights.len() + 1, "edges and weights: one edge more than weights");
    assert_eq!(g_t.len(), u.len(), "g_t and u: one each a sample");
    let f = cdf(weights, padding);
    let (mut g_edges, mut g_u) = (vec![0.0; edges.len()], vec![]);
    for i in 0..u.len() {
        let k = bin_of(&f, u[i]);
        let weight = f[k + 1] - f[k];
        let s = (u[i] - f[k]) / weight;
        g_edges[k] += g_t[i] * (1.0 - s);
        g_edges[k + 1] += g_t[i] * s;
        g_u.push(g_t[i] * (edges[k + 1] - edges[k]) / weight);
    }
    (g_edges, g_u)
}

/// Gradients of [`super::sample_snapped`]: in a faint bin s = (u - F_k) / `faint`.
pub(crate) fn sample_snapped(
    edges: &[f64],
    weights: &[f64],
    padding: f64,
    u: &[f64],
    g_t: &[f64],
    faint: f64,
) -> (Vec<f64>, Vec<f64>) {
    let f = cdf(weights, padding);
    let (mut g_edges, mut g_u) = (vec![0.0; edges.len()], vec![]);
    for i in 0..u.len() {
        let k = bin_of(&f, u[i]);
        let share = f[k + 1] - f[k];
        let divisor = if share < SNAPPED { faint } else { share };
        let s = (u[i] - f[k]) / divisor;
        g_edges[k] += g_t[i] * (1.0 - s);
        g_edges[k + 1] += g_t[i] * s;
        g_u.push(g_t[i] * (edges[k + 1] - edges[k]) / divisor);
    }
    (g_edges, g_u)
}
