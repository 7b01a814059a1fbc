//! Honest rays and boxes in emulated arithmetic: divided, or multiplied by the inverse; faces by sign, or sorted.

use super::arrays::{RayAndBox, forward, outputs, vjp};
use super::{Hit, arrays};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::Conventions;

/// The interval with the axes that determine its ends (3: near or far).
fn stretch(q: &RayAndBox, m: &Machine) -> Option<(Hit, [usize; 2])> {
    let mut hit = Hit { enter: m.round(q.near), leave: m.round(q.far) };
    let mut axes = [3, 3];
    for a in 0..3 {
        if q.d[a] == 0.0 {
            if q.o[a] < q.low[a] || q.o[a] > q.high[a] {
                return None;
            }
            continue;
        }
        let t = |face: f64| match m.form % 2 {
            0 => m.div(m.sub(face, q.o[a]), q.d[a]),
            _ => m.mul(m.sub(face, q.o[a]), m.div(1.0, q.d[a])),
        };
        let (low, high) = (t(q.low[a]), t(q.high[a]));
        let by_sign = if q.d[a] > 0.0 { (low, high) } else { (high, low) };
        let (first, last) = if m.form / 2 % 2 == 0 { (low.min(high), low.max(high)) } else { by_sign };
        if first > hit.enter {
            (hit.enter, axes[0]) = (first, a);
        }
        if last < hit.leave {
            (hit.leave, axes[1]) = (last, a);
        }
    }
    (hit.enter <= hit.leave).then_some((hit, axes))
}

/// Where rays enter and leave a box. The t of a miss are arbitrary.
pub(crate) fn ray_aabb(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let miss = [arrays::rays_and_boxes(a)[0].far, 0.0, f64::INFINITY][(m.form % 3) as usize];
    forward(a, |q| outputs(stretch(q, m).map(|(hit, _)| hit), miss))
}

/// Their gradient.
pub(crate) fn ray_aabb_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |q, g| {
        let mut terms: [[Vec<f64>; 3]; 2] = Default::default();
        if let Some((hit, axes)) = stretch(q, m) {
            for (axis, t, g) in [(axes[0], hit.enter, g.enter), (axes[1], hit.leave, g.leave)] {
                if axis == 3 {
                    continue;
                }
                let over = |x: f64| match m.form % 2 {
                    0 => m.div(x, q.d[axis]),
                    _ => m.mul(x, m.div(1.0, q.d[axis])),
                };
                terms[0][axis].push(-over(g));
                terms[1][axis].push(if m.form % 3 == 0 { -over(m.mul(g, t)) } else { -m.mul(over(g), t) });
            }
        }
        terms.map(|side| side.map(|terms| m.sum(&terms)))
    })
}
