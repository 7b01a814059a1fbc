//! Registry row of splats' colors.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::{Only, Special};

/// Colors of splats from where they are seen.
pub(crate) const GAUSSIAN_COLOR: Component = Component {
    name: "gaussian_color",
    folder: "gaussian_color",
    code: include_str!("honest.rs"),
    formula: "max(sum_k f_k Y_k(d / |d|) + 1/2, 0), d = mean - camera center",
    source: "3D Gaussian Splatting (Kerbl et al. 2023), section 4, and its rasterizer; Plenoxels (Fridovich-Keil et al. 2022)",
    inputs: &[
        Port::smooth("means", "M,3", "means of the splats"),
        Port::plain("camera_center", "3", "where the camera is"),
        Port::smooth(
            "coefficients",
            "M,B,3",
            "(degree + 1)^2 of each splat, band by band, three channels each",
        ),
    ],
    outputs: &[Port::smooth("colors", "M,3", "not below 0")],
    conventions: &["harmonic_sign", "splat_color"],
    forward: Direction {
        oracle: arrays::color,
        bound: bound::color,
        honest: honest::color,
        wrong: mistakes::color,
    },
    vjp: Some(Direction {
        oracle: arrays::color_vjp,
        bound: bound::color_vjp,
        honest: honest::color_vjp,
        wrong: mistakes::color_vjp,
    }),
    cases: cases::gaussian_color,
    mistakes: mistakes::GAUSSIAN_COLOR,
    special: Special {
        large: cases::large,
        laws: Some(mistakes::laws::OF_SPLATS),
        only: Some(Only {
            input: "coefficients",
            axis: 1,
            lengths: &[16, 9, 4],
            what: "coefficients a channel",
        }),
        ..Special::NONE
    },
};
