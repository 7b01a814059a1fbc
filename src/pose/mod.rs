//! Poses: from how a structure from motion writes them to camera-to-world matrices.
//!
//! Letters: `q` = (w, x, y, z) a quaternion, scalar first, and `t` a translation, which together take the world to the camera:
//! x_c = R(q) x_w + t; `c2w` the way back.

use glam::{DMat3, DMat4, DVec3};

use crate::convention::{Axes, Quaternion};

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

/// The factor of the products in a rotation: 2 / |q|^2, or 2 where q is taken for a unit quaternion.
fn factor(q: [f64; 4], length: Quaternion) -> f64 {
    match length {
        Quaternion::Normalized => 2.0 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]),
        Quaternion::AsGiven => 2.0,
    }
}

/// The rotation of a quaternion: with s = 2 / |q|^2
///
/// R = I + s [-(y^2 + z^2), x y - w z, x z + w y; x y + w z, -(x^2 + z^2), y z - w x; x z - w y, y z + w x, -(x^2 + y^2)].
///
/// # Convention
/// (w, x, y, z), the scalar first, as COLMAP has it. `length`: s = 2 with [`Quaternion::AsGiven`], a rotation for unit quaternions alone.
///
/// ```
/// use nerf_oracle::{convention::Quaternion, pose::rotation};
/// // A quarter turn about z takes x to y.
/// let half = 0.5f64.sqrt();
/// let r = rotation([half, 0.0, 0.0, half], Quaternion::Normalized);
/// assert!((r.x_axis - glam::DVec3::Y).length() < 1e-15);
/// assert_eq!(rotation([2.0, 0.0, 0.0, 2.0], Quaternion::Normalized).x_axis, glam::DVec3::Y);
/// ```
pub fn rotation(q: [f64; 4], length: Quaternion) -> DMat3 {
    let s = factor(q, length);
    let [w, x, y, z] = q;
    DMat3::from_cols(
        DVec3::new(1.0 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)),
        DVec3::new(s * (x * y - w * z), 1.0 - s * (x * x + z * z), s * (y * z + w * x)),
        DVec3::new(s * (x * z + w * y), s * (y * z - w * x), 1.0 - s * (x * x + y * y)),
    )
}

/// Camera to world of a picture of COLMAP's: [R^T, -R^T t; 0, 0, 0, 1] with R = R(q).
///
/// COLMAP's `images.txt` and `images.bin` have the way from the world to the camera: its documentation, "Output Format".
///
/// # Units
/// t and the camera's place in those of the scene.
///
/// # Convention
/// `axes` says how the camera's own axes are called: OpenCV's are COLMAP's; with OpenGL's (y up, z backward) the second and the third
/// column change sign, and the camera stays where it is. `length` as with [`rotation`].
///
/// ```
/// use glam::{DMat4, DVec3};
/// use nerf_oracle::{convention::{Axes::{Opencv, Opengl}, Quaternion::Normalized}, pose::from_colmap};
/// // Without a rotation the world's origin lies at t before the camera: the camera is at -t.
/// let pose = from_colmap([1.0, 0.0, 0.0, 0.0], [1.0, 2.0, 3.0], Opencv, Normalized);
/// assert_eq!(pose, DMat4::from_translation(DVec3::new(-1.0, -2.0, -3.0)));
/// let pose = from_colmap([1.0, 0.0, 0.0, 0.0], [1.0, 2.0, 3.0], Opengl, Normalized);
/// assert_eq!(pose.z_axis.truncate(), DVec3::NEG_Z);
/// assert_eq!(pose.w_axis.truncate(), DVec3::new(-1.0, -2.0, -3.0));
/// ```
pub fn from_colmap(q: [f64; 4], t: [f64; 3], axes: Axes, length: Quaternion) -> DMat4 {
    let back = rotation(q, length).transpose();
    let place = -(back * DVec3::from(t));
    let flip = flip(axes);
    DMat4::from_cols(
        back.x_axis.extend(0.0),
        (flip * back.y_axis).extend(0.0),
        (flip * back.z_axis).extend(0.0),
        place.extend(1.0),
    )
}

/// What the camera's y and z axes are multiplied by.
fn flip(axes: Axes) -> f64 {
    match axes {
        Axes::Opencv => 1.0,
        Axes::Opengl => -1.0,
    }
}
