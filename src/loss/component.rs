//! Registry rows of loss, metric and bytes.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::arrays::number;
use crate::contract::component::{Component, Direction, Entries, Port};
use crate::contract::special::{Form, Special};

/// Mean squared error.
pub(crate) const MSE: Component = Component {
    name: "mse",
    folder: "loss",
    code: include_str!("honest.rs"),
    formula: "mean of (prediction - target)^2 over all entries",
    source: "NeRF (Mildenhall et al. 2020) equation 6, with the mean of its code",
    inputs: &[
        Port::smooth("prediction", "...", "rendered colors"),
        Port::plain("target", "...", "photographed colors"),
    ],
    outputs: &[Port::smooth("value", "", "mean squared error")],
    conventions: &[],
    forward: Direction { oracle: arrays::mse, bound: bound::mse, honest: honest::mse, wrong: mistakes::mse },
    vjp: Some(Direction {
        oracle: arrays::mse_vjp,
        bound: bound::mse_vjp,
        honest: honest::mse_vjp,
        wrong: mistakes::mse_vjp,
    }),
    cases: cases::mse,
    mistakes: mistakes::MSE,
    special: Special { large: cases::large_mse, ..Special::NONE },
};

/// Figures of pictures in [0, 1] alone.
const OF_ONE: &[Form] = &[Form {
    without: &["peak"],
    takes: None,
    meaning: "1: colors lie in [0, 1]",
    holds: |a, _| number(a, "peak") == 1.0,
}];

/// Peak signal-to-noise ratio.
pub(crate) const PSNR: Component = Component {
    name: "psnr",
    folder: "loss",
    code: include_str!("honest.rs"),
    formula: "10 log10(peak^2 / mse), mean over pictures or of the mean error",
    source: "NeRF (Mildenhall et al. 2020) section 6; bmild/nerf run_nerf_helpers.py mse2psnr",
    inputs: &[
        Port::plain("prediction", "B,H,W,3", "rendered pictures"),
        Port::plain("target", "B,H,W,3", "photographs"),
        Port::plain("peak", "", "largest color value"),
    ],
    outputs: &[Port::plain("value", "", "decibels; infinite where a picture is reproduced exactly")],
    conventions: &["psnr", "psnr_floor", "psnr_peak"],
    forward: Direction {
        oracle: arrays::psnr,
        bound: bound::psnr,
        honest: honest::psnr,
        wrong: mistakes::psnr,
    },
    vjp: None,
    cases: cases::psnr,
    mistakes: mistakes::PSNR,
    special: Special {
        large: cases::large_psnr,
        forms: OF_ONE,
        laws: Some(mistakes::laws::OF_PSNR),
        ..Special::NONE
    },
};

/// Colors as bytes.
pub(crate) const TO_UINT8: Component = Component {
    name: "to_uint8",
    folder: "loss",
    code: include_str!("honest.rs"),
    formula: "round(255 clip(x, 0, 1)), halves away from 0; or floor",
    source: "bmild/nerf run_nerf_helpers.py to8b (floor); imageio and torchvision (round)",
    inputs: &[Port::plain("image", "H,W,3", "colors, beyond [0, 1] too")],
    outputs: &[Port::plain("bytes", "H,W,3", "0, ..., 255").of(Entries::Byte)],
    conventions: &["bytes"],
    forward: Direction {
        oracle: arrays::to_uint8,
        bound: bound::to_uint8,
        honest: honest::to_uint8,
        wrong: mistakes::to_uint8,
    },
    vjp: None,
    cases: cases::to_uint8,
    mistakes: mistakes::TO_UINT8,
    special: Special { large: cases::large_to_uint8, ..Special::NONE },
};
