//! Registry row of the distortion loss.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// How far apart along a ray its weights lie.
pub(crate) const DISTORTION_LOSS: Component = Component {
    name: "distortion_loss",
    folder: "distortion",
    code: include_str!("honest.rs"),
    formula: "sum_ij w_i w_j |m_i - m_j| + 1/3 sum_i w_i^2 (t_{i+1} - t_i), m_i = (t_i + t_{i+1}) / 2; of each ray",
    source: "mip-NeRF 360 (Barron et al. 2022), equation 15",
    inputs: &[
        Port::smooth("weights", "R,N", "weights of the intervals"),
        Port::smooth("t", "R,N+1", "their edges, never falling: distances, or normalized ones"),
    ],
    outputs: &[Port::smooth("loss", "R", "of each ray: add up or average them yourself")],
    conventions: &[],
    forward: Direction {
        oracle: arrays::distortion,
        bound: bound::distortion,
        honest: honest::distortion,
        wrong: mistakes::distortion,
    },
    vjp: Some(Direction {
        oracle: arrays::distortion_vjp,
        bound: bound::distortion_vjp,
        honest: honest::distortion_vjp,
        wrong: mistakes::distortion_vjp,
    }),
    cases: cases::distortion_loss,
    mistakes: mistakes::DISTORTION_LOSS,
    special: Special { large: cases::large, laws: Some(mistakes::laws::OF_INTERVALS), ..Special::NONE },
};
