//! Registry row of the frustum's Gaussian.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// From a ray's interval to a Gaussian.
pub(crate) const CONICAL_FRUSTUM: Component = Component {
    name: "conical_frustum",
    folder: "conical_frustum",
    code: include_str!("honest.rs"),
    formula: "mean o + t_mean d, variances t_variance d_i^2 + r_variance (1 - d_i^2 / |d|^2); with s = start + end, d = end - start and \
              q = d^2 / (3 s^2 + d^2): t_mean = s (1/2 + q), t_variance = d^2 (5 - 16 q + 20 q^2) / 60, r_variance = r^2 (s^2 / 16 + d^2 \
              (5/48 - q / 15))",
    source: "mip-NeRF (Barron et al. 2021) equations 7 and 8; google/mipnerf internal/mip.py conical_frustum_to_gaussian, lift_gaussian",
    inputs: &[
        Port::smooth("origins", "M,3", "where rays begin"),
        Port::smooth("directions", "M,3", "of any length but 0, in which t counts"),
        Port::smooth("radii", "M", "a cone's at t = 1, or a cylinder's"),
        Port::smooth("starts", "M", "first t of the intervals, not below 0"),
        Port::smooth("ends", "M", "last t, not below the first"),
    ],
    outputs: &[
        Port::smooth("t_mean", "M", "mean of t"),
        Port::smooth("t_variance", "M", "variance of t"),
        Port::smooth("r_variance", "M", "variance across the ray"),
        Port::smooth("means", "M,3", "means in space"),
        Port::smooth("variances", "M,3", "diagonals of the covariances in space"),
    ],
    conventions: &["ray_shape"],
    forward: Direction {
        oracle: arrays::conical_frustum,
        bound: bound::conical_frustum,
        honest: honest::conical_frustum,
        wrong: mistakes::conical_frustum,
    },
    vjp: Some(Direction {
        oracle: arrays::conical_frustum_vjp,
        bound: bound::conical_frustum_vjp,
        honest: honest::conical_frustum_vjp,
        wrong: mistakes::conical_frustum_vjp,
    }),
    cases: cases::conical_frustum,
    mistakes: mistakes::CONICAL_FRUSTUM,
    special: Special { large: cases::large, ..Special::NONE },
};
