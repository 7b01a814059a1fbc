//! A chunk of rays on one thread: encoding, network and rendering, and all of it backward.

use super::gradient::Group;
use super::network::{Batch, Network};
use super::passes::{AddRows, BiasRelu, Heads, HeadsBackward, JoinBackward};
use super::product::{Matrix, product, transposed};
use super::trunk::Tape;
use crate::convention::Density;
use crate::encoding::fast::positional_encoding;
use crate::volume_rendering::fast::{Weights, attenuation, density_gradient};

/// Rays with N samples each. Geometry is f64: it costs nothing beside the network, and 2^9 pi x magnifies its rounding.
#[derive(Clone, Copy, Debug)]
pub struct Rays<'a> {
    /// Origins (R, 3).
    pub origins: &'a [f64],
    /// Directions (R, 3); unit in the profile `cs180`.
    pub directions: &'a [f64],
    /// Sample distances (R, N).
    pub t: &'a [f64],
    /// Step lengths (R, N).
    pub deltas: &'a [f64],
    /// N.
    pub samples: usize,
}

/// A picture's worth of rendered rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rendered {
    /// Colours over the background (R, 3).
    pub colors: Vec<f32>,
    /// Opacity, the sum of the weights (R).
    pub opacity: Vec<f32>,
    /// sum w t (R), not divided by the opacity.
    pub depth: Vec<f32>,
}

impl<'a> Rays<'a> {
    /// R.
    #[allow(clippy::len_without_is_empty, reason = "nobody asks")]
    pub fn len(&self) -> usize {
        self.origins.len() / 3
    }

    /// Rays that make up a chunk.
    pub(super) fn in_chunk(&self) -> usize {
        (super::CHUNK / self.samples).max(1)
    }

    pub(super) fn part(&self, from: usize, to: usize) -> Rays<'a> {
        let n = self.samples;
        Rays {
            origins: &self.origins[from * 3..to * 3],
            directions: &self.directions[from * 3..to * 3],
            t: &self.t[from * n..to * n],
            deltas: &self.deltas[from * n..to * n],
            samples: n,
        }
    }

    /// o + t d (R N, 3).
    fn positions(&self, out: &mut Vec<f64>) {
        out.clear();
        let rays = self
            .origins
            .chunks_exact(3)
            .zip(self.directions.chunks_exact(3))
            .zip(self.t.chunks_exact(self.samples));
        for ((o, d), t) in rays {
            out.extend(t.iter().flat_map(|t| [o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]]));
        }
    }
}

/// Everything that a chunk needs memory for. Arrays over active samples hold those alone, in order.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    tape: Tape,
    positions: Vec<f64>,
    /// Output of the density head (P), and the density.
    z: Vec<f32>,
    sigmas: Vec<f32>,
    deltas: Vec<f32>,
    rays: Weights,
    /// Samples whose colour is wanted.
    active: Vec<usize>,
    /// Encoded directions (R, direction), and what they and the biases add to the colour layer (R, color).
    directions: Vec<f32>,
    ray_terms: Vec<f32>,
    /// Colour layer (active, color) and its gradient; colours (active, 3) and their gradient before the sigmoid.
    hidden: Vec<f32>,
    g_hidden: Vec<f32>,
    rgbs: Vec<f32>,
    g_z_rgb: Vec<f32>,
    /// Gradients of the density by sample (P), and before its activation (active).
    g_sigma: Vec<f32>,
    g_z: Vec<f32>,
    /// Gradients of the colour layer summed over each ray (R, color).
    g_rays: Vec<f32>,
}

/// A network's parameters in the forms that products want, made once a call.
pub(super) struct Prepared<'a> {
    net: &'a Network,
    trunk: Vec<Vec<f32>>,
    /// M = w_color w_feature (color, width), and its transpose.
    folded: Vec<f32>,
    folded_t: Vec<f32>,
    /// b_color + w_color b_feature.
    bias: Vec<f32>,
}

impl<'a> Prepared<'a> {
    pub fn new(net: &'a Network) -> Self {
        let (width, color) = (net.shape.width, net.shape.color);
        let (w_feature, b_feature) = net.feature.of(&net.params);
        let (w_color, b_color) = net.color0.of(&net.params);
        let w_color = Matrix::new(w_color, color, width, net.color0.inputs);
        let mut folded = vec![0.0; color * width];
        product(&mut folded, width, w_color, Matrix::new(w_feature, width, width, width), false);
        let mut bias = b_color.to_vec();
        product(&mut bias, 1, w_color, Matrix::new(b_feature, width, 1, 1), true);
        let folded_t = transposed(&folded, color, width);
        Prepared { net, trunk: net.trunk.transposed(&net.params), folded, folded_t, bias }
    }

    /// Densities of `chunk.positions`.
    fn densities(&self, chunk: &mut Chunk) {
        let net = self.net;
        let points = chunk.positions.len() / 3;
        net.trunk.reserve(&mut chunk.tape, points);
        let columns = net.shape.position;
        positional_encoding(net.arch, &chunk.positions, 3, columns / 6, &mut chunk.tape.encoding, columns);
        net.trunk.forward(net.arch, &net.params, &self.trunk, &mut chunk.tape, points);
        chunk.z.resize(points, 0.0);
        let (w, b) = net.sigma.of(&net.params);
        let x = net.trunk.last(&chunk.tape);
        net.arch.dispatch(Heads::<1> { x, w, bias: b, z: &mut chunk.z });
        chunk.sigmas.clear();
        chunk.sigmas.extend(chunk.z.iter().map(|&z| density(z, net.density)));
    }

    /// Colours of the active samples; their activations move to the front.
    fn colors(&self, chunk: &mut Chunk, directions: &[f64], samples: usize) {
        let net = self.net;
        let (width, color, columns) = (net.shape.width, net.shape.color, net.shape.direction);
        let (count, rays) = (chunk.active.len(), directions.len() / 3);
        if count < chunk.z.len() {
            net.trunk.compact(&mut chunk.tape, &chunk.active);
        }
        chunk.directions.resize(rays * columns, 0.0);
        positional_encoding(net.arch, directions, 3, columns / 6, &mut chunk.directions, columns);
        chunk.ray_terms.clear();
        chunk.ray_terms.extend((0..rays).flat_map(|_| &self.bias));
        let d = Matrix::new(&chunk.directions, rays, columns, columns);
        let w = Matrix::new(&net.color0.of(&net.params).0[width..], color, columns, net.color0.inputs);
        product(&mut chunk.ray_terms, color, d, w.t(), true);

        chunk.hidden.resize(count * color, 0.0);
        let h = Matrix::new(net.trunk.last(&chunk.tape), count, width, width);
        product(&mut chunk.hidden, color, h, Matrix::new(&self.folded_t, width, color, color), false);
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

    pub fn forward(
        &self,
        chunk: &mut Chunk,
        positions: &[f64],
        directions: &[f64],
        samples: usize,
    ) -> (Vec<f32>, Vec<f32>) {
        chunk.positions.clear();
        chunk.positions.extend(positions);
        self.densities(chunk);
        chunk.active.clear();
        chunk.active.extend(0..positions.len() / 3);
        self.colors(chunk, directions, samples);
        (chunk.sigmas.clone(), chunk.rgbs.clone())
    }

    /// Weights of all samples, colours of the active ones; colours of the rays in the result.
    pub fn render(&self, chunk: &mut Chunk, rays: &Rays, background: [f32; 3]) -> Rendered {
        self.render_active(chunk, rays, background, false)
    }

    fn render_active(&self, chunk: &mut Chunk, rays: &Rays, background: [f32; 3], dense: bool) -> Rendered {
        let samples = rays.samples;
        rays.positions(&mut chunk.positions);
        self.densities(chunk);
        chunk.deltas.clear();
        chunk.deltas.extend(rays.deltas.iter().map(|&d| d as f32));
        chunk.rays.compute(self.net.arch, &chunk.sigmas, &chunk.deltas, samples);
        let (behind, z) = (&chunk.rays.behind, &chunk.z);
        // Negated, so that a NaN counts as active and comes out at the end.
        let idle =
            |&n: &usize| slope(z[n], self.net.density) == 0.0 || (n % samples > 0 && behind[n - 1] == 0.0);
        chunk.active.clear();
        chunk.active.extend((0..z.len()).filter(|n| dense || !idle(n)));
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

    /// Adds gradient and loss of a chunk to `group`; `scale` is the weight of one channel of one ray in the loss.
    pub fn step(&self, chunk: &mut Chunk, batch: &Batch, dense: bool, scale: f64, group: &mut Group) {
        let rendered = self.render_active(chunk, &batch.rays, batch.background, dense);
        let residuals: Vec<f32> =
            rendered.colors.iter().zip(batch.targets).map(|(c, target)| c - target).collect();
        group.loss += residuals.iter().map(|&r| f64::from(r) * f64::from(r)).sum::<f64>();
        group.forward_points += chunk.z.len();
        group.backward_points += chunk.active.len();
        let g_colors: Vec<f32> = residuals.iter().map(|r| (2.0 * scale) as f32 * r).collect();
        self.render_backward(chunk, &batch.rays, &g_colors, batch.background);
        self.network_backward(chunk, batch.rays.samples, &mut group.partial);
    }

    /// From the colours of rays to what stands before sigmoid and density activation of the active samples.
    fn render_backward(&self, chunk: &mut Chunk, rays: &Rays, g_colors: &[f32], background: [f32; 3]) {
        let samples = rays.samples;
        chunk.g_sigma.clear();
        chunk.g_sigma.resize(chunk.z.len(), 0.0);
        chunk.g_z_rgb.clear();
        for (rgb, &n) in chunk.rgbs.chunks_exact(3).zip(&chunk.active) {
            let w = chunk.rays.weights[n];
            let g = &g_colors[n / samples * 3..n / samples * 3 + 3];
            chunk.g_sigma[n] = g[0] * rgb[0] + g[1] * rgb[1] + g[2] * rgb[2];
            chunk.g_z_rgb.extend(g.iter().zip(rgb).map(|(g, c)| w * g * c * (1.0 - c)));
        }
        for (ray, q) in chunk.g_sigma.chunks_exact_mut(samples).enumerate() {
            let span = ray * samples..(ray + 1) * samples;
            let g = &g_colors[ray * 3..ray * 3 + 3];
            let b = g[0] * background[0] + g[1] * background[1] + g[2] * background[2];
            let Weights { weights, behind, .. } = &chunk.rays;
            density_gradient(&weights[span.clone()], &behind[span.clone()], &chunk.deltas[span], b, q);
        }
        chunk.g_z.clear();
        chunk
            .g_z
            .extend(chunk.active.iter().map(|&n| chunk.g_sigma[n] * slope(chunk.z[n], self.net.density)));
    }

    /// From there to the parameters; the folded matrix's gradient goes behind them.
    fn network_backward(&self, chunk: &mut Chunk, samples: usize, gradient: &mut [f32]) {
        let net = self.net;
        let (width, color, columns) = (net.shape.width, net.shape.color, net.shape.direction);
        let count = chunk.active.len();
        let (gradient, g_folded) = gradient.split_at_mut(net.params.len());

        chunk.g_hidden.resize(count * color, 0.0);
        let (g_w, g_bias) = net.color1.of_mut(gradient);
        let (w, g_x) = (net.color1.of(&net.params).0, &mut *chunk.g_hidden);
        net.arch.dispatch(HeadsBackward::<3> { x: &chunk.hidden, g_z: &chunk.g_z_rgb, w, g_w, g_bias, g_x });

        let rays = chunk.ray_terms.len() / color;
        chunk.g_rays.clear();
        chunk.g_rays.resize(rays * color, 0.0);
        for (from, to, ray) in runs(&chunk.active, samples) {
            let sum = &mut chunk.g_rays[ray * color..(ray + 1) * color];
            net.arch.dispatch(AddRows { sum, rows: &chunk.g_hidden[from * color..to * color] });
        }
        let (g_w, g_b) = net.color0.of_mut(gradient);
        let g_rays = Matrix::new(&chunk.g_rays, rays, color, color);
        let directions = Matrix::new(&chunk.directions, rays, columns, columns);
        product(&mut g_w[width..], net.color0.inputs, g_rays.t(), directions, true);
        net.arch.dispatch(AddRows { sum: g_b, rows: &chunk.g_rays });

        let g_hidden = Matrix::new(&chunk.g_hidden, count, color, color);
        let h = net.trunk.last(&chunk.tape);
        product(g_folded, width, g_hidden.t(), Matrix::new(h, count, width, width), true);
        let mut g = std::mem::take(&mut chunk.tape.g);
        product(&mut g, width, g_hidden, Matrix::new(&self.folded, color, width, width), false);
        let (g_w, _) = net.sigma.of_mut(gradient);
        let mut g_last = vec![0.0; width];
        let w = net.sigma.of(&net.params).0;
        let h = net.trunk.last(&chunk.tape);
        net.arch.dispatch(JoinBackward { g: &mut g, h, g_z: &chunk.g_z, w, g_w, g_bias: &mut g_last });
        chunk.tape.g = g;
        net.sigma.of_mut(gradient).1[0] += chunk.g_z.iter().sum::<f32>();
        let g_bias = net.trunk.layers[net.shape.depth - 1].of_mut(gradient).1;
        net.arch.dispatch(AddRows { sum: g_bias, rows: &g_last });
        net.trunk.backward(net.arch, &net.params, &mut chunk.tape, count, gradient);
    }

    /// Gradients of feature and colour layer from those of M (behind the parameters) and of the colour layer's bias:
    /// g_color = g_M w_feature^T + g_b b_feature^T, g_feature = w_color^T g_M, g_b_feature = w_color^T g_b.
    pub fn unfold(&self, gradient: &mut [f32]) {
        let net = self.net;
        let (width, color, inputs) = (net.shape.width, net.shape.color, net.color0.inputs);
        let (gradient, g_folded) = gradient.split_at_mut(net.params.len());
        let g_folded = Matrix::new(g_folded, color, width, width);
        let (w_feature, b_feature) = net.feature.of(&net.params);
        let w_color = Matrix::new(net.color0.of(&net.params).0, color, width, inputs);
        let (g_w, g_b) = net.color0.of_mut(gradient);
        product(g_w, inputs, g_folded, Matrix::new(w_feature, width, width, width).t(), true);
        let g_b = g_b.to_vec();
        let g_bias = Matrix::new(&g_b, color, 1, 1);
        product(g_w, inputs, g_bias, Matrix::new(b_feature, width, 1, 1).t(), true);
        let (g_w, g_b_feature) = net.feature.of_mut(gradient);
        product(g_w, width, w_color.t(), g_folded, true);
        product(g_b_feature, 1, w_color.t(), g_bias, true);
    }
}

/// Consecutive active samples of one ray: (from, to, ray).
fn runs(active: &[usize], samples: usize) -> impl Iterator<Item = (usize, usize, usize)> {
    let mut from = 0;
    active.chunk_by(move |a, b| a / samples == b / samples).map(move |run| {
        let span = (from, from + run.len(), run[0] / samples);
        from += run.len();
        span
    })
}

/// Density from the density head's output; see [`crate::field::density`].
fn density(z: f32, activation: Density) -> f32 {
    match activation {
        Density::Relu if z < 0.0 => 0.0,
        Density::Relu => z,
        Density::Softplus => z.max(0.0) + libm::log1pf(attenuation(z.abs()).0),
        Density::Exp => libm::expf(z),
    }
}

/// d density / dz.
fn slope(z: f32, activation: Density) -> f32 {
    match activation {
        Density::Relu if z <= 0.0 => 0.0,
        Density::Relu => 1.0,
        Density::Softplus => sigmoid(z),
        Density::Exp => libm::expf(z),
    }
}

/// 1 / (1 + e^-z), without overflow on either side.
pub(super) fn sigmoid(z: f32) -> f32 {
    let e = attenuation(z.abs()).0;
    if z < 0.0 { e / (1.0 + e) } else { 1.0 / (1.0 + e) }
}
