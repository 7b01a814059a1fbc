//! The oracle of this folder on named arrays, and what turns these into its types and back.

use glam::DVec2;

use super::{Distortion, backward};
use crate::contract::arrays::{Arrays, array, arrays, twos, values};
use crate::convention::Conventions;

/// The lens of a case.
pub(crate) fn lens(a: &Arrays) -> Distortion {
    Distortion::from_opencv(&values(a, "coefficients"))
}

/// A point's result, on its place in the outputs.
pub(crate) type Pair = [f64; 2];

/// `f(point)` of each point of `from`, as the output `to`.
pub(crate) fn forward(a: &Arrays, from: &str, to: &str, f: impl Fn(Pair) -> Pair) -> Arrays {
    let points = twos(a, from);
    arrays([(to, array(&[points.len(), 2], points.into_iter().flat_map(f).collect()))])
}

/// `f(point, cotangent)` of each point, as the gradients: those of the coefficients added up by `total`.
pub(crate) fn vjp<T: Copy, const N: usize>(
    a: &Arrays,
    from: &str,
    to: &str,
    f: impl Fn(Pair, Pair) -> (Pair, [T; N]),
    total: impl Fn(&[T]) -> f64,
) -> Arrays {
    let points = twos(a, from);
    let gradients: Vec<(Pair, [T; N])> =
        points.iter().zip(twos(a, &format!("grad_{to}"))).map(|(&p, g)| f(p, g)).collect();
    let of = |n: usize| total(&gradients.iter().map(|(_, g_k)| g_k[n]).collect::<Vec<_>>());
    let coefficients = a["coefficients"].len();
    let g_points = gradients.iter().flat_map(|(g, _)| *g).collect();
    arrays([
        (&format!("grad_{from}"), array(&[points.len(), 2], g_points)),
        ("grad_coefficients", array(&[coefficients], (0..coefficients).map(of).collect())),
    ])
}

/// A sum, one term after another.
pub(crate) fn in_order(terms: &[f64]) -> f64 {
    let mut sum = crate::math::Sum::default();
    terms.iter().for_each(|&x| sum.add(x));
    sum.value()
}

/// The ideal point, not a number where the lens has none.
pub(crate) fn undistorted(lens: &Distortion, target: Pair) -> DVec2 {
    lens.undistort(target.into()).unwrap_or(DVec2::NAN)
}

pub(super) fn lens_distort(a: &Arrays, _: &Conventions) -> Arrays {
    let lens = lens(a);
    forward(a, "points", "distorted", |p| lens.distort(p.into()).to_array())
}

pub(super) fn lens_distort_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    let lens = lens(a);
    let f = |p: Pair, g: Pair| {
        let (g_p, g_k) = backward::distort(&lens, p.into(), g.into());
        (g_p.to_array(), g_k)
    };
    vjp(a, "points", "distorted", f, in_order)
}

pub(super) fn lens_undistort(a: &Arrays, _: &Conventions) -> Arrays {
    let lens = lens(a);
    forward(a, "distorted", "points", |target| undistorted(&lens, target).to_array())
}

pub(super) fn lens_undistort_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    let lens = lens(a);
    let f = |target: Pair, g: Pair| {
        let (g_target, g_k) = backward::undistort(&lens, undistorted(&lens, target), g.into());
        (g_target.to_array(), g_k)
    };
    vjp(a, "distorted", "points", f, in_order)
}
