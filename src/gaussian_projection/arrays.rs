//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{Form, Splat, View, backward, project};
use crate::camera::arrays::intrinsics;
use crate::contract::arrays::{Arrays, array, arrays, groups, number, threes, twos, values};
use crate::convention::Conventions;

/// How this code base projects.
pub(crate) fn form(c: &Conventions) -> Form {
    Form {
        center: c.splat_center,
        dilation: c.splat_dilation,
        clamp: c.splat_clamp,
        clamp_gradient: c.splat_clamp_gradient,
        radius: c.radius_floor,
        compensation: c.compensation_floor,
        culling: c.splat_culling,
    }
}

/// The camera of a case.
pub(crate) fn view(a: &Arrays) -> View {
    let w2c = groups::<4>(a, "w2c");
    View {
        rotation: [0, 1, 2].map(|i| [w2c[i][0], w2c[i][1], w2c[i][2]]),
        translation: [0, 1, 2].map(|i| w2c[i][3]),
        k: intrinsics(&values(a, "K")),
        width: number(a, "width"),
        height: number(a, "height"),
    }
}

/// `f(mean, covariance)` of each Gaussian that isn't culled, as the outputs.
pub(crate) fn forward(a: &Arrays, c: &Conventions, f: impl Fn([f64; 3], [f64; 6]) -> Splat) -> Arrays {
    let (means, view) = (threes(a, "means").into_iter(), view(a));
    let one = |(mean, sigma)| match project(mean, sigma, &view, form(c)) {
        Splat::NOWHERE => Splat::NOWHERE,
        _ => f(mean, sigma),
    };
    let splats: Vec<Splat> = means.zip(groups::<6>(a, "covariances")).map(one).collect();
    let n = splats.len();
    let each = |read: fn(&Splat) -> f64| array(&[n], splats.iter().map(read).collect());
    arrays([
        ("means2d", array(&[n, 2], splats.iter().flat_map(|s| s.mean).collect())),
        ("covariances2d", array(&[n, 3], splats.iter().flat_map(|s| s.covariance).collect())),
        ("conics", array(&[n, 3], splats.iter().flat_map(|s| s.conic).collect())),
        ("depths", each(|s| s.depth)),
        ("radii", each(|s| s.radius)),
        ("compensations", each(|s| s.compensation)),
    ])
}

/// `f(mean, covariance, cotangent)` of each Gaussian that isn't culled, as the gradients.
pub(crate) fn vjp(
    a: &Arrays,
    c: &Conventions,
    f: impl Fn([f64; 3], [f64; 6], &Splat) -> ([f64; 3], [f64; 6]),
) -> Arrays {
    let (means, sigmas) = (threes(a, "means"), groups::<6>(a, "covariances"));
    let (g_mean, g_depth) = (twos(a, "grad_means2d"), values(a, "grad_depths"));
    let (g_covariance, g_conic) = (threes(a, "grad_covariances2d"), threes(a, "grad_conics"));
    let g_compensation = values(a, "grad_compensations");
    let cotangent = |n: usize| Splat {
        mean: g_mean[n],
        covariance: g_covariance[n],
        conic: g_conic[n],
        depth: g_depth[n],
        radius: 0.0,
        compensation: g_compensation[n],
    };
    let view = view(a);
    let one = |n: usize| match project(means[n], sigmas[n], &view, form(c)) {
        Splat::NOWHERE => ([0.0; 3], [0.0; 6]),
        _ => f(means[n], sigmas[n], &cotangent(n)),
    };
    let (g_means, g_sigmas): (Vec<_>, Vec<_>) = (0..means.len()).map(one).unzip();
    arrays([
        ("grad_means", array(&[g_means.len(), 3], g_means.concat())),
        ("grad_covariances", array(&[g_sigmas.len(), 6], g_sigmas.concat())),
    ])
}

pub(super) fn projection(a: &Arrays, c: &Conventions) -> Arrays {
    forward(a, c, |mean, sigma| project(mean, sigma, &view(a), form(c)))
}

pub(super) fn projection_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    vjp(a, c, |mean, sigma, g| backward::project(mean, sigma, &view(a), form(c), g))
}
