//! Registry row of a Gaussian's covariance.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// From rotation and scales to a covariance.
pub(crate) const GAUSSIAN_COVARIANCE: Component = Component {
    name: "gaussian_covariance",
    folder: "gaussian_covariance",
    code: include_str!("honest.rs"),
    formula: "R diag(s)^2 R^T, R the rotation of q / |q|",
    source: "3D Gaussian Splatting (Kerbl et al. 2023), equation 6; gradients: its appendix A",
    inputs: &[
        Port::smooth("quaternions", "M,4", "rotations, of any length but 0"),
        Port::smooth("scales", "M,3", "standard deviations along the axes, or their logarithms"),
    ],
    outputs: &[Port::smooth("covariances", "M,3,3", "symmetric; a gradient has all nine entries")],
    conventions: &["quaternion_order", "quaternion_length", "splat_scale"],
    forward: Direction {
        oracle: arrays::covariance,
        bound: bound::covariance,
        honest: honest::covariance,
        wrong: mistakes::covariance,
    },
    vjp: Some(Direction {
        oracle: arrays::covariance_vjp,
        bound: bound::covariance_vjp,
        honest: honest::covariance_vjp,
        wrong: mistakes::covariance_vjp,
    }),
    cases: cases::gaussian_covariance,
    mistakes: mistakes::GAUSSIAN_COVARIANCE,
    special: Special { large: cases::large, laws: Some(mistakes::laws::OF_SPLATS), ..Special::NONE },
};
