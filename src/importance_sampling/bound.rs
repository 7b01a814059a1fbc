//! Error bounds of importance sampling.
//!
//! All terms of the sums that make up F are positive, so every honest F has a relative error of at most gamma, at the edges and between
//! them. An honest sample then solves F(t) = u for a u with the same relative error: it lies between the inverses of the two ends of
//! that interval, from the left and from the right. Where F is constant (bins without weight) these are far apart, and all answers in
//! between are admissible. Errors local to the bin are added.

use super::arrays::{Ray, drawn, forward, vjp};
use super::{SNAPPED, cdf};
use crate::camera::bound::{any_order, hyper};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, exact, gamma};
use crate::convention::Conventions;

/// Roundings of one weight on its way into F: padding, its sum, the total, the quotient, the product with u.
const ROUNDINGS: f64 = 6.0;

/// A ray's distribution, and the error of an honest one.
struct Distribution<'a> {
    ray: &'a Ray,
    f: Vec<f64>,
    /// Relative error of F.
    relative: f64,
    /// Absolute error of F, from flushing to zero.
    absolute: f64,
    /// Sum of the padded weights, at most 1: implementations need not divide by it.
    total: f64,
    /// What shares below [`SNAPPED`] count as.
    faint: Option<f64>,
    m: &'a Arithmetic,
}

/// The bins in which honest samples may lie, and the interval.
struct Reach {
    low: f64,
    high: f64,
    bins: [usize; 2],
    /// Whether it is one bin, inside [0, 1]: neither a kink nor the end of the domain.
    smooth: bool,
}

impl<'a> Distribution<'a> {
    fn new(ray: &'a Ray, c: &Conventions, m: &'a Arithmetic) -> Self {
        let n = ray.weights.len() as f64;
        let f = cdf(&ray.weights, ray.padding);
        let relative = gamma(2.0 * n, m.u_sum) + gamma(ROUNDINGS, m.u);
        let total: f64 = ray.weights.iter().map(|w| w + ray.padding).sum();
        let scale = if total > 0.0 { 1.0 + 1.0 / total } else { 1.0 };
        let absolute = 2.0 * (n + 4.0) * m.tiny * scale;
        let total = if total > 0.0 { total.min(1.0) } else { 1.0 };
        Distribution { ray, f, relative, absolute, total, faint: c.pdf_division.faint(), m }
    }

    fn reach(&self, u: f64) -> Reach {
        let low = u / (1.0 + self.relative) - self.absolute;
        let high = if self.relative < 1.0 { u / (1.0 - self.relative) + self.absolute } else { 1.0 };
        let last = self.ray.weights.len() - 1;
        // From the left: the first bin that ends at or above. u = 0 is exact, and so is F before the first weight.
        let first = match u {
            0.0 => super::bin_of(&self.f, 0.0),
            _ => (0..last).find(|&k| self.f[k + 1] >= low).unwrap_or(last),
        };
        // From the right: the last bin that begins at or below.
        let end = (0..=last).rev().find(|&k| self.f[k] <= high).unwrap_or(0).max(first);
        let (edges, ended) = (&self.ray.edges, high >= 1.0);
        Reach {
            low: if low <= 0.0 { edges[first] } else { self.at(first, low) },
            high: if ended { edges[last + 1] } else { self.at(end, high) },
            bins: [first, if ended { last } else { end }],
            smooth: first == end && !ended,
        }
    }

    /// The t in bin k where F is u.
    fn at(&self, k: usize, u: f64) -> f64 {
        let (edges, f) = (&self.ray.edges, &self.f);
        let s = if f[k + 1] > f[k] { ((u - f[k]) / (f[k + 1] - f[k])).clamp(0.0, 1.0) } else { 0.0 };
        edges[k] + s * (edges[k + 1] - edges[k])
    }

    /// The error of t = a + s (b - a), a (1 - s) + b s or a + (u - F) ((b - a) / p), in any of the bins.
    fn local(&self, [first, last]: [usize; 2]) -> f64 {
        let (m, edges) = (self.m, &self.ray.edges[first..=last + 1]);
        let largest = edges.iter().fold(0.0, |max: f64, e| max.max(e.abs()));
        let widest = edges.windows(2).fold(0.0, |max: f64, e| max.max(e[1] - e[0]));
        largest * gamma(3.0, m.u) + widest * gamma(6.0, m.u) + 4.0 * m.tiny * (1.0 + widest)
    }

    /// Whether a division by the weight of one of these bins may leave the type: the weight may be flushed to zero, or the bin's
    /// width over it may overflow.
    fn overflows(&self, [first, last]: [usize; 2]) -> bool {
        (first..=last).any(|k| {
            let (weight, width) =
                ((self.f[k + 1] - self.f[k]) * self.total, self.ray.edges[k + 1] - self.ray.edges[k]);
            weight > 0.0 && (weight < 2.0 * self.m.tiny || width / weight > 0.5 * self.m.largest)
        })
    }

    fn error(&self, u: f64, t: f64) -> f64 {
        let reach = self.reach(u);
        if self.overflows(reach.bins) {
            return f64::INFINITY;
        }
        let [low, high] = self.snapped_too(u, reach.bins, [reach.low, reach.high]);
        let e = (t - low).max(high - t).max(0.0) + self.local(reach.bins);
        if t.abs() + e > self.m.largest { f64::INFINITY } else { e }
    }

    /// Whether an honest machine may take a bin's share for another number, and whether all do.
    fn snaps(&self, k: usize) -> (bool, bool) {
        let (share, _) = self.inside(k, 0.0);
        let limit = SNAPPED * (1.0 + self.m.u);
        let on = self.faint.is_some();
        (on && share.y - share.e < limit, on && share.y + share.e < SNAPPED * (1.0 - self.m.u))
    }

    /// The interval of answers where some of these bins' shares may count as another number.
    fn snapped_too(&self, u: f64, [first, last]: [usize; 2], as_it_is: [f64; 2]) -> [f64; 2] {
        let bins = first..=last;
        let all = bins.clone().all(|k| self.snaps(k).1);
        let mut answers = if all { [f64::INFINITY, f64::NEG_INFINITY] } else { as_it_is };
        for k in bins.filter(|k| self.snaps(*k).0) {
            let (edges, (share, _)) = (&self.ray.edges, self.inside(k, 0.0));
            let (width, place) = (edges[k + 1] - edges[k], (u - self.f[k]).clamp(0.0, share.y));
            let at = |place: f64| edges[k] + place / self.faint.unwrap_or(1.0) * width;
            answers = [answers[0].min(at(place - share.e)), answers[1].max(at(place + share.e))];
        }
        answers
    }

    /// F_{k+1} - F_k, and s inside the bin.
    fn inside(&self, k: usize, u: f64) -> (Bounded, Bounded) {
        let (m, [a, b]) = (self.m, [self.f[k], self.f[k + 1]].map(|f| self.honest(f)));
        let weight = m.sub(b, a);
        let s = m.div(m.sub(exact(u), a), weight);
        (weight, s)
    }

    fn honest(&self, f: f64) -> Bounded {
        // 0 before the first weight is exact.
        if f == 0.0 { exact(0.0) } else { Bounded { y: f, e: f * self.relative + self.absolute } }
    }
}

/// Bound of [`super::sample`].
pub(crate) fn sample(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    forward(a, c, |ray| {
        let d = Distribution::new(ray, c, m);
        ray.u.iter().zip(drawn(ray, c)).map(|(&u, t)| d.error(u, t)).collect()
    })
}

/// Bound of [`super::backward::sample`]. At a kink any slope dt / du is admissible, and each edge next to the sample may get any
/// share of the cotangent; so may each of several edges in one place, of what they get together.
pub(crate) fn sample_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    vjp(a, c, |ray, g| {
        let d = Distribution::new(ray, c, m);
        let mut terms: Vec<Vec<Bounded>> = vec![vec![]; ray.edges.len()];
        let mut g_u = vec![];
        for (&u, &g) in ray.u.iter().zip(g) {
            let reach = d.reach(u);
            let k = super::bin_of(&d.f, u);
            let (perhaps, surely) = d.snaps(k);
            if !reach.smooth || perhaps != surely {
                let share = Bounded { y: 0.5 * g, e: 0.5 * g.abs() };
                // The sum rounds for any shares of its terms.
                let [first, last] = reach.bins;
                terms[first.min(k)..=last.max(k) + 1].iter_mut().for_each(|t| t.push(share.widened(g.abs())));
                g_u.push(f64::INFINITY);
                continue;
            }
            let (mut weight, mut s) = d.inside(k, u);
            if surely {
                weight = hyper(d.faint.unwrap_or(1.0), m);
                s = m.div(m.sub(exact(u), d.honest(d.f[k])), weight);
            }
            let width = m.sub(exact(ray.edges[k + 1]), exact(ray.edges[k]));
            terms[k].push(m.mul(exact(g), m.sub(exact(1.0), s)));
            // Through the lerp a + s (b - a), the gradient of a is a difference too.
            terms[k + 1].push(m.mul(exact(g), s));
            let slope = m.div(m.mul(exact(g), width), weight);
            g_u.push(slope.or(m.mul(exact(g), m.div(width, weight))).e);
        }
        let alone = terms.iter().map(|terms| any_order(terms, m).e);
        let shared = (0..terms.len()).map(|k| shared_at(&ray.edges, k, &terms));
        (alone.zip(shared).map(|(alone, shared)| alone + shared).collect(), g_u)
    })
}

/// What edge k shares with others in the same place. Whoever finds a bin's edges as the largest edge below and the smallest above has
/// chosen among equals, and by which of them the result moves is nobody's to say.
fn shared_at(edges: &[f64], k: usize, terms: &[Vec<Bounded>]) -> f64 {
    let here: Vec<usize> = (0..edges.len()).filter(|&n| edges[n] == edges[k]).collect();
    if here.len() == 1 {
        return 0.0;
    }
    here.iter().flat_map(|&n| &terms[n]).map(|term| term.y.abs() + term.e).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::arithmetic::{Dtype, Grade};
    use crate::contract::arrays::{array, arrays, scalar};
    use crate::convention::CS180;

    /// Edges 1 and 2 are one: any shares of what they get together are admissible, and no more; the others have their own.
    #[test]
    fn sa3_edges_in_one_place_share_their_gradient() {
        let a = arrays([
            ("edges", array(&[1, 4], vec![2.0, 3.0, 3.0, 4.5])),
            ("weights", array(&[1, 3], vec![1.0, 2.0, 1.0])),
            ("padding", scalar(0.0)),
            ("u", array(&[1, 3], vec![0.125, 0.40625, 0.9375])),
            ("grad_t", array(&[1, 3], vec![1.0, 0.5, 2.0])),
        ]);
        let bound = sample_vjp(&a, &CS180, &Arithmetic::new(Dtype::F64, Grade::B));
        let shared = 0.5 + 0.5 + 0.5;
        let e = &bound["grad_edges"];
        assert!(e[[0, 0]] < 1e-12 && e[[0, 3]] < 1e-12, "{e:?}");
        for k in [1, 2] {
            assert!(e[[0, k]] > shared && e[[0, k]] < shared + 1e-12, "{e:?}");
        }
    }
}
