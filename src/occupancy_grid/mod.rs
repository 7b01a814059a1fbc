//! Occupancy grid: which cells of the unit box may have density, so that samples are taken only there.
//!
//! Instant-NGP (Mueller et al. 2022) appendix C. Letters: `R` cells along an edge; cell (i, j, k) is [i, i+1) x [j, j+1) x [k, k+1) over R,
//! index i + R (j + R k); the last cell of an axis is closed. A ray is o + t d in units of the box.

use crate::convention::{GridDecay, GridThreshold, GridUnseen};

pub(crate) mod arrays;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
#[cfg(feature = "fast")]
pub mod fast;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// Densities seen in each cell, and which of them count as occupied.
#[derive(Clone, Debug, PartialEq)]
pub struct OccupancyGrid {
    /// R.
    pub resolution: usize,
    /// The largest recent density in each cell, (R^3); -1 where no camera sees the cell.
    pub density: Vec<f64>,
    /// A cell is occupied where its density is larger.
    pub threshold: f64,
}

/// The part of a ray inside one cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The cell's index.
    pub cell: usize,
    /// Where it is entered.
    pub enter: f64,
    /// Where it is left.
    pub leave: f64,
}

impl OccupancyGrid {
    /// The index of the cell that holds `x`; points outside the box belong to the nearest cell.
    ///
    /// ```
    /// use nerf_oracle::occupancy_grid::OccupancyGrid;
    /// let grid = OccupancyGrid { resolution: 4, density: vec![0.0; 64], threshold: 0.5 };
    /// assert_eq!(grid.cell([0.3, 0.0, 1.0]), 1 + 4 * (0 + 4 * 3));
    /// ```
    pub fn cell(&self, x: [f64; 3]) -> usize {
        let r = self.resolution;
        let [i, j, k] = x.map(|x| (x * r as f64).floor().clamp(0.0, (r - 1) as f64) as usize);
        i + r * (j + r * k)
    }

    /// Whether the cell that holds `x` is occupied.
    ///
    /// # Panics
    /// Where `density` doesn't have R^3 cells.
    pub fn occupied(&self, x: [f64; 3]) -> bool {
        assert_eq!(self.density.len(), self.resolution.pow(3), "density and cells: one each a cell");
        self.density[self.cell(x)] > self.threshold
    }

    /// One update: the cells that somebody looked into fall by the factor `decay`, or rise to what was found there. Nothing is known of
    /// the others, which stay as they are; those that no camera sees (density below 0) stay so.
    ///
    /// density = max(decay density, max of sigma over the points in the cell), where there are points in the cell.
    ///
    /// # Shapes
    /// `points` (M), `sigmas` (M).
    ///
    /// # Convention
    /// `fades`: or every cell that a camera sees falls, as instant-ngp has it, which looks into all of them often enough. `unseen`: or a
    /// density below 0 is one like any other.
    ///
    /// # Panics
    /// Where the lengths differ, or `density` doesn't have R^3 cells.
    pub fn update(
        &mut self,
        decay: f64,
        points: &[[f64; 3]],
        sigmas: &[f64],
        fades: GridDecay,
        unseen: GridUnseen,
    ) {
        assert_eq!(points.len(), sigmas.len(), "points and sigmas: one each a point");
        assert_eq!(self.density.len(), self.resolution.pow(3), "density and cells: one each a cell");
        let mut found = vec![f64::NEG_INFINITY; self.density.len()];
        for m in 0..points.len() {
            let cell = self.cell(points[m]);
            found[cell] = found[cell].max(sigmas[m]);
        }
        for cell in 0..found.len() {
            let fades = found[cell] >= 0.0 || fades == GridDecay::EveryCell;
            if fades && (self.density[cell] >= 0.0 || unseen == GridUnseen::Ordinary) {
                self.density[cell] = (decay * self.density[cell]).max(found[cell]);
            }
        }
    }

    /// The threshold that can't empty the grid: the smaller of `limit` and the mean of the densities above 0 (after
    /// nerfacc's `OccGridEstimator`); -1, so that every cell that is seen counts as occupied, where no cell would be denser.
    ///
    /// A field that is thin everywhere keeps its densest cells, and with them samples and gradients; a limit alone would end both
    /// for ever. `limit` is a density, an optical depth over the width of a cell: never one over a step, which depends on how many
    /// samples a ray has.
    ///
    /// # Convention
    /// nerfacc takes the mean over all cells that are seen, those of density 0 too; instant-ngp and torch-ngp over all cells, those that
    /// aren't seen as 0; older grids take the limit alone.
    ///
    /// ```
    /// use nerf_oracle::{convention::GridThreshold::*, occupancy_grid::OccupancyGrid};
    /// let mut density = vec![0.0; 8];
    /// (density[0], density[1], density[2]) = (0.25, 0.75, -1.0);
    /// let grid = OccupancyGrid { resolution: 2, density, threshold: 0.0 };
    /// assert_eq!((grid.threshold_below(2.0, LimitAlone), grid.threshold_below(2.0, MeanOfSeen)), (2.0, 1.0 / 7.0));
    /// assert_eq!(grid.threshold_below(2.0, MeanOverAll), 1.0 / 8.0);
    /// assert_eq!((grid.threshold_below(2.0, MeanOfDense), grid.threshold_below(0.1, MeanOfDense)), (0.5, 0.1));
    /// ```
    pub fn threshold_below(&self, limit: f64, convention: GridThreshold) -> f64 {
        if convention == GridThreshold::LimitAlone {
            return limit;
        }
        let (mut sum, mut count, mut most) = (0.0, 0.0, 0.0_f64);
        for density in &self.density {
            let counts = match convention {
                GridThreshold::MeanOverAll => true,
                GridThreshold::MeanOfSeen => *density >= 0.0,
                _ => *density > 0.0,
            };
            if counts {
                sum += density.max(0.0);
                count += 1.0;
                most = most.max(*density);
            }
        }
        let threshold = if count == 0.0 { limit } else { limit.min(sum / count) };
        let opens = most <= threshold && convention == GridThreshold::MeanOfDense;
        if opens { -1.0 } else { threshold }
    }

    /// The cells that a ray passes between `near` and `far`, in order, without gaps or overlaps.
    ///
    /// All crossings of the ray with the planes between cells are computed and sorted; between two of them the ray is in one cell, that
    /// of its midpoint. There is no stepping, so no rounding accumulates and starting on a face is no special case (CG3).
    ///
    /// # Convention
    /// A ray that runs in a face belongs to the cells above it (below it at the box's upper end). Where rounding puts the ray outside
    /// the box, the nearest cells count.
    ///
    /// ```
    /// use nerf_oracle::occupancy_grid::OccupancyGrid;
    /// let grid = OccupancyGrid { resolution: 2, density: vec![0.0; 8], threshold: 0.5 };
    /// let cells = grid.crossings([0.0, 0.25, 0.25], [1.0, 0.0, 0.0], 0.0, 1.0);
    /// assert_eq!((cells[0].cell, cells[1].cell, cells[1].enter, cells.len()), (0, 1, 0.5, 2));
    /// ```
    pub fn crossings(&self, o: [f64; 3], d: [f64; 3], near: f64, far: f64) -> Vec<Crossing> {
        let r = self.resolution;
        let mut faces = vec![near, far];
        for a in 0..3 {
            for n in 1..r {
                let t = (n as f64 / r as f64 - o[a]) / d[a];
                if near < t && t < far {
                    faces.push(t);
                }
            }
        }
        faces.sort_by(f64::total_cmp);
        let mut out: Vec<Crossing> = vec![];
        for i in 1..faces.len() {
            let (enter, leave) = (faces[i - 1], faces[i]);
            let middle = 0.5 * (enter + leave);
            let cell = self.cell([o[0] + middle * d[0], o[1] + middle * d[1], o[2] + middle * d[2]]);
            match out.last_mut() {
                Some(last) if last.cell == cell => last.leave = leave,
                _ if enter < leave => out.push(Crossing { cell, enter, leave }),
                _ => {}
            }
        }
        out
    }

    /// The sampling distances of a ray: of all t = (k + u) `step` in [near, far), k whole, those whose point lies in an occupied cell.
    ///
    /// One `u` in [0, 1) shifts the whole lattice of a ray; `u` = 1/2 is the lattice at rest.
    ///
    /// # Panics
    /// Where `density` doesn't have R^3 cells.
    pub fn samples(&self, o: [f64; 3], d: [f64; 3], near: f64, far: f64, step: f64, u: f64) -> Vec<f64> {
        let mut out = vec![];
        let mut k = (near / step - u).ceil();
        while (k + u) * step < far {
            let t = (k + u) * step;
            if self.occupied([o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]]) {
                out.push(t);
            }
            k += 1.0;
        }
        out
    }
}
