//! The oracle of this folder on named arrays, and what turns these into its types and back.

use glam::DVec2;

use super::{backward, distort, undistort};
use crate::contract::arrays::{Arrays, values};
use crate::convention::Conventions;
use crate::lens::arrays::{Pair, forward, in_order, vjp};

/// The coefficients of a case.
pub(crate) fn coefficients(a: &Arrays) -> [f64; 4] {
    let k = values(a, "coefficients");
    [k[0], k[1], k[2], k[3]]
}

/// The ideal point, not a number where the lens has none.
pub(crate) fn undistorted(k: [f64; 4], target: Pair) -> DVec2 {
    undistort(k, target.into()).unwrap_or(DVec2::NAN)
}

pub(super) fn fisheye_distort(a: &Arrays, _: &Conventions) -> Arrays {
    let k = coefficients(a);
    forward(a, "points", "distorted", |p| distort(k, p.into()).to_array())
}

pub(super) fn fisheye_distort_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    let k = coefficients(a);
    let f = |p: Pair, g: Pair| {
        let (g_p, g_k) = backward::distort(k, p.into(), g.into());
        (g_p.to_array(), g_k)
    };
    vjp(a, "points", "distorted", f, in_order)
}

pub(super) fn fisheye_undistort(a: &Arrays, _: &Conventions) -> Arrays {
    let k = coefficients(a);
    forward(a, "distorted", "points", |target| undistorted(k, target).to_array())
}

pub(super) fn fisheye_undistort_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    let k = coefficients(a);
    let f = |target: Pair, g: Pair| {
        let (g_target, g_k) = backward::undistort(k, undistorted(k, target), g.into());
        (g_target.to_array(), g_k)
    };
    vjp(a, "distorted", "points", f, in_order)
}
