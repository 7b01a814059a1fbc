//! A Gaussian in a picture: EWA splatting's projection, by the Jacobian of the perspective at its mean.
//!
//! Zwicker et al. 2001, "EWA Volume Splatting", equations 26 to 31; 3D Gaussian Splatting (Kerbl et al. 2023), equation 5. Letters: `t`
//! the mean in the camera's axes (x right, y down, z forward), `J` the Jacobian, `R` the camera's rotation, `T` = J R, `h` what is added
//! to the variances, `a`, `b`, `c` the three numbers of the picture's covariance.

use crate::camera::Intrinsics;
use crate::convention::{
    CompensationFloor, RadiusFloor, SplatCenter, SplatClamp, SplatClampGradient, SplatCulling, SplatDilation,
};

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

/// The camera of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Rotation from the world to the camera, in rows: the upper left of `w2c`.
    pub rotation: [[f64; 3]; 3],
    /// Where the world's origin is in the camera's axes: the last column of `w2c`.
    pub translation: [f64; 3],
    /// Focal lengths and principal point, in pixels.
    pub k: Intrinsics,
    /// Width of the picture, in pixels.
    pub width: f64,
    /// Height of the picture, in pixels.
    pub height: f64,
}

/// How code bases project.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Form {
    /// Where pixels have their centers.
    pub center: SplatCenter,
    /// How much every splat is widened.
    pub dilation: SplatDilation,
    /// Where the Jacobian is clamped.
    pub clamp: SplatClamp,
    /// What of a clamped mean is differentiated.
    pub clamp_gradient: SplatClampGradient,
    /// The least half difference of variances in the radius.
    pub radius: RadiusFloor,
    /// The least compensation.
    pub compensation: CompensationFloor,
    /// What is said of a splat beside the picture.
    pub culling: SplatCulling,
}

/// A Gaussian in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Splat {
    /// Its mean, in pixels.
    pub mean: [f64; 2],
    /// Its covariance with the dilation: of x, of both, of y.
    pub covariance: [f64; 3],
    /// The inverse of that, in the same order.
    pub conic: [f64; 3],
    /// Depth along the camera's axis.
    pub depth: f64,
    /// How many pixels it reaches: three standard deviations along its long axis, rounded up.
    pub radius: f64,
    /// How much fainter it becomes so that the dilation adds no light.
    pub compensation: f64,
}

impl Splat {
    /// What is said of a splat that was culled.
    pub const NOWHERE: Splat = Splat {
        mean: [0.0; 2],
        covariance: [0.0; 3],
        conic: [0.0; 3],
        depth: 0.0,
        radius: 0.0,
        compensation: 0.0,
    };

    /// Whether its circle reaches into a picture of this width and height.
    pub fn touches(&self, size: [f64; 2]) -> bool {
        (0..2).all(|n| self.mean[n] + self.radius > 0.0 && self.mean[n] - self.radius < size[n])
    }
}

/// The projected Gaussian: t = R mean + translation, (fx t_x/t_z + cx, fy t_y/t_z + cy), T Sigma T^T + h, its inverse
/// (c, -b, a) / (a c - b^2), depth t_z, radius ceil(3 sqrt(lambda)) with the larger eigenvalue lambda, compensation
/// sqrt(det before / det after the dilation).
///
/// # Shapes
/// A mean and the upper triangle of a 3 x 3 covariance, row by row (xx, xy, xz, yy, yz, zz).
///
/// # Units
/// Mean in those of the scene, results in pixels; depth in those of the scene.
///
/// # Convention
/// Means lie in front of the camera (t_z > 0): what is culled is the caller's. In J t_x/t_z is clamped, lest a splat beside the camera
/// fill the picture; the mean in the picture isn't. `form` says where, and the rest. [`SplatCulling::Zero`] says
/// [`Splat::NOWHERE`] of a splat whose circle misses the picture; its gradient is 0.
///
/// ```
/// use nerf_oracle::camera::Intrinsics;
/// use nerf_oracle::gaussian_projection::{Form, View, project};
/// let view = View {
///     rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
///     translation: [0.0; 3],
///     k: Intrinsics { fx: 20.0, fy: 20.0, cx: 16.0, cy: 16.0 },
///     width: 32.0,
///     height: 32.0,
/// };
/// // A ball of deviation 1/2 at depth 2: (20/2 1/2)^2 square pixels, and 0.3 besides.
/// let splat = project([0.0, 0.0, 2.0], [0.25, 0.0, 0.0, 0.25, 0.0, 0.25], &view, Form::default());
/// assert_eq!((splat.mean, splat.covariance, splat.depth), ([16.0, 16.0], [25.3, 0.0, 25.3], 2.0));
/// assert_eq!(splat.radius, 16.0);
/// ```
pub fn project(mean: [f64; 3], sigma: [f64; 6], view: &View, form: Form) -> Splat {
    let t = in_camera(mean, view);
    let shift = if form.center == SplatCenter::Integer { 0.5 } else { 0.0 };
    let [p, q] = transform(t, view, form);
    let (before, h) =
        ([quadratic(p, sigma, p), quadratic(p, sigma, q), quadratic(q, sigma, q)], form.dilation.value());
    let [a, b, c] = [before[0] + h, before[1], before[2] + h];
    let (det, least) = (a * c - b * b, form.compensation.determinant());
    let ratio = (before[0] * before[2] - b * b).max(least) / det.max(least);
    let half = 0.5 * (a - c);
    let larger = 0.5 * (a + c) + (half * half + b * b).max(form.radius.value()).sqrt();
    let splat = Splat {
        mean: [view.k.fx * (t[0] / t[2]) + view.k.cx - shift, view.k.fy * (t[1] / t[2]) + view.k.cy - shift],
        covariance: [a, b, c],
        conic: [c / det, -b / det, a / det],
        depth: t[2],
        radius: (3.0 * larger.sqrt()).ceil(),
        compensation: ratio.max(0.0).sqrt().max(form.compensation.value()),
    };
    let kept = form.culling == SplatCulling::Kept || splat.touches([view.width, view.height]);
    if kept { splat } else { Splat::NOWHERE }
}

/// A mean in the camera's axes.
fn in_camera(mean: [f64; 3], view: &View) -> [f64; 3] {
    [0, 1, 2].map(|i| {
        let r = view.rotation[i];
        r[0] * mean[0] + r[1] * mean[1] + r[2] * mean[2] + view.translation[i]
    })
}

/// t_x/t_z and t_y/t_z as the Jacobian has them, and whether each is clamped.
fn clamped(t: [f64; 3], view: &View, form: Form) -> [(f64, bool); 2] {
    let axis = |slope: f64, limits: [f64; 2]| {
        let held = slope.max(limits[0]).min(limits[1]);
        (held, held != slope)
    };
    [
        axis(t[0] / t[2], limits(view.k.fx, view.k.cx, view.width, form.clamp)),
        axis(t[1] / t[2], limits(view.k.fy, view.k.cy, view.height, form.clamp)),
    ]
}

/// The least and the largest slope of the Jacobian, along an axis with this focal length, principal point and size.
fn limits(f: f64, center: f64, size: f64, clamp: SplatClamp) -> [f64; 2] {
    let half = 0.5 * size / f;
    match clamp {
        SplatClamp::Picture => [-(center / f + 0.3 * half), (size - center) / f + 0.3 * half],
        SplatClamp::Centered => [-1.3 * half, 1.3 * half],
        SplatClamp::None => [f64::NEG_INFINITY, f64::INFINITY],
    }
}

/// T = J R, in rows: J = (fx/z, 0, -fx x/z^2; 0, fy/z, -fy y/z^2).
fn transform(t: [f64; 3], view: &View, form: Form) -> [[f64; 3]; 2] {
    let [(x, _), (y, _)] = clamped(t, view, form);
    let row = |axis: usize, f: f64, slope: f64| {
        [0, 1, 2].map(|k| f / t[2] * (view.rotation[axis][k] - slope * view.rotation[2][k]))
    };
    [row(0, view.k.fx, x), row(1, view.k.fy, y)]
}

/// Sigma v, of a symmetric matrix by its upper triangle.
fn times(s: [f64; 6], v: [f64; 3]) -> [f64; 3] {
    [
        s[0] * v[0] + s[1] * v[1] + s[2] * v[2],
        s[1] * v[0] + s[3] * v[1] + s[4] * v[2],
        s[2] * v[0] + s[4] * v[1] + s[5] * v[2],
    ]
}

/// p^T Sigma q.
fn quadratic(p: [f64; 3], sigma: [f64; 6], q: [f64; 3]) -> f64 {
    let s = times(sigma, q);
    p[0] * s[0] + p[1] * s[1] + p[2] * s[2]
}
