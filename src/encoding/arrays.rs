//! The oracle of this folder on named arrays, and what turns these into its types and back.

use ndarray::Ix2;

use super::{Encoding, backward};
use crate::contract::arrays::{Arrays, arrays, from_rows, input, number, rows};
use crate::convention::Conventions;

/// The encoding that the scalar `L` asks for.
pub(crate) fn settings(a: &Arrays, c: &Conventions) -> Encoding {
    Encoding::new(number(a, "L") as usize, c)
}

/// D of `x`.
pub(crate) fn dims(a: &Arrays) -> usize {
    input(a, "x").view().into_dimensionality::<Ix2>().expect("x is (M, D)").ncols()
}

/// Whether a cotangent is as wide as these conventions make the encoding.
pub(super) fn admits(a: &Arrays, c: &Conventions) -> bool {
    a.get("grad_encoding").is_none_or(|g| g.shape()[1] == settings(a, c).width(dims(a)))
}

pub(super) fn encoding(a: &Arrays, c: &Conventions) -> Arrays {
    let encoding = settings(a, c);
    let out: Vec<Vec<f64>> = rows(a, "x").iter().map(|x| super::positional_encoding(x, &encoding)).collect();
    arrays([("encoding", from_rows(&out, encoding.width(dims(a))))])
}

pub(super) fn encoding_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let encoding = settings(a, c);
    let g = rows(a, "grad_encoding");
    let out: Vec<Vec<f64>> =
        rows(a, "x").iter().zip(&g).map(|(x, g)| backward::positional_encoding(x, &encoding, g)).collect();
    arrays([("grad_x", from_rows(&out, dims(a)))])
}
