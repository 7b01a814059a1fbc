//! When and how the occupancy grid learns: from every training sample, and from looks into cells now and then.
//!
//! Nothing here depends on the samples a ray has: thresholds are optical depths over a cell, so that a scene of another size, or with
//! more samples, keeps the same cells. And no grid is ever empty: see `OccupancyGrid::threshold_below` and [`CompactModel::reopen`].

use super::CompactModel;
use super::chunk::Chunk;
use super::forward::densities;
use super::pace::Pace;
use super::parts::Part;
use super::settings::{CompactSettings, OPAQUE};
use super::space::OPTICAL_SIZE;
use super::views::Views;
use crate::hash_grid::fast as hash_grid;
use crate::occupancy_grid::fast::Occupancy;
use crate::parallel;
use crate::random::{Key, Purpose};

/// Steps between updates; until the first of them every cell counts as occupied.
const EVERY: u64 = 16;
/// The grid is this coarse until [`GROWS_AT`], and cheap to fill as a whole.
pub(super) const FIRST_RESOLUTION: usize = 64;
/// When the grid gets its final resolution; until then all cells are looked at, a part of them at every update.
const GROWS_AT: u64 = 208;
/// Updates until every cell of the first grid has been looked at, once the first update has looked at all of them.
const TURNS: usize = 4;
/// What is left of a cell's density after an update that found nothing in it.
const DECAY: f32 = 0.9;
/// Cells that an update looks at once the grid has grown: half of them anywhere, half of them occupied.
const LOOKS: usize = 1 << 15;
/// Optical depth over the width of a cell above which it is occupied: 1.9 across the whole box.
const OCCUPIED: f64 = 0.015;
/// Cells of a task.
const TASK: usize = 2048;
/// The fewest tasks of a round, whose buffers the next one uses again: the looks of a grown grid.
const TASKS: usize = LOOKS / TASK;

impl CompactModel {
    /// Every 16 steps: cells are looked at, densities fall and rise, and what is dense enough counts as occupied.
    pub(super) fn update_occupancy(&mut self, step: u64) {
        if !step.is_multiple_of(EVERY) || self.settings.without.contains(&Part::Occupancy) {
            return;
        }
        let first = self.occupancy.density.iter().all(|&density| density == 0.0);
        if first {
            // What the untrained network thought of the cells doesn't count.
            self.occupancy = unknown(&self.views, &self.settings);
        } else if step >= GROWS_AT && self.occupancy.resolution < self.settings.occupancy {
            self.occupancy = self.occupancy.resampled(self.settings.occupancy);
        }
        let cells = self.cells(step, first);
        let mut chunks = std::mem::take(&mut self.chunks);
        let tasks = TASKS.max(parallel::threads());
        chunks.resize_with(chunks.len().max(tasks), Chunk::default);
        for (round, cells) in cells.chunks(tasks * TASK).enumerate() {
            let chunks = &mut chunks[..cells.len().div_ceil(TASK)];
            parallel::for_chunks(chunks, 1, |n, chunk| {
                let first = n * TASK;
                let cells = &cells[first..cells.len().min(first + TASK)];
                self.look(cells, round * tasks * TASK + first, step, &mut chunk[0]);
            });
            for chunk in chunks {
                self.occupancy.raise(&chunk.points, &chunk.sigma);
            }
        }
        self.chunks = chunks;
        self.occupancy.update(DECAY);
        self.apply_thresholds();
    }

    fn apply_thresholds(&mut self) {
        let cell = self.settings.space.width() * OPTICAL_SIZE / self.settings.occupancy as f64;
        let [occupied, opaque] = [OCCUPIED, OPAQUE].map(|depth| (depth / cell) as f32);
        self.occupancy.apply_thresholds([self.occupancy.threshold(occupied), opaque]);
    }

    /// A step met no occupied cell: all that cameras see are open until the next update.
    pub(super) fn reopen(&mut self) {
        self.occupancy.apply_thresholds([-1.0, f32::INFINITY]);
    }

    /// The cells that an update looks at: all, then part by part; in the grown grid half of the looks go anywhere, half into cells that
    /// are occupied, of which a few are a large part of the scene.
    fn cells(&self, step: u64, first: bool) -> Vec<u32> {
        let cells = self.occupancy.density.len();
        if first {
            return (0..cells as u32).collect();
        }
        if step < GROWS_AT {
            let turn = (step / EVERY) as usize % TURNS;
            return (turn..cells).step_by(TURNS).map(|cell| cell as u32).collect();
        }
        let key = Key::new(self.settings.seed, Purpose::Occupancy);
        let occupied = self.occupancy.occupied_cells();
        let cell = |n: usize| {
            let u = key.uniform(step, n as u64, 3);
            match occupied.len() {
                some if n < LOOKS / 2 && some > 0 => occupied[(u * some as f64) as usize],
                _ => (u * cells as f64) as u32,
            }
        };
        (0..LOOKS).map(cell).collect()
    }

    /// Densities at random points of cells; `first` is the first one's number in the update.
    fn look(&self, cells: &[u32], first: usize, step: u64, chunk: &mut Chunk) {
        let key = Key::new(self.settings.seed, Purpose::Occupancy);
        let r = self.occupancy.resolution;
        chunk.clear();
        for (n, &cell) in cells.iter().enumerate() {
            let (u, cell) = (key.uniforms(step, (first + n) as u64, 3), cell as usize);
            let corner = [cell % r, cell / r % r, cell / r / r];
            chunk.points.push(std::array::from_fn(|a| ((corner[a] as f64 + u[a]) / r as f64) as f32));
        }
        chunk.reserve();
        let active = self.settings.levels_at(step);
        for (level, out) in self.levels.iter().zip(&mut chunk.encoding).take(active) {
            hash_grid::encode_level(self.arch, level, level.table(), &chunk.points, out);
        }
        chunk.clear_levels(active);
        densities(self.arch, &self.pass(None), chunk);
    }
}

/// Cells along an edge of the grid that says what cameras see.
const SEEN: usize = 32;
/// Rays of a view along each of its sides.
const LINES: usize = 48;
/// Views of a task.
const TOGETHER: usize = 16;

/// A grid that knows nothing but which cells lie before some training camera, between near and far.
fn unknown(views: &Views, settings: &CompactSettings) -> Occupancy {
    let tasks = views.count().div_ceil(TOGETHER);
    let seen = parallel::map(tasks, |task| {
        let mut seen = Occupancy::full(SEEN);
        for view in task * TOGETHER..views.count().min((task + 1) * TOGETHER) {
            views.lattice(view, LINES).for_each(|ray| walk(&mut seen, &ray, settings));
        }
        seen
    });
    let near = |cell: usize| {
        let at = [cell % SEEN, cell / SEEN % SEEN, cell / SEEN / SEEN];
        let [x, y, z] = at.map(|i| i.saturating_sub(1)..(i + 2).min(SEEN));
        let mut around = z.flat_map(|k| {
            y.clone().flat_map({
                let x = x.clone();
                move |j| x.clone().map(move |i| (k * SEEN + j) * SEEN + i)
            })
        });
        around.any(|n| seen.iter().any(|grid| grid.found[n] >= 0.0))
    };
    // A cell beside one that a ray of the lattice meets counts as seen: other rays pass between those.
    let mut grid = Occupancy::full(SEEN);
    grid.hide(|cell| !near(cell));
    grid.resampled(FIRST_RESOLUTION)
}

/// Marks the cells along a ray, in steps of half a cell.
fn walk(seen: &mut Occupancy, ray: &super::views::BoxRay, settings: &CompactSettings) {
    let pace = Pace::new(settings, (2 * SEEN) as f64 / settings.space.width());
    let points = pace.everywhere(ray, [settings.near, settings.far].map(|t| t as f32));
    seen.raise(&points, &vec![0.0; points.len()]);
}
