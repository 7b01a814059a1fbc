//! Vector-Jacobian products of volume rendering, by hand. `g_` marks the gradient of the loss with respect to what follows.

use super::{Rendering, optical_depths, product};
use crate::convention::{Depth, EmptyDepth, ProductEps};
use crate::math::{Sum, exp, expm1};

/// Gradients of the loss with respect to what a ray returns.
#[derive(Clone, Debug, PartialEq)]
pub struct Cotangent {
    /// With respect to C.
    pub color: [f64; 3],
    /// With respect to each weight, (N).
    pub weights: Vec<f64>,
    /// With respect to A.
    pub opacity: f64,
    /// With respect to the transmittance behind the last sample.
    pub transmittance: f64,
}

/// Gradients of [`super::volume_render_alpha`] with respect to `alphas` and `rgbs`.
///
/// g_alpha_i = T_i (g_w_i - B_{i+1}) and g_c_i = w_i g_C, where g_w_i = g_C . c_i + g_weights_i + g_A is the value of one unit of weight,
/// and B_i = alpha_i g_w_i + (1 - alpha_i + eps) B_{i+1} the value of one unit of light that arrives at sample i; B_N = g_T. Nothing is
/// divided by 1 - alpha, so opaque samples are exact.
///
/// # Panics
/// Where the lengths differ: N of everything, N + 1 transmittances.
pub fn volume_render_alpha(
    alphas: &[f64],
    rgbs: &[[f64; 3]],
    eps: ProductEps,
    forward: &Rendering,
    g: &Cotangent,
) -> (Vec<f64>, Vec<[f64; 3]>) {
    assert_eq!(alphas.len(), rgbs.len(), "alphas and rgbs: one each a sample");
    let through: Vec<f64> = alphas.iter().map(|alpha| 1.0 - alpha).collect();
    through_samples(alphas, &through, rgbs, eps, forward, g)
}

/// The formula above, given what each sample lets through, without eps.
fn through_samples(
    alphas: &[f64],
    through: &[f64],
    rgbs: &[[f64; 3]],
    eps: ProductEps,
    forward: &Rendering,
    g: &Cotangent,
) -> (Vec<f64>, Vec<[f64; 3]>) {
    let n = alphas.len();
    assert_eq!(forward.weights.len(), n, "forward.weights and samples: one each a sample");
    assert_eq!(
        forward.transmittance.len(),
        n + 1,
        "forward.transmittance and samples: one more than samples"
    );
    assert_eq!(g.weights.len(), n, "g.weights and samples: one each a sample");
    let (mut g_alphas, mut g_rgbs) = (vec![0.0; n], vec![[0.0; 3]; n]);
    let mut behind = Sum::default();
    behind.add(g.transmittance);
    for i in (0..n).rev() {
        let g_w = weight_gradient(rgbs[i], g.weights[i], g);
        g_alphas[i] = forward.transmittance[i] * (g_w - behind.value());
        g_rgbs[i] = g.color.map(|g_color| forward.weights[i] * g_color);
        // Compensated: in an empty ray each sample adds the same small number and rounds the same way, which sums up to 16 ULP over 64.
        let from_eps = eps.value() * behind.value();
        behind = behind.times(through[i]);
        behind.add(from_eps);
        behind.add(alphas[i] * g_w);
    }
    (g_alphas, g_rgbs)
}

/// Gradients of [`super::volume_render`] with respect to `sigmas`, `rgbs` and `deltas`.
///
/// With x = sigma delta: d alpha / dx = e^-x, so g_x_i = e^-x_i g_alpha_i, g_sigma = delta g_x, g_delta = sigma g_x. A sample
/// lets e^-x through, which is accurate where 1 - alpha has no digits left.
///
/// # Panics
/// Where the lengths differ: N of everything, N + 1 transmittances.
pub fn volume_render(
    sigmas: &[f64],
    rgbs: &[[f64; 3]],
    deltas: &[f64],
    eps: ProductEps,
    forward: &Rendering,
    g: &Cotangent,
) -> (Vec<f64>, Vec<[f64; 3]>, Vec<f64>) {
    assert_eq!(sigmas.len(), deltas.len(), "sigmas and deltas: one each a sample");
    assert_eq!(sigmas.len(), rgbs.len(), "sigmas and rgbs: one each a sample");
    let x = optical_depths(sigmas, deltas);
    let alphas: Vec<f64> = x.iter().map(|&x| -expm1(-x)).collect();
    let through: Vec<f64> = x.iter().map(|&x| exp(-x)).collect();
    let (g_alphas, g_rgbs) = through_samples(&alphas, &through, rgbs, eps, forward, g);
    let g_x: Vec<f64> = (0..x.len()).map(|i| exp(-x[i]) * g_alphas[i]).collect();
    (optical_depths(deltas, &g_x), g_rgbs, optical_depths(sigmas, &g_x))
}

/// g_C . c + g_weight + g_A.
fn weight_gradient(rgb: [f64; 3], g_weight: f64, g: &Cotangent) -> f64 {
    g.color[0] * rgb[0] + g.color[1] * rgb[1] + g.color[2] * rgb[2] + g_weight + g.opacity
}

/// Gradients of [`super::composite_background`] with respect to `color`, `opacity` and `background`.
///
/// C + (1 - A) b: g_C = g, g_A = -g . b, g_b = (1 - A) g.
pub fn composite_background(opacity: f64, background: [f64; 3], g: [f64; 3]) -> ([f64; 3], f64, [f64; 3]) {
    let g_opacity = -(g[0] * background[0] + g[1] * background[1] + g[2] * background[2]);
    (g, g_opacity, g.map(|g| (1.0 - opacity) * g))
}

/// Gradients of [`super::depth`] with respect to `weights` and `t`.
///
/// z = sum w t / A: g_w_i = g (t_i - z) / A and g_t_i = g w_i / A. Where A = 0, both are 0, since `far` is a constant; but the first or
/// last t has g, where that is an empty ray's depth by convention. z = sum w t + (1 - A) far: g_w_i = g (t_i - far) and g_t_i = g w_i.
///
/// # Panics
/// Where the lengths differ.
pub fn depth(
    weights: &[f64],
    t: &[f64],
    far: f64,
    convention: Depth,
    empty: EmptyDepth,
    g: f64,
) -> (Vec<f64>, Vec<f64>) {
    assert_eq!(weights.len(), t.len(), "weights and t: one each a sample");
    let mut opacity = Sum::default();
    weights.iter().for_each(|&w| opacity.add(w));
    let opacity = opacity.value();
    match convention {
        Depth::Plain | Depth::FarBehind => {
            let behind = if convention == Depth::FarBehind { far } else { 0.0 };
            let g_weights = t.iter().map(|t| product(g, t - behind)).collect();
            (g_weights, weights.iter().map(|w| g * w).collect())
        }
        Depth::Divided if opacity == 0.0 => {
            let mut g_t = vec![0.0; t.len()];
            for i in 0..t.len() {
                let (first, last) = (i == 0, i + 1 == t.len());
                if first && empty == EmptyDepth::First || last && empty == EmptyDepth::Last {
                    g_t[i] = g;
                }
            }
            (vec![0.0; t.len()], g_t)
        }
        Depth::Divided => {
            let z = super::depth(weights, t, 0.0, Depth::Divided, EmptyDepth::Far);
            let g_weights = t.iter().map(|t| product(g, t - z) / opacity).collect();
            (g_weights, weights.iter().map(|w| g * (w / opacity)).collect())
        }
    }
}
