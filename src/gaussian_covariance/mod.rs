//! The covariance of a Gaussian from its rotation and its scales: an ellipsoid, however the optimizer moves its parameters.
//!
//! 3D Gaussian Splatting (Kerbl et al. 2023), equation 6. Letters: `q` quaternion, `u` the same divided by its length, `R` its rotation,
//! `s` standard deviations along the axes, `M` = R diag(s).

use crate::convention::{QuaternionLength, QuaternionOrder, SplatScale};
use crate::math::exp;

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

/// How rotation and scales are written down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Form {
    /// Where the quaternion has its real part.
    pub order: QuaternionOrder,
    /// Whether it is divided by its length.
    pub length: QuaternionLength,
    /// What scales are.
    pub scale: SplatScale,
}

/// R diag(s)^2 R^T: the covariance of a Gaussian with these standard deviations along the columns of R.
///
/// # Shapes
/// A quaternion and three scales to a symmetric 3 x 3 matrix, in rows.
///
/// # Units
/// Scales in those of the scene, covariance in their squares.
///
/// # Convention
/// `form` says where the real part is, whether q is divided by its length here, and whether scales are logarithms. A quaternion of 0 has
/// no rotation: the result isn't a number where it is divided.
///
/// ```
/// use nerf_oracle::gaussian_covariance::{Form, covariance};
/// // A quarter turn about z takes the long axis from x to y, whatever the quaternion's length.
/// let turned = covariance([3.0, 0.0, 0.0, 3.0], [2.0, 1.0, 1.0], Form::default());
/// assert!((turned[0][0] - 1.0).abs() < 1e-14 && (turned[1][1] - 4.0).abs() < 1e-14 && turned[2][2] == 1.0);
/// ```
pub fn covariance(q: [f64; 4], scales: [f64; 3], form: Form) -> [[f64; 3]; 3] {
    let (r, s) = (rotation(unit(q, form).0), deviations(scales, form));
    let mut sigma = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            for k in 0..3 {
                sigma[i][j] += (r[i][k] * s[k]) * (r[j][k] * s[k]);
            }
        }
    }
    sigma
}

/// The matrix that turns as the unit quaternion w + x i + y j + z k does: v to u v u*.
///
/// # Convention
/// The polynomial is evaluated as it is: of a quaternion that isn't unit it is no rotation.
///
/// ```
/// use nerf_oracle::gaussian_covariance::rotation;
/// assert_eq!(rotation([0.5, 0.5, 0.5, 0.5]), [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
/// ```
pub fn rotation([w, x, y, z]: [f64; 4]) -> [[f64; 3]; 3] {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// The quaternion with its real part first, divided by its length, and that; length 1 where it is taken as it is.
fn unit(q: [f64; 4], form: Form) -> ([f64; 4], f64) {
    let q = match form.order {
        QuaternionOrder::RealFirst => q,
        QuaternionOrder::RealLast => [q[3], q[0], q[1], q[2]],
    };
    if form.length == QuaternionLength::AsGiven {
        return (q, 1.0);
    }
    let length = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    (q.map(|x| x / length), length)
}

/// Standard deviations along the axes.
fn deviations(scales: [f64; 3], form: Form) -> [f64; 3] {
    match form.scale {
        SplatScale::Plain => scales,
        SplatScale::Log => scales.map(exp),
    }
}
