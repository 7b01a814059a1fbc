//! Variants of volume rendering for `bench`: rays of 64 samples through a soft surface, as a trained scene has them.

use pulp::{Simd, WithSimd};

use crate::approximate::{Grade, attenuation};
use crate::bench::{BF16, Kernel, Scaling, Suite, Tolerance, Variant, kernel};
use crate::contract::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, input, values};
use crate::convention::ProductEps;
use crate::random::{Key, Purpose};
use crate::volume_rendering::fast::RayWeights;
use crate::{math, parallel};

const SAMPLES: usize = 64;
/// Rays of a task.
const TASK: usize = 64;

/// Rays of [`SAMPLES`] samples; items are samples.
fn workload(items: usize) -> Arrays {
    rays(items / SAMPLES, SAMPLES)
}

/// Empty space with a little haze, then a surface at a random depth; one ray in four meets nothing.
fn rays(count: usize, samples: usize) -> Arrays {
    let key = Key::new(1, Purpose::Cases);
    let single = |x: f64| f64::from(x as f32);
    let (mut sigmas, mut rgbs) = (vec![], vec![]);
    for r in 0..count as u64 {
        let (surface, u) = (key.uniform(0, r, 0), key.uniforms(1, r, 4 * samples));
        let meets = key.below(4, 0, r, 1) > 0;
        for i in 0..samples {
            let off = ((i as f64 + 0.5) / samples as f64 - surface) / 0.06;
            let bump = if meets { 60.0 * math::exp(-off * off) } else { 0.0 };
            sigmas.push(single(bump + 0.02 * u[4 * i]));
            rgbs.extend(u[4 * i + 1..4 * i + 4].iter().map(|&u| single(u)));
        }
    }
    let delta = single(4.0 / samples as f64);
    arrays([
        ("sigmas", array(&[count, samples], sigmas)),
        ("rgbs", array(&[count, samples, 3], rgbs)),
        ("deltas", array(&[count, samples], vec![delta; count * samples])),
    ])
}

/// Inputs in f32 (colors perhaps shorter), and all results.
struct Rays<C> {
    samples: usize,
    sigmas: Vec<f32>,
    rgbs: Vec<C>,
    deltas: Vec<f32>,
    out: Vec<Task>,
}

/// The results of some rays.
#[derive(Default)]
struct Task {
    rays: RayWeights,
    /// Color, opacity, transmittance behind the last sample.
    seen: Vec<[f32; 5]>,
}

impl<C> Rays<C> {
    fn new(a: &Arrays, color: fn(f32) -> C) -> Self {
        let single = |name| values(a, name).iter().map(|&x| x as f32).collect::<Vec<f32>>();
        let samples = input(a, "sigmas").shape()[1];
        let rgbs = single("rgbs").into_iter().map(color).collect();
        let (sigmas, deltas) = (single("sigmas"), single("deltas"));
        let rays = sigmas.len() / samples;
        let out = (0..rays.div_ceil(TASK)).map(|_| Task::default()).collect();
        Rays { samples, sigmas, rgbs, deltas, out }
    }

    fn bytes(&self) -> usize {
        let n = self.sigmas.len();
        // Densities, steps, weights, transmittances, opacities; colors; results.
        5 * 4 * n + size_of_val(&self.rgbs[..]) + n / self.samples * 20
    }

    fn read(&self) -> Arrays {
        let rays = self.sigmas.len() / self.samples;
        let wide = |x: Vec<f32>| x.into_iter().map(f64::from).collect::<Vec<f64>>();
        let column = |from: usize, to: usize| {
            wide(self.out.iter().flat_map(|t| &t.seen).flat_map(|s| s[from..to].to_vec()).collect())
        };
        let weights = wide(self.out.iter().flat_map(|t| t.rays.weights.iter().copied()).collect());
        arrays([
            ("colors", array(&[rays, 3], column(0, 3))),
            ("weights", array(&[rays, self.samples], weights)),
            ("opacity", array(&[rays], column(3, 4))),
            ("transmittance", array(&[rays], column(4, 5))),
        ])
    }
}

/// `work(task, sigmas, rgbs, deltas, samples)` for all tasks, on all threads or on one.
fn tasks<C: Copy + Sync + 'static>(
    a: &Arrays,
    threads: bool,
    color: fn(f32) -> C,
    work: impl Fn(&mut Task, &[f32], &[C], &[f32], usize) + Sync + Send + Copy + 'static,
) -> Box<dyn Kernel> {
    let rays = Rays::new(a, color);
    let run = move |rays: &mut Rays<C>| {
        let Rays { samples, sigmas, rgbs, deltas, out } = rays;
        let one = |n: usize, task: &mut Task| {
            let from = n * TASK * *samples;
            let to = sigmas.len().min(from + TASK * *samples);
            work(task, &sigmas[from..to], &rgbs[3 * from..3 * to], &deltas[from..to], *samples);
        };
        if threads {
            parallel::for_chunks(out, 1, |n, task| one(n, &mut task[0]));
        } else {
            out.iter_mut().enumerate().for_each(|(n, task)| one(n, task));
        }
    };
    let bytes = rays.bytes();
    kernel(rays, bytes, run, Rays::read)
}

fn oracle(a: &Arrays) -> Box<dyn Kernel> {
    let (rays, samples) = (input(a, "sigmas").shape()[0], input(a, "sigmas").shape()[1]);
    let rgbs: Vec<[f64; 3]> = values(a, "rgbs").as_chunks::<3>().0.to_vec();
    let data = (values(a, "sigmas"), rgbs, values(a, "deltas"), Vec::new());
    let bytes = 8 * rays * samples * 7;
    let run =
        move |data: &mut (Vec<f64>, Vec<[f64; 3]>, Vec<f64>, Vec<crate::volume_rendering::Rendering>)| {
            let (sigmas, rgbs, deltas, out) = data;
            out.clear();
            for r in 0..rays {
                let row = r * samples..(r + 1) * samples;
                let (sigmas, rgbs) = (&sigmas[row.clone()], &rgbs[row.clone()]);
                out.push(crate::volume_rendering::volume_render(
                    sigmas,
                    rgbs,
                    &deltas[row],
                    ProductEps::None,
                ));
            }
        };
    kernel(data, bytes, run, move |data| crate::volume_rendering::arrays::renderings(samples, &data.3))
}

/// The straightforward code: alpha = 1 - exp(-x), T as a running product.
fn plain(task: &mut Task, sigmas: &[f32], rgbs: &[f32], deltas: &[f32], samples: usize) {
    task.seen.clear();
    task.rays.weights.clear();
    for ray in (0..sigmas.len()).step_by(samples) {
        let (mut t, mut seen) = (1.0f32, [0f32; 5]);
        for i in ray..ray + samples {
            let alpha = 1.0 - (-sigmas[i] * deltas[i]).exp();
            let w = t * alpha;
            task.rays.weights.push(w);
            for k in 0..3 {
                seen[k] += w * rgbs[3 * i + k];
            }
            seen[3] += w;
            t *= 1.0 - alpha;
        }
        seen[4] = t;
        task.seen.push(seen);
    }
}

struct Composite<'a, C> {
    task: &'a mut Task,
    rgbs: &'a [C],
    samples: usize,
    wide: fn(C) -> f32,
}

impl<C: Copy> WithSimd for Composite<'_, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Composite { task, rgbs, samples, wide } = self;
        task.seen.clear();
        let rays = task.rays.weights.chunks_exact(samples).zip(task.rays.behind.chunks_exact(samples));
        for ((weights, behind), rgbs) in rays.zip(rgbs.chunks_exact(3 * samples)) {
            let mut seen = [0f32; 5];
            for (w, c) in weights.iter().zip(rgbs.chunks_exact(3)) {
                for k in 0..3 {
                    seen[k] += w * wide(c[k]);
                }
                seen[3] += w;
            }
            seen[4] = behind[samples - 1];
            task.seen.push(seen);
        }
    }
}

fn vectorized<C: Copy>(
    task: &mut Task,
    (sigmas, rgbs, deltas): (&[f32], &[C], &[f32]),
    samples: usize,
    wide: fn(C) -> f32,
) {
    let arch = crate::simd::arch();
    task.rays.compute(arch, sigmas, deltas, samples);
    arch.dispatch(Composite { task, rgbs, samples, wide });
}

/// Exponentials of a stated grade for all samples, then one scan a ray.
struct Graded<'a> {
    task: &'a mut Task,
    sigmas: &'a [f32],
    deltas: &'a [f32],
    samples: usize,
    grade: Grade,
}

impl WithSimd for Graded<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Graded { task, sigmas, deltas, samples, grade } = self;
        let RayWeights { weights, behind, .. } = &mut task.rays;
        weights.resize(sigmas.len(), 0.0);
        behind.resize(sigmas.len(), 0.0);
        let low = grade == Grade::Low;
        for ((w, b), (s, d)) in weights.iter_mut().zip(behind.iter_mut()).zip(sigmas.iter().zip(deltas)) {
            (*b, *w) = if low { attenuation(s * d, Grade::Low) } else { attenuation(s * d, Grade::Middle) };
        }
        for (weights, behind) in weights.chunks_exact_mut(samples).zip(behind.chunks_exact_mut(samples)) {
            let mut t = 1.0;
            for (w, behind) in weights.iter_mut().zip(behind) {
                *w *= t;
                t *= *behind;
                *behind = t;
            }
        }
    }
}

fn graded(a: &Arrays, grade: Grade) -> Box<dyn Kernel> {
    tasks(
        a,
        true,
        |c| c,
        move |task, sigmas, rgbs, deltas, samples| {
            let arch = crate::simd::arch();
            arch.dispatch(Graded { task, sigmas, deltas, samples, grade });
            arch.dispatch(Composite { task, rgbs, samples, wide: |c| c });
        },
    )
}

/// Samples that are computed together before the transmittance is compared with eps.
const STRIDE: usize = 16;

/// A ray ends after the block of samples that takes its transmittance below eps.
struct Stopped<'a> {
    task: &'a mut Task,
    sigmas: &'a [f32],
    rgbs: &'a [f32],
    deltas: &'a [f32],
    samples: usize,
    eps: f32,
}

impl WithSimd for Stopped<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Stopped { task, sigmas, rgbs, deltas, samples, eps } = self;
        task.seen.clear();
        task.rays.weights.clear();
        task.rays.weights.resize(sigmas.len(), 0.0);
        let mut both = [(0f32, 0f32); STRIDE];
        let rays = sigmas.chunks_exact(samples).zip(deltas.chunks_exact(samples));
        let out = rgbs.chunks_exact(3 * samples).zip(task.rays.weights.chunks_exact_mut(samples));
        for ((sigmas, deltas), (rgbs, weights)) in rays.zip(out) {
            let (mut t, mut seen) = (1.0f32, [0f32; 5]);
            for from in (0..samples).step_by(STRIDE) {
                if t < eps {
                    break;
                }
                let block = from..samples.min(from + STRIDE);
                for (both, i) in both.iter_mut().zip(block.clone()) {
                    *both = attenuation(sigmas[i] * deltas[i], Grade::Full);
                }
                for (&(keep, alpha), i) in both.iter().zip(block) {
                    let w = t * alpha;
                    weights[i] = w;
                    for k in 0..3 {
                        seen[k] += w * rgbs[3 * i + k];
                    }
                    seen[3] += w;
                    t *= keep;
                }
            }
            seen[4] = t;
            task.seen.push(seen);
        }
    }
}

fn stopped(a: &Arrays, eps: f32) -> Box<dyn Kernel> {
    tasks(
        a,
        true,
        |c| c,
        move |task, sigmas, rgbs, deltas, samples| {
            crate::simd::arch().dispatch(Stopped { task, sigmas, rgbs, deltas, samples, eps });
        },
    )
}

/// Vectorized on all threads.
fn threaded(a: &Arrays) -> Box<dyn Kernel> {
    tasks(a, true, |c| c, |task, s, c, d, n| vectorized(task, (s, c, d), n, |c| c))
}

/// The suite of volume rendering.
pub(crate) const SUITE: Suite = Suite {
    component: "volume_render",
    judged: true,
    item: "sample",
    workload,
    items: 4096 * SAMPLES,
    checked: 512 * SAMPLES,
    oracle,
    variants: &[
        Variant::f32(
            "plain_f32",
            "one thread, 1 - exp(-x) of the library, a running product",
            Tolerance::f32(),
            |a| tasks(a, false, |c| c, plain),
        ),
        Variant::f32(
            "vectorized",
            "one thread, one polynomial for e^-x and 1 - e^-x over all samples, then one scan a ray",
            Tolerance::f32(),
            |a| tasks(a, false, |c| c, |task, s, c, d, n| vectorized(task, (s, c, d), n, |c| c)),
        ),
        Variant::f32("threaded", "the same on all threads", Tolerance::f32(), threaded),
        Variant::f32(
            "exp_256_ulp",
            "all threads, exponential within 256 ULP",
            Tolerance::grade(Grade::Middle.exp_ulp()),
            |a| graded(a, Grade::Middle),
        ),
        Variant::f32(
            "exp_8192_ulp",
            "all threads, exponential within 8,192 ULP (11 bits)",
            Tolerance::grade(Grade::Low.exp_ulp()),
            |a| graded(a, Grade::Low),
        ),
        Variant::f32(
            "stop_1e-4",
            "all threads, a ray ends where T < 1e-4",
            Tolerance::f32().within(1e-4),
            |a| stopped(a, 1e-4),
        ),
        Variant::f32(
            "stop_1e-3",
            "all threads, a ray ends where T < 1e-3",
            Tolerance::f32().within(1e-3),
            |a| stopped(a, 1e-3),
        ),
        Variant::f32(
            "stop_1e-2",
            "all threads, a ray ends where T < 1e-2",
            Tolerance::f32().within(1e-2),
            |a| stopped(a, 1e-2),
        ),
        Variant {
            dtype: Dtype::Bf16,
            ..Variant::f32(
                "bf16_colors",
                "all threads, colors stored as bf16, everything else as before",
                Tolerance::f32().stored(BF16),
                |a| {
                    tasks(a, true, crate::approximate::to_bf16, |task, s, c, d, n| {
                        vectorized(task, (s, c, d), n, crate::approximate::from_bf16)
                    })
                },
            )
        },
    ],
};

/// Time and memory against the samples of a ray.
pub(crate) const SCALING: &[Scaling] = &[Scaling {
    component: "volume_render",
    parameter: "samples",
    about: "threaded, 1,024 rays",
    values: &[16.0, 32.0, 64.0, 128.0, 256.0, 512.0],
    prepare: |samples| threaded(&rays(1024, samples as usize)),
    memory: true,
}];
