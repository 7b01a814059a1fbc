//! The NeRF network: parameters, evaluation, rendering, and the gradient of a training step.

use pulp::Arch;

use super::chunk::{ChunkBuffers, Prepared};
use super::gradient::{Gradient, Pool};
use super::product::{Multiply, Plain};
use super::rays::{Rays, Rendered};
use super::skipping::Skipping;
use super::trunk::{Affine, Trunk};
use crate::convention::{Conventions, Density};
use crate::field::nerf_mlp::Shape;
use crate::field::trunk::Plan;
use crate::field::{Layer, NerfMlp};
use crate::parallel;

/// A [`NerfMlp`] in f32, with its encodings, for batches of points and rays.
#[derive(Debug)]
pub struct Network {
    /// Sizes; the columns of the encodings are 3 (1 + 2 L).
    pub shape: Shape,
    /// Density activation.
    pub density: Density,
    /// All parameters: for each layer in the order of [`NerfMlp::layers`] its weights, row by row, then its biases.
    pub params: Vec<f32>,
    /// Instructions used between the matrix products; `Arch::Scalar` gives the plain path.
    pub arch: Arch,
    pub(super) trunk: Trunk,
    pub(super) sigma: Affine,
    pub(super) feature: Affine,
    pub(super) color0: Affine,
    pub(super) color1: Affine,
    pool: Pool<ChunkBuffers>,
}

/// What a training step sees: rays, and the colors that they should have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Batch<'a> {
    /// R rays.
    pub rays: Rays<'a>,
    /// Colors (R, 3) in [0, 1].
    pub targets: &'a [f32],
    /// The color behind everything.
    pub background: [f32; 3],
}

impl Network {
    /// The oracle's network with its parameters rounded to f32; density and skip are those of `c`.
    ///
    /// # Panics
    /// Where the skip's input is [encoding, h].
    pub fn new(oracle: &NerfMlp, shape: &Shape, c: &Conventions) -> Self {
        let Shape { position, direction, width, depth, color, .. } = *shape;
        let mut at = 0;
        Network {
            shape: *shape,
            density: c.density,
            params: oracle
                .layers()
                .iter()
                .flat_map(|(_, l)| l.w.iter().chain(&l.b))
                .map(|&p| p as f32)
                .collect(),
            arch: crate::simd::arch(),
            trunk: Trunk::next(&mut at, position, width, depth, Plan::of(c)),
            sigma: Affine::next(&mut at, width, 1),
            feature: Affine::next(&mut at, width, width),
            color0: Affine::next(&mut at, width + direction, color),
            color1: Affine::next(&mut at, color, 3),
            pool: Pool::default(),
        }
    }

    /// `values` (parameters or their gradient, in the order of [`Self::params`]) as the oracle's network.
    pub fn to_oracle(&self, values: &[f32]) -> NerfMlp {
        let zeros = |layer: &Affine| Layer::zeros(layer.inputs, layer.outputs);
        let mut oracle = NerfMlp {
            trunk: self.trunk.layers.iter().map(zeros).collect(),
            sigma: zeros(&self.sigma),
            feature: zeros(&self.feature),
            color0: zeros(&self.color0),
            color1: zeros(&self.color1),
        };
        let mut values = values.iter();
        for layer in oracle.layers_mut() {
            for (to, from) in layer.w.iter_mut().chain(&mut layer.b).zip(&mut values) {
                *to = f64::from(*from);
            }
        }
        oracle
    }

    /// Densities (M) and colors (M, 3) of points (M, 3), where `samples` consecutive points share a direction.
    ///
    /// # Shapes
    /// `positions` (M, 3), `directions` (M / `samples`, 3).
    ///
    /// # Panics
    /// Where the lengths differ.
    pub fn forward(&self, positions: &[f64], directions: &[f64], samples: usize) -> (Vec<f32>, Vec<f32>) {
        assert_eq!(positions.len(), directions.len() * samples, "positions and directions: `samples` to one");
        let prepared = Prepared::new(self);
        let size = (super::CHUNK / samples).max(1);
        let rays = directions.len() / 3;
        let chunks = parallel::map(rays.div_ceil(size), |n| {
            let (from, to) = (n * size, rays.min((n + 1) * size));
            let positions = &positions[from * samples * 3..to * samples * 3];
            self.pool.with(|chunk| prepared.forward(chunk, positions, &directions[from * 3..to * 3], samples))
        });
        let (mut sigmas, mut rgbs) = (vec![], vec![]);
        for (sigma, rgb) in chunks {
            sigmas.extend(sigma);
            rgbs.extend(rgb);
        }
        (sigmas, rgbs)
    }

    /// Densities (M) of points (M, 3), without colors.
    pub fn densities(&self, positions: &[f64]) -> Vec<f32> {
        let prepared = Prepared::new(self);
        let chunks: Vec<&[f64]> = positions.chunks(3 * super::CHUNK).collect();
        let densities =
            parallel::map(chunks.len(), |n| self.pool.with(|chunk| prepared.densities_of(chunk, chunks[n])));
        densities.concat()
    }

    /// Colors, opacities and depths of rays, for pictures.
    pub fn render(&self, rays: &Rays, background: [f32; 3]) -> Rendered {
        self.render_skipping(rays, Skipping::default(), background)
    }

    /// [`Self::render`] without the samples that `skipping` leaves out.
    pub fn render_skipping(&self, rays: &Rays, skipping: Skipping, background: [f32; 3]) -> Rendered {
        let prepared = Prepared::new(self);
        let spans = skipping.spans(rays);
        let chunks = parallel::map(spans.len(), |n| {
            let (from, to) = spans[n];
            let (part, skipping) = (rays.part(from, to), skipping.part(from, to, rays.samples));
            self.pool.with(|chunk| prepared.render(chunk, &part, skipping, background))
        });
        let mut all = Rendered::default();
        for part in chunks {
            all.colors.extend(part.colors);
            all.opacity.extend(part.opacity);
            all.depth.extend(part.depth);
        }
        all
    }

    /// Weights of all samples (R, N), without colors: what a fine network's samples are drawn from.
    pub fn weights(&self, rays: &Rays) -> Vec<f32> {
        let prepared = Prepared::new(self);
        let size = rays.in_chunk();
        let chunks = parallel::map(rays.len().div_ceil(size), |n| {
            let part = rays.part(n * size, rays.len().min((n + 1) * size));
            self.pool.with(|chunk| {
                prepared.weigh(chunk, &part, Skipping::default());
                chunk.rays.weights.clone()
            })
        });
        chunks.concat()
    }

    /// Loss and gradient of a batch: the mean over rays and channels of (C + T_end background - target)^2.
    ///
    /// `dense` computes every sample's color and backward pass, whether or not they have any effect.
    pub fn step(&self, batch: &Batch, dense: bool, gradient: &mut Gradient) -> f64 {
        self.step_on(batch, Skipping::default(), dense, gradient, &Plain)
    }

    /// [`Self::step`] (not `dense`) without the samples that `skipping` leaves out; the same bits where it leaves out none.
    pub fn step_skipping(&self, batch: &Batch, skipping: Skipping, gradient: &mut Gradient) -> f64 {
        self.step_on(batch, skipping, false, gradient, &Plain)
    }

    /// The step, whose products in chunks `on` computes: the folded matrix, made once a step, is not among them.
    pub(crate) fn step_on(
        &self,
        batch: &Batch,
        skipping: Skipping,
        dense: bool,
        gradient: &mut Gradient,
        on: &impl Multiply,
    ) -> f64 {
        let prepared = Prepared::on(self, on);
        let rays = &batch.rays;
        let spans = skipping.spans(rays);
        let scale = 1.0 / (3 * rays.len()) as f64;
        let len = self.params.len();
        // Behind the parameters: the gradient of the folded matrix M.
        let folded = self.shape.color * self.shape.width;
        let loss = gradient.accumulate(len + folded, spans.len(), |n, group| {
            let (from, to) = spans[n];
            let part =
                Batch { rays: rays.part(from, to), targets: &batch.targets[from * 3..to * 3], ..*batch };
            let skipping = skipping.part(from, to, rays.samples);
            self.pool.with(|chunk| prepared.step(chunk, &part, skipping, dense, scale, group));
        });
        prepared.unfold(&mut gradient.values);
        gradient.values.truncate(len);
        scale * loss
    }
}
