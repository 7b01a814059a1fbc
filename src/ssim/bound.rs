//! Error bounds of structural similarity: in grade A that of central moments, in grade B the widest of all ways, in running error
//! analysis. Short types have their result alone: losses and metrics are computed in f32, also where the network isn't.

use super::arrays::{forward, vjp};
use super::honest::{CENTRAL, Pictures, WAYS};
use crate::contract::arithmetic::{Arithmetic, Dtype, Grade};
use crate::contract::arrays::{Arrays, number};
use crate::contract::bounded::Bounded;
use crate::convention::Conventions;

/// The ways of a grade.
fn ways(m: &Arithmetic) -> std::ops::Range<u64> {
    if m.grade == Grade::A { CENTRAL..WAYS } else { 0..WAYS }
}

/// The arithmetic of everything but the result: f32's at least. Moments in fewer bits would leave nothing of a covariance, and no gradient
/// that could be told from another one.
fn fine(m: &Arithmetic) -> Arithmetic {
    let (tiny, largest) = (m.tiny.min(Dtype::F32.smallest_normal()), m.largest.max(Dtype::F32.largest()));
    Arithmetic { u: m.u_sum, tiny, largest, ..*m }
}

/// Rounded to the type once more, where that is a shorter one.
fn answered(m: &Arithmetic, x: Bounded) -> Bounded {
    if m.u_sum < m.u { m.rounded(x.y, x.e) } else { x }
}

/// Bound of [`super::ssim`].
pub(crate) fn ssim(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let fine = fine(m);
    let one = |way| answered(m, Pictures::new(&fine, a, c, way).value()).e;
    forward(ways(m).map(one).fold(0.0, f64::max))
}

/// Bound of [`super::backward::ssim`].
pub(crate) fn ssim_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let fine = fine(m);
    let one = |way| Pictures::new(&fine, a, c, way).gradient(number(a, "grad_value"), |g| answered(m, g).e);
    let mut widest = one(ways(m).start);
    for way in ways(m).skip(1) {
        widest.zip_mut_with(&one(way), |e, other| *e = e.max(*other));
    }
    vjp(widest)
}
