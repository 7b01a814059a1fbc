//! Error bounds of splats' opacities: the widest of the ways that honest code takes, each in running error analysis.

use super::Splat;
use super::arrays::{form, forward, vjp};
use super::honest::{Seen, WAYS};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, any_order};
use crate::convention::Conventions;

/// Bound of [`super::alpha`].
pub(crate) fn alpha(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    forward(a, |pixel, splat| {
        (0..WAYS).map(|way| Seen::new(m, pixel, splat, form(c), way).opacity().e).fold(0.0, f64::max)
    })
}

/// Bound of [`super::backward::alpha`].
pub(crate) fn alpha_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let widest = |pixel: [f64; 2], splat: &Splat, g: f64| -> [Bounded; 6] {
        let one = |way| Seen::new(m, pixel, splat, form(c), way).gradients(g);
        (1..WAYS).map(one).fold(one(0), |all, one| std::array::from_fn(|n| all[n].or(one[n])))
    };
    vjp(a, widest, |parts| any_order(parts, m).e)
}
