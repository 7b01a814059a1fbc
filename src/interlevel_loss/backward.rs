//! Vector-Jacobian product of the interlevel loss, by hand. `g` is the gradient of the total loss with respect to it.

use super::{Form, Histogram, check, outer, overlaps, reduced};
use crate::math::Sum;

/// Gradient with respect to the proposal's weights: g_v_j = -2 g / N sum over the intervals i that j overlaps of
/// max(0, w_i - bound_i) / (w_i + eps).
///
/// # Convention
/// The fine weights and all edges have none: the proposal is moved to the field, never the field to the proposal ("stop gradient").
///
/// # Panics
/// Where there isn't one edge more than weights.
///
/// ```
/// use nerf_oracle::convention::{LossReduction, OuterEdges};
/// use nerf_oracle::interlevel_loss::{Form, Histogram, backward::interlevel};
/// let form = Form { eps: 0.0, edges: OuterEdges::Touching, reduction: LossReduction::Sum };
/// let fine = Histogram { weights: &[0.5, 0.25], t: &[0.0, 1.0, 2.0] };
/// let proposal = Histogram { weights: &[0.25], t: &[0.0, 2.0] };
/// assert_eq!(interlevel(fine, proposal, form, 1.0), [-1.0]);
/// ```
pub fn interlevel(fine: Histogram, proposal: Histogram, form: Form, g: f64) -> Vec<f64> {
    check(fine, proposal);
    let mut sums = vec![Sum::default(); proposal.weights.len()];
    for i in 0..fine.weights.len() {
        let missing = (fine.weights[i] - outer(fine.t, i, proposal, form.edges)).max(0.0);
        for (j, sum) in sums.iter_mut().enumerate() {
            if missing > 0.0 && overlaps(fine.t, i, proposal.t, j, form.edges) {
                sum.add(missing / (fine.weights[i] + form.eps));
            }
        }
    }
    sums.iter().map(|sum| reduced(-2.0 * g * sum.value(), fine.weights.len(), form.reduction)).collect()
}
