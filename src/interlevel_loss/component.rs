//! Registry row of the interlevel loss.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// What a proposal fails to cover.
pub(crate) const INTERLEVEL_LOSS: Component = Component {
    name: "interlevel_loss",
    folder: "interlevel_loss",
    code: include_str!("honest.rs"),
    formula: "mean over intervals of max(0, w_i - bound_i)^2 / (w_i + eps), bound_i the proposal's weights whose intervals overlap i; \
              of each ray",
    source: "mip-NeRF 360 (Barron et al. 2022), equations 12 and 13; google-research/multinerf internal/stepfun.py lossfun_outer",
    inputs: &[
        Port::plain("weights", "R,N", "weights of the field: no gradient"),
        Port::plain("t", "R,N+1", "their edges, never falling"),
        Port::smooth("proposal_weights", "R,M", "weights of the proposal"),
        Port::plain("proposal_t", "R,M+1", "their edges, from and to the same distances"),
        Port::plain("eps", "", "added to the weight that is divided by"),
    ],
    outputs: &[Port::smooth("loss", "R", "of each ray: add up or average them yourself")],
    conventions: &["outer_edges", "interlevel_eps", "interlevel_reduction"],
    forward: Direction {
        oracle: arrays::interlevel,
        bound: bound::interlevel,
        honest: honest::interlevel,
        wrong: mistakes::interlevel,
    },
    vjp: Some(Direction {
        oracle: arrays::interlevel_vjp,
        bound: bound::interlevel_vjp,
        honest: honest::interlevel_vjp,
        wrong: mistakes::interlevel_vjp,
    }),
    cases: cases::interlevel_loss,
    mistakes: mistakes::INTERLEVEL_LOSS,
    special: Special { large: cases::large, ..Special::NONE },
};
