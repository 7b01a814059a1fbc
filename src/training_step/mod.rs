//! A whole training step: rays and draws -> samples -> field -> colors -> loss, back to the gradient of every parameter, and Adam.
//!
//! Tests of single functions miss the mistakes of the loop: gradients that are never cleared, a learning rate one step early, moments
//! that are forgotten. Nothing is defined here: every line is a function of another folder.

use crate::convention::{Conventions, Delta};
use crate::encoding::{Encoding, positional_encoding};
use crate::field::{NerfMlp, backward as field_backward};
use crate::loss::{backward as loss_backward, mse};
use crate::optimizer::{Adam, Moments, adam_step, eps};
use crate::ray::Ray;
use crate::sample::{sample_along_ray, step_sizes};
use crate::volume_rendering::backward::{Cotangent, volume_render as render_backward};
use crate::volume_rendering::volume_render;

pub(crate) mod arrays;
pub(crate) mod bound;
pub(crate) mod cases;
mod chain;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

#[cfg(test)]
mod by_hand;
pub use judge::judge;

#[cfg(test)]
mod tests;

/// What is trained: a network and its encodings.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// The network.
    pub net: NerfMlp,
    /// Encoding of positions.
    pub position: Encoding,
    /// Encoding of directions.
    pub direction: Encoding,
}

/// The rays of one step.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// Rays, (R).
    pub rays: Vec<Ray>,
    /// The viewing direction of each ray, as the field is given it, (R).
    pub directions: Vec<[f64; 3]>,
    /// Numbers in [0, 1), N for each ray.
    pub u: Vec<Vec<f64>>,
    /// The photographs' colors, (R).
    pub target: Vec<[f64; 3]>,
}

/// One pass over a batch, forth and back.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Sample positions, N for each ray.
    pub t: Vec<Vec<f64>>,
    /// Step lengths, N for each ray.
    pub deltas: Vec<Vec<f64>>,
    /// Colors of the rays, (R).
    pub colors: Vec<[f64; 3]>,
    /// The mean squared error over all rays and channels.
    pub loss: f64,
    /// Its gradient.
    pub gradient: NerfMlp,
}

/// Parameters and what Adam remembers of each, in the order of [`flat`].
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Parameters, (P).
    pub params: Vec<f64>,
    /// Means of gradients, (P).
    pub m: Vec<f64>,
    /// Means of squared gradients, (P).
    pub v: Vec<f64>,
}

/// What some steps of training leave behind.
#[derive(Clone, Debug, PartialEq)]
pub struct Trained {
    /// The first step's pass.
    pub pass: Pass,
    /// The loss before each step, (S).
    pub losses: Vec<f64>,
    /// After the first step.
    pub first: State,
    /// After the last step.
    pub last: State,
}

/// All parameters in one row: layer after layer (`trunk0`, ..., `sigma`, `feature`, `color0`, `color1`), the weights of a layer output by
/// output, then its biases.
///
/// ```
/// use nerf_oracle::{convention::CS180, field::{NerfMlp, nerf_mlp::Shape}, training_step::flat};
/// use nerf_oracle::random::{Key, Purpose};
/// let shape = Shape { position: 9, direction: 9, width: 2, depth: 1, color: 2 };
/// let net = NerfMlp::initial(&shape, &CS180, &Key::new(0, Purpose::Parameters));
/// let params = flat(&net);
/// assert_eq!(params.len(), 2 * 10 + 3 + 2 * 3 + 2 * 12 + 3 * 3);
/// assert_eq!([params[9], params[18]], [net.trunk[0].w[[1, 0]], net.trunk[0].b[0]]);
/// ```
pub fn flat(net: &NerfMlp) -> Vec<f64> {
    let mut params = vec![];
    for (_, layer) in net.layers() {
        params.extend(&layer.w);
        params.extend(&layer.b);
    }
    params
}

/// The network of these sizes with these parameters.
///
/// # Panics
/// Where there are fewer than the network has, or more.
pub fn filled(net: &NerfMlp, params: &[f64]) -> NerfMlp {
    let mut net = net.clone();
    let mut left = params;
    for layer in net.layers_mut() {
        for x in layer.w.iter_mut().chain(layer.b.iter_mut()) {
            let (first, rest) = left.split_first().expect("params: as many as the network has");
            (*x, left) = (*first, rest);
        }
    }
    assert!(left.is_empty(), "params: as many as the network has");
    net
}

/// The loss of a batch and its gradient, with what comes on the way.
///
/// C = volume_render(field(o + t d)), loss = mean (C - target)^2, and the vector-Jacobian products of the same functions backwards. The
/// positions t aren't functions of the parameters.
///
/// # Panics
/// Where `batch` hasn't one direction, one row of draws and one target each ray.
pub fn pass(field: &Field, batch: &Batch, (near, far): (f64, f64), c: &Conventions) -> Pass {
    let rays = batch.rays.len();
    assert_eq!(batch.directions.len(), rays, "directions and rays: one each a ray");
    assert_eq!(batch.u.len(), rays, "u and rays: one row each a ray");
    assert_eq!(batch.target.len(), rays, "target and rays: one each a ray");
    let (mut ts, mut steps, mut colors, mut seen) = (vec![], vec![], vec![], vec![]);
    for r in 0..rays {
        let ray = &batch.rays[r];
        let t = sample_along_ray(near, far, &batch.u[r], c.grid);
        let mut deltas = step_sizes(&t, near, far, c.delta, c.last_delta);
        if c.delta == Delta::DifferencesTimesNorm {
            deltas.iter_mut().for_each(|delta| *delta *= ray.d.length());
        }
        let direction = positional_encoding(&batch.directions[r], &field.direction);
        let (mut tapes, mut sigmas, mut rgbs) = (vec![], vec![], vec![]);
        for &t in &t {
            let position = positional_encoding(&ray.at(t).to_array(), &field.position);
            let tape = field.net.forward(&position, &direction, c);
            sigmas.push(tape.sigma);
            rgbs.push(tape.rgb);
            tapes.push(tape);
        }
        let rendering = volume_render(&sigmas, &rgbs, &deltas, c.product_eps);
        colors.push(rendering.color);
        seen.push((tapes, sigmas, rgbs, rendering));
        ts.push(t);
        steps.push(deltas);
    }
    let (prediction, target) = (colors.concat(), batch.target.concat());
    let loss = mse(&prediction, &target);
    let g_colors = loss_backward::mse(&prediction, &target, 1.0);
    let mut gradient = filled(&field.net, &vec![0.0; flat(&field.net).len()]);
    for (r, (tapes, sigmas, rgbs, rendering)) in seen.iter().enumerate() {
        let color = [g_colors[3 * r], g_colors[3 * r + 1], g_colors[3 * r + 2]];
        let g = Cotangent { color, weights: vec![0.0; tapes.len()], opacity: 0.0, transmittance: 0.0 };
        let (g_sigmas, g_rgbs, _) = render_backward(sigmas, rgbs, &steps[r], c.product_eps, rendering, &g);
        for (i, tape) in tapes.iter().enumerate() {
            field_backward::nerf_mlp(&field.net, tape, c, g_sigmas[i], g_rgbs[i], &mut gradient);
        }
    }
    Pass { t: ts, deltas: steps, colors, loss, gradient }
}

/// One step of Adam for every parameter. `step` counts from 1.
///
/// # Panics
/// Where the lengths differ.
pub fn update(before: &State, gradient: &[f64], adam: &Adam, step: u64, c: &Conventions) -> State {
    let count = before.params.len();
    assert_eq!(gradient.len(), count, "gradient and params: one each a parameter");
    assert_eq!(before.m.len(), count, "m and params: one each a parameter");
    assert_eq!(before.v.len(), count, "v and params: one each a parameter");
    let adam = Adam { eps: eps(adam, step, c.adam_eps), ..*adam };
    let mut after = before.clone();
    for (i, &g) in gradient.iter().enumerate() {
        let moments = Moments { param: before.params[i], m: before.m[i], v: before.v[i] };
        let moved = adam_step(&adam, moments, g, step);
        (after.params[i], after.m[i], after.v[i]) = (moved.param, moved.m, moved.v);
    }
    after
}

/// Trains a field from moments of 0: one step for each batch, with its own learning rate (that of `adam` isn't used).
///
/// # Panics
/// Where there is no batch, or not one rate for each.
pub fn train(
    field: &Field,
    batches: &[Batch],
    bounds: (f64, f64),
    rates: &[f64],
    adam: &Adam,
    c: &Conventions,
) -> Trained {
    assert_eq!(batches.len(), rates.len(), "batches and rates: one each a step");
    let params = flat(&field.net);
    let zeros = vec![0.0; params.len()];
    let mut state = State { params, m: zeros.clone(), v: zeros };
    let (mut losses, mut first) = (vec![], None);
    for (k, batch) in batches.iter().enumerate() {
        let net = filled(&field.net, &state.params);
        let passed = pass(&Field { net, ..field.clone() }, batch, bounds, c);
        let adam = Adam { lr: rates[k], ..*adam };
        state = update(&state, &flat(&passed.gradient), &adam, k as u64 + 1, c);
        losses.push(passed.loss);
        if first.is_none() {
            first = Some((passed, state.clone()));
        }
    }
    let (pass, first) = first.expect("batches: at least one");
    Trained { pass, losses, first, last: state }
}
