//! Registry rows of lenses.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::{Reach, Special};

/// OpenCV's coefficients.
const COEFFICIENTS: Port = Port::smooth(
    "coefficients",
    "C",
    "of the lens in OpenCV's order: k1, k2, p1, p2; k3 where there are 5; k4, k5, k6 where there are 8",
);

/// Most programs have five of them, or four.
const SPECIAL: Special =
    Special { reach: Some(Reach { input: "coefficients", least: 4.0 }), ..Special::NONE };

/// Ideal points to the distorted picture.
pub(crate) const LENS_DISTORT: Component = Component {
    name: "lens_distort",
    folder: "lens",
    code: include_str!("honest.rs"),
    formula: "x' = x radial + 2 p1 x y + p2 (r^2 + 2 x^2), y' = y radial + p1 (r^2 + 2 y^2) + 2 p2 x y, radial = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)",
    source: "OpenCV, Camera Calibration and 3D Reconstruction; Brown 1966",
    inputs: &[Port::smooth("points", "M,2", "ideal points, x/z and y/z in camera space"), COEFFICIENTS],
    outputs: &[Port::smooth("distorted", "M,2", "where they land, in the same units")],
    conventions: &[],
    forward: Direction {
        oracle: arrays::lens_distort,
        bound: bound::lens_distort,
        honest: honest::lens_distort,
        wrong: mistakes::lens_distort,
    },
    vjp: Some(Direction {
        oracle: arrays::lens_distort_vjp,
        bound: bound::lens_distort_vjp,
        honest: honest::lens_distort_vjp,
        wrong: mistakes::lens_distort_vjp,
    }),
    cases: cases::lens_distort,
    mistakes: mistakes::LENS_DISTORT,
    special: Special { large: cases::large_distort, ..SPECIAL },
};

/// And back.
pub(crate) const LENS_UNDISTORT: Component = Component {
    name: "lens_undistort",
    folder: "lens",
    code: include_str!("honest.rs"),
    formula: "the point before every fold of the lens for which lens_distort(points, coefficients) = distorted",
    source: "OpenCV, Camera Calibration and 3D Reconstruction; its inverse, which has no formula",
    inputs: &[
        Port::smooth("distorted", "M,2", "points of the distorted picture, (u - cx) / fx and (v - cy) / fy"),
        COEFFICIENTS,
    ],
    outputs: &[Port::smooth("points", "M,2", "ideal points, x/z and y/z in camera space")],
    conventions: &[],
    forward: Direction {
        oracle: arrays::lens_undistort,
        bound: bound::lens_undistort,
        honest: honest::lens_undistort,
        wrong: mistakes::lens_undistort,
    },
    vjp: Some(Direction {
        oracle: arrays::lens_undistort_vjp,
        bound: bound::lens_undistort_vjp,
        honest: honest::lens_undistort_vjp,
        wrong: mistakes::lens_undistort_vjp,
    }),
    cases: cases::lens_undistort,
    mistakes: mistakes::LENS_UNDISTORT,
    special: Special {
        large: cases::large_undistort,
        laws: Some(mistakes::laws::OF_UNDISTORTION),
        ..SPECIAL
    },
};
