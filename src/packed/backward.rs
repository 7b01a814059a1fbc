//! Vector-Jacobian products of packed rays' sums and products, by hand. `g` is the gradient of the loss with respect to the result.

use super::{Scan, check};
use crate::math::Sum;

/// The gradient of [`super::scan`] with respect to `x`, from those of its four results.
///
/// A sample counts in the sums at it and behind it, and in the products: with E the exclusive product, from the ray's end on
/// * s_k = g_incl_k + r_k, r_k = s_{k+1} + g_excl_{k+1} for the sums,
/// * p_k = g_incl_k + q_k, q_k = x_{k+1} p_{k+1} + g_excl_{k+1} for the products: the value of one unit of the product through k,
///
/// g_x_k = s_k + E_k p_k. Nothing is divided by x, so that a factor of 0 has its gradient (VR4).
///
/// # Panics
/// Where the lengths differ, and where `offsets` are none, fall, or don't end at S.
///
/// ```
/// use nerf_oracle::packed::{Scan, backward, scan};
/// let (x, offsets) = ([0.5, 0.0, 0.5], [0, 3]);
/// let zeros = vec![0.0; 3];
/// let g = Scan { exclusive_sum: zeros.clone(), inclusive_sum: zeros.clone(), exclusive_product: zeros, inclusive_product: vec![1.0; 3] };
/// // Products 1/2, 0, 0: the 0 has 1/2 from its own place, and 1/4 from the last one.
/// assert_eq!(backward::scan(&x, &offsets, &scan(&x, &offsets), &g), [1.0, 0.75, 0.0]);
/// ```
pub fn scan(x: &[f64], offsets: &[usize], forward: &Scan, g: &Scan) -> Vec<f64> {
    check(x.len(), offsets);
    assert_eq!(forward.exclusive_product.len(), x.len(), "forward and x: one each a sample");
    for g in [&g.exclusive_sum, &g.inclusive_sum, &g.exclusive_product, &g.inclusive_product] {
        assert_eq!(g.len(), x.len(), "g and x: one each a sample");
    }
    let mut g_x = vec![0.0; x.len()];
    for ray in offsets.windows(2) {
        let (mut behind, mut through) = (Sum::default(), Sum::default());
        for k in (ray[0]..ray[1]).rev() {
            behind.add(g.inclusive_sum[k]);
            through.add(g.inclusive_product[k]);
            g_x[k] = behind.value() + forward.exclusive_product[k] * through.value();
            behind.add(g.exclusive_sum[k]);
            through = through.times(x[k]);
            through.add(g.exclusive_product[k]);
        }
    }
    g_x
}

/// The gradients of [`super::accumulate`] with respect to `weights` and `values`: g_w_i = g_r . v_i and g_v_i = w_i g_r, r the ray of i.
///
/// # Panics
/// Where the lengths differ, and where `offsets` are none, fall, or don't end at S.
///
/// ```
/// use nerf_oracle::packed::backward::accumulate;
/// let (g_weights, g_values) = accumulate(&[0.5, 2.0], &[[1.0, 2.0, 3.0]; 2], &[0, 1, 2], &[[1.0; 3], [0.0, 1.0, 0.0]]);
/// assert_eq!(g_weights, [6.0, 2.0]);
/// assert_eq!(g_values, [[0.5; 3], [0.0, 2.0, 0.0]]);
/// ```
pub fn accumulate(
    weights: &[f64],
    values: &[[f64; 3]],
    offsets: &[usize],
    g: &[[f64; 3]],
) -> (Vec<f64>, Vec<[f64; 3]>) {
    assert_eq!(weights.len(), values.len(), "weights and values: one each a sample");
    check(weights.len(), offsets);
    assert_eq!(g.len() + 1, offsets.len(), "g and offsets: one each a ray");
    let (mut g_weights, mut g_values) = (vec![], vec![]);
    for r in 0..g.len() {
        for i in offsets[r]..offsets[r + 1] {
            g_weights.push(g[r][0] * values[i][0] + g[r][1] * values[i][1] + g[r][2] * values[i][2]);
            g_values.push(g[r].map(|g| weights[i] * g));
        }
    }
    (g_weights, g_values)
}
