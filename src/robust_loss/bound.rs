//! Error bounds of the robust losses: the widest of the ways that honest code takes, each in running error analysis.

use super::arrays::{forward, pair, vjp};
use super::honest::{charbonnier_slope, divided, rooted};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, number};
use crate::contract::bounded::{Bounded, any_order, exact, hyper};
use crate::convention::{Conventions, HuberSlope, LossReduction};

/// The size of a Bounded number.
fn size(d: Bounded) -> Bounded {
    if d.y < 0.0 { d.neg() } else { d }
}

/// One entry of Huber's loss: the piece that it is on, or any where rounding may put it on the other. Divided by delta at once, or by the
/// caller.
fn piece(d: Bounded, delta: Bounded, slope: HuberSlope, m: &Arithmetic) -> Bounded {
    let (size, half) = (size(d), exact(0.5));
    let square = m.mul(half, m.mul(size, size));
    let (inside, beyond) = if slope == HuberSlope::One {
        // d^2 (1/2 / delta) and |d| - delta / 2.
        (m.div(square, delta), m.sub(size, m.mul(half, delta)))
    } else {
        let linear = m.mul(delta, m.sub(size, m.mul(half, delta)));
        // delta |d| - delta^2 / 2.
        (square, linear.or(m.sub(m.mul(delta, size), m.mul(half, m.mul(delta, delta)))))
    };
    let (taken, other) = if size.y <= delta.y { (inside, beyond) } else { (beyond, inside) };
    let open = (size.y - delta.y).abs() <= size.e + delta.e;
    if open { taken.widened((other.y - taken.y).abs() + other.e) } else { taken }
}

/// A sum or mean.
fn reduced(terms: &[Bounded], c: &Conventions, m: &Arithmetic) -> Bounded {
    let sum = any_order(terms, m);
    if c.loss_reduction == LossReduction::Sum { sum } else { divided(m, sum, terms.len()) }
}

/// Bound of [`super::huber`].
pub(crate) fn huber(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let ([p, t], delta) = (pair(a), hyper(number(a, "delta"), m));
    let all = |slope| -> Vec<Bounded> {
        p.iter().zip(&t).map(|(p, t)| piece(m.sub(exact(*p), exact(*t)), delta, slope, m)).collect()
    };
    let value = reduced(&all(c.huber_slope), c, m);
    let value = match c.huber_slope {
        HuberSlope::Delta => value,
        // By Huber's own, divided in the end.
        HuberSlope::One => value.or(m.div(reduced(&all(HuberSlope::Delta), c, m), delta)),
    };
    forward(value.e)
}

/// Bound of [`super::backward::huber`]. A limited number is off by no more than it was, or than the limit is.
pub(crate) fn huber_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let ([p, t], delta, g) = (pair(a), hyper(number(a, "delta"), m), exact(number(a, "grad_value")));
    let one = |(p, t): (&f64, &f64)| {
        let d = m.sub(exact(*p), exact(*t));
        let limited = if size(d).y + d.e < delta.y - delta.e {
            d
        } else {
            Bounded {
                y: d.y.max(-delta.y).min(delta.y),
                e: delta.e.max(if size(d).y - d.e > delta.y { 0.0 } else { d.e }),
            }
        };
        let slope = if c.huber_slope == HuberSlope::One { m.div(limited, delta) } else { limited };
        let mean =
            |x: Bounded| if c.loss_reduction == LossReduction::Sum { x } else { divided(m, x, entries(a)) };
        mean(m.mul(g, slope)).or(m.mul(mean(g), slope)).e
    };
    vjp(a, p.iter().zip(&t).map(one).collect())
}

/// The number of entries.
fn entries(a: &Arrays) -> usize {
    a["prediction"].len()
}

/// Bound of [`super::charbonnier`].
pub(crate) fn charbonnier(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let ([p, t], eps) = (pair(a), number(a, "eps"));
    let terms =
        |way| -> Vec<Bounded> { p.iter().zip(&t).map(|(p, t)| rooted(m, p, t, eps, c, way)).collect() };
    forward(reduced(&terms(0), c, m).or(reduced(&terms(1), c, m)).e)
}

/// Bound of [`super::backward::charbonnier`].
pub(crate) fn charbonnier_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let ([p, t], eps, g) = (pair(a), number(a, "eps"), number(a, "grad_value"));
    let one = |(p, t): (&f64, &f64)| {
        let way = |way| charbonnier_slope(m, [*p, *t], eps, c, [g, entries(a) as f64], way).e;
        (0..4).map(way).fold(0.0, f64::max)
    };
    vjp(a, p.iter().zip(&t).map(one).collect())
}
