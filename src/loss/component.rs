//! Registry rows of loss, metric and bytes.

use ndarray::Axis;

use super::{backward, bound, cases, honest, mistakes};
use crate::contract::component::{Arrays, Component, Pass, Port, arrays, input, number, scalar, values};
use crate::convention::Conventions;

/// Mean squared error.
pub const MSE: Component = Component {
    name: "mse",
    folder: "loss",
    formula: "mean of (prediction - target)^2 over all entries",
    source: "NeRF (Mildenhall et al. 2020) equation 6, with the mean of its code",
    inputs: &[
        Port::smooth("prediction", "...", "rendered colors"),
        Port::plain("target", "...", "photographed colors"),
    ],
    outputs: &[Port::smooth("value", "", "mean squared error")],
    conventions: &[],
    forward: Pass { oracle: mse, bound: bound::mse, honest: honest::mse, wrong: mistakes::mse },
    vjp: Some(Pass {
        oracle: mse_vjp,
        bound: bound::mse_vjp,
        honest: honest::mse_vjp,
        wrong: mistakes::mse_vjp,
    }),
    cases: cases::mse,
    mistakes: mistakes::MSE,
};

/// Peak signal-to-noise ratio.
pub const PSNR: Component = Component {
    name: "psnr",
    folder: "loss",
    formula: "10 log10(peak^2 / mse), mean over pictures or of the mean error",
    source: "NeRF (Mildenhall et al. 2020) section 6; bmild/nerf run_nerf_helpers.py mse2psnr",
    inputs: &[
        Port::plain("prediction", "B,H,W,3", "rendered pictures"),
        Port::plain("target", "B,H,W,3", "photographs"),
        Port::plain("peak", "", "largest color value"),
    ],
    outputs: &[Port::plain("value", "", "decibels; infinite where a picture is reproduced exactly")],
    conventions: &["psnr"],
    forward: Pass { oracle: psnr, bound: bound::psnr, honest: honest::psnr, wrong: mistakes::psnr },
    vjp: None,
    cases: cases::psnr,
    mistakes: mistakes::PSNR,
};

/// Colors as bytes.
pub const TO_UINT8: Component = Component {
    name: "to_uint8",
    folder: "loss",
    formula: "round(255 clip(x, 0, 1)), halves away from 0; or floor",
    source: "bmild/nerf run_nerf_helpers.py to8b (floor); imageio and torchvision (round)",
    inputs: &[Port::plain("image", "H,W,3", "colors, beyond [0, 1] too")],
    outputs: &[Port::plain("bytes", "H,W,3", "0, ..., 255")],
    conventions: &["bytes"],
    forward: Pass {
        oracle: to_uint8,
        bound: bound::to_uint8,
        honest: honest::to_uint8,
        wrong: mistakes::to_uint8,
    },
    vjp: None,
    cases: cases::to_uint8,
    mistakes: mistakes::TO_UINT8,
};

/// The pictures of a batch, each a flat slice.
pub(crate) fn pictures(a: &Arrays, name: &str) -> Vec<Vec<f64>> {
    input(a, name).axis_iter(Axis(0)).map(|picture| picture.iter().copied().collect()).collect()
}

fn mse(a: &Arrays, _: &Conventions) -> Arrays {
    arrays([("value", scalar(super::mse(&values(a, "prediction"), &values(a, "target"))))])
}

fn mse_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    let g = backward::mse(&values(a, "prediction"), &values(a, "target"), number(a, "grad_value"));
    arrays([("grad_prediction", like(a, "prediction", g))])
}

fn psnr(a: &Arrays, c: &Conventions) -> Arrays {
    let (predictions, targets) = (pictures(a, "prediction"), pictures(a, "target"));
    let predictions: Vec<&[f64]> = predictions.iter().map(Vec::as_slice).collect();
    let targets: Vec<&[f64]> = targets.iter().map(Vec::as_slice).collect();
    arrays([("value", scalar(super::psnr_of_images(&predictions, &targets, number(a, "peak"), c.psnr)))])
}

fn to_uint8(a: &Arrays, c: &Conventions) -> Arrays {
    arrays([("bytes", input(a, "image").mapv(|x| f64::from(super::to_uint8(x, c.bytes))))])
}

/// Entries in the shape of an input.
pub(crate) fn like(a: &Arrays, name: &str, entries: Vec<f64>) -> ndarray::ArrayD<f64> {
    crate::contract::component::array(input(a, name).shape(), entries)
}
