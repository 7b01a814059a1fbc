//! Lenses: OpenCV's radial and tangential distortion, where a lens bends what a pinhole would see, and its inverse.
//!
//! Letters: `p` = (x, y) an ideal point, x_c / z_c and y_c / z_c of a point in camera space (OpenCV axes); `target` where it lands on the
//! distorted picture, in the same units; `r^2` = x^2 + y^2.

use glam::{DMat2, DVec2};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Input, Result};

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// Coefficients as OpenCV and COLMAP name them. Where there are fewer, the others are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Distortion {
    /// Radial, r^2.
    pub k1: f64,
    /// Radial, r^4.
    pub k2: f64,
    /// Tangential.
    pub p1: f64,
    /// Tangential.
    pub p2: f64,
    /// Radial, r^6.
    pub k3: f64,
    /// Radial, r^2 of the denominator.
    pub k4: f64,
    /// Radial, r^4 of the denominator.
    pub k5: f64,
    /// Radial, r^6 of the denominator.
    pub k6: f64,
}

/// The radial factor N/D of one point, and what its derivatives need.
pub(crate) struct Radial {
    /// x^2 + y^2.
    pub r2: f64,
    /// D = 1 + k4 r^2 + k5 r^4 + k6 r^6.
    pub denominator: f64,
    /// N/D, with N = 1 + k1 r^2 + k2 r^4 + k3 r^6.
    pub value: f64,
    /// Its derivative with respect to r^2.
    pub slope: f64,
}

impl Distortion {
    /// Coefficients in OpenCV's order: k1, k2, p1, p2, then k3, then k4, k5, k6.
    ///
    /// # Panics
    /// Where there aren't 4, 5 or 8.
    pub fn from_opencv(k: &[f64]) -> Distortion {
        assert!([4, 5, 8].contains(&k.len()), "coefficients: 4, 5 or 8, found {}", k.len());
        let at = |n: usize| k.get(n).copied().unwrap_or(0.0);
        Distortion { k1: k[0], k2: k[1], p1: k[2], p2: k[3], k3: at(4), k4: at(5), k5: at(6), k6: at(7) }
    }

    /// The radial factor at (x, y).
    pub(crate) fn radial(&self, p: DVec2) -> Radial {
        let r2 = p.x * p.x + p.y * p.y;
        let numerator = 1.0 + self.k1 * r2 + self.k2 * r2 * r2 + self.k3 * r2 * r2 * r2;
        let denominator = 1.0 + self.k4 * r2 + self.k5 * r2 * r2 + self.k6 * r2 * r2 * r2;
        let value = numerator / denominator;
        let of_numerator = self.k1 + 2.0 * self.k2 * r2 + 3.0 * self.k3 * r2 * r2;
        let of_denominator = self.k4 + 2.0 * self.k5 * r2 + 3.0 * self.k6 * r2 * r2;
        Radial { r2, denominator, value, slope: (of_numerator - value * of_denominator) / denominator }
    }

    /// Where an ideal point (x, y) = (x_c / z_c, y_c / z_c) lands on the distorted picture, in the same units.
    ///
    /// With r^2 = x^2 + y^2 and the radial factor (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6):
    /// x' = x radial + 2 p1 x y + p2 (r^2 + 2 x^2), y' = y radial + p1 (r^2 + 2 y^2) + 2 p2 x y
    /// (OpenCV, "Camera Calibration and 3D Reconstruction").
    ///
    /// # Units
    /// Points and results at depth 1: pixels are fx x' + cx, fy y' + cy.
    ///
    /// ```
    /// use glam::DVec2;
    /// use nerf_oracle::lens::Distortion;
    /// let lens = Distortion { k1: 0.5, p1: 0.125, ..Distortion::default() };
    /// assert_eq!(lens.distort(DVec2::new(1.0, 1.0)), DVec2::new(2.25, 2.5));
    /// ```
    pub fn distort(&self, p: DVec2) -> DVec2 {
        let Radial { r2, value, .. } = self.radial(p);
        DVec2::new(
            p.x * value + 2.0 * self.p1 * p.x * p.y + self.p2 * (r2 + 2.0 * p.x * p.x),
            p.y * value + self.p1 * (r2 + 2.0 * p.y * p.y) + 2.0 * self.p2 * p.x * p.y,
        )
    }

    /// The Jacobian of [`Self::distort`]. It is symmetric.
    pub fn jacobian(&self, p: DVec2) -> DMat2 {
        let Radial { value, slope, .. } = self.radial(p);
        let slope = 2.0 * slope;
        let mixed = slope * p.x * p.y + 2.0 * self.p1 * p.x + 2.0 * self.p2 * p.y;
        DMat2::from_cols(
            DVec2::new(value + slope * p.x * p.x + 2.0 * self.p1 * p.y + 6.0 * self.p2 * p.x, mixed),
            DVec2::new(mixed, value + slope * p.y * p.y + 6.0 * self.p1 * p.y + 2.0 * self.p2 * p.x),
        )
    }

    /// Whether the lens keeps its orientation at p: the Jacobian is positive definite. It is symmetric, so these two decide; the
    /// determinant alone is positive again past two folds.
    fn unfolded(&self, p: DVec2) -> bool {
        let jacobian = self.jacobian(p);
        jacobian.determinant() > 0.0 && jacobian.x_axis.x > 0.0
    }

    /// The ideal point whose distorted image is `target`, by Newton's method from `target` itself, with one step more when the residual is
    /// below 1e-12.
    ///
    /// # Errors
    /// Where 50 steps don't bring the residual below 1e-12, or the lens folds over on the way: the Jacobian isn't positive definite at one
    /// of Newton's points, or at one of 16 places between the middle and what it found. Such a point has no trustworthy ray (CG5).
    ///
    /// ```
    /// use glam::DVec2;
    /// use nerf_oracle::lens::Distortion;
    /// let lens = Distortion { k1: 0.1, k2: -0.05, p1: 1e-3, p2: -1e-3, ..Distortion::default() };
    /// let p = DVec2::new(0.3, -0.2);
    /// assert!((lens.undistort(lens.distort(p)).unwrap() - p).length() < 1e-15);
    /// // Steps of x = x' / radial(x), as is usual, swing between 1.042 and 1.407 here for ever:
    /// let lens = Distortion { k1: -0.45, k2: 0.25, ..Distortion::default() };
    /// assert!((lens.undistort(lens.distort(DVec2::new(1.25, 0.0))).unwrap().x - 1.25).abs() < 1e-15);
    /// ```
    pub fn undistort(&self, target: DVec2) -> Result<DVec2> {
        let mut p = target;
        for _ in 0..50 {
            if !self.unfolded(p) {
                break;
            }
            let residual = self.distort(p) - target;
            p -= self.jacobian(p).inverse() * residual;
            if residual.length() < 1e-12 {
                if (1..=16).all(|n| self.unfolded(p * (f64::from(n) / 16.0))) {
                    return Ok(p);
                }
                break;
            }
        }
        Err(Error::input(Input {
            file: "lens distortion",
            field: self.to_string(),
            found: format!("no inverse at ({}, {})", target.x, target.y),
            expected: "a lens that doesn't fold over inside the picture",
            remedy: "Check the coefficients, or undistort the pictures beforehand and set them to 0.",
        }))
    }
}

impl std::fmt::Display for Distortion {
    /// The coefficients that a lens has: k1, k2, p1, p2, and the others where they aren't 0.
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "k1 {}, k2 {}, p1 {}, p2 {}", self.k1, self.k2, self.p1, self.p2)?;
        for (name, k) in [("k3", self.k3), ("k4", self.k4), ("k5", self.k5), ("k6", self.k6)] {
            if k != 0.0 {
                write!(f, ", {name} {k}")?;
            }
        }
        Ok(())
    }
}
