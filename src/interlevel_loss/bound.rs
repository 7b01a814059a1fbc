//! Error bounds of the interlevel loss: in grade A of the weights that overlap, in grade B of a difference of running sums too.

use super::arrays::{form, forward, vjp};
use super::honest::{RUNNING, Ray, WAYS};
use crate::contract::arithmetic::{Arithmetic, Grade};
use crate::contract::arrays::Arrays;
use crate::convention::Conventions;

/// The number of ways of a grade.
fn ways(m: &Arithmetic) -> u64 {
    if m.grade == Grade::A { RUNNING } else { WAYS }
}

/// Bound of [`super::interlevel`].
pub(crate) fn interlevel(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    forward(a, |fine, proposal| {
        let one = |way| Ray::new(m, fine, proposal, form(a, c), way).loss().e;
        (0..ways(m)).map(one).fold(0.0, f64::max)
    })
}

/// Bound of [`super::backward::interlevel`].
pub(crate) fn interlevel_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    vjp(a, |fine, proposal, g| {
        let mut widest = vec![0.0; proposal.weights.len()];
        for way in 0..ways(m) {
            let one = Ray::new(m, fine, proposal, form(a, c), way).gradients(g);
            widest.iter_mut().zip(one).for_each(|(e, other): (&mut f64, _)| *e = e.max(other.e));
        }
        widest
    })
}
