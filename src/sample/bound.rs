//! Error bounds of samples, in running error analysis.
//!
//! Covered: t from the sample's number, from an edge (counted from near, from far, or interpolated between them) plus jitter, between
//! two edges by their difference or by weights; all hyper-parameters rounded first.

use crate::camera::bound::{any_order, hyper};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, array, arrays, number, row, size, threes};
use crate::contract::bounded::{Bounded, exact};
use crate::convention::{Conventions, Delta, Grid, LastDelta};

/// The interval [near, far] that all rays share.
struct Interval<'a> {
    near: Bounded,
    far: Bounded,
    m: &'a Arithmetic,
}

impl<'a> Interval<'a> {
    fn new(a: &Arrays, m: &'a Arithmetic) -> Self {
        Interval { near: hyper(number(a, "near"), m), far: hyper(number(a, "far"), m), m }
    }

    /// (far - near) / cells.
    fn width(&self, cells: f64) -> Bounded {
        self.m.div(self.m.sub(self.far, self.near), hyper(cells, self.m))
    }

    /// near + a (far - near) / cells, in any of its forms. `a` may be half-way between two edges: their mean.
    fn edge(&self, a: f64, cells: f64) -> Bounded {
        let m = self.m;
        let (count, s) = (hyper(a, m), m.div(hyper(a, m), hyper(cells, m)));
        let edge = m
            .add(self.near, m.mul(count, self.width(cells)))
            .or(m.sub(self.far, m.mul(hyper(cells - a, m), self.width(cells))))
            .or(self.between(self.near, self.far, s));
        if a == libm::floor(a) {
            edge
        } else {
            edge.widened(2.0 * m.u * (self.near.size() + self.far.size()))
        }
    }

    /// lower + s (upper - lower), or lower (1 - s) + upper s.
    fn between(&self, lower: Bounded, upper: Bounded, s: Bounded) -> Bounded {
        let m = self.m;
        let weighted = m.add(m.mul(lower, m.sub(exact(1.0), s)), m.mul(upper, s));
        m.add(lower, m.mul(s, m.sub(upper, lower))).or(weighted)
    }

    /// t_i, where `cells` intervals divide [near, far] and u in [0, 1) moves it from edge a to edge a + w.
    fn position(&self, a: f64, w: f64, u: f64, cells: f64) -> Bounded {
        let m = self.m;
        let (u, width) = (exact(u), self.width(cells));
        let (lower, upper) = (self.edge(a, cells), self.edge(a + w, cells));
        let number = m.add(hyper(a, m), m.mul(u, exact(w)));
        m.add(self.near, m.mul(number, width))
            .or(self.between(self.near, self.far, m.div(number, hyper(cells, m))))
            .or(m.add(lower, m.mul(u, m.mul(exact(w), width))))
            .or(self.between(lower, upper, u))
    }

    fn sample(&self, i: usize, n: usize, u: f64, grid: Grid) -> Bounded {
        let (m, i, last) = (self.m, i as f64, n as f64 - 1.0);
        let jitter = m.mul(exact(u), self.width(n as f64));
        match grid {
            Grid::Intervals => self.position(i, 1.0, u, n as f64),
            Grid::EndsPlusWidth if n == 1 => m.add(self.near, jitter),
            Grid::EndsPlusWidth => m.add(self.edge(i, last), jitter),
            _ if n == 1 => self.near,
            Grid::EndsPlusSpacing => self.position(i, 1.0, u, last),
            Grid::EndsBetweenMidpoints => {
                let (lower, upper) = ((i - 0.5).max(0.0), (i + 0.5).min(last));
                self.position(lower, upper - lower, u, last)
            }
        }
    }
}

/// Bound of positions and points.
pub(crate) fn sample_along_rays(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let interval = Interval::new(a, m);
    let (rays, samples) = size(a, "u");
    let (o, d) = (threes(a, "rays_o"), threes(a, "rays_d"));
    let (mut t, mut points) = (vec![], vec![]);
    for r in 0..rays {
        for (i, u) in row(a, "u", r).into_iter().enumerate() {
            let at = interval.sample(i, samples, u, c.grid);
            t.push(at.e);
            points.extend((0..3).map(|k| m.add(exact(o[r][k]), m.mul(at, exact(d[r][k]))).e));
        }
    }
    arrays([("t", array(&[rays, samples], t)), ("points", array(&[rays, samples, 3], points))])
}

/// Bound of [`super::step_sizes`]: the mean of the differences is their sum over n - 1, or the last t minus the first.
pub(crate) fn step_sizes(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let interval = Interval::new(a, m);
    let (rays, samples) = size(a, "t");
    let width = interval.width(samples as f64);
    let mut deltas = vec![];
    for r in 0..rays {
        let t: Vec<Bounded> = row(a, "t", r).into_iter().map(exact).collect();
        if c.delta == Delta::Width || samples == 0 {
            deltas.extend(vec![width.e; samples]);
            continue;
        }
        if c.delta == Delta::Midpoints {
            let edge = |i: usize| match i {
                0 => interval.near,
                i if i == samples => interval.far,
                // (a + b) / 2 or a + (b - a) / 2.
                i => m
                    .mul(exact(0.5), m.add(t[i - 1], t[i]))
                    .or(m.add(t[i - 1], m.mul(exact(0.5), m.sub(t[i], t[i - 1])))),
            };
            deltas.extend((0..samples).map(|i| m.sub(edge(i + 1), edge(i)).e));
            continue;
        }
        let differences: Vec<Bounded> = t.windows(2).map(|t| m.sub(t[1], t[0])).collect();
        if c.delta == Delta::Central {
            let (half, last) = (exact(0.5), samples - 1);
            deltas.extend((0..samples).map(|i| match i {
                0 if last == 0 => width.e,
                0 => differences[0].e,
                i if i == last => differences[last - 1].e,
                // The middle of one gap less that of the other, half of both gaps, or of their sum.
                i => {
                    let middle = |i: usize| m.mul(half, m.add(t[i], t[i + 1]));
                    let gaps = m.mul(half, m.add(differences[i - 1], differences[i]));
                    let ends = m.mul(half, m.sub(t[i + 1], t[i - 1]));
                    ends.or(gaps).or(m.sub(middle(i), middle(i - 1))).e
                }
            }));
            continue;
        }
        let last = match c.last_delta {
            LastDelta::Width => width,
            LastDelta::Repeated => differences.last().copied().unwrap_or(width),
            LastDelta::Mean if samples == 1 => width,
            LastDelta::Mean => {
                let count = hyper(samples as f64 - 1.0, m);
                let ends = m.sub(t[samples - 1], t[0]);
                m.div(any_order(&differences, m), count).or(m.div(ends, count))
            }
            LastDelta::TenToTen => hyper(1e10, m),
            LastDelta::TenToNine => hyper(1e9, m),
            LastDelta::Thousandth => hyper(1e-3, m),
            LastDelta::ToFar => m.sub(interval.far, t[samples - 1]),
        };
        deltas.extend(differences.iter().chain([&last]).map(|delta| delta.e));
    }
    arrays([("deltas", array(&[rays, samples], deltas))])
}
