//! Laws of hand-written backward passes of the projection: what the conic hands to the covariance, that to Sigma and to J, and J to the mean.

use super::super::arrays::{form, view, vjp};
use super::super::backward::{jacobian_gradient, of_covariance, of_jacobian, of_sigma};
use super::super::{Form, Splat, View, backward, clamped, in_camera, project, transform};
use crate::contract::laws::Laws;

/// From the conic, (A, B, C), to the covariance.
const CONIC: [&str; 7] = [
    "as it is",
    "with the gradient of B for both of its entries in the matrix",
    "with half of the gradient of B",
    "nothing",
    "without the minus",
    "with det^2 + 1e-4 in the denominator",
    "with det^2 + 1e-7 in the denominator",
];

/// From the covariance to Sigma.
const SIGMA: [&str; 7] = [
    "the numbers off the diagonal for both of their entries",
    "the numbers off the diagonal for one of their entries",
    "nothing",
    "not turned back",
    "turned the other way",
    "not turned back, the numbers off the diagonal for one of their entries",
    "twice that",
];

/// From the covariance to J.
const JACOBIAN: [&str; 4] =
    ["of both factors", "of one factor alone", "nothing: J is held", "of x and y in J, not of z"];

/// What of a clamped mean is differentiated.
const HELD: [&str; 4] = [
    "as it is by convention",
    "as if it weren't clamped",
    "without the depth of the held column",
    "nothing of a splat that is clamped",
];

/// What the place in the picture hands to the mean.
const PLACE: [&str; 5] = [
    "all of it",
    "nothing",
    "without the depth",
    "with + for the depth",
    "with one over z for one over z^2 in the depth",
];

/// How the mean's gradient is turned.
const TURNED: [&str; 3] = ["R^T", "not at all", "R"];

/// What the depth and the compensation hand on.
const REST: [&str; 4] = ["both", "the depth alone", "the compensation alone", "nothing"];

/// Those of a splat.
pub(crate) const OF_SPLATS: Laws = Laws {
    choices: &[CONIC.len(), SIGMA.len(), JACOBIAN.len(), HELD.len(), PLACE.len(), TURNED.len(), REST.len()],
    says: |part, choice| match part {
        0 => format!("from the conic to the covariance: {}", CONIC[choice]),
        1 => format!("from the covariance to Sigma: {}", SIGMA[choice]),
        2 => format!("from the covariance to J: {}", JACOBIAN[choice]),
        3 => format!("where x/z is clamped: {}", HELD[choice]),
        4 => format!("from the place to the mean: {}", PLACE[choice]),
        5 => format!("the mean's gradient turned by {}", TURNED[choice]),
        _ => format!("of depth and compensation {}", REST[choice]),
    },
    of: |a, c, law| {
        let view = view(a);
        vjp(a, c, |mean, sigma, g| of(mean, sigma, &view, form(c), g, law))
    },
    rounding: &[],
};

/// The covariance's gradient by way of the conic and the rest.
fn covariance(splat: &Splat, form: Form, g: &Splat, law: &[usize]) -> [f64; 3] {
    let g = match law[6] {
        1 | 3 => Splat { compensation: 0.0, ..*g },
        _ => *g,
    };
    let none = Splat { conic: [0.0; 3], ..g };
    let (whole, without) = (of_covariance(splat, form, &g), of_covariance(splat, form, &none));
    let own = [0, 1, 2].map(|n| whole[n] - without[n]);
    let with_b = |factor: f64| {
        let conic = [g.conic[0], factor * g.conic[1], g.conic[2]];
        let whole = of_covariance(splat, form, &Splat { conic, ..g });
        [0, 1, 2].map(|n| whole[n] - without[n])
    };
    let [a, b, c] = splat.covariance;
    let det = a * c - b * b;
    let over = |eps: f64| own.map(|x| x * det * det / (det * det + eps));
    let part = match law[0] {
        1 => with_b(2.0),
        2 => with_b(0.5),
        3 => [0.0; 3],
        4 => own.map(|x| -x),
        5 => over(1e-4),
        6 => over(1e-7),
        _ => return whole,
    };
    [0, 1, 2].map(|n| part[n] + without[n])
}

/// Sigma's gradient, of the rows P and Q of T, or of J where it isn't turned back.
fn sigma(rows: [[f64; 3]; 2], view: &View, g: [f64; 3], choice: usize) -> [f64; 6] {
    let r = view.rotation;
    // T = J R: J is T R^T.
    let by = |row: [f64; 3], turn: &dyn Fn(usize, usize) -> f64| -> [f64; 3] {
        [0, 1, 2].map(|i| (0..3).map(|k| row[k] * turn(k, i)).sum())
    };
    let j = rows.map(|row| by(row, &|k, i| r[i][k]));
    let seen = match choice {
        3 | 5 => j,
        4 => j.map(|row| by(row, &|k, i| r[i][k])),
        _ => rows,
    };
    let mut out = of_sigma(seen, g);
    match choice {
        1 | 5 => [1, 2, 4].iter().for_each(|n| out[*n] *= 0.5),
        2 => out = [0.0; 6],
        6 => out.iter_mut().for_each(|x| *x *= 2.0),
        _ => {}
    }
    out
}

fn of(
    mean: [f64; 3],
    six: [f64; 6],
    view: &View,
    form: Form,
    g: &Splat,
    law: &[usize],
) -> ([f64; 3], [f64; 6]) {
    if law.iter().all(|choice| *choice == 0) {
        return backward::project(mean, six, view, form, g);
    }
    let (t, splat) = (in_camera(mean, view), project(mean, six, view, form));
    let rows = transform(t, view, form);
    let g_covariance = covariance(&splat, form, g, law);
    let held: Vec<bool> = clamped(t, view, form).iter().map(|(_, held)| *held).collect();
    let mut of_j = jacobian_gradient(rows, six, g_covariance, view);
    match law[2] {
        1 => of_j = of_j.map(|row| row.map(|x| 0.5 * x)),
        2 => of_j = [[0.0; 2]; 2],
        _ => {}
    }
    let mut g_t = match law[3] {
        1 => {
            let free = Form { clamp: crate::convention::SplatClamp::None, ..form };
            of_jacobian(t, of_j, view, free)
        }
        2 => {
            // The column of the depth has no gradient at all there.
            let kept = [0, 1].map(|n| if held[n] { [of_j[n][0], 0.0] } else { of_j[n] });
            of_jacobian(t, kept, view, form)
        }
        3 if held.contains(&true) => [0.0; 3],
        _ => of_jacobian(t, of_j, view, form),
    };
    if law[2] == 3 {
        g_t[2] = 0.0;
    }
    let [fx, fy] = [view.k.fx, view.k.fy];
    let along = -(fx * t[0] * g.mean[0] + fy * t[1] * g.mean[1]);
    let depth = match law[4] {
        0 => along / (t[2] * t[2]),
        3 => -along / (t[2] * t[2]),
        4 => along / t[2],
        _ => 0.0,
    };
    if law[4] != 1 {
        g_t[0] += fx / t[2] * g.mean[0];
        g_t[1] += fy / t[2] * g.mean[1];
    }
    g_t[2] += depth + if law[6] < 2 { g.depth } else { 0.0 };
    let r = view.rotation;
    let g_mean = match law[5] {
        0 => [0, 1, 2].map(|k| r[0][k] * g_t[0] + r[1][k] * g_t[1] + r[2][k] * g_t[2]),
        1 => g_t,
        _ => [0, 1, 2].map(|k| r[k][0] * g_t[0] + r[k][1] * g_t[1] + r[k][2] * g_t[2]),
    };
    (g_mean, sigma(rows, view, g_covariance, law[1]))
}
