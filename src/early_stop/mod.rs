//! Early stop: samples behind which almost no light comes through are left out; rays of different lengths, packed.
//!
//! Letters as in volume rendering: x_i = sigma_i delta_i, T_i = exp(-sum_{j<i} x_j), a ray is followed
//! until T < `eps`. Nothing is renormalized: the light that is left goes on to the background. By a convention a ray that has
//! stopped is divided by its opacity (instant-ngp, VR5).
//! Packed: the samples of all rays in one array; those of ray r are `offsets[r] .. offsets[r + 1]`.

use crate::convention::{ProductEps, Stop};
use crate::math::{Sum, exp};
use crate::volume_rendering::{Rendering, optical_depths, volume_render};

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// How many samples of a ray are used: up to and including the first behind which T < `eps`; all where there is none.
///
/// # Error
/// Let n be the result, c_i in [0, 1] and b in [0, 1] the background. The color of the first n samples over the background differs
/// from the full one, channel by channel, by at most T_n < eps: what is behind changes from some color in [0, 1] to b, and
/// contributes T_n times that.
///
/// # Panics
/// Where the lengths differ.
///
/// ```
/// use nerf_oracle::early_stop::live_samples;
/// let ln2 = std::f64::consts::LN_2;
/// // T behind the samples: 1/2, 1/4, 1/8, 1/16.
/// assert_eq!(live_samples(&[ln2; 4], &[1.0; 4], 0.2), 3);
/// assert_eq!(live_samples(&[ln2; 4], &[1.0; 4], 0.0), 4);
/// ```
pub fn live_samples(sigmas: &[f64], deltas: &[f64], eps: f64) -> usize {
    assert_eq!(sigmas.len(), deltas.len(), "sigmas and deltas: one each a sample");
    let x = optical_depths(sigmas, deltas);
    let mut depth = Sum::default();
    for i in 0..x.len() {
        depth.add(x[i]);
        if exp(-depth.value()) < eps {
            return i + 1;
        }
    }
    x.len()
}

/// The samples that are used: [`live_samples`], without the one that ends the ray or with one more where that is the convention.
pub(crate) fn used_samples(sigmas: &[f64], deltas: &[f64], eps: f64, stop: Stop) -> usize {
    let live = live_samples(sigmas, deltas, eps);
    let mut depth = Sum::default();
    optical_depths(&sigmas[..live], &deltas[..live]).into_iter().for_each(|x| depth.add(x));
    let stopped = live > 0 && exp(-depth.value()) < eps;
    match stop {
        Stop::InFront if stopped => live - 1,
        // All of them where nothing stopped it.
        Stop::OneMore => (live + 1).min(sigmas.len()),
        _ => live,
    }
}

/// Renders packed rays with early stop: for each ray [`live_samples`], and [`volume_render`] of so many samples.
///
/// # Shapes
/// `sigmas` (S), `rgbs` (S), `deltas` (S), `offsets` (R + 1) from 0 to S, never falling; a ray may have no samples at all. The
/// result has the live samples' weights alone: those behind are 0.
///
/// # Panics
/// Where the lengths differ, `offsets` are none, fall or lead past S.
///
/// ```
/// use nerf_oracle::early_stop::render_packed;
/// let ln2 = std::f64::consts::LN_2;
/// // Rays of 3, 0 and 1 samples.
/// let rays = render_packed(&[ln2; 4], &[[1.0; 3]; 4], &[1.0; 4], &[0, 3, 3, 4], 0.3);
/// assert_eq!([rays[0].weights.len(), rays[1].weights.len(), rays[2].weights.len()], [2, 0, 1]);
/// assert!((rays[0].opacity - 0.75).abs() < 1e-15);
/// ```
pub fn render_packed(
    sigmas: &[f64],
    rgbs: &[[f64; 3]],
    deltas: &[f64],
    offsets: &[usize],
    eps: f64,
) -> Vec<Rendering> {
    assert_eq!(sigmas.len(), deltas.len(), "sigmas and deltas: one each a sample");
    assert_eq!(sigmas.len(), rgbs.len(), "sigmas and rgbs: one each a sample");
    assert!(!offsets.is_empty(), "offsets and rays: one more than rays, and not none");
    render_packed_to(sigmas, rgbs, deltas, offsets, eps, Stop::Behind)
}

/// A ray that has stopped, by a convention: C / A and w / A, opaque, and no light behind it.
pub(crate) fn made_opaque(ray: &Rendering) -> Rendering {
    let whole = ray.opacity;
    let mut opaque = ray.clone();
    opaque.color.iter_mut().chain(&mut opaque.weights).for_each(|x| *x /= whole);
    opaque.opacity = 1.0;
    *opaque.transmittance.last_mut().expect("one behind all samples") = 0.0;
    opaque
}

/// The same in a convention.
pub(crate) fn render_packed_to(
    sigmas: &[f64],
    rgbs: &[[f64; 3]],
    deltas: &[f64],
    offsets: &[usize],
    eps: f64,
    stop: Stop,
) -> Vec<Rendering> {
    let mut rays = vec![];
    for r in 0..offsets.len() - 1 {
        let (first, end) = (offsets[r], offsets[r + 1]);
        let last = first + used_samples(&sigmas[first..end], &deltas[first..end], eps, stop);
        let (s, c, d) = (&sigmas[first..last], &rgbs[first..last], &deltas[first..last]);
        rays.push(volume_render(s, c, d, ProductEps::None));
    }
    rays
}
