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
    "conjugated",
    "divided by its square",
    "not divided by its length",
    "divided by its length and 1e-8",
    "z, y, x for x, y, z",
];

/// The scales.
const SCALES: [&str; 9] =
    ["s", "sqrt(s)", "s^2", "exp(s)", "1 / s", "|s|", "the largest for all", "s, at least 1e-4", "2 s"];

/// The rotation's matrix.
const MATRIX: [&str; 6] = [
    "R",
    "R with + for - in front of w",
    "1 - 2 (y^2 + z^2), 1 - 2 (x^2 - z^2), 1 - 2 (x^2 - y^2) on its diagonal",
    "R with w^2 + x^2 - y^2 - z^2 and so on, not divided",
    "R without the factors of 2",
    "1",
];

/// The product, S the diagonal matrix of the scales.
const PRODUCT: [&str; 11] = [
    "R S S R^T",
    "R^T S S R",
    "R S R^T",
    "S R R^T S",
    "S S",
    "R S S R",
    "R S",
    "S R S R^T",
    "(R S)^T (R S)",
    "R S^-1 S^-1 R^T",
    "the diagonal of R S S R^T",
];

/// Those of a splat.
pub(crate) const OF_SPLATS: Laws = Laws {
    choices: &[QUATERNION.len(), SCALES.len(), MATRIX.len(), PRODUCT.len()],
    says: |part, choice| match part {
        0 => format!("q {}", QUATERNION[choice]),
        1 => format!("{} for the scales", SCALES[choice]),
        2 => format!("{} for R", MATRIX[choice]),
        _ => PRODUCT[choice].into(),
    },
    of: |a, c, law| forward(a, |q, s| of(q, s, form(c), law)),
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
        1 => return DMat3::from_cols_array_2d(&r),
        2 => (r[1][1], r[2][2]) = (1.0 - 2.0 * (x * x - z * z), 1.0 - 2.0 * (x * x - y * y)),
        3 => {
            r[0][0] = w * w + x * x - y * y - z * z;
            r[1][1] = w * w - x * x + y * y - z * z;
            r[2][2] = w * w - x * x - y * y + z * z;
        }
        4 => return 0.5 * (DMat3::from_cols_array_2d(&r).transpose() + DMat3::IDENTITY),
        5 => return DMat3::IDENTITY,
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
        1 => s.sqrt(),
        2 => s * s,
        3 => crate::math::exp(s),
        4 => 1.0 / s,
        5 => s.abs(),
        6 => most,
        7 => s.max(1e-4),
        8 => 2.0 * s,
        _ => s,
    });
    let r = turning(q, form, law);
    let (back, own) = (r.transpose(), DMat3::from_diagonal(DVec3::from(s)));
    let m = r * own;
    let whole = m * m.transpose();
    let product = match law[3] {
        0 => whole,
        1 => back * own * own * r,
        2 => m * back,
        3 => own * r * back * own,
        4 => own * own,
        5 => m * own * r,
        6 => m,
        7 => own * r * own * back,
        8 => m.transpose() * m,
        9 => r * own.inverse() * own.inverse() * back,
        _ => DMat3::from_diagonal(DVec3::new(whole.x_axis.x, whole.y_axis.y, whole.z_axis.z)),
    };
    product.transpose().to_cols_array_2d()
}
