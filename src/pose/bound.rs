//! Error bounds of poses: the formulas once more, in running error analysis.
//!
//! Covered: the quaternion normalized by its length or its square, diagonals as 1 - s (y^2 + z^2) or as sums of all four squares; the
//! inverse as a transpose, or of the 4x4 matrix by elimination.

use super::arrays::{Written, forward, vjp};
use super::flip;
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, exact, gamma};
use crate::convention::{Conventions, Quaternion};

/// A quaternion with what it is divided by.
struct Rotation<'a> {
    m: &'a Arithmetic,
    /// As given, or of length 1.
    q: [Bounded; 4],
    /// 1 / |q|.
    inverse: Bounded,
    length: Quaternion,
}

impl<'a> Rotation<'a> {
    fn new(q: [f64; 4], length: Quaternion, m: &'a Arithmetic) -> Self {
        let given = q.map(exact);
        if length == Quaternion::AsGiven {
            return Rotation { m, q: given, inverse: exact(1.0), length };
        }
        let squares = m.any_order(&given.map(|x| m.mul(x, x)));
        let size = m.sqrt(m.rounded(squares.y, squares.e));
        let quotient = m.div(exact(1.0), size);
        let inverse = m.elementary(quotient.y, quotient.e);
        Rotation { m, q: given.map(|x| m.mul(x, inverse).or(m.div(x, size))), inverse, length }
    }

    /// 2 q_i q_j.
    fn twice(&self, i: usize, j: usize) -> Bounded {
        self.m.mul(exact(2.0), self.m.mul(self.q[i], self.q[j]))
    }

    /// An entry of the rotation; w, x, y, z are numbered from 0.
    fn entry(&self, i: usize, j: usize) -> Bounded {
        let m = self.m;
        if i != j {
            // x y - w z and the like: the sign is that of the turn from i to j.
            let k = 3 - i - j;
            let turn = self.twice(0, k + 1);
            let forward = (i + 1) % 3 == j;
            return m.any_order(&[self.twice(i + 1, j + 1), if forward { turn.neg() } else { turn }]);
        }
        let others = [1, 2].map(|n| (i + n) % 3 + 1);
        let falling = others.map(|n| self.twice(n, n).neg());
        let short = m.any_order(&[exact(1.0), falling[0], falling[1]]);
        if self.length == Quaternion::AsGiven {
            return short;
        }
        let squares = [0, i + 1, others[0], others[1]].map(|n| m.mul(self.q[n], self.q[n]));
        let all = m.any_order(&[squares[0], squares[1], squares[2].neg(), squares[3].neg()]);
        short.or(all.widened((all.y - short.y).abs()))
    }

    fn entries(&self) -> [[Bounded; 3]; 3] {
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| self.entry(i, j)))
    }
}

/// What inverting [R t; 0 1] by elimination, or its transpose, adds to each entry of the inverse X: X E X with E what rounding and
/// elimination leave of the matrix (Higham, section 14.3: about 3 n u of |L| |U|, whose entries are at most twice as large as the matrix
/// with these pivots). A large t is the first pivot of the transpose, and what it fills into the row of zeros is as small.
fn eliminated(r: &[[Bounded; 3]; 3], t: [f64; 3], m: &Arithmetic) -> [[f64; 4]; 4] {
    let far = t.iter().fold(1.0, |far: f64, t| far.max(t.abs()));
    let place = |i: usize| (0..3).map(|j| (r[j][i].y * t[j]).abs()).fold(0.0, |sum, x| sum + x);
    let x = |i: usize, j: usize| match (i, j) {
        (3, 3) => 1.0,
        (3, _) => 0.0,
        (_, 3) => place(i),
        _ => r[j][i].size(),
    };
    let off = |k: usize, l: usize| match (k, l) {
        (3, 3) => 1.0,
        (3, _) => 1.0 / far,
        (_, 3) => far,
        _ => 1.0,
    };
    let left = 2.0 * gamma(12.0, m.u);
    let e = |k: usize, l: usize| left * off(k, l) + if k < 3 && l < 3 { r[k][l].e } else { 0.0 };
    [0, 1, 2, 3].map(|i| {
        [0, 1, 2, 3].map(|j| {
            let through = |k: usize| (0..4).map(|l| x(i, k) * e(k, l) * x(l, j)).fold(0.0, |sum, x| sum + x);
            through(0) + through(1) + through(2) + through(3)
        })
    })
}

/// Bound of [`super::from_colmap`].
pub(crate) fn pose_from_colmap(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    forward(a, |(q, t)| {
        let r = Rotation::new(q, c.quaternion, m).entries();
        let mut e = [0.0; 16];
        for (i, row) in eliminated(&r, t, m).into_iter().enumerate() {
            e[4 * i..4 * i + 4].copy_from_slice(&row);
        }
        for i in 0..3 {
            let products: Vec<Bounded> = (0..3).map(|j| m.mul(r[j][i], exact(t[j]))).collect();
            e[4 * i + 3] = e[4 * i + 3].max(m.any_order(&products).e);
            (0..3).for_each(|j| e[4 * i + j] = e[4 * i + j].max(r[j][i].e));
        }
        e
    })
}

/// Gradients of the quaternion as the chain rule has them: of R, of the products, of the normalization.
fn of_quaternion(rotation: &Rotation, g: &[[Bounded; 3]; 3]) -> [Bounded; 4] {
    let (m, q) = (rotation.m, &rotation.q);
    let twice = |x: Bounded, y: Bounded| m.mul(exact(2.0), m.mul(x, y));
    let turned = |k: usize| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        [g[j][i], g[i][j].neg()]
    };
    let mut terms: [Vec<Bounded>; 4] = Default::default();
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        for share in turned(k) {
            terms[0].push(twice(q[k + 1], share));
            terms[k + 1].push(twice(q[0], share));
        }
        for (other, share) in [(j, g[k][j]), (j, g[j][k]), (i, g[k][i]), (i, g[i][k])] {
            terms[k + 1].push(twice(q[other + 1], share));
        }
        for share in [g[i][i], g[j][j]] {
            terms[k + 1].push(m.mul(exact(-4.0), m.mul(q[k + 1], share)));
        }
    }
    let d = terms.map(|terms| m.any_order(&terms));
    if rotation.length == Quaternion::AsGiven {
        return d;
    }
    let trace: f64 = (0..3).map(|k| g[k][k].size()).sum();
    let along = m.any_order(&[0, 1, 2, 3].map(|n| m.mul(q[n], d[n])));
    [0, 1, 2, 3].map(|n| {
        // A diagonal of all squares passes as much again along q, which cancels.
        let spread = 8.0 * m.u * q[n].size() * trace;
        let across = m.sub(d[n], m.mul(q[n], along)).widened(spread);
        m.mul(across, rotation.inverse)
    })
}

/// Bound of [`super::backward::from_colmap`].
pub(crate) fn pose_from_colmap_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    vjp(a, |(q, t), g| {
        let rotation = Rotation::new(q, c.quaternion, m);
        let signs = [1.0, flip(c.axes), flip(c.axes)];
        let place = [0, 1, 2].map(|i| exact(g[4 * i + 3]));
        let g_r = [0, 1, 2].map(|i| {
            [0, 1, 2].map(|j| {
                let through = m.mul(exact(t[i]), place[j]).neg();
                m.add(exact(signs[i] * g[4 * j + i]), through)
            })
        });
        let r = rotation.entries();
        let g_t = r.map(|row| m.any_order(&[0, 1, 2].map(|j| m.mul(row[j], place[j]))).e);
        let written: Written = (of_quaternion(&rotation, &g_r).map(|x| x.e), g_t);
        written
    })
}
