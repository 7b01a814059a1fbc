//! The interlevel loss: how much of a ray's weights the histogram of a proposal network fails to cover.
//!
//! Mip-NeRF 360 (Barron et al. 2022), section 3. Letters: N intervals between N + 1 edges t with weights w, which the loss doesn't move;
//! M intervals of the proposal between edges s with weights v, which it pulls up.

use crate::convention::{LossReduction, OuterEdges};
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

/// A histogram along a ray: weights of intervals, and one edge more, never falling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Histogram<'a> {
    /// Weights of the intervals.
    pub weights: &'a [f64],
    /// Their edges.
    pub t: &'a [f64],
}

/// How code bases take the loss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form {
    /// Added to the weight that is divided by.
    pub eps: f64,
    /// Whether an interval that begins where another ends overlaps it.
    pub edges: OuterEdges,
    /// Mean or sum over the intervals of the ray.
    pub reduction: LossReduction,
}

/// max(0, w_i - bound_i)^2 / (w_i + eps), the mean over intervals (equation 13): bound_i is the outer measure of the proposal.
///
/// # Shapes
/// `fine`: weights (N), edges (N + 1); `proposal`: weights (M), edges (M + 1). Both from and to the same distances; one number.
///
/// # Units
/// None: both histograms have the units of their edges in common.
///
/// # Convention
/// A bound: what the proposal has too much costs nothing. `form.eps` keeps an interval without weight from 0 / 0. Nothing is passed to
/// the fine weights, nor to any edge: [`backward`].
///
/// # Panics
/// Where there isn't one edge more than weights.
///
/// ```
/// use nerf_oracle::convention::{LossReduction, OuterEdges};
/// use nerf_oracle::interlevel_loss::{Form, Histogram, interlevel};
/// let form = Form { eps: 0.0, edges: OuterEdges::Touching, reduction: LossReduction::Sum };
/// let fine = Histogram { weights: &[0.5, 0.25], t: &[0.0, 1.0, 2.0] };
/// // One interval of the proposal covers both: half of what the first one needs, and all of the second.
/// let proposal = Histogram { weights: &[0.25], t: &[0.0, 2.0] };
/// assert_eq!(interlevel(fine, proposal, form), 0.0625 / 0.5);
/// ```
pub fn interlevel(fine: Histogram, proposal: Histogram, form: Form) -> f64 {
    check(fine, proposal);
    let mut loss = Sum::default();
    for i in 0..fine.weights.len() {
        let missing = (fine.weights[i] - outer(fine.t, i, proposal, form.edges)).max(0.0);
        loss.add(if missing > 0.0 { missing * missing / (fine.weights[i] + form.eps) } else { 0.0 });
    }
    reduced(loss.value(), fine.weights.len(), form.reduction)
}

/// The proposal's weight that lies in interval i, or may: all of every interval that overlaps it (equation 12).
///
/// # Convention
/// `edges`: with [`OuterEdges::Touching`] an interval of the proposal that begins where interval i ends counts, and one that ends where it
/// begins doesn't, as searches through sorted edges have it; with [`OuterEdges::Inside`] neither does.
pub(crate) fn outer(t: &[f64], i: usize, proposal: Histogram, edges: OuterEdges) -> f64 {
    let mut sum = Sum::default();
    for (j, v) in proposal.weights.iter().enumerate() {
        if overlaps(t, i, proposal.t, j, edges) {
            sum.add(*v);
        }
    }
    sum.value()
}

/// Whether interval j of the proposal overlaps interval i.
pub(crate) fn overlaps(t: &[f64], i: usize, s: &[f64], j: usize, edges: OuterEdges) -> bool {
    let begins = if edges == OuterEdges::Touching { s[j] <= t[i + 1] } else { s[j] < t[i + 1] };
    begins && t[i] < s[j + 1]
}

/// One edge more than weights, in both.
fn check(fine: Histogram, proposal: Histogram) {
    assert_eq!(fine.weights.len() + 1, fine.t.len(), "fine weights and t: one edge more than weights");
    assert_eq!(
        proposal.weights.len() + 1,
        proposal.t.len(),
        "proposal weights and t: one edge more than weights"
    );
}

/// A sum, or the mean of as many intervals.
fn reduced(sum: f64, intervals: usize, reduction: LossReduction) -> f64 {
    if reduction == LossReduction::Sum { sum } else { sum / intervals as f64 }
}
