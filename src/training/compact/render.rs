//! Renders rays with a trained model, without jitter. The occupancy grid is part of the model: density is 0 in empty cells.

use super::CompactModel;
use super::chunk::Chunk;
use super::forward::run;
use super::kernels::Plain;
use super::march::MarchAtRest;
use crate::hash_grid::fast as hash_grid;
use crate::parallel;
use crate::ray::Ray;
use crate::training::Pixel;

/// Rays of a chunk: a few thousand samples at most, as most rays miss or stop soon.
const RAYS: usize = 128;
/// Chunks per task, which reuses its buffers.
const CHUNKS: usize = 16;

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
        let length = (self.settings.size / samples) as f32;
        self.arch.dispatch(MarchAtRest { model: self, length, rays, chunk });
        let active = self.settings.levels_at(self.step);
        for (level, out) in self.levels.iter().zip(&mut chunk.encoding).take(active) {
            hash_grid::encode_level(self.arch, level, &chunk.points, out);
        }
        chunk.clear_levels(active);
        let mut pass = self.pass(samples, None);
        (pass.background, pass.stop) = ([0.0; 3], self.settings.stop_at_rest as f32);
        run(self.arch, &pass, chunk, &Plain);
        let far = self.settings.far as f32;
        let pixel = |ray: &super::chunk::Ray| {
            let opacity = 1.0 - ray.transmittance;
            let depth = if opacity > 0.0 { ray.depth / opacity } else { far };
            Pixel { rgb: ray.color, opacity, depth }
        };
        chunk.rays.iter().map(pixel).collect()
    }
}
