//! Registry row of structural similarity.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::arrays::number;
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::{Form, Only, Special};

/// Functions of pictures in [0, 1] alone.
const OF_ONE: &[Form] = &[Form {
    without: &["peak"],
    takes: None,
    meaning: "1: colors lie in [0, 1]",
    holds: |a, _| number(a, "peak") == 1.0,
}];

/// How alike two pictures look.
pub(crate) const SSIM: Component = Component {
    name: "ssim",
    folder: "ssim",
    code: include_str!("honest.rs"),
    formula: "mean over windows and channels of (2 ma mb + c1) (2 sab + c2) / ((ma^2 + mb^2 + c1) (sa^2 + sb^2 + c2)), \
              c = (0.01 peak)^2, (0.03 peak)^2; 11 x 11, Gaussian of 1.5",
    source: "Wang et al. 2004, equations 13 to 17; graphdeco-inria/gaussian-splatting utils/loss_utils.py (padding)",
    inputs: &[
        Port::smooth("prediction", "H,W,C", "a rendered picture, at least 11 x 11"),
        Port::plain("target", "H,W,C", "its photograph"),
        Port::plain("peak", "", "largest color value"),
    ],
    outputs: &[Port::smooth("value", "", "structural similarity, 1 for equal pictures: not 1 less it")],
    conventions: &["ssim_window", "ssim_padding", "ssim_variance", "ssim_peak"],
    forward: Direction {
        oracle: arrays::ssim,
        bound: bound::ssim,
        honest: honest::ssim,
        wrong: mistakes::ssim,
    },
    vjp: Some(Direction {
        oracle: arrays::ssim_vjp,
        bound: bound::ssim_vjp,
        honest: honest::ssim_vjp,
        wrong: mistakes::ssim_vjp,
    }),
    cases: cases::ssim,
    mistakes: mistakes::SSIM,
    special: Special {
        only: Some(Only { input: "prediction", axis: 2, lengths: &[3], what: "channels" }),
        large: cases::large,
        forms: OF_ONE,
        // Each pixel is in up to 121 windows, but in few where pictures are hardly larger than a window.
        work: 32,
        laws: Some(mistakes::laws::OF_SIMILARITY),
        ..Special::NONE
    },
};
