//! Error bounds of the distortion loss: the definition in grade A; the form by running sums, which cancels far from 0, in grade B.

use super::arrays::{forward, vjp};
use crate::camera::bound::any_order;
use crate::contract::arithmetic::{Arithmetic, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, exact};
use crate::convention::Conventions;

/// A ray as a program has it.
struct Ray {
    w: Vec<Bounded>,
    /// Middles and lengths of the intervals.
    middle: Vec<Bounded>,
    length: Vec<Bounded>,
    third: Bounded,
}

impl Ray {
    fn new(weights: &[f64], t: &[f64], m: &Arithmetic) -> Ray {
        let half = |ends: &[f64]| m.mul(exact(0.5), m.add(exact(ends[0]), exact(ends[1])));
        Ray {
            w: weights.iter().copied().map(exact).collect(),
            middle: t.windows(2).map(half).collect(),
            length: t.windows(2).map(|ends| m.sub(exact(ends[1]), exact(ends[0]))).collect(),
            third: m.div(exact(1.0), exact(3.0)),
        }
    }

    /// |m_i - m_j|.
    fn distance(&self, i: usize, j: usize, m: &Arithmetic) -> Bounded {
        let apart = m.sub(self.middle[i], self.middle[j]);
        if apart.y < 0.0 { apart.neg() } else { apart }
    }

    /// sum_j w_j |m_i - m_j|.
    fn apart(&self, i: usize, m: &Arithmetic) -> Bounded {
        let term = |j: usize| if i == j { exact(0.0) } else { m.mul(self.w[j], self.distance(i, j, m)) };
        any_order(&(0..self.w.len()).map(term).collect::<Vec<_>>(), m)
    }

    /// w_i^2 delta_i / 3.
    fn own(&self, i: usize, m: &Arithmetic) -> Bounded {
        m.mul(m.mul(m.mul(self.w[i], self.w[i]), self.length[i]), self.third)
    }

    /// sum w_j and sum w_j m_j over some intervals.
    fn running(&self, range: std::ops::Range<usize>, m: &Arithmetic) -> (Bounded, Bounded) {
        let moments: Vec<Bounded> = range.clone().map(|j| m.mul(self.w[j], self.middle[j])).collect();
        (any_order(&self.w[range], m), any_order(&moments, m))
    }

    /// The same as [`Self::apart`], of those in front of i alone, by running sums; with or without what is at i in both.
    fn in_front(&self, i: usize, m: &Arithmetic) -> Bounded {
        let by = |end: usize| {
            let (weight, moment) = self.running(0..end, m);
            m.sub(m.mul(self.middle[i], weight), moment)
        };
        Bounded { y: by(i).y, e: by(i).e.max(by(i + 1).e) }
    }

    /// The loss.
    fn loss(&self, m: &Arithmetic) -> Bounded {
        let all = 0..self.w.len();
        let own: Vec<Bounded> = all.clone().map(|i| self.own(i, m)).collect();
        let total = |between: Vec<Bounded>, factor: f64| {
            let between = m.mul(exact(factor), any_order(&between, m));
            let summed = m.add(between, any_order(&own, m));
            summed.or(any_order(&[&[between], &own[..]].concat(), m))
        };
        let pairs = total(all.clone().map(|i| m.mul(self.w[i], self.apart(i, m))).collect(), 1.0);
        if m.grade == Grade::A {
            return pairs;
        }
        pairs.or(total(all.map(|i| m.mul(self.w[i], self.in_front(i, m))).collect(), 2.0))
    }

    /// Gradients of the weights and of the edges.
    fn gradients(&self, g: f64, m: &Arithmetic) -> (Vec<Bounded>, Vec<Bounded>) {
        let (n, g, two) = (self.w.len(), exact(g), exact(2.0));
        let (mut g_w, mut parts) = (vec![], vec![vec![]; n + 1]);
        for i in 0..n {
            let own = m.mul(m.mul(two, self.third), m.mul(self.w[i], self.length[i]));
            let pairs = m.add(m.mul(two, self.apart(i, m)), own);
            let mut total = m.mul(g, pairs);
            if m.grade == Grade::B {
                // The light in front and that behind, each by running sums.
                let (weight, moment) = self.running(i + 1..n, m);
                let behind = m.sub(moment, m.mul(self.middle[i], weight));
                let both = m.add(self.in_front(i, m), behind);
                total = total.or(m.mul(g, m.add(m.mul(two, both), own)));
            }
            g_w.push(total);
            let (a, b) =
                (m.mul(g, self.ahead(i, m)), m.mul(g, m.mul(m.mul(self.w[i], self.w[i]), self.third)));
            parts[i].extend([a, b.neg()]);
            parts[i + 1].extend([a, b]);
        }
        (g_w, parts.iter().map(|parts| any_order(parts, m)).collect())
    }

    /// w_i sum_j w_j sign(m_i - m_j); where middles meet, or may by rounding, the sign is anything between -1 and 1.
    fn ahead(&self, i: usize, m: &Arithmetic) -> Bounded {
        let sign = |j: usize| {
            let apart = m.sub(self.middle[i], self.middle[j]);
            let y = if apart.y > 0.0 {
                1.0
            } else if apart.y < 0.0 {
                -1.0
            } else {
                0.0
            };
            let open = i != j && apart.y.abs() <= apart.e;
            Bounded { y, e: if open { 1.0 + y.abs() } else { 0.0 } }
        };
        let terms: Vec<Bounded> = (0..self.w.len()).map(|j| m.mul(self.w[j], sign(j))).collect();
        m.mul(self.w[i], any_order(&terms, m))
    }
}

/// Bound of [`super::distortion`].
pub(crate) fn distortion(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    forward(a, |weights, t| Ray::new(weights, t, m).loss(m).e)
}

/// Bound of [`super::backward::distortion`].
pub(crate) fn distortion_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    vjp(a, |weights, t, g| {
        let (g_weights, g_t) = Ray::new(weights, t, m).gradients(g, m);
        (g_weights.iter().map(|g| g.e).collect(), g_t.iter().map(|g| g.e).collect())
    })
}
