//! The projection, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{form, forward, view, vjp};
use super::{Form, Splat, View, backward, clamped, in_camera, project, quadratic};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::{Conventions, SplatCenter, SplatClamp, SplatClampGradient};

/// Mistakes of the projection.
pub(crate) const GAUSSIAN_PROJECTION: &[Mistake] = &[
    Mistake::new(
        "not_dilated",
        "J R Sigma R^T J^T as it is",
        "splats below a pixel fall between pixels and flicker; lines have no inverse",
        "add 0.3 to both variances",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "every_entry_dilated",
        "0.3 added to the whole matrix, covariance too",
        "small splats are stretched along the diagonal",
        "0.3 times the identity",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "not_turned",
        "J Sigma J^T: the covariance is still in the world's axes",
        "splats keep their shape on the screen as the camera turns",
        "J R Sigma R^T J^T",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "turned_back",
        "J R^T: the rotation of c2w, or that of a view matrix stored by columns",
        "splats turn against the camera",
        "J R with R from the world to the camera, in rows",
        "ports of the rasterizer of 3D Gaussian splatting, which is handed transposed matrices",
        1,
    ),
    Mistake::new(
        "jacobian_signs",
        "+ f x/z^2 in the Jacobian's last column",
        "splats off the middle lean the wrong way",
        "- f x/z^2: what is farther is nearer to the middle",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "jacobian_not_squared",
        "- f x/z in the Jacobian's last column",
        "splats off the middle are drawn out with their depth",
        "- f x/z^2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "one_focal",
        "fx for both axes of the Jacobian",
        "splats are squeezed where pixels aren't square",
        "fy along y",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mean_clamped_too",
        "the clamped t projects the mean as well",
        "splats beside the picture gather along its edges",
        "clamp in the Jacobian alone",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "clamped_without_depth",
        "t_x = clamp(t_x/t_z) in the Jacobian, not multiplied by t_z again",
        "splats lean too little, the less the farther away",
        "t_x = t_z clamp(t_x/t_z)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "conic_sign",
        "(c, b, a) / det",
        "splats are mirrored",
        "-b: the inverse of a 2 x 2 matrix",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "conic_not_swapped",
        "(a, -b, c) / det",
        "splats that are wide are drawn tall",
        "(c, -b, a) / det",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "radius_of_variance",
        "3 lambda: the root is missing",
        "splats reach far too many tiles, the small ones too few",
        "3 sqrt(lambda)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "radius_of_the_short_axis",
        "the smaller eigenvalue",
        "long splats are cut off in tiles",
        "mid + sqrt(mid^2 - det)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "distance_for_depth",
        "|t| for t_z",
        "splats at the picture's edges are sorted behind those they hide",
        "the third coordinate in the camera's axes",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "compensation_squared",
        "det before / det after, without the root",
        "small splats fade twice as fast",
        "the root: light goes with the area, the root of the determinant",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "jacobian_held",
        "means learn from their place in the picture alone",
        "splats move without regard to how their size changes; depth is learned badly",
        "the Jacobian's entries depend on t as well",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "clamp_not_differentiated",
        "a clamped slope is differentiated as if it weren't",
        "splats beside the picture are pulled by what their leaning would do",
        "no gradient along x where x/z is clamped",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "off_diagonal_once",
        "gradients of xy, xz, yz as those of single entries of the matrix",
        "rotations learn at half of the speed of scales",
        "twice: the number stands in the matrix twice",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "gradient_not_turned_back",
        "the gradient of t as that of the mean",
        "means move along the camera's axes in place of the world's",
        "times R^T",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "compensation_not_differentiated",
        "the compensation is held constant",
        "splats don't learn that shrinking makes them fainter",
        "its gradient to the covariance, by both determinants",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "jacobian_without_focal",
        "1/z and -x/z^2 in the Jacobian, without fx and fy",
        "splats in the units of the image plane at depth 1, not in pixels: nothing but the dilation is left of them",
        "fx/z, -fx x/z^2, and fy below",
        "1 public implementation",
        1,
    ),
];

/// What is multiplied from the left with Sigma, in rows, and t as the Jacobian has it.
fn wrong_transform(t: [f64; 3], view: &View, form: Form, wrong: &[&str]) -> [[f64; 3]; 2] {
    let has = |name: &str| wrong.contains(&name);
    let focal = match () {
        () if has("jacobian_without_focal") => [1.0, 1.0],
        () if has("one_focal") => [view.k.fx, view.k.fx],
        () => [view.k.fx, view.k.fy],
    };
    let slopes = clamped(t, view, form);
    let r = |i: usize, k: usize| match () {
        () if has("not_turned") => f64::from(u8::from(i == k)),
        () if has("turned_back") => view.rotation[k][i],
        () => view.rotation[i][k],
    };
    let row = |n: usize| {
        let scale = focal[n] / t[2];
        let along = match () {
            () if has("jacobian_signs") => -scale * slopes[n].0,
            () if has("jacobian_not_squared") => focal[n] * slopes[n].0,
            () if has("clamped_without_depth") => scale * slopes[n].0 / t[2],
            () => scale * slopes[n].0,
        };
        [0, 1, 2].map(|k| scale * r(n, k) - along * r(2, k))
    };
    [row(0), row(1)]
}

/// A splat with what is wrong about it.
fn wrong_splat(mean: [f64; 3], sigma: [f64; 6], view: &View, form: Form, wrong: &[&str]) -> Splat {
    let has = |name: &str| wrong.contains(&name);
    let (t, right) = (in_camera(mean, view), project(mean, sigma, view, form));
    let [p, q] = wrong_transform(t, view, form, wrong);
    let before = [quadratic(p, sigma, p), quadratic(p, sigma, q), quadratic(q, sigma, q)];
    let h = if has("not_dilated") { 0.0 } else { form.dilation.value() };
    let [a, b, c] =
        [before[0] + h, before[1] + if has("every_entry_dilated") { h } else { 0.0 }, before[2] + h];
    let det = a * c - b * b;
    let ratio = ((before[0] * before[2] - before[1] * before[1]) / det).max(0.0);
    let apart = (0.25 * (a - c) * (a - c) + b * b).max(form.radius.value()).sqrt();
    let lambda = 0.5 * (a + c) + if has("radius_of_the_short_axis") { -apart } else { apart };
    let slopes = clamped(t, view, form);
    let shift = if form.center == SplatCenter::Integer { 0.5 } else { 0.0 };
    let place = |n: usize, f: f64, center: f64| f * slopes[n].0 + center - shift;
    Splat {
        mean: if has("mean_clamped_too") {
            [place(0, view.k.fx, view.k.cx), place(1, view.k.fy, view.k.cy)]
        } else {
            right.mean
        },
        covariance: [a, b, c],
        conic: match () {
            () if has("conic_sign") => [c / det, b / det, a / det],
            () if has("conic_not_swapped") => [a / det, -b / det, c / det],
            () => [c / det, -b / det, a / det],
        },
        depth: if has("distance_for_depth") {
            (t[0] * t[0] + t[1] * t[1] + t[2] * t[2]).sqrt()
        } else {
            right.depth
        },
        radius: (3.0 * if has("radius_of_variance") { lambda } else { lambda.max(0.0).sqrt() }).ceil(),
        compensation: if has("compensation_squared") { ratio } else { ratio.sqrt() }
            .max(form.compensation.value()),
    }
}

/// Projections.
pub(crate) fn projection(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (view, form) = (view(a), form(c));
    forward(a, |mean, sigma| match wrong {
        [] => project(mean, sigma, &view, form),
        wrong => wrong_splat(mean, sigma, &view, form, wrong),
    })
}

/// What comes to the mean by its place in the picture and its depth.
fn of_place(mean: [f64; 3], view: &View, form: Form, g: &Splat) -> [f64; 3] {
    let alone = Splat { covariance: [0.0; 3], conic: [0.0; 3], compensation: 0.0, ..*g };
    backward::project(mean, [0.0; 6], view, form, &alone).0
}

/// Their gradients.
pub(crate) fn projection_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (view, form) = (view(a), form(c));
    vjp(a, |mean, sigma, g| {
        let (mut g_mean, mut g_sigma) = backward::project(mean, sigma, &view, form, g);
        match wrong.first() {
            Some(&"jacobian_held") => g_mean = of_place(mean, &view, form, g),
            Some(&"clamp_not_differentiated") => g_mean = as_if_free(mean, sigma, &view, form, g),
            Some(&"off_diagonal_once") => [1, 2, 4].iter().for_each(|&n| g_sigma[n] /= 2.0),
            Some(&"gradient_not_turned_back") => {
                let t = in_camera(mean, &view);
                g_mean = backward::project(t, in_axes(sigma, &view), &straight(&view), form, g).0;
            }
            Some(&"compensation_not_differentiated") => {
                let without = Splat { compensation: 0.0, ..*g };
                return backward::project(mean, sigma, &view, form, &without);
            }
            _ => {}
        }
        (g_mean, g_sigma)
    })
}

/// A camera like this one, at the origin and not turned.
fn straight(view: &View) -> View {
    let rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    View { rotation, translation: [0.0; 3], ..*view }
}

/// R Sigma R^T.
fn in_axes(sigma: [f64; 6], view: &View) -> [f64; 6] {
    let r = view.rotation;
    [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| quadratic(r[i], sigma, r[j]))
}

/// The gradient of the mean where the clamped slope is taken for t_x/t_z itself: x is t_z times the limit, which moves with both.
fn as_if_free(mean: [f64; 3], sigma: [f64; 6], view: &View, form: Form, g: &Splat) -> [f64; 3] {
    let t = in_camera(mean, view);
    let slopes = clamped(t, view, form);
    let there = [slopes[0].0 * t[2], slopes[1].0 * t[2], t[2]];
    // Slopes are the limits: nothing is clamped.
    let r = view.rotation;
    let free = Form { clamp: SplatClamp::None, clamp_gradient: SplatClampGradient::Through, ..form };
    let of_shape = Splat { mean: [0.0; 2], depth: 0.0, ..*g };
    let g_t = backward::project(there, in_axes(sigma, view), &straight(view), free, &of_shape).0;
    let of_place = of_place(mean, view, form, g);
    [0, 1, 2].map(|k| of_place[k] + r[0][k] * g_t[0] + r[1][k] * g_t[1] + r[2][k] * g_t[2])
}
