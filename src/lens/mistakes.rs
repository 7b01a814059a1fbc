//! Lenses, wrong on purpose. Without a mistake every function equals the oracle.

mod wrong_lens;

use super::Distortion;
use super::arrays::{Pair, forward, in_order, lens, undistorted, vjp};
use super::backward;
use crate::contract::arrays::{Arrays, values};
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use wrong_lens::WrongLens;

const TANGENTIAL_SWAPPED: Mistake = Mistake::new(
    "tangential_swapped",
    "p1 and p2 exchanged: x + p1 (r^2 + 2 x^2) + 2 p2 x y",
    "a shift of a pixel or two that no rotation of the camera undoes; it passes for noise of the poses",
    "p1 with x y in x', and with r^2 + 2 y^2 in y'",
    "never by itself; calibrations that call OpenCV's p1 another's p2 are many",
    0,
);
const TANGENTIAL_MISSING: Mistake = Mistake::new(
    "tangential_missing",
    "the radial factor alone",
    "pictures of lenses that sit askew are bent to one side",
    "add 2 p1 x y + p2 (r^2 + 2 x^2) and its twin",
    "never; cheap to keep",
    0,
);
const RADIUS_NOT_SQUARED: Mistake = Mistake::new(
    "radius_not_squared",
    "1 + k1 r + k2 r^2 + ...: r for r^2",
    "the middle of the picture is bent most; a kink at the middle itself",
    "powers of r^2 = x^2 + y^2",
    "never; cheap to keep",
    0,
);
const K3_THIRD: Mistake = Mistake::new(
    "k3_third",
    "coefficients read as k1, k2, k3, p1, p2",
    "a tangential coefficient bends radially, and k3 shifts: edges are pixels off",
    "k1, k2, p1, p2, k3 (OpenCV's order)",
    "camera files that list radial before tangential ones, handed on to OpenCV as they are",
    1,
);
const K4_IN_THE_NUMERATOR: Mistake = Mistake::new(
    "k4_in_the_numerator",
    "1 + k1 r^2 + k2 r^4 + k3 r^6 + k4 r^8: OpenCV's k4 as one more power",
    "what k4 flattens is bent further: most of the correction at the edge has the wrong sign",
    "k4, k5, k6 are the denominator's",
    "a camera model of nerfstudio and multinerf with a k4 of its own (seven copies of ten read), fed with OpenCV's",
    7,
);
const DENOMINATOR_DROPPED: Mistake = Mistake::new(
    "denominator_dropped",
    "k4, k5, k6 not read",
    "a rational lens is bent several times too far: its two halves nearly cancel",
    "divide by 1 + k4 r^2 + k5 r^4 + k6 r^6",
    "readers that take what they know of a file with eight coefficients",
    1,
);
const LENS_HELD_CONSTANT: Mistake = Mistake::new(
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

/// Mistakes of its inverse.
pub(crate) const LENS_UNDISTORT: &[Mistake] = &[
    Mistake::new(
        "five_steps",
        "x = (x' - tangential) / radial, five times from x' on",
        "off by a tenth of a pixel for a phone's lens; 1.387 for 1.250 with k = (-0.45, 0.25), and no better with more steps",
        "Newton's method, until the residual is down to rounding; and look at the residual",
        "OpenCV's undistortPoints without criteria; a structure-from-motion issue has 54 pixels",
        2,
    ),
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

/// A lens of these coefficients as wrong code reads it; `None` where the mistakes are others.
fn misread(a: &Arrays, wrong: &[&str]) -> Option<WrongLens> {
    let lens_alone = [
        TANGENTIAL_SWAPPED,
        TANGENTIAL_MISSING,
        RADIUS_NOT_SQUARED,
        K3_THIRD,
        K4_IN_THE_NUMERATOR,
        DENOMINATOR_DROPPED,
    ];
    let reads = lens_alone.iter().any(|mistake| wrong.contains(&mistake.name));
    reads.then(|| WrongLens::new(&values(a, "coefficients"), wrong))
}

/// Distorted points.
pub(crate) fn lens_distort(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (lens, misread) = (lens(a), misread(a, wrong));
    forward(a, "points", "distorted", |p| match &misread {
        _ if wrong.contains(&"undone_instead") => undistorted(&lens, p).to_array(),
        Some(lens) => lens.distort(p.into()).to_array(),
        None => lens.distort(p.into()).to_array(),
    })
}

/// Their gradient.
pub(crate) fn lens_distort_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (lens, misread) = (lens(a), misread(a, wrong));
    let f = |p: Pair, g: Pair| {
        let (mut g_p, mut g_k) = match &misread {
            Some(lens) => lens.backward(p.into(), g.into()),
            None => backward::distort(&lens, p.into(), g.into()),
        };
        if wrong.contains(&"radius_not_differentiated") {
            g_p = glam::DVec2::from(g) * lens.radial(p.into()).value;
        }
        if wrong.contains(&"lens_held_constant") {
            g_k = [0.0; 8];
        }
        (g_p.to_array(), g_k)
    };
    vjp(a, "points", "distorted", f, in_order)
}

/// x = (x' - tangential) / radial, so many times.
fn fixed_point(lens: &Distortion, target: Pair, steps: usize) -> Pair {
    let step = |p: Pair, _| {
        let radial = lens.radial(p.into()).value;
        let bent = lens.distort(p.into()).to_array();
        [0, 1].map(|j| (target[j] - (bent[j] - p[j] * radial)) / radial)
    };
    (0..steps).fold(target, step)
}

/// Ideal points.
pub(crate) fn lens_undistort(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (lens, misread) = (lens(a), misread(a, wrong));
    let has = |name: &str| wrong.contains(&name);
    let negative = Distortion::from_opencv(&values(a, "coefficients").iter().map(|k| -k).collect::<Vec<_>>());
    forward(a, "distorted", "points", |target| match &misread {
        _ if has("five_steps") => fixed_point(&lens, target, 5),
        _ if has("one_step") => fixed_point(&lens, target, 1),
        _ if has("distorted_again") => lens.distort(target.into()).to_array(),
        _ if has("signs_flipped") => negative.distort(target.into()).to_array(),
        Some(lens) => lens.undistort(target.into()).to_array(),
        None => undistorted(&lens, target).to_array(),
    })
}

/// Their gradient.
pub(crate) fn lens_undistort_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (lens, misread) = (lens(a), misread(a, wrong));
    let f = |target: Pair, g: Pair| {
        let p = undistorted(&lens, target);
        let (mut h, mut g_k) = match &misread {
            Some(lens) => lens.inverse_backward(lens.undistort(target.into()), g.into()),
            None => backward::undistort(&lens, p, g.into()),
        };
        match wrong.first() {
            Some(&"handed_through") => h = g.into(),
            Some(&"jacobian_not_inverted") => h = lens.jacobian(p) * glam::DVec2::from(g),
            Some(&"lens_held_constant") => g_k = [0.0; 8],
            _ => {}
        }
        (h.to_array(), g_k)
    };
    vjp(a, "distorted", "points", f, in_order)
}
