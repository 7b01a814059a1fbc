//! Somebody's interlevel loss, judged.

use ndarray::{ArrayView1, ArrayView2};

use super::component::INTERLEVEL_LOSS;
use crate::judge::door::front_door;

front_door! {
    /// Judges the loss of one ray: (weights, t, proposal_weights, proposal_t, eps) -> loss.
    ///
    /// ```
    /// use nerf_oracle::convention::{LossReduction, OuterEdges};
    /// use nerf_oracle::interlevel_loss::{Form, Histogram, backward, interlevel, judge};
    /// let form = |eps| Form { eps, edges: OuterEdges::Touching, reduction: LossReduction::Mean };
    /// fn of<'a>(weights: &'a [f64], t: &'a [f64]) -> Histogram<'a> {
    ///     Histogram { weights, t }
    /// }
    /// judge(|w, t, v, s, eps| interlevel(of(w, t), of(v, s), form(eps)))
    ///     .vjp(|w, t, v, s, eps, g| backward::interlevel(of(w, t), of(v, s), form(eps), g))
    ///     .assert_pass();
    /// ```
    each INTERLEVEL_LOSS: judge as Ray(
        weights: &[f64],
        t: &[f64],
        proposal_weights: &[f64],
        proposal_t: &[f64],
        eps: f64,
    );
    /// With its gradient: the same and grad_loss -> grad_proposal_weights.
    each_vjp(grad_loss: f64);
}

front_door! {
    /// Judges that of many rays: `weights` (R, N), `t` (R, N + 1), `proposal_weights` (R, M), `proposal_t` (R, M + 1), eps -> loss (R).
    whole INTERLEVEL_LOSS: judge_batch as Rays(
        weights: ArrayView2<f64>,
        t: ArrayView2<f64>,
        proposal_weights: ArrayView2<f64>,
        proposal_t: ArrayView2<f64>,
        eps: f64,
    );
    /// With its gradient: the same and grad_loss -> grad_proposal_weights.
    whole_vjp(grad_loss: ArrayView1<f64>);
}
