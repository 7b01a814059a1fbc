//! The covariance, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{form, forward, vjp};
use super::{Form, backward, covariance as oracle, deviations, rotation, unit};
use crate::contract::arrays::{Arrays, values};
use crate::contract::component::{Mistake, joined};
use crate::convention::{Conventions, QuaternionLength};
use crate::pose::mistakes::signs::{SIGNS, signed};

mod gradients;
pub(crate) mod laws;

use gradients::{OF_GRADIENTS, hand_written};

const WIDENED: Mistake = Mistake::new(
    "eps_on_the_diagonal",
    "eps is added to the diagonal",
    "small splats are larger than their scales",
    "the dilation in the picture, nothing here",
    "never; cheap to keep",
    0,
)
.with("eps", 1e-3, [1e-9, 1.0]);
const LEAST_SCALE: Mistake = Mistake::new(
    "scales_held_up",
    "scales are at least so large",
    "no splat is flat, and one that is has no gradient",
    "scales as they are",
    "never; cheap to keep",
    0,
)
.with("least", 1e-2, [1e-6, 1.0]);

/// Mistakes of the covariance.
pub(crate) const GAUSSIAN_COVARIANCE: &[Mistake] =
    &joined::<{ FORWARD.len() + OF_GRADIENTS.len() }>(&[FORWARD, OF_GRADIENTS]);

const FORWARD: &[Mistake] = &[
    Mistake::new(
        "rotation_transposed",
        "R^T diag(s)^2 R: M^T M of an M = diag(s) R whose R is in rows",
        "every splat is turned the other way; those along the axes, with which training begins, look right",
        "M M^T with M = R diag(s); M^T M is right where matrices are stored by columns (GLM)",
        "a splat viewer's server and a WebGL loader (M = S @ R, M.T @ M), after the rasterizer's line for GLM",
        2,
    ),
    Mistake::new(
        "rotation_cancels",
        "(diag(s) R) (diag(s) R)^T: R R^T stands inside",
        "splats can't turn: every axis stays along x, y or z",
        "M = R diag(s): scale first, then turn",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "scale_not_squared",
        "R diag(s) R^T",
        "scales are variances: small splats are far too large, large ones too small",
        "s^2: once from each M",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "norm_squared",
        "q / |q|^2: the root is missing",
        "short quaternions shear splats and blow them up",
        "divide by the root of the sum of squares",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "norm_of_all",
        "one norm for all quaternions: without its axis",
        "what a splat looks like depends on how many there are",
        "the norm along the last axis",
        "never in this row; as norm_of_all_rays of directions",
        0,
    ),
    Mistake::new(
        "length_squared_times_rotation",
        "w^2 + x^2 - y^2 - z^2 on the diagonal, of quaternions that aren't of length 1: |q|^2 R",
        "scales are multiplied by |q|^2, which every step of the optimizer changes",
        "divide q by its length, or write 1 - 2 (y^2 + z^2) as the original does",
        "1 public implementation, which shares the function with poses, whose quaternions are of length 1",
        1,
    ),
    WIDENED,
    LEAST_SCALE,
    Mistake::new(
        "not_multiplied_with_itself",
        "M = R S itself in the place of M M^T",
        "no covariance: not even symmetric",
        "M M^T",
        "never; cheap to keep",
        0,
    ),
    SIGNS[0],
    SIGNS[1],
    SIGNS[2],
    SIGNS[3],
    SIGNS[4],
    SIGNS[5],
    Mistake::new(
        "diagonal_once",
        "1 - (y^2 + z^2) in R_xx: a 2 is missing",
        "R isn't a rotation: splats are sheared",
        "1 - 2 (y^2 + z^2)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "off_diagonal_once_in_rotation",
        "x y - w z and the like off the diagonal, without the 2",
        "R isn't a rotation: splats are turned half as far and shrink",
        "2 (x y - w z)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "quaternion_rolled",
        "q[2], q[3], q[0], q[1] in the place of q[0], q[1], q[2], q[3]",
        "another rotation",
        "w first, or last",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "length_by_sum",
        "q divided by the sum of its entries' sizes",
        "R isn't a rotation",
        "divide by the root of the sum of squares",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "upper_triangle_alone",
        "the six numbers of one half, and 0 in the other",
        "whoever reads the matrix by rows or by columns sees another splat",
        "both halves, or six numbers",
        "never; cheap to keep",
        0,
    ),
];

/// The length that quaternions are divided by.
fn divisor(q: [f64; 4], of_all: f64, wrong: &[&str]) -> f64 {
    let square = q.iter().map(|x| x * x).sum::<f64>();
    match () {
        () if wrong.contains(&"norm_squared") => square,
        () if wrong.contains(&"norm_of_all") => of_all,
        () => square.sqrt(),
    }
}

/// A covariance with what is wrong about it.
fn wrong_covariance(
    mut q: [f64; 4],
    scales: [f64; 3],
    of_all: f64,
    form: Form,
    wrong: &[&str],
) -> [[f64; 3]; 3] {
    let has = |name: &str| wrong.contains(&name);
    if has("quaternion_rolled") {
        q.rotate_left(2);
    }
    let as_given = Form { length: QuaternionLength::AsGiven, ..form };
    let (u, _) = unit(q, as_given);
    let length = if form.length == QuaternionLength::Divided { divisor(q, of_all, wrong) } else { 1.0 };
    let length = if has("length_by_sum") { u.iter().map(|x| x.abs()).sum() } else { length };
    let (mut r, mut s) = (signed(rotation(u.map(|x| x / length)), wrong), deviations(scales, form));
    if let Some(least) = LEAST_SCALE.among(wrong) {
        s = s.map(|s| s.max(least));
    }
    match () {
        () if has("diagonal_once") => r[0][0] = 0.5 * (1.0 + r[0][0]),
        () if has("off_diagonal_once_in_rotation") => {
            r = [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { r[i][i] } else { 0.5 * r[i][j] }))
        }
        () => {}
    }
    if has("length_squared_times_rotation") {
        let square = u.iter().map(|x| x * x).sum::<f64>();
        r = rotation(u.map(|x| x / square.sqrt())).map(|row| row.map(|x| square * x));
    }
    let entry = |i: usize, j: usize| -> f64 {
        let term = |k: usize| match () {
            () if has("rotation_transposed") => (r[k][i] * s[k]) * (r[k][j] * s[k]),
            () if has("rotation_cancels") => (s[i] * r[i][k]) * (s[j] * r[j][k]),
            () if has("scale_not_squared") => r[i][k] * s[k] * r[j][k],
            () => (r[i][k] * s[k]) * (r[j][k] * s[k]),
        };
        (0..3).map(term).sum()
    };
    let more = WIDENED.among(wrong).unwrap_or(0.0);
    if has("upper_triangle_alone") {
        return [0, 1, 2].map(|i| [0, 1, 2].map(|j| if j < i { 0.0 } else { entry(i, j) }));
    }
    if has("not_multiplied_with_itself") {
        return [0, 1, 2].map(|i| [0, 1, 2].map(|j| r[i][j] * s[j]));
    }
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j) + if i == j { more } else { 0.0 }))
}

/// Covariances.
pub(crate) fn covariance(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let of_all = values(a, "quaternions").iter().map(|x| x * x).sum::<f64>().sqrt();
    forward(a, |q, s| match wrong {
        [] => oracle(q, s, form(c)),
        wrong => wrong_covariance(q, s, of_all, form(c), wrong),
    })
}

/// Their gradients.
pub(crate) fn covariance_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let form = form(c);
    vjp(a, |q, scales, g| match wrong {
        [] => backward::covariance(q, scales, g, form),
        wrong => hand_written(q, scales, g, form, wrong),
    })
}
