//! Vector-Jacobian product of packed rendering with early stop, by hand.

use crate::convention::ProductEps;
use crate::math::Sum;
use crate::volume_rendering::Rendering;
use crate::volume_rendering::backward::{Cotangent, volume_render};

/// The cotangent of a ray from that of the same ray made opaque, [`super::made_opaque`].
///
/// C' = C / A and w' = w / A, where A = sum w; A' = 1 and T' = 0 are constants. g_C = g_C' / A and g_w_i = (g_w'_i - K) / A, where
/// K = g_C' . C' + sum g_w' w' is what all the light is worth.
pub(crate) fn made_opaque(ray: &Rendering, g: &Cotangent) -> Cotangent {
    let whole = ray.opacity;
    let mut worth = Sum::default();
    for (value, g) in ray.color.iter().chain(&ray.weights).zip(g.color.iter().chain(&g.weights)) {
        worth.add(value / whole * g);
    }
    Cotangent {
        color: g.color.map(|g| g / whole),
        weights: g.weights.iter().map(|g| (g - worth.value()) / whole).collect(),
        opacity: 0.0,
        transmittance: 0.0,
    }
}

/// Gradients of [`super::render_packed`] with respect to `sigmas`, `rgbs` and `deltas`, packed.
///
/// The number of live samples is piecewise constant: they have the gradient of a ray of so many samples, those behind have none.
/// `rays` is what the forward pass returned; `g` has a cotangent a ray, whose weights are those of the live samples.
///
/// # Panics
/// Where the lengths differ, in all or in a ray.
pub fn render_packed(
    sigmas: &[f64],
    rgbs: &[[f64; 3]],
    deltas: &[f64],
    offsets: &[usize],
    rays: &[Rendering],
    g: &[Cotangent],
) -> (Vec<f64>, Vec<[f64; 3]>, Vec<f64>) {
    let n = sigmas.len();
    assert_eq!(n, deltas.len(), "sigmas and deltas: one each a sample");
    assert_eq!(n, rgbs.len(), "sigmas and rgbs: one each a sample");
    assert_eq!(offsets.len(), rays.len() + 1, "offsets and rays: one more than rays");
    assert_eq!(g.len(), rays.len(), "g and rays: one each a ray");
    let (mut g_sigmas, mut g_rgbs, mut g_deltas) = (vec![0.0; n], vec![[0.0; 3]; n], vec![0.0; n]);
    for r in 0..rays.len() {
        let first = offsets[r];
        let last = first + rays[r].weights.len();
        let (s, c, d) = (&sigmas[first..last], &rgbs[first..last], &deltas[first..last]);
        let live = volume_render(s, c, d, ProductEps::None, &rays[r], &g[r]);
        g_sigmas[first..last].copy_from_slice(&live.0);
        g_rgbs[first..last].copy_from_slice(&live.1);
        g_deltas[first..last].copy_from_slice(&live.2);
    }
    (g_sigmas, g_rgbs, g_deltas)
}
