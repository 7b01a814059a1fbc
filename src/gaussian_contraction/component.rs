//! Registry row of the contraction of Gaussians.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// Gaussians of all of space in a ball or a cube.
pub(crate) const CONTRACT_GAUSSIANS: Component = Component {
    name: "contract_gaussians",
    folder: "gaussian_contraction",
    code: include_str!("honest.rs"),
    formula: "f(mean), J Sigma J^T; J the Jacobian of the contraction f at the mean",
    source: "mip-NeRF 360 (Barron et al. 2022), section 3.1 and equation 10; multinerf internal/coord.py track_linearize",
    inputs: &[
        Port::smooth("means", "M,3", "what is near lies within length 1"),
        Port::smooth("covariances", "M,3,3", "symmetric; a gradient has all nine entries"),
    ],
    outputs: &[
        Port::smooth("contracted_means", "M,3", "within 2 of the origin, or scaled"),
        Port::smooth("contracted_covariances", "M,3,3", "of the contraction's tangents at the means"),
    ],
    conventions: &["contraction_norm", "contraction_range"],
    forward: Direction {
        oracle: arrays::contract_gaussians,
        bound: bound::contract_gaussians,
        honest: honest::contract_gaussians,
        wrong: mistakes::contract_gaussians,
    },
    vjp: Some(Direction {
        oracle: arrays::contract_gaussians_vjp,
        bound: bound::contract_gaussians_vjp,
        honest: honest::contract_gaussians_vjp,
        wrong: mistakes::contract_gaussians_vjp,
    }),
    cases: cases::contract_gaussians,
    mistakes: mistakes::CONTRACT_GAUSSIANS,
    special: Special { large: cases::large, ..Special::NONE },
};
