//! What is wrong with the rays of a whole picture alone, and what it does.

use crate::camera::mistakes::FOCAL_OF_ITS_OWN;
use crate::contract::component::Mistake;

/// Of single rays, too.
pub(super) const FLAT: Mistake = Mistake::new(
    "depth_left_out",
    "R (x, y, 0): the direction to a pixel without the plane's distance",
    "rays within the picture's plane, that never leave the camera forward",
    "R (x, y, 1)",
    "1 public implementation",
    1,
);

/// Of single rays, too.
pub(super) const POSE_IGNORED: Mistake = Mistake::new(
    "pose_ignored",
    "o = 0 and d = d_c: rays of the camera's own space",
    "all pictures are taken from one place",
    "R d_c, and the camera's position",
    "1 public implementation",
    1,
);

/// Of its numbers and its axes.
pub(super) const OF_PICTURES: &[Mistake] = &[
    FOCAL_OF_ITS_OWN,
    Mistake::new(
        "focal_floored",
        "int(focal)",
        "a field of view that is a little too wide",
        "the focal length as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "right_angles",
        "x and y from -1 to 1 over the picture: a view of 90 degrees across and down, whatever the focal length",
        "another lens, and views that are squeezed where the picture isn't square",
        "(u - cx) / fx, (v - cy) / fy",
        "2 renderers, in Fortran and Python",
        2,
    ),
    Mistake::new(
        "focal_rounded",
        "round(focal)",
        "a field of view that is a little off",
        "the focal length as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "center_halved",
        "half of the center, with the whole focal length: one of two that were to be rescaled",
        "a quarter of the picture, not its middle, in the middle of the view",
        "focal length and center in the same pixels",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "half_angle_forgotten",
        "W / 2 / tan(fov) for both focal lengths: the whole angle for half of it",
        "a focal length that is too short by more than half",
        "W / 2 / tan(fov / 2)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "angle_in_whole_degrees",
        "the field of view across rounded to degrees, and both focal lengths from it",
        "a focal length that is a little off",
        "the angle as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "rows_as_far_as_columns",
        "linspace(0, W - 1, H) for the rows: the width for the height",
        "a picture stretched in height",
        "linspace(0, H - 1, H)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "norm_down_the_columns",
        "directions divided by the norm over a column of the picture",
        "directions that shrink with the picture's height",
        "the norm over the last axis",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "pixels_in_the_unit_square",
        "i / W and j / H for pixels, with K in pixels",
        "all rays nearly alike",
        "pixels, or K over the picture's size",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "focal_of_half_the_width",
        "W / 2 for both focal lengths",
        "a field of view of 90 degrees, whatever it is",
        "the focal length of the camera",
        "1 public implementation",
        1,
    ),
];
