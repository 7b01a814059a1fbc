//! A training step of the 8x256 network, for its share of the ceiling.
//!
//! Per point: the trunk, the folded color layer M (what is computed; feature and color layer apart would be 65,536 multiplications
//! more), both with their gradients. Per ray: the direction's columns. The heads of 1 and 3 outputs (0.1% of the work) are loops of
//! their own, not products, and stand in the pass.

use super::{Clock, Dense, Found, Layers, WorkCount, used};
use crate::bench::rounds::seconds;
use crate::bench::uniform;
use crate::convention::CS180;
use crate::field::NerfMlp;
use crate::field::fast::product::{Matrix, Multiply, Plain, product};
use crate::field::fast::{Batch, Gradient, Network, Rays, Skipping};
use crate::field::nerf_mlp::Shape;
use crate::random::{Key, Purpose};

/// Samples of a ray.
const SAMPLES: usize = 64;
/// Rays of the chunk that is checked: 512 points.
const CHECKED: usize = 8;

/// A step's dense layers, rays as `benches/step.rs` draws them.
pub const DENSE: Dense = Dense {
    name: "nerf_mlp",
    about: "8x256, 64 samples a ray, chunks of 512 points, every sample with its color and backward pass; 1,024 rays, 128 where quick",
    prepare: |quick| Box::new(Step::new(if quick { 128 } else { 1024 })),
};

impl Multiply for Clock {
    fn product(&self, c: &mut [f32], stride: usize, a: Matrix, b: Matrix, accumulate: bool) {
        let start = Clock::now();
        product(c, stride, a, b, accumulate);
        self.add(start);
    }
}

/// Compares every seventh row of each product, and its last, with f64.
struct Checked {
    multiply: fn(&mut [f32], usize, Matrix, Matrix, bool),
    found: Found,
}

impl Default for Checked {
    fn default() -> Self {
        Checked { multiply: product, found: Found::default() }
    }
}

impl Multiply for Checked {
    fn product(&self, c: &mut [f32], stride: usize, a: Matrix, b: Matrix, accumulate: bool) {
        let before = c.to_vec();
        (self.multiply)(c, stride, a, b, accumulate);
        let ((rows, terms), columns) = (a.shape(), b.shape().1);
        let entries = (0..rows).filter(|i| i % 7 == 0 || i + 1 == rows).flat_map(|i| {
            (0..columns).map(move |j| (i, j)).map(|(i, j)| {
                let old = if accumulate { before[i * stride + j] } else { 0.0 };
                used((0..terms).map(|k| (a.at(i, k), b.at(k, j))), old, false, c[i * stride + j])
            })
        });
        self.found.add(2.0 * (rows * terms * columns) as f64, entries);
    }
}

/// Useful flops of the products, per point and per ray.
fn flops(net: &Network) -> [f64; 2] {
    let Shape { direction, width, depth, color, .. } = net.shape;
    let forward =
        (0..depth).map(|n| net.shape.trunk_inputs(n, &CS180) * width).sum::<usize>() + width * color;
    // Nobody needs the encoding's gradient.
    let to_inputs = (depth - 1) * width * width + width * color;
    [2 * forward + to_inputs, 2 * color * direction].map(|macs| 2.0 * macs as f64)
}

/// A batch of rays and the network.
struct Step {
    net: Network,
    origins: Vec<f64>,
    directions: Vec<f64>,
    t: Vec<f64>,
    deltas: Vec<f64>,
    targets: Vec<f32>,
    gradient: Gradient,
}

impl Step {
    fn new(rays: usize) -> Self {
        let mut oracle = NerfMlp::initial(&Shape::PAPER, &CS180, &Key::new(0, Purpose::Parameters));
        // Keeps every density alive.
        oracle.sigma.b[0] += 0.1;
        let (samples, width) = (rays * SAMPLES, 4.0 / SAMPLES as f64);
        let jitter = uniform(32, samples, 0.0, 1.0);
        Step {
            net: Network::new(&oracle, &Shape::PAPER, &CS180),
            origins: uniform(30, 3 * rays, -2.0, 2.0),
            directions: uniform(31, 3 * rays, -0.58, 0.58),
            t: (0..samples).map(|i| 2.0 + ((i % SAMPLES) as f64 + jitter[i]) * width).collect(),
            deltas: vec![width; samples],
            targets: uniform(33, 3 * rays, 0.0, 1.0).iter().map(|&x| x as f32).collect(),
            gradient: Gradient::default(),
        }
    }

    fn rays(&self) -> usize {
        self.origins.len() / 3
    }

    /// The training step on the first `rays` rays, every sample computed.
    fn run(&mut self, rays: usize, on: &impl Multiply) {
        let Step { net, origins, directions, t, deltas, targets, gradient } = self;
        let (origins, directions) = (&origins[..3 * rays], &directions[..3 * rays]);
        let (t, deltas) = (&t[..SAMPLES * rays], &deltas[..SAMPLES * rays]);
        let rays = Rays { origins, directions, t, deltas, samples: SAMPLES, cube: None };
        let batch = Batch { rays, targets: &targets[..3 * rays.len()], background: [0.0; 3] };
        std::hint::black_box(net.step_on(&batch, Skipping::default(), true, gradient, on));
    }

    /// The products of a chunk, checked.
    fn checked(&mut self, checked: Checked) -> [f64; 2] {
        self.run(CHECKED, &checked);
        checked.found.worst_and_flops()
    }
}

impl Layers for Step {
    fn check(&mut self) -> f64 {
        self.checked(Checked::default())[0]
    }

    fn work(&self) -> WorkCount {
        let [point, ray] = flops(&self.net);
        let points = self.rays() * SAMPLES;
        let products = points as f64 * point + self.rays() as f64 * ray;
        // The heads: forward, weights, inputs.
        let heads = 2 * 3 * (self.net.shape.width + 3 * self.net.shape.color) * points;
        WorkCount { points, products, pass: products + heads as f64 }
    }

    fn products(&mut self) -> f64 {
        let clock = Clock::default();
        self.run(self.rays(), &clock);
        clock.seconds()
    }

    fn pass(&mut self) -> f64 {
        seconds(|| self.run(self.rays(), &Plain))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand for 8x256. Forward: 63 * 256 + 6 * 256^2 + 319 * 256 in the trunk, 256 * 128 in M: 523,776 multiplications; the weights'
    /// gradients as many; the inputs' 7 * 256^2 + 256 * 128 = 491,520. Per ray 27 * 128 forward and for the weights.
    #[test]
    fn flops_are_those_that_run() {
        let mut step = Step::new(16);
        assert_eq!(flops(&step.net), [2.0 * (2.0 * 523_776.0 + 491_520.0), 2.0 * 2.0 * 3456.0]);
        let [worst, ran] = step.checked(Checked::default());
        assert!(worst > 0.0 && worst <= 1.0, "{worst}");
        assert_eq!(ran, 512.0 * flops(&step.net)[0] + 8.0 * flops(&step.net)[1]);
        let work = step.work();
        assert_eq!((work.points, work.products), (1024, 2.0 * ran));
        assert_eq!(work.pass - work.products, 1024.0 * 2.0 * 3.0 * 640.0);
    }

    /// Who times or checks a step gets the step's own bits, and a part of its time.
    #[test]
    fn a_step_that_is_watched_is_the_training_step() {
        let mut step = Step::new(8);
        let whole = step.pass();
        let plain = std::mem::take(&mut step.gradient.values);
        assert!(plain.iter().any(|&g| g != 0.0) && whole > 0.0);
        step.checked(Checked::default());
        assert!(std::mem::take(&mut step.gradient.values) == plain);
        // One thread, so that the products' seconds are seconds of the clock on the wall.
        let [mut part, mut watched] = [0.0; 2];
        crate::parallel::with_threads(Some(1), || watched = seconds(|| part = step.products()));
        assert!(step.gradient.values == plain);
        assert!(0.0 < part && part < watched, "{part} of {watched}");
    }

    /// Off by a thousandth in one entry of one product.
    #[test]
    fn a_wrong_product_is_found() {
        let mut step = Step::new(8);
        for wrong in [1.0 + 1e-3, f32::NAN] {
            WRONG.store(wrong.to_bits(), std::sync::atomic::Ordering::Relaxed);
            let multiply = |c: &mut [f32], stride, a: Matrix, b: Matrix, accumulate| {
                product(c, stride, a, b, accumulate);
                if a.shape().0 == 256 && b.shape().1 == 63 {
                    // The largest entry of a row: a sum of little more than roundings may be off by as much as it is.
                    let row = c[7 * stride..8 * stride].iter_mut();
                    let entry = row.max_by(|a, b| a.abs().total_cmp(&b.abs())).expect("63 columns");
                    *entry *= f32::from_bits(WRONG.load(std::sync::atomic::Ordering::Relaxed));
                }
            };
            let [worst, _] = step.checked(Checked { multiply, ..Checked::default() });
            assert!(worst > 1.0 || worst.is_nan(), "{wrong}: {worst}");
        }
    }

    static WRONG: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
}
