//! Rigid motions from the numbers that pose refinement learns: the exponential maps of rotation vectors and of twists.
//!
//! Letters: `w` a rotation vector, whose length theta is the angle in radians and whose direction the axis; K = `[w]_x` its matrix, K p =
//! w x p; `rho` the translational part of a twist; with it `w` makes six numbers.

use glam::{DMat3, DMat4, DVec3};

use crate::convention::{MotionLayout, RotationClamp, TwistOrder, TwistTranslation};
use crate::math::sin;

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

/// How a twist is written, and what becomes of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Twist {
    /// Which half comes first.
    pub order: TwistOrder,
    /// Whether the rotation turns the translation on its way.
    pub translation: TwistTranslation,
    /// The least angle of the coefficients.
    pub clamp: RotationClamp,
    /// Whether the matrix is for columns or for rows.
    pub layout: MotionLayout,
}

/// The rotation of a rotation vector (Rodrigues 1840):
///
/// R = I + a K + b K^2, a = sin theta / theta, b = (1 - cos theta) / theta^2; at 0 a = 1 and b = 1/2.
///
/// # Units
/// Radians.
///
/// # Convention
/// R turns columns, counterclockwise for who looks against w. `clamp`: with [`RotationClamp::Hundredth`] a and b are those of an angle of
/// 0.01 at least, and K is that of w.
///
/// ```
/// use glam::{DMat3, DVec3};
/// use nerf_oracle::{convention::RotationClamp::None, rigid_motion::so3_exp};
/// // A quarter turn about z takes x to y.
/// let r = so3_exp([0.0, 0.0, std::f64::consts::FRAC_PI_2], None);
/// assert!((r * DVec3::X - DVec3::Y).length() < 1e-15);
/// assert_eq!(so3_exp([0.0; 3], None), DMat3::IDENTITY);
/// // Near 0 the angle is that of the vector, to the last digit.
/// assert_eq!(so3_exp([0.0, 0.0, 1e-9], None).x_axis, DVec3::new(1.0, 1e-9, 0.0));
/// ```
pub fn so3_exp(w: [f64; 3], clamp: RotationClamp) -> DMat3 {
    let [a, b, ..] = coefficients(held(w, clamp));
    rotation(w, a, b)
}

/// The motion of a twist (Blanco 2010, section 10.1; Murray, Li and Sastry 1994, equation 2.36): [R, t; 0, 0, 0, 1] with R that of
/// [`so3_exp`] and
///
/// t = V rho, V = I + b K + c K^2, c = (theta - sin theta) / theta^3; at 0 c = 1/6.
///
/// # Units
/// w in radians, rho in the scene's.
///
/// # Convention
/// `form.order`: (rho, w), or (w, rho). `form.translation`: with [`TwistTranslation::Plain`] t = rho. `form.clamp`: as with [`so3_exp`], c
/// included. `form.layout`: with [`MotionLayout::ForRows`] the matrix is transposed, for points as rows.
///
/// ```
/// use glam::DVec3;
/// use nerf_oracle::{convention::TwistTranslation, rigid_motion::{Twist, se3_exp}};
/// // Ahead along x while turning by half a turn about z: half a circle, whose diameter is 2 / pi of its length.
/// let twist = [1.0, 0.0, 0.0, 0.0, 0.0, std::f64::consts::PI];
/// let place = se3_exp(twist, &Twist::default()).w_axis.truncate();
/// assert!((place - DVec3::new(0.0, 2.0 / std::f64::consts::PI, 0.0)).length() < 1e-15);
/// let plain = Twist { translation: TwistTranslation::Plain, ..Twist::default() };
/// assert_eq!(se3_exp(twist, &plain).w_axis.truncate(), DVec3::X);
/// ```
pub fn se3_exp(twist: [f64; 6], form: &Twist) -> DMat4 {
    let (rho, w) = halves(twist, form.order);
    let [a, b, c, ..] = coefficients(held(w, form.clamp));
    let r = rotation(w, a, b);
    let t = match form.translation {
        TwistTranslation::Plain => DVec3::from(rho),
        TwistTranslation::Coupled => along(w, rho, b, c),
    };
    let motion =
        DMat4::from_cols(r.x_axis.extend(0.0), r.y_axis.extend(0.0), r.z_axis.extend(0.0), t.extend(1.0));
    laid(motion, form.layout)
}

/// I + a K + b K^2.
fn rotation([x, y, z]: [f64; 3], a: f64, b: f64) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(1.0 - b * (y * y + z * z), b * x * y + a * z, b * x * z - a * y),
        DVec3::new(b * x * y - a * z, 1.0 - b * (x * x + z * z), b * y * z + a * x),
        DVec3::new(b * x * z + a * y, b * y * z - a * x, 1.0 - b * (x * x + y * y)),
    )
}

/// (I + b K + c K^2) p.
fn along(w: [f64; 3], p: [f64; 3], b: f64, c: f64) -> DVec3 {
    let (w, p) = (DVec3::from(w), DVec3::from(p));
    let across = w.cross(p);
    p + b * across + c * w.cross(across)
}

/// The translational and the rotational half of a twist.
fn halves(twist: [f64; 6], order: TwistOrder) -> ([f64; 3], [f64; 3]) {
    let [first, last] = [0, 3].map(|n| [twist[n], twist[n + 1], twist[n + 2]]);
    if order == TwistOrder::TranslationFirst { (first, last) } else { (last, first) }
}

/// A motion as its points are written.
fn laid(motion: DMat4, layout: MotionLayout) -> DMat4 {
    if layout == MotionLayout::ForColumns { motion } else { motion.transpose() }
}

/// The squared angle that coefficients are taken at.
fn held([x, y, z]: [f64; 3], clamp: RotationClamp) -> f64 {
    let square = x * x + y * y + z * z;
    if clamp == RotationClamp::None { square } else { square.max(LEAST_SQUARE) }
}

/// The square of the least angle, where there is one.
const LEAST_SQUARE: f64 = 1e-4;

/// The squared angle below which series are summed: beyond it quotients lose less than three bits.
const SERIES_BELOW: f64 = 4.0;

/// a, b, c and what follows them: c_k = sum_j (-x)^j / (k + 2 j)! of x = theta^2, for k from 1 to 5.
///
/// Each is a quotient of what the one two before it lacks, c_k = (1 / (k - 2)! - c_(k-2)) / x, in which small angles cancel; their series
/// doesn't: from the last two downward, c_k = 1 / k! - x c_(k+2).
fn coefficients(x: f64) -> [f64; 5] {
    if x < SERIES_BELOW {
        let (four, five) = (series(4.0, x) / 24.0, series(5.0, x) / 120.0);
        let (two, three) = (0.5 - x * four, 1.0 / 6.0 - x * five);
        return [1.0 - x * three, two, three, four, five];
    }
    let theta = x.sqrt();
    let (one, half) = (sin(theta) / theta, sin(0.5 * theta) / theta);
    let (two, three) = (2.0 * half * half, (1.0 - one) / x);
    [one, two, three, (0.5 - two) / x, (1.0 / 6.0 - three) / x]
}

/// k! c_k: 1 - x / ((k + 1) (k + 2)) (1 - x / ((k + 3) (k + 4)) (1 - ...)), whose next term is below 1e-20 of it.
fn series(k: f64, x: f64) -> f64 {
    let mut left = 1.0;
    for j in (1..=TERMS).rev() {
        let n = k + 2.0 * f64::from(j);
        left = 1.0 - x * left / (n * (n - 1.0));
    }
    left
}

/// Terms after the first.
const TERMS: u32 = 13;
