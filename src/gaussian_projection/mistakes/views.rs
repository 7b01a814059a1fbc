//! What is wrong with axes and limits of a view, and what it does.

use crate::contract::component::Mistake;

/// Of axes that are mixed up.
pub(super) const OF_VIEWS: &[Mistake] = &[
    Mistake::new(
        "covariance_by_columns",
        "the six numbers read as xx, xy, yy, xz, yz, zz",
        "splats that point elsewhere",
        "xx, xy, xz, yy, yz, zz: the upper triangle row by row",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "pose_inverted",
        "camera to world for world to camera",
        "splats as another camera would see them",
        "x_c = R x + t of the view's own matrix",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "center_swapped",
        "c_y with x, c_x with y",
        "splats beside their places, wherever the center isn't on the diagonal",
        "x with c_x",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "one_focal_in_the_mean",
        "f_x for both in the mean",
        "splats too high or too low, where focal lengths differ",
        "f_y with y",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "y_not_clamped",
        "only x / z is held within the view's limits",
        "needles above and below the picture",
        "both",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "limits_of_x_for_both",
        "the limits of x for y, too",
        "splats too thin or too thick beyond the picture's shorter side",
        "each axis' own field of view",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "slopes_exchanged",
        "y / z in the first row of the Jacobian, x / z in the second",
        "splats sheared the wrong way",
        "x with x",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "dilated_across_alone",
        "0.3 is added to the first entry alone",
        "thin splats vanish between pixels",
        "both of the diagonal",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "radius_of_a_rounded_deviation",
        "3 ceil(sqrt lambda)",
        "radii that are up to two pixels too large",
        "ceil(3 sqrt lambda)",
        "2 public implementations",
        2,
    ),
];
