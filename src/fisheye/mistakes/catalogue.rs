//! What is wrong with fisheyes, what it does, and where it was seen.

use crate::contract::component::Mistake;

pub(super) const OPENCV_LENS: Mistake = Mistake::new(
    "opencv_lens",
    "k1, k2, k3, k4 taken for the k1, k2, p1, p2 of the other model",
    "edges are bent the wrong way, and to one side: nothing but the middle of the picture fits",
    "look at the camera's model: OPENCV_FISHEYE, is_fisheye",
    "readers that know one model and take four coefficients for its",
    1,
);
pub(super) const RADIUS_FOR_ANGLE: Mistake = Mistake::new(
    "radius_for_angle",
    "the polynomial of r = tan theta: without atan",
    "what is far off the axis lands outside of the picture",
    "theta = atan r",
    "never by itself; a pinhole's radius handed to the fisheye's polynomial",
    0,
);
pub(super) const EVERY_POWER: Mistake = Mistake::new(
    "every_power",
    "theta (1 + k1 theta + k2 theta^2 + k3 theta^3 + k4 theta^4)",
    "the middle is bent as much as the edge",
    "even powers: theta^2, theta^4, ...",
    "never; cheap to keep",
    0,
);
pub(super) const LAST_TWO_DROPPED: Mistake = Mistake::new(
    "last_two_dropped",
    "k3 and k4 not read",
    "edges are pixels off",
    "theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)",
    "readers of two coefficients that take what they know",
    0,
);
pub(super) const EPS_IN_RADIUS: Mistake = Mistake::new(
    "eps_in_radius",
    "divided by the radius + eps",
    "the middle of the picture shrinks toward its center",
    "1 where the radius is 0, and nothing added elsewhere",
    "never; cheap to keep",
    0,
)
.with("eps", 1e-6, [1e-16, 1e-1]);
pub(super) const NAN_IN_THE_MIDDLE: Mistake = Mistake::new(
    "not_a_number_in_the_middle",
    "theta_d / r at r = 0, or tan theta / theta_d",
    "one pixel of a centered picture is NaN, and with it the batch that draws it",
    "1 where the radius is 0 (or below an eps)",
    "copies without OpenCV's test of r > 1e-8",
    1,
);
pub(super) const LENS_HELD_CONSTANT: Mistake = Mistake::new(
    "lens_held_constant",
    "no gradient for the coefficients",
    "a calibration that is to be refined stays as it is",
    "g_kn = theta^(2n+1) (u . g); of an inverse by way of its stretch",
    "kernels without a backward pass (nerfacc's)",
    1,
)
.of_gradient();
pub(super) const GRADIENT_NAN_IN_THE_MIDDLE: Mistake = Mistake::new(
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
    LAST_TWO_DROPPED,
    EPS_IN_RADIUS,
    Mistake::new(
        "scaled_by_polynomial",
        "(1 + k1 theta^2 + ...) (x, y), or theta_d / theta for theta_d / r",
        "the picture stays a pinhole's: what is far off the axis lands outside of it",
        "theta_d / r",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "polynomial_of_radius",
        "theta (1 + k1 r^2 + ...): the radius in the polynomial, the angle in front of it",
        "edges are bent too far",
        "powers of theta = atan r",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "radius_not_rooted",
        "r = x^2 + y^2: theta = atan(r^2), and theta_d is divided by r^2",
        "what is far off the axis is squeezed toward the middle, which is NaN",
        "the root of x^2 + y^2",
        "a kernel of undistortions",
        1,
    ),
    Mistake::new(
        "quadrant_lost",
        "atan(y / x) for the direction: theta_d (cos phi, sin phi)",
        "the left half of the picture is drawn over the right one",
        "atan2(y, x), or (x, y) / r",
        "never; cheap to keep",
        0,
    ),
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

pub(super) const FEW_STEPS: Mistake = Mistake::new(
    "few_steps",
    "theta = theta_d / (1 + k1 theta^2 + ...), so many times from theta_d on",
    "edges are off where the lens is strong",
    "Newton's method, until the residual is down to rounding",
    "never; cheap to keep",
    0,
)
.with("steps", 5.0, [1.0, 200.0]);
pub(super) const FEW_STEPS_OF_NEWTON: Mistake = Mistake::new(
    "few_steps_of_newton",
    "Newton's method, so many steps of it from theta_d on",
    "edges are off where the lens is strong",
    "until the residual is down to rounding",
    "a lens of one coefficient in C++: two",
    1,
)
.with("steps", 1.0, [1.0, 6.0]);
pub(super) const FEW_STEPS_OF_DIFFERENCES: Mistake = Mistake::new(
    "few_steps_of_differences",
    "x += x' - distort(x), so many times from x' on",
    "edges are off, at wide angles without coefficients too, and run away where the slope is above 2",
    "Newton's method, until the residual is down to rounding",
    "1 public implementation: ten",
    1,
)
.with("steps", 10.0, [1.0, 200.0]);

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
        "angle_bent_again",
        "the polynomial of theta_d for the angle",
        "the bend is doubled, where it should vanish",
        "Newton's method for theta",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "divided_by_angle",
        "(tan theta / theta) (x', y')",
        "edges are pixels off, by the bend itself",
        "tan theta / theta_d",
        "never; cheap to keep",
        0,
    ),
    FEW_STEPS,
    FEW_STEPS_OF_NEWTON,
    FEW_STEPS_OF_DIFFERENCES,
    Mistake::new(
        "handed_back_without_coefficients",
        "the point as it came where all coefficients are 0",
        "without coefficients a fisheye is taken for a pinhole: the radius is the angle",
        "tan(theta) theta_d / r, as with any coefficients",
        "1 public implementation",
        1,
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
    LAST_TWO_DROPPED,
    EPS_IN_RADIUS,
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
