//! f32 hash grid: 4 features per level, each level's table small enough for a core's L2 cache, level by level.
//!
//! A level belongs to one task at a time, which adds gradients in the order of the points: same bits on any number of threads, and faster
//! than atomics or private copies. Levels take turns with a task's buffer of gradients, which stays in the cache. Corner indices and
//! weights of 16 points are computed together, in vectors; an entry is 16 bytes: one load and one multiply-add per corner. Features are
//! stored level by level too, a buffer each: four points fill a cache line.

use pulp::{Arch, Simd, WithSimd};

use crate::optimizer::fast::Rates;
use crate::simd::{Aligned, copied, multiply_add, repeated};

/// F.
pub const FEATURES: usize = 4;
/// Levels; the encoding has `LEVELS * FEATURES` columns.
pub const LEVELS: usize = 8;
/// Columns of the encoding, all levels side by side.
pub const WIDTH: usize = LEVELS * FEATURES;
/// Points whose corners are computed together.
pub(crate) const BLOCK: usize = 16;
/// Entries of a cache line, the unit of the sparse optimizer.
const LINE: usize = 4;

/// Features at a vertex.
pub type Entry = [f32; FEATURES];

/// One grid, its table, and its optimizer's state.
#[derive(Clone, Debug)]
pub struct Level {
    resolution: u32,
    dense: bool,
    table: Aligned<Entry>,
    m: Aligned<Entry>,
    v: Aligned<Entry>,
    /// The table's running mean, of which pictures are made.
    mean: Aligned<Entry>,
}

/// The gradient of a level's table while a step adds it up. Levels take turns with one, so that it stays in the cache.
#[derive(Clone, Debug)]
pub struct Gradient {
    entries: Aligned<Entry>,
    /// The cache lines of `entries` that aren't all 0.
    touched: Vec<bool>,
}

impl Default for Gradient {
    fn default() -> Self {
        Gradient { entries: repeated([0.0; FEATURES], 0), touched: vec![] }
    }
}

impl Gradient {
    /// The entries, as many as those of the largest level that has used it.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Room for a level's.
    fn reserve(&mut self, level: &Level) {
        if self.entries.len() < level.table.len() {
            self.entries.resize(level.table.len(), [0.0; FEATURES]);
            self.touched.resize(level.table.len() / LINE, false);
        }
    }
}

impl Level {
    /// A level with this table: (N + 1)^3 entries if `dense`, otherwise a power of two.
    pub fn new(resolution: u32, mut table: Vec<Entry>, dense: bool) -> Self {
        table.resize(table.len().next_multiple_of(LINE), [0.0; FEATURES]);
        let (zeros, table) = (repeated([0.0; FEATURES], table.len()), copied(&table));
        Level { resolution, dense, m: zeros.clone(), v: zeros, mean: table.clone(), table }
    }

    /// The table.
    pub fn table(&self) -> &[Entry] {
        &self.table
    }

    /// N.
    pub fn resolution(&self) -> u32 {
        self.resolution
    }

    /// Whether every vertex has its own entry.
    pub fn dense(&self) -> bool {
        self.dense
    }

    /// The table's running mean, as far as [`average`] has moved it.
    pub fn mean(&self) -> &[Entry] {
        &self.mean
    }

    /// Table and running means, as one state: parameters, m, v, and the parameters' own mean.
    pub fn state(&self) -> [&[Entry]; 4] {
        [&self.table, &self.m, &self.v, &self.mean]
    }

    /// The same, to be filled from a checkpoint.
    pub fn state_mut(&mut self) -> [&mut [Entry]; 4] {
        [&mut self.table, &mut self.m, &mut self.v, &mut self.mean]
    }

    /// Table indices and trilinear weights of the 8 corners of up to 16 points.
    #[inline(always)]
    pub(crate) fn corners(
        &self,
        points: &[[f32; 3]],
        index: &mut [[u32; BLOCK]; 8],
        weight: &mut [[f32; BLOCK]; 8],
    ) {
        let (scale, top) = (self.resolution as f32, (self.resolution - 1) as f32);
        let (mut fraction, mut low) = ([[0f32; BLOCK]; 3], [[0u32; BLOCK]; 3]);
        for axis in 0..3 {
            let mut x = [0f32; BLOCK];
            x.iter_mut().zip(points).for_each(|(x, p)| *x = p[axis]);
            for i in 0..BLOCK {
                let scaled = x[i] * scale;
                let cell = if scaled < top { scaled } else { top }.trunc();
                // From 2^23 on a float's low bits are its whole part; a conversion that saturates isn't vector code.
                low[axis][i] = (cell + 8_388_608.0).to_bits() & 0x7f_ffff;
                fraction[axis][i] = scaled - cell;
            }
        }
        let side = self.resolution + 1;
        let [_, y, z] = super::PRIMES;
        let (stride_y, stride_z) = if self.dense { (side, side * side) } else { (y, z) };
        let mask = self.table.len() as u32 - 1;
        for corner in 0..8 {
            let upper = [corner & 1, corner >> 1 & 1, corner >> 2];
            for i in 0..BLOCK {
                let x = low[0][i] + upper[0];
                let y = (low[1][i] + upper[1]).wrapping_mul(stride_y);
                let z = (low[2][i] + upper[2]).wrapping_mul(stride_z);
                index[corner as usize][i] = if self.dense { x + y + z } else { (x ^ y ^ z) & mask };
                let along = |a: usize| if upper[a] == 1 { fraction[a][i] } else { 1.0 - fraction[a][i] };
                weight[corner as usize][i] = along(0) * along(1) * along(2);
            }
        }
    }
}

struct Encode<'a> {
    level: &'a Level,
    table: &'a [Entry],
    points: &'a [[f32; 3]],
    out: &'a mut [Entry],
}

impl WithSimd for Encode<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (mut index, mut weight) = ([[0; BLOCK]; 8], [[0.0; BLOCK]; 8]);
        for (points, out) in self.points.chunks(BLOCK).zip(self.out.chunks_mut(BLOCK)) {
            self.level.corners(points, &mut index, &mut weight);
            for (i, out) in out.iter_mut().enumerate().take(points.len()) {
                let mut sum = [0f32; FEATURES];
                for corner in 0..8 {
                    let entry = &self.table[index[corner][i] as usize];
                    for f in 0..FEATURES {
                        sum[f] = multiply_add::<S>(weight[corner][i], entry[f], sum[f]);
                    }
                }
                *out = sum;
            }
        }
    }
}

struct Scatter<'a> {
    level: &'a Level,
    gradient: &'a mut Gradient,
    points: &'a [[f32; 3]],
    g_out: &'a [Entry],
}

impl WithSimd for Scatter<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (mut index, mut weight) = ([[0; BLOCK]; 8], [[0.0; BLOCK]; 8]);
        for (points, g_out) in self.points.chunks(BLOCK).zip(self.g_out.chunks(BLOCK)) {
            self.level.corners(points, &mut index, &mut weight);
            let (gradient, touched) = (&mut self.gradient.entries[..], &mut self.gradient.touched[..]);
            for (i, &g_out) in g_out.iter().enumerate().take(points.len()) {
                for corner in 0..8 {
                    let entry = index[corner][i] as usize;
                    for f in 0..FEATURES {
                        let sum = &mut gradient[entry][f];
                        *sum = multiply_add::<S>(weight[corner][i], g_out[f], *sum);
                    }
                    touched[entry / LINE] = true;
                }
            }
        }
    }
}

struct Update<'a> {
    level: &'a mut Level,
    gradient: &'a mut Gradient,
    rates: Rates,
}

impl WithSimd for Update<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (Level { table, m, v, .. }, Gradient { entries: gradient, touched }) =
            (self.level, self.gradient);
        let lines = |entries| <[Entry]>::as_chunks_mut::<LINE>(entries).0;
        let (table, gradient, m, v) = (lines(table), lines(gradient), lines(m), lines(v));
        for (line, touched) in touched.iter_mut().enumerate().filter(|(_, touched)| **touched) {
            *touched = false;
            let (p, g) = (table[line].as_flattened_mut(), gradient[line].as_flattened_mut());
            let (m, v) = (m[line].as_flattened_mut(), v[line].as_flattened_mut());
            for i in 0..LINE * FEATURES {
                let new = self.rates.one(p[i], g[i], m[i], v[i]);
                (p[i], m[i], v[i]) = if g[i] == 0.0 { (p[i], m[i], v[i]) } else { new };
                g[i] = 0.0;
            }
        }
    }
}

struct Average<'a> {
    level: &'a mut Level,
    rate: f32,
}

impl WithSimd for Average<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Level { table, mean, .. } = self.level;
        for (mean, x) in mean.as_flattened_mut().iter_mut().zip(table.as_flattened()) {
            *mean += self.rate * (x - *mean);
        }
    }
}

/// A level's features at `points` of the unit box, read from `table`, its own or its mean, into `out`, which may be longer.
///
/// # Panics
/// Where `out` is shorter, or the table has another length.
pub fn encode_level(arch: Arch, level: &Level, table: &[Entry], points: &[[f32; 3]], out: &mut [Entry]) {
    assert!(out.len() >= points.len(), "out and points: {} entries for {} points", out.len(), points.len());
    assert_eq!(table.len(), level.table.len(), "table: a level's own");
    arch.dispatch(Encode { level, table, points, out });
}

/// Adds the gradients of a level's features at `points`, in order, to its table's, `gradient`. `g_out` may be longer.
///
/// # Panics
/// Where `g_out` is shorter.
pub fn scatter(arch: Arch, level: &Level, points: &[[f32; 3]], g_out: &[Entry], gradient: &mut Gradient) {
    assert!(
        g_out.len() >= points.len(),
        "g_out and points: {} entries for {} points",
        g_out.len(),
        points.len()
    );
    gradient.reserve(level);
    arch.dispatch(Scatter { level, gradient, points, g_out });
}

/// Adam on the parameters that have a gradient, which is cleared for the next level. The others keep their running means, as in Instant-NGP.
pub fn update(arch: Arch, level: &mut Level, gradient: &mut Gradient, rates: Rates) {
    gradient.reserve(level);
    arch.dispatch(Update { level, gradient, rates });
}

/// The table's mean goes by a share `rate` to where the table is.
pub fn average(arch: Arch, level: &mut Level, rate: f32) {
    arch.dispatch(Average { level, rate });
}

#[cfg(test)]
mod tests;
