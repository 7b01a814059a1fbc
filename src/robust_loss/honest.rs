//! Honest robust losses: by pieces or by a limited difference, the constants inside or divided in the end; slopes by a division or by the
//! inverse root.

use super::arrays::{forward, pair, vjp};
use crate::contract::arrays::{Arrays, number};
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::convention::{CharbonnierEps, Conventions, HuberSlope, LossReduction};

/// x / n.
pub(super) fn divided<O: Operations>(o: &O, x: O::Number, n: usize) -> O::Number {
    o.mul(x, o.div(o.exact(1.0), o.exact(n as f64)))
}

fn mean(m: &Machine, x: f64, n: usize) -> f64 {
    if m.form % 2 == 0 { m.div(x, n as f64) } else { divided(m, x, n) }
}

/// A sum or mean.
fn reduced(m: &Machine, terms: &[f64], c: &Conventions) -> f64 {
    let sum = m.sum(terms);
    if c.loss_reduction == LossReduction::Sum { sum } else { mean(m, sum, terms.len()) }
}

/// One entry of Huber's loss.
fn piece(m: &Machine, d: f64, delta: f64, slope: HuberSlope) -> f64 {
    let (size, half) = (d.abs(), m.mul(0.5, delta));
    match slope {
        HuberSlope::One if size <= delta => m.div(m.mul(0.5, m.mul(size, size)), delta),
        HuberSlope::One => m.sub(size, half),
        HuberSlope::Delta if size <= delta => m.mul(0.5, m.mul(size, size)),
        HuberSlope::Delta if m.stable => m.mul(delta, m.sub(size, half)),
        HuberSlope::Delta => m.sub(m.mul(delta, size), m.mul(0.5, m.mul(delta, delta))),
    }
}

/// Huber's loss.
pub(crate) fn huber(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let ([p, t], delta) = (pair(a), m.round(number(a, "delta")));
    let all = |slope| -> Vec<f64> {
        p.iter().zip(&t).map(|(p, t)| piece(m, m.sub(*p, *t), delta, slope)).collect()
    };
    let late = c.huber_slope == HuberSlope::One && m.form / 2 % 2 == 1;
    forward(if late {
        m.div(reduced(m, &all(HuberSlope::Delta), c), delta)
    } else {
        reduced(m, &all(c.huber_slope), c)
    })
}

/// Its gradient.
pub(crate) fn huber_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let ([p, t], delta, g) = (pair(a), m.round(number(a, "delta")), number(a, "grad_value"));
    let over = |x: f64| if c.loss_reduction == LossReduction::Sum { x } else { mean(m, x, p.len()) };
    let one = |(p, t): (&f64, &f64)| {
        let limited = m.sub(*p, *t).max(-delta).min(delta);
        let slope = if c.huber_slope == HuberSlope::One { m.div(limited, delta) } else { limited };
        if m.stable { over(m.mul(g, slope)) } else { m.mul(over(g), slope) }
    };
    vjp(a, p.iter().zip(&t).map(one).collect())
}

/// sqrt(d^2 + eps^2); in the first way of a rounded square, in the second of a square of the rounded number.
pub(super) fn rooted<O: Operations>(
    o: &O,
    p: &f64,
    t: &f64,
    eps: f64,
    c: &Conventions,
    way: u64,
) -> O::Number {
    let d = o.sub(o.exact(*p), o.exact(*t));
    o.sqrt(o.add(o.mul(d, d), added(o, eps, c, way)))
}

/// What stands beside the square.
fn added<O: Operations>(o: &O, eps: f64, c: &Conventions, way: u64) -> O::Number {
    match c.charbonnier_eps {
        CharbonnierEps::AsGiven => o.hyper(eps),
        CharbonnierEps::Square if way % 2 == 0 => o.hyper(eps * eps),
        CharbonnierEps::Square => o.mul(o.hyper(eps), o.hyper(eps)),
    }
}

/// The slope, by a division of d or by the inverse root, and the cotangent before it or behind.
pub(super) fn charbonnier_slope<O: Operations>(
    o: &O,
    [p, t]: [f64; 2],
    eps: f64,
    c: &Conventions,
    [g, n]: [f64; 2],
    way: u64,
) -> O::Number {
    let d = o.sub(o.exact(p), o.exact(t));
    let root = rooted(o, &p, &t, eps, c, way);
    let over = |x| if c.loss_reduction == LossReduction::Sum { x } else { o.div(x, o.exact(n)) };
    if way / 2 % 2 == 0 {
        over(o.mul(o.exact(g), o.div(d, root)))
    } else {
        o.mul(o.mul(over(o.exact(g)), o.div(o.exact(1.0), root)), d)
    }
}

/// Charbonnier's loss.
pub(crate) fn charbonnier(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let ([p, t], eps) = (pair(a), number(a, "eps"));
    let terms: Vec<f64> = p.iter().zip(&t).map(|(p, t)| rooted(m, p, t, eps, c, m.form)).collect();
    forward(reduced(m, &terms, c))
}

/// Its gradient.
pub(crate) fn charbonnier_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let ([p, t], eps, g) = (pair(a), number(a, "eps"), number(a, "grad_value"));
    let n = p.len() as f64;
    vjp(a, p.iter().zip(&t).map(|(p, t)| charbonnier_slope(m, [*p, *t], eps, c, [g, n], m.form)).collect())
}
