//! Variants of the spherical harmonics for `bench`: bands 0 to 3.

use pulp::{Simd, WithSimd};

use crate::approximate::{from_bf16, to_bf16};
use crate::bench::{BF16, Kernel, Suite, Tolerance, Variant, rows, singles, uniform};
use crate::contract::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, scalar, values};
use crate::convention::{HarmonicForm, HarmonicSign};
use crate::parallel;
use crate::spherical_harmonics::{POLYNOMIALS, fast, harmonics};

const WIDTH: usize = fast::WIDTH;
/// Directions of a task.
const TASK: usize = 2048;

/// Unit directions.
fn workload(items: usize) -> Arrays {
    let u = uniform(1, 3 * items, -1.0, 1.0);
    let unit = |v: &[f64; 3]| {
        let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt().max(1e-6);
        v.map(|x| f64::from((x / length) as f32))
    };
    let d = u.as_chunks::<3>().0.iter().flat_map(unit).collect();
    arrays([("d", array(&[items, 3], d)), ("degree", scalar(3.0))])
}

fn oracle(a: &Arrays) -> Box<dyn Kernel> {
    let run = |d: &[f64], out: &mut [f64]| {
        for (d, out) in d.as_chunks::<3>().0.iter().zip(out.chunks_exact_mut(WIDTH)) {
            out.copy_from_slice(&harmonics(*d, 3, HarmonicForm::Sphere, HarmonicSign::Alternating));
        }
    };
    rows("harmonics", (values(a, "d"), 3, WIDTH), run, |&y| y)
}

/// The table of polynomials, term by term.
fn plain(a: &Arrays) -> Box<dyn Kernel> {
    let power = |x: f32, n: u32| (0..n).fold(1.0f32, |p, _| p * x);
    let run = move |d: &[f32], out: &mut [f32]| {
        for (d, out) in d.as_chunks::<3>().0.iter().zip(out.chunks_exact_mut(WIDTH)) {
            for (out, polynomial) in out.iter_mut().zip(&POLYNOMIALS) {
                *out = 0.0;
                for &(coefficient, [i, j, k]) in *polynomial {
                    *out += coefficient as f32 * power(d[0], i) * power(d[1], j) * power(d[2], k);
                }
            }
        }
    };
    rows("harmonics", (singles(a, "d"), 3, WIDTH), run, |&y| y.into())
}

struct Directions<'a, T> {
    d: &'a [f32],
    out: &'a mut [T],
    store: fn(f32) -> T,
}

impl<T: Copy> WithSimd for Directions<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let store = self.store;
        for (d, out) in self.d.as_chunks::<3>().0.iter().zip(self.out.as_chunks_mut::<WIDTH>().0) {
            *out = fast::harmonics(*d).map(store);
        }
    }
}

fn shared(a: &Arrays) -> Box<dyn Kernel> {
    let run = |d: &[f32], out: &mut [f32]| crate::simd::arch().dispatch(Directions { d, out, store: |x| x });
    rows("harmonics", (singles(a, "d"), 3, WIDTH), run, |&y| y.into())
}

fn threaded<T: Copy + Default + Send + 'static>(
    a: &Arrays,
    store: fn(f32) -> T,
    load: fn(T) -> f32,
) -> Box<dyn Kernel> {
    let run = move |d: &[f32], out: &mut [T]| {
        let arch = crate::simd::arch();
        parallel::for_chunks(out, TASK * WIDTH, |n, out| {
            let d = &d[n * TASK * 3..][..out.len() / WIDTH * 3];
            arch.dispatch(Directions { d, out, store });
        });
    };
    rows("harmonics", (singles(a, "d"), 3, WIDTH), run, move |&y| load(y).into())
}

/// The suite of the spherical harmonics.
pub(crate) const SUITE: Suite = Suite {
    component: "spherical_harmonics",
    judged: true,
    item: "direction",
    workload,
    items: 1 << 16,
    checked: 1 << 12,
    oracle,
    variants: &[
        Variant::new(
            "plain_f32",
            "one thread, the polynomials term by term",
            Dtype::F32,
            Tolerance::f32(),
            plain,
        ),
        Variant::new(
            "vectorized",
            "one thread, common products shared",
            Dtype::F32,
            Tolerance::f32(),
            shared,
        ),
        Variant::new("threaded", "the same on all threads", Dtype::F32, Tolerance::f32(), |a| {
            threaded(a, |x| x, |x| x)
        }),
        Variant::new(
            "bf16",
            "the same, results stored as bf16: half the memory",
            Dtype::Bf16,
            Tolerance::f32().stored(BF16),
            |a| threaded(a, to_bf16, from_bf16),
        ),
    ],
};
