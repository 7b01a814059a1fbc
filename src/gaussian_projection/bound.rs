//! Error bounds of the projection: the widest of the ways that honest code takes, each in running error analysis.

use super::Splat;
use super::arrays::{form, forward, view, vjp};
use super::honest::{Projected, Results, WAYS};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, widest};
use crate::convention::Conventions;

/// How far off a number is that is rounded up: by as many pixels as lie between.
fn rounded_up(x: Bounded) -> f64 {
    if x.e == f64::INFINITY {
        return x.e;
    }
    let (low, up, high) = ((x.y - x.e).ceil(), x.y.ceil(), (x.y + x.e).ceil());
    (up - low).max(high - up)
}

/// The errors of one way.
fn errors(results: &Results<Bounded>) -> Splat {
    Splat {
        mean: results.mean.map(|x| x.e),
        covariance: results.covariance.map(|x| x.e),
        conic: results.conic.map(|x| x.e),
        depth: results.depth.e,
        radius: rounded_up(results.reach),
        compensation: results.compensation.e,
    }
}

/// Bound of [`super::project`].
pub(crate) fn projection(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let (view, form) = (view(a), form(c));
    forward(a, c, |mean, sigma| {
        let one = |way| errors(&Projected::new(m, mean, sigma, &view, form, way).results());
        let larger = |a: Splat, b: Splat| Splat {
            mean: widest(a.mean, b.mean),
            covariance: widest(a.covariance, b.covariance),
            conic: widest(a.conic, b.conic),
            depth: a.depth.max(b.depth),
            radius: a.radius.max(b.radius),
            compensation: a.compensation.max(b.compensation),
        };
        (1..WAYS).map(one).fold(one(0), larger)
    })
}

/// Bound of [`super::backward::project`].
pub(crate) fn projection_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let (view, form) = (view(a), form(c));
    vjp(a, c, |mean, sigma, g| {
        (0..WAYS).fold(([0.0; 3], [0.0; 6]), |all, way| {
            let (g_mean, g_sigma) = Projected::new(m, mean, sigma, &view, form, way).gradients(g);
            (widest(all.0, g_mean.map(|x| x.e)), widest(all.1, g_sigma.map(|x| x.e)))
        })
    })
}
