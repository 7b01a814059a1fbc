//! Honest lenses in emulated arithmetic: powers or Horner's scheme, quotient first or last; inverses by Newton's method, with the inverse
//! matrix or by two quotients; gradients by the formula, or as the chain rule has them.

use super::Distortion;
use super::arrays::{Pair, forward, lens, vjp};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::Conventions;

/// A point with the radial factor there.
struct Point<'a> {
    m: &'a Machine,
    lens: &'a Distortion,
    p: Pair,
    powers: [f64; 3],
    numerator: f64,
    denominator: f64,
    /// The radial factor's derivative with respect to r^2, twice.
    slope: f64,
}

impl<'a> Point<'a> {
    fn new(lens: &'a Distortion, p: Pair, m: &'a Machine) -> Self {
        let r2 = m.dot(&p, &p);
        let r4 = m.mul(r2, r2);
        let powers = [r2, r4, m.mul(r4, r2)];
        let horner = m.form % 2 == 0;
        let sum = |k: [f64; 3]| match horner {
            true => k.iter().rev().fold(0.0, |inner, &k| m.mul(r2, m.add(k, inner))),
            false => m.dot(&k, &powers),
        };
        let derivative = |k: [f64; 3]| match horner {
            true => m.add(k[0], m.mul(r2, m.add(2.0 * k[1], m.mul(r2, m.mul(3.0, k[2]))))),
            false => m.sum(&[k[0], m.mul(2.0 * k[1], r2), m.mul(m.mul(3.0, k[2]), r4)]),
        };
        let (above, below) = ([lens.k1, lens.k2, lens.k3], [lens.k4, lens.k5, lens.k6]);
        let (numerator, denominator) = (m.add(1.0, sum(above)), m.add(1.0, sum(below)));
        let radial = m.div(numerator, denominator);
        let half = match m.stable {
            true => m.div(m.sub(derivative(above), m.mul(radial, derivative(below))), denominator),
            false => {
                let through = m.div(m.mul(numerator, derivative(below)), m.mul(denominator, denominator));
                m.sub(m.div(derivative(above), denominator), through)
            }
        };
        Point { m, lens, p, powers, numerator, denominator, slope: m.mul(2.0, half) }
    }

    fn radial(&self) -> f64 {
        self.m.div(self.numerator, self.denominator)
    }

    /// p1 and p2 as coordinate j sees them: that of 2 x y first.
    fn tangential(&self, j: usize) -> [f64; 2] {
        let p = [self.lens.p1, self.lens.p2];
        [p[j], p[1 - j]]
    }

    fn twice(&self) -> f64 {
        self.m.mul(2.0, self.m.mul(self.p[0], self.p[1]))
    }

    fn along(&self, j: usize) -> f64 {
        self.m.add(self.powers[0], self.m.mul(2.0, self.m.mul(self.p[j], self.p[j])))
    }

    fn distorted(&self) -> Pair {
        let m = self.m;
        [0, 1].map(|j| {
            let [mixed, along] = self.tangential(j);
            let radial = match m.stable {
                true => m.mul(self.p[j], self.radial()),
                false => m.div(m.mul(self.p[j], self.numerator), self.denominator),
            };
            m.sum(&[radial, m.mul(mixed, self.twice()), m.mul(along, self.along(j))])
        })
    }

    fn jacobian(&self) -> [f64; 3] {
        let m = self.m;
        let diagonal = |j: usize| {
            let [mixed, along] = self.tangential(j);
            let through = m.mul(m.mul(self.slope, self.p[j]), self.p[j]);
            let [small, large] = [m.mul(2.0 * mixed, self.p[1 - j]), m.mul(m.mul(6.0, along), self.p[j])];
            m.sum(&[self.radial(), through, small, large])
        };
        let across = m.mul(self.slope, m.mul(self.p[0], self.p[1]));
        let [mixed, along] = [m.mul(2.0 * self.lens.p1, self.p[0]), m.mul(2.0 * self.lens.p2, self.p[1])];
        [diagonal(0), m.sum(&[across, mixed, along]), diagonal(1)]
    }

    /// J^-1 v.
    fn solved(&self, v: Pair) -> Pair {
        let (m, [xx, xy, yy]) = (self.m, self.jacobian());
        let determinant = m.sub(m.mul(xx, yy), m.mul(xy, xy));
        if m.form % 3 == 1 {
            let [a, b, c] = [yy, -xy, xx].map(|entry| m.div(entry, determinant));
            return [m.dot(&[a, b], &v), m.dot(&[b, c], &v)];
        }
        [m.dot(&[yy, -xy], &v), m.dot(&[-xy, xx], &v)].map(|x| m.div(x, determinant))
    }

    /// The gradient of the point.
    fn pulled(&self, g: Pair) -> Pair {
        let m = self.m;
        if m.form % 3 == 0 {
            let [xx, xy, yy] = self.jacobian();
            return [m.dot(&[xx, xy], &g), m.dot(&[xy, yy], &g)];
        }
        // By way of the gradient of r^2, from the radial factor and both tangential terms.
        let s = m.dot(&self.p, &g);
        let (p1, p2) = (self.lens.p1, self.lens.p2);
        let g_r2 = m.sum(&[m.mul(m.mul(0.5, self.slope), s), m.mul(p2, g[0]), m.mul(p1, g[1])]);
        let g_twice = m.dot(&[p1, p2], &g);
        [0, 1].map(|j| {
            let [_, along] = self.tangential(j);
            let own = m.mul(m.mul(4.0, m.mul(along, g[j])), self.p[j]);
            let rest = m.mul(m.mul(2.0, g_r2), self.p[j]);
            m.sum(&[m.mul(self.radial(), g[j]), rest, own, m.mul(m.mul(2.0, g_twice), self.p[1 - j])])
        })
    }

    /// The gradients of the coefficients.
    fn of_coefficients(&self, g: Pair) -> [f64; 8] {
        let m = self.m;
        let s = m.div(m.dot(&self.p, &g), self.denominator);
        let [k1, k2, k3] = self.powers.map(|power| m.mul(s, power));
        let [k4, k5, k6] = [k1, k2, k3].map(|g_k| -m.mul(self.radial(), g_k));
        let p1 = m.dot(&[self.twice(), self.along(1)], &g);
        let p2 = m.dot(&[self.along(0), self.twice()], &g);
        [k1, k2, p1, p2, k3, k4, k5, k6]
    }
}

/// Distorted points.
pub(crate) fn lens_distort(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let lens = lens(a);
    forward(a, "points", "distorted", |p| Point::new(&lens, p, m).distorted())
}

/// Their gradient.
pub(crate) fn lens_distort_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let lens = lens(a);
    let f = |p: Pair, g: Pair| {
        let point = Point::new(&lens, p, m);
        (point.pulled(g), point.of_coefficients(g))
    };
    vjp(a, "points", "distorted", f, |terms| m.sum(terms))
}

/// Newton's method from the distorted point, a dozen steps.
fn inverse(lens: &Distortion, target: Pair, m: &Machine) -> Pair {
    (0..12).fold(target, |p, _| {
        let point = Point::new(lens, p, m);
        let here = point.distorted();
        let step = point.solved([0, 1].map(|j| m.sub(here[j], target[j])));
        [0, 1].map(|j| m.sub(p[j], step[j]))
    })
}

/// Ideal points.
pub(crate) fn lens_undistort(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let lens = lens(a);
    forward(a, "distorted", "points", |target| inverse(&lens, target, m))
}

/// Their gradient, at the points that this machine finds.
pub(crate) fn lens_undistort_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let lens = lens(a);
    let f = |target: Pair, g: Pair| {
        let point = Point::new(&lens, inverse(&lens, target, m), m);
        let h = point.solved(g);
        (h, point.of_coefficients(h).map(|g_k| -g_k))
    };
    vjp(a, "distorted", "points", f, |terms| m.sum(terms))
}
