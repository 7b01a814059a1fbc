//! The matrix products of a compact training step alone, for `bench`'s share of the ceiling: the kernels of `forward` and `backward`, in
//! their order, tile by tile, chunk by chunk, on the chunks of a step.
//!
//! In them: the four matrices that every sample passes, forward (with the ReLU that the kernel applies) and backward, and the ray's part
//! of the color network's hidden layer copied to its samples, because a product adds to it; encodings are moved between levels and
//! tiles, as in training. Not in them: that part itself (once a ray), ReLU's masks, activations, rendering, the early stop, encodings.

use pulp::{Arch, Simd, WithSimd};

use super::backward::turn_colors;
use super::chunk::{Chunk, Ray};
use super::forward::{TILE, run};
use super::kernels::{outer, product};
use super::networks::{GEOMETRY, HIDDEN, Networks};
use super::step::CHUNK;
use super::{CompactModel, Overrides};
use crate::bench::dense::{Dense, Layers, WorkCount, bound, worse};
use crate::bench::rounds::seconds;
use crate::hash_grid::fast::{Entry, LEVELS, WIDTH};
use crate::scene;
use crate::simd::{Aligned, CacheAligned, repeated};
use crate::spherical_harmonics::fast as harmonics;
use crate::training::Model;

/// The step whose batch it is, the first with full step lengths and all levels; steps before it that are trained.
const STEP: u64 = 401;
const TRAINED: u64 = 40;

/// The dense layers of a step.
pub const DENSE: Dense = Dense {
    name: "compact",
    about: "32-64-16 and 16-64-3 (the harmonics once a ray), a training batch of the built-in blob in chunks of about 1,024 samples, \
            trained for 40 steps",
    prepare: |_| Box::new(Step::new()),
};

/// Who multiplies: for time, or to be checked.
trait Multiply {
    fn product<S: Simd, const K: usize, const N: usize>(
        &mut self,
        s: S,
        x: &[[f32; K]],
        inner: usize,
        w: &[[f32; N]],
        y: &mut [[f32; N]],
        accumulate: bool,
        relu: bool,
    );
    fn outer<S: Simd, const K: usize, const N: usize>(
        &mut self,
        s: S,
        x: &[[f32; K]],
        inner: usize,
        dy: &[[f32; N]],
        dw: &mut [[f32; N]],
    );
}

struct Timed;

impl Multiply for Timed {
    #[inline(always)]
    fn product<S: Simd, const K: usize, const N: usize>(
        &mut self,
        s: S,
        x: &[[f32; K]],
        inner: usize,
        w: &[[f32; N]],
        y: &mut [[f32; N]],
        accumulate: bool,
        relu: bool,
    ) {
        product(s, x, inner, w, y, accumulate, relu);
    }

    #[inline(always)]
    fn outer<S: Simd, const K: usize, const N: usize>(
        &mut self,
        s: S,
        x: &[[f32; K]],
        inner: usize,
        dy: &[[f32; N]],
        dw: &mut [[f32; N]],
    ) {
        outer(s, x, inner, dy, dw);
    }
}

/// Compares every entry of every product with f64; counts the flops of all columns, padded ones too.
#[derive(Default)]
struct Checked {
    worst: f64,
    flops: f64,
    /// Something to add to the first entry of every product: for the test that this is found.
    wrong: f32,
}

impl Checked {
    /// One entry: the terms of its sum, what was there before, and what came out.
    fn entry(&mut self, terms: impl ExactSizeIterator<Item = (f32, f32)>, before: f32, relu: bool, got: f32) {
        let count = terms.len();
        let (mut sum, mut absolute) = (f64::from(before), f64::from(before.abs()));
        for (a, b) in terms {
            let term = f64::from(a) * f64::from(b);
            sum += term;
            absolute += term.abs();
        }
        let expected = if relu { sum.max(0.0) } else { sum };
        self.worst = worse(self.worst, (f64::from(got) - expected).abs() / bound(count, absolute));
    }
}

impl Multiply for Checked {
    #[inline(always)]
    fn product<S: Simd, const K: usize, const N: usize>(
        &mut self,
        s: S,
        x: &[[f32; K]],
        inner: usize,
        w: &[[f32; N]],
        y: &mut [[f32; N]],
        accumulate: bool,
        relu: bool,
    ) {
        let before = y.to_vec();
        product(s, x, inner, w, y, accumulate, relu);
        y[0][0] += self.wrong;
        self.flops += 2.0 * (x.len() * inner * N) as f64;
        for (p, row) in y.iter().enumerate() {
            for (o, &got) in row.iter().enumerate() {
                let old = if accumulate { before[p][o] } else { 0.0 };
                self.entry((0..inner).map(|i| (x[p][i], w[i][o])), old, relu, got);
            }
        }
    }

    #[inline(always)]
    fn outer<S: Simd, const K: usize, const N: usize>(
        &mut self,
        s: S,
        x: &[[f32; K]],
        inner: usize,
        dy: &[[f32; N]],
        dw: &mut [[f32; N]],
    ) {
        let before = dw.to_vec();
        outer(s, x, inner, dy, dw);
        dw[0][0] += self.wrong;
        self.flops += 2.0 * (x.len() * inner * N) as f64;
        for (i, row) in dw.iter().enumerate().take(inner) {
            for (o, &got) in row.iter().enumerate() {
                self.entry((0..x.len()).map(|p| (x[p][i], dy[p][o])), before[i][o], false, got);
            }
        }
    }
}

/// What a pass starts from.
struct Marched {
    rays: Vec<Ray>,
    points: Vec<[f32; 3]>,
    t: Vec<f32>,
    ray_of: Vec<u32>,
    encoding: [Aligned<Entry>; LEVELS],
}

/// A chunk, and what passes and products overwrite of it.
struct Filled {
    /// Behind a pass: `rgb` holds the gradients of the raw colors.
    chunk: Chunk,
    marched: Marched,
    /// Encodings of the live samples, and their rays' part of the hidden layer.
    encoding: [Aligned<Entry>; LEVELS],
    views: Vec<[f32; HIDDEN]>,
    /// Raw colors of the products: where `rgb` would be, which holds gradients.
    raw: Aligned<[f32; 16]>,
}

impl Filled {
    fn before_pass(&mut self) {
        let (chunk, marched) = (&mut self.chunk, &self.marched);
        chunk.rays.clone_from(&marched.rays);
        chunk.points.clone_from(&marched.points);
        chunk.t.clone_from(&marched.t);
        chunk.ray_of.clone_from(&marched.ray_of);
        chunk.encoding.clone_from(&marched.encoding);
    }

    fn before_products(&mut self) {
        self.chunk.encoding.clone_from(&self.encoding);
    }
}

struct Products<'a, M> {
    nets: &'a Networks,
    filled: &'a mut Filled,
    on: &'a mut M,
}

impl<M: Multiply> WithSimd for Products<'_, M> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, s: S) {
        let Products { nets, filled: Filled { chunk: c, views, raw, .. }, on } = self;
        let (w, rows, n) = (&nets.weights, c.rows(), c.points.len());
        let tiles = || (0..rows).step_by(TILE).map(|first| first..(first + TILE).min(rows));
        let mut encoding = CacheAligned([[0f32; WIDTH]; TILE]);
        for tile in tiles() {
            let encoding = &mut encoding.0[..tile.len()];
            c.gather(tile.start, encoding);
            let hidden = &mut c.hidden0[tile.clone()];
            on.product(s, encoding, WIDTH, &w.density0, hidden, false, true);
            on.product(s, hidden, HIDDEN, &w.density1, &mut c.geometry[tile], false, false);
        }
        for tile in tiles() {
            for p in tile.start..tile.end.min(n) {
                c.hidden1[p] = views[c.ray_of[p] as usize];
            }
            let hidden = &mut c.hidden1[tile.clone()];
            on.product(s, &c.geometry[tile.clone()], GEOMETRY, &w.color0, hidden, true, true);
            on.product(s, hidden, HIDDEN, &w.color1, &mut raw[tile], false, false);
        }
        c.gradient.clear();
        let mut color1_t = CacheAligned([[0f32; HIDDEN]; 16]);
        let (mut hidden, mut geometry) =
            (CacheAligned([[0f32; HIDDEN]; TILE]), CacheAligned([[0f32; GEOMETRY]; TILE]));
        for tile in tiles() {
            let (hidden, geometry) = (&mut hidden.0[..tile.len()], &mut geometry.0[..tile.len()]);
            let encoding = &mut encoding.0[..tile.len()];
            let rgb = &c.rgb[tile.clone()];
            on.product(s, rgb, 3, &nets.color1_t, hidden, false, false);
            on.product(s, hidden, HIDDEN, &nets.color0_t, geometry, false, false);
            on.outer(s, rgb, 3, &c.hidden1[tile.clone()], &mut color1_t.0);
            on.outer(s, &c.geometry[tile.clone()], GEOMETRY, hidden, &mut c.gradient.color0);
            on.product(s, geometry, GEOMETRY, &nets.density1_t, hidden, false, false);
            on.outer(s, &c.hidden0[tile.clone()], HIDDEN, geometry, &mut c.gradient.density1);
            c.gather(tile.start, encoding);
            on.outer(s, encoding, WIDTH, hidden, &mut c.gradient.density0);
            on.product(s, hidden, HIDDEN, &nets.density0_t, encoding, false, false);
            c.spread(tile.start, encoding);
        }
        turn_colors(&color1_t.0, &mut c.gradient.color1);
    }
}

/// Weights that a sample meets: in the density network, in the color network.
const WEIGHTS: [usize; 2] = [WIDTH * HIDDEN + HIDDEN * GEOMETRY, GEOMETRY * HIDDEN + HIDDEN * 3];

/// Useful flops of the products of a live sample: forward, weights, inputs.
const SAMPLE: f64 = 2.0 * 3.0 * (WEIGHTS[0] + WEIGHTS[1]) as f64;

/// A model, and a batch that has been marched and encoded.
struct Step {
    model: CompactModel,
    filled: Vec<Filled>,
    /// d loss / d color over the error.
    gradient: f32,
    arch: Arch,
}

impl Step {
    fn new() -> Self {
        let scene = scene::load("builtin:blob", &scene::Options::default()).expect("a built-in scene");
        let mut model = CompactModel::new(&scene, &Overrides::default()).expect("it has no lens");
        for step in STEP - TRAINED..STEP {
            model.step(&scene, step).expect("a step of a built-in scene");
        }
        let mut chunks = vec![];
        let count = model.settings.batch_at(STEP) / CHUNK;
        chunks.resize_with(count, Chunk::default);
        let rays = model.rays.div_ceil(count);
        model.march(&mut chunks, rays, model.settings.samples_at(STEP), STEP);
        model.encode(&mut chunks, STEP);
        let filled = chunks.into_iter().map(|chunk| {
            let Chunk { rays, points, t, ray_of, encoding, .. } = &chunk;
            let (rays, points, t, ray_of) = (rays.clone(), points.clone(), t.clone(), ray_of.clone());
            let marched = Marched { rays, points, t, ray_of, encoding: encoding.clone() };
            let encoding = marched.encoding.clone();
            Filled { chunk, marched, encoding, views: vec![], raw: repeated([0.0; 16], 0) }
        });
        let filled = filled.collect();
        let gradient = 2.0 / (3 * rays * count) as f32;
        let arch = model.arch;
        let mut step = Step { model, filled, gradient, arch };
        // Forward alone leaves encodings and views as the products want them.
        step.run(None);
        for Filled { chunk, encoding, views, raw, .. } in &mut step.filled {
            let rows = chunk.rows();
            encoding.clone_from(&chunk.encoding);
            views.extend(chunk.rays.iter().map(|ray| ray.view));
            raw.resize(rows, [0.0; 16]);
        }
        step.run(Some(gradient));
        step
    }

    /// A pass over all chunks; its seconds.
    fn run(&mut self, gradient: Option<f32>) -> f64 {
        let pass = self.model.pass(self.model.settings.samples_at(STEP), gradient);
        self.filled.iter_mut().for_each(Filled::before_pass);
        let (arch, filled) = (self.arch, &mut self.filled);
        seconds(|| crate::parallel::for_each(filled, |filled| run(arch, &pass, &mut filled.chunk)))
    }

    /// The first chunk's products, checked.
    fn checked(&mut self, mut checked: Checked) -> Checked {
        let filled = &mut self.filled[0];
        filled.before_products();
        self.arch.dispatch(Products { nets: &self.model.nets, filled, on: &mut checked });
        checked
    }
}

impl Layers for Step {
    fn check(&mut self) -> f64 {
        self.checked(Checked::default()).worst
    }

    fn work(&self) -> WorkCount {
        let sum = |of: fn(&Chunk) -> usize| {
            self.filled.iter().map(|filled| of(&filled.chunk)).sum::<usize>() as f64
        };
        let (seen, live) = (sum(|c| c.visited.len()), sum(|c| c.points.len()));
        let products = live * SAMPLE;
        // Samples after the early stop have a density, and no more.
        let stopped = 2.0 * (seen - live) * WEIGHTS[0] as f64;
        let rays = sum(|c| c.rays.iter().filter(|ray| ray.count > 0).count());
        let per_ray =
            if self.model.settings.view_dependent { 4.0 * (harmonics::WIDTH * HIDDEN) as f64 } else { 0.0 };
        WorkCount { points: live as usize, products, pass: products + stopped + rays * per_ray }
    }

    fn products(&mut self) -> f64 {
        self.filled.iter_mut().for_each(Filled::before_products);
        let (arch, nets, filled) = (self.arch, &self.model.nets, &mut self.filled);
        seconds(|| {
            crate::parallel::for_each(filled, |filled| {
                arch.dispatch(Products { nets, filled, on: &mut Timed });
            });
        })
    }

    fn pass(&mut self) -> f64 {
        self.run(Some(self.gradient))
    }
}

#[cfg(test)]
mod tests;
