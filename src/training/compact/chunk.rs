//! A chunk of whole rays and the buffers of their samples, small enough for a core's L2 cache.

use super::networks::{GEOMETRY, HIDDEN, Networks, Weights};
use super::pace::Pace;
use super::scatter::Scatter;
use super::views::{BoxRay, Target};
use crate::hash_grid::fast::{Entry, FEATURES, LEVELS, WIDTH};
use crate::occupancy_grid::fast::{MarchRay, Steps};
use crate::simd::{Aligned, repeated};
use crate::spherical_harmonics::fast::{self as harmonics, harmonics};

/// Rows of a block: the kernels take whole blocks.
pub(super) const BLOCK: usize = 16;

/// Samples that pass through a network together: their activations fill the L1 cache.
pub(super) const TILE: usize = 64;

/// The parameters that all chunks of a batch share.
#[derive(Clone, Copy)]
pub(super) struct Pass<'a> {
    pub nets: &'a Networks,
    /// The weights that it goes forward through.
    pub weights: &'a Weights,
    /// A ray ends where its transmittance falls below this.
    pub stop: f32,
    pub view_dependent: bool,
    /// d loss / d color over the error, 2 / (3 rays): the loss is the mean squared error. `None`: forward alone.
    pub gradient: Option<f32>,
    /// The distortion loss beside it.
    pub scatter: Option<Scatter>,
}

/// A ray, the range of its samples in the chunk, and its rendering.
#[derive(Clone, Copy)]
pub(crate) struct Ray {
    pub first: usize,
    pub count: usize,
    pub target: Target,
    pub harmonics: [f32; harmonics::WIDTH],
    /// The training pixel that it comes from.
    pub pixel: u32,
    /// Whether there may be more samples after its last one.
    pub cut: bool,
    /// Color over the background. Before a pass: what samples in front of this chunk's have added.
    pub color: [f32; 3],
    /// T behind the last sample. Before a pass: the light that is left for this chunk's samples.
    pub transmittance: f32,
    /// sum of w t, with what was added before.
    pub depth: f32,
    /// Forward: the harmonics' part of the color network's hidden layer, the same for all samples. Backward: its gradient.
    pub view: [f32; HIDDEN],
}

/// Rays, samples and activations. Rows beyond the samples pad the last block and have any finite value.
pub(crate) struct Chunk {
    pub rays: Vec<Ray>,
    /// Positions of the samples along the ray, as the march found them.
    pub steps: Steps,
    /// Samples in the unit box; after [`Chunk::keep`] the live ones alone.
    pub points: Vec<[f32; 3]>,
    /// Their distances along the ray.
    pub t: Vec<f32>,
    /// Their step lengths, in the unit in which the network's densities are 1 / length.
    pub delta: Vec<f32>,
    pub ray_of: Vec<u32>,
    /// Encodings, level by level; after the backward pass their gradients.
    pub encoding: [Aligned<Entry>; LEVELS],
    /// All samples before the early stop, with their densities.
    pub visited: Vec<[f32; 3]>,
    pub sigma: Vec<f32>,
    pub hidden0: Aligned<[f32; HIDDEN]>,
    pub geometry: Aligned<[f32; GEOMETRY]>,
    pub hidden1: Aligned<[f32; HIDDEN]>,
    /// Columns 0 to 2: the raw color, then the color, then the raw color's gradient. See `composite` for the others.
    pub rgb: Aligned<[f32; 16]>,
    pub gradient: Weights,
    /// Samples of the rays whose errors count.
    pub counted: usize,
    /// Sum of squared errors over rays and channels.
    pub error: f64,
    /// Pixels of the rays that aren't in that sum, because they were ended too early.
    pub again: Vec<u32>,
}

impl Default for Chunk {
    fn default() -> Self {
        Chunk {
            rays: vec![],
            steps: Steps::default(),
            points: vec![],
            t: vec![],
            delta: vec![],
            ray_of: vec![],
            encoding: std::array::from_fn(|_| repeated([0.0; FEATURES], 0)),
            visited: vec![],
            sigma: vec![],
            hidden0: repeated([0.0; HIDDEN], 0),
            geometry: repeated([0.0; GEOMETRY], 0),
            hidden1: repeated([0.0; HIDDEN], 0),
            rgb: repeated([0.0; 16], 0),
            gradient: Weights::zeros(),
            error: 0.0,
            again: vec![],
            counted: 0,
        }
    }
}

impl Chunk {
    /// No rays, no samples; the buffers keep their size.
    pub(crate) fn clear(&mut self) {
        self.rays.clear();
        self.points.clear();
        self.t.clear();
        self.delta.clear();
        self.ray_of.clear();
    }

    /// The next ray and what its pixel shows; samples pushed from now on are its own.
    #[inline(always)]
    pub(super) fn push_ray(&mut self, ray: &BoxRay, target: Target, pixel: u32, cut: bool) {
        self.rays.push(Ray {
            first: self.points.len(),
            count: 0,
            target,
            harmonics: harmonics(ray.unit),
            pixel,
            cut,
            color: [0.0; 3],
            transmittance: 1.0,
            depth: 0.0,
            view: [0.0; HIDDEN],
        });
    }

    /// A ray of a pass before, with the light that was left; samples pushed from now on lie behind those that it had.
    #[inline(always)]
    pub(super) fn resume(&mut self, ray: Ray) {
        self.rays.push(Ray { first: self.points.len(), count: 0, view: [0.0; HIDDEN], ..ray });
    }

    /// The samples of the last ray, so many of its steps.
    #[inline(always)]
    pub(super) fn push_samples(&mut self, march_ray: &MarchRay, k: &[f32], pace: &Pace) {
        let ray = self.rays.len() - 1;
        pace.place(march_ray, k, [&mut self.t, &mut self.delta], &mut self.points);
        self.ray_of.extend(k.iter().map(|_| ray as u32));
        self.rays[ray].count = k.len();
    }

    /// Resizes the activations to the samples pushed so far.
    pub(crate) fn reserve(&mut self) {
        let rows = self.rows();
        if self.rgb.len() < rows {
            self.encoding.iter_mut().for_each(|level| level.resize(rows, [0.0; FEATURES]));
            self.hidden0.resize(rows, [0.0; HIDDEN]);
            self.geometry.resize(rows, [0.0; GEOMETRY]);
            self.hidden1.resize(rows, [0.0; HIDDEN]);
            self.rgb.resize(rows, [0.0; 16]);
        }
    }

    /// Levels that aren't in use yet are 0.
    pub(crate) fn clear_levels(&mut self, active: usize) {
        let rows = self.rows();
        self.encoding[active..].iter_mut().for_each(|level| level[..rows].fill([0.0; FEATURES]));
    }

    /// The encodings of some rows, all levels side by side.
    #[inline(always)]
    pub(crate) fn gather(&self, first: usize, rows: &mut [[f32; WIDTH]]) {
        for (l, level) in self.encoding.iter().enumerate() {
            for (row, entry) in rows.iter_mut().zip(&level[first..]) {
                row.as_chunks_mut().0[l] = *entry;
            }
        }
    }

    /// Writes rows back, level by level.
    #[inline(always)]
    pub(crate) fn spread(&mut self, first: usize, rows: &[[f32; WIDTH]]) {
        for (l, level) in self.encoding.iter_mut().enumerate() {
            for (row, entry) in rows.iter().zip(&mut level[first..]) {
                *entry = row.as_chunks().0[l];
            }
        }
    }

    /// Samples, padded to whole blocks.
    pub(crate) fn rows(&self) -> usize {
        self.points.len().next_multiple_of(BLOCK)
    }

    /// Keeps the first `live(ray)` samples of each ray and compacts them, with all of their arrays.
    #[inline(always)]
    pub(crate) fn keep(&mut self, live: impl Fn(&Ray, &[f32], &[f32]) -> usize) {
        self.visited.clone_from(&self.points);
        let mut kept = 0;
        for ray in &mut self.rays {
            let samples = ray.first..ray.first + ray.count;
            let count = live(ray, &self.sigma[samples.clone()], &self.delta[samples]);
            let from = ray.first..ray.first + count;
            if kept != ray.first {
                self.points.copy_within(from.clone(), kept);
                self.t.copy_within(from.clone(), kept);
                self.delta.copy_within(from.clone(), kept);
                self.ray_of.copy_within(from.clone(), kept);
                self.encoding.iter_mut().for_each(|level| level.copy_within(from.clone(), kept));
                self.hidden0.copy_within(from.clone(), kept);
                self.geometry.copy_within(from, kept);
            }
            (ray.first, ray.count) = (kept, count);
            kept += count;
        }
        self.points.truncate(kept);
        self.t.truncate(kept);
        self.delta.truncate(kept);
        self.ray_of.truncate(kept);
    }
}
