//! The matrix products of a training step of the 8x256 network alone, for `bench`'s share of the ceiling.
//!
//! Per point: the trunk, the folded color layer M (what is computed; feature and color layer apart would be 65,536 multiplications
//! more), both with their gradients. Per ray: the direction's columns. The heads of 1 and 3 outputs (0.1% of the work) are loops of
//! their own, not products, and stand in the pass.

use super::CHUNK;
use super::chunk::{ChunkBuffers, Prepared};
use super::gradient::{Gradient, Group, Pool};
use super::network::{Batch, Network};
use super::product::{Matrix, product};
use super::rays::Rays;
use super::skipping::Skipping;
use crate::bench::dense::{Dense, Layers, WorkCount, bound, worse};
use crate::bench::rounds::seconds;
use crate::bench::uniform;
use crate::convention::Density;
use crate::field::NerfMlp;
use crate::field::nerf_mlp::Shape;
use crate::parallel;
use crate::random::{Key, Purpose};

/// Samples of a ray.
const SAMPLES: usize = 64;
/// Groups of chunks, as a step has.
const GROUPS: usize = 16;

/// A step's dense layers, rays as `benches/step.rs` draws them.
pub const DENSE: Dense = Dense {
    name: "nerf_mlp",
    about: "8x256, 64 samples a ray, chunks of 512 points, every sample with its color and backward pass; 1,024 rays, 128 where quick",
    prepare: |quick| Box::new(Step::new(if quick { 128 } else { 1024 })),
};

/// Who multiplies: for time, or to be checked.
trait Multiply {
    fn product(&mut self, c: &mut [f32], stride: usize, a: Matrix, b: Matrix, accumulate: bool);
}

struct Timed;

impl Multiply for Timed {
    fn product(&mut self, c: &mut [f32], stride: usize, a: Matrix, b: Matrix, accumulate: bool) {
        product(c, stride, a, b, accumulate);
    }
}

/// Compares every seventh row of each product, and its last, with f64; counts flops.
struct Checked {
    multiply: fn(&mut [f32], usize, Matrix, Matrix, bool),
    worst: f64,
    flops: f64,
}

impl Default for Checked {
    fn default() -> Self {
        Checked { multiply: product, worst: 0.0, flops: 0.0 }
    }
}

impl Multiply for Checked {
    fn product(&mut self, c: &mut [f32], stride: usize, a: Matrix, b: Matrix, accumulate: bool) {
        let before = c.to_vec();
        (self.multiply)(c, stride, a, b, accumulate);
        let ((rows, terms), columns) = (a.shape(), b.shape().1);
        self.flops += 2.0 * (rows * terms * columns) as f64;
        for i in (0..rows).filter(|i| i % 7 == 0 || i + 1 == rows) {
            for j in 0..columns {
                let old = if accumulate { f64::from(before[i * stride + j]) } else { 0.0 };
                let (mut sum, mut absolute) = (old, old.abs());
                for k in 0..terms {
                    let term = f64::from(a.at(i, k)) * f64::from(b.at(k, j));
                    sum += term;
                    absolute += term.abs();
                }
                let off = (f64::from(c[i * stride + j]) - sum).abs();
                self.worst = worse(self.worst, off / bound(terms, absolute));
            }
        }
    }
}

/// The products of a chunk that has been through a step, in the step's order, without what lies between them. Inputs are what the step
/// left or what the products before wrote; adds to `gradient`, the folded matrix's after the parameters.
fn products(net: &Prepared, chunk: &mut ChunkBuffers, gradient: &mut [f32], on: &mut impl Multiply) {
    let Prepared { net, trunk: transposed, folded, folded_t, bias } = net;
    let (trunk, points) = (&net.trunk, chunk.active.len());
    let (width, color, columns) = (net.shape.width, net.shape.color, net.shape.direction);
    let (gradient, g_folded) = gradient.split_at_mut(net.params.len());
    let tape = &mut chunk.tape;
    for (n, layer) in trunk.layers.iter().enumerate() {
        let (before, after) = tape.h.split_at_mut(n);
        let x = match n {
            0 => Matrix::new(&tape.encoding, points, layer.inputs, trunk.encoding),
            n => Matrix::new(&before[n - 1], points, layer.inputs, trunk.stride(n - 1)),
        };
        let w = Matrix::new(&transposed[n], layer.inputs, width, width);
        on.product(&mut after[0], trunk.stride(n), x, w, false);
    }
    let rays = chunk.directions.len() / columns;
    chunk.ray_terms.clear();
    chunk.ray_terms.extend((0..rays).flat_map(|_| bias));
    let directions = Matrix::new(&chunk.directions, rays, columns, columns);
    let w = Matrix::new(&net.color0.of(&net.params).0[width..], color, columns, net.color0.inputs);
    on.product(&mut chunk.ray_terms, color, directions, w.t(), true);
    let h = Matrix::new(trunk.last(tape), points, width, width);
    on.product(&mut chunk.hidden, color, h, Matrix::new(folded_t, width, color, color), false);

    let g_rays = Matrix::new(&chunk.g_rays, rays, color, color);
    let g_w = &mut net.color0.of_mut(gradient).0[width..];
    on.product(g_w, net.color0.inputs, g_rays.t(), directions, true);
    let g_hidden = Matrix::new(&chunk.g_hidden, points, color, color);
    on.product(g_folded, width, g_hidden.t(), h, true);
    on.product(&mut tape.g, width, g_hidden, Matrix::new(folded, color, width, width), false);
    for (n, layer) in trunk.layers.iter().enumerate().rev() {
        let g = Matrix::new(&tape.g, points, width, width);
        let x = match n {
            0 => Matrix::new(&tape.encoding, points, layer.inputs, trunk.encoding),
            n => Matrix::new(&tape.h[n - 1], points, layer.inputs, trunk.stride(n - 1)),
        };
        on.product(layer.of_mut(gradient).0, layer.inputs, g.t(), x, true);
        if n > 0 {
            let w = Matrix::new(layer.of(&net.params).0, width, width, layer.inputs);
            on.product(&mut tape.g_next, width, g, w, false);
            std::mem::swap(&mut tape.g, &mut tape.g_next);
        }
    }
}

/// Useful flops of the products, per point and per ray.
fn flops(net: &Network) -> [f64; 2] {
    let (width, color) = (net.shape.width, net.shape.color);
    let layers = &net.trunk.layers;
    let forward = layers.iter().map(|l| l.inputs * width).sum::<usize>() + width * color;
    // Nobody needs the encoding's gradient.
    let to_inputs = (layers.len() - 1) * width * width + width * color;
    [2 * forward + to_inputs, 2 * color * net.shape.direction].map(|macs| 2.0 * macs as f64)
}

/// A chunk's buffers after a step, and a group's gradient.
#[derive(Default)]
struct Filled {
    chunk: ChunkBuffers,
    gradient: Vec<f32>,
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
    pool: Pool<Filled>,
}

impl Step {
    fn new(rays: usize) -> Self {
        let mut oracle = NerfMlp::initial(&Shape::PAPER, &Key::new(0, Purpose::Parameters));
        // Keeps every density alive.
        oracle.sigma.b[0] += 0.1;
        let (samples, width) = (rays * SAMPLES, 4.0 / SAMPLES as f64);
        let jitter = uniform(32, samples, 0.0, 1.0);
        Step {
            net: Network::new(&oracle, &Shape::PAPER, Density::Relu),
            origins: uniform(30, 3 * rays, -2.0, 2.0),
            directions: uniform(31, 3 * rays, -0.58, 0.58),
            t: (0..samples).map(|i| 2.0 + ((i % SAMPLES) as f64 + jitter[i]) * width).collect(),
            deltas: vec![width; samples],
            targets: uniform(33, 3 * rays, 0.0, 1.0).iter().map(|&x| x as f32).collect(),
            gradient: Gradient::default(),
            pool: Pool::default(),
        }
    }

    /// The first `rays` rays.
    fn batch(&self, rays: usize) -> Batch<'_> {
        let Step { origins, directions, t, deltas, targets, .. } = self;
        let all = Rays { origins, directions, t, deltas, samples: SAMPLES };
        Batch { rays: all.part(0, rays), targets: &targets[..3 * rays], background: [0.0; 3] }
    }

    fn rays(&self) -> usize {
        self.origins.len() / 3
    }

    /// A chunk's buffers after its step, with its gradient.
    fn filled(&self, prepared: &Prepared) -> Filled {
        let (mut chunk, mut group) = (ChunkBuffers::default(), Group::default());
        group.partial.resize(self.net.params.len() + prepared.folded.len(), 0.0);
        prepared.step(&mut chunk, &self.batch(CHUNK / SAMPLES), Skipping::default(), true, 1e-3, &mut group);
        Filled { chunk, gradient: group.partial }
    }

    /// The products of a chunk, checked.
    fn checked(&self, mut checked: Checked) -> Checked {
        let prepared = Prepared::new(&self.net);
        let mut filled = self.filled(&prepared);
        products(&prepared, &mut filled.chunk, &mut filled.gradient, &mut checked);
        checked
    }
}

impl Layers for Step {
    fn check(&mut self) -> f64 {
        self.checked(Checked::default()).worst
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
        let prepared = Prepared::new(&self.net);
        let chunks = self.rays() * SAMPLES / CHUNK;
        let each = chunks.div_ceil(GROUPS);
        let this = &*self;
        seconds(|| {
            parallel::map(chunks.div_ceil(each), |group| {
                this.pool.with(|filled| {
                    // In the first run alone: a median doesn't see it.
                    if filled.gradient.is_empty() {
                        *filled = this.filled(&prepared);
                    }
                    filled.gradient.fill(0.0);
                    for _ in group * each..chunks.min((group + 1) * each) {
                        products(&prepared, &mut filled.chunk, &mut filled.gradient, &mut Timed);
                    }
                });
            });
        })
    }

    fn pass(&mut self) -> f64 {
        let mut gradient = std::mem::take(&mut self.gradient);
        let batch = self.batch(self.rays());
        let took = seconds(|| {
            std::hint::black_box(self.net.step(&batch, true, &mut gradient));
        });
        self.gradient = gradient;
        took
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand for 8x256. Forward: 63 * 256 + 6 * 256^2 + 319 * 256 in the trunk, 256 * 128 in M: 523,776 multiplications; the weights'
    /// gradients as many; the inputs' 7 * 256^2 + 256 * 128 = 491,520. Per ray 27 * 128 forward and for the weights.
    #[test]
    fn flops_are_those_that_run() {
        let step = Step::new(16);
        assert_eq!(flops(&step.net), [2.0 * (2.0 * 523_776.0 + 491_520.0), 2.0 * 2.0 * 3456.0]);
        let checked = step.checked(Checked::default());
        assert!(checked.worst > 0.0 && checked.worst <= 1.0, "{}", checked.worst);
        assert_eq!(checked.flops, 512.0 * flops(&step.net)[0] + 8.0 * flops(&step.net)[1]);
        let work = step.work();
        assert_eq!((work.points, work.products), (1024, 2.0 * checked.flops));
        assert_eq!(work.pass - work.products, 1024.0 * 2.0 * 3.0 * 640.0);
    }

    /// Where nothing stands between the products (biases 0, everything alive, no density), activations and gradients are those of the
    /// training, bit for bit.
    #[test]
    fn they_are_the_trainings_own() {
        let mut step = Step::new(8);
        let net = &mut step.net;
        net.params.iter_mut().for_each(|w| *w = w.abs() / 16.0);
        for layer in net.trunk.layers.clone().into_iter().chain([net.feature, net.color0]) {
            layer.of_mut(&mut net.params).1.fill(0.0);
        }
        net.sigma.of_mut(&mut net.params).0.fill(0.0);
        // An encoding has either sign, but x > 0: that alone is looked at.
        let (first, skip) = (net.trunk.layers[0], net.trunk.layers[net.trunk.skip]);
        for (n, row) in first.of_mut(&mut net.params).0.chunks_mut(63).enumerate() {
            row.fill(0.0);
            row[0] = 1.0 + n as f32 / 256.0;
        }
        skip.of_mut(&mut net.params).0.chunks_mut(319).for_each(|row| row[256..].fill(0.0));
        step.origins.fill(0.5);
        step.directions.iter_mut().for_each(|d| *d = 0.1 + d.abs());
        let (net, prepared) = (&step.net, Prepared::new(&step.net));
        let (mut expected, mut got) = (step.filled(&prepared), step.filled(&prepared));
        assert!(expected.chunk.tape.h[7].iter().all(|&x| x > 0.0), "every unit is alive");
        got.gradient.fill(0.0);
        products(&prepared, &mut got.chunk, &mut got.gradient, &mut Timed);
        assert!(got.chunk.tape.h == expected.chunk.tape.h);
        for layer in &net.trunk.layers {
            let of = |filled: &mut Filled| layer.of_mut(&mut filled.gradient).0.to_vec();
            assert!(of(&mut got) == of(&mut expected) && of(&mut got).iter().any(|&g| g != 0.0));
        }
        let folded = net.params.len()..;
        assert!(got.gradient[folded.clone()] == expected.gradient[folded]);
        let of = |filled: &mut Filled| net.color0.of_mut(&mut filled.gradient).0.to_vec();
        assert!(of(&mut got) == of(&mut expected));
    }

    /// Off by a thousandth in one entry of one product.
    #[test]
    fn a_wrong_product_is_found() {
        let step = Step::new(8);
        for wrong in [1.0 + 1e-3, f32::NAN] {
            let mut checked = Checked {
                multiply: |c, stride, a, b, accumulate| {
                    product(c, stride, a, b, accumulate);
                    if a.shape().0 == 256 && b.shape().1 == 63 {
                        c[7 * stride + 3] *= WRONG.get();
                    }
                },
                ..Checked::default()
            };
            WRONG.set(wrong);
            checked = step.checked(checked);
            assert!(checked.worst > 1.0 || checked.worst.is_nan(), "{wrong}: {}", checked.worst);
        }
    }

    thread_local! {
        static WRONG: std::cell::Cell<f32> = const { std::cell::Cell::new(1.0) };
    }
}
