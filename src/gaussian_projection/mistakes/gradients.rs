//! Gradients of projections that are written by hand, wrong on purpose.

use super::super::backward::{jacobian_gradient, of_covariance, of_jacobian, of_sigma};
use super::super::{Form, Splat, View, clamped, in_camera, project, transform};
use crate::contract::component::Mistake;
use crate::convention::{SplatClamp, SplatClampGradient};

/// Between a splat in the picture and its mean and covariance. T = J R.
pub(super) const OF_GRADIENTS: &[Mistake] = &[
    Mistake::new(
        "jacobian_held",
        "means learn from their place in the picture and their depth alone",
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
        "gradient_turned_on",
        "R g for R^T g as the gradient of the mean",
        "means drift in directions that depend on the camera",
        "the transpose of what turned the mean",
        "a trainer in WGSL",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "off_diagonal_twice",
        "what comes to the covariance's number b by its inverse, in both entries of a matrix",
        "slanted splats turn too fast",
        "half of it in each entry, or twice in none",
        "1 splat renderer in Slang",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "conic_off_diagonal_once",
        "half of the gradient of the conic's B: that of one entry for that of the number",
        "slanted splats turn too slowly",
        "one meaning in both kernels, where splats are drawn and where they are projected",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "conic_off_diagonal_twice",
        "twice the gradient of the conic's B",
        "slanted splats turn too fast",
        "one meaning in both kernels, where splats are drawn and where they are projected",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "one_factor_alone",
        "g_T = g T Sigma for (g + g^T) T Sigma: of the other T nothing comes back",
        "means learn half of what their splats' shapes tell",
        "both factors",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "depth_held_in_jacobian",
        "J's entries differentiated by t_x and t_y alone",
        "depths learn nothing from sizes",
        "J_00 = f / z depends on z alone",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "depth_held_in_place",
        "the mean's place in the picture differentiated by t_x and t_y alone",
        "depths learn nothing from places",
        "d(x / z) / dz = -x / z^2",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "place_held",
        "means learn from their depth and the shape of their splats alone",
        "splats hardly move",
        "the gradient of the mean in the picture, too",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "jacobian_turned_on",
        "R for R^T between T and J",
        "means learn other axes' gradients, but where the camera isn't turned",
        "g_J = g_T R^T",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// The gradients with what is wrong about them.
pub(super) fn hand_written(
    mean: [f64; 3],
    sigma: [f64; 6],
    view: &View,
    form: Form,
    g: &Splat,
    wrong: &[&str],
) -> ([f64; 3], [f64; 6]) {
    let has = |name: &str| wrong.contains(&name);
    let mut g = *g;
    if has("compensation_not_differentiated") {
        g.compensation = 0.0;
    }
    match () {
        () if has("conic_off_diagonal_once") => g.conic[1] *= 0.5,
        () if has("conic_off_diagonal_twice") => g.conic[1] *= 2.0,
        () => {}
    }
    let (t, r) = (in_camera(mean, view), view.rotation);
    let mut g_covariance = of_covariance(&project(mean, sigma, view, form), form, &g);
    if has("off_diagonal_twice") {
        let by_conic = Splat { mean: [0.0; 2], covariance: [0.0; 3], compensation: 0.0, ..g };
        g_covariance[1] += of_covariance(&project(mean, sigma, view, form), form, &by_conic)[1];
    }
    let of_shape =
        if has("jacobian_held") { [0.0; 3] } else { by_shape(t, sigma, g_covariance, view, form, wrong) };
    let of_place = by_place(t, view, &g, wrong);
    let g_t = [0, 1, 2].map(|k| of_shape[k] + of_place[k]);
    let g_mean = match () {
        () if has("gradient_not_turned_back") => g_t,
        () if has("gradient_turned_on") => [0, 1, 2].map(|i| (0..3).map(|k| r[i][k] * g_t[k]).sum()),
        () => [0, 1, 2].map(|k| r[0][k] * g_t[0] + r[1][k] * g_t[1] + r[2][k] * g_t[2]),
    };
    let mut g_sigma = of_sigma(transform(t, view, form), g_covariance);
    if has("off_diagonal_once") {
        [1, 2, 4].iter().for_each(|&n| g_sigma[n] /= 2.0);
    }
    (g_mean, g_sigma)
}

/// What comes to t by the splat's shape.
fn by_shape(
    t: [f64; 3],
    sigma: [f64; 6],
    g_covariance: [f64; 3],
    view: &View,
    form: Form,
    wrong: &[&str],
) -> [f64; 3] {
    let has = |name: &str| wrong.contains(&name);
    let (mut t, mut form) = (t, form);
    if has("clamp_not_differentiated") {
        // The clamped slope is taken for t_x / t_z itself: x is t_z times the limit, which moves with both. There nothing is clamped.
        let slopes = clamped(t, view, form);
        t = [slopes[0].0 * t[2], slopes[1].0 * t[2], t[2]];
        form = Form { clamp: SplatClamp::None, clamp_gradient: SplatClampGradient::Through, ..form };
    }
    let mut turned = *view;
    if has("jacobian_turned_on") {
        turned.rotation = [0, 1, 2].map(|i| [0, 1, 2].map(|k| view.rotation[k][i]));
    }
    let mut g_j = jacobian_gradient(transform(t, view, form), sigma, g_covariance, &turned);
    if has("one_factor_alone") {
        g_j = g_j.map(|row| row.map(|g| 0.5 * g));
    }
    let mut g_t = of_jacobian(t, g_j, view, form);
    if has("depth_held_in_jacobian") {
        g_t[2] = 0.0;
    }
    g_t
}

/// What comes to t by the splat's place in the picture and its depth.
fn by_place(t: [f64; 3], view: &View, g: &Splat, wrong: &[&str]) -> [f64; 3] {
    let has = |name: &str| wrong.contains(&name);
    if has("place_held") {
        return [0.0, 0.0, g.depth];
    }
    let slope = (view.k.fx * t[0] * g.mean[0] + view.k.fy * t[1] * g.mean[1]) / (t[2] * t[2]);
    let slope = if has("depth_held_in_place") { 0.0 } else { slope };
    [view.k.fx / t[2] * g.mean[0], view.k.fy / t[2] * g.mean[1], g.depth - slope]
}
