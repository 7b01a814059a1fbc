//! The backward pass of a training step's chunk: loss, rendering and network.

use super::activation::density_backward;
use super::chunk::{ChunkBuffers, Prepared, runs};
use super::gradient::Group;
use super::network::Batch;
use super::passes::{AddRows, HeadsBackward, JoinBackward};
use super::product::{Matrix, Multiply, product};
use super::rays::Rays;
use super::skipping::Skipping;
use crate::volume_rendering::fast::{RayWeights, density_gradient};

impl<M: Multiply> Prepared<'_, M> {
    /// Adds gradient and loss of a chunk to `group`; `scale` is the weight of one channel of one ray in the loss.
    pub(super) fn step(
        &self,
        chunk: &mut ChunkBuffers,
        batch: &Batch,
        skipping: Skipping,
        dense: bool,
        scale: f64,
        group: &mut Group,
    ) {
        let rendered = self.render_active(chunk, &batch.rays, skipping, batch.background, dense);
        let residuals: Vec<f32> =
            rendered.colors.iter().zip(batch.targets).map(|(c, target)| c - target).collect();
        group.loss += residuals.iter().map(|&r| f64::from(r) * f64::from(r)).sum::<f64>();
        group.forward_points += chunk.live.len();
        group.backward_points += chunk.active.len();
        let g_colors: Vec<f32> = residuals.iter().map(|r| (2.0 * scale) as f32 * r).collect();
        self.render_backward(chunk, &batch.rays, &g_colors, batch.background);
        self.network_backward(chunk, batch.rays.samples, &mut group.partial);
    }

    /// From the colors of the rays back to the inputs of sigmoid and density activation, for the active samples.
    fn render_backward(&self, chunk: &mut ChunkBuffers, rays: &Rays, g_colors: &[f32], background: [f32; 3]) {
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
            let RayWeights { weights, behind, .. } = &chunk.rays;
            density_gradient(&weights[span.clone()], &behind[span.clone()], &chunk.deltas[span], b, q);
        }
        chunk.g_z.clear();
        let density = self.net.density;
        chunk
            .g_z
            .extend(chunk.active.iter().map(|&n| density_backward(chunk.g_sigma[n], chunk.z[n], density)));
    }

    /// From there back to the parameters; the folded matrix's gradient goes after them.
    fn network_backward(&self, chunk: &mut ChunkBuffers, samples: usize, gradient: &mut [f32]) {
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
        self.on.product(&mut g_w[width..], net.color0.inputs, g_rays.t(), directions, true);
        net.arch.dispatch(AddRows { sum: g_b, rows: &chunk.g_rays });

        let g_hidden = Matrix::new(&chunk.g_hidden, count, color, color);
        let h = net.trunk.last(&chunk.tape);
        self.on.product(g_folded, width, g_hidden.t(), Matrix::new(h, count, width, width), true);
        let mut g = std::mem::take(&mut chunk.tape.g);
        let folded = Matrix::new(&self.folded, color, width, width);
        self.on.product(&mut g, width, g_hidden, folded, false);
        let (g_w, _) = net.sigma.of_mut(gradient);
        let mut g_last = vec![0.0; width];
        let w = net.sigma.of(&net.params).0;
        let h = net.trunk.last(&chunk.tape);
        net.arch.dispatch(JoinBackward { g: &mut g, h, g_z: &chunk.g_z, w, g_w, g_bias: &mut g_last });
        chunk.tape.g = g;
        net.sigma.of_mut(gradient).1[0] += chunk.g_z.iter().sum::<f32>();
        let g_bias = net.trunk.layers[net.shape.depth - 1].of_mut(gradient).1;
        net.arch.dispatch(AddRows { sum: g_bias, rows: &g_last });
        net.trunk.backward(net.arch, &net.params, &mut chunk.tape, count, gradient, self.on);
    }

    /// Gradients of feature and color layer from those of M (after the parameters) and of the color layer's bias:
    /// g_color = g_M w_feature^T + g_b b_feature^T, g_feature = w_color^T g_M, g_b_feature = w_color^T g_b.
    pub(super) fn unfold(&self, gradient: &mut [f32]) {
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
