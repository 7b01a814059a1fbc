//! Volume rendering: densities and colors along a ray -> one color.
//!
//! NeRF (Mildenhall et al. 2020) equation 3, after Max, "Optical models for direct volume rendering" (1995).
//! Letters, for sample i of N: `sigma` density, `delta` step length, x = sigma delta optical depth, `alpha` = 1 - e^-x
//! opacity, `T` = product of (1 - alpha) of the samples before = transmittance, `w` = T alpha weight, `c` color,
//! A = sum of w, the ray's opacity.

use crate::convention::{Depth, EmptyDepth, ProductEps};
use crate::math::{Product, Sum, exp, expm1};

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
#[cfg(feature = "fast")]
pub mod fast;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// What volume rendering returns for a ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendering {
    /// C = sum w_i c_i, without any background.
    pub color: [f64; 3],
    /// w_i = T_i alpha_i, (N).
    pub weights: Vec<f64>,
    /// T_i in front of each sample and, last, behind all of them: (N + 1).
    pub transmittance: Vec<f64>,
    /// A = sum w_i.
    pub opacity: f64,
}

/// Renders one ray from densities: alpha_i = 1 - exp(-sigma_i delta_i), T_i = exp(-sum_{j<i} sigma_j delta_j).
///
/// # Shapes
/// `sigmas` (N), `rgbs` (N), `deltas` (N).
///
/// # Units
/// sigma in 1 / length, delta in the same length, so that x = sigma delta has no unit. sigma >= 0 and delta >= 0; where one is
/// infinite and the other 0, x is 0.
///
/// # Convention
/// `eps` is added to each factor 1 - alpha, as some implementations do; [`ProductEps::None`] is the formula.
///
/// # Panics
/// Where the lengths differ.
///
/// ```
/// use nerf_oracle::{convention::ProductEps, volume_rendering::volume_render};
/// let ln2 = std::f64::consts::LN_2;
/// let r = volume_render(&[ln2, ln2, 0.0, ln2], &[[1.0; 3]; 4], &[1.0; 4], ProductEps::None);
/// assert_eq!(r.weights, [0.5, 0.25, 0.0, 0.125]);
/// assert!((r.transmittance[4] - 0.125).abs() < 1e-16); // ln 2 itself is rounded
/// ```
pub fn volume_render(sigmas: &[f64], rgbs: &[[f64; 3]], deltas: &[f64], eps: ProductEps) -> Rendering {
    assert_eq!(sigmas.len(), deltas.len(), "sigmas and deltas: one each a sample");
    assert_eq!(sigmas.len(), rgbs.len(), "sigmas and rgbs: one each a sample");
    let x = optical_depths(sigmas, deltas);
    let alphas: Vec<f64> = x.iter().map(|&x| -expm1(-x)).collect();
    if eps != ProductEps::None {
        return volume_render_alpha(&alphas, rgbs, eps);
    }
    // The sum in the exponent is compensated: 1,024 samples lose no more digits than one.
    let mut depth = Sum::default();
    let mut transmittance = vec![1.0];
    for &x in &x {
        depth.add(x);
        transmittance.push(exp(-depth.value()));
    }
    composite(&alphas, rgbs, transmittance)
}

/// x_i = sigma_i delta_i, 0 where either is 0, even if the other is infinite.
pub(crate) fn optical_depths(sigmas: &[f64], deltas: &[f64]) -> Vec<f64> {
    (0..sigmas.len()).map(|i| product(sigmas[i], deltas[i])).collect()
}

/// a b, 0 where either is 0, even if the other is infinite.
pub(crate) fn product(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

/// Renders one ray from opacities: T_i = prod_{j<i} (1 - alpha_j + eps).
///
/// # Shapes
/// `alphas` (N) in [0, 1], `rgbs` (N).
///
/// # Panics
/// Where the lengths differ.
///
/// ```
/// use nerf_oracle::{convention::ProductEps, volume_rendering::volume_render_alpha};
/// let r = volume_render_alpha(&[0.5, 1.0, 0.3], &[[1.0; 3]; 3], ProductEps::None);
/// assert_eq!(r.weights, [0.5, 0.5, 0.0]);
/// ```
pub fn volume_render_alpha(alphas: &[f64], rgbs: &[[f64; 3]], eps: ProductEps) -> Rendering {
    assert_eq!(alphas.len(), rgbs.len(), "alphas and rgbs: one each a sample");
    // Compensated, as the sum above: a plain product of 1,024 factors is off by 22 ULP.
    let mut light = Product::default();
    let mut transmittance = vec![1.0];
    for &alpha in alphas {
        let mut through = Sum::default();
        [1.0, -alpha, eps.value()].iter().for_each(|&x| through.add(x));
        light.multiply(through);
        transmittance.push(light.value());
    }
    composite(alphas, rgbs, transmittance)
}

/// w_i = T_i alpha_i, C = sum w_i c_i, A = sum w_i.
fn composite(alphas: &[f64], rgbs: &[[f64; 3]], transmittance: Vec<f64>) -> Rendering {
    let (mut color, mut opacity) = ([Sum::default(); 3], Sum::default());
    let mut weights = Vec::with_capacity(alphas.len());
    for (i, &alpha) in alphas.iter().enumerate() {
        let w = transmittance[i] * alpha;
        for (sum, c) in color.iter_mut().zip(rgbs[i]) {
            sum.add(w * c);
        }
        opacity.add(w);
        weights.push(w);
    }
    Rendering { color: color.map(|sum| sum.value()), weights, transmittance, opacity: opacity.value() }
}

/// The color over a background b: C + (1 - A) b.
///
/// ```
/// let c = nerf_oracle::volume_rendering::composite_background([0.25; 3], 0.5, [1.0, 0.0, 0.5]);
/// assert_eq!(c, [0.75, 0.25, 0.5]);
/// ```
pub fn composite_background(color: [f64; 3], opacity: f64, background: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| color[k] + (1.0 - opacity) * background[k])
}

/// Expected distance: sum w_i t_i / A, and `far` where A = 0; or the sum alone; or the sum and (1 - A) far. A sample without weight
/// adds nothing, even at an infinite distance.
///
/// # Convention
/// `empty`: an empty ray's depth, where the sum is divided; the first and the last t of a ray without samples are `far` too.
///
/// # Shapes
/// `weights` (N), `t` (N).
///
/// # Panics
/// Where the lengths differ.
///
/// ```
/// use nerf_oracle::{convention::{Depth, EmptyDepth}, volume_rendering};
/// let depth = |w: &[f64], t: &[f64], far, of| volume_rendering::depth(w, t, far, of, EmptyDepth::Far);
/// assert_eq!(depth(&[0.25, 0.25], &[2.0, 4.0], 6.0, Depth::Divided), 3.0);
/// assert_eq!(depth(&[0.25, 0.25], &[2.0, 4.0], 6.0, Depth::Plain), 1.5);
/// assert_eq!(depth(&[0.0, 0.0], &[2.0, 4.0], 6.0, Depth::Divided), 6.0);
/// assert_eq!(depth(&[0.25, 0.25], &[2.0, 4.0], 6.0, Depth::FarBehind), 4.5);
/// ```
pub fn depth(weights: &[f64], t: &[f64], far: f64, convention: Depth, empty: EmptyDepth) -> f64 {
    assert_eq!(weights.len(), t.len(), "weights and t: one each a sample");
    let (mut weighted, mut opacity) = (Sum::default(), Sum::default());
    for (w, t) in weights.iter().zip(t) {
        weighted.add(product(*w, *t));
        opacity.add(*w);
    }
    match convention {
        Depth::Plain => weighted.value(),
        Depth::FarBehind => {
            // Term by term, as 1 - A cancels.
            weights.iter().for_each(|w| weighted.add(-product(*w, far)));
            weighted.add(far);
            weighted.value()
        }
        Depth::Divided if opacity.value() == 0.0 => match empty {
            EmptyDepth::Zero => 0.0,
            EmptyDepth::First if !t.is_empty() => t[0],
            EmptyDepth::Last if !t.is_empty() => t[t.len() - 1],
            _ => far,
        },
        Depth::Divided => weighted.value() / opacity.value(),
    }
}
