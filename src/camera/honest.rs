//! Honest implementations of the camera in emulated arithmetic: what the bound must never reject.

use super::Intrinsics;
use super::arrays::{in_axes, intrinsics, matrix, rows34};
use crate::contract::arrays::{Arrays, array, arrays, threes, twos, values};
use crate::contract::machine::Machine;
use crate::convention::Conventions;

/// A short sum of products: as one operation, or written out with every step rounded.
pub(crate) fn dot(a: &[f64], b: &[f64], m: &Machine) -> f64 {
    if m.form % 2 == 0 {
        return m.dot(a, b);
    }
    let step = |sum: f64, (a, b): (&f64, &f64)| {
        if m.fused { m.round(sum + a * b) } else { m.add(sum, m.mul(*a, *b)) }
    };
    a.iter().zip(b).fold(0.0, step)
}

/// R x + o: homogeneous coordinates, or the rotation first.
pub(crate) fn transformed(rows: &[[f64; 4]; 3], x: &[f64; 3], m: &Machine) -> [f64; 3] {
    rows.map(|row| match m.form % 3 {
        0 => dot(&row, &[x[0], x[1], x[2], 1.0], m),
        _ => m.add(dot(&row[..3], x, m), row[3]),
    })
}

/// K^-1: by elimination, or adjugate over determinant (where that doesn't overflow).
pub(crate) fn inverse(k: &Intrinsics, m: &Machine) -> [[f64; 3]; 3] {
    let determinant = m.mul(k.fx, k.fy);
    if m.form % 5 < 3 || !determinant.is_finite() {
        let (x, y) = (m.div(1.0, k.fx), m.div(1.0, k.fy));
        return [[x, 0.0, -m.mul(k.cx, x)], [0.0, y, -m.mul(k.cy, y)], [0.0, 0.0, 1.0]];
    }
    let over = |x: f64| m.div(x, determinant);
    let (cx, cy) = (over(m.mul(k.cx, k.fy)), over(m.mul(k.cy, k.fx)));
    [[over(k.fy), 0.0, -cx], [0.0, over(k.fx), -cy], [0.0, 0.0, 1.0]]
}

/// s K^-1 (u, v, 1): the pinhole formula in two orders, or the matrix with the depth inside or outside.
pub(crate) fn point(k: &Intrinsics, [u, v]: [f64; 2], s: f64, m: &Machine) -> [f64; 3] {
    let (x, y) = (m.sub(u, k.cx), m.sub(v, k.cy));
    match m.form % 4 {
        0 => [m.mul(s, m.div(x, k.fx)), m.mul(s, m.div(y, k.fy)), s],
        1 => [m.div(m.mul(s, x), k.fx), m.div(m.mul(s, y), k.fy), s],
        2 => inverse(k, m).map(|row| dot(&row, &[m.mul(s, u), m.mul(s, v), s], m)),
        _ => inverse(k, m).map(|row| m.mul(s, dot(&row, &[u, v, 1.0], m))),
    }
}

/// The gradients of uv and s of one pixel and, accumulated over the batch, of K.
#[derive(Default)]
pub(crate) struct Gather {
    focal: [Vec<f64>; 2],
    through_u: [Vec<f64>; 2],
    through_c: [Vec<f64>; 2],
}

impl Gather {
    pub(crate) fn pixel(
        &mut self,
        k: &Intrinsics,
        uv: [f64; 2],
        s: f64,
        g: [f64; 3],
        m: &Machine,
    ) -> ([f64; 2], f64) {
        let (f, c, inverse) = ([k.fx, k.fy], [k.cx, k.cy], inverse(k, m));
        let mut g_uv = [0.0; 2];
        for n in 0..2 {
            let sg = m.mul(s, g[n]);
            g_uv[n] = match m.form % 3 {
                0 => m.div(sg, f[n]),
                1 => m.mul(s, m.div(g[n], f[n])),
                _ => m.mul(sg, inverse[n][n]),
            };
            // torch's backward of a quotient x / f: -g (x / f) / f.
            let x = m.div(m.mul(s, m.sub(uv[n], c[n])), f[n]);
            self.focal[n].push(-m.mul(g[n], m.div(x, f[n])));
            self.through_u[n].push(m.mul(g[n], m.mul(s, uv[n])));
            self.through_c[n].push(sg);
        }
        let g_s = if m.form % 2 == 0 {
            dot(&[point(k, uv, 1.0, m)[0], point(k, uv, 1.0, m)[1], 1.0], &g, m)
        } else {
            let back: [f64; 3] =
                std::array::from_fn(|j| dot(&[inverse[0][j], inverse[1][j], inverse[2][j]], &g, m));
            dot(&[uv[0], uv[1], 1.0], &back, m)
        };
        (g_uv, g_s)
    }

    /// Summed per pixel, or through the inverse matrix: -K^-T G K^-T.
    pub(crate) fn k(&self, k: &Intrinsics, g_u: [&[f64]; 2], m: &Machine) -> ndarray::ArrayD<f64> {
        let inverse = inverse(k, m);
        let focal = |n: usize| {
            if m.form % 2 == 0 {
                return m.sum(&self.focal[n]);
            }
            let (u, c) = (m.sum(&self.through_u[n]), m.sum(&self.through_c[n]));
            -m.mul(inverse[n][n], dot(&[u, c], &[inverse[n][n], inverse[n][2]], m))
        };
        let center = |n: usize| {
            let matrix = m.form % 2 == 1;
            if matrix { -m.mul(inverse[n][n], m.sum(&self.through_c[n])) } else { -m.sum(g_u[n]) }
        };
        matrix([focal(0), focal(1), center(0), center(1)])
    }
}

/// Camera space to world space.
pub(crate) fn transform(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let (c2w, x_c) = (values(a, "c2w"), threes(a, "x_c"));
    let point = |(n, x): (usize, &[f64; 3])| transformed(&rows34(&c2w, n), x, m);
    arrays([("x_w", array(&[x_c.len(), 3], x_c.iter().enumerate().flat_map(point).collect()))])
}

/// g x^T, with the translation's gradient beside it and 0 below.
pub(crate) fn pose_gradient(g: [f64; 3], x: [f64; 3], translation: [f64; 3], m: &Machine) -> [f64; 16] {
    let mut out = [0.0; 16];
    for k in 0..3 {
        (0..3).for_each(|j| out[4 * k + j] = m.mul(g[k], x[j]));
        out[4 * k + 3] = translation[k];
    }
    out
}

/// R^T g.
pub(crate) fn rotate_transposed(rows: &[[f64; 4]; 3], g: [f64; 3], m: &Machine) -> [f64; 3] {
    std::array::from_fn(|j| dot(&[rows[0][j], rows[1][j], rows[2][j]], &g, m))
}

/// Gradient of the transform.
pub(crate) fn transform_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let (c2w, x_c, g) = (values(a, "c2w"), threes(a, "x_c"), threes(a, "grad_x_w"));
    let points = x_c.len();
    let g_c2w = (0..points).flat_map(|n| pose_gradient(g[n], x_c[n], g[n], m)).collect();
    let g_x_c = (0..points).flat_map(|n| rotate_transposed(&rows34(&c2w, n), g[n], m)).collect();
    arrays([("grad_c2w", array(&[points, 4, 4], g_c2w)), ("grad_x_c", array(&[points, 3], g_x_c))])
}

/// Pixel and depth to camera space.
pub(crate) fn pixel_to_camera(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let (k, uv, s) = (intrinsics(&values(a, "K")), twos(a, "uv"), values(a, "s"));
    let points = (0..s.len()).flat_map(|n| point(&k, uv[n], s[n], m)).collect();
    in_axes(arrays([("x_c", array(&[s.len(), 3], points))]), "x_c", c)
}

/// Its gradient.
pub(crate) fn pixel_to_camera_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let a = &in_axes(a.clone(), "grad_x_c", c);
    let (k, uv, s) = (intrinsics(&values(a, "K")), twos(a, "uv"), values(a, "s"));
    let (mut gather, mut g_u, mut g_v, mut g_s) = (Gather::default(), vec![], vec![], vec![]);
    for (n, g) in threes(a, "grad_x_c").into_iter().enumerate() {
        let (on_uv, on_s) = gather.pixel(&k, uv[n], s[n], g, m);
        g_u.push(on_uv[0]);
        g_v.push(on_uv[1]);
        g_s.push(on_s);
    }
    let g_uv = g_u.iter().zip(&g_v).flat_map(|(&u, &v)| [u, v]).collect();
    arrays([
        ("grad_K", gather.k(&k, [&g_u, &g_v], m)),
        ("grad_uv", array(&[s.len(), 2], g_uv)),
        ("grad_s", array(&[s.len()], g_s)),
    ])
}
