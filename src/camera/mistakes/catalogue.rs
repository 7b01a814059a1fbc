//! What is wrong with cameras, what it does, and where it was seen.

use crate::contract::component::Mistake;

const fn flipped(name: &'static str, cause: &'static str) -> Mistake {
    Mistake::new(
        name,
        cause,
        "the scene is mirrored or lies behind the camera; training on several views can't converge",
        "use the axes that the pose was written for (OpenCV: x right, y down, z forward)",
        "many (yenchenlin/nerf-pytorch#53, NeuRay#35)",
        3,
    )
}

pub(crate) const NO_HALF: Mistake = Mistake::new(
    "no_half_pixel",
    "the ray goes through (i, j), the pixel's corner, while cx = W / 2 counts from the picture's edge",
    "everything is shifted by half a pixel: 0.12 to 0.15 degrees on a picture of 100 pixels",
    "add 0.5 to column and row",
    "5 of 38 CS180 projects (2 of them at evaluation alone), 15 others",
    20,
);
pub(crate) const MINUS_HALF: Mistake = Mistake::new(
    "minus_half_pixel",
    "0.5 is subtracted where it should be added",
    "everything is shifted by a pixel in both directions",
    "add 0.5 to column and row",
    "1 CS180 project",
    1,
);
pub(crate) const ROW_COLUMN: Mistake = Mistake::new(
    "row_column_swapped",
    "row and column exchanged: uv is read as (row, column), or meshgrid was called with indexing=\"ij\"",
    "a transposed picture",
    "u is the column, v the row",
    "3 public implementations",
    3,
);
pub(crate) const CENTER_SWAPPED: Mistake = Mistake::new(
    "center_swapped",
    "cx = H / 2 and cy = W / 2: height and width exchanged in K",
    "nothing on a square picture; a shift on any other",
    "images.shape is (count, height, width, 3): cx = W / 2, cy = H / 2",
    "2 public implementations",
    2,
);
pub(crate) const CENTER_ONE_EARLY: Mistake = Mistake::new(
    "center_one_early",
    "fx, fy, cx, cy are read one place too early for the center: cx = fy and cy = cx",
    "the picture's middle far outside of it",
    "cx is the third number, cy the fourth",
    "svox2#55",
    1,
);
pub(crate) const CENTER_FLOORED: Mistake = Mistake::new(
    "center_floored",
    "cx = W // 2: integer division",
    "half a pixel of shift, on odd sizes alone",
    "divide by 2.0",
    "1 public implementation",
    1,
);
pub(crate) const FOCAL_IGNORED: Mistake = Mistake::new(
    "focal_ignored",
    "f = 1",
    "a field of view of nearly 180 degrees",
    "divide by the focal length in pixels",
    "1 public implementation",
    1,
);
pub(crate) const ONE_FOCAL_LENGTH: Mistake = Mistake::new(
    "one_focal_length",
    "fx for both axes",
    "nothing where pixels are square; stretched views where they aren't",
    "divide v - cy by fy",
    "robotics code and students, 3 public implementations",
    3,
);
pub(crate) const FOCALS_SWAPPED: Mistake = Mistake::new(
    "focals_swapped",
    "fx and fy exchanged, as where K is built from (height, width)",
    "nothing where pixels are square; stretched views where they aren't",
    "u belongs to fx, v to fy",
    "never; cheap to keep",
    0,
);
pub(crate) const SQUARE_PICTURE: Mistake = Mistake::new(
    "square_picture",
    "fx and cx for both axes: one focal length and one center, as of a square picture",
    "nothing on a square picture; shifted and stretched views on any other",
    "v belongs to fy and cy",
    "1 public implementation",
    1,
);
pub(crate) const INVERSE_POSE: Mistake = Mistake::new(
    "inverse_pose",
    "the inverse of c2w is used as it: world to camera taken for camera to world",
    "points land in the wrong place, and a round trip with the same mistake passes",
    "use c2w, not its inverse",
    "1 CS180 project, 2 public implementations",
    3,
);
pub(crate) const NOT_RESCALED: Mistake = Mistake::new(
    "intrinsics_not_rescaled",
    "the pictures were halved, K was not: it is twice the right one",
    "a quarter of the view, off center",
    "scale fx, fy, cx, cy with the picture",
    "1 public implementation",
    1,
);
pub(crate) const FOCAL_SCALED: Mistake = Mistake::new(
    "focal_scaled",
    "the focal length is k times the right one: written in for one data set, or for pictures of another size",
    "a view too narrow or too wide, which training can't mend",
    "the focal length in pixels of the picture in hand",
    "2 public implementations",
    2,
)
.with("k", 2.0, [1e-2, 100.0]);
pub(crate) const FOCAL_OF_ITS_OWN: Mistake = Mistake::new(
    "focal_of_its_own",
    "a focal length that is written in, whatever the camera's is",
    "right for one data set, too narrow or too wide a view for all others",
    "the focal length that is handed over",
    "1 public implementation: f = 1200",
    1,
)
.with("f", 500.0, [0.01, 1e5]);
pub(crate) const K_TRANSPOSED: Mistake = Mistake::new(
    "K_transposed",
    "K^T is inverted: row vectors multiplied as if they were columns",
    "directions without sense",
    "K^-1 (u, v, 1) for columns, (u, v, 1) K^-T for rows",
    "never; cheap to keep",
    0,
);
pub(crate) const K_FOR_INVERSE: Mistake = Mistake::new(
    "K_for_inverse",
    "K (u, v, 1) in the place of K^-1 (u, v, 1)",
    "all rays point nearly the same way",
    "invert K",
    "never; cheap to keep",
    0,
);
pub(crate) const FOCAL_MULTIPLIED: Mistake = Mistake::new(
    "focal_multiplied",
    "(u - cx) fx for (u - cx) / fx",
    "all points lie far to the side",
    "divide by the focal length",
    "never; cheap to keep",
    0,
);
pub(crate) const MEAN_FOCAL: Mistake = Mistake::new(
    "mean_focal_length",
    "(fx + fy) / 2 for both axes",
    "nothing where pixels are square; stretched views where they aren't",
    "u belongs to fx, v to fy",
    "never; cheap to keep",
    0,
);
pub(crate) const CENTER_UNDIVIDED: Mistake = Mistake::new(
    "center_taken_off_undivided",
    "u / fx - cx",
    "all points lie far to the side",
    "(u - cx) / fx",
    "never; cheap to keep",
    0,
);
pub(crate) const ROTATION_TRANSPOSED: Mistake = Mistake::new(
    "rotation_transposed",
    "R^T in the place of R (the rotation of the inverse pose, or a matrix written column by column)",
    "views turn the wrong way; right for the identity alone",
    "use the upper 3x3 of c2w as it is",
    "3 public implementations (chengzhag/UCPE#5)",
    3,
);
const ROTATION_INVERTED: Mistake = Mistake::new(
    "rotation_inverted",
    "R^-1 in the place of R, the translation as it is",
    "views turn the wrong way, and shrink where the pose has a scale",
    "use the upper 3x3 of c2w as it is",
    "1 public implementation",
    1,
);
pub(crate) const FLIPS: [Mistake; 6] = [
    flipped("flipped_x", "x points to the left, against the pose"),
    flipped("flipped_y", "y points up while z points forward, against the pose"),
    flipped("flipped_z", "z points backward while y points down, against the pose"),
    flipped("flipped_xy", "x to the left and y up: the picture is turned by 180 degrees"),
    flipped("flipped_xz", "x to the left and z backward, against the pose"),
    flipped("flipped_xyz", "all three axes point the other way"),
];

/// Mistakes of the transform.
pub(crate) const TRANSFORM: &[Mistake] = &[
    ROTATION_TRANSPOSED,
    ROTATION_INVERTED,
    INVERSE_POSE,
    Mistake::new(
        "moved_before_turned",
        "R (x_c + o)",
        "cameras stand elsewhere, where they are turned",
        "R x_c + o",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "taken_off_before_turned",
        "R (x_c - o)",
        "cameras stand on the other side of the world",
        "R x_c + o",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "place_of_an_inverse",
        "R x_c - R^T o: the translation of the inverse pose",
        "cameras at the right distance in the wrong places",
        "R x_c + o",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "inverted_by_transpose",
        "R^T (x_c - o): the inverse pose, where that of world to camera was meant",
        "points land in the wrong place, and a round trip with the same mistake passes",
        "use c2w as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "first_pose_for_all",
        "the first camera's pose for all points",
        "views of one camera, whatever was asked",
        "one pose for each point",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "divided_by_depth",
        "x_w / z_w: projected as if world space were a picture",
        "all points lie on a plane",
        "divide by the fourth coordinate, which is 1",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "translation_missing",
        "x_w = R x_c: a 0 was appended to the point in the place of a 1",
        "all cameras stand at the origin",
        "append 1 to points, 0 to directions",
        "never; cheap to keep",
        0,
    ),
    FLIPS[0],
    FLIPS[1],
    FLIPS[2],
    FLIPS[3],
    FLIPS[4],
    FLIPS[5],
];

/// Mistakes of the lens.
pub(crate) const PIXEL_TO_CAMERA: &[Mistake] = &[
    NO_HALF,
    MINUS_HALF,
    ROW_COLUMN,
    CENTER_SWAPPED,
    CENTER_ONE_EARLY,
    CENTER_FLOORED,
    FOCAL_IGNORED,
    ONE_FOCAL_LENGTH,
    FOCALS_SWAPPED,
    FOCAL_MULTIPLIED,
    MEAN_FOCAL,
    CENTER_UNDIVIDED,
    NOT_RESCALED,
    FOCAL_SCALED,
    K_TRANSPOSED,
    K_FOR_INVERSE,
    Mistake::new(
        "depth_alone_in_z",
        "((u - cx) / fx, (v - cy) / fy, s): x and y aren't multiplied by the depth",
        "all points lie on a square tube along the axis",
        "s K^-1 (u, v, 1)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "pixel_scaled_alone",
        "K^-1 (s u, s v, 1)",
        "points lie on the plane at depth 1, in wrong places",
        "s K^-1 (u, v, 1)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "distance_for_depth",
        "s along the ray: the direction is made unit before",
        "points off the axis are too near",
        "s K^-1 (u, v, 1), as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "coordinates_refolded",
        "an array of (3, M) folded to (M, 3): reshape for a transposition",
        "points are mixed from other points' coordinates",
        "stack along the last axis, or transpose",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "depths_along_coordinates",
        "points of shape (M, 3) times s of shape (M): coordinate j of each point times s_j",
        "an error but for three points, whose coordinates are stretched, and for one",
        "s[:, None]",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "depth_in_the_pixel",
        "K^-1 (u, v, s): the depth in the place of 1",
        "points that are stretched with their depth",
        "s K^-1 (u, v, 1)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "divided_by_its_depth",
        "(x / s, y / s, s)",
        "far points near the axis, near ones far off",
        "(s x, s y, s)",
        "never; cheap to keep",
        0,
    ),
    WHOLE_PIXELS,
    UPSIDE_DOWN_ONE_OFF,
    HALF_PIXEL_TWICE,
    PIXELS_AS_THEY_ARE,
    Mistake::new(
        "depth_forgotten",
        "x_c = K^-1 (u, v, 1), whatever the depth is",
        "every point lies at depth 1",
        "multiply by s",
        "never; cheap to keep",
        0,
    ),
    FLIPS[0],
    FLIPS[1],
    FLIPS[2],
    FLIPS[3],
    FLIPS[4],
    FLIPS[5],
    SQUARE_PICTURE,
];

pub(crate) const WHOLE_PIXELS: Mistake = Mistake::new(
    "whole_pixels",
    "uv is cut to whole pixels, and half a pixel added",
    "nothing where uv are middles of pixels; elsewhere rays that jump from pixel to pixel",
    "uv as they are",
    "never; cheap to keep",
    0,
);

pub(crate) const UPSIDE_DOWN_ONE_OFF: Mistake = Mistake::new(
    "flipped_by_whole_pixels",
    "2 cy - 1 - v for v: rows of whole pixels flipped, where v has its half pixel",
    "a picture upside down, and a pixel off",
    "leave v, or 2 cy - v",
    "never; cheap to keep",
    0,
);

pub(crate) const HALF_PIXEL_TWICE: Mistake = Mistake::new(
    "half_pixel_twice",
    "half a pixel is added to uv that have it already",
    "everything is shifted by half a pixel",
    "uv as they are",
    "never; cheap to keep",
    0,
);

pub(crate) const PIXELS_AS_THEY_ARE: Mistake = Mistake::new(
    "pixels_as_they_are",
    "(u, v, 1): neither center nor focal length",
    "rays that all look into one corner",
    "K^-1 (u, v, 1)",
    "an Instant-NGP port in PyTorch",
    1,
);
