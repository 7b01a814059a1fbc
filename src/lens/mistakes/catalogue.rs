//! What is wrong with lenses, what it does, and where it was seen.

use crate::contract::component::Mistake;

pub(super) const TANGENTIAL_SWAPPED: Mistake = Mistake::new(
    "tangential_swapped",
    "p1 and p2 exchanged: x + p1 (r^2 + 2 x^2) + 2 p2 x y",
    "a shift of a pixel or two that no rotation of the camera undoes; it passes for noise of the poses",
    "p1 with x y in x', and with r^2 + 2 y^2 in y'",
    "never by itself; calibrations that call OpenCV's p1 another's p2 are many",
    0,
);
pub(super) const TANGENTIAL_MISSING: Mistake = Mistake::new(
    "tangential_missing",
    "the radial factor alone",
    "pictures of lenses that sit askew are bent to one side",
    "add 2 p1 x y + p2 (r^2 + 2 x^2) and its twin",
    "never; cheap to keep",
    0,
);
pub(super) const RADIUS_NOT_SQUARED: Mistake = Mistake::new(
    "radius_not_squared",
    "1 + k1 r + k2 r^2 + ...: r for r^2",
    "the middle of the picture is bent most; a kink at the middle itself",
    "powers of r^2 = x^2 + y^2",
    "never; cheap to keep",
    0,
);
pub(super) const K3_THIRD: Mistake = Mistake::new(
    "k3_third",
    "coefficients read as k1, k2, k3, p1, p2",
    "a tangential coefficient bends radially, and k3 shifts: edges are pixels off",
    "k1, k2, p1, p2, k3 (OpenCV's order)",
    "camera files that list radial before tangential ones, handed on to OpenCV as they are",
    1,
);
pub(super) const K4_IN_THE_NUMERATOR: Mistake = Mistake::new(
    "k4_in_the_numerator",
    "1 + k1 r^2 + k2 r^4 + k3 r^6 + k4 r^8: OpenCV's k4 as one more power",
    "what k4 flattens is bent further: most of the correction at the edge has the wrong sign",
    "k4, k5, k6 are the denominator's",
    "a camera model of nerfstudio and multinerf with a k4 of its own (seven copies of ten read), fed with OpenCV's",
    7,
);
pub(super) const DENOMINATOR_DROPPED: Mistake = Mistake::new(
    "denominator_dropped",
    "k4, k5, k6 not read",
    "a rational lens is bent several times too far: its two halves nearly cancel",
    "divide by 1 + k4 r^2 + k5 r^4 + k6 r^6",
    "readers that take what they know of a file with eight coefficients",
    1,
);
pub(super) const K3_DROPPED: Mistake = Mistake::new(
    "k3_dropped",
    "k3 not read: k1, k2, p1, p2 alone",
    "edges are pixels off",
    "k3 is the fifth coefficient",
    "readers of four coefficients that take what they know",
    0,
);
pub(super) const TWO_RADIAL: Mistake = Mistake::new(
    "two_radial_coefficients",
    "1 + k1 r^2 + k2 r^4 alone: neither p1, p2 nor k3 to k6",
    "edges are pixels off, to one side where the lens sits askew",
    "all coefficients that there are",
    "1 public implementation",
    1,
);
pub(super) const EVERY_POWER: Mistake = Mistake::new(
    "every_power",
    "1 + k1 r^2 + k2 r^3 + k3 r^4",
    "the edge is bent wrongly",
    "powers of r^2: r^2, r^4, r^6",
    "never; cheap to keep",
    0,
);
pub(super) const ALL_IN_THE_NUMERATOR: Mistake = Mistake::new(
    "all_in_the_numerator",
    "k4, k5, k6 as three more powers of r^2",
    "what the denominator flattens is bent further",
    "k4, k5, k6 are the denominator's",
    "never; cheap to keep",
    0,
);
pub(super) const RADIUS_DOUBLED: Mistake = Mistake::new(
    "radius_doubled",
    "p2 (2 r^2 + x^2), p1 (2 r^2 + y^2)",
    "a shift of a pixel or two that no rotation of the camera undoes",
    "r^2 + 2 x^2, r^2 + 2 y^2",
    "never; cheap to keep",
    0,
);
pub(super) const COORDINATES_EXCHANGED: Mistake = Mistake::new(
    "coordinates_exchanged",
    "p2 (r^2 + 2 y^2) in x', p1 (r^2 + 2 x^2) in y'",
    "a shift of a pixel or two that no rotation of the camera undoes",
    "p2 (r^2 + 2 x^2) in x', p1 (r^2 + 2 y^2) in y'",
    "never; cheap to keep",
    0,
);
pub(super) const SWAPPED_IN_Y: Mistake = Mistake::new(
    "tangential_swapped_in_y",
    "p1 and p2 are exchanged in y', and are right in x'",
    "a shift of a pixel or two along y that no rotation of the camera undoes",
    "p1 (r^2 + 2 y^2) + 2 p2 x y in y'",
    "kalibr#698",
    1,
);
pub(super) const P1_TWICE: Mistake = Mistake::new(
    "p1_twice",
    "p1 for p2 in y': 2 p1 x y",
    "a shift of a pixel or two that no rotation of the camera undoes",
    "y' = ... + 2 p2 x y",
    "never; cheap to keep",
    0,
);
pub(super) const P2_TWICE: Mistake = Mistake::new(
    "p2_twice",
    "p2 for p1 in x': 2 p2 x y",
    "a shift of a pixel or two that no rotation of the camera undoes",
    "x' = ... + 2 p1 x y",
    "never; cheap to keep",
    0,
);
pub(super) const K5_TWICE: Mistake = Mistake::new(
    "k5_twice",
    "k5 for k6: 1 + k4 r^2 + k5 r^4 + k5 r^6 below",
    "edges are off where the lens is strong",
    "k6 is the last coefficient",
    "1 public implementation",
    1,
);
pub(super) const TANGENTIAL_NEGATED: Mistake = Mistake::new(
    "tangential_negated",
    "the tangential terms taken off",
    "pictures of lenses that sit askew are bent to the other side",
    "add them",
    "never; cheap to keep",
    0,
);
pub(super) const TANGENTIAL_STRETCHED: Mistake = Mistake::new(
    "tangential_stretched",
    "(x + tangential) radial",
    "right for weak lenses: edges are off by the product of both",
    "x radial + tangential",
    "never; cheap to keep",
    0,
);
pub(super) const TANGENTIAL_OF_BENT_POINT: Mistake = Mistake::new(
    "tangential_of_bent_point",
    "the tangential terms of what the radial factor has bent already",
    "right for weak lenses: edges are off by the product of both",
    "both of the ideal point",
    "never; cheap to keep",
    0,
);
pub(super) const X_OVERWRITTEN: Mistake = Mistake::new(
    "x_overwritten",
    "y' by the x' that was just computed",
    "right for weak lenses: y' is off by the product of both",
    "keep x until y' is computed",
    "never; cheap to keep",
    0,
);
pub(super) const LENS_HELD_CONSTANT: Mistake = Mistake::new(
    "lens_held_constant",
    "no gradient for the coefficients",
    "a calibration that is to be refined stays as it is",
    "g_k1 = r^2 (x g_x + y g_y), ...; of an inverse by way of J^-1",
    "kernels without a backward pass (nerfacc's, instant-ngp's but for its grid of shifts)",
    2,
)
.of_gradient();

/// Mistakes of the lens.
pub(crate) const LENS_DISTORT: &[Mistake] = &[
    TANGENTIAL_SWAPPED,
    TANGENTIAL_MISSING,
    RADIUS_NOT_SQUARED,
    K3_THIRD,
    K4_IN_THE_NUMERATOR,
    DENOMINATOR_DROPPED,
    K3_DROPPED,
    TWO_RADIAL,
    EVERY_POWER,
    ALL_IN_THE_NUMERATOR,
    RADIUS_DOUBLED,
    COORDINATES_EXCHANGED,
    SWAPPED_IN_Y,
    P1_TWICE,
    P2_TWICE,
    K5_TWICE,
    TANGENTIAL_NEGATED,
    TANGENTIAL_STRETCHED,
    TANGENTIAL_OF_BENT_POINT,
    X_OVERWRITTEN,
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
        "the gradient g radial: r^2 held constant, tangential terms left off",
        "poses learn less along the radius than across it",
        "J = radial + 2 slope p p^T + the tangential terms' slopes",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    LENS_HELD_CONSTANT,
];

pub(super) const FEW_STEPS: Mistake = Mistake::new("few_steps","x = (x' - tangential) / radial, so many times from x' on","after five steps off by a tenth of a pixel for a phone's lens; 1.387 for 1.250 with k = (-0.45, 0.25), and no better with more steps","Newton's method, until the residual is down to rounding; and look at the residual","OpenCV's undistortPoints without criteria: five; a structure-from-motion issue has 54 pixels",2)
.with("steps", 5.0, [2.0, 200.0]);
pub(super) const FEW_STEPS_OF_DIFFERENCES: Mistake = Mistake::new(
    "few_steps_of_differences",
    "x += x' - distort(x), so many times from x' on",
    "edges are off where the lens is strong, and run away where it bends by more than twice",
    "Newton's method, until the residual is down to rounding; and look at the residual",
    "a camera course: ten",
    1,
)
.with("steps", 10.0, [1.0, 200.0]);
pub(super) const FEW_STEPS_OF_NEWTON: Mistake = Mistake::new(
    "few_steps_of_newton",
    "Newton's method, so many steps of it from x' on",
    "edges are off where the lens is strong",
    "until the residual is down to rounding",
    "never; cheap to keep",
    0,
)
.with("steps", 1.0, [1.0, 6.0]);

/// Mistakes of its inverse.
pub(crate) const LENS_UNDISTORT: &[Mistake] = &[
    FEW_STEPS,
    FEW_STEPS_OF_DIFFERENCES,
    FEW_STEPS_OF_NEWTON,
    Mistake::new(
        "one_step",
        "(x' - tangential) / radial at the distorted point: one step",
        "the correction is right to first order alone",
        "solve for the point: Newton's method",
        "never by itself; a start taken for the end",
        0,
    ),
    Mistake::new(
        "distorted_again",
        "lens_distort of what is distorted already",
        "the bend is doubled, where it should vanish",
        "the inverse, which has no formula",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "signs_flipped",
        "lens_distort with -k for k",
        "right to first order alone: the edge is off by the square of the correction",
        "solve for the point: Newton's method",
        "never; cheap to keep",
        0,
    ),
    TANGENTIAL_SWAPPED,
    TANGENTIAL_MISSING,
    RADIUS_NOT_SQUARED,
    K3_THIRD,
    K4_IN_THE_NUMERATOR,
    DENOMINATOR_DROPPED,
    K3_DROPPED,
    TWO_RADIAL,
    EVERY_POWER,
    ALL_IN_THE_NUMERATOR,
    RADIUS_DOUBLED,
    COORDINATES_EXCHANGED,
    SWAPPED_IN_Y,
    P1_TWICE,
    P2_TWICE,
    K5_TWICE,
    TANGENTIAL_NEGATED,
    TANGENTIAL_STRETCHED,
    TANGENTIAL_OF_BENT_POINT,
    X_OVERWRITTEN,
    Mistake::new(
        "handed_through",
        "the gradient of the point is that of what was found: g",
        "poses and pixels learn as if there were no lens",
        "J^-1 g",
        "iterations under no_grad",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "jacobian_not_inverted",
        "J g",
        "too large where it should be too small",
        "J^-1 g",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    LENS_HELD_CONSTANT,
];
