//! Fisheye lenses: the angle off the axis is what a picture shows evenly, with a polynomial to mend it (Kannala and Brandt 2006).
//!
//! Letters: `p` = (x, y) an ideal point, x_c / z_c and y_c / z_c of a point in camera space (OpenCV axes); `r` its length; `theta` = atan r
//! its angle off the axis; `target` where it lands on the picture, in the same units, `theta_d` the length of that.

use glam::DVec2;

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

/// theta_d of an angle: theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8).
fn bent(k: [f64; 4], theta: f64) -> f64 {
    let t2 = theta * theta;
    theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))))
}

/// Its derivative.
fn bent_slope(k: [f64; 4], theta: f64) -> f64 {
    let t2 = theta * theta;
    1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])))
}

/// Where an ideal point lands on a fisheye's picture: (theta_d / r) (x, y), theta_d = theta (1 + k1 theta^2 + ... + k4 theta^8).
///
/// OpenCV, "Fisheye camera model"; Kannala and Brandt 2006, equation 6. In the middle nothing moves.
///
/// # Units
/// Points and results at depth 1, angles in radians: pixels are fx x' + cx, fy y' + cy.
///
/// ```
/// use glam::DVec2;
/// let landed = nerf_oracle::fisheye::distort([0.0; 4], DVec2::new(0.0, 1.0));
/// assert_eq!(landed, DVec2::new(0.0, std::f64::consts::FRAC_PI_4)); // 45 degrees off the axis
/// ```
pub fn distort(k: [f64; 4], p: DVec2) -> DVec2 {
    let r = p.length();
    if r == 0.0 {
        return p;
    }
    p * (bent(k, libm::atan(r)) / r)
}

/// The angle whose theta_d this is, by Newton's method from theta_d itself, with one step more when the residual is below 1e-12.
fn straightened(k: [f64; 4], theta_d: f64) -> Option<f64> {
    let mut theta = theta_d;
    for _ in 0..50 {
        let residual = bent(k, theta) - theta_d;
        theta -= residual / bent_slope(k, theta);
        if residual.abs() < 1e-12 {
            let rises = (1..=16).all(|n| bent_slope(k, theta * (f64::from(n) / 16.0)) > 0.0);
            return Some(theta).filter(|theta| rises && *theta < std::f64::consts::FRAC_PI_2);
        }
    }
    None
}

/// The ideal point that lands at `target`: (tan theta / theta_d) target, with the theta before every fold that is bent to theta_d.
///
/// # Errors
/// Where Newton's method doesn't converge, theta_d doesn't rise with theta all the way (looked at in 16 places), or theta is 90 degrees or
/// more, where no point at depth 1 is: such a point has no trustworthy ray (CG5).
///
/// ```
/// use glam::DVec2;
/// use nerf_oracle::fisheye::{distort, undistort};
/// let (k, p) = ([0.1, -0.02, 0.01, -0.001], DVec2::new(3.0, -4.0)); // 79 degrees off the axis
/// assert!((undistort(k, distort(k, p)).unwrap() - p).length() < 1e-13);
/// ```
pub fn undistort(k: [f64; 4], target: DVec2) -> Result<DVec2> {
    let theta_d = target.length();
    if theta_d == 0.0 {
        return Ok(target);
    }
    let theta = straightened(k, theta_d).ok_or_else(|| {
        Error::input(Input {
            file: "fisheye lens",
            field: format!("k1 {}, k2 {}, k3 {}, k4 {}", k[0], k[1], k[2], k[3]),
            found: format!("no inverse at ({}, {})", target.x, target.y),
            expected: "a lens that sees every angle below 90 degrees at one place of the picture",
            remedy: "Check the coefficients, or undistort the pictures beforehand.",
        })
    })?;
    Ok(target * (libm::tan(theta) / theta_d))
}
