//! One training step: march rays, encode, networks forward and backward, scatter, Adam.

use super::CompactModel;
use super::chunk::{Chunk, Pass};
use super::forward::run;
use super::kernels::{Multiply, Plain};
use super::march::March;
use super::networks::Weights;
use super::pace::Pace;
use super::scatter::Scatter;
use crate::hash_grid::fast::{self as hash_grid, Level};
use crate::optimizer::Adam;
use crate::optimizer::fast::Rates;
use crate::parallel;
use crate::random::{Key, Purpose};
use crate::training::StepReport;

/// Samples per chunk, approximately: their activations stay in a core's L2 cache.
pub(crate) const CHUNK: usize = 1024;

/// Rays of the first step, before the number of samples per ray is known.
pub(super) const FIRST_RAYS: usize = 512;

impl CompactModel {
    /// Adam of Instant-NGP, `eps` far below every gradient that matters.
    fn rates(&self, lr: f64, step: u64) -> Rates {
        let lr = lr * self.settings.lr_factor(step);
        Rates::new(&Adam { lr, beta1: 0.9, beta2: 0.99, eps: 1e-15, weight_decay: 0.0 }, step)
    }

    /// The pass that the chunks of a step or of a picture share.
    pub(super) fn pass(&self, gradient: Option<f32>) -> Pass<'_> {
        Pass {
            nets: &self.nets,
            weights: &self.nets.weights,
            stop: self.settings.stop as f32,
            view_dependent: self.settings.view_dependent,
            gradient,
            scatter: None,
        }
    }

    /// Step `step`, counted from 1.
    pub(super) fn train_step(&mut self, step: u64) -> StepReport {
        let mut chunks = std::mem::take(&mut self.chunks);
        let rays = self.draw(&mut chunks, step);
        self.run(&mut chunks, rays, step, &Plain);
        let slope = self.apply(&mut chunks, step);
        let seen: usize = chunks.iter().map(|c| c.visited.len()).sum();
        let live: usize = chunks.iter().map(|c| c.counted).sum();
        self.again = chunks.iter().flat_map(|c| c.again.iter().copied()).collect();
        let counted = (rays - self.again.len()).max(1);
        let error: f64 = chunks.iter().map(|c| c.error).sum();
        self.chunks = chunks;
        self.rays = self.settings.rays.unwrap_or_else(|| {
            let wanted = self.settings.batch_at(step) as f64 / seen.max(1) as f64;
            (rays as f64 * wanted.clamp(0.5, 1.5)).clamp(64.0, 65_536.0) as usize
        });
        self.update_occupancy(step);
        self.average(step);
        if seen == 0 {
            self.reopen();
        }
        let mse = error / (3 * counted) as f64;
        // A gradient that is no number spoils all weights; activations of NaN may still look like 0.
        let loss = if slope.is_finite() { mse } else { f64::NAN };
        StepReport { loss, mse, samples: live as u64, still: slope == 0.0 }
    }

    /// A step's batch: random rays, marched and encoded; how many they are.
    pub(crate) fn draw(&self, chunks: &mut Vec<Chunk>, step: u64) -> usize {
        let count = self.settings.batch_at(step) / CHUNK;
        chunks.resize_with(count, Chunk::default);
        let rays_each = self.rays.div_ceil(count);
        self.march(chunks, rays_each, self.settings.samples_at(step), step);
        self.encode(chunks, step);
        rays_each * count
    }

    /// Forward and backward of a step's batch of `rays` rays; `on` multiplies.
    pub(crate) fn run(&self, chunks: &mut [Chunk], rays: usize, step: u64, on: &impl Multiply) {
        let mut pass = self.pass(Some(2.0 / (3 * rays) as f32));
        let pace = Pace::new(&self.settings, self.settings.samples_at(step));
        pass.scatter = Scatter::new(&self.settings, pace, rays);
        parallel::for_each(chunks, |chunk| run(self.arch, &pass, chunk, on));
    }

    fn march(&self, chunks: &mut [Chunk], rays_each: usize, samples: f64, step: u64) {
        let pace = Pace::new(&self.settings, samples);
        let keys = [Purpose::Rays, Purpose::Samples].map(|purpose| Key::new(self.settings.seed, purpose));
        parallel::for_chunks(chunks, 1, |c, chunk| {
            let rays = c * rays_each..(c + 1) * rays_each;
            self.arch.dispatch(March { model: self, keys, step, pace, rays, chunk: &mut chunk[0] });
        });
    }

    /// Level by level over many chunks, so that a level's table stays in the L2 cache while it is read.
    fn encode(&self, chunks: &mut [Chunk], step: u64) {
        let active = self.settings.levels_at(step);
        let share = chunks.len().div_ceil(parallel::threads());
        parallel::for_chunks(chunks, share, |_, chunks| {
            for (l, level) in self.levels.iter().enumerate().take(active) {
                for chunk in &mut *chunks {
                    let out = &mut chunk.encoding[l];
                    hash_grid::encode_level(self.arch, level, level.table(), &chunk.points, out);
                }
            }
            chunks.iter_mut().for_each(|chunk| chunk.clear_levels(active));
        });
    }

    /// Gradients of all chunks, in order, into Adam. The occupancy grid learns the densities seen meanwhile.
    /// Returns the networks' slope, the sum of the sizes of its entries.
    fn apply(&mut self, chunks: &mut [Chunk], step: u64) -> f32 {
        let mut gradient = Weights::zeros();
        chunks.iter().for_each(|chunk| gradient.add(&chunk.gradient));
        let slope = gradient.parts().into_iter().flatten().map(|g| g.abs()).sum();
        let [grid_lr, net_lr] = self.settings.lr;
        self.nets.update(&gradient, self.rates(net_lr, step));
        let (rates, active, arch) = (self.rates(grid_lr, step), self.settings.levels_at(step), self.arch);
        let (levels, gradients, occupancy) = (&mut self.levels, &mut self.gradients, &mut self.occupancy);
        let chunks = &*chunks;
        parallel::join(
            || chunks.iter().for_each(|chunk| occupancy.raise(&chunk.visited, &chunk.sigma)),
            || {
                let mut levels = balanced(levels, active);
                parallel::for_each_with(&mut levels, gradients, |(l, level), gradient| {
                    for chunk in chunks {
                        hash_grid::scatter(arch, level, &chunk.points, &chunk.encoding[*l], gradient);
                    }
                    hash_grid::update(arch, level, gradient, rates);
                });
            },
        );
        slope
    }
}

/// The first `active` levels, fine and coarse alternating: fine ones cost more, and neighbors go to the same thread.
fn balanced(levels: &mut [Level], active: usize) -> Vec<(usize, &mut Level)> {
    let mut left: std::collections::VecDeque<_> = levels.iter_mut().enumerate().take(active).collect();
    let mut out = vec![];
    while let Some(fine) = left.pop_back() {
        out.push(fine);
        out.extend(left.pop_front());
    }
    out
}
