//! One training step of the whole pipeline in plain f64: rays -> samples -> encoding -> field -> volume rendering -> loss, and
//! the gradient of every parameter. The fast path is checked against this file.

use crate::convention::{Conventions, Delta, LastDelta};
use crate::encoding::{Encoding, positional_encoding};
use crate::field::{Layer, Mlp, NerfMlp, backward as field_backward, mlp, nerf_mlp};
use crate::importance_sampling;
use crate::ndc::cube::Cube;
use crate::optimizer::{Adam, Moments, adam_step};
use crate::ray::Ray;
use crate::sample::step_sizes;
use crate::volume_rendering::backward::Cotangent;
use crate::volume_rendering::{self, Rendering, composite_background};

#[cfg(test)]
mod tests;

/// The NeRF paper's field: encodings and network, in the world's coordinates or, where there is a cube, in those of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// The network.
    pub net: NerfMlp,
    /// Encoding of positions.
    pub position: Encoding,
    /// Encoding of directions.
    pub direction: Encoding,
    /// The normalized device coordinates that positions are in.
    pub cube: Option<Cube>,
    /// All other conventions.
    pub conventions: Conventions,
}

/// One ray of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// The ray.
    pub ray: Ray,
    /// Sample positions, (N).
    pub t: Vec<f64>,
    /// Step lengths, (N).
    pub deltas: Vec<f64>,
    /// The photograph's color.
    pub rgb: [f64; 3],
}

impl Field {
    /// Density and color at r(t).
    pub fn at(&self, ray: &Ray, t: f64) -> nerf_mlp::Tape {
        let x = ray.at(t).to_array();
        let position = match &self.cube {
            Some(cube) => cube.point(x),
            None => x,
        };
        // The direction of view, unit length whatever the length of the ray's direction.
        self.seen(position, (ray.d / ray.d.length()).to_array())
    }

    /// Density and color at a position in the field's own coordinates, seen along a unit direction of the world's.
    pub fn seen(&self, position: [f64; 3], view: [f64; 3]) -> nerf_mlp::Tape {
        let position = positional_encoding(&position, &self.position);
        self.net.forward(&position, &positional_encoding(&view, &self.direction), &self.conventions)
    }

    /// One ray, and what the backward pass needs.
    ///
    /// # Panics
    /// Where the lengths differ.
    pub fn render(&self, ray: &Ray, t: &[f64], deltas: &[f64]) -> (Rendering, Vec<nerf_mlp::Tape>) {
        assert_eq!(t.len(), deltas.len(), "t and deltas: one each a sample");
        let tapes: Vec<_> = t.iter().map(|&t| self.at(ray, t)).collect();
        let sigmas: Vec<f64> = tapes.iter().map(|tape| tape.sigma).collect();
        let rgbs: Vec<[f64; 3]> = tapes.iter().map(|tape| tape.rgb).collect();
        (volume_rendering::volume_render(&sigmas, &rgbs, deltas, self.conventions.product_eps), tapes)
    }

    /// The loss of a batch and its gradient with respect to every parameter.
    ///
    /// loss = mean over rays and channels of (C + (1 - A) b - target)^2.
    ///
    /// # Panics
    /// Where a target's positions and step lengths differ in number.
    pub fn loss_and_gradient(&self, batch: &[Target], background: [f64; 3]) -> (f64, NerfMlp) {
        let mut gradient = self.net.clone();
        gradient.layers_mut().into_iter().for_each(clear);
        let (mut loss, scale) = (0.0, 1.0 / (3 * batch.len()) as f64);
        for target in batch {
            let (rendering, tapes) = self.render(&target.ray, &target.t, &target.deltas);
            let color = composite_background(rendering.color, rendering.opacity, background);
            let mut g_color = [0.0; 3];
            for k in 0..3 {
                let difference = color[k] - target.rgb[k];
                loss += scale * difference * difference;
                g_color[k] = 2.0 * scale * difference;
            }
            self.backward(target, &rendering, &tapes, g_color, background, &mut gradient);
        }
        (loss, gradient)
    }

    /// Adds one ray's gradient.
    fn backward(
        &self,
        target: &Target,
        rendering: &Rendering,
        tapes: &[nerf_mlp::Tape],
        g_color: [f64; 3],
        background: [f64; 3],
        gradient: &mut NerfMlp,
    ) {
        let (color, opacity, _) =
            volume_rendering::backward::composite_background(rendering.opacity, background, g_color);
        let weights = vec![0.0; tapes.len()];
        let cotangent = Cotangent { color, weights, opacity, transmittance: 0.0 };
        let sigmas: Vec<f64> = tapes.iter().map(|tape| tape.sigma).collect();
        let rgbs: Vec<[f64; 3]> = tapes.iter().map(|tape| tape.rgb).collect();
        let eps = self.conventions.product_eps;
        let (g_sigmas, g_rgbs, _) = volume_rendering::backward::volume_render(
            &sigmas,
            &rgbs,
            &target.deltas,
            eps,
            rendering,
            &cotangent,
        );
        for (i, tape) in tapes.iter().enumerate() {
            field_backward::nerf_mlp(&self.net, tape, &self.conventions, g_sigmas[i], g_rgbs[i], gradient);
        }
    }
}

/// The edges of the N equal intervals on [near, far] to which the weights of N stratified samples belong.
pub fn interval_edges(near: f64, far: f64, n: usize) -> Vec<f64> {
    let mut edges = vec![];
    for i in 0..n {
        edges.push(near + i as f64 * ((far - near) / n as f64));
    }
    edges.push(far);
    edges
}

/// Where the fine network of a hierarchical pair is evaluated, and its step lengths: NeRF (Mildenhall et al. 2020) section 5.2.
///
/// The union of the coarse samples `t` with one sample for each `u` from the piecewise-constant distribution of the coarse `weights`
/// over the intervals between `edges`. The step of a sample is the distance to the next one, that of the last to `far` (equation 3). The
/// weights are constants here: the coarse network learns from its own colors alone, and loss = coarse + fine needs no gradient from
/// one network to the other.
///
/// # Panics
/// Where there is no bin, `t` and `weights` differ in length, or `edges` aren't one more.
pub fn fine_samples(t: &[f64], edges: &[f64], weights: &[f64], u: &[f64], far: f64) -> (Vec<f64>, Vec<f64>) {
    assert_eq!(t.len(), weights.len(), "t and weights: one each a coarse sample");
    let drawn = importance_sampling::sample(edges, weights, 0.0, u);
    let all = importance_sampling::union(t, &drawn);
    let deltas = step_sizes(&all, edges[0], far, Delta::Differences, LastDelta::ToFar);
    (all, deltas)
}

/// The loss of a batch of pixels in 2D and its gradient: mean over pixels and channels of (mlp(encoding(xy)) - target)^2.
///
/// # Panics
/// Where the lengths differ.
pub fn image_loss_and_gradient(
    net: &Mlp,
    encoding: &Encoding,
    pixels: &[[f64; 2]],
    targets: &[[f64; 3]],
) -> (f64, Vec<Layer>) {
    assert_eq!(pixels.len(), targets.len(), "pixels and targets: one each a pixel");
    let mut gradient = net.layers.clone();
    gradient.iter_mut().for_each(clear);
    let (mut loss, scale) = (0.0, 1.0 / (3 * pixels.len()) as f64);
    for (xy, target) in pixels.iter().zip(targets) {
        let tape: mlp::Tape = net.forward(&positional_encoding(xy, encoding));
        let mut g_y = [0.0; 3];
        for k in 0..3 {
            let difference = tape.y[k] - target[k];
            loss += scale * difference * difference;
            g_y[k] = 2.0 * scale * difference;
        }
        field_backward::mlp(net, &tape, &g_y, &mut gradient);
    }
    (loss, gradient)
}

/// One Adam step for every parameter of a layer: weights row by row, then biases. `step` counts from 1.
///
/// # Panics
/// Where the layers differ in shape.
pub fn adam_layer(adam: &Adam, step: u64, params: &mut Layer, m: &mut Layer, v: &mut Layer, g: &Layer) {
    let shape = |layer: &Layer| (layer.w.dim(), layer.b.len());
    assert_eq!(shape(m), shape(params), "m and params: the same shape");
    assert_eq!(shape(v), shape(params), "v and params: the same shape");
    assert_eq!(shape(g), shape(params), "g and params: the same shape");
    let means = m.w.iter_mut().chain(&mut m.b).zip(v.w.iter_mut().chain(&mut v.b));
    let entries = params.w.iter_mut().chain(&mut params.b).zip(means);
    for ((param, (m, v)), g) in entries.zip(g.w.iter().chain(&g.b)) {
        let after = adam_step(adam, Moments { param: *param, m: *m, v: *v }, *g, step);
        (*param, *m, *v) = (after.param, after.m, after.v);
    }
}

fn clear(layer: &mut Layer) {
    layer.w.fill(0.0);
    layer.b.fill(0.0);
}
