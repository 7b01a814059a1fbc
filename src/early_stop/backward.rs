//! Vector-Jacobian product of packed rendering with early stop, by hand.

use crate::convention::ProductEps;
use crate::volume_rendering::Rendering;
use crate::volume_rendering::backward::{Cotangent, volume_render};

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
