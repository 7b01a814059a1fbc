//! The compact model: a hash grid and two small networks, with an occupancy grid and early stop, so that only what the scene needs is
//! computed.
//!
//! After Instant-NGP (Mueller et al. 2022). A step goes: `step` marches random rays through the occupancy grid and encodes the samples
//! level by level; `forward` and `backward` take chunks of whole rays through networks, rendering and loss; the gradients are
//! scattered level by level and folded chunk by chunk, in order, so that the result has the same bits on any number of threads.

use pulp::Arch;
use serde_json::{Map, Value};

use crate::error::Result;
use crate::files::npz::{Array, Arrays};
use crate::hash_grid::{
    self,
    fast::{Gradient, Level},
};
use crate::occupancy_grid::fast::Occupancy;
use crate::random::{Key, Purpose};
use crate::ray::Ray;
use crate::scene::Scene;
use crate::training::probe::{Cells, Probe};
use crate::training::{Model, Pixel, StepReport};

mod backward;
pub(crate) mod chunk;
pub(crate) mod extent;
mod forward;
pub(crate) mod kernels;
mod march;
mod mean;
pub(crate) mod networks;
mod occupancy;
mod pace;
mod parts;
pub(crate) mod reference;
mod render;
mod scatter;
pub(crate) mod settings;
pub(crate) mod space;
mod state;
pub(crate) mod step;
mod views;

#[cfg(test)]
mod tests;

use chunk::Chunk;
pub use extent::Extent;
use networks::{Networks, Weights};
pub use parts::Part;
pub use settings::{CompactSettings, Overrides};
use views::Views;

/// Hash grid, networks and occupancy grid, with the state of training.
pub struct CompactModel {
    pub(crate) settings: CompactSettings,
    views: Views,
    levels: Vec<Level>,
    nets: Networks,
    pub(crate) occupancy: Occupancy,
    /// Buffers, used again step after step.
    chunks: Vec<Chunk>,
    /// Rays of the next step: as many as filled a batch in the last one.
    rays: usize,
    /// Pixels whose rays were ended too early in the last step: the first rays of the next.
    again: Vec<u32>,
    /// Steps done.
    pub(crate) step: u64,
    /// As many as there are threads, all 0 between steps: the levels' gradients, one after another.
    gradients: Vec<Gradient>,
    arch: Arch,
}

impl std::fmt::Debug for CompactModel {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("CompactModel").field("settings", &self.settings).finish_non_exhaustive()
    }
}

impl CompactModel {
    /// The untrained model of a scene.
    ///
    /// # Errors
    /// Where a lens has no inverse at some training pixel.
    pub fn new(scene: &Scene, overrides: &Overrides) -> Result<Self> {
        let settings = CompactSettings::derive(scene, overrides);
        let views = Views::new(scene, &settings)?;
        let levels = (0..settings.resolutions.len()).map(|l| initial_level(&settings, l)).collect();
        let nets = Networks::new(Weights::random(&Key::new(settings.seed, Purpose::Parameters)));
        let occupancy = Occupancy::full(occupancy::FIRST_RESOLUTION);
        let rays = settings.rays.unwrap_or(step::FIRST_RAYS);
        let arch = crate::simd::arch();
        Ok(CompactModel {
            settings,
            views,
            levels,
            nets,
            occupancy,
            chunks: vec![],
            rays,
            again: vec![],
            step: 0,
            gradients: vec![],
            arch,
        })
    }
}

/// Entries uniform in [-1e-4, 1e-4], as in Instant-NGP.
fn initial_level(settings: &CompactSettings, l: usize) -> Level {
    let key = Key::new(settings.seed, Purpose::HashTable);
    let (resolution, table) = (settings.resolutions[l], settings.table);
    let dense = hash_grid::is_dense(resolution, table);
    let entries = if dense { (resolution as usize + 1).pow(3) } else { table };
    let draws = key.uniforms(0, l as u64, 4 * entries);
    let entry = |u: &[f64; 4]| u.map(|u| (1e-4 * (2.0 * u - 1.0)) as f32);
    Level::new(resolution, draws.as_chunks::<4>().0.iter().map(entry).collect(), dense)
}

impl Model for CompactModel {
    fn step(&mut self, _: &Scene, step: u64) -> Result<StepReport> {
        self.step = step;
        Ok(self.train_step(step))
    }

    fn start(&self) -> u64 {
        300
    }

    fn any_background(&self) -> bool {
        self.settings.any_background
    }

    fn render(&self, rays: &[Ray]) -> Vec<Pixel> {
        self.render_rays(rays)
    }

    fn probe(&self, rays: &[(Ray, Vec<f64>)]) -> Vec<Vec<Probe>> {
        let reference = reference::Reference::new(self);
        crate::parallel::map(rays.len(), |r| reference.probe(&rays[r].0, &rays[r].1))
    }

    fn cells(&self) -> Option<Cells> {
        let CompactSettings { low, size, space, .. } = self.settings;
        let whole = self.occupancy.resolution;
        // Of contracted space, the part that isn't.
        let resolution = whole / space.width() as usize;
        let first = (whole - resolution) / 2;
        let cell = |n: usize| {
            let [x, y, z] = [n % resolution, n / resolution % resolution, n / resolution / resolution];
            ((first + z) * whole + first + y) * whole + first + x
        };
        let occupied = (0..resolution.pow(3)).map(|n| self.occupancy.occupied(cell(n))).collect();
        Some(Cells { low, high: low + size, resolution, occupied })
    }

    fn arrays(&self) -> Box<dyn Iterator<Item = (String, Array)> + '_> {
        Box::new(self.each_array())
    }

    fn restore(&mut self, state: &Arrays, file: &str) -> Result<()> {
        self.take_arrays(state, file)
    }

    fn settings(&self) -> Map<String, Value> {
        self.settings.to_json()
    }
}
