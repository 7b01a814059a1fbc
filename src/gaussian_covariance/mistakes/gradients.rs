//! Gradients of the covariance that are written by hand, wrong on purpose.

use super::super::{Form, backward, deviations, rotation, unit};
use crate::contract::component::Mistake;
use crate::convention::{QuaternionLength, QuaternionOrder, SplatScale};

/// Between the covariance and its quaternion and scales. M = R diag(s).
pub(super) const OF_GRADIENTS: &[Mistake] = &[
    Mistake::new(
        "gradient_of_the_other_scale",
        "the gradient of s handed on as that of ln s, or the reverse",
        "the factor s is missing: steps of small splats are too large by 1 / s",
        "ln s learns s times the gradient of s",
        "fvdb-core#432, whose kernel takes logarithms",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "normalization_not_differentiated",
        "the gradient of q / |q| handed on as that of q",
        "a part along q, which turns nothing, makes quaternions longer or shorter at every step",
        "(g - (g . u) u) / |q|",
        "kernels that divide inside and differentiate as the original does, which takes quaternions as they are",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "one_factor_alone",
        "g M in place of (g + g^T) M: one of the two M is held constant",
        "half of the gradient",
        "M stands there twice",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "off_diagonal_twice",
        "the gradients of six numbers copied to both triangles as they are",
        "rotations learn twice as fast as scales",
        "half of an off-diagonal gradient to each triangle",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "factor_transposed",
        "g_M = (g + g^T) M^T",
        "splats turn and grow for what another matrix would need",
        "(g + g^T) M",
        "1 splat renderer",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "rotation_transposed_in_gradient",
        "R^T for R in all of the gradient: a line for matrices by columns (GLM) in rows",
        "splats turn the wrong way while they are fitted",
        "R as the forward pass has it",
        "1 port of 3D Gaussian splatting's backward pass to Warp",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "rotation_gradient_transposed",
        "the gradient of R's entry (j, i) for that of (i, j)",
        "every turn is undone: the real part's gradient has the other sign",
        "g_R as R is stored: by rows, or by columns (GLM)",
        "2 ports of 3D Gaussian splatting's backward pass, to Julia and Warp",
        2,
    )
    .of_gradient(),
    Mistake::new(
        "scales_by_rows",
        "g_s_i = sum_k g_M_ik R_ik and g_R_ik = g_M_ik s_i: scales along rows, where M = R diag(s) has them along columns",
        "every axis learns another one's size",
        "sum_i g_M_ik R_ik, g_M_ik s_k",
        "2 ports of 3D Gaussian splatting's backward pass, to Julia and Warp",
        2,
    )
    .of_gradient(),
    Mistake::new(
        "not_divided_by_length",
        "g_u - (g_u . u) u without / |q|",
        "quaternions that aren't of length 1 learn too fast or too slowly",
        "divided by |q|",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "radial_part_kept",
        "g_u / |q|: divided, but not projected",
        "lengths of quaternions learn what they can't change",
        "(g_u - (g_u . u) u) / |q|",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "cotangent_halved",
        "the cotangent's off-diagonal entries halved",
        "slanted splats learn too slowly",
        "both entries as they are; half of a number that stands for both",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "factor_scaled_by_rows",
        "g_M = (g + g^T) S R, where M = R S",
        "splats turn and grow for what another matrix would need",
        "(g + g^T) R S",
        "1 ray tracer of ellipsoids",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "product_in_other_order",
        "g_M = M (g + g^T)",
        "splats turn and grow for what another matrix would need",
        "(g + g^T) M",
        "2 kernels",
        2,
    )
    .of_gradient(),
    Mistake::new(
        "rotation_scaled_by_rows",
        "g_R_ik = g_M_ik s_i: scales along rows, where M = R diag(s) has them along columns",
        "splats turn about the wrong axis",
        "g_M_ik s_k",
        "1 voxelizer",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "rotation_unscaled",
        "g_R = g_M, without s",
        "small splats turn too fast",
        "g_R_ik = g_M_ik s_k",
        "1 ray tracer of ellipsoids",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "diagonal_of_rotation_alone",
        "the gradient of R's diagonal alone goes on to the quaternion",
        "splats hardly turn",
        "all nine entries",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// The gradients with what is wrong about them.
pub(super) fn hand_written(
    q: [f64; 4],
    scales: [f64; 3],
    g: [[f64; 3]; 3],
    form: Form,
    wrong: &[&str],
) -> ([f64; 4], [f64; 3]) {
    let has = |name: &str| wrong.contains(&name);
    let ((u, length), s) = (unit(q, form), deviations(scales, form));
    let r = if has("rotation_transposed_in_gradient") { transposed(rotation(u)) } else { rotation(u) };
    let given = square(|i, j| match () {
        () if i == j => g[i][i],
        () if has("off_diagonal_twice") => g[i][j] + g[j][i],
        () if has("cotangent_halved") => 0.5 * g[i][j],
        () => g[i][j],
    });
    let both = |i: usize, j: usize| given[i][j] + if has("one_factor_alone") { 0.0 } else { given[j][i] };
    let m = square(|i, k| match () {
        () if has("factor_transposed") => r[k][i] * s[i],
        () if has("factor_scaled_by_rows") => r[i][k] * s[i],
        () => r[i][k] * s[k],
    });
    let g_m = square(|i, k| match () {
        () if has("product_in_other_order") => (0..3).map(|j| m[i][j] * both(j, k)).sum(),
        () => (0..3).map(|j| both(i, j) * m[j][k]).sum(),
    });
    let by_rows = has("scales_by_rows");
    let g_s: [f64; 3] = std::array::from_fn(|k| {
        let of_deviation: f64 =
            (0..3).map(|i| if by_rows { g_m[k][i] * r[k][i] } else { g_m[i][k] * r[i][k] }).sum();
        let log = (form.scale == SplatScale::Log) != has("gradient_of_the_other_scale");
        if log { s[k] * of_deviation } else { of_deviation }
    });
    let mut g_r = square(|i, k| match () {
        () if has("rotation_unscaled") => g_m[i][k],
        () if by_rows || has("rotation_scaled_by_rows") => g_m[i][k] * s[i],
        () => g_m[i][k] * s[k],
    });
    if has("rotation_gradient_transposed") {
        g_r = transposed(g_r);
    }
    if has("diagonal_of_rotation_alone") {
        g_r = square(|i, k| if i == k { g_r[i][k] } else { 0.0 });
    }
    let mut g_u = backward::rotation_vjp(u, g_r);
    if form.length == QuaternionLength::Divided && !has("normalization_not_differentiated") {
        let radial: f64 = if has("radial_part_kept") { 0.0 } else { (0..4).map(|a| g_u[a] * u[a]).sum() };
        let length = if has("not_divided_by_length") { 1.0 } else { length };
        g_u = [0, 1, 2, 3].map(|a| (g_u[a] - radial * u[a]) / length);
    }
    if form.order == QuaternionOrder::RealLast {
        g_u.rotate_left(1);
    }
    (g_u, g_s)
}

fn square(entry: impl Fn(usize, usize) -> f64) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|k| entry(i, k)))
}

fn transposed(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    square(|i, k| m[k][i])
}
