//! Honest covariances: the quaternion divided first, or 2/|q|^2 in front of its products; diagonals as 1 - 2(yy + zz) or by all four
//! squares; M M^T or R diag(s^2) R^T; gradients of each.

use super::Form;
use super::arrays::{form, forward, vjp};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::convention::{Conventions, QuaternionLength, QuaternionOrder, SplatScale};

/// The number of ways to a covariance.
pub(super) const WAYS: u64 = 12;

type Matrix<N> = [[N; 3]; 3];

/// A Gaussian in some arithmetic, on one of the ways.
pub(super) struct Gaussian<'a, O: Operations> {
    o: &'a O,
    form: Form,
    way: u64,
    /// The quaternion that goes into the polynomial, its real part first.
    u: [O::Number; 4],
    /// 1 / |q|.
    inverse: O::Number,
    /// 2, or 2/|q|^2 where the quaternion isn't divided first.
    two: O::Number,
    r: Matrix<O::Number>,
    s: [O::Number; 3],
}

impl<'a, O: Operations> Gaussian<'a, O> {
    pub(super) fn new(o: &'a O, q: [f64; 4], scales: [f64; 3], form: Form, way: u64) -> Self {
        let mut u = q.map(|x| o.exact(x));
        if form.order == QuaternionOrder::RealLast {
            u = [u[3], u[0], u[1], u[2]];
        }
        let (mut two, mut inverse) = (o.exact(2.0), o.exact(1.0));
        if form.length == QuaternionLength::Divided {
            let square = o.dot(&u, &u);
            let length = o.sqrt(square);
            inverse = o.div(inverse, length);
            match way % 3 {
                0 => u = u.map(|x| o.div(x, length)),
                1 => u = u.map(|x| o.mul(x, inverse)),
                _ => two = o.div(two, square),
            }
        }
        let s = scales.map(|s| match form.scale {
            SplatScale::Plain => o.exact(s),
            SplatScale::Log => o.exp(o.exact(s)),
        });
        let mut gaussian = Gaussian { o, form, way, u, inverse, two, r: [[o.exact(0.0); 3]; 3], s };
        gaussian.r = gaussian.rotation();
        gaussian
    }

    /// Whether diagonals are ww + xx - yy - zz: the same for a unit quaternion alone.
    fn by_all_squares(&self) -> bool {
        self.form.length == QuaternionLength::Divided && self.way % 3 == 1
    }

    fn rotation(&self) -> Matrix<O::Number> {
        let (o, [w, x, y, z]) = (self.o, self.u);
        let square = |a: O::Number| o.mul(a, a);
        let diagonal = |own: O::Number, a: O::Number, b: O::Number| {
            if self.by_all_squares() {
                return o.sum(&[square(w), square(own), o.neg(square(a)), o.neg(square(b))]);
            }
            o.sub(o.exact(1.0), o.mul(self.two, o.add(square(a), square(b))))
        };
        let plus = |a, b, c, d| o.mul(self.two, o.add(o.mul(a, b), o.mul(c, d)));
        let minus = |a, b, c, d| o.mul(self.two, o.sub(o.mul(a, b), o.mul(c, d)));
        [
            [diagonal(x, y, z), minus(x, y, w, z), plus(x, z, w, y)],
            [plus(x, y, w, z), diagonal(y, x, z), minus(y, z, w, x)],
            [minus(x, z, w, y), plus(y, z, w, x), diagonal(z, x, y)],
        ]
    }

    fn m(&self) -> Matrix<O::Number> {
        self.r.map(|row| std::array::from_fn(|k| self.o.mul(row[k], self.s[k])))
    }

    pub(super) fn covariance(&self) -> Matrix<O::Number> {
        let (o, m) = (self.o, self.m());
        let (left, right) = if self.way / 3 % 2 == 0 {
            (m, m)
        } else {
            let variances = self.s.map(|s| o.mul(s, s));
            (self.r.map(|row| std::array::from_fn(|k| o.mul(row[k], variances[k]))), self.r)
        };
        std::array::from_fn(|i| std::array::from_fn(|j| o.dot(&left[i], &right[j])))
    }

    /// Gradients of the quaternion and the scales.
    pub(super) fn gradients(&self, g: Matrix<f64>) -> ([O::Number; 4], [O::Number; 3]) {
        let (o, m, s) = (self.o, self.m(), self.s);
        // g M + g^T M, or (g + g^T) M.
        let g_m: Matrix<O::Number> = std::array::from_fn(|i| {
            std::array::from_fn(|k| {
                let column = [0, 1, 2].map(|j| m[j][k]);
                let (row, across) = (g[i].map(|g| o.exact(g)), [0, 1, 2].map(|j| o.exact(g[j][i])));
                if self.way / 6 % 2 == 0 {
                    return o.add(o.dot(&row, &column), o.dot(&across, &column));
                }
                o.dot(&[0, 1, 2].map(|j| o.add(row[j], across[j])), &column)
            })
        });
        let g_s = [0, 1, 2].map(|k| {
            let through = o.dot(&[0, 1, 2].map(|i| g_m[i][k]), &[0, 1, 2].map(|i| self.r[i][k]));
            if self.form.scale == SplatScale::Log { o.mul(through, s[k]) } else { through }
        });
        let g_r: Matrix<O::Number> = g_m.map(|row| std::array::from_fn(|k| o.mul(row[k], s[k])));
        let [w, x, y, z] = self.through_lengths(self.of_polynomial(&g_r), &g_r);
        let g_q = if self.form.order == QuaternionOrder::RealLast { [x, y, z, w] } else { [w, x, y, z] };
        (g_q, g_s)
    }

    /// From the polynomial's quaternion to the one that was given.
    fn through_lengths(&self, g_u: [O::Number; 4], g_r: &Matrix<O::Number>) -> [O::Number; 4] {
        let o = self.o;
        if self.form.length == QuaternionLength::AsGiven {
            return g_u;
        }
        if self.way % 3 == 2 {
            // By the slope of 2/|q|^2: what goes to it are the products that it stands in front of.
            let off = |i: usize, j: usize| o.mul(g_r[i][j], o.div(self.r[i][j], self.two));
            let diagonal = |i: usize| o.mul(g_r[i][i], o.div(o.sub(self.r[i][i], o.exact(1.0)), self.two));
            let of_two = o.sum(&[
                off(0, 1),
                off(0, 2),
                off(1, 0),
                off(1, 2),
                off(2, 0),
                off(2, 1),
                diagonal(0),
                diagonal(1),
                diagonal(2),
            ]);
            let slope = o.mul(of_two, o.mul(self.two, self.two));
            return [0, 1, 2, 3].map(|a| o.sub(g_u[a], o.mul(slope, self.u[a])));
        }
        let radial = o.dot(&g_u, &self.u);
        [0, 1, 2, 3].map(|a| o.mul(o.sub(g_u[a], o.mul(radial, self.u[a])), self.inverse))
    }

    /// Gradient of the quaternion that goes into the polynomial.
    fn of_polynomial(&self, g: &Matrix<O::Number>) -> [O::Number; 4] {
        let (o, [w, x, y, z]) = (self.o, self.u);
        let apart = |i: usize, j: usize| o.sub(g[i][j], g[j][i]);
        let both = |i: usize, j: usize| o.add(g[i][j], g[j][i]);
        let (turn, across) = ([apart(2, 1), apart(0, 2), apart(1, 0)], [both(1, 2), both(0, 2), both(0, 1)]);
        // The diagonal's: of three squares each, or of all.
        let own = |a: usize, x: O::Number| {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            let rest = o.add(g[b][b], g[c][c]);
            if self.by_all_squares() {
                return o.mul(x, o.sub(g[a][a], rest));
            }
            o.times(-2.0, o.mul(x, rest))
        };
        let real =
            if self.by_all_squares() { o.mul(w, o.sum(&[g[0][0], g[1][1], g[2][2]])) } else { o.exact(0.0) };
        let sums = [
            [o.mul(x, turn[0]), o.mul(y, turn[1]), o.mul(z, turn[2]), real],
            [o.mul(w, turn[0]), o.mul(y, across[2]), o.mul(z, across[1]), own(0, x)],
            [o.mul(w, turn[1]), o.mul(x, across[2]), o.mul(z, across[0]), own(1, y)],
            [o.mul(w, turn[2]), o.mul(x, across[1]), o.mul(y, across[0]), own(2, z)],
        ];
        sums.map(|terms| o.mul(self.two, o.sum(&terms)))
    }
}

/// Which way a machine takes.
fn way(m: &Machine) -> u64 {
    (2 * m.form + u64::from(m.stable)) % WAYS
}

/// Covariances.
pub(crate) fn covariance(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    forward(a, |q, s| Gaussian::new(m, q, s, form(c), way(m)).covariance())
}

/// Their gradients.
pub(crate) fn covariance_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |q, s, g| Gaussian::new(m, q, s, form(c), way(m)).gradients(g))
}
