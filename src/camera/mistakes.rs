//! The camera, wrong on purpose. Every function takes the names of its mistakes; without any it equals the oracle.
//!
//! Two rows of the catalogue are not here because no case can show them: K read from the wrong array axes (cy = I / 2, with I the
//! number of images, which no row receives), and the sign pattern (+, -, -), which is the other value of the convention `axes`.

use glam::{DMat3, DMat4, DVec2, DVec3};

use super::arrays::{self, intrinsics, pose};
use super::{Intrinsics, transform as oracle};
use crate::contract::arrays::{Arrays, array, arrays, threes, twos, values};
use crate::contract::component::Mistake;
use crate::convention::Conventions;

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
pub(crate) const ROTATION_TRANSPOSED: Mistake = Mistake::new(
    "rotation_transposed",
    "R^T in the place of R (the rotation of the inverse pose, or a matrix written column by column)",
    "views turn the wrong way; right for the identity alone",
    "use the upper 3x3 of c2w as it is",
    "3 public implementations (chengzhag/UCPE#5)",
    3,
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
    INVERSE_POSE,
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
    CENTER_FLOORED,
    FOCAL_IGNORED,
    ONE_FOCAL_LENGTH,
    FOCALS_SWAPPED,
    NOT_RESCALED,
    FOCAL_SCALED,
    K_TRANSPOSED,
    K_FOR_INVERSE,
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

/// Flips axes.
pub(crate) fn flip(x: DVec3, wrong: &[&str]) -> DVec3 {
    let Some(axes) = wrong.iter().find_map(|name| name.strip_prefix("flipped_")) else { return x };
    let sign = |axis: char| if axes.contains(axis) { -1.0 } else { 1.0 };
    DVec3::new(sign('x') * x.x, sign('y') * x.y, sign('z') * x.z)
}

/// K as the mistakes have it.
fn wrong_lens(mut k: Intrinsics, wrong: &[&str]) -> Intrinsics {
    for name in wrong {
        match *name {
            "center_swapped" => (k.cx, k.cy) = (k.cy, k.cx),
            "center_floored" => (k.cx, k.cy) = (libm::floor(k.cx), libm::floor(k.cy)),
            "focal_ignored" => (k.fx, k.fy) = (1.0, 1.0),
            "one_focal_length" => k.fy = k.fx,
            "square_picture" => (k.fy, k.cy) = (k.fx, k.cx),
            "focals_swapped" => (k.fx, k.fy) = (k.fy, k.fx),
            "intrinsics_not_rescaled" => {
                k = Intrinsics { fx: 2.0 * k.fx, fy: 2.0 * k.fy, cx: 2.0 * k.cx, cy: 2.0 * k.cy }
            }
            _ => {}
        }
    }
    let scale = FOCAL_SCALED.among(wrong).unwrap_or(1.0);
    Intrinsics { fx: scale * k.fx, fy: scale * k.fy, ..k }
}

/// The pixel as the mistakes have it.
fn wrong_pixel(mut uv: DVec2, wrong: &[&str]) -> DVec2 {
    for name in wrong {
        match *name {
            "no_half_pixel" => uv -= 0.5,
            "minus_half_pixel" => uv -= 1.0,
            "row_column_swapped" => uv = DVec2::new(uv.y, uv.x),
            _ => {}
        }
    }
    uv
}

/// The point at depth s behind a pixel, as the mistakes have it; the axes are left alone.
pub(crate) fn wrong_point(k: &Intrinsics, uv: DVec2, s: f64, wrong: &[&str]) -> DVec3 {
    let (k, uv) = (wrong_lens(*k, wrong), wrong_pixel(uv, wrong));
    if wrong.contains(&"K_transposed") {
        let (x, y) = (uv.x / k.fx, uv.y / k.fy);
        return s * DVec3::new(x, y, 1.0 - k.cx * x - k.cy * y);
    }
    if wrong.contains(&"K_for_inverse") {
        return s * DVec3::new(k.fx * uv.x + k.cx, k.fy * uv.y + k.cy, 1.0);
    }
    super::pixel_to_camera(&k, uv, s)
}

/// The pose with R^T in the place of R.
pub(crate) fn with_transposed_rotation(c2w: &DMat4) -> DMat4 {
    let mut transposed = DMat4 { w_axis: glam::DVec4::W, ..*c2w }.transpose();
    transposed.w_axis = c2w.w_axis;
    transposed
}

/// The inverse of a pose, whatever its last row is.
pub(crate) fn inverse(c2w: &DMat4) -> DMat4 {
    let r = DMat3::from_mat4(*c2w).inverse();
    let mut out = DMat4::from_mat3(r);
    out.w_axis = (-(r * c2w.w_axis.truncate())).extend(1.0);
    out
}

/// Camera space to world space.
pub(crate) fn transform(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (c2w, x_c) = (values(a, "c2w"), threes(a, "x_c"));
    let point = |m: usize| {
        let mut c2w = pose(&c2w, m);
        for name in wrong {
            match *name {
                "rotation_transposed" => c2w = with_transposed_rotation(&c2w),
                "inverse_pose" => c2w = inverse(&c2w),
                "translation_missing" => c2w.w_axis = glam::DVec4::W,
                _ => {}
            }
        }
        oracle(&c2w, flip(DVec3::from(x_c[m]), wrong)).to_array()
    };
    arrays([("x_w", array(&[x_c.len(), 3], (0..x_c.len()).flat_map(point).collect()))])
}

/// Its gradient: no mistakes of its own.
pub(crate) fn transform_vjp(a: &Arrays, c: &Conventions, _: &[&str]) -> Arrays {
    arrays::transform_vjp(a, c)
}

/// Pixel and depth to camera space.
pub(crate) fn pixel_to_camera(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (k, uv, s) = (intrinsics(&values(a, "K")), twos(a, "uv"), values(a, "s"));
    let point = |m: usize| {
        let s = if wrong.contains(&"depth_forgotten") { 1.0 } else { s[m] };
        flip(wrong_point(&k, DVec2::from(uv[m]), s, wrong), wrong).to_array()
    };
    let points = arrays([("x_c", array(&[s.len(), 3], (0..s.len()).flat_map(point).collect()))]);
    arrays::in_axes(points, "x_c", c)
}

/// Its gradient: no mistakes of its own.
pub(crate) fn pixel_to_camera_vjp(a: &Arrays, c: &Conventions, _: &[&str]) -> Arrays {
    arrays::pixel_to_camera_vjp(a, c)
}
