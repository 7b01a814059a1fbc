//! Registry row of importance sampling.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// Samples of a piecewise-constant distribution.
pub(crate) const IMPORTANCE_SAMPLING: Component = Component {
    name: "importance_sampling",
    folder: "importance_sampling",
    code: include_str!("honest.rs"),
    formula: "F_k = sum_{j<k} (w_j + padding) / sum_j (w_j + padding), t = e_k + (u - F_k) / (F_{k+1} - F_k) (e_{k+1} - e_k)",
    source: "NeRF (Mildenhall et al. 2020) section 5.2",
    inputs: &[
        Port::smooth("edges", "R,E", "edges of the N = E - 1 bins of a ray, ascending"),
        Port::plain("weights", "R,N", "weights of the bins, not normalized; detached, as in the paper"),
        Port::plain("padding", "", "added to every weight; 0 as in the paper, 1e-5 as in its code"),
        Port::smooth("u", "R,M", "numbers in [0, 1], in any order"),
    ],
    outputs: &[Port::smooth("t", "R,M", "samples, in the order of u")],
    conventions: &["pdf_padding", "pdf_division"],
    forward: Direction {
        oracle: arrays::sample,
        bound: bound::sample,
        honest: honest::sample,
        wrong: mistakes::sample,
    },
    vjp: Some(Direction {
        oracle: arrays::sample_vjp,
        bound: bound::sample_vjp,
        honest: honest::sample_vjp,
        wrong: mistakes::sample_vjp,
    }),
    cases: cases::importance_sampling,
    mistakes: mistakes::IMPORTANCE_SAMPLING,
    special: Special { large: cases::large, laws: Some(mistakes::laws::OF_SAMPLES), ..Special::NONE },
};
