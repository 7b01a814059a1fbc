//! The occupancy grid of the 8x256 network, over all that the training rays can reach.
//!
//! The network itself is evaluated at random points of cells: every cell at first, then a part of them now and then, and the occupied ones
//! with their neighbors each time, because content moves by a cell, not across the scene. A cell keeps the largest recent density.

use crate::error::Result;
use crate::field::fast::Rays;
use crate::occupancy_grid::fast::Occupancy;
use crate::parallel;
use crate::random::Key;
use crate::ray::Ray;
use crate::scene::{Scene, pixel_ray};
use crate::training::probe::Cells;

/// An update samples every cell whose index equals its number modulo this.
const PARTS: usize = 8;
/// Rounds over occupied cells and their neighbors when the grid is filled.
const FIRST_LOOKS: u64 = 12;
/// What an update leaves of the density of a cell that it looks at and finds no more in.
const DECAY: f32 = 0.8;
/// Opacity of a 64th of the way from near to far above which a cell is occupied, however many samples a ray has.
pub(super) const OPACITY: f64 = 0.01;
/// Points per task.
const TASK: usize = 1 << 13;

/// Densities at points (M, 3).
pub(crate) type DensityAt<'a> = &'a dyn Fn(&[f64]) -> Vec<f32>;

/// Where a ray's samples begin and end.
pub(crate) type Ends<'a> = &'a dyn Fn(&Ray) -> [[f64; 3]; 2];

/// The grid, and the box of the scene that it fills.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    /// Its corners.
    low: [f64; 3],
    high: [f64; 3],
    cells: Occupancy,
}

impl Grid {
    /// Over the box of all training rays between their `ends`, with this many cells along an edge (a multiple of 16); no density known.
    ///
    /// # Errors
    /// Where a training pixel has no ray.
    pub(crate) fn new(scene: &Scene, ends: Ends, resolution: usize) -> Result<Self> {
        // Every eighth pixel and the last ones: a sample outside the box counts as live, so that nothing depends on the rest.
        const STRIDE: usize = 8;
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for frame in &scene.train {
            let camera = &frame.camera;
            let along = |n: usize| (0..n).step_by(STRIDE).chain([n - 1]);
            for (i, j) in along(camera.height).flat_map(|j| along(camera.width).map(move |i| (i, j))) {
                let Some(ray) = pixel_ray(camera, i, j)? else { continue };
                for x in ends(&ray) {
                    for a in 0..3 {
                        (low[a], high[a]) = (low[a].min(x[a]), high[a].max(x[a]));
                    }
                }
            }
        }
        Ok(Grid { low, high, cells: Occupancy::full(resolution) })
    }

    /// A grid as [`Self::corners`] and [`Self::densities`] gave it; `step` is a 64th of the way from near to far.
    pub(crate) fn from_parts(
        corners: &[f64],
        resolution: usize,
        densities: Vec<f32>,
        step: f64,
    ) -> Option<Self> {
        let none = vec![0; (resolution / 4).pow(3)];
        let cells = Occupancy::from_parts(resolution, densities, &none, &none)?;
        let corner = |n: usize| <[f64; 3]>::try_from(corners.get(3 * n..3 * n + 3)?).ok();
        let mut grid = Grid { low: corner(0)?, high: corner(1)?, cells };
        grid.close(step);
        Some(grid)
    }

    /// The box, (2, 3).
    pub(crate) fn corners(&self) -> [f64; 6] {
        let ([a, b, c], [d, e, f]) = (self.low, self.high);
        [a, b, c, d, e, f]
    }

    /// Cells along an edge.
    pub(crate) fn resolution(&self) -> usize {
        self.cells.resolution
    }

    /// The largest recent density in each cell.
    pub(crate) fn densities(&self) -> &[f32] {
        &self.cells.density
    }

    /// Share of the cells that are occupied.
    pub(crate) fn fraction(&self) -> f64 {
        self.cells.fraction()
    }

    /// The same for people to look at.
    pub(crate) fn to_cells(&self) -> Cells {
        let resolution = self.cells.resolution;
        let occupied = (0..resolution.pow(3)).map(|cell| self.cells.occupied(cell)).collect();
        Cells { low: self.low.into(), high: self.high.into(), resolution, occupied }
    }

    /// Whether a point may have a density: it lies in an occupied cell, or outside the grid.
    pub(crate) fn live(&self, x: [f64; 3]) -> bool {
        let inside = (0..3).all(|a| self.low[a] <= x[a] && x[a] <= self.high[a]);
        let unit = std::array::from_fn(|a| ((x[a] - self.low[a]) / (self.high[a] - self.low[a])) as f32);
        !inside || self.cells.occupied(self.cells.cell(unit))
    }

    /// The samples of rays that may have a density (R, N).
    pub(crate) fn mask(&self, rays: &Rays) -> Vec<bool> {
        let mut mask = vec![false; rays.t.len()];
        parallel::for_chunks(&mut mask, TASK, |chunk, mask| {
            for (n, live) in mask.iter_mut().enumerate() {
                *live = self.live(rays.position(chunk * TASK + n));
            }
        });
        mask
    }

    /// The first look: at every cell once, then around what was found. `step` is a 64th of the way, `number` the training step.
    pub(crate) fn fill(&mut self, key: &Key, number: u64, step: f64, density_at: DensityAt) {
        self.cells.density.fill(0.0);
        let all: Vec<usize> = (0..self.cells.density.len()).collect();
        self.raise(&all, key, number, 0, density_at);
        self.cells.update(1.0);
        for round in 1..=FIRST_LOOKS {
            self.close(step);
            self.raise(&self.surroundings(), key, number, round, density_at);
            self.cells.update(1.0);
        }
        self.close(step);
    }

    /// A later update, the `turn`-th: a part of all cells, and around the occupied ones.
    pub(crate) fn update(&mut self, key: &Key, (number, turn): (u64, u64), step: f64, density_at: DensityAt) {
        let part = turn as usize % PARTS;
        let some: Vec<usize> = (part..self.cells.density.len()).step_by(PARTS).collect();
        self.raise(&some, key, number, 0, density_at);
        self.raise(&self.surroundings(), key, number, 1, density_at);
        self.cells.update(DECAY);
        self.close(step);
    }

    /// Closes the cells of too little density; a thin field keeps its densest cells, a field without any all of them.
    fn close(&mut self, step: f64) {
        self.cells.apply_threshold(self.cells.threshold(threshold(step)));
    }

    /// Takes down the network's density at a random point in each of some cells.
    fn raise(&mut self, cells: &[usize], key: &Key, number: u64, round: u64, density_at: DensityAt) {
        let mut points = vec![0.0; 3 * cells.len()];
        parallel::for_chunks(&mut points, 3 * TASK, |task, points| {
            for (n, x) in points.chunks_exact_mut(3).enumerate() {
                let cell = cells[task * TASK + n];
                for (a, index) in self.indices(cell).into_iter().enumerate() {
                    let u = key.uniform(number, cell as u64, 4 * round + a as u64);
                    let share = (index as f64 + u) / self.cells.resolution as f64;
                    x[a] = self.low[a] + share * (self.high[a] - self.low[a]);
                }
            }
        });
        let densities = density_at(&points);
        for (&cell, sigma) in cells.iter().zip(densities) {
            // A NaN raises nothing here; it comes out in the loss.
            self.cells.found[cell] = self.cells.found[cell].max(sigma);
        }
    }

    fn indices(&self, cell: usize) -> [usize; 3] {
        let r = self.cells.resolution;
        [cell % r, cell / r % r, cell / r / r]
    }

    /// Occupied cells and all that touch them.
    fn surroundings(&self) -> Vec<usize> {
        let (mut found, r) = (vec![false; self.cells.density.len()], self.cells.resolution);
        for cell in (0..found.len()).filter(|&cell| self.cells.occupied(cell)) {
            let [x, y, z] = self.indices(cell).map(|i| i.saturating_sub(1)..=(i + 1).min(r - 1));
            for k in z {
                for j in y.clone() {
                    x.clone().for_each(|i| found[(k * r + j) * r + i] = true);
                }
            }
        }
        (0..found.len()).filter(|&cell| found[cell]).collect()
    }
}

/// The density whose opacity over a step is [`OPACITY`]: 1 - e^(-sigma step).
fn threshold(step: f64) -> f32 {
    (-crate::math::ln_1p(-OPACITY) / step) as f32
}
