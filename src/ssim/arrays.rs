//! The oracle of this folder on named arrays, and what turns these into its types and back.

use ndarray::{Array3, ArrayView3, Ix3};

use super::{Form, backward};
use crate::contract::arrays::{Arrays, arrays, input, number, scalar};
use crate::convention::{Conventions, PsnrPeak};

/// How windows are taken.
pub(crate) fn form(c: &Conventions) -> Form {
    Form { window: c.ssim_window, padding: c.ssim_padding, variance: c.ssim_variance }
}

/// The largest color value, as given or by convention 1.
pub(crate) fn peak(a: &Arrays, c: &Conventions) -> f64 {
    if c.ssim_peak == PsnrPeak::One { 1.0 } else { number(a, "peak") }
}

/// A picture of a case.
pub(crate) fn picture<'a>(a: &'a Arrays, name: &str) -> ArrayView3<'a, f64> {
    input(a, name).view().into_dimensionality::<Ix3>().expect("three axes")
}

/// Their similarity as the output.
pub(crate) fn forward(value: f64) -> Arrays {
    arrays([("value", scalar(value))])
}

/// Its gradient as the output.
pub(crate) fn vjp(gradient: Array3<f64>) -> Arrays {
    arrays([("grad_prediction", gradient.into_dyn())])
}

pub(super) fn ssim(a: &Arrays, c: &Conventions) -> Arrays {
    forward(super::ssim(picture(a, "prediction"), picture(a, "target"), peak(a, c), form(c)))
}

pub(super) fn ssim_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let (p, t) = (picture(a, "prediction"), picture(a, "target"));
    vjp(backward::ssim(p, t, peak(a, c), form(c), number(a, "grad_value")))
}
