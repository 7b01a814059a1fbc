//! Error bounds of the contraction: the ways to write it, in running error analysis.
//!
//! Where rounding leaves open whether a point is inside, or which coordinate is the largest, the bound covers each answer.

use super::arrays::{forward, vjp};
use super::length;
use crate::camera::bound::any_order;
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, exact};
use crate::convention::{ContractionNorm, ContractionRange, Conventions};

/// A point with its length, and what follows from it.
struct Point {
    x: [Bounded; 3],
    r: Bounded,
    /// 1 / r: a quotient, or an elementary function such as `rsqrt`.
    inverse: Bounded,
    /// d r / d x.
    slope: [Bounded; 3],
    /// Coordinates of the largest size; one of them, if they don't tie.
    largest: Vec<usize>,
}

impl Point {
    fn new(x: [f64; 3], norm: ContractionNorm, m: &Arithmetic) -> Point {
        let size = length(x, norm);
        let largest: Vec<usize> = (0..3).filter(|&j| x[j].abs() == size).collect();
        let bounded = x.map(exact);
        let r = if norm == ContractionNorm::L2 {
            let squares = any_order(&bounded.map(|x| m.mul(x, x)), m);
            m.sqrt(m.rounded(squares.y, squares.e))
        } else {
            exact(size)
        };
        let quotient = m.div(exact(1.0), r);
        let inverse = m.elementary(quotient.y, quotient.e);
        let slope = std::array::from_fn(|j| match norm {
            ContractionNorm::L2 => m.mul(bounded[j], inverse),
            // Where coordinates tie, each may have any share of the slope.
            _ if !largest.contains(&j) => exact(0.0),
            _ => Bounded { y: x[j].signum(), e: if largest.len() > 1 { 1.0 } else { 0.0 } },
        });
        Point { x: bounded, r, inverse, slope, largest }
    }

    /// What honest code takes: `inside`, `outside`, or, where r rounds to 1, either.
    fn either(&self, inside: [Bounded; 3], outside: impl Fn() -> [Bounded; 3]) -> [Bounded; 3] {
        if self.r.y + self.r.e < 1.0 {
            return inside;
        }
        let outside = outside();
        if self.r.y - self.r.e > 1.0 {
            return outside;
        }
        [0, 1, 2].map(|j| outside[j].widened((outside[j].y - inside[j].y).abs()))
    }

    /// The result of `f`, given the largest coordinate, whichever of those that tie is taken for it.
    fn whichever(&self, f: impl Fn(usize) -> [Bounded; 3]) -> [Bounded; 3] {
        let all: Vec<[Bounded; 3]> = self.largest.iter().map(|&k| f(k)).collect();
        [0, 1, 2].map(|j| {
            let apart = |other: &[Bounded; 3]| other[j].e + (other[j].y - all[0][j].y).abs();
            Bounded { y: all[0][j].y, e: all.iter().map(apart).fold(0.0, f64::max) }
        })
    }

    /// 2 - 1 / r.
    fn radius(&self, m: &Arithmetic) -> Bounded {
        m.sub(exact(2.0), self.inverse)
    }

    /// (2 - 1/r) / r: a product, or (2 r - 1) / r^2.
    fn factor(&self, m: &Arithmetic) -> Bounded {
        let quotient = m.div(m.sub(m.mul(exact(2.0), self.r), exact(1.0)), m.mul(self.r, self.r));
        m.mul(self.radius(m), self.inverse).or(quotient)
    }

    /// The contracted point, beyond r = 1.
    fn folded(&self, norm: ContractionNorm, m: &Arithmetic) -> [Bounded; 3] {
        let far = self.x.map(|x| {
            let apart = m.mul(self.radius(m), m.mul(x, self.inverse));
            m.mul(self.factor(m), x).or(apart)
        });
        if norm != ContractionNorm::Merf {
            return far;
        }
        self.whichever(|k| [0, 1, 2].map(|j| if j == k { far[j] } else { m.mul(self.x[j], self.inverse) }))
    }

    /// Its gradient as automatic differentiation has it, of (2 - 1/r) (x/r): by way of the gradient of 1/r.
    fn differentiated(&self, g: [Bounded; 3], m: &Arithmetic) -> [Bounded; 3] {
        let (radius, inverse) = (self.radius(m), self.inverse);
        let through_radius = m.dot(&g, &self.x.map(|x| m.mul(x, inverse)));
        let scaled = g.map(|g| m.mul(g, radius));
        let g_inverse = m.sub(m.dot(&scaled, &self.x), through_radius);
        let g_r = m.mul(g_inverse, m.mul(inverse, inverse)).neg();
        [0, 1, 2].map(|j| m.add(m.mul(scaled[j], inverse), m.mul(g_r, self.slope[j])))
    }

    /// The same of s x with s = (2 - 1/r) / r or (2 r - 1) / r^2, whose slope is a difference of two or of three terms.
    fn expanded(&self, g: [Bounded; 3], m: &Arithmetic) -> [Bounded; 3] {
        let (along, square) = (m.dot(&g, &self.x), m.mul(self.inverse, self.inverse));
        let cube = m.mul(square, self.inverse);
        let two = m.mul(exact(2.0), m.sub(cube, square));
        let numerator = m.sub(m.mul(exact(2.0), self.r), exact(1.0));
        let three = m.mul(exact(2.0), m.sub(square, m.mul(numerator, cube)));
        let g_r = m.mul(two.or(three), along);
        [0, 1, 2].map(|j| m.add(m.mul(self.factor(m), g[j]), m.mul(g_r, self.slope[j])))
    }

    /// The same by the parts of g across and along x, for L2.
    fn split(&self, g: [Bounded; 3], m: &Arithmetic) -> [Bounded; 3] {
        let radial = m.dot(&g, &self.slope);
        let along = self.slope.map(|u| m.mul(radial, u));
        let shrunk = along.map(|along| m.mul(along, m.mul(self.inverse, self.inverse)));
        [0, 1, 2].map(|j| m.add(m.mul(self.factor(m), m.sub(g[j], along[j])), shrunk[j]))
    }

    /// The gradient of MERF's contraction: the formula, or as automatic differentiation has it of x times a scale for each coordinate.
    fn by_coordinates(&self, g: [Bounded; 3], m: &Arithmetic) -> [Bounded; 3] {
        let square = m.mul(self.inverse, self.inverse);
        let one = |k: usize| {
            let products = [0, 1, 2].map(|j| m.mul(g[j], self.x[j]));
            let others: Vec<Bounded> = (0..3).filter(|&j| j != k).map(|j| products[j]).collect();
            let others = m.mul(m.sum(&others), square);
            let sign = exact(self.x[k].y.signum());
            let short = m.sub(m.mul(g[k], square), m.mul(sign, others));
            let slope = m.sub(m.mul(square, self.inverse), m.mul(self.radius(m), square));
            let g_r = m.sub(m.mul(products[k], slope), others);
            let long = m.add(m.mul(g[k], self.factor(m)), m.mul(sign, g_r));
            [0, 1, 2].map(|j| if j == k { short.or(long) } else { m.mul(g[j], self.inverse) })
        };
        self.whichever(one)
    }
}

/// What lies within [-2, 2], scaled.
fn scaled(y: Bounded, range: ContractionRange, m: &Arithmetic) -> Bounded {
    match range {
        ContractionRange::Two => y,
        ContractionRange::One => m.mul(exact(0.5), y),
        ContractionRange::Unit => {
            let shifted_first = m.mul(exact(0.25), m.add(y, exact(2.0)));
            m.add(m.mul(exact(0.25), y), exact(0.5)).or(shifted_first)
        }
    }
}

/// Bound of [`super::contract`].
pub(crate) fn contraction(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    forward(a, |x| {
        let point = Point::new(x, c.contraction_norm, m);
        let y = point.either(point.x, || point.folded(c.contraction_norm, m));
        y.map(|y| scaled(y, c.contraction_range, m).e)
    })
}

/// Bound of [`super::backward::contract`].
pub(crate) fn contraction_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    vjp(a, |x, g| {
        let point = Point::new(x, c.contraction_norm, m);
        let g = g.map(|g| match c.contraction_range {
            ContractionRange::Two => exact(g),
            ContractionRange::One => m.mul(exact(0.5), exact(g)),
            ContractionRange::Unit => m.mul(exact(0.25), exact(g)),
        });
        let outside = || {
            if c.contraction_norm == ContractionNorm::Merf {
                return point.by_coordinates(g, m);
            }
            let (a, b) = (point.differentiated(g, m), point.expanded(g, m));
            let split = if c.contraction_norm == ContractionNorm::L2 { point.split(g, m) } else { a };
            [0, 1, 2].map(|j| a[j].or(b[j]).or(split[j]))
        };
        point.either(g, outside).map(|g| g.e)
    })
}
