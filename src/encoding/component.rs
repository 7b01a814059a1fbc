//! Registry row of the positional encoding.

use ndarray::{Array2, ArrayD, Axis, Ix2};

use super::{Encoding, backward, bound, cases, honest, mistakes};
use crate::contract::component::{Arrays, Component, Pass, Port, arrays, input, number};
use crate::convention::Conventions;

/// Positional encoding.
pub const POSITIONAL_ENCODING: Component = Component {
    name: "positional_encoding",
    folder: "encoding",
    formula: "x, then sin(2^k pi x), cos(2^k pi x) for k = 0, ..., L - 1",
    source: "NeRF (Mildenhall et al. 2020) equation 4",
    inputs: &[
        Port::smooth("x", "M,D", "points, period 2 in band 0"),
        Port::plain("L", "", "number of bands"),
    ],
    outputs: &[Port::smooth("encoding", "M,D+2LD", "identity, then the bands")],
    conventions: &["identity", "frequency", "bands", "columns"],
    forward: Pass {
        oracle: encoding,
        bound: bound::positional_encoding,
        honest: honest::positional_encoding,
        wrong: mistakes::positional_encoding,
    },
    vjp: Some(Pass {
        oracle: encoding_vjp,
        bound: bound::positional_encoding_vjp,
        honest: honest::positional_encoding_vjp,
        wrong: mistakes::positional_encoding_vjp,
    }),
    cases: cases::positional_encoding,
    mistakes: mistakes::POSITIONAL_ENCODING,
};

/// The encoding that the scalar `L` asks for.
pub(crate) fn settings(a: &Arrays, c: &Conventions) -> Encoding {
    Encoding::new(number(a, "L") as usize, c)
}

/// Rows of an (M, D) array.
pub(crate) fn rows(a: &Arrays, name: &str) -> Vec<Vec<f64>> {
    input(a, name).axis_iter(Axis(0)).map(|row| row.iter().copied().collect()).collect()
}

/// An (M, D) array from its rows; `width` is needed where there are none.
pub(crate) fn from_rows(rows: &[Vec<f64>], width: usize) -> ArrayD<f64> {
    Array2::from_shape_fn((rows.len(), width), |(m, d)| rows[m][d]).into_dyn()
}

/// D of `x`.
pub(crate) fn dims(a: &Arrays) -> usize {
    input(a, "x").view().into_dimensionality::<Ix2>().expect("x is (M, D)").ncols()
}

fn encoding(a: &Arrays, c: &Conventions) -> Arrays {
    let encoding = settings(a, c);
    let out: Vec<Vec<f64>> = rows(a, "x").iter().map(|x| super::positional_encoding(x, &encoding)).collect();
    arrays([("encoding", from_rows(&out, encoding.width(dims(a))))])
}

fn encoding_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let encoding = settings(a, c);
    let g = rows(a, "grad_encoding");
    let out: Vec<Vec<f64>> =
        rows(a, "x").iter().zip(&g).map(|(x, g)| backward::positional_encoding(x, &encoding, g)).collect();
    arrays([("grad_x", from_rows(&out, dims(a)))])
}
