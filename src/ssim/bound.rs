//! Error bounds of structural similarity: in grade A that of central moments, in grade B the widest of all ways, in running error
//! analysis.

use super::arrays::{forward, vjp};
use super::honest::{CENTRAL, Pictures, WAYS};
use crate::contract::arithmetic::{Arithmetic, Dtype, Grade};
use crate::contract::arrays::{Arrays, number};
use crate::convention::Conventions;

/// The ways of a grade.
fn ways(m: &Arithmetic) -> std::ops::Range<u64> {
    if m.grade == Grade::A { CENTRAL..WAYS } else { 0..WAYS }
}

/// The arithmetic that the window is made in: f32's at least.
fn fine(m: &Arithmetic) -> Arithmetic {
    Arithmetic { u: m.u_sum, tiny: m.tiny.min(Dtype::F32.smallest_normal()), ..*m }
}

/// Bound of [`super::ssim`].
pub(crate) fn ssim(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let fine = fine(m);
    forward(ways(m).map(|way| Pictures::new([m, &fine], a, c, way).value().e).fold(0.0, f64::max))
}

/// Bound of [`super::backward::ssim`].
pub(crate) fn ssim_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let fine = fine(m);
    let one = |way| Pictures::new([m, &fine], a, c, way).gradient(number(a, "grad_value"), |g| g.e);
    let mut widest = one(ways(m).start);
    for way in ways(m).skip(1) {
        widest.zip_mut_with(&one(way), |e, other| *e = e.max(*other));
    }
    vjp(widest)
}
