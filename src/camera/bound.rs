//! Error bounds of the camera: the formulas once more, in running error analysis.
//!
//! Covered: K inverted as a matrix (by elimination, or adjugate over determinant) or the pinhole formula written out; points as
//! 3-vectors or in homogeneous coordinates; every order of sums, as one operation or one addition at a time, fused or not.

use super::arrays::{in_axes, intrinsics, matrix, rows34};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, array, arrays, threes, twos, values};
use crate::contract::bounded::{Bounded, exact};
use crate::convention::Conventions;

/// A sum in any order: inside one operation, or by additions that each round to the type.
pub(crate) fn any_order(terms: &[Bounded], m: &Arithmetic) -> Bounded {
    m.any_order(terms)
}

/// A hyper-parameter: given in f64, rounded to the type where the type can't represent it.
pub(crate) fn hyper(x: f64, m: &Arithmetic) -> Bounded {
    let digits = libm::frexp(x).0 / m.u;
    if digits == libm::rint(digits) && x.abs() <= m.largest { exact(x) } else { m.rounded(x, 0.0) }
}

/// One axis of the lens: focal length and principal point.
#[derive(Clone, Copy)]
pub(crate) struct Axis {
    pub f: Bounded,
    pub c: Bounded,
}

impl Axis {
    /// The two axes of a K that is exact.
    pub(crate) fn of(k: &[f64]) -> [Axis; 2] {
        let k = intrinsics(k);
        [Axis { f: exact(k.fx), c: exact(k.cx) }, Axis { f: exact(k.fy), c: exact(k.cy) }]
    }

    /// 1 / f: one division, or adjugate over determinant, which rounds both once more.
    fn inverse(&self, m: &Arithmetic) -> Bounded {
        let inverse = m.div(exact(1.0), self.f);
        inverse.widened(2.0 * m.u * inverse.size())
    }

    /// The terms s u / f and -s c / f of a row of s K^-1 (u, v, 1).
    pub(crate) fn terms(&self, u: Bounded, s: Bounded, m: &Arithmetic) -> [Bounded; 2] {
        let inverse = self.inverse(m);
        [m.mul(m.mul(s, u), inverse), m.mul(m.mul(s, self.c), inverse).neg()]
    }

    /// s (u - c) / f, in any of its forms.
    pub(crate) fn point(&self, u: Bounded, s: Bounded, m: &Arithmetic) -> Bounded {
        let pixels = m.sub(u, self.c);
        m.mul(s, m.div(pixels, self.f))
            .or(m.div(m.mul(s, pixels), self.f))
            .or(any_order(&self.terms(u, s, m), m))
    }

    /// Gradients of [`Self::point`]: of u, and of f as (whole, through s u / f, through -s c / f).
    fn gradient(&self, u: Bounded, s: Bounded, g: Bounded, m: &Arithmetic) -> (Bounded, [Bounded; 3]) {
        let inverse = self.inverse(m);
        let g_u = m.mul(m.mul(s, g), inverse);
        let whole = m.mul(g_u, m.div(m.sub(u, self.c), self.f)).neg();
        let through = |x: Bounded| m.mul(m.mul(g_u, x), inverse);
        (g_u, [whole, through(u).neg(), through(self.c)])
    }
}

/// Accumulates the gradient of K over the pixels of a batch.
#[derive(Default)]
pub(crate) struct Gather {
    center: [Vec<Bounded>; 2],
    focal: [[Vec<Bounded>; 4]; 2],
}

impl Gather {
    /// Errors of the gradients of uv and s of one pixel; its contribution to the gradient of K is kept.
    pub(crate) fn pixel(
        &mut self,
        axes: &[Axis; 2],
        uv: [f64; 2],
        s: f64,
        g: [Bounded; 3],
        m: &Arithmetic,
    ) -> ([f64; 2], f64) {
        let (uv, s) = (uv.map(exact), exact(s));
        let (mut g_uv, mut whole, mut expanded) = ([0.0; 2], vec![g[2]], vec![g[2]]);
        for k in 0..2 {
            let (g_u, g_f) = axes[k].gradient(uv[k], s, g[k], m);
            g_uv[k] = g_u.e;
            self.center[k].push(g_u.neg());
            g_f.iter().zip(&mut self.focal[k]).for_each(|(&g, gathered)| gathered.push(g));
            self.focal[k][3].push(m.add(g_f[1], g_f[2]));
            whole.push(m.mul(axes[k].point(uv[k], exact(1.0), m), g[k]));
            expanded.extend(axes[k].terms(uv[k], exact(1.0), m).map(|term| m.mul(term, g[k])));
        }
        (g_uv, any_order(&whole, m).or(any_order(&expanded, m)).e)
    }

    /// Errors of the gradient of K: sums over the batch, each one operation.
    pub(crate) fn k(&self, m: &Arithmetic) -> ndarray::ArrayD<f64> {
        let total = |terms: &[Bounded]| {
            let sum = m.sum(terms);
            m.rounded(sum.y, sum.e)
        };
        let focal = |k: usize| {
            let [whole, u, c, pairs] = self.focal[k].each_ref().map(|terms| total(terms));
            whole.or(pairs).or(m.add(u, c)).e
        };
        matrix([focal(0), focal(1), total(&self.center[0]).e, total(&self.center[1]).e])
    }
}

/// Bound of [`super::transform`].
pub(crate) fn transform(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let (c2w, x_c) = (values(a, "c2w"), threes(a, "x_c"));
    let point = |(n, x): (usize, &[f64; 3])| {
        let homogeneous = [x[0], x[1], x[2], 1.0];
        rows34(&c2w, n).map(|row| {
            let product =
                |j: usize| if j == 3 { exact(row[3]) } else { m.mul(exact(row[j]), exact(homogeneous[j])) };
            any_order(&[product(0), product(1), product(2), product(3)], m).e
        })
    };
    arrays([("x_w", array(&[x_c.len(), 3], x_c.iter().enumerate().flat_map(point).collect()))])
}

/// Bound of [`super::backward::transform`]. The translation's gradient is the cotangent itself.
pub(crate) fn transform_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let (c2w, x_c, g) = (values(a, "c2w"), threes(a, "x_c"), threes(a, "grad_x_w"));
    let (mut g_c2w, mut g_x_c) = (vec![], vec![]);
    for n in 0..x_c.len() {
        let (g, x) = (g[n].map(exact), x_c[n].map(exact));
        g_c2w.extend(pose_errors(g, x, [0.0; 3], m));
        g_x_c.extend(rotate_transposed(&rows34(&c2w, n), g, m).map(|g| g.e));
    }
    let points = x_c.len();
    arrays([("grad_c2w", array(&[points, 4, 4], g_c2w)), ("grad_x_c", array(&[points, 3], g_x_c))])
}

/// Errors of g x^T, with those of the translation's gradient beside it and 0 below.
pub(crate) fn pose_errors(
    g: [Bounded; 3],
    x: [Bounded; 3],
    translation: [f64; 3],
    m: &Arithmetic,
) -> [f64; 16] {
    let mut errors = [0.0; 16];
    for k in 0..3 {
        for j in 0..3 {
            errors[4 * k + j] = m.mul(g[k], x[j]).e;
        }
        errors[4 * k + 3] = translation[k];
    }
    errors
}

/// R^T g.
pub(crate) fn rotate_transposed(rows: &[[f64; 4]; 3], g: [Bounded; 3], m: &Arithmetic) -> [Bounded; 3] {
    std::array::from_fn(|j| {
        let terms: [Bounded; 3] = std::array::from_fn(|k| m.mul(exact(rows[k][j]), g[k]));
        any_order(&terms, m)
    })
}

/// Bound of [`super::pixel_to_camera`]. The depth is passed through unchanged.
pub(crate) fn pixel_to_camera(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let (axes, uv, s) = (Axis::of(&values(a, "K")), twos(a, "uv"), values(a, "s"));
    let point = |n: usize| {
        let along = |k: usize| axes[k].point(exact(uv[n][k]), exact(s[n]), m).e;
        [along(0), along(1), 0.0]
    };
    arrays([("x_c", array(&[s.len(), 3], (0..s.len()).flat_map(point).collect()))])
}

/// Bound of [`super::backward::pixel_to_camera`]: through the pinhole formula, or through the inverse matrix.
pub(crate) fn pixel_to_camera_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let a = &in_axes(a.clone(), "grad_x_c", c);
    let (axes, uv, s) = (Axis::of(&values(a, "K")), twos(a, "uv"), values(a, "s"));
    let (mut gather, mut g_uv, mut g_s) = (Gather::default(), vec![], vec![]);
    for (n, g) in threes(a, "grad_x_c").into_iter().enumerate() {
        let (on_uv, on_s) = gather.pixel(&axes, uv[n], s[n], g.map(exact), m);
        g_uv.extend(on_uv);
        g_s.push(on_s);
    }
    arrays([
        ("grad_K", gather.k(m)),
        ("grad_uv", array(&[s.len(), 2], g_uv)),
        ("grad_s", array(&[s.len()], g_s)),
    ])
}
