//! Forward: a chunk of rays through both networks and volume rendering, and the loss.

use pulp::{Arch, Simd, WithSimd};

use super::backward::backward;
use super::chunk::{Chunk, Pass, TILE};
use super::kernels::{Multiply, Plain};
use super::networks::{GEOMETRY, HIDDEN};
use super::views::{Behind, Target};
use crate::approximate::exp;
use crate::hash_grid::fast::WIDTH;
use crate::simd::CacheAligned;

struct Densities<'a, 'b>(&'b Pass<'a>, &'b mut Chunk);

impl WithSimd for Densities<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, s: S) {
        density(s, self.0, self.1, &Plain);
    }
}

struct Whole<'a, 'b, M>(&'b Pass<'a>, &'b mut Chunk, &'b M);

impl<M: Multiply> WithSimd for Whole<'_, '_, M> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, s: S) {
        let Whole(pass, chunk, on) = self;
        density(s, pass, chunk, on);
        early_stop(pass, chunk);
        color(s, pass, chunk, on);
        composite(pass, chunk);
        if pass.gradient.is_some() {
            backward(s, pass, chunk, on);
        }
    }
}

/// The densities of a chunk's encoded samples, into `sigma`.
pub(super) fn densities(arch: Arch, pass: &Pass, chunk: &mut Chunk) {
    arch.dispatch(Densities(pass, chunk));
}

/// Renders a chunk's rays, with gradients if the pass needs them; `on` multiplies.
pub(super) fn run(arch: Arch, pass: &Pass, chunk: &mut Chunk, on: &impl Multiply) {
    arch.dispatch(Whole(pass, chunk, on));
}

/// e^clamp(x, -15, 15), as [`EXPONENT`](super::settings::EXPONENT) says.
#[inline(always)]
pub(super) fn trunc_exp(x: f32) -> f32 {
    exp(x.clamp(-15.0, 15.0))
}

#[inline(always)]
fn density<S: Simd>(s: S, pass: &Pass, c: &mut Chunk, on: &impl Multiply) {
    let w = pass.weights;
    let rows = c.rows();
    let mut encoding = CacheAligned([[0f32; WIDTH]; TILE]);
    for first in (0..rows).step_by(TILE) {
        let tile = first..(first + TILE).min(rows);
        let encoding = &mut encoding.0[..tile.len()];
        c.gather(first, encoding);
        on.product(s, encoding, WIDTH, &w.density0, &mut c.hidden0[tile.clone()], false, true);
        on.product(s, &c.hidden0[tile.clone()], HIDDEN, &w.density1, &mut c.geometry[tile], false, false);
    }
    // Written as a loop: what a closure does in an iterator's library code isn't compiled for this machine's vectors.
    c.sigma.resize(c.points.len(), 0.0);
    for (sigma, geometry) in c.sigma.iter_mut().zip(c.geometry.iter()) {
        *sigma = trunc_exp(geometry[0]);
    }
}

/// Leaves out what lies behind the sample that takes a ray's transmittance below `stop`.
#[inline(always)]
fn early_stop(pass: &Pass, c: &mut Chunk) {
    c.keep(|ray, sigmas, deltas| {
        let limit = -(pass.stop / ray.transmittance).ln();
        let (mut depth, mut live) = (0.0, 0);
        while live < sigmas.len() && depth < limit {
            depth += sigmas[live] * deltas[live];
            live += 1;
        }
        live
    });
}

#[inline(always)]
fn color<S: Simd>(s: S, pass: &Pass, c: &mut Chunk, on: &impl Multiply) {
    let w = pass.weights;
    for ray in c.rays.iter_mut().filter(|ray| ray.count > 0 && pass.view_dependent) {
        for (&h, row) in ray.harmonics.iter().zip(w.view.iter()) {
            ray.view.iter_mut().zip(row).for_each(|(v, r)| *v += h * r);
        }
    }
    let (rows, n) = (c.rows(), c.points.len());
    for first in (0..rows).step_by(TILE) {
        let tile = first..(first + TILE).min(rows);
        for p in first..tile.end.min(n) {
            c.hidden1[p] = c.rays[c.ray_of[p] as usize].view;
        }
        on.product(
            s,
            &c.geometry[tile.clone()],
            GEOMETRY,
            &w.color0,
            &mut c.hidden1[tile.clone()],
            true,
            true,
        );
        on.product(s, &c.hidden1[tile.clone()], HIDDEN, &w.color1, &mut c.rgb[tile], false, false);
    }
    // Four samples fill a vector; rows after the last are padding.
    for four in c.rgb[..rows].as_chunks_mut::<4>().0 {
        let mut x: [f32; 16] = std::array::from_fn(|i| four[i / 4][i % 4]);
        x.iter_mut().for_each(|x| *x = 1.0 / (1.0 + exp((-*x).clamp(-40.0, 40.0))));
        (0..16).for_each(|i| four[i / 4][i % 4] = x[i]);
    }
}

/// Colors and errors; if the pass needs gradients, those of the raw colors in columns 0 to 2 of `rgb`, and of the raw density in
/// column 3.
#[inline(always)]
fn composite(pass: &Pass, c: &mut Chunk) {
    (c.error, c.counted) = (0.0, 0);
    c.again.clear();
    for ray in &mut c.rays {
        let (mut transmittance, mut color, mut depth) = (ray.transmittance, ray.color, ray.depth);
        for p in ray.first..ray.first + ray.count {
            let sigma = trunc_exp(c.geometry[p][0]);
            let next = transmittance * exp((-sigma * c.delta[p]).max(-40.0));
            let weight = transmittance - next;
            for k in 0..3 {
                color[k] += weight * c.rgb[p][k];
            }
            depth += weight * c.t[p];
            // For the backward pass: the weight, the transmittance behind the sample, the density.
            [c.rgb[p][3], c.rgb[p][4], c.rgb[p][5], c.rgb[p][6]] = [weight, next, sigma, 0.0];
            transmittance = next;
        }
        (ray.transmittance, ray.depth) = (transmittance, depth);
        // A ray that was ended too early has no color to compare.
        let counts = !(ray.cut && transmittance > pass.stop);
        if counts {
            c.counted += ray.count;
        } else {
            c.again.push(ray.pixel);
        }
        let Target { color: target, behind } = ray.target;
        let (mut g_color, mut g_light) = ([0f32; 3], 0.0);
        for k in 0..3 {
            let background = if let Behind::Color(background) = behind { background[k] } else { 0.0 };
            ray.color[k] = color[k] + transmittance * background;
            let error = ray.color[k] - target[k];
            let (squared, slopes) = match behind {
                Behind::Anything { clear } => over_all_backgrounds(error, transmittance - clear),
                Behind::Color(_) => (error * error, [error, error * background]),
            };
            let factor = if counts { pass.gradient.unwrap_or(0.0) } else { 0.0 };
            c.error += if counts { f64::from(squared) } else { 0.0 };
            g_color[k] = factor * slopes[0];
            g_light += factor * slopes[1];
        }
        if pass.gradient.is_some() {
            // What the distortion loss adds to each weight's worth, in column 6 of its sample.
            if let Some(scatter) = pass.scatter.filter(|_| counts) {
                scatter.charge(&c.t, &mut c.rgb, ray.first..ray.first + ray.count);
            }
            let range = ray.first..ray.first + ray.count;
            let (samples, deltas) = (&mut c.rgb[range.clone()], &c.delta[range]);
            composite_backward(samples, deltas, transmittance * g_light, g_color);
        }
    }
}

/// A channel that is off by `error` over black, and lets through `light` too much: the mean of (error + b light)^2 over backgrounds b even in
/// [0, 1], which is error^2 + error light + light^2 / 3, and half its derivatives by error and by light. Random backgrounds would have the
/// same mean, and noise.
#[inline(always)]
fn over_all_backgrounds(error: f32, light: f32) -> (f32, [f32; 2]) {
    let squared = error * error + error * light + light * light / 3.0;
    (squared, [error + 0.5 * light, 0.5 * error + light / 3.0])
}

/// Gradients below this are 0: Adam's eps is 10^5 times as large. Behind an opaque sample they are subnormal,
/// which makes products many times slower.
const LEAST: f32 = 1e-20;

#[inline(always)]
fn flush(gradient: f32) -> f32 {
    if gradient.abs() < LEAST { 0.0 } else { gradient }
}

/// From the last sample to the first, as in the oracle: `behind` is what the light behind the sample is worth, at first the background's.
#[inline(always)]
fn composite_backward(samples: &mut [[f32; 16]], deltas: &[f32], mut behind: f32, g: [f32; 3]) {
    let dot = |c: [f32; 3]| g[0] * c[0] + g[1] * c[1] + g[2] * c[2];
    for (sample, delta) in samples.iter_mut().zip(deltas).rev() {
        let [r, green, b, weight, next, sigma, charge, ..] = *sample;
        let seen = dot([r, green, b]) + charge;
        let slope = delta * (next * seen - behind);
        behind += weight * seen;
        *sample = [0.0; 16];
        for (k, c) in [r, green, b].into_iter().enumerate() {
            sample[k] = flush(weight * g[k] * c * (1.0 - c));
        }
        // d sigma / d raw = sigma.
        sample[3] = flush(slope * sigma);
    }
}
