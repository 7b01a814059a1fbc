//! Renders rays with a trained model, without jitter. The occupancy grid is part of the model: density is 0 in empty cells.
//!
//! In rounds: each takes the next few samples of every ray that has light left, so that hardly anything behind a surface is evaluated,
//! and no ray ends before its light does.

use super::CompactModel;
use super::chunk::{self, Chunk, Pass};
use super::forward::run;
use super::kernels::Plain;
use super::pace::Pace;
use super::views::{BoxRay, Target};
use crate::hash_grid::fast as hash_grid;
use crate::occupancy_grid::fast::MarchRay;
use crate::parallel;
use crate::ray::Ray;
use crate::training::Pixel;

/// Rays of a chunk.
const RAYS: usize = 128;
/// Chunks per task, which reuses its buffers.
const CHUNKS: usize = 16;
/// Samples of a round, about: their activations stay in a core's L2 cache.
const ROUND: usize = 1024;
/// The fewest samples that a round takes of a ray, so that what a ray costs by itself is shared.
const FEWEST: usize = 8;
/// The most: of more, those behind a surface are for nothing.
const MOST: usize = 16;

impl CompactModel {
    pub(super) fn render_rays(&self, rays: &[Ray]) -> Vec<Pixel> {
        let samples = self.settings.samples_at_rest(self.step);
        let tasks = parallel::map(rays.len().div_ceil(RAYS * CHUNKS), |task| {
            let first = task * RAYS * CHUNKS;
            let mut chunk = Chunk::default();
            let rays = &rays[first..(first + RAYS * CHUNKS).min(rays.len())];
            rays.chunks(RAYS)
                .flat_map(|rays| self.render_chunk(rays, samples, &mut chunk))
                .collect::<Vec<_>>()
        });
        tasks.concat()
    }

    fn render_chunk(&self, rays: &[Ray], samples: f64, chunk: &mut Chunk) -> Vec<Pixel> {
        let pace = Pace::new(&self.settings, samples);
        let mut pass = self.pass(None);
        pass.weights = self.weights_at_rest();
        pass.stop = self.settings.stop_at_rest as f32;
        chunk.clear();
        let march_ray = |(n, ray): (usize, &Ray)| {
            let ray = BoxRay::new(ray, &self.settings);
            // A ray's number stands for its pixel.
            chunk.push_ray(&ray, Target::NOTHING, n as u32, false);
            self.march_ray(&ray, 0.5, u32::MAX)
        };
        let march_rays: Vec<MarchRay> = rays.iter().enumerate().map(march_ray).collect();
        let mut steps = std::mem::take(&mut chunk.steps);
        pace.march(&self.occupancy, self.arch, &march_rays, &mut steps);

        let mut pixels =
            vec![Pixel { rgb: [0.0; 3], opacity: 0.0, depth: self.settings.far as f32 }; rays.len()];
        let mut taken = vec![0; rays.len()];
        let mut lit = std::mem::take(&mut chunk.rays);
        lit.retain(|ray| !steps.of(ray.pixel as usize).is_empty());
        while !lit.is_empty() {
            let most = (ROUND / lit.len()).clamp(FEWEST, MOST);
            chunk.clear();
            for ray in lit.drain(..) {
                let n = ray.pixel as usize;
                let next = &steps.of(n)[taken[n]..];
                let next = &next[..next.len().min(most)];
                chunk.resume(ray);
                chunk.push_samples(&march_rays[n], next, &pace);
                taken[n] += next.len();
            }
            self.render_round(&pass, chunk);
            for ray in &chunk.rays {
                pixels[ray.pixel as usize] = self.pixel(ray);
            }
            std::mem::swap(&mut lit, &mut chunk.rays);
            lit.retain(|ray| {
                let n = ray.pixel as usize;
                ray.transmittance > pass.stop && taken[n] < steps.of(n).len()
            });
        }
        chunk.steps = steps;
        pixels
    }

    /// The samples of a chunk, encoded and rendered.
    fn render_round(&self, pass: &Pass, chunk: &mut Chunk) {
        chunk.reserve();
        let active = self.settings.levels_at(self.step);
        for (level, out) in self.levels.iter().zip(&mut chunk.encoding).take(active) {
            hash_grid::encode_level(self.arch, level, self.table_at_rest(level), &chunk.points, out);
        }
        chunk.clear_levels(active);
        run(self.arch, pass, chunk, &Plain);
    }

    fn pixel(&self, ray: &chunk::Ray) -> Pixel {
        let opacity = 1.0 - ray.transmittance;
        let depth = if opacity > 0.0 { ray.depth / opacity } else { self.settings.far as f32 };
        Pixel { rgb: ray.color, opacity, depth }
    }
}
