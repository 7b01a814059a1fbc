//! Fisheyes, wrong on purpose. Without a mistake every function equals the oracle.

use glam::DVec2;

use super::arrays::{coefficients, undistorted};
use super::{backward, bent, distort};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::lens::Distortion;
use crate::lens::arrays::{Pair, forward, in_order, vjp};

const OPENCV_LENS: Mistake = Mistake::new(
    "opencv_lens",
    "k1, k2, k3, k4 taken for the k1, k2, p1, p2 of the other model",
    "edges are bent the wrong way, and to one side: nothing but the middle of the picture fits",
    "look at the camera's model: OPENCV_FISHEYE, is_fisheye",
    "readers that know one model and take four coefficients for its",
    1,
);
const RADIUS_FOR_ANGLE: Mistake = Mistake::new(
    "radius_for_angle",
    "the polynomial of r = tan theta: without atan",
    "what is far off the axis lands outside of the picture",
    "theta = atan r",
    "never by itself; a pinhole's radius handed to the fisheye's polynomial",
    0,
);
const EVERY_POWER: Mistake = Mistake::new(
    "every_power",
    "theta (1 + k1 theta + k2 theta^2 + k3 theta^3 + k4 theta^4)",
    "the middle is bent as much as the edge",
    "even powers: theta^2, theta^4, ...",
    "never; cheap to keep",
    0,
);
const NAN_IN_THE_MIDDLE: Mistake = Mistake::new(
    "not_a_number_in_the_middle",
    "theta_d / r at r = 0, or tan theta / theta_d",
    "one pixel of a centered picture is NaN, and with it the batch that draws it",
    "1 where the radius is 0 (or below an eps)",
    "copies without OpenCV's test of r > 1e-8",
    1,
);
const LENS_HELD_CONSTANT: Mistake = Mistake::new(
    "lens_held_constant",
    "no gradient for the coefficients",
    "a calibration that is to be refined stays as it is",
    "g_kn = theta^(2n+1) (u . g); of an inverse by way of its stretch",
    "kernels without a backward pass (nerfacc's)",
    1,
)
.of_gradient();
const GRADIENT_NAN_IN_THE_MIDDLE: Mistake = Mistake::new(
    "gradient_not_a_number_in_the_middle",
    "the slope of |p| at 0, selected away in the forward pass alone",
    "a point in the middle makes every pose NaN",
    "keep r off 0 inside of the selection",
    "torch.where(r > 0, theta_d / r, 1): what isn't selected is differentiated too",
    1,
)
.of_gradient();

/// Mistakes of the fisheye.
pub(crate) const FISHEYE_DISTORT: &[Mistake] = &[
    OPENCV_LENS,
    RADIUS_FOR_ANGLE,
    EVERY_POWER,
    NAN_IN_THE_MIDDLE,
    Mistake::new(
        "not_divided_by_radius",
        "theta_d (x, y)",
        "the picture shrinks toward its middle with the square of the distance",
        "theta_d (x, y) / r",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "undone_instead",
        "the inverse: the ideal point that lands where this one is",
        "points project to the other side of where they are seen; errors double",
        "the formula as it is: distort takes ideal points",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "radius_not_differentiated",
        "the gradient (theta_d / r) g",
        "poses learn too fast along the radius, most at the edge",
        "what is along the radius is stretched by d theta_d / d r",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    GRADIENT_NAN_IN_THE_MIDDLE,
    LENS_HELD_CONSTANT,
];

/// Mistakes of its inverse.
pub(crate) const FISHEYE_UNDISTORT: &[Mistake] = &[
    OPENCV_LENS,
    Mistake::new(
        "angle_for_radius",
        "(theta / theta_d) (x', y'): without tan",
        "the picture stays a fisheye's, and straight lines bent",
        "tan theta / theta_d",
        "never by itself; directions by sin and cos of theta have no need of it",
        0,
    ),
    Mistake::new(
        "polynomial_not_inverted",
        "tan theta_d / theta_d: the bent angle for the angle",
        "right for an equidistant lens alone: edges are pixels off",
        "Newton's method for theta",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "distorted_again",
        "fisheye_distort of what is distorted already",
        "the bend is doubled, where it should vanish",
        "the inverse",
        "never; cheap to keep",
        0,
    ),
    EVERY_POWER,
    NAN_IN_THE_MIDDLE,
    Mistake::new(
        "handed_through",
        "the gradient of the point is that of what was found: g",
        "poses and pixels learn as if there were no lens",
        "both stretches, inverted",
        "iterations under no_grad",
        1,
    )
    .of_gradient(),
    GRADIENT_NAN_IN_THE_MIDDLE,
    LENS_HELD_CONSTANT,
];

/// theta_d with every power of theta, and its slope.
fn every_power(k: [f64; 4], theta: f64) -> (f64, f64) {
    let t = theta;
    let value = t * (1.0 + t * (k[0] + t * (k[1] + t * (k[2] + t * k[3]))));
    (value, 1.0 + t * (2.0 * k[0] + t * (3.0 * k[1] + t * (4.0 * k[2] + t * 5.0 * k[3]))))
}

/// The other model's lens of these coefficients.
fn opencv(k: [f64; 4]) -> Distortion {
    Distortion::from_opencv(&k)
}

/// Distorted points.
pub(crate) fn fisheye_distort(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let k = coefficients(a);
    let has = |name: &str| wrong.contains(&name);
    forward(a, "points", "distorted", |p| {
        let point = DVec2::from(p);
        let r = point.length();
        if r == 0.0 {
            return if has("not_a_number_in_the_middle") { [f64::NAN; 2] } else { p };
        }
        let theta = if has("radius_for_angle") { r } else { libm::atan(r) };
        match () {
            () if has("opencv_lens") => opencv(k).distort(point),
            () if has("undone_instead") => undistorted(k, p),
            () if has("every_power") => point * (every_power(k, theta).0 / r),
            () if has("not_divided_by_radius") => point * bent(k, theta),
            () if has("radius_for_angle") => point * (bent(k, theta) / r),
            () => distort(k, point),
        }
        .to_array()
    })
}

/// Their gradient.
pub(crate) fn fisheye_distort_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let k = coefficients(a);
    let f = |p: Pair, g: Pair| {
        let (point, g) = (DVec2::from(p), DVec2::from(g));
        let r = point.length();
        let (mut g_p, mut g_k) = backward::distort(k, point, g);
        match wrong.first() {
            Some(&"opencv_lens") => {
                let (on_p, on_k) = crate::lens::backward::distort(&opencv(k), point, g);
                (g_p, g_k) = (on_p, [on_k[0], on_k[1], on_k[2], on_k[3]]);
            }
            Some(&"radius_not_differentiated") if r > 0.0 => g_p = g * (bent(k, libm::atan(r)) / r),
            Some(&"gradient_not_a_number_in_the_middle") if r == 0.0 => g_p = DVec2::NAN,
            Some(&"lens_held_constant") => g_k = [0.0; 4],
            _ => {}
        }
        (g_p.to_array(), g_k)
    };
    vjp(a, "points", "distorted", f, in_order)
}

/// The angle with theta_d = theta (1 + k1 theta + ...).
fn every_power_undone(k: [f64; 4], theta_d: f64) -> f64 {
    (0..30).fold(theta_d, |theta, _| {
        let (value, slope) = every_power(k, theta);
        theta - (value - theta_d) / slope
    })
}

/// Ideal points.
pub(crate) fn fisheye_undistort(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let k = coefficients(a);
    let has = |name: &str| wrong.contains(&name);
    forward(a, "distorted", "points", |p| {
        let target = DVec2::from(p);
        let theta_d = target.length();
        if theta_d == 0.0 {
            return if has("not_a_number_in_the_middle") { [f64::NAN; 2] } else { p };
        }
        let right = undistorted(k, p);
        match () {
            () if has("opencv_lens") => opencv(k).undistort(target).unwrap_or(DVec2::NAN),
            () if has("angle_for_radius") => target * (libm::atan(right.length()) / theta_d),
            () if has("polynomial_not_inverted") => target * (libm::tan(theta_d) / theta_d),
            () if has("distorted_again") => distort(k, target),
            () if has("every_power") => target * (libm::tan(every_power_undone(k, theta_d)) / theta_d),
            () => right,
        }
        .to_array()
    })
}

/// Their gradient.
pub(crate) fn fisheye_undistort_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let k = coefficients(a);
    let f = |target: Pair, g: Pair| {
        let (mut h, mut g_k) = backward::undistort(k, undistorted(k, target), g.into());
        match wrong.first() {
            Some(&"handed_through") => h = g.into(),
            Some(&"gradient_not_a_number_in_the_middle") if target == [0.0; 2] => h = DVec2::NAN,
            Some(&"lens_held_constant") => g_k = [0.0; 4],
            _ => {}
        }
        (h.to_array(), g_k)
    };
    vjp(a, "distorted", "points", f, in_order)
}
