//! Registry rows of fisheye lenses.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// The polynomial's coefficients.
const COEFFICIENTS: Port = Port::smooth("coefficients", "4", "k1, k2, k3, k4 of the angle's polynomial");

/// Ideal points to a fisheye's picture.
pub(crate) const FISHEYE_DISTORT: Component = Component {
    name: "fisheye_distort",
    folder: "fisheye",
    code: include_str!("honest.rs"),
    formula: "(x', y') = (theta_d / r) (x, y), theta = atan r, theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)",
    source: "OpenCV, Fisheye camera model; Kannala and Brandt 2006, equation 6",
    inputs: &[Port::smooth("points", "M,2", "ideal points, x/z and y/z in camera space"), COEFFICIENTS],
    outputs: &[Port::smooth("distorted", "M,2", "where they land, in the same units")],
    conventions: &[],
    forward: Direction {
        oracle: arrays::fisheye_distort,
        bound: bound::fisheye_distort,
        honest: honest::fisheye_distort,
        wrong: mistakes::fisheye_distort,
    },
    vjp: Some(Direction {
        oracle: arrays::fisheye_distort_vjp,
        bound: bound::fisheye_distort_vjp,
        honest: honest::fisheye_distort_vjp,
        wrong: mistakes::fisheye_distort_vjp,
    }),
    cases: cases::fisheye_distort,
    mistakes: mistakes::FISHEYE_DISTORT,
    special: Special {
        large: cases::large_distort,
        laws: Some(mistakes::laws::OF_FISHEYES),
        ..Special::NONE
    },
};

/// And back.
pub(crate) const FISHEYE_UNDISTORT: Component = Component {
    name: "fisheye_undistort",
    folder: "fisheye",
    code: include_str!("honest.rs"),
    formula: "(x, y) = (tan theta / theta_d) (x', y'), theta the angle before every fold with theta_d = |(x', y')|",
    source: "OpenCV, Fisheye camera model; its inverse, which has no formula",
    inputs: &[
        Port::smooth("distorted", "M,2", "points of the fisheye's picture, (u - cx) / fx and (v - cy) / fy"),
        COEFFICIENTS,
    ],
    outputs: &[Port::smooth("points", "M,2", "ideal points, x/z and y/z in camera space")],
    conventions: &[],
    forward: Direction {
        oracle: arrays::fisheye_undistort,
        bound: bound::fisheye_undistort,
        honest: honest::fisheye_undistort,
        wrong: mistakes::fisheye_undistort,
    },
    vjp: Some(Direction {
        oracle: arrays::fisheye_undistort_vjp,
        bound: bound::fisheye_undistort_vjp,
        honest: honest::fisheye_undistort_vjp,
        wrong: mistakes::fisheye_undistort_vjp,
    }),
    cases: cases::fisheye_undistort,
    mistakes: mistakes::FISHEYE_UNDISTORT,
    special: Special { large: cases::large_undistort, ..Special::NONE },
};
