//! Honest poses in emulated arithmetic: normalized by a quotient or a factor, diagonals in two forms, inverted by a transpose or by
//! elimination; gradients by the formula, or as the chain rule has them.

use super::arrays::{Written, forward, vjp};
use super::flip;
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::{Conventions, Quaternion};

/// The quaternion as this machine uses it, and 1 / |q|.
fn unit(q: [f64; 4], length: Quaternion, m: &Machine) -> ([f64; 4], f64) {
    if length == Quaternion::AsGiven {
        return (q, 1.0);
    }
    let size = m.sqrt(m.dot(&q, &q));
    let inverse = m.div(1.0, size);
    (q.map(|x| if m.stable { m.div(x, size) } else { m.mul(x, inverse) }), inverse)
}

/// The rotation of what `unit` gave.
fn rotation([w, x, y, z]: [f64; 4], length: Quaternion, m: &Machine) -> [[f64; 3]; 3] {
    let off = |a: f64, b: f64, c: f64, d: f64, sign: f64| match m.form % 2 {
        0 => m.mul(2.0, m.add(m.mul(a, b), sign * m.mul(c, d))),
        _ => m.add(m.mul(m.mul(2.0, a), b), sign * m.mul(m.mul(2.0, c), d)),
    };
    let all = length == Quaternion::Normalized && m.form % 3 == 1;
    let diagonal = |own: f64, a: f64, b: f64| match all {
        true => m.dot(&[w, own, -a, -b], &[w, own, a, b]),
        false => m.sub(1.0, m.mul(2.0, m.dot(&[a, b], &[a, b]))),
    };
    [
        [diagonal(x, y, z), off(x, y, w, z, -1.0), off(x, z, w, y, 1.0)],
        [off(x, y, w, z, 1.0), diagonal(y, x, z), off(y, z, w, x, -1.0)],
        [off(x, z, w, y, -1.0), off(y, z, w, x, 1.0), diagonal(z, x, y)],
    ]
}

/// [R t; 0 1]^-1 by Gauss and Jordan, with row pivots; or that of the transpose, as row-major arrays are for a library of columns.
fn eliminated(r: &[[f64; 3]; 3], t: [f64; 3], m: &Machine) -> [[f64; 4]; 4] {
    let unit = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
    let entry = |i: usize, j: usize| match (i, j) {
        (3, _) => unit(3, j),
        (_, 3) => t[i],
        _ => r[i][j],
    };
    let mut rows: [[f64; 8]; 4] = std::array::from_fn(|i| {
        std::array::from_fn(|j| match j {
            4.. => unit(i, j - 4),
            _ if m.stable => entry(i, j),
            _ => entry(j, i),
        })
    });
    for k in 0..4 {
        let pivot = (k..4).fold(k, |best, i| if rows[i][k].abs() > rows[best][k].abs() { i } else { best });
        rows.swap(k, pivot);
        let head = rows[k][k];
        rows[k] = rows[k].map(|x| m.div(x, head));
        let pivot = rows[k];
        for i in (0..4).filter(|&i| i != k) {
            let factor = rows[i][k];
            rows[i] = std::array::from_fn(|j| m.sub(rows[i][j], m.mul(factor, pivot[j])));
        }
    }
    [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| if m.stable { rows[i][4 + j] } else { rows[j][4 + i] }))
}

/// Camera to world.
pub(crate) fn pose_from_colmap(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    forward(a, |(q, t)| {
        let r = rotation(unit(q, c.quaternion, m).0, c.quaternion, m);
        let transposed = |i: usize| {
            let column = [r[0][i], r[1][i], r[2][i]];
            [column[0], column[1], column[2], -m.dot(&column, &t)]
        };
        // Elimination inverts what isn't quite a rotation; a transpose is its inverse for unit quaternions alone.
        let elimination = c.quaternion == Quaternion::Normalized && m.form % 4 == 3;
        let inverse = match elimination {
            true => eliminated(&r, t, m),
            false => [transposed(0), transposed(1), transposed(2), [0.0, 0.0, 0.0, 1.0]],
        };
        let signs = [1.0, flip(c.axes), flip(c.axes), 1.0];
        std::array::from_fn(|n| signs[n % 4] * inverse[n / 4][n % 4])
    })
}

/// Their gradient.
pub(crate) fn pose_from_colmap_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |(given, t), g| {
        let (q, inverse) = unit(given, c.quaternion, m);
        let signs = [1.0, flip(c.axes), flip(c.axes)];
        let place = [g[3], g[7], g[11]];
        let g_r = [0, 1, 2].map(|i| [0, 1, 2].map(|j| m.sub(signs[i] * g[4 * j + i], m.mul(t[i], place[j]))));
        let r = rotation(q, c.quaternion, m);
        let g_t = r.map(|row| -m.dot(&row, &place));
        let d = of_products(q, &g_r, m);
        if c.quaternion == Quaternion::AsGiven {
            return (d, g_t);
        }
        let along = m.dot(&q, &d);
        let written: Written = ([0, 1, 2, 3].map(|n| m.mul(m.sub(d[n], m.mul(q[n], along)), inverse)), g_t);
        written
    })
}

/// The gradient of the quaternion in R = I + 2 P(q).
fn of_products([w, x, y, z]: [f64; 4], a: &[[f64; 3]; 3], m: &Machine) -> [f64; 4] {
    let turned = [m.sub(a[2][1], a[1][2]), m.sub(a[0][2], a[2][0]), m.sub(a[1][0], a[0][1])];
    let mixed = [m.add(a[1][2], a[2][1]), m.add(a[0][2], a[2][0]), m.add(a[0][1], a[1][0])];
    let own = |k: usize| m.mul(-2.0, m.add(a[(k + 1) % 3][(k + 1) % 3], a[(k + 2) % 3][(k + 2) % 3]));
    let rows = [
        m.dot(&[x, y, z], &turned),
        m.dot(&[w, y, z, x], &[turned[0], mixed[2], mixed[1], own(0)]),
        m.dot(&[w, x, z, y], &[turned[1], mixed[2], mixed[0], own(1)]),
        m.dot(&[w, x, y, z], &[turned[2], mixed[1], mixed[0], own(2)]),
    ];
    rows.map(|x| m.mul(2.0, x))
}
