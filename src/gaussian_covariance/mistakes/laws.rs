//! Laws of a splat's covariance: what of the quaternion, what of the scales, in which order they are multiplied, and signs of R.

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
const MATRIX: [&str; 4] =
    ["R", "R with w^2 + x^2 - y^2 - z^2 and so on, not divided", "R without the factors of 2", "1"];

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

/// The entries of R, row by row, each of which may have a wrong sign by itself: in its second term, in its first.
const ENTRIES: [[&str; 2]; 9] = [
    ["1 - 2 (y^2 - z^2)", "1 - 2 (z^2 - y^2)"],
    ["2 (x y + w z)", "2 (-x y - w z)"],
    ["2 (x z - w y)", "2 (-x z + w y)"],
    ["2 (x y - w z)", "2 (-x y + w z)"],
    ["1 - 2 (x^2 - z^2)", "1 - 2 (z^2 - x^2)"],
    ["2 (y z + w x)", "2 (-y z - w x)"],
    ["2 (x z + w y)", "2 (-x z - w y)"],
    ["2 (y z - w x)", "2 (-y z + w x)"],
    ["1 - 2 (x^2 - y^2)", "1 - 2 (y^2 - x^2)"],
];

/// The part that is the first entry; those of the others follow.
const ENTRY: usize = 4;

/// The choices of each part.
const CHOICES: [usize; ENTRY + 9] = {
    let mut choices = [3; ENTRY + 9];
    choices[0] = QUATERNION.len();
    choices[1] = SCALES.len();
    choices[2] = MATRIX.len();
    choices[3] = PRODUCT.len();
    choices
};

/// Those of a splat.
pub(crate) const OF_SPLATS: Laws = Laws {
    choices: &CHOICES,
    says: |part, choice| match part {
        0 => format!("q {}", QUATERNION[choice]),
        1 => format!("{} in the place of the scales", SCALES[choice]),
        2 => format!("{} in the place of R", MATRIX[choice]),
        3 => format!("Sigma = {}", PRODUCT[choice]),
        _ => {
            let entry = part - ENTRY;
            let said = ENTRIES[entry][choice - 1];
            format!("{said} in row {}, column {} of R", entry / 3 + 1, entry % 3 + 1)
        }
    },
    of: |a, c, law| forward(a, |q, s| of(q, s, form(c), law)),
    rounding: &[],
};

/// An entry of R with a wrong sign.
fn mistyped([w, x, y, z]: [f64; 4], (i, j): (usize, usize), choice: usize) -> f64 {
    let v = [x, y, z];
    let (whole, first, second) = match (j + 3 - i) % 3 {
        0 => (1.0, -v[usize::from(i == 0)] * v[usize::from(i == 0)], -v[2 - i / 2] * v[2 - i / 2]),
        1 => (0.0, v[i] * v[j], -w * v[3 - i - j]),
        _ => (0.0, v[i] * v[j], w * v[3 - i - j]),
    };
    whole + 2.0 * if choice == 1 { first - second } else { second - first }
}

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
    if law[2] == 1 {
        r[0][0] = w * w + x * x - y * y - z * z;
        r[1][1] = w * w - x * x + y * y - z * z;
        r[2][2] = w * w - x * x - y * y + z * z;
    }
    for (entry, choice) in law[ENTRY..].iter().enumerate().filter(|(_, choice)| **choice > 0) {
        r[entry / 3][entry % 3] = mistyped([w, x, y, z], (entry / 3, entry % 3), *choice);
    }
    // What replaces the matrix as a whole comes behind the signs of its entries.
    let r = DMat3::from_cols_array_2d(&r).transpose();
    match law[2] {
        2 => 0.5 * (r + DMat3::IDENTITY),
        3 => DMat3::IDENTITY,
        _ => r,
    }
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
