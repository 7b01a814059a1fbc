//! Honest clips: the norm of all numbers or of the tensors' norms; times one factor, or divided and multiplied; limits by comparisons or
//! by sizes and signs.

use super::arrays::{by_norm, by_value, tensors};
use crate::contract::arrays::{Arrays, number};
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::convention::Conventions;

/// The ways to clip by a norm.
pub(super) const WAYS: u64 = 6;

/// The root of a sum of squares.
fn length<O: Operations>(o: &O, numbers: &[O::Number]) -> O::Number {
    o.sqrt(o.dot(numbers, numbers))
}

/// The norm of all tensors.
fn norm<O: Operations>(o: &O, tensors: &[Vec<O::Number>], way: u64) -> O::Number {
    if way % 2 == 0 {
        return length(o, &tensors.concat());
    }
    let norms: Vec<O::Number> = tensors.iter().map(|tensor| length(o, tensor)).collect();
    length(o, &norms)
}

/// The clipped tensors and the norm.
pub(super) fn clipped<O: Operations>(
    o: &O,
    a: &Arrays,
    c: &Conventions,
    way: u64,
) -> ([Vec<O::Number>; 2], O::Number) {
    let tensors = tensors(a).map(|tensor| tensor.iter().map(|g| o.exact(*g)).collect::<Vec<_>>());
    let (norm, most) = (norm(o, &tensors, way), o.hyper(number(a, "max_norm")));
    let eps = c.clip_eps.value();
    let under = if eps == 0.0 { norm } else { o.add(norm, o.hyper(eps)) };
    // Not below the limit: then the factor is 1, exactly.
    let under = o.max(under, most);
    let factor = o.div(most, under);
    let one = |g: O::Number| match way / 2 % 3 {
        0 => o.mul(g, factor),
        1 => o.mul(o.div(g, under), most),
        _ => o.mul(g, o.mul(most, o.div(o.exact(1.0), under))),
    };
    (tensors.map(|tensor| tensor.into_iter().map(one).collect()), norm)
}

/// By the norm.
pub(crate) fn clip_by_global_norm(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let way = (2 * m.form + u64::from(m.stable) + m.noise / 4) % WAYS;
    let (clipped, norm) = clipped(m, a, c, way);
    by_norm(a, clipped, norm)
}

/// By value.
pub(crate) fn clip_by_value(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let limit = m.round(number(a, "limit"));
    by_value(a, |g| match m.form % 3 {
        0 => g.max(-limit).min(limit),
        1 => g.abs().min(limit).copysign(g),
        _ => super::clip_by_value(g, limit),
    })
}
