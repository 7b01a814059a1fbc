//! Volume rendering in f32 for many rays: exponentials vectorized over all samples, then one scan per ray.
//!
//! x = sigma delta optical depth, alpha = 1 - e^-x, T transmittance, w = T alpha.
//! One polynomial gives both e^-x and alpha = -expm1(-x), so that thin samples keep their relative accuracy and T is a
//! product of N factors instead of N exponentials of sums.

use pulp::{Arch, Simd, WithSimd};

use crate::approximate::{Grade, attenuation};

/// Densities of a batch of rays turned into weights.
#[derive(Clone, Debug, Default)]
pub struct RayWeights {
    /// w_i = T_i alpha_i (R, N).
    pub weights: Vec<f32>,
    /// T_{i+1}, the transmittance behind sample i (R, N).
    pub behind: Vec<f32>,
    alpha: Vec<f32>,
}

impl RayWeights {
    /// Weights of R rays with `samples` samples each; earlier contents are overwritten.
    ///
    /// # Shapes
    /// `sigmas`, `deltas` (R, N).
    ///
    /// # Panics
    /// Where the lengths differ, or aren't whole rays.
    pub fn compute(&mut self, arch: Arch, sigmas: &[f32], deltas: &[f32], samples: usize) {
        assert_eq!(sigmas.len(), deltas.len(), "sigmas and deltas: one each a sample");
        assert!(
            sigmas.len().is_multiple_of(samples),
            "{} sigmas are no whole rays of {samples}",
            sigmas.len()
        );
        let RayWeights { weights, behind, alpha } = self;
        for buffer in [&mut *weights, behind, alpha] {
            buffer.resize(sigmas.len(), 0.0);
        }
        arch.dispatch(Attenuate { sigmas, deltas, behind, alpha });
        let rays = weights.chunks_mut(samples).zip(behind.chunks_mut(samples)).zip(alpha.chunks(samples));
        for ((weights, behind), alpha) in rays {
            let mut t = 1.0;
            for ((w, behind), alpha) in weights.iter_mut().zip(behind).zip(alpha) {
                *w = t * alpha;
                t *= *behind;
                *behind = t;
            }
        }
    }
}

/// Gradient with respect to the densities of one ray, of g . (sum w_i c_i + T_end background).
///
/// d/d sigma_i = delta_i (T_{i+1} q_i - sum_{j>i} w_j q_j - T_end b), with q_i = g . c_i and b = g . background: what the
/// sample adds, minus what it takes from everything behind it. No division, so that alpha = 1 is no special case.
///
/// # Shapes
/// All slices (N). `q` is overwritten with the gradient.
pub fn density_gradient(weights: &[f32], behind: &[f32], deltas: &[f32], b: f32, q: &mut [f32]) {
    let lengths = [weights.len(), behind.len(), deltas.len()];
    debug_assert_eq!(lengths, [q.len(); 3], "weights, behind, deltas and q: one each a sample");
    let mut taken = behind.last().map_or(0.0, |t| t * b);
    for i in (0..q.len()).rev() {
        let gradient = deltas[i] * (behind[i] * q[i] - taken);
        taken += weights[i] * q[i];
        q[i] = gradient;
    }
}

/// e^-x and alpha of every sample.
struct Attenuate<'a> {
    sigmas: &'a [f32],
    deltas: &'a [f32],
    behind: &'a mut [f32],
    alpha: &'a mut [f32],
}

impl WithSimd for Attenuate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let inputs = self.sigmas.iter().zip(self.deltas);
        for ((behind, alpha), (sigma, delta)) in self.behind.iter_mut().zip(self.alpha.iter_mut()).zip(inputs)
        {
            (*behind, *alpha) = attenuation(sigma * delta, Grade::Full);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three spikes of optical depth ln 2: weights 1/2, 1/4, 1/8 (and what is behind them).
    #[test]
    fn three_spikes() {
        let mut sigmas = [0.0f32; 8];
        for i in [0, 1, 7] {
            sigmas[i] = std::f32::consts::LN_2 * 2.0;
        }
        let mut rays = RayWeights::default();
        rays.compute(crate::simd::arch(), &sigmas, &[0.5; 8], 8);
        for (i, w) in [(0, 0.5), (1, 0.25), (7, 0.125)] {
            assert!((rays.weights[i] - w).abs() < 1e-7);
        }
        assert!((rays.behind[7] - 0.125).abs() < 1e-7);
    }
}
