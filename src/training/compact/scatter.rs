//! The distortion loss of a chunk's rays: weights that lie far apart along a ray cost, so that fog and floaters give way to surfaces.
//!
//! As [`crate::distortion`] has it, over places in [0, 1] that are even in 1 / distance between near and far, as mip-NeRF 360 takes them:
//! what is far may be as deep as it is wide in the picture. A sample's interval is its step.

use std::ops::Range;

use super::pace::Pace;
use super::settings::CompactSettings;

/// What weights cost by where they are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scatter {
    /// The loss' factor over the number of rays.
    factor: f32,
    pace: Pace,
    /// Where places begin: `near`, or a thousandth of `far` where rays begin at the camera, whose 1 / distance is infinite.
    near: f32,
    /// 1 / (1 / near - 1 / far).
    scale: f32,
}

impl Scatter {
    /// For a batch of so many rays at a pace, if the loss is in use.
    pub(super) fn new(settings: &CompactSettings, pace: Pace, rays: usize) -> Option<Self> {
        let CompactSettings { near, far, distortion, .. } = *settings;
        let near = near.max(1e-3 * far);
        let scale = 1.0 / (1.0 / near - 1.0 / far);
        let factor = (distortion / rays as f64) as f32;
        (factor > 0.0).then_some(Scatter { factor, pace, near: near as f32, scale: scale as f32 })
    }

    /// Into column 6 of a ray's samples: the loss' gradient with respect to their weights, which are in column 3:
    /// 2 sum_j w_j |m_i - m_j| + 2/3 w_i width_i, by sums over the samples in front and behind.
    #[inline(always)]
    pub(super) fn charge(&self, t: &[f32], samples: &mut [[f32; 16]], ray: Range<usize>) {
        let (t, samples) = (&t[ray.clone()], &mut samples[ray]);
        let (mut weights, mut moments) = (0.0, 0.0);
        for (sample, &t) in samples.iter_mut().zip(t) {
            let t = t.max(self.near);
            let (w, m) = (sample[3], (1.0 / self.near - 1.0 / t) * self.scale);
            let width = self.pace.step(t) / (t * t) * self.scale;
            // What lies in front: sum of w_j (m_i - m_j).
            sample[6] = 2.0 * (m * weights - moments) + 2.0 / 3.0 * w * width;
            sample[7] = m;
            (weights, moments) = (weights + w, moments + w * m);
        }
        let (mut weights, mut moments) = (0.0, 0.0);
        for sample in samples.iter_mut().rev() {
            let (w, m) = (sample[3], sample[7]);
            sample[6] = self.factor * (sample[6] + 2.0 * (moments - m * weights));
            (weights, moments) = (weights + w, moments + w * m);
        }
    }
}
