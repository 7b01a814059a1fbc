//! A chunk of rays on one thread: encoding, network and rendering.

use super::activation::{density, sigmoid, slope};
use super::network::Network;
use super::passes::{BiasRelu, Heads};
use super::product::{Matrix, Multiply, Plain, product, transposed};
use super::rays::{Rays, Rendered};
use super::skipping::{Skipping, spread};
use super::trunk::Tape;
use crate::encoding::fast::positional_encoding;
use crate::volume_rendering::fast::RayWeights;

/// The buffers of a chunk. Arrays over active samples hold only those, in order.
#[derive(Debug, Default)]
pub(super) struct ChunkBuffers {
    pub tape: Tape,
    pub positions: Vec<f64>,
    /// Samples that are evaluated (P): each is a row of the tape.
    pub live: Vec<usize>,
    /// Output of the density head (P), and the density; spread to all samples where rays are rendered, 0 where nothing was evaluated.
    pub z: Vec<f32>,
    pub sigmas: Vec<f32>,
    pub deltas: Vec<f32>,
    pub rays: RayWeights,
    /// Samples whose color is computed, and their rows of the tape.
    pub active: Vec<usize>,
    pub rows: Vec<usize>,
    /// Encoded directions (R, direction), and what they and the biases add to the color layer (R, color).
    pub directions: Vec<f32>,
    pub ray_terms: Vec<f32>,
    /// Color layer (active, color) and its gradient; colors (active, 3) and their gradient before the sigmoid.
    pub hidden: Vec<f32>,
    pub g_hidden: Vec<f32>,
    pub rgbs: Vec<f32>,
    pub g_z_rgb: Vec<f32>,
    /// Gradients of the density by sample, and before its activation (active).
    pub g_sigma: Vec<f32>,
    pub g_z: Vec<f32>,
    /// Gradients of the color layer summed over each ray (R, color).
    pub g_rays: Vec<f32>,
}

/// A network's parameters in the layouts that the matrix products need, made once per call.
pub(super) struct Prepared<'a, M = Plain> {
    pub net: &'a Network,
    /// Who multiplies for a chunk.
    pub on: &'a M,
    pub trunk: Vec<Vec<f32>>,
    /// M = w_color w_feature (color, width), and its transpose.
    pub folded: Vec<f32>,
    pub folded_t: Vec<f32>,
    /// b_color + w_color b_feature.
    pub bias: Vec<f32>,
}

impl<'a> Prepared<'a> {
    pub(super) fn new(net: &'a Network) -> Self {
        Self::on(net, &Plain)
    }
}

impl<'a, M: Multiply> Prepared<'a, M> {
    pub(super) fn on(net: &'a Network, on: &'a M) -> Self {
        let (width, color) = (net.shape.width, net.shape.color);
        let (w_feature, b_feature) = net.feature.of(&net.params);
        let (w_color, b_color) = net.color0.of(&net.params);
        let w_color = Matrix::new(w_color, color, width, net.color0.inputs);
        let mut folded = vec![0.0; color * width];
        product(&mut folded, width, w_color, Matrix::new(w_feature, width, width, width), false);
        let mut bias = b_color.to_vec();
        product(&mut bias, 1, w_color, Matrix::new(b_feature, width, 1, 1), true);
        let folded_t = transposed(&folded, color, width);
        Prepared { net, on, trunk: net.trunk.transposed(&net.params), folded, folded_t, bias }
    }

    /// Densities of `chunk.positions`.
    fn densities(&self, chunk: &mut ChunkBuffers) {
        let net = self.net;
        let points = chunk.positions.len() / 3;
        net.trunk.reserve(&mut chunk.tape, points);
        let columns = net.shape.position;
        positional_encoding(net.arch, &chunk.positions, 3, columns / 6, &mut chunk.tape.encoding, columns);
        net.trunk.forward(net.arch, &net.params, &self.trunk, &mut chunk.tape, points, self.on);
        chunk.z.resize(points, 0.0);
        let (w, b) = net.sigma.of(&net.params);
        let x = net.trunk.last(&chunk.tape);
        net.arch.dispatch(Heads::<1> { x, w, bias: b, z: &mut chunk.z });
        chunk.sigmas.clear();
        chunk.sigmas.extend(chunk.z.iter().map(|&z| density(z, net.density)));
    }

    /// Colors of the active samples; their activations move to the front.
    fn colors(&self, chunk: &mut ChunkBuffers, directions: &[f64], samples: usize) {
        let net = self.net;
        let (width, color, columns) = (net.shape.width, net.shape.color, net.shape.direction);
        let (count, rays) = (chunk.active.len(), directions.len() / 3);
        if count < chunk.positions.len() / 3 {
            net.trunk.compact(&mut chunk.tape, &chunk.rows);
        }
        chunk.directions.resize(rays * columns, 0.0);
        positional_encoding(net.arch, directions, 3, columns / 6, &mut chunk.directions, columns);
        chunk.ray_terms.clear();
        chunk.ray_terms.extend((0..rays).flat_map(|_| &self.bias));
        let d = Matrix::new(&chunk.directions, rays, columns, columns);
        let w = Matrix::new(&net.color0.of(&net.params).0[width..], color, columns, net.color0.inputs);
        self.on.product(&mut chunk.ray_terms, color, d, w.t(), true);

        chunk.hidden.resize(count * color, 0.0);
        let h = Matrix::new(net.trunk.last(&chunk.tape), count, width, width);
        let folded = Matrix::new(&self.folded_t, width, color, color);
        self.on.product(&mut chunk.hidden, color, h, folded, false);
        for (from, to, ray) in runs(&chunk.active, samples) {
            let bias = &chunk.ray_terms[ray * color..(ray + 1) * color];
            net.arch.dispatch(BiasRelu {
                x: &mut chunk.hidden[from * color..to * color],
                stride: color,
                bias,
            });
        }
        chunk.rgbs.resize(count * 3, 0.0);
        let (w, b) = net.color1.of(&net.params);
        net.arch.dispatch(Heads::<3> { x: &chunk.hidden, w, bias: b, z: &mut chunk.rgbs });
        for z in &mut chunk.rgbs {
            *z = sigmoid(*z);
        }
    }

    /// Densities of `positions`.
    pub(super) fn densities_of(&self, chunk: &mut ChunkBuffers, positions: &[f64]) -> Vec<f32> {
        chunk.positions.clear();
        chunk.positions.extend(positions);
        self.densities(chunk);
        chunk.sigmas.clone()
    }

    pub(super) fn forward(
        &self,
        chunk: &mut ChunkBuffers,
        positions: &[f64],
        directions: &[f64],
        samples: usize,
    ) -> (Vec<f32>, Vec<f32>) {
        let sigmas = self.densities_of(chunk, positions);
        chunk.active.clear();
        chunk.active.extend(0..positions.len() / 3);
        self.colors(chunk, directions, samples);
        (sigmas, chunk.rgbs.clone())
    }

    /// Weights of all samples, colors of the active ones; colors of the rays in the result.
    pub(super) fn render(
        &self,
        chunk: &mut ChunkBuffers,
        rays: &Rays,
        skipping: Skipping,
        background: [f32; 3],
    ) -> Rendered {
        self.render_active(chunk, rays, skipping, background, false)
    }

    /// Densities of the live samples, and weights of all.
    pub(super) fn weigh(&self, chunk: &mut ChunkBuffers, rays: &Rays, skipping: Skipping) {
        let all = rays.t.len();
        chunk.live.clear();
        chunk.live.extend((0..all).filter(|&n| skipping.live.is_none_or(|live| live[n])));
        rays.positions(&chunk.live, &mut chunk.positions);
        self.densities(chunk);
        spread(&mut chunk.z, &chunk.live, all);
        spread(&mut chunk.sigmas, &chunk.live, all);
        chunk.deltas.clear();
        chunk.deltas.extend(rays.deltas.iter().map(|&d| d as f32));
        chunk.rays.compute(self.net.arch, &chunk.sigmas, &chunk.deltas, rays.samples);
        skipping.end(&mut chunk.rays, rays.samples);
    }

    pub(super) fn render_active(
        &self,
        chunk: &mut ChunkBuffers,
        rays: &Rays,
        skipping: Skipping,
        background: [f32; 3],
        dense: bool,
    ) -> Rendered {
        let samples = rays.samples;
        self.weigh(chunk, rays, skipping);
        let (behind, z) = (&chunk.rays.behind, &chunk.z);
        // Negated, so that a NaN counts as active and shows in the result.
        let dark = |t: f32| t == 0.0 || t < skipping.stop;
        let idle =
            |n: usize| slope(z[n], self.net.density) == 0.0 || (n % samples > 0 && dark(behind[n - 1]));
        chunk.active.clear();
        chunk.rows.clear();
        for (row, &n) in chunk.live.iter().enumerate() {
            if dense || !idle(n) {
                chunk.active.push(n);
                chunk.rows.push(row);
            }
        }
        self.colors(chunk, rays.directions, samples);

        let mut out =
            Rendered { colors: vec![], opacity: vec![0.0; rays.len()], depth: vec![0.0; rays.len()] };
        for last in chunk.rays.behind.chunks_exact(samples).map(|behind| behind[samples - 1]) {
            out.colors.extend(background.map(|b| last * b));
        }
        for (rgb, &n) in chunk.rgbs.chunks_exact(3).zip(&chunk.active) {
            let (w, ray) = (chunk.rays.weights[n], n / samples);
            for (color, c) in out.colors[3 * ray..3 * ray + 3].iter_mut().zip(rgb) {
                *color += w * c;
            }
            out.opacity[ray] += w;
            out.depth[ray] += w * rays.t[n] as f32;
        }
        out
    }
}

/// Consecutive active samples of one ray: (from, to, ray).
pub(super) fn runs(active: &[usize], samples: usize) -> impl Iterator<Item = (usize, usize, usize)> {
    let mut from = 0;
    active.chunk_by(move |a, b| a / samples == b / samples).map(move |run| {
        let span = (from, from + run.len(), run[0] / samples);
        from += run.len();
        span
    })
}
