//! Variants of samples along rays for `bench`: 64 a ray.

use half::f16;
use pulp::{Simd, WithSimd};

use crate::bench::{F16, Kernel, Suite, Tolerance, Variant, kernel, singles, uniform};
use crate::contract::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, number, scalar, values};
use crate::convention::Grid;
use crate::parallel;
use crate::sample::sample_along_ray;

const SAMPLES: usize = 64;
/// Rays of a task.
const TASK: usize = 256;

/// Rays from a camera at distance 4, jittered samples; items are samples.
fn workload(items: usize) -> Arrays {
    let rays = items / SAMPLES;
    arrays([
        ("rays_o", array(&[rays, 3], uniform(6, 3 * rays, -4.0, 4.0))),
        ("rays_d", array(&[rays, 3], uniform(7, 3 * rays, -1.0, 1.0))),
        ("near", scalar(2.0)),
        ("far", scalar(6.0)),
        ("u", array(&[rays, SAMPLES], uniform(8, rays * SAMPLES, 0.0, 1.0))),
    ])
}

/// t and o + t d of every sample, stored as `T`.
struct Samples<T> {
    o: Vec<[f32; 3]>,
    d: Vec<[f32; 3]>,
    u: Vec<f32>,
    near: f32,
    width: f32,
    /// Rows of 4: t, then the point.
    out: Vec<[T; 4]>,
}

impl<T: Copy + Default + Send + Sync + 'static> Samples<T> {
    fn new(a: &Arrays) -> Self {
        let threes = |name| singles(a, name).as_chunks::<3>().0.to_vec();
        let (near, far) = (number(a, "near"), number(a, "far"));
        let u = singles(a, "u");
        let out = vec![[T::default(); 4]; u.len()];
        let width = ((far - near) / SAMPLES as f64) as f32;
        Samples { o: threes("rays_o"), d: threes("rays_d"), u, near: near as f32, width, out }
    }

    fn kernel(
        self,
        run: impl Fn(&mut Samples<T>) + 'static,
        wide: impl Fn(T) -> f64 + 'static,
    ) -> Box<dyn Kernel> {
        let bytes = 4 * self.u.len() + size_of_val(&self.out[..]) + 24 * self.o.len();
        kernel(self, bytes, run, move |s| {
            let rays = s.o.len();
            let t = s.out.iter().map(|row| wide(row[0])).collect();
            let points = s.out.iter().flat_map(|row| [1, 2, 3].map(|k| wide(row[k]))).collect();
            arrays([("t", array(&[rays, SAMPLES], t)), ("points", array(&[rays, SAMPLES, 3], points))])
        })
    }
}

fn oracle(a: &Arrays) -> Box<dyn Kernel> {
    let (near, far) = (number(a, "near"), number(a, "far"));
    let inputs = ["rays_o", "rays_d", "u"].map(|name| values(a, name));
    let rays = inputs[0].len() / 3;
    let bytes = 8 * (6 * rays + 5 * rays * SAMPLES);
    let data = (inputs, vec![], vec![]);
    let run = move |([o, d, u], t, points): &mut ([Vec<f64>; 3], Vec<f64>, Vec<f64>)| {
        t.clear();
        points.clear();
        for r in 0..rays {
            let at = sample_along_ray(near, far, &u[r * SAMPLES..(r + 1) * SAMPLES], Grid::Intervals);
            let vector = |x: &[f64]| glam::DVec3::new(x[3 * r], x[3 * r + 1], x[3 * r + 2]);
            let ray = crate::ray::Ray { o: vector(o), d: vector(d) };
            for &at in &at {
                points.extend(ray.at(at).to_array());
            }
            t.extend(at);
        }
    };
    kernel(data, bytes, run, move |(_, t, points)| {
        let t = array(&[rays, SAMPLES], t.clone());
        arrays([("t", t), ("points", array(&[rays, SAMPLES, 3], points.clone()))])
    })
}

/// Rays of one task.
struct Task<'a, T> {
    o: &'a [[f32; 3]],
    d: &'a [[f32; 3]],
    u: &'a [f32],
    near: f32,
    width: f32,
    out: &'a mut [[T; 4]],
    store: fn(f32) -> T,
}

impl<T: Copy> Task<'_, T> {
    #[inline(always)]
    fn rays(self) {
        let Task { o, d, u, near, width, out, store } = self;
        let rays = o.iter().zip(d).zip(u.chunks_exact(SAMPLES).zip(out.chunks_exact_mut(SAMPLES)));
        for ((o, d), (u, out)) in rays {
            for (i, (u, out)) in u.iter().zip(out).enumerate() {
                let t = near + (i as f32 + u) * width;
                *out = [t, o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]].map(store);
            }
        }
    }
}

impl<T: Copy> WithSimd for Task<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.rays();
    }
}

fn plain(a: &Arrays) -> Box<dyn Kernel> {
    let run = |s: &mut Samples<f32>| {
        let Samples { o, d, u, near, width, out } = s;
        Task { o, d, u, near: *near, width: *width, out, store: |x| x }.rays();
    };
    Samples::new(a).kernel(run, f64::from)
}

fn vectorized(a: &Arrays) -> Box<dyn Kernel> {
    let run = |s: &mut Samples<f32>| {
        let Samples { o, d, u, near, width, out } = s;
        crate::simd::arch().dispatch(Task { o, d, u, near: *near, width: *width, out, store: |x| x });
    };
    Samples::new(a).kernel(run, f64::from)
}

fn threaded<T: Copy + Default + Send + Sync + 'static>(
    a: &Arrays,
    store: fn(f32) -> T,
    wide: fn(T) -> f64,
) -> Box<dyn Kernel> {
    let run = move |s: &mut Samples<T>| {
        let Samples { o, d, u, near, width, out } = s;
        let (arch, near, width) = (crate::simd::arch(), *near, *width);
        parallel::for_chunks(out, TASK * SAMPLES, |n, out| {
            let (from, to) = (n * TASK, n * TASK + out.len() / SAMPLES);
            let (o, d, u) = (&o[from..to], &d[from..to], &u[from * SAMPLES..to * SAMPLES]);
            arch.dispatch(Task { o, d, u, near, width, out, store });
        });
    };
    Samples::new(a).kernel(run, wide)
}

/// The suite of samples along rays.
pub(crate) const SUITE: Suite = Suite {
    component: "sample_along_rays",
    judged: true,
    item: "sample",
    workload,
    items: 4096 * SAMPLES,
    checked: 256 * SAMPLES,
    oracle,
    variants: &[
        Variant::new("plain_f32", "one thread, the formula in f32", Dtype::F32, Tolerance::f32(), plain),
        Variant::new(
            "vectorized",
            "one thread, the machine's widest instructions",
            Dtype::F32,
            Tolerance::f32(),
            vectorized,
        ),
        Variant::new("threaded", "the same on all threads", Dtype::F32, Tolerance::f32(), |a| {
            threaded(a, |x| x, f64::from)
        }),
        Variant::new(
            "f16",
            "the same, stored as f16: half the memory",
            Dtype::F16,
            // Below 2^-14 numbers of f16 are 2^-24 apart.
            Tolerance::f32().stored(F16).within(1.0 / 16_777_216.0),
            |a| threaded(a, f16::from_f32, f64::from),
        ),
    ],
};
