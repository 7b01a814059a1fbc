//! Error bounds of schedules: the widest of the ways that honest code takes, each in running error analysis in f32 at least, and the
//! rounding of the rate to the type. From rate to rate is for grade B.

use super::arrays::forward;
use super::honest::{WAYS, cosine, exponential, log_linear};
use crate::contract::arithmetic::{Arithmetic, Dtype, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::bounded::Bounded;
use crate::convention::Conventions;

/// The widest way.
fn widest(m: &Arithmetic, rate: impl Fn(&Arithmetic, u64) -> Bounded) -> Arrays {
    let (tiny, largest) = (m.tiny.min(Dtype::F32.smallest_normal()), m.largest.max(Dtype::F32.largest()));
    let fine = Arithmetic { u: m.u_sum, tiny, largest, ..*m };
    let answered = |x: Bounded| if m.u_sum < m.u { m.rounded(x.y, x.e) } else { x };
    let ways = if m.grade == Grade::A { WAYS - 1 } else { WAYS };
    forward((0..ways).map(|way| answered(rate(&fine, way)).e).fold(0.0, f64::max))
}

/// Bound of [`super::exponential`].
pub(crate) fn lr_exponential(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    widest(m, |fine, way| exponential(fine, a, c, way))
}

/// Bound of [`super::cosine`].
pub(crate) fn lr_cosine(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    widest(m, |fine, way| cosine(fine, a, c, way))
}

/// Bound of [`super::log_linear`].
pub(crate) fn lr_log_linear(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    widest(m, |fine, way| log_linear(fine, a, c, way))
}
