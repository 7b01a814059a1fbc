//! Error bounds of the expected distance.

use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, array, arrays, number, row, size, values};
use crate::contract::bounded::{Bounded, exact};
use crate::convention::{Conventions, Depth, EmptyDepth};

/// w . t, A and z = w . t / A of one ray.
fn divided(a: &Arrays, r: usize, m: &Arithmetic) -> (Bounded, Bounded, Bounded) {
    let weights: Vec<Bounded> = row(a, "weights", r).into_iter().map(exact).collect();
    let t: Vec<Bounded> = row(a, "t", r).into_iter().map(exact).collect();
    let (weighted, opacity) = (m.dot(&weights, &t), m.sum(&weights));
    (weighted, opacity, m.div(weighted, opacity))
}

/// The largest number beside A, where one keeps empty rays from 0 / 0: it is told, and changes a depth by that over A.
const BESIDE: f64 = 1e-6;

/// How far a quotient by A may be off where A may have such a number beside it.
fn beside(opacity: Bounded, powers: f64, c: &Conventions) -> f64 {
    if c.empty_depth == EmptyDepth::Far { 0.0 } else { powers * BESIDE / opacity.y }
}

/// sum w t + (1 - A) far, or sum w t + far - A far, or far as one more sample.
fn behind(a: &Arrays, r: usize, m: &Arithmetic) -> f64 {
    let far = m.rounded(number(a, "far"), 0.0);
    let (weighted, opacity, _) = divided(a, r, m);
    let rest = m.sub(exact(1.0), opacity);
    let (mut weights, mut t): (Vec<Bounded>, Vec<Bounded>) =
        row(a, "weights", r).into_iter().zip(row(a, "t", r)).map(|(w, t)| (exact(w), exact(t))).unzip();
    weights.push(rest);
    t.push(far);
    let factored = m.add(weighted, m.mul(rest, far));
    factored.or(m.sub(m.add(weighted, far), m.mul(opacity, far))).or(m.dot(&weights, &t)).e
}

/// Bound of [`super::super::depth`]: the quotient of two sums, or the sum of normalized weights times t.
pub(crate) fn expected(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let (rays, samples) = size(a, "weights");
    let error = |r: usize| {
        let (weighted, opacity, z) = divided(a, r, m);
        match c.depth {
            Depth::Plain => weighted.e,
            Depth::FarBehind => behind(a, r, m),
            Depth::Divided if opacity.y == 0.0 && c.empty_depth == EmptyDepth::Far => {
                m.rounded(number(a, "far"), 0.0).e
            }
            Depth::Divided if opacity.y == 0.0 => 0.0,
            // Normalizing the weights first rounds each of them once more.
            Depth::Divided => z.e + (m.u * samples.min(3) as f64 + beside(opacity, 1.0, c)) * z.size(),
        }
    };
    arrays([("depth", array(&[rays], (0..rays).map(error).collect()))])
}

/// Bound of [`super::super::backward::depth`]: g (t - z) / A, or g t / A - g (w . t) / A^2.
pub(crate) fn expected_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let (rays, samples) = size(a, "weights");
    let (mut g_weights, mut g_t) = (vec![], vec![]);
    for (r, g) in values(a, "grad_depth").into_iter().enumerate() {
        let (weighted, opacity, z) = divided(a, r, m);
        for (w, t) in row(a, "weights", r).into_iter().zip(row(a, "t", r)) {
            let (g, w, t) = (exact(g), exact(w), exact(t));
            let (on_w, on_t) = match c.depth {
                Depth::Plain => (m.mul(g, t), m.mul(g, w)),
                // g (t - far), or g t - g far, as autograd adds up what comes back from the sum and from A.
                Depth::FarBehind => {
                    let far = m.rounded(number(a, "far"), 0.0);
                    let terms = m.sub(m.mul(g, t), m.mul(g, far));
                    (m.mul(g, m.sub(t, far)).or(terms), m.mul(g, w))
                }
                // g t / eps, whatever eps is. The first and the last t that a depth is clipped to may be constants.
                Depth::Divided if opacity.y == 0.0 && c.empty_depth != EmptyDepth::Far => {
                    let clipped = c.empty_depth != EmptyDepth::Zero;
                    let on_t = if clipped { g.size() } else { 0.0 };
                    (exact(0.0).widened(f64::INFINITY), exact(0.0).widened(on_t))
                }
                Depth::Divided if opacity.y == 0.0 => (exact(0.0), exact(0.0)),
                Depth::Divided => {
                    let factored = m.div(m.mul(g, m.sub(t, z)), opacity);
                    let square = m.mul(opacity, opacity);
                    let terms = m.sub(m.mul(m.div(g, opacity), t), m.div(m.mul(g, weighted), square));
                    // g t / A and g z / A cancel: each moves by the number beside A.
                    let size = (g.size() * t.size() + g.size() * z.size()) / opacity.y;
                    let on_t = m.div(m.mul(g, w), opacity).or(m.mul(m.div(g, opacity), w));
                    (
                        factored.or(terms).widened(beside(opacity, 2.0, c) * size),
                        on_t.widened(beside(opacity, 1.0, c) * on_t.size()),
                    )
                }
            };
            g_weights.push(on_w.e);
            g_t.push(on_t.e);
        }
    }
    arrays([("grad_weights", array(&[rays, samples], g_weights)), ("grad_t", array(&[rays, samples], g_t))])
}
