//! OpenCV's lens distortion with two radial and two tangential coefficients, and its inverse.

use glam::{DMat2, DVec2};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Input, Result};

/// Coefficients as OpenCV and COLMAP name them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distortion {
    /// Radial, r^2.
    pub k1: f64,
    /// Radial, r^4.
    pub k2: f64,
    /// Tangential.
    pub p1: f64,
    /// Tangential.
    pub p2: f64,
}

impl Distortion {
    /// Where an ideal point (x, y) = (x_c / z_c, y_c / z_c) lands on the distorted picture, in the same units.
    ///
    /// x' = x (1 + k1 r^2 + k2 r^4) + 2 p1 x y + p2 (r^2 + 2 x^2), and y' with p1 and p2 exchanged
    /// (OpenCV, "Camera Calibration and 3D Reconstruction").
    pub fn distort(&self, p: DVec2) -> DVec2 {
        let r2 = p.x * p.x + p.y * p.y;
        let radial = 1.0 + self.k1 * r2 + self.k2 * r2 * r2;
        DVec2::new(
            p.x * radial + 2.0 * self.p1 * p.x * p.y + self.p2 * (r2 + 2.0 * p.x * p.x),
            p.y * radial + self.p1 * (r2 + 2.0 * p.y * p.y) + 2.0 * self.p2 * p.x * p.y,
        )
    }

    /// The Jacobian of [`Self::distort`].
    pub fn jacobian(&self, p: DVec2) -> DMat2 {
        let r2 = p.x * p.x + p.y * p.y;
        let radial = 1.0 + self.k1 * r2 + self.k2 * r2 * r2;
        let slope = 2.0 * self.k1 + 4.0 * self.k2 * r2;
        let mixed = slope * p.x * p.y + 2.0 * self.p1 * p.x + 2.0 * self.p2 * p.y;
        DMat2::from_cols(
            DVec2::new(radial + slope * p.x * p.x + 2.0 * self.p1 * p.y + 6.0 * self.p2 * p.x, mixed),
            DVec2::new(mixed, radial + slope * p.y * p.y + 6.0 * self.p1 * p.y + 2.0 * self.p2 * p.x),
        )
    }

    /// The ideal point whose distorted image is `target`, by Newton's method from `target` itself.
    ///
    /// # Errors
    /// Where the lens folds over (the Jacobian is not positive definite), or 50 steps don't bring the residual below 1e-12: such a point
    /// has no trustworthy ray (CG5).
    ///
    /// ```
    /// use glam::DVec2;
    /// let lens = nerf_oracle::camera::Distortion { k1: 0.1, k2: -0.05, p1: 1e-3, p2: -1e-3 };
    /// let p = DVec2::new(0.3, -0.2);
    /// assert!((lens.undistort(lens.distort(p)).unwrap() - p).length() < 1e-12);
    /// ```
    pub fn undistort(&self, target: DVec2) -> Result<DVec2> {
        let mut p = target;
        for _ in 0..50 {
            let residual = self.distort(p) - target;
            let jacobian = self.jacobian(p);
            // Symmetric, so positive definite where these two hold: past two folds the determinant is positive again.
            if !(jacobian.determinant() > 0.0 && jacobian.x_axis.x > 0.0) {
                break;
            }
            if residual.length() < 1e-12 {
                return Ok(p);
            }
            p -= jacobian.inverse() * residual;
        }
        Err(Error::input(Input {
            file: "lens distortion",
            field: format!("k1 {}, k2 {}, p1 {}, p2 {}", self.k1, self.k2, self.p1, self.p2),
            found: format!("no inverse at ({}, {})", target.x, target.y),
            expected: "a lens that doesn't fold over inside the picture",
            remedy: "Check the coefficients, or undistort the pictures beforehand and set them to 0.",
        }))
    }
}
