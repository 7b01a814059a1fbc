//! Error bounds of the lens: the formulas once more, in running error analysis.
//!
//! Covered: powers of r^2 or Horner's scheme, every grouping of the sums, gradients as the chain rule has them. An inverse is as good as
//! the residual that its arithmetic sees, times what the inverse Jacobian makes of it: no iteration gets closer (Tisseur, "Newton's method
//! in floating point arithmetic", 2001), and one that stops before that has done too few steps.

use glam::DMat2;

use super::Distortion;
use super::arrays::{Pair, forward, lens, undistorted, vjp};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, exact};
use crate::convention::Conventions;

/// A point with the radial factor there.
struct Point<'a> {
    m: &'a Arithmetic,
    lens: &'a Distortion,
    p: [Bounded; 2],
    squares: [Bounded; 2],
    /// r^2, r^4, r^6.
    powers: [Bounded; 3],
    denominator: Bounded,
    radial: Bounded,
    /// Its derivative with respect to r^2, twice.
    slope: Bounded,
}

impl<'a> Point<'a> {
    fn new(lens: &'a Distortion, p: [Bounded; 2], m: &'a Arithmetic) -> Self {
        let squares = p.map(|x| m.mul(x, x));
        let r2 = m.any_order(&squares);
        let r4 = m.mul(r2, r2);
        let powers = [r2, r4, m.mul(r4, r2)];
        let sum = |k: [f64; 3]| {
            let [a, b, c] = [0, 1, 2].map(|n| m.mul(exact(k[n]), powers[n]));
            m.any_order(&[exact(1.0), a, b, c])
        };
        let derivative = |k: [f64; 3]| {
            let b = m.mul(exact(2.0 * k[1]), r2);
            m.any_order(&[exact(k[0]), b, m.mul(m.mul(exact(3.0), exact(k[2])), r4)])
        };
        let (above, below) = ([lens.k1, lens.k2, lens.k3], [lens.k4, lens.k5, lens.k6]);
        let (numerator, denominator) = (sum(above), sum(below));
        let radial = m.div(numerator, denominator);
        let through = m.div(m.mul(radial, derivative(below)), denominator);
        let half = m.sub(m.div(derivative(above), denominator), through);
        let slope = m.mul(exact(2.0), half);
        Point { m, lens, p, squares, powers, denominator, radial, slope }
    }

    /// 2 x y.
    fn twice(&self) -> Bounded {
        self.m.mul(self.m.mul(exact(2.0), self.p[0]), self.p[1])
    }

    /// r^2 + 2 x^2, or with y.
    fn along(&self, j: usize) -> Bounded {
        let double = self.m.mul(exact(2.0), self.squares[j]);
        self.m.any_order(&[self.squares[0], self.squares[1], double])
    }

    /// The two tangential coefficients, that of the mixed term first, seen from coordinate j: p1, p2 for x; p2, p1 for y.
    fn tangential(&self, j: usize) -> [Bounded; 2] {
        let p = [exact(self.lens.p1), exact(self.lens.p2)];
        [p[j], p[1 - j]]
    }

    fn distorted(&self) -> [Bounded; 2] {
        [0, 1].map(|j| {
            let [mixed, along] = self.tangential(j);
            let m = self.m;
            let radial = m.mul(self.p[j], self.radial);
            m.any_order(&[radial, m.mul(mixed, self.twice()), m.mul(along, self.along(j))])
        })
    }

    /// What coordinate i of the distorted point gains from coordinate j, as the terms of the sum.
    fn slopes(&self, i: usize, j: usize) -> Vec<Bounded> {
        let m = self.m;
        let [mixed, along] = self.tangential(i);
        let through_radius = m.mul(m.mul(self.slope, self.p[i]), self.p[j]);
        let of = |factor: f64, k: Bounded, x: Bounded| m.mul(m.mul(exact(factor), k), x);
        if i == j {
            let [small, large] = [of(2.0, mixed, self.p[1 - i]), of(6.0, along, self.p[i])];
            vec![self.radial, through_radius, small, large]
        } else {
            vec![through_radius, of(2.0, mixed, self.p[i]), of(2.0, along, self.p[j])]
        }
    }

    /// An entry of the Jacobian.
    fn jacobian(&self, i: usize, j: usize) -> Bounded {
        self.m.any_order(&self.slopes(i, j))
    }

    /// The gradient of the point, and those of the coefficients.
    fn gradients(&self, g: [Bounded; 2]) -> ([Bounded; 2], [Bounded; 8]) {
        let m = self.m;
        let g_p = [0, 1].map(|j| {
            let of = |i: usize| self.slopes(i, j).into_iter().map(|slope| m.mul(g[i], slope)).collect();
            let terms: [Vec<Bounded>; 2] = [of(0), of(1)];
            m.any_order(&terms.concat())
        });
        let share = [0, 1].map(|i| m.div(m.mul(g[i], self.p[i]), self.denominator));
        let above = self.powers.map(|power| m.any_order(&share.map(|share| m.mul(share, power))));
        let below = above.map(|g_k| m.mul(g_k, self.radial).neg());
        let tangential = |along: usize| {
            m.any_order(&[m.mul(g[1 - along], self.twice()), m.mul(g[along], self.along(along))])
        };
        let (g_p1, g_p2) = (tangential(1), tangential(0));
        (g_p, [above[0], above[1], g_p1, g_p2, above[2], below[0], below[1], below[2]])
    }
}

/// A gradient's sum over the points.
fn total(terms: &[Bounded], m: &Arithmetic) -> f64 {
    m.any_order(terms).e
}

/// Bound of [`Distortion::distort`].
pub(crate) fn lens_distort(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let lens = lens(a);
    forward(a, "points", "distorted", |p| Point::new(&lens, p.map(exact), m).distorted().map(|x| x.e))
}

/// Bound of [`super::backward::distort`].
pub(crate) fn lens_distort_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let lens = lens(a);
    let f = |p: Pair, g: Pair| {
        let (g_p, g_k) = Point::new(&lens, p.map(exact), m).gradients(g.map(exact));
        (g_p.map(|g| g.e), g_k)
    };
    vjp(a, "points", "distorted", f, |terms| total(terms, m))
}

/// |a| v, by rows.
fn times(a: &DMat2, v: [f64; 2]) -> [f64; 2] {
    let row = |x: f64, y: f64| x.abs() * v[0] + y.abs() * v[1];
    [row(a.x_axis.x, a.y_axis.x), row(a.x_axis.y, a.y_axis.y)]
}

/// The ideal point, with how close an iteration gets to it.
///
/// A last step is off by J^-1 times the error of the residual, and its own rounding; what was left of the step before counts by the
/// error of J: G of it, in the largest row.
fn inverse(lens: &Distortion, target: Pair, m: &Arithmetic) -> [Bounded; 2] {
    let p = undistorted(lens, target);
    let steep = lens.jacobian(p).inverse();
    let here = Point::new(lens, p.to_array().map(exact), m).distorted();
    let seen = [0, 1].map(|j| here[j].e + m.u * target[j].abs() + m.tiny);
    let moved = times(&steep, seen);
    let p = p.to_array();
    let close = [0, 1].map(|j| moved[j] + m.u * p[j].abs() + m.tiny);
    let beside = Point::new(lens, [0, 1].map(|j| Bounded { y: p[j], e: close[j] }), m);
    let off = |i: usize| [beside.jacobian(i, 0).e, beside.jacobian(i, 1).e];
    let rows = [off(0), off(1)];
    let g = [0, 1].map(|j| times(&steep, [rows[0][j], rows[1][j]]));
    let g = (g[0][0] + g[1][0]).max(g[0][1] + g[1][1]);
    let largest = close[0].max(close[1]);
    let widen = |e: f64| if g < 0.5 { e + largest * 2.0 * g / (1.0 - g) } else { f64::INFINITY };
    [0, 1].map(|j| Bounded { y: p[j], e: widen(close[j]) })
}

/// Bound of [`Distortion::undistort`].
pub(crate) fn lens_undistort(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let lens = lens(a);
    forward(a, "distorted", "points", |target| inverse(&lens, target, m).map(|x| x.e))
}

/// Bound of [`super::backward::undistort`]: at the point that was found, by the inverse matrix or by two quotients.
pub(crate) fn lens_undistort_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let lens = lens(a);
    let f = |target: Pair, g: Pair| {
        let p = inverse(&lens, target, m);
        let point = Point::new(&lens, p, m);
        let (xx, xy, yy) = (point.jacobian(0, 0), point.jacobian(0, 1), point.jacobian(1, 1));
        let determinant = m.any_order(&[m.mul(xx, yy), m.mul(xy, xy).neg()]);
        let solved = |a: Bounded, g_a: f64, g_b: f64| {
            let terms = [m.mul(a, exact(g_a)), m.mul(xy, exact(g_b)).neg()];
            let inverted = [m.div(a, determinant), m.div(xy, determinant).neg()];
            let products = [m.mul(inverted[0], exact(g_a)), m.mul(inverted[1], exact(g_b))];
            m.div(m.any_order(&terms), determinant).or(m.any_order(&products))
        };
        let h = [solved(yy, g[0], g[1]), solved(xx, g[1], g[0])];
        (h.map(|h| h.e), point.gradients(h).1)
    };
    vjp(a, "distorted", "points", f, |terms| total(terms, m))
}
