//! Error bounds of clipped gradients: the widest of the ways to a norm, in running error analysis; of a limit its own rounding.

use super::arrays::{by_norm, by_value};
use super::honest::{WAYS, clipped};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, number};
use crate::contract::bounded::hyper;
use crate::convention::Conventions;

/// Bound of [`super::clip_by_global_norm`].
pub(crate) fn clip_by_global_norm(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let one = |way| {
        let (clipped, norm) = clipped(m, a, c, way);
        by_norm(a, clipped.map(|tensor| tensor.iter().map(|g| g.e).collect()), norm.e)
    };
    let mut widest = one(0);
    for way in 1..WAYS {
        for (name, other) in one(way) {
            let bound = widest.get_mut(&name).expect("all ways have the same outputs");
            bound.zip_mut_with(&other, |e, other| *e = e.max(*other));
        }
    }
    widest
}

/// Bound of [`super::clip_by_value`].
pub(crate) fn clip_by_value(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let limit = hyper(number(a, "limit"), m);
    by_value(a, |g| if g.abs() <= limit.y - limit.e { 0.0 } else { limit.e })
}
