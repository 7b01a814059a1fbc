//! Updates of the occupancy grid: from every training sample, and from random cells now and then.

use super::CompactModel;
use super::chunk::Chunk;
use super::forward::densities;
use super::settings::Part;
use super::step::optical_step;
use crate::hash_grid::fast as hash_grid;
use crate::parallel;
use crate::random::{Key, Purpose};

/// Steps between updates; until the first of them every cell counts as occupied.
const EVERY: u64 = 16;
/// The grid is this coarse until [`GROWS_AT`], and cheap to fill as a whole.
pub(super) const FIRST_RESOLUTION: usize = 64;
/// When the grid gets its final resolution.
const GROWS_AT: u64 = 200;
/// The factor of a cell's density in an update without samples in it.
const DECAY: f32 = 0.9;
/// Random cells per update. Occupied cells get training samples all the time; these find what was missed.
const RANDOM_CELLS: usize = 1 << 15;
/// Opacity of one step above which a cell is occupied.
const OPACITY: f32 = 0.01;
/// Optical depth of one step above which a cell is opaque.
pub(super) const OPAQUE: f32 = 1.0;
/// Cells per task.
const TASK: usize = 2048;

impl CompactModel {
    /// Every 16 steps: densities decay, random cells (at first all) are sampled, and those dense enough count as occupied.
    pub(super) fn update_occupancy(&mut self, step: u64) {
        if !step.is_multiple_of(EVERY) || self.settings.without.contains(&Part::Occupancy) {
            return;
        }
        if step == EVERY {
            // The densities of the untrained network are discarded.
            self.occupancy.density.fill(0.0);
        }
        if step >= GROWS_AT && self.occupancy.resolution < self.settings.occupancy {
            self.occupancy = self.occupancy.resampled(self.settings.occupancy);
        }
        self.occupancy.decay(DECAY);
        let cells = self.occupancy.density.len();
        let all = step == EVERY;
        let count = if all { cells } else { RANDOM_CELLS.min(cells) };
        let mut tasks = std::mem::take(&mut self.chunks);
        tasks.resize_with(tasks.len().max(count.div_ceil(TASK)), Chunk::default);
        let chunks = &mut tasks[..count.div_ceil(TASK)];
        parallel::for_chunks(chunks, 1, |n, chunk| {
            let draws = n * TASK..((n + 1) * TASK).min(count);
            self.sample_cells(draws, all, step, &mut chunk[0]);
        });
        for chunk in chunks {
            self.occupancy.raise(&chunk.points, &chunk.sigma);
        }
        self.chunks = tasks;
        let delta = optical_step(self.settings.samples);
        self.occupancy.apply_thresholds([OPACITY / delta, OPAQUE / delta]);
    }

    /// Densities at random points of cells: of cell n itself if `all`, otherwise of a random one.
    fn sample_cells(&self, draws: std::ops::Range<usize>, all: bool, step: u64, chunk: &mut Chunk) {
        let key = Key::new(self.settings.seed, Purpose::Occupancy);
        let r = self.occupancy.resolution;
        chunk.clear();
        for n in draws {
            let u = key.uniforms(step, n as u64, 4);
            let cell = if all { n } else { (u[3] * (r * r * r) as f64) as usize };
            let corner = [cell % r, cell / r % r, cell / r / r];
            chunk.points.push(std::array::from_fn(|a| ((corner[a] as f64 + u[a]) / r as f64) as f32));
        }
        chunk.reserve();
        let active = self.settings.levels_at(step);
        for (level, out) in self.levels.iter().zip(&mut chunk.encoding).take(active) {
            hash_grid::encode_level(self.arch, level, &chunk.points, out);
        }
        chunk.clear_levels(active);
        densities(self.arch, &self.pass(self.settings.samples, None), chunk);
    }
}
