//! The oracle of this folder on named arrays, and what turns these into its types and back.

use ndarray::Axis;

use super::backward;
use crate::contract::arrays::{Arrays, array, arrays, input, number, scalar, values};
use crate::convention::{Conventions, PsnrPeak};

/// The pictures of a batch, each a flat slice.
pub(crate) fn pictures(a: &Arrays, name: &str) -> Vec<Vec<f64>> {
    input(a, name).axis_iter(Axis(0)).map(|picture| picture.iter().copied().collect()).collect()
}

pub(super) fn mse(a: &Arrays, _: &Conventions) -> Arrays {
    arrays([("value", scalar(super::mse(&values(a, "prediction"), &values(a, "target"))))])
}

pub(super) fn mse_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    let g = backward::mse(&values(a, "prediction"), &values(a, "target"), number(a, "grad_value"));
    arrays([("grad_prediction", like(a, "prediction", g))])
}

pub(super) fn psnr(a: &Arrays, c: &Conventions) -> Arrays {
    let (predictions, targets) = (pictures(a, "prediction"), pictures(a, "target"));
    let predictions: Vec<&[f64]> = predictions.iter().map(Vec::as_slice).collect();
    let targets: Vec<&[f64]> = targets.iter().map(Vec::as_slice).collect();
    let value = super::psnr_of_images(&predictions, &targets, peak(a, c), c.psnr, c.psnr_floor);
    arrays([("value", scalar(value))])
}

/// The largest color value, as given or by convention 1.
pub(crate) fn peak(a: &Arrays, c: &Conventions) -> f64 {
    if c.psnr_peak == PsnrPeak::One { 1.0 } else { number(a, "peak") }
}

pub(super) fn to_uint8(a: &Arrays, c: &Conventions) -> Arrays {
    arrays([("bytes", input(a, "image").mapv(|x| f64::from(super::to_uint8(x, c.bytes))))])
}

/// Entries in the shape of an input.
pub(crate) fn like(a: &Arrays, name: &str, entries: Vec<f64>) -> ndarray::ArrayD<f64> {
    array(input(a, name).shape(), entries)
}
