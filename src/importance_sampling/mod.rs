//! Importance sampling: the samples of a fine pass, drawn where the weights of a coarse pass are large.
//!
//! Letters: N bins between the `edges` e_0 <= ... <= e_N on a ray, `weights` w of the bins, F the cumulative distribution at the
//! edges, `u` in [0, 1], `t` the sample, s its place inside a bin.

use crate::math::Sum;

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// The cumulative distribution at the edges: F_k = sum_{j<k} (w_j + padding) / sum_j (w_j + padding), N + 1 values from 0 to 1.
///
/// NeRF (Mildenhall et al. 2020) section 5.2 normalizes the weights; `padding` is added to each of them before (1e-5 in the
/// original code, 0.01 in nerfstudio, 0 in the paper). Where all weights and the padding are 0, all bins weigh the same: the limit
/// of any padding that goes to 0 (SA1).
///
/// ```
/// use nerf_oracle::importance_sampling::cdf;
/// assert_eq!(cdf(&[1.0, 0.0, 3.0], 0.0), [0.0, 0.25, 0.25, 1.0]);
/// assert_eq!(cdf(&[0.0, 0.0], 0.0), [0.0, 0.5, 1.0]);
/// ```
pub fn cdf(weights: &[f64], padding: f64) -> Vec<f64> {
    let mut sum = Sum::default();
    let mut sums = vec![0.0];
    for &w in weights {
        sum.add(w + padding);
        sums.push(sum.value());
    }
    let (n, total) = (weights.len(), sum.value());
    let mut f = vec![];
    for k in 0..=n {
        f.push(if total > 0.0 { sums[k] / total } else { k as f64 / n as f64 });
    }
    f
}

/// The bin that holds `u`: the last one with some weight that begins at or below it.
///
/// A bin without weight is never chosen, whatever `u` is: at a tie the inverse of F is continuous from the right. u = 1 belongs to the
/// last bin with weight (SA3: a search through F would run past it).
pub(crate) fn bin_of(f: &[f64], u: f64) -> usize {
    let (mut bin, mut any) = (0, false);
    for k in 0..f.len() - 1 {
        if f[k] < f[k + 1] && (f[k] <= u || !any) {
            (bin, any) = (k, true);
        }
    }
    bin
}

/// Samples of the piecewise-constant distribution, one for each `u`: t = F^-1(u).
///
/// t = e_k + s (e_{k+1} - e_k) with s = (u - F_k) / (F_{k+1} - F_k): NeRF (Mildenhall et al. 2020) section 5.2, inverse transform
/// sampling. [`cdf`] has F.
///
/// # Shapes
/// `edges` (N + 1), ascending; `weights` (N), none negative; `u` (M), in any order; result (M), in the order of `u`.
///
/// # Convention
/// A weight belongs to the bin between two edges. The original code has samples instead of edges, and passes their midpoints
/// with the weights of all samples except the first and the last. Small differences F_{k+1} - F_k are divided by as they are: the
/// original code takes 1 for any below 1e-5, and an opaque ray's samples then fall on the edges (SA2).
///
/// # Panics
/// Where there is no bin, or `edges` aren't one more than `weights`.
///
/// ```
/// use nerf_oracle::importance_sampling::sample;
/// let (edges, weights) = ([2.0, 3.0, 5.0], [1.0, 3.0]);
/// assert_eq!(sample(&edges, &weights, 0.0, &[0.125, 0.25, 0.625, 1.0]), [2.5, 3.0, 4.0, 5.0]);
/// ```
pub fn sample(edges: &[f64], weights: &[f64], padding: f64, u: &[f64]) -> Vec<f64> {
    assert!(!weights.is_empty(), "weights: at least one bin");
    assert_eq!(edges.len(), weights.len() + 1, "edges and weights: one edge more than weights");
    let f = cdf(weights, padding);
    let mut t = vec![];
    for &u in u {
        let k = bin_of(&f, u);
        let s = (u - f[k]) / (f[k + 1] - f[k]);
        t.push(edges[k] + s * (edges[k + 1] - edges[k]));
    }
    t
}

/// The same where a bin's share counts as `faint` if it is below [`SNAPPED`]: as 1 in the original code, where samples in faint bins fall
/// on their edge.
pub(crate) fn sample_snapped(
    edges: &[f64],
    weights: &[f64],
    padding: f64,
    u: &[f64],
    faint: f64,
) -> Vec<f64> {
    let f = cdf(weights, padding);
    let mut t = vec![];
    for &u in u {
        let k = bin_of(&f, u);
        let share = f[k + 1] - f[k];
        let s = (u - f[k]) / if share < SNAPPED { faint } else { share };
        t.push(edges[k] + s * (edges[k + 1] - edges[k]));
    }
    t
}

/// The share below which the original code divides by 1 (run_nerf_helpers.py sample_pdf), and others by this itself.
pub(crate) const SNAPPED: f64 = 1e-5;

/// The union of the samples of two passes, ascending: where the fine network of a hierarchical pair is evaluated (section 5.2).
///
/// ```
/// use nerf_oracle::importance_sampling::union;
/// assert_eq!(union(&[1.0, 3.0], &[2.5, 0.5]), [0.5, 1.0, 2.5, 3.0]);
/// ```
pub fn union(coarse: &[f64], fine: &[f64]) -> Vec<f64> {
    let mut t = coarse.to_vec();
    t.extend(fine);
    t.sort_by(f64::total_cmp);
    t
}
