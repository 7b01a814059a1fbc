//! f32 occupancy bits; `march` walks rays over them, past empty cells, bricks and blocks of cells.

mod follow;
mod march;
mod steps;
mod walk;

pub use follow::Path;
pub use steps::{MarchRay, Steps};

/// Cells along a brick's edge: 4^3 bits are a word, so that an empty word lets a ray skip 64 cells.
const BRICK: usize = 4;
/// Cells along a block's edge: its 4^3 bricks are a word too.
const BLOCK: usize = 16;

/// The margin around occupied bricks, so that no ray loses a cell to rounding.
const MARGIN: f32 = 1e-4;

/// What stands for a density where there is none: less than any.
const NOWHERE: f32 = -1.0;

/// A cubic grid of cells over the unit box.
#[derive(Clone, Debug, PartialEq)]
pub struct Occupancy {
    /// Cells along an edge, a multiple of 16.
    pub resolution: usize,
    /// The largest recent density, (R^3), index x + R (y + R z); below 0 where no camera sees the cell.
    pub density: Vec<f32>,
    /// The largest density found in each cell since the last [`Self::update`]; below 0 where nobody looked.
    pub found: Vec<f32>,
    /// For each brick, the bits of its occupied cells, and of those that are opaque.
    words: Vec<[u64; 2]>,
    /// For each block, the bits of the bricks with occupied cells.
    blocks: Vec<u64>,
    /// Two corners of a box that holds all occupied bricks.
    bounds: [[f32; 3]; 2],
}

impl Occupancy {
    /// A grid with every cell occupied and no density known.
    ///
    /// # Panics
    /// Where the resolution isn't a multiple of 16.
    pub fn full(resolution: usize) -> Self {
        assert!(
            resolution > 0 && resolution.is_multiple_of(BLOCK),
            "{resolution} cells an edge: whole blocks of {BLOCK} are needed"
        );
        let words = vec![[!0, 0]; (resolution / BRICK).pow(3)];
        let blocks = vec![!0; (resolution / BLOCK).pow(3)];
        let bounds = [[0.0; 3], [1.0; 3]];
        let cells = resolution.pow(3);
        let (density, found) = (vec![0.0; cells], vec![NOWHERE; cells]);
        Occupancy { resolution, density, found, words, blocks, bounds }
    }

    /// A grid from its parts, as [`Self::density`] and [`Self::bits`] return them; `None` if the lengths don't match.
    pub fn from_parts(
        resolution: usize,
        density: Vec<f32>,
        occupied: &[u64],
        opaque: &[u64],
    ) -> Option<Self> {
        let bricks = (resolution / BRICK).pow(3);
        let whole = resolution > 0 && resolution.is_multiple_of(BLOCK);
        let fits = whole
            && density.len() == resolution.pow(3)
            && [occupied, opaque].iter().all(|bits| bits.len() == bricks);
        fits.then(|| {
            let words = occupied.iter().zip(opaque).map(|(&a, &b)| [a, b]).collect();
            let mut grid = Occupancy { density, words, ..Occupancy::full(resolution) };
            grid.sum_up();
            grid
        })
    }

    /// The occupied cells, and the opaque ones, a word for each brick of 4^3.
    pub fn bits(&self) -> [Vec<u64>; 2] {
        [0, 1].map(|kind| self.words.iter().map(|words| words[kind]).collect())
    }

    #[inline(always)]
    fn along(&self, x: f32) -> usize {
        // The conversion saturates: NaN and coordinates below the box become 0.
        ((x * self.resolution as f32) as usize).min(self.resolution - 1)
    }

    /// Index of the cell that holds a point of the unit box.
    #[inline(always)]
    pub fn cell(&self, p: [f32; 3]) -> usize {
        (self.along(p[2]) * self.resolution + self.along(p[1])) * self.resolution + self.along(p[0])
    }

    /// Whether the cell with this index is occupied.
    pub fn occupied(&self, cell: usize) -> bool {
        let (r, bricks) = (self.resolution, self.resolution / BRICK);
        let (x, y, z) = (cell % r, cell / r % r, cell / r / r);
        let [word, _] = self.words[(z / BRICK * bricks + y / BRICK) * bricks + x / BRICK];
        word >> ((z % BRICK * BRICK + y % BRICK) * BRICK + x % BRICK) & 1 == 1
    }

    /// The indices of all occupied cells, brick by brick.
    pub fn occupied_cells(&self) -> Vec<u32> {
        let (r, bricks) = (self.resolution, self.resolution / BRICK);
        let mut out = vec![];
        for (n, &[mut word, _]) in self.words.iter().enumerate() {
            let (x, y, z) = (n % bricks * BRICK, n / bricks % bricks * BRICK, n / bricks / bricks * BRICK);
            while word != 0 {
                let bit = word.trailing_zeros() as usize;
                let (i, j, k) = (bit % BRICK, bit / BRICK % BRICK, bit / BRICK / BRICK);
                out.push((((z + k) * r + y + j) * r + x + i) as u32);
                word &= word - 1;
            }
        }
        out
    }

    /// Share of the cells that are occupied.
    pub fn fraction(&self) -> f64 {
        let ones: u32 = self.words.iter().map(|[occupied, _]| occupied.count_ones()).sum();
        f64::from(ones) / self.density.len() as f64
    }

    /// Takes down the densities found at points, for the next [`Self::update`].
    ///
    /// # Panics
    /// Where the lengths differ.
    pub fn raise(&mut self, points: &[[f32; 3]], sigmas: &[f32]) {
        assert_eq!(points.len(), sigmas.len(), "points and sigmas: one each a point");
        for (&p, &sigma) in points.iter().zip(sigmas) {
            let cell = self.cell(p);
            self.found[cell] = self.found[cell].max(sigma);
        }
    }

    /// Cells that were looked at: their density times `decay`, or what was found, where that is more. All others stay as they are.
    pub fn update(&mut self, decay: f32) {
        for (density, found) in self.density.iter_mut().zip(&mut self.found) {
            if *found >= 0.0 && *density >= 0.0 {
                *density = (*density * decay).max(*found);
            }
            *found = NOWHERE;
        }
    }

    /// No camera sees these cells: they stay empty, whatever is found in them.
    pub fn hide(&mut self, hidden: impl Fn(usize) -> bool) {
        let cells = self.density.iter_mut().enumerate().filter(|(cell, _)| hidden(*cell));
        cells.for_each(|(_, density)| *density = NOWHERE);
    }

    /// The smaller of `limit` and the mean of the densities above 0; below all that is seen where no cell is denser than that.
    pub fn threshold(&self, limit: f32) -> f32 {
        let (mut sum, mut count, mut most) = (0.0, 0u32, 0f32);
        for &density in self.density.iter().filter(|density| **density > 0.0) {
            (sum, count, most) = (sum + f64::from(density), count + 1, most.max(density));
        }
        let threshold = limit.min((sum / f64::from(count.max(1))) as f32);
        if most > threshold { threshold } else { NOWHERE }
    }

    /// Marks the cells denser than `threshold` as occupied; none is opaque.
    pub fn apply_threshold(&mut self, threshold: f32) {
        self.apply_thresholds([threshold, f32::INFINITY]);
    }

    /// Marks the cells denser than the first threshold as occupied, those denser than the second, larger one as opaque.
    pub fn apply_thresholds(&mut self, thresholds: [f32; 2]) {
        let (r, bricks) = (self.resolution, self.resolution / BRICK);
        self.words.fill([0; 2]);
        for (row, densities) in self.density.chunks_exact(r).enumerate() {
            let (y, z) = (row % r, row / r);
            let first = (z / BRICK * bricks + y / BRICK) * bricks;
            let shift = (z % BRICK * BRICK + y % BRICK) * BRICK;
            for (brick, four) in densities.chunks_exact(BRICK).enumerate() {
                for (word, threshold) in self.words[first + brick].iter_mut().zip(thresholds) {
                    let nibble = (0..BRICK).fold(0, |bits, x| bits | u64::from(four[x] > threshold) << x);
                    *word |= nibble << shift;
                }
            }
        }
        self.sum_up();
    }

    /// Updates what follows from the bits: blocks and bounds.
    fn sum_up(&mut self) {
        let (bricks, blocks) = (self.resolution / BRICK, self.resolution / BLOCK);
        self.blocks = vec![0; blocks.pow(3)];
        self.bounds = [[1.0; 3], [0.0; 3]];
        for (i, _) in self.words.iter().enumerate().filter(|(_, [occupied, _])| *occupied != 0) {
            let (x, y, z) = (i % bricks, i / bricks % bricks, i / bricks / bricks);
            let block = (z / 4 * blocks + y / 4) * blocks + x / 4;
            self.blocks[block] |= 1 << ((z % 4 * 4 + y % 4) * 4 + x % 4);
            for (a, at) in [x, y, z].into_iter().enumerate() {
                let [low, high] = &mut self.bounds;
                low[a] = low[a].min(at as f32 / bricks as f32 - MARGIN).max(0.0);
                high[a] = high[a].max((at + 1) as f32 / bricks as f32 + MARGIN).min(1.0);
            }
        }
    }

    /// Distances between which a ray of the unit box can meet occupied cells; near > far where it can't.
    #[inline(always)]
    pub fn span(&self, o: [f32; 3], d: [f32; 3]) -> (f32, f32) {
        let [low, high] = self.bounds;
        if low[0] > high[0] {
            return (f32::INFINITY, f32::NEG_INFINITY);
        }
        let size: [f32; 3] = std::array::from_fn(|a| high[a] - low[a]);
        ray_box(std::array::from_fn(|a| (o[a] - low[a]) / size[a]), std::array::from_fn(|a| d[a] / size[a]))
    }

    /// The same densities in cells of another size.
    pub fn resampled(&self, resolution: usize) -> Self {
        let mut out = Occupancy::full(resolution);
        let at = |i: usize| i * self.resolution / resolution;
        for (i, density) in out.density.iter_mut().enumerate() {
            let (x, y, z) =
                (at(i % resolution), at(i / resolution % resolution), at(i / resolution / resolution));
            *density = self.density[(z * self.resolution + y) * self.resolution + x];
        }
        out
    }
}

/// Distances at which a ray enters and leaves the unit box; enter > leave where it misses.
#[inline(always)]
pub fn ray_box(o: [f32; 3], d: [f32; 3]) -> (f32, f32) {
    let (mut enter, mut leave) = (f32::NEG_INFINITY, f32::INFINITY);
    for a in 0..3 {
        if d[a] == 0.0 {
            if o[a] < 0.0 || o[a] > 1.0 {
                return (f32::INFINITY, f32::NEG_INFINITY);
            }
            continue;
        }
        let (t0, t1) = (-o[a] / d[a], (1.0 - o[a]) / d[a]);
        enter = enter.max(t0.min(t1));
        leave = leave.min(t0.max(t1));
    }
    (enter, leave)
}

#[cfg(test)]
mod tests;
