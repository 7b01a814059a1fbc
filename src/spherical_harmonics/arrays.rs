//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::backward;
use crate::contract::arrays::{Arrays, arrays, from_rows, number, rows};
use crate::convention::Conventions;

/// Number of values for the `degree` that the arrays ask for.
pub(crate) fn width(a: &Arrays) -> usize {
    (degree(a) + 1) * (degree(a) + 1)
}

/// The last band.
pub(crate) fn degree(a: &Arrays) -> usize {
    number(a, "degree") as usize
}

/// Directions, one a row.
pub(crate) fn directions(a: &Arrays) -> Vec<[f64; 3]> {
    rows(a, "d").iter().map(|d| [d[0], d[1], d[2]]).collect()
}

/// `f(direction)` for each row, as the output.
pub(crate) fn forward(a: &Arrays, f: impl Fn([f64; 3]) -> Vec<f64>) -> Arrays {
    let out: Vec<Vec<f64>> = directions(a).into_iter().map(f).collect();
    arrays([("harmonics", from_rows(&out, width(a)))])
}

/// `f(direction, cotangent)` for each row, as the gradient.
pub(crate) fn vjp(a: &Arrays, f: impl Fn([f64; 3], &[f64]) -> [f64; 3]) -> Arrays {
    let g = rows(a, "grad_harmonics");
    let out: Vec<Vec<f64>> = directions(a).into_iter().zip(&g).map(|(d, g)| f(d, g).to_vec()).collect();
    arrays([("grad_d", from_rows(&out, 3))])
}

pub(super) fn harmonics(a: &Arrays, c: &Conventions) -> Arrays {
    forward(a, |d| super::harmonics(d, degree(a), c.harmonic_form, c.harmonic_sign))
}

pub(super) fn harmonics_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    vjp(a, |d, g| backward::harmonics(d, degree(a), c.harmonic_form, c.harmonic_sign, g))
}
