//! Error bounds of rays and boxes.
//!
//! Whether a ray hits is certain where the two ends are further apart than their errors; otherwise either answer is admissible. On a
//! miss there is no t, and any is admissible.

use super::arrays::{RayAndBox, forward, vjp};
use crate::camera::bound::{any_order, hyper};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, exact};
use crate::convention::Conventions;

/// An end of the interval: its candidates, by axis, and near or far.
struct End {
    /// (axis, t), without those of infinite t.
    candidates: Vec<(usize, Bounded)>,
    limit: Bounded,
    /// 1 for the largest of the candidates, -1 for the smallest.
    sign: f64,
}

impl End {
    /// The interval of the extreme of all honest candidates.
    fn interval(&self) -> [f64; 2] {
        let all = || self.candidates.iter().map(|(_, t)| t).chain([&self.limit]);
        let extreme = |side: f64| {
            let each = all().map(|t| self.sign * (t.y + side * t.e));
            self.sign * each.fold(f64::NEG_INFINITY, f64::max)
        };
        [extreme(-1.0), extreme(1.0)]
    }

    /// The only candidate that can be the end; `None` if it is near or far; an error if several can.
    fn decider(&self) -> Result<Option<(usize, Bounded)>, ()> {
        let [low, high] = self.interval();
        let worst = if self.sign > 0.0 { low } else { high };
        let able = |t: &Bounded| self.sign * t.y + t.e >= self.sign * worst;
        let axes: Vec<_> = self.candidates.iter().filter(|(_, t)| able(t)).collect();
        match (axes.len(), able(&self.limit)) {
            (0, _) => Ok(None),
            (1, false) => Ok(Some(*axes[0])),
            _ => Err(()),
        }
    }
}

/// Both ends; `None` if the ray is parallel to a slab and outside of it, which no rounding can change.
fn ends(q: &RayAndBox, m: &Arithmetic) -> Option<[End; 2]> {
    let end = |limit, sign| End { candidates: vec![], limit: hyper(limit, m), sign };
    let (mut enter, mut leave) = (end(q.near, 1.0), end(q.far, -1.0));
    for a in 0..3 {
        if q.d[a] == 0.0 {
            if q.o[a] < q.low[a] || q.o[a] > q.high[a] {
                return None;
            }
            continue;
        }
        let t = |face: f64| {
            let (way, d) = (m.sub(exact(face), exact(q.o[a])), exact(q.d[a]));
            m.div(way, d).or(m.mul(way, m.div(exact(1.0), d)))
        };
        let (low, high) = (t(q.low[a]), t(q.high[a]));
        let (first, last) = if q.d[a] > 0.0 { (low, high) } else { (high, low) };
        enter.candidates.push((a, first));
        leave.candidates.push((a, last));
    }
    Some([enter, leave])
}

/// Whether the ray certainly hits, certainly misses, or may do either.
fn decided(ends: &Option<[End; 2]>) -> Option<bool> {
    let Some([enter, leave]) = ends else { return Some(false) };
    let ([enter_low, enter_high], [leave_low, leave_high]) = (enter.interval(), leave.interval());
    match () {
        _ if enter_high <= leave_low => Some(true),
        _ if enter_low > leave_high => Some(false),
        _ => None,
    }
}

/// Bound of [`super::between`].
pub(crate) fn ray_aabb(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    forward(a, |q| {
        let ends = ends(q, m);
        let (Some(hit), Some([enter, leave])) = (decided(&ends), &ends) else {
            let undecided = f64::from(u8::from(ends.is_some()));
            return [f64::INFINITY, f64::INFINITY, undecided];
        };
        if !hit {
            return [f64::INFINITY, f64::INFINITY, 0.0];
        }
        let error = |end: &End, y: f64| {
            let [low, high] = end.interval();
            (y - low).max(high - y)
        };
        let line = super::between(q.o, q.d, q.low, q.high, q.near, q.far).expect("a hit, decided");
        [error(enter, line.enter), error(leave, line.leave), 0.0]
    })
}

/// Bound of [`super::backward::between`]: infinite on a miss, which has no t to differentiate, and where two axes, or an axis and near
/// or far, may determine an end.
pub(crate) fn ray_aabb_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    vjp(a, |q, g| {
        let ends = ends(q, m);
        let unknown = [[f64::INFINITY; 3]; 2];
        let (Some(true), Some(ends)) = (decided(&ends), ends) else { return unknown };
        let mut terms: [[Vec<Bounded>; 3]; 2] = Default::default();
        for (end, g) in ends.iter().zip([g.enter, g.leave]) {
            let Ok(decider) = end.decider() else { return unknown };
            let Some((axis, t)) = decider else { continue };
            let (g, d) = (exact(g), exact(q.d[axis]));
            let inverse = m.div(exact(1.0), d);
            let share = m.div(g, d).or(m.mul(g, inverse));
            terms[0][axis].push(share);
            terms[1][axis].push(m.mul(share, t).or(m.div(m.mul(g, t), d)).or(m.mul(m.mul(g, t), inverse)));
        }
        terms.map(|side| side.map(|terms| any_order(&terms, m).e))
    })
}
