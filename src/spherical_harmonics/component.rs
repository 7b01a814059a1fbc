//! Registry row of the spherical harmonics.

use super::{backward, bound, cases, honest, mistakes};
use crate::contract::component::{Arrays, Component, Pass, Port, arrays, number};
use crate::convention::Conventions;
use crate::encoding::component::{from_rows, rows};

/// Spherical harmonics of directions.
pub const SPHERICAL_HARMONICS: Component = Component {
    name: "spherical_harmonics",
    folder: "spherical_harmonics",
    formula: "Y_l^m(d) for l = 0, ..., degree and m = -l, ..., l, real, orthonormal, sign (-1)^m",
    source: "Sloan, Stupid Spherical Harmonics Tricks (2008), A2; Instant-NGP (Mueller et al. 2022) section 5.3",
    inputs: &[
        Port::smooth("d", "M,3", "directions of length 1, components in [-1, 1]"),
        Port::plain("degree", "", "last band, 0 to 4"),
    ],
    outputs: &[Port::smooth("harmonics", "M,(degree+1)^2", "band by band, m ascending")],
    conventions: &[],
    forward: Pass {
        oracle: harmonics,
        bound: bound::harmonics,
        honest: honest::harmonics,
        wrong: mistakes::harmonics,
    },
    vjp: Some(Pass {
        oracle: harmonics_vjp,
        bound: bound::harmonics_vjp,
        honest: honest::harmonics_vjp,
        wrong: mistakes::harmonics_vjp,
    }),
    cases: cases::spherical_harmonics,
    mistakes: mistakes::SPHERICAL_HARMONICS,
};

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

fn harmonics(a: &Arrays, _: &Conventions) -> Arrays {
    forward(a, |d| super::harmonics(d, degree(a)))
}

fn harmonics_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    vjp(a, |d, g| backward::harmonics(d, degree(a), g))
}
