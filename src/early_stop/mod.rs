//! Early stop: samples behind which almost no light comes through are left out.
//!
//! Letters as in volume rendering: x_i = sigma_i delta_i, T_i = exp(-sum_{j<i} x_j), `eps` the smallest transmittance that is
//! followed. Nothing is renormalised (instant-ngp divides by the opacity, VR5): the light that is left goes on to the background.

use crate::maths::{Sum, exp};

#[cfg(test)]
mod tests;

/// How many samples of a ray are used: up to and including the first behind which T < `eps`; all where there is none.
///
/// # Error
/// Let n be the result, c_i in [0, 1] and b in [0, 1] the background. The colour of the first n samples over the background differs
/// from the full one, channel by channel, by at most T_n < eps: what is behind changes from some colour in [0, 1] to b, and
/// contributes T_n times that.
///
/// ```
/// use nerf_oracle::early_stop::live_samples;
/// let ln2 = std::f64::consts::LN_2;
/// // T behind the samples: 1/2, 1/4, 1/8, 1/16.
/// assert_eq!(live_samples(&[ln2; 4], &[1.0; 4], 0.2), 3);
/// assert_eq!(live_samples(&[ln2; 4], &[1.0; 4], 0.0), 4);
/// ```
pub fn live_samples(sigmas: &[f64], deltas: &[f64], eps: f64) -> usize {
    let mut depth = Sum::default();
    for i in 0..sigmas.len() {
        depth.add(sigmas[i] * deltas[i]);
        if exp(-depth.value()) < eps {
            return i + 1;
        }
    }
    sigmas.len()
}
