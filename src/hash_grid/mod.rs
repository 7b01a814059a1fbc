//! Multi-resolution hash grid: a point of the unit box -> trilinearly interpolated features of several grids.
//!
//! Instant-NGP (Mueller et al. 2022) equations 2 to 4. Letters: `N` cells along an edge of a level, so that it has (N + 1)^3
//! vertices; `T` largest number of table entries of a level; `F` features of an entry; `x` a point of [0, 1]^3.
//! A level whose vertices fit into T entries is dense: every vertex has its own entry. In others, vertices share entries by a hash;
//! training resolves collisions, because vertices in empty space have no gradient.

use ndarray::Array2;

use crate::convention::{Conventions, HashIndex, HashLevels, HashPrimes, HashWeights};
use crate::math::pow;

pub(crate) mod arrays;
pub mod backward;
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

/// One grid, its table, and how points find their entries.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Cells along an edge of the box: a point x lies at x scale + shift, counted in cells. N, where that is a whole number.
    pub scale: f64,
    /// Where the box begins in the first cell.
    pub shift: f64,
    /// The last cell; it is closed.
    pub last: u32,
    /// Vertices along an edge, as a dense level counts them.
    pub side: u32,
    /// Whether it may be dense.
    pub index: HashIndex,
    /// Factors of the hash.
    pub primes: HashPrimes,
    /// How it interpolates.
    pub weights: HashWeights,
    /// Entries (E, F), each of F features; dense where all side^3 vertices have one, otherwise a power of two.
    pub table: Array2<f64>,
}

/// Factors of the hash, equation 4. The first is 1, so that neighbors along x stay neighbors in memory.
pub const PRIMES: [u32; 3] = [1, 2_654_435_761, 805_459_861];

/// The factors by convention; tiny-cuda-nn has three sets of them.
pub fn primes(convention: HashPrimes) -> [u32; 3] {
    match convention {
        HashPrimes::Coherent => PRIMES,
        HashPrimes::Prime => [1_958_374_283, 2_654_435_761, 805_459_861],
        HashPrimes::Reversed => [2_165_219_737, 1_434_869_437, 2_097_192_037],
    }
}

/// Level l's n = base growth^l with growth = (finest / base)^(1 / (levels - 1)), equations 2 and 3. Where it misses a whole number by a
/// rounding of the power alone, it is that number.
pub fn growing(base: u32, finest: u32, levels: usize, l: usize) -> f64 {
    let ratio = f64::from(finest) / f64::from(base);
    let n = f64::from(base) * pow(ratio, l as f64 / (levels.max(2) - 1) as f64);
    if (n - n.round()).abs() < 1e-9 * n { n.round() } else { n }
}

/// The levels' resolutions N_l = base * growth^l, equations 2 and 3.
///
/// # Convention
/// Rounded to the nearest whole number, where the paper rounds down ([`HashLevels::Floor`]): rounding down makes the finest level depend
/// on the last bit of the power.
///
/// ```
/// assert_eq!(nerf_oracle::hash_grid::resolutions(16, 128, 4), [16, 32, 64, 128]);
/// ```
pub fn resolutions(base: u32, finest: u32, levels: usize) -> Vec<u32> {
    (0..levels).map(|l| growing(base, finest, levels, l).round() as u32).collect()
}

/// Whether all (N + 1)^3 vertices fit into `max_entries`.
pub fn is_dense(resolution: u32, max_entries: usize) -> bool {
    let side = u64::from(resolution) + 1;
    side * side * side <= max_entries as u64
}

impl Level {
    /// A level of N cells with this table, in the paper's conventions.
    pub fn new(resolution: u32, table: Array2<f64>) -> Level {
        Level {
            scale: f64::from(resolution),
            shift: 0.0,
            last: resolution - 1,
            side: resolution + 1,
            index: HashIndex::DenseWhereItFits,
            primes: HashPrimes::Coherent,
            weights: HashWeights::Linear,
            table,
        }
    }

    /// The level of n = base growth^l cells ([`growing`]) in these conventions.
    ///
    /// ```
    /// use nerf_oracle::{convention::{CS180, HashLevels}, hash_grid::Level};
    /// let of = |hash_levels| Level::by_convention(6.5, Default::default(), &nerf_oracle::convention::Conventions { hash_levels, ..CS180 });
    /// let at = |level: Level| (level.scale, level.shift, level.side);
    /// assert_eq!((at(of(HashLevels::Floor)), at(of(HashLevels::TinyCudaNn))), ((6.0, 0.0, 7), (5.5, 0.5, 7)));
    /// ```
    pub fn by_convention(n: f64, table: Array2<f64>, c: &Conventions) -> Level {
        let vertices = (n - 1.0).ceil() as u32 + 1;
        let level = match c.hash_levels {
            HashLevels::Nearest => Level::new(n.round() as u32, table),
            HashLevels::Floor => Level::new(n.floor() as u32, table),
            HashLevels::TinyCudaNn => Level::new(1, table).laid(n - 1.0, 0.5, vertices),
            HashLevels::TorchNgp => Level::new(1, table).laid(n - 1.0, 0.5, vertices + 1),
            HashLevels::AlignCorners => Level::new(1, table).laid(n - 1.0, 0.0, vertices),
        };
        Level { index: c.hash_index, primes: c.hash_primes, weights: c.hash_weights, ..level }
    }

    /// The same, laid on the box at x scale + shift; its last cell is that of x = 1.
    fn laid(self, scale: f64, shift: f64, side: u32) -> Level {
        Level { scale, shift, last: (scale + shift).floor() as u32, side, ..self }
    }

    /// A level of zeros: dense where its vertices fit into `max_entries`, which must be a power of two.
    pub fn zeros(resolution: u32, max_entries: usize, features: usize) -> Level {
        let side = resolution as usize + 1;
        let entries = if is_dense(resolution, max_entries) { side * side * side } else { max_entries };
        Level::new(resolution, Array2::zeros([entries, features]))
    }

    /// Whether every vertex has its own entry.
    pub fn dense(&self) -> bool {
        self.index == HashIndex::DenseWhereItFits && is_dense(self.side - 1, self.table.nrows())
    }

    /// The entry of a vertex: x + side (y + side z), or (x p_1 xor y p_2 xor z p_3) in 32-bit arithmetic; both mod the table's length.
    pub fn entry(&self, [x, y, z]: [u32; 3]) -> usize {
        if self.dense() {
            let side = self.side as usize;
            // A vertex beyond the last one, which tiny-cuda-nn's cells reach, has the entry of another.
            return (x as usize + side * (y as usize + side * z as usize)) % self.table.nrows();
        }
        let [p_1, p_2, p_3] = primes(self.primes);
        let hash = x.wrapping_mul(p_1) ^ y.wrapping_mul(p_2) ^ z.wrapping_mul(p_3);
        hash as usize % self.table.nrows()
    }

    /// The cell of `x` along one axis and the place in it: (c, f) with x scale + shift = c + f. The last cell is closed: x = 1 is
    /// (N - 1, 1).
    pub fn cell(&self, x: f64) -> (u32, f64) {
        let scaled = x * self.scale + self.shift;
        let cell = scaled.floor().clamp(0.0, f64::from(self.last));
        (cell as u32, scaled - cell)
    }

    /// The weight of the upper side for the fraction f.
    pub fn weight(&self, f: f64) -> f64 {
        match self.weights {
            HashWeights::Linear => f,
            HashWeights::Smoothstep => f * f * (3.0 - 2.0 * f),
        }
    }
}

/// The vertex and weight of corner k of 8, from each axis' cell and the weight of its upper side; bit a of k is the side along axis a.
pub fn corner(k: usize, cells: [(u32, f64); 3]) -> ([u32; 3], f64) {
    let (mut vertex, mut weight) = ([0; 3], 1.0);
    for a in 0..3 {
        let (cell, upper_weight) = cells[a];
        let upper = k >> a & 1 == 1;
        vertex[a] = if upper { cell + 1 } else { cell };
        weight *= if upper { upper_weight } else { 1.0 - upper_weight };
    }
    (vertex, weight)
}

/// The encoding of one point: for each level the weighted sum of the entries at its cell's 8 corners.
///
/// # Shapes
/// `x` (3) in [0, 1]; result (L F), level by level.
///
/// # Panics
/// Where a level has no entries.
///
/// ```
/// use nerf_oracle::hash_grid::{Level, encode};
/// let mut level = Level::zeros(1, 8, 1);
/// level.table[[7, 0]] = 1.0; // the vertex (1, 1, 1)
/// assert_eq!(encode(&[level], [0.5, 0.5, 1.0]), [0.25]);
/// ```
pub fn encode(levels: &[Level], x: [f64; 3]) -> Vec<f64> {
    let mut out = vec![];
    for level in levels {
        let cells = x.map(|x| level.cell(x)).map(|(cell, f)| (cell, level.weight(f)));
        assert!(level.table.nrows() > 0, "table: at least one entry");
        let mut features = vec![0.0; level.table.ncols()];
        for k in 0..8 {
            let (vertex, weight) = corner(k, cells);
            let entry = level.entry(vertex);
            for f in 0..features.len() {
                features[f] += weight * level.table[[entry, f]];
            }
        }
        out.extend(features);
    }
    out
}
