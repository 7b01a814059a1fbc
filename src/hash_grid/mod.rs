//! Multi-resolution hash grid: a point of the unit box -> trilinearly interpolated features of several grids.
//!
//! Instant-NGP (Mueller et al. 2022) equations 2 to 4. Letters: `N` cells along an edge of a level, so that it has (N + 1)^3
//! vertices; `T` largest number of table entries of a level; `F` features of an entry; `x` a point of [0, 1]^3.
//! A level whose vertices fit into T entries is dense: every vertex has its own entry. In others, vertices share entries by a hash;
//! training resolves collisions, because vertices in empty space have no gradient.

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

/// One grid and its table.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// N.
    pub resolution: u32,
    /// Entries, each F features; (N + 1)^3 of them where dense, otherwise a power of two.
    pub table: Vec<Vec<f64>>,
}

/// Factors of the hash, equation 4. The first is 1, so that neighbors along x stay neighbors in memory.
pub const PRIMES: [u32; 3] = [1, 2_654_435_761, 805_459_861];

/// The levels' resolutions: N_l = base * growth^l with growth = (finest / base)^(1 / (levels - 1)), equations 2 and 3.
///
/// # Convention
/// Rounded to the nearest whole number, where the paper rounds down: rounding down would make the finest level depend on the last bit of
/// the power.
///
/// ```
/// assert_eq!(nerf_oracle::hash_grid::resolutions(16, 128, 4), [16, 32, 64, 128]);
/// ```
pub fn resolutions(base: u32, finest: u32, levels: usize) -> Vec<u32> {
    let ratio = f64::from(finest) / f64::from(base);
    let steps = (levels.max(2) - 1) as f64;
    (0..levels).map(|l| (f64::from(base) * pow(ratio, l as f64 / steps)).round() as u32).collect()
}

/// Whether all (N + 1)^3 vertices fit into `max_entries`.
pub fn is_dense(resolution: u32, max_entries: usize) -> bool {
    let side = u64::from(resolution) + 1;
    side * side * side <= max_entries as u64
}

impl Level {
    /// A level of zeros: dense where its vertices fit into `max_entries`, which must be a power of two.
    pub fn zeros(resolution: u32, max_entries: usize, features: usize) -> Level {
        let side = resolution as usize + 1;
        let entries = if is_dense(resolution, max_entries) { side * side * side } else { max_entries };
        Level { resolution, table: vec![vec![0.0; features]; entries] }
    }

    /// Whether every vertex has its own entry.
    pub fn dense(&self) -> bool {
        is_dense(self.resolution, self.table.len())
    }

    /// The entry of a vertex: x + (N + 1) (y + (N + 1) z), or (x xor y p_2 xor z p_3) mod T in 32-bit arithmetic.
    pub fn entry(&self, [x, y, z]: [u32; 3]) -> usize {
        if self.dense() {
            let side = self.resolution as usize + 1;
            return x as usize + side * (y as usize + side * z as usize);
        }
        let hash = x.wrapping_mul(PRIMES[0]) ^ y.wrapping_mul(PRIMES[1]) ^ z.wrapping_mul(PRIMES[2]);
        hash as usize % self.table.len()
    }
}

/// The cell of `x` along one axis and the place in it: (c, f) with x N = c + f. The last cell is closed: x = 1 is (N - 1, 1).
pub fn cell(x: f64, resolution: u32) -> (u32, f64) {
    let scaled = x * f64::from(resolution);
    let cell = scaled.floor().clamp(0.0, f64::from(resolution - 1));
    (cell as u32, scaled - cell)
}

/// The vertex and trilinear weight of corner k of 8; bit a of k is the side along axis a.
pub fn corner(k: usize, cells: [(u32, f64); 3]) -> ([u32; 3], f64) {
    let (mut vertex, mut weight) = ([0; 3], 1.0);
    for a in 0..3 {
        let (cell, fraction) = cells[a];
        let upper = k >> a & 1 == 1;
        vertex[a] = if upper { cell + 1 } else { cell };
        weight *= if upper { fraction } else { 1.0 - fraction };
    }
    (vertex, weight)
}

/// The encoding of one point: for each level the weighted sum of the entries at its cell's 8 corners.
///
/// # Shapes
/// `x` (3) in [0, 1]; result (L F), level by level.
///
/// # Panics
/// Where a level has no entries, or entries of different lengths meet at a corner of the cell.
///
/// ```
/// use nerf_oracle::hash_grid::{Level, encode};
/// let mut level = Level::zeros(1, 8, 1);
/// level.table[7] = vec![1.0]; // the vertex (1, 1, 1)
/// assert_eq!(encode(&[level], [0.5, 0.5, 1.0]), [0.25]);
/// ```
pub fn encode(levels: &[Level], x: [f64; 3]) -> Vec<f64> {
    let mut out = vec![];
    for level in levels {
        let cells = x.map(|x| cell(x, level.resolution));
        let mut features = vec![0.0; level.table[0].len()];
        for k in 0..8 {
            let (vertex, weight) = corner(k, cells);
            let entry = &level.table[level.entry(vertex)];
            assert_eq!(entry.len(), features.len(), "entries of a table: as many features as the first");
            for f in 0..features.len() {
                features[f] += weight * entry[f];
            }
        }
        out.extend(features);
    }
    out
}
