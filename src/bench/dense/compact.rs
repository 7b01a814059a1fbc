//! A training step of the compact model, for its share of the ceiling.
//!
//! In the products: the four matrices that samples pass, forward (with the ReLU that the kernel applies) and backward; the samples
//! behind the early stop too, which pass the density network alone. Not in them: the ray's part of the color network's hidden layer
//! (once a ray), ReLU's masks, activations, rendering, the early stop, encodings.

use pulp::Simd;

use super::{Clock, Dense, Found, Layers, WorkCount, used};
use crate::bench::rounds::seconds;
use crate::hash_grid::fast::WIDTH;
use crate::scene;
use crate::spherical_harmonics::fast as harmonics;
use crate::training::Model;
use crate::training::compact::chunk::Chunk;
use crate::training::compact::kernels::{Multiply, Plain, outer, product};
use crate::training::compact::networks::{GEOMETRY, HIDDEN};
use crate::training::compact::{CompactModel, Overrides};

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

impl Multiply for Clock {
    #[inline(always)]
    fn product<S: Simd, const K: usize, const N: usize>(
        &self,
        s: S,
        x: &[[f32; K]],
        inner: usize,
        w: &[[f32; N]],
        y: &mut [[f32; N]],
        accumulate: bool,
        relu: bool,
    ) {
        let start = Clock::now();
        product(s, x, inner, w, y, accumulate, relu);
        self.add(start);
    }

    #[inline(always)]
    fn outer<S: Simd, const K: usize, const N: usize>(
        &self,
        s: S,
        x: &[[f32; K]],
        inner: usize,
        dy: &[[f32; N]],
        dw: &mut [[f32; N]],
    ) {
        let start = Clock::now();
        outer(s, x, inner, dy, dw);
        self.add(start);
    }
}

/// Compares every entry of every product with f64.
#[derive(Default)]
struct Checked {
    found: Found,
    /// Something to add to the first entry of every product: for the test that this is found.
    wrong: f32,
}

impl Multiply for Checked {
    #[inline(always)]
    fn product<S: Simd, const K: usize, const N: usize>(
        &self,
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
        let entries = (0..y.len()).flat_map(|p| (0..N).map(move |o| (p, o))).map(|(p, o)| {
            let old = if accumulate { before[p][o] } else { 0.0 };
            used((0..inner).map(|i| (x[p][i], w[i][o])), old, relu, y[p][o])
        });
        self.found.add(2.0 * (x.len() * inner * N) as f64, entries);
    }

    #[inline(always)]
    fn outer<S: Simd, const K: usize, const N: usize>(
        &self,
        s: S,
        x: &[[f32; K]],
        inner: usize,
        dy: &[[f32; N]],
        dw: &mut [[f32; N]],
    ) {
        let before = dw.to_vec();
        outer(s, x, inner, dy, dw);
        dw[0][0] += self.wrong;
        let entries = (0..inner)
            .flat_map(|i| (0..N).map(move |o| (i, o)))
            .map(|(i, o)| used((0..x.len()).map(|p| (x[p][i], dy[p][o])), before[i][o], false, dw[i][o]));
        self.found.add(2.0 * (x.len() * inner * N) as f64, entries);
    }
}

/// Weights that a sample meets: in the density network, in the color network.
const WEIGHTS: [usize; 2] = [WIDTH * HIDDEN + HIDDEN * GEOMETRY, GEOMETRY * HIDDEN + HIDDEN * 3];

/// Useful flops of the products of a live sample: forward, weights, inputs.
const SAMPLE: f64 = 2.0 * 3.0 * (WEIGHTS[0] + WEIGHTS[1]) as f64;

/// A model that has been trained a little, and the batch of its next step.
struct Step {
    model: CompactModel,
    chunks: Vec<Chunk>,
}

impl Step {
    fn new() -> Self {
        let scene = scene::load("builtin:blob", &scene::Options::default()).expect("a built-in scene");
        let mut model = CompactModel::new(&scene, &Overrides::default()).expect("it has no lens");
        for step in STEP - TRAINED..STEP {
            model.step(&scene, step).expect("a step of a built-in scene");
        }
        let mut step = Step { model, chunks: vec![] };
        step.run(&Plain);
        step
    }

    /// Draws the batch, as a step does, and takes it forward and backward; the seconds of the latter.
    fn run(&mut self, on: &impl Multiply) -> f64 {
        let rays = self.model.draw(&mut self.chunks, STEP);
        seconds(|| self.model.run(&mut self.chunks, rays, STEP, on))
    }

    /// The first chunk's products, checked.
    fn checked(&mut self, checked: Checked) -> [f64; 2] {
        let rays = self.model.draw(&mut self.chunks, STEP);
        self.model.run(&mut self.chunks[..1], rays, STEP, &checked);
        checked.found.worst_and_flops()
    }

    fn sum(&self, of: impl Fn(&Chunk) -> usize) -> usize {
        self.chunks.iter().map(of).sum()
    }
}

impl Layers for Step {
    fn check(&mut self) -> f64 {
        let [worst, _] = self.checked(Checked::default());
        self.run(&Plain);
        worst
    }

    fn work(&self) -> WorkCount {
        let (seen, live) = (self.sum(|c| c.visited.len()), self.sum(|c| c.points.len()));
        // Samples after the early stop have a density only.
        let products = live as f64 * SAMPLE + 2.0 * ((seen - live) * WEIGHTS[0]) as f64;
        let rays = self.sum(|c| c.rays.iter().filter(|ray| ray.count > 0).count());
        let per_ray = if self.model.settings.view_dependent { 4 * harmonics::WIDTH * HIDDEN } else { 0 };
        WorkCount { points: live, products, pass: products + (rays * per_ray) as f64 }
    }

    fn products(&mut self) -> f64 {
        let clock = Clock::default();
        self.run(&clock);
        clock.seconds()
    }

    fn pass(&mut self) -> f64 {
        self.run(&Plain)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

    use super::*;

    /// A step as it is made, which all tests share: it is trained once, and passed anew.
    fn made() -> MutexGuard<'static, Step> {
        static STEP: LazyLock<Mutex<Step>> = LazyLock::new(|| Mutex::new(Step::new()));
        let mut step = STEP.lock().unwrap_or_else(PoisonError::into_inner);
        step.chunks.clear();
        step.run(&Plain);
        step
    }

    /// By hand: 32 * 64 + 64 * 16 and 16 * 64 + 64 * 3 weights are 4,288, each with 6 flops. What runs has 13 more columns of 64 in the
    /// color layer forward, and rows that fill a block of 16.
    #[test]
    fn flops_are_those_that_run() {
        assert_eq!(SAMPLE, 6.0 * 4288.0);
        let mut step = made();
        let [worst, flops] = step.checked(Checked::default());
        assert!(worst > 0.0 && worst <= 1.0, "{worst}");
        let chunk = &step.chunks[0];
        let rows = [chunk.visited.len(), chunk.points.len()].map(|n| n.next_multiple_of(16) as f64);
        assert_eq!(flops, 2.0 * 3072.0 * (rows[0] - rows[1]) + rows[1] * (SAMPLE + 2.0 * 13.0 * 64.0));
        step.pass();
        let (seen, live) = (step.sum(|c| c.visited.len()), step.sum(|c| c.points.len()));
        let work = step.work();
        assert_eq!(work.points, live);
        assert_eq!(work.products, live as f64 * SAMPLE + (seen - live) as f64 * 6144.0);
        assert!(live > 12 * 1024, "{live}");
        let more = work.pass / (live as f64 * SAMPLE);
        assert!((1.0..1.5).contains(&more), "{more}");
    }

    /// Below the normal numbers arithmetic is slow: what a pass starts from and leaves has none.
    #[test]
    fn no_number_is_subnormal() {
        let mut step = made();
        let encodings = |chunk: &Chunk| {
            let levels = chunk.encoding.iter();
            levels.flat_map(|l| l[..chunk.points.len()].as_flattened().to_vec()).collect::<Vec<f32>>()
        };
        let fine = |values: &[f32]| {
            assert!(!values.iter().any(|x| x.is_subnormal()));
            assert!(values.iter().any(|&x| x != 0.0));
        };
        step.chunks.iter().for_each(|chunk| fine(&encodings(chunk)));
        for chunk in &step.chunks {
            let rows = ..chunk.points.len();
            fine(chunk.hidden0[rows].as_flattened());
            fine(chunk.rgb[rows].as_flattened());
            chunk.gradient.parts().into_iter().for_each(fine);
        }
        // The batch before its pass.
        let Step { model, chunks } = &mut *step;
        model.draw(chunks, STEP);
        step.chunks.iter().for_each(|chunk| fine(&encodings(chunk)));
    }

    /// Who times or checks a pass gets the pass's own bits, and a part of its time.
    #[test]
    fn a_pass_that_is_watched_is_the_training_pass() {
        let mut step = made();
        let gradient = |step: &Step| step.chunks[0].gradient.parts().map(<[f32]>::to_vec);
        let plain = gradient(&step);
        assert!(plain.iter().all(|part| part.iter().any(|&g| g != 0.0)));
        step.chunks[0].gradient.clear();
        step.checked(Checked::default());
        assert!(gradient(&step) == plain);
        step.chunks[0].gradient.clear();
        let clock = Clock::default();
        let [mut watched, mut part] = [0.0; 2];
        let step = &mut *step;
        crate::parallel::with_threads(Some(1), || (watched, part) = (step.run(&clock), clock.seconds()));
        assert!(gradient(step) == plain);
        assert!(0.0 < part && part < watched, "{part} of {watched}");
    }

    #[test]
    fn a_wrong_product_is_found() {
        let mut step = made();
        for wrong in [1e-3, f32::NAN] {
            let [worst, _] = step.checked(Checked { wrong, ..Checked::default() });
            assert!(worst > 1.0 || worst.is_nan(), "{wrong}: {worst}");
        }
    }
}
