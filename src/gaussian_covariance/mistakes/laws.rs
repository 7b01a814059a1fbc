//! Laws of a splat's covariance: what of the quaternion, what of the scales, and in which order they are multiplied.

use glam::{DMat3, DVec3};

use super::super::arrays::{form, forward};
use super::super::{Form, covariance as oracle, deviations, rotation, unit};
use crate::contract::laws::Laws;

/// The quaternion.
const QUATERNION: [&str; 8] = [
    "as it is",
    "x, y, z, w for w, x, y, z",
    "w, x, y, z for x, y, z, w",
    "conjugated, which makes R^T of R",
    "divided by its square",
    "not divided by its length",
    "divided by its length and 1e-8",
    "z, y, x for x, y, z",
];

/// The scales.
const SCALES: [&str; 8] =
    ["s", "s^2", "exp(s)", "1 / s", "|s|", "the largest for all", "s, at least 1e-4", "2 s"];

/// The rotation's matrix.
const MATRIX: [&str; 5] = [
    "R",
    "1 - 2 (y^2 + z^2), 1 - 2 (x^2 - z^2), 1 - 2 (x^2 - y^2) on its diagonal",
    "R with w^2 + x^2 - y^2 - z^2 and so on, not divided",
    "R without the factors of 2",
    "1",
];

/// The product, S the diagonal matrix of the scales.
const PRODUCT: [&str; 7] = [
    "R S S R^T",
    "R S R^T",
    "S S, which (R S)^T (R S) is, too",
    "R S S R",
    "R S",
    "S R S R^T",
    "the diagonal of R S S R^T",
];

/// Those of a splat.
pub(crate) const OF_SPLATS: Laws = Laws {
    choices: &[QUATERNION.len(), SCALES.len(), MATRIX.len(), PRODUCT.len()],
    says: |part, choice| match part {
        0 => format!("q {}", QUATERNION[choice]),
        1 => format!("{} in the place of the scales", SCALES[choice]),
        2 => format!("{} in the place of R", MATRIX[choice]),
        _ => format!("Sigma = {}", PRODUCT[choice]),
    },
    of: |a, c, law| forward(a, |q, s| of(q, s, form(c), law)),
    rounding: &[],
};

/// The matrix that stands for R.
fn turning(q: [f64; 4], form: Form, law: &[usize]) -> DMat3 {
    let [a, b, c, d] = q;
    let q = match law[0] {
        1 => [d, a, b, c],
        2 => [b, c, d, a],
        _ => q,
    };
    let ([w, x, y, z], length) = unit(q, form);
    let whole = |by: f64| [w, x, y, z].map(|x| x * by);
    let [w, x, y, z] = match law[0] {
        3 => [w, -x, -y, -z],
        4 => whole(1.0 / length),
        5 => whole(length),
        6 => whole(length / (length + 1e-8)),
        7 => [w, z, y, x],
        _ => [w, x, y, z],
    };
    let mut r = rotation([w, x, y, z]);
    match law[2] {
        1 => (r[1][1], r[2][2]) = (1.0 - 2.0 * (x * x - z * z), 1.0 - 2.0 * (x * x - y * y)),
        2 => {
            r[0][0] = w * w + x * x - y * y - z * z;
            r[1][1] = w * w - x * x + y * y - z * z;
            r[2][2] = w * w - x * x - y * y + z * z;
        }
        3 => return 0.5 * (DMat3::from_cols_array_2d(&r).transpose() + DMat3::IDENTITY),
        4 => return DMat3::IDENTITY,
        _ => {}
    }
    DMat3::from_cols_array_2d(&r).transpose()
}

fn of(q: [f64; 4], scales: [f64; 3], form: Form, law: &[usize]) -> [[f64; 3]; 3] {
    if law.iter().all(|choice| *choice == 0) {
        return oracle(q, scales, form);
    }
    let s = deviations(scales, form);
    let most = s.iter().copied().fold(f64::MIN, f64::max);
    let s = s.map(|s| match law[1] {
        1 => s * s,
        2 => crate::math::exp(s),
        3 => 1.0 / s,
        4 => s.abs(),
        5 => most,
        6 => s.max(1e-4),
        7 => 2.0 * s,
        _ => s,
    });
    let r = turning(q, form, law);
    let (back, own) = (r.transpose(), DMat3::from_diagonal(DVec3::from(s)));
    let m = r * own;
    let whole = m * m.transpose();
    let product = match law[3] {
        0 => whole,
        1 => m * back,
        2 => own * own,
        3 => m * own * r,
        4 => m,
        5 => own * m * back,
        _ => DMat3::from_diagonal(DVec3::new(whole.x_axis.x, whole.y_axis.y, whole.z_axis.z)),
    };
    product.transpose().to_cols_array_2d()
}
