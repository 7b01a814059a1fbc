//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{Form, Splat, alpha as oracle, backward};
use crate::contract::arrays::{Arrays, array, arrays, rows, threes, twos, values};
use crate::convention::Conventions;
use crate::math::Sum;

/// How opacities are cut.
pub(crate) fn form(c: &Conventions) -> Form {
    Form {
        cap: c.alpha_cap,
        faint: c.faint,
        power: c.positive_power,
        cap_gradient: c.cap_gradient,
        conic_gradient: c.conic_gradient,
    }
}

/// The splats of a case.
pub(crate) fn splats(a: &Arrays) -> Vec<Splat> {
    let shapes = twos(a, "means2d").into_iter().zip(threes(a, "conics"));
    shapes
        .zip(values(a, "opacities"))
        .map(|((mean, conic), opacity)| Splat { mean, conic, opacity })
        .collect()
}

/// `f(pixel, splat)` of each pair, as the output.
pub(crate) fn forward(a: &Arrays, f: impl Fn([f64; 2], &Splat) -> f64) -> Arrays {
    let (pixels, splats) = (twos(a, "pixels"), splats(a));
    let alphas = pixels.iter().flat_map(|&pixel| splats.iter().map(move |splat| (pixel, splat)));
    let alphas = alphas.map(|(pixel, splat)| f(pixel, splat)).collect();
    arrays([("alphas", array(&[pixels.len(), splats.len()], alphas))])
}

/// `f(pixel, splat, cotangent)` of each pair: the six gradients of a splat, which `add` gathers over the pixels.
pub(crate) fn vjp<T>(
    a: &Arrays,
    f: impl Fn([f64; 2], &Splat, f64) -> [T; 6],
    add: impl Fn(&[T]) -> f64,
) -> Arrays {
    let (pixels, splats, g) = (twos(a, "pixels"), splats(a), rows(a, "grad_alphas"));
    let (mut g_means, mut g_conics, mut g_opacities) = (vec![], vec![], vec![]);
    for (n, splat) in splats.iter().enumerate() {
        let mut parts: [Vec<T>; 6] = Default::default();
        for (p, &pixel) in pixels.iter().enumerate() {
            parts.iter_mut().zip(f(pixel, splat, g[p][n])).for_each(|(parts, part)| parts.push(part));
        }
        let [x, y, a, b, c, opacity] = parts.map(|parts| add(&parts));
        g_means.extend([x, y]);
        g_conics.extend([a, b, c]);
        g_opacities.push(opacity);
    }
    let n = splats.len();
    arrays([
        ("grad_means2d", array(&[n, 2], g_means)),
        ("grad_conics", array(&[n, 3], g_conics)),
        ("grad_opacities", array(&[n], g_opacities)),
    ])
}

/// A splat's gradients in a row.
pub(crate) fn six(g: &Splat) -> [f64; 6] {
    let ([x, y], [a, b, c]) = (g.mean, g.conic);
    [x, y, a, b, c, g.opacity]
}

/// A compensated sum.
pub(crate) fn total(parts: &[f64]) -> f64 {
    let mut sum = Sum::default();
    parts.iter().for_each(|&x| sum.add(x));
    sum.value()
}

pub(super) fn alpha(a: &Arrays, c: &Conventions) -> Arrays {
    forward(a, |pixel, splat| oracle(pixel, splat, form(c)))
}

pub(super) fn alpha_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    vjp(a, |pixel, splat, g| six(&backward::alpha(pixel, splat, form(c), g)), total)
}
