//! Rays, wrong on purpose. Every function takes the names of its mistakes; without any it equals the oracle.
//!
//! In `image_rays` a grid of uv without the half pixel, and rays that agree with it, are the convention `pixel_center`; the mistake
//! `no_half_pixel` reports the center (or reports no uv) and shoots through the corner. Directions that are not normalized are the
//! convention `directions`; a norm that is taken over the wrong axis is a mistake.

use glam::{DMat3, DMat4, DVec2, DVec3};
use ndarray::Axis;

use super::arrays::{self, bundle, picture, positions};
use super::{Ray, camera_direction, pixel_position};
use crate::camera::arrays::{intrinsics, pose};
use crate::camera::mistakes::{self, FLIPS, flip, inverse, with_transposed_rotation, wrong_point};
use crate::camera::{Intrinsics, rotate};
use crate::contract::arrays::{Arrays, array, twos, values};
use crate::contract::component::Mistake;
use crate::convention::{Axes, Conventions, Directions};

const ORIGIN_MINUS_RT: Mistake = Mistake::new(
    "origin_minus_rt",
    "o = -R^T t, with R and t of c2w: the formula for a world-to-camera matrix",
    "cameras at the right distance in the wrong places",
    "o is the translation of c2w",
    "1 public implementation",
    1,
);
const ORIGIN_MINUS_INVERSE_RT: Mistake = Mistake::new(
    "origin_minus_inverse_rt",
    "o = -R^-1 t, with R and t of c2w: the formula for a world-to-camera matrix",
    "cameras at the right distance in the wrong places",
    "o is the translation of c2w",
    "CS180 students, 3 public implementations",
    3,
);
const TRANSLATION_IN_DIRECTION: Mistake = Mistake::new(
    "translation_in_direction",
    "d = R d_c + t: a 1 was appended to the direction, or x_w was taken without subtracting o (beside a wrong o: less that)",
    "directions change when the camera is moved",
    "rotate directions, translate points",
    "CUT3R#90",
    1,
);
const ORIGIN_NORMALISED: Mistake = Mistake::new(
    "origin_normalized",
    "o / |o|: the origin was normalized along with the direction",
    "all cameras on the unit sphere",
    "normalize the direction alone",
    "never; cheap to keep",
    0,
);

const NORM_OF_ALL: Mistake = Mistake::new(
    "norm_of_all_rays",
    "d / norm(d) without an axis: the norm of all rays together",
    "directions far too short, and shorter the larger the batch is",
    "norm(d, axis=-1, keepdims=True)",
    "1 public implementation",
    1,
);

/// Mistakes of the ray through a pixel.
pub(crate) const PIXEL_TO_RAY: &[Mistake] = &[
    mistakes::NO_HALF,
    mistakes::MINUS_HALF,
    mistakes::ROW_COLUMN,
    mistakes::CENTER_SWAPPED,
    mistakes::CENTER_FLOORED,
    mistakes::FOCAL_IGNORED,
    mistakes::ONE_FOCAL_LENGTH,
    mistakes::FOCALS_SWAPPED,
    mistakes::NOT_RESCALED,
    mistakes::FOCAL_SCALED,
    mistakes::K_TRANSPOSED,
    mistakes::K_FOR_INVERSE,
    mistakes::ROTATION_TRANSPOSED,
    mistakes::INVERSE_POSE,
    ORIGIN_MINUS_RT,
    ORIGIN_MINUS_INVERSE_RT,
    TRANSLATION_IN_DIRECTION,
    ORIGIN_NORMALISED,
    NORM_OF_ALL,
    Mistake::new(
        "norm_without_axis",
        "d / norm(d, axis=1) without keepdims: (M, 3) / (M,)",
        "an error for most M; at M = 3 column j is divided by the norm of ray j",
        "keepdims=True",
        "1 public implementation",
        1,
    ),
    FLIPS[0],
    FLIPS[1],
    FLIPS[2],
    FLIPS[3],
    FLIPS[4],
    FLIPS[5],
    Mistake::new(
        "norm_detached",
        "the norm is taken for a constant: g_r = g_d / |r|",
        "gradients of camera poses that lengthen rays in the place of turning them",
        "differentiate the norm too: g_r = (g_d - d (d . g_d)) / |r|",
        "1 public implementation, where the norm is taken under no_grad",
        1,
    )
    .of_gradient(),
    mistakes::SQUARE_PICTURE,
];

/// Mistakes of the rays of a picture.
pub(crate) const IMAGE_RAYS: &[Mistake] = &[
    mistakes::NO_HALF,
    mistakes::MINUS_HALF,
    mistakes::ROW_COLUMN,
    mistakes::CENTER_SWAPPED,
    mistakes::CENTER_FLOORED,
    mistakes::FOCAL_IGNORED,
    mistakes::NOT_RESCALED,
    mistakes::FOCAL_SCALED,
    mistakes::K_TRANSPOSED,
    mistakes::K_FOR_INVERSE,
    mistakes::ROTATION_TRANSPOSED,
    mistakes::INVERSE_POSE,
    ORIGIN_MINUS_RT,
    ORIGIN_MINUS_INVERSE_RT,
    TRANSLATION_IN_DIRECTION,
    ORIGIN_NORMALISED,
    NORM_OF_ALL,
    Mistake::new(
        "pixels_to_the_edges",
        "u = i W / (W - 1), v = j H / (H - 1): linspace(0, W, W), from edge to edge",
        "pixels are spread too far: right in the middle, half a pixel off at the edges",
        "arange(W) + 0.5",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "picture_refolded",
        "pixels are listed column by column, and folded row by row to (H, W)",
        "the picture is torn to stripes where it isn't square, transposed where it is",
        "meshgrid(..., indexing=\"xy\"), flattened and folded in one order",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "half_pixel_upward",
        "0.5 is added behind the sign of y: u + 0.5 and v - 0.5",
        "everything is shifted by a pixel in the vertical",
        "add 0.5 to column and row before the center is taken off",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "grid_size_swapped",
        "columns run over the height and rows over the width, and the grid is read as (H, W)",
        "nothing on a square picture; pixels in other places on any other",
        "meshgrid(arange(W), arange(H), indexing=\"xy\")",
        "1 CS180 project",
        1,
    ),
    Mistake::new(
        "one_angle_for_both_axes",
        "y runs over [-1, 1] as x does, and both are multiplied by tan(fov / 2): fy = f H / W",
        "nothing on a square picture; squeezed views on any other",
        "the angle of the height is another one: divide y by the width too, or by f",
        "a ray marcher in numpy; shaders that forget the picture's aspect",
        2,
    ),
    Mistake::new(
        "picture_transposed",
        "the grid's first axis is the column: rays are (W, H), or listed column by column",
        "a transposed picture, or one that is torn where it is folded again",
        "meshgrid(..., indexing=\"xy\"), or transpose the grid",
        "torch's meshgrid without indexing: 4 public implementations",
        4,
    ),
    FLIPS[0],
    FLIPS[1],
    FLIPS[2],
    FLIPS[3],
    FLIPS[4],
    FLIPS[5],
];

/// One ray as the mistakes have it, not yet divided by its norm.
fn wrong_ray(k: &Intrinsics, c2w: &DMat4, uv: DVec2, c: &Conventions, wrong: &[&str]) -> Ray {
    let c2w = &if wrong.contains(&"inverse_pose") { inverse(c2w) } else { *c2w };
    let turned = if wrong.contains(&"rotation_transposed") { with_transposed_rotation(c2w) } else { *c2w };
    let camera = match c.axes {
        Axes::Opencv => wrong_point(k, uv, 1.0, wrong),
        Axes::Opengl if wrong.is_empty() => camera_direction(k, uv, c.axes),
        Axes::Opengl => wrong_point(k, uv, 1.0, wrong) * DVec3::new(1.0, -1.0, -1.0),
    };
    let camera = if c.directions == Directions::UnitInCamera { camera / camera.length() } else { camera };
    let o = c2w.w_axis.truncate();
    let mut ray = Ray { o, d: rotate(&turned, flip(camera, wrong)) };
    for name in wrong {
        match *name {
            "origin_minus_rt" => ray.o = -rotate(&with_transposed_rotation(c2w), ray.o),
            "origin_normalized" => ray.o /= ray.o.length(),
            "origin_minus_inverse_rt" => ray.o = -(DMat3::from_mat4(*c2w).inverse() * ray.o),
            "translation_in_direction" if ray.o == o => ray.d += o,
            "translation_in_direction" => ray.d += o - ray.o,
            _ => {}
        }
    }
    ray
}

/// Directions divided by their norms, or by those of other rays.
fn normalize(rays: &mut [Ray], c: &Conventions, wrong: &[&str]) {
    if c.directions != Directions::Unit {
        return;
    }
    let norms: Vec<f64> = rays.iter().map(|ray| ray.d.length()).collect();
    let mixed = wrong.contains(&"norm_without_axis") && rays.len() == 3;
    let all = norms.iter().map(|norm| norm * norm).sum::<f64>().sqrt();
    for (ray, &norm) in rays.iter_mut().zip(&norms) {
        let norm = if wrong.contains(&"norm_of_all_rays") { all } else { norm };
        ray.d = if mixed { ray.d / DVec3::new(norms[0], norms[1], norms[2]) } else { ray.d / norm };
    }
}

/// Pixel to ray.
pub(crate) fn pixel_to_ray(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (k, c2w) = (intrinsics(&values(a, "K")), values(a, "c2w"));
    let ray = |(m, uv): (usize, [f64; 2])| wrong_ray(&k, &pose(&c2w, m), DVec2::from(uv), c, wrong);
    let mut rays: Vec<Ray> = twos(a, "uv").into_iter().enumerate().map(ray).collect();
    normalize(&mut rays, c, wrong);
    bundle(&rays, &[rays.len(), 3])
}

/// Its gradient.
pub(crate) fn pixel_to_ray_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if !wrong.contains(&"norm_detached") || c.directions != Directions::Unit {
        return arrays::pixel_to_ray_vjp(a, c);
    }
    // As undivided directions have it, each cotangent over its ray's length.
    let (k, c2w) = (intrinsics(&values(a, "K")), values(a, "c2w"));
    let mut a = a.clone();
    for (m, uv) in twos(&a, "uv").into_iter().enumerate() {
        let length = wrong_ray(&k, &pose(&c2w, m), DVec2::from(uv), c, &[]).d.length();
        let g = a.get_mut("grad_rays_d").expect("a cotangent");
        g.index_axis_mut(Axis(0), m).mapv_inplace(|g| g / length);
    }
    arrays::pixel_to_ray_vjp(&a, &Conventions { directions: Directions::Depth, ..*c })
}

/// The rays of a picture. A grid whose rows and columns are exchanged shows it in uv.
pub(crate) fn image_rays(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (height, width, mut k, c2w) = picture(a);
    if wrong.contains(&"one_angle_for_both_axes") {
        k.fy *= height as f64 / width as f64;
    }
    let mut uv = positions(a, c);
    let (mut rows, mut columns) = (height, width);
    if wrong.contains(&"grid_size_swapped") {
        uv = (0..height * width).map(|n| pixel_position(n % height, n / height, c.pixel_center)).collect();
    }
    for (n, uv) in uv.iter_mut().enumerate() {
        let (column, row) = ((n % width) as f64, (n / width) as f64);
        if wrong.contains(&"pixels_to_the_edges") && width > 1 && height > 1 {
            let steps = DVec2::new(width as f64 / (width - 1) as f64, height as f64 / (height - 1) as f64);
            *uv = DVec2::new(column, row) * steps;
        }
        if wrong.contains(&"half_pixel_upward") {
            *uv = DVec2::new(column + 0.5, row - 0.5);
        }
    }
    if wrong.contains(&"picture_refolded") {
        uv = (0..height * width).map(|n| uv[n % height * width + n / height]).collect();
    }
    if wrong.contains(&"picture_transposed") {
        uv = (0..height * width).map(|n| uv[n % height * width + n / height]).collect();
        (rows, columns) = (width, height);
    }
    let mut rays: Vec<Ray> = uv.iter().map(|&uv| wrong_ray(&k, &c2w, uv, c, wrong)).collect();
    normalize(&mut rays, c, wrong);
    let mut out = bundle(&rays, &[rows, columns, 3]);
    let swapped = wrong.contains(&"row_column_swapped");
    let said = uv.iter().flat_map(|uv| if swapped { [uv.y, uv.x] } else { uv.to_array() });
    out.insert("uv".into(), array(&[rows, columns, 2], said.collect()));
    out
}
