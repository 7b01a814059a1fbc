//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{Form, backward, covariance as oracle};
use crate::contract::arrays::{Arrays, array, arrays, groups, matrices3, threes};
use crate::convention::Conventions;

/// How rotations and scales are written down.
pub(crate) fn form(c: &Conventions) -> Form {
    Form { order: c.quaternion_order, length: c.quaternion_length, scale: c.splat_scale }
}

/// `f(quaternion, scales)` of each Gaussian, as the output.
pub(crate) fn forward(a: &Arrays, f: impl Fn([f64; 4], [f64; 3]) -> [[f64; 3]; 3]) -> Arrays {
    let quaternions = groups::<4>(a, "quaternions");
    let sigma = quaternions.iter().zip(threes(a, "scales")).flat_map(|(&q, s)| f(q, s)).flatten().collect();
    arrays([("covariances", array(&[quaternions.len(), 3, 3], sigma))])
}

/// `f(quaternion, scales, cotangent)` of each Gaussian, as the gradients.
pub(crate) fn vjp(
    a: &Arrays,
    f: impl Fn([f64; 4], [f64; 3], [[f64; 3]; 3]) -> ([f64; 4], [f64; 3]),
) -> Arrays {
    let (quaternions, scales) = (groups::<4>(a, "quaternions"), threes(a, "scales"));
    let g = matrices3(a, "grad_covariances");
    let one = |n: usize| f(quaternions[n], scales[n], g[n]);
    let (g_q, g_s): (Vec<_>, Vec<_>) = (0..quaternions.len()).map(one).unzip();
    arrays([
        ("grad_quaternions", array(&[g_q.len(), 4], g_q.concat())),
        ("grad_scales", array(&[g_s.len(), 3], g_s.concat())),
    ])
}

pub(super) fn covariance(a: &Arrays, c: &Conventions) -> Arrays {
    forward(a, |q, s| oracle(q, s, form(c)))
}

pub(super) fn covariance_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    vjp(a, |q, s, g| backward::covariance(q, s, g, form(c)))
}
