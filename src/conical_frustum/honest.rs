//! Honest Gaussians of frustums: mip-NeRF's middle and half width, multinerf's ratio, polynomials of it; the axis' part across the ray as
//! 1 - d_i^2 / |d|^2, by the other two, or with d / |d|^2; gradients of each, as automatic differentiation has them, and by hand.

use super::arrays::{cotangents, forward, frustums, vjp};
use super::{Frustum, Gaussian};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::convention::{Conventions, RayShape};

/// The number of ways.
pub(super) const WAYS: u64 = 9;

/// A frustum in some arithmetic, on one of the ways.
pub(super) struct Ways<'a, O: Operations> {
    o: &'a O,
    f: &'a Frustum,
    shape: RayShape,
    way: u64,
    /// start + end, or half of it.
    s: O::Number,
    /// end - start, or half of it.
    d: O::Number,
    /// Their squares.
    ss: O::Number,
    dd: O::Number,
    /// 3 s^2 + d^2.
    sum: O::Number,
}

/// Moments along a ray: mean and variance of t, variance across over the squared radius.
type Moments<N> = [N; 3];

/// Outputs in the order of the contract.
pub(super) struct Numbers<N> {
    pub(super) moments: Moments<N>,
    pub(super) mean: [N; 3],
    pub(super) variance: [N; 3],
}

/// Gradients in the order of the contract.
pub(super) struct Gradients<N> {
    pub(super) origin: [N; 3],
    pub(super) direction: [N; 3],
    pub(super) radius: N,
    pub(super) start: N,
    pub(super) end: N,
}

impl<'a, O: Operations> Ways<'a, O> {
    pub(super) fn new(o: &'a O, f: &'a Frustum, shape: RayShape, way: u64) -> Self {
        let (start, end) = (o.exact(f.start), o.exact(f.end));
        let (mut s, mut d) = (o.add(start, end), o.sub(end, start));
        if way % 3 == 0 {
            (s, d) = (o.times(0.5, s), o.times(0.5, d));
        }
        let (ss, dd) = (o.mul(s, s), o.mul(d, d));
        let sum = o.add(o.times(3.0, ss), dd);
        Ways { o, f, shape, way, s, d, ss, dd, sum }
    }

    /// q; 0 of an interval without length.
    fn ratio(&self) -> O::Number {
        if self.f.start == self.f.end { self.o.exact(0.0) } else { self.o.div(self.dd, self.sum) }
    }

    /// x / y, where an interval without length has none of x.
    fn part(&self, x: O::Number, y: O::Number) -> O::Number {
        if self.f.start == self.f.end { self.o.exact(0.0) } else { self.o.div(x, y) }
    }

    /// c[0] + c[1] q + ..., from the last to the first.
    fn polynomial(&self, q: O::Number, coefficients: &[f64]) -> O::Number {
        let o = self.o;
        let (last, others) = coefficients.split_last().expect("coefficients");
        others.iter().rev().fold(o.hyper(*last), |sum, c| o.add(o.mul(sum, q), o.hyper(*c)))
    }

    fn moments(&self) -> Moments<O::Number> {
        let (o, s, ss, dd) = (self.o, self.s, self.ss, self.dd);
        if self.shape == RayShape::Cylinder {
            return if self.way % 3 == 0 {
                [s, o.div(dd, o.exact(3.0)), o.exact(0.25)]
            } else {
                [o.times(0.5, s), o.div(dd, o.exact(12.0)), o.exact(0.25)]
            };
        }
        match self.way % 3 {
            0 => {
                let ddd = o.mul(dd, dd);
                let mean = o.add(s, self.part(o.times(2.0, o.mul(s, dd)), self.sum));
                let outer = o.sub(o.times(12.0, ss), dd);
                let less =
                    o.mul(o.hyper(4.0 / 15.0), self.part(o.mul(ddd, outer), o.mul(self.sum, self.sum)));
                let along = o.sub(o.div(dd, o.exact(3.0)), less);
                let across = o.sub(
                    o.add(o.times(0.25, ss), o.mul(o.hyper(5.0 / 12.0), dd)),
                    o.mul(o.hyper(4.0 / 15.0), self.part(ddd, self.sum)),
                );
                [mean, along, across]
            }
            1 => {
                let q = self.ratio();
                let mean = o.mul(s, o.add(o.exact(0.5), q));
                let outer = o.sub(o.times(12.0, ss), dd);
                let less = o.mul(o.hyper(1.0 / 15.0), o.mul(o.mul(q, q), outer));
                let along = o.sub(o.mul(o.hyper(1.0 / 12.0), dd), less);
                let inner = o.sub(o.hyper(5.0 / 48.0), o.mul(o.hyper(1.0 / 15.0), q));
                [mean, along, o.add(o.times(1.0 / 16.0, ss), o.mul(dd, inner))]
            }
            _ => {
                let q = self.ratio();
                let mean = o.add(o.times(0.5, s), o.mul(s, q));
                let along = o.div(o.mul(dd, self.polynomial(q, &[5.0, -16.0, 20.0])), o.exact(60.0));
                let inner = o.sub(o.hyper(5.0 / 48.0), o.div(q, o.exact(15.0)));
                [mean, along, o.add(o.div(ss, o.exact(16.0)), o.mul(dd, inner))]
            }
        }
    }

    fn direction(&self) -> [O::Number; 3] {
        self.f.direction.map(|x| self.o.exact(x))
    }

    /// |d|^2.
    fn length(&self) -> O::Number {
        self.o.dot(&self.direction(), &self.direction())
    }

    /// n_i.
    fn across(&self) -> [O::Number; 3] {
        let (o, v, length) = (self.o, self.direction(), self.length());
        [0, 1, 2].map(|i| match self.way / 3 {
            0 => o.sub(o.exact(1.0), o.div(o.mul(v[i], v[i]), length)),
            1 => {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                o.div(o.add(o.mul(v[j], v[j]), o.mul(v[k], v[k])), length)
            }
            _ => o.sub(o.exact(1.0), o.mul(v[i], o.div(v[i], length))),
        })
    }

    /// The squared radius.
    fn square(&self) -> O::Number {
        let r = self.o.exact(self.f.radius);
        self.o.mul(r, r)
    }

    pub(super) fn gaussian(&self) -> Numbers<O::Number> {
        let (o, v, n) = (self.o, self.direction(), self.across());
        let [mean, along, across] = self.moments();
        let across = o.mul(self.square(), across);
        let variance = [0, 1, 2].map(|i| {
            let length = if self.way / 3 == 1 {
                o.mul(o.mul(along, v[i]), v[i])
            } else {
                o.mul(along, o.mul(v[i], v[i]))
            };
            o.add(length, o.mul(across, n[i]))
        });
        let mean_in_space = [0, 1, 2].map(|i| o.add(o.exact(self.f.origin[i]), o.mul(mean, v[i])));
        Numbers { moments: [mean, along, across], mean: mean_in_space, variance }
    }

    pub(super) fn gradients(&self, g: &Gaussian) -> Gradients<O::Number> {
        let (o, v, n, length) = (self.o, self.direction(), self.across(), self.length());
        let (g_mean, g_variance) = (g.mean.map(|g| o.exact(g)), g.variance.map(|g| o.exact(g)));
        let [mean, along, squares] = self.moments();
        let square = self.square();
        let across = o.mul(square, squares);
        let vv = v.map(|x| o.mul(x, x));
        let to_mean = o.add(o.exact(g.t_mean), o.dot(&g_mean, &v));
        let to_along = o.add(o.exact(g.t_variance), o.dot(&g_variance, &vv));
        let to_across = o.add(o.exact(g.r_variance), o.dot(&g_variance, &n));
        // What the directions' length takes: sum_i g_i d_i^2 over |d|^2.
        let pulled = o.div(o.dot(&g_variance, &vv), length);
        let direction = [0, 1, 2].map(|j| {
            let turned = if self.way / 3 == 1 {
                let parts = [0, 1, 2].map(|i| o.mul(o.sub(g_variance[i], g_variance[j]), vv[i]));
                o.div(o.sum(&parts), length)
            } else {
                o.sub(pulled, g_variance[j])
            };
            let straight = o.mul(o.times(2.0, o.mul(along, v[j])), g_variance[j]);
            let turned = o.mul(o.mul(across, o.div(o.times(2.0, v[j]), length)), turned);
            o.sum(&[o.mul(mean, g_mean[j]), straight, turned])
        });
        let radius = o.mul(o.mul(o.times(2.0, o.exact(self.f.radius)), squares), to_across);
        let (start, end) = self.ends(to_mean, to_along, o.mul(square, to_across));
        Gradients { origin: g_mean, direction, radius, start, end }
    }

    /// The gradients of start and end.
    fn ends(&self, g_mean: O::Number, g_along: O::Number, g_across: O::Number) -> (O::Number, O::Number) {
        let (o, d) = (self.o, self.d);
        let (g_s, g_d) = match (self.shape, self.way % 3) {
            (RayShape::Cylinder, 0) => (g_mean, o.mul(o.div(o.times(2.0, d), o.exact(3.0)), g_along)),
            (RayShape::Cylinder, _) => (o.times(0.5, g_mean), o.mul(o.div(d, o.exact(6.0)), g_along)),
            (RayShape::Cone, 0) => self.through_halves(g_mean, g_along, g_across),
            (RayShape::Cone, 1) => self.through_ratio(g_mean, g_along, g_across),
            (RayShape::Cone, _) => self.by_hand(g_mean, g_along, g_across),
        };
        let half = |x: O::Number| if self.way % 3 == 0 { o.times(0.5, x) } else { x };
        (half(o.sub(g_s, g_d)), half(o.add(g_s, g_d)))
    }

    /// Each line of mip-NeRF's formula, backward: to the middle and the half width.
    fn through_halves(
        &self,
        g_mean: O::Number,
        g_along: O::Number,
        g_across: O::Number,
    ) -> (O::Number, O::Number) {
        let (o, s, ss, dd, sum) = (self.o, self.s, self.ss, self.dd, self.sum);
        let less = o.mul(o.hyper(4.0 / 15.0), g_along);
        let outer = o.sub(o.times(12.0, ss), dd);
        let ddd = o.mul(dd, dd);
        let square = o.mul(sum, sum);
        // Of the quotients' numerators, then of their denominator.
        let g_product = self.part(g_mean, sum);
        let g_fourth = o.neg(self.part(less, square));
        let g_last = o.neg(self.part(o.mul(o.hyper(4.0 / 15.0), g_across), sum));
        let of_mean = o.neg(self.part(o.mul(g_product, o.times(2.0, o.mul(s, dd))), sum));
        let of_along = o.neg(self.part(o.times(2.0, o.mul(g_fourth, o.mul(ddd, outer))), sum));
        let of_across = o.neg(self.part(o.mul(g_last, ddd), sum));
        let g_sum = o.sum(&[of_mean, of_along, of_across]);
        let g_outer = o.mul(g_fourth, ddd);
        let g_ss = o.sum(&[o.times(0.25, g_across), o.times(12.0, g_outer), o.times(3.0, g_sum)]);
        let g_ddd = o.add(o.mul(g_fourth, outer), g_last);
        let g_dd = o.sum(&[
            o.div(g_along, o.exact(3.0)),
            o.mul(o.hyper(5.0 / 12.0), g_across),
            o.mul(g_product, o.times(2.0, s)),
            o.mul(o.times(2.0, dd), g_ddd),
            o.neg(g_outer),
            g_sum,
        ]);
        let g_s = o.sum(&[g_mean, o.mul(g_product, o.times(2.0, dd)), o.mul(o.times(2.0, s), g_ss)]);
        (g_s, o.mul(o.times(2.0, self.d), g_dd))
    }

    /// The same of multinerf's ratio: to sum and difference.
    fn through_ratio(
        &self,
        g_mean: O::Number,
        g_along: O::Number,
        g_across: O::Number,
    ) -> (O::Number, O::Number) {
        let (o, s, ss, dd) = (self.o, self.s, self.ss, self.dd);
        let q = self.ratio();
        let less = o.mul(o.hyper(1.0 / 15.0), g_along);
        let outer = o.sub(o.times(12.0, ss), dd);
        let qq = o.mul(q, q);
        let g_q = o.sum(&[
            o.mul(g_mean, s),
            o.neg(o.mul(less, o.mul(o.times(2.0, q), outer))),
            o.neg(o.mul(o.mul(o.hyper(1.0 / 15.0), g_across), dd)),
        ]);
        let g_top = self.part(g_q, self.sum);
        let g_sum = o.neg(o.mul(g_top, q));
        let g_ss = o.sum(&[
            o.times(1.0 / 16.0, g_across),
            o.neg(o.times(12.0, o.mul(less, qq))),
            o.times(3.0, g_sum),
        ]);
        let inner = o.sub(o.hyper(5.0 / 48.0), o.mul(o.hyper(1.0 / 15.0), q));
        let g_dd = o.sum(&[
            o.mul(o.hyper(1.0 / 12.0), g_along),
            o.mul(less, qq),
            o.mul(g_across, inner),
            g_top,
            g_sum,
        ]);
        let g_s = o.add(o.mul(g_mean, o.add(o.exact(0.5), q)), o.mul(o.times(2.0, s), g_ss));
        (g_s, o.mul(o.times(2.0, self.d), g_dd))
    }

    /// By polynomials of q.
    fn by_hand(&self, g_mean: O::Number, g_along: O::Number, g_across: O::Number) -> (O::Number, O::Number) {
        let (o, s, d, q) = (self.o, self.s, self.d, self.ratio());
        let qq = o.mul(q, q);
        let p = self.part(o.mul(d, s), self.sum);
        let of_s = [
            self.polynomial(q, &[0.5, -1.0, 2.0]),
            o.mul(o.mul(o.hyper(0.8), o.mul(s, qq)), self.polynomial(q, &[2.0, -5.0])),
            o.mul(s, o.add(o.exact(0.125), o.mul(o.hyper(0.4), qq))),
        ];
        let of_d = [
            o.times(2.0, o.mul(p, o.sub(o.exact(1.0), q))),
            o.div(o.mul(d, self.polynomial(q, &[5.0, -32.0, 76.0, -40.0])), o.exact(30.0)),
            o.mul(d, self.polynomial(q, &[5.0 / 24.0, -4.0 / 15.0, 2.0 / 15.0])),
        ];
        let g = [g_mean, g_along, g_across];
        (o.dot(&of_s, &g), o.dot(&of_d, &g))
    }
}

fn ways<'a>(m: &'a Machine, f: &'a Frustum, c: &Conventions) -> Ways<'a, Machine> {
    Ways::new(m, f, c.ray_shape, m.noise % WAYS)
}

/// The frustums' Gaussians.
pub(crate) fn conical_frustum(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let one = |f: &Frustum| {
        let Numbers { moments: [t_mean, t_variance, r_variance], mean, variance } = ways(m, f, c).gaussian();
        Gaussian { t_mean, t_variance, r_variance, mean, variance }
    };
    forward(&frustums(a).iter().map(one).collect::<Vec<_>>())
}

/// Their gradient.
pub(crate) fn conical_frustum_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let one = |(f, g): (&Frustum, &Gaussian)| {
        let Gradients { origin, direction, radius, start, end } = ways(m, f, c).gradients(g);
        Frustum { origin, direction, radius, start, end }
    };
    vjp(&frustums(a).iter().zip(&cotangents(a)).map(one).collect::<Vec<_>>())
}
