//! The 2D network: pixel -> color, for fitting pictures.

use pulp::Arch;

use super::activation::sigmoid;
use super::gradient::{Gradient, Pool};
use super::passes::{AddRows, Heads, HeadsBackward};
use super::product::Plain;
use super::trunk::{Affine, Tape, Trunk};
use crate::encoding::fast::positional_encoding;
use crate::field::Mlp;
use crate::field::trunk::Plan;
use crate::parallel;

/// An [`Mlp`] in f32 with its encoding: hidden layers of one width with ReLU, a sigmoid after three outputs.
#[derive(Debug)]
pub struct ImageNetwork {
    /// All parameters: for each layer its weights (out, in), row by row, then its biases.
    pub params: Vec<f32>,
    /// Instructions used between the matrix products; `Arch::Scalar` gives the plain path.
    pub arch: Arch,
    dims: usize,
    trunk: Trunk,
    head: Affine,
    pool: Pool<ImageBuffers>,
}

#[derive(Debug, Default)]
struct ImageBuffers {
    tape: Tape,
    rgbs: Vec<f32>,
    g_z: Vec<f32>,
}

impl ImageNetwork {
    /// The oracle's network on inputs of `dims` dimensions, encoded to as many columns as its first layer takes, with its
    /// parameters rounded to f32.
    pub fn new(oracle: &Mlp, dims: usize) -> Self {
        let depth = oracle.layers.len() - 1;
        let (width, columns) = oracle.layers[0].w.dim();
        let mut at = 0;
        ImageNetwork {
            params: oracle.layers.iter().flat_map(|l| l.w.iter().chain(&l.b)).map(|&p| p as f32).collect(),
            arch: crate::simd::arch(),
            dims,
            trunk: Trunk::next(&mut at, columns, width, depth, Plan::straight()),
            head: Affine::next(&mut at, width, 3),
            pool: Pool::default(),
        }
    }

    /// Writes `values` (parameters or their gradient) to the oracle's layers.
    pub fn write_to(&self, values: &[f32], oracle: &mut Mlp) {
        let mut values = values.iter();
        for layer in &mut oracle.layers {
            for (to, from) in layer.w.iter_mut().chain(&mut layer.b).zip(&mut values) {
                *to = f64::from(*from);
            }
        }
    }

    /// Colors (M, 3) of points `x` (M, dims).
    pub fn forward(&self, x: &[f64]) -> Vec<f32> {
        let transposed = self.trunk.transposed(&self.params);
        let size = super::CHUNK * self.dims;
        let mut colors = vec![0.0; x.len() / self.dims * 3];
        parallel::for_chunks(&mut colors, super::CHUNK * 3, |n, colors| {
            let x = &x[n * size..x.len().min((n + 1) * size)];
            self.pool.with(|work| {
                self.colors(work, &transposed, x);
                colors.copy_from_slice(&work.rgbs);
            });
        });
        colors
    }

    /// Loss and gradient of a batch: the mean over points and channels of (color - target)^2.
    ///
    /// # Shapes
    /// `x` (M, dims), `targets` (M, 3).
    ///
    /// # Panics
    /// Where these aren't as many points.
    pub fn step(&self, x: &[f64], targets: &[f32], gradient: &mut Gradient) -> f64 {
        let transposed = self.trunk.transposed(&self.params);
        let points = x.len() / self.dims;
        assert_eq!(targets.len(), 3 * points, "targets and points of x: three each a point");
        let scale = 1.0 / (3 * points) as f64;
        let loss = gradient.accumulate(self.params.len(), points.div_ceil(super::CHUNK), |n, group| {
            let (from, to) = (n * super::CHUNK, points.min((n + 1) * super::CHUNK));
            group.forward_points += to - from;
            group.backward_points += to - from;
            self.pool.with(|work| {
                self.colors(work, &transposed, &x[from * self.dims..to * self.dims]);
                let targets = &targets[from * 3..to * 3];
                group.loss += self.loss(work, targets, scale);
                self.backward(work, to - from, &mut group.partial);
            });
        });
        scale * loss
    }

    fn colors(&self, work: &mut ImageBuffers, transposed: &[Vec<f32>], x: &[f64]) {
        let (points, columns) = (x.len() / self.dims, self.trunk.encoding);
        self.trunk.reserve(&mut work.tape, points);
        let levels = (columns / self.dims - 1) / 2;
        positional_encoding(self.arch, x, self.dims, levels, &mut work.tape.encoding, columns);
        self.trunk.forward(self.arch, &self.params, transposed, &mut work.tape, points, &Plain);
        work.rgbs.resize(points * 3, 0.0);
        let (w, b) = self.head.of(&self.params);
        let x = self.trunk.last(&work.tape);
        self.arch.dispatch(Heads::<3> { x, w, bias: b, z: &mut work.rgbs });
        for z in &mut work.rgbs {
            *z = sigmoid(*z);
        }
    }

    /// The sum of squared errors; leaves the gradient before the sigmoid in `work.g_z`.
    fn loss(&self, work: &mut ImageBuffers, targets: &[f32], scale: f64) -> f64 {
        let mut sum = 0.0;
        work.g_z.clear();
        for (c, target) in work.rgbs.iter().zip(targets) {
            let r = c - target;
            sum += f64::from(r) * f64::from(r);
            work.g_z.push((2.0 * scale) as f32 * r * c * (1.0 - c));
        }
        sum
    }

    fn backward(&self, work: &mut ImageBuffers, points: usize, gradient: &mut [f32]) {
        let width = self.trunk.width;
        let mut g = std::mem::take(&mut work.tape.g);
        let (w, (g_w, g_bias)) = (self.head.of(&self.params).0, self.head.of_mut(gradient));
        let x = self.trunk.last(&work.tape);
        self.arch.dispatch(HeadsBackward::<3> { x, g_z: &work.g_z, w, g_w, g_bias, g_x: &mut g });
        let g_last = self.trunk.layers[self.trunk.layers.len() - 1].of_mut(gradient).1;
        self.arch.dispatch(AddRows { sum: g_last, rows: &g[..points * width] });
        work.tape.g = g;
        self.trunk.backward(self.arch, &self.params, &mut work.tape, points, gradient, &Plain);
    }
}
