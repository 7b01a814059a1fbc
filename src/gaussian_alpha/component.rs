//! Registry row of splats' opacities.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// How opaque splats are at pixels.
pub(crate) const GAUSSIAN_ALPHA: Component = Component {
    name: "gaussian_alpha",
    folder: "gaussian_alpha",
    code: include_str!("honest.rs"),
    formula: "min(cap, opacity exp(-1/2 (A dx^2 + C dy^2) - B dx dy)), d from the mean to the pixel",
    source: "3D Gaussian Splatting (Kerbl et al. 2023), equations 3 and 4; cap and cut: its rasterizer",
    inputs: &[
        Port::plain("pixels", "P,2", "where pixels have their centers"),
        Port::smooth("means2d", "G,2", "means of the splats, in pixels"),
        Port::smooth("conics", "G,3", "inverse covariances: xx, xy, yy"),
        Port::smooth("opacities", "G", "opacities in the middle, from 0 to 1"),
    ],
    outputs: &[Port::smooth("alphas", "P,G", "of each splat at each pixel")],
    conventions: &["alpha_cap", "faint", "positive_power", "cap_gradient", "conic_gradient"],
    forward: Direction {
        oracle: arrays::alpha,
        bound: bound::alpha,
        honest: honest::alpha,
        wrong: mistakes::alpha,
    },
    vjp: Some(Direction {
        oracle: arrays::alpha_vjp,
        bound: bound::alpha_vjp,
        honest: honest::alpha_vjp,
        wrong: mistakes::alpha_vjp,
    }),
    cases: cases::gaussian_alpha,
    mistakes: mistakes::GAUSSIAN_ALPHA,
    special: Special {
        reads: &[("alphas", &["alpha_cap", "faint", "positive_power"])],
        large: cases::large,
        laws: Some(mistakes::laws::OF_PIXELS),
        ..Special::NONE
    },
};
