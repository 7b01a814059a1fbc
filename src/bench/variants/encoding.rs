//! Variants of the positional encoding for `bench`: 10 bands of 3 dimensions.

use pulp::{Simd, WithSimd};

use crate::approximate::{Grade, from_bf16, sin_cos_pi, to_bf16};
use crate::bench::{BF16, Kernel, Scaling, Suite, Tolerance, Variant, rows, singles, uniform};
use crate::contract::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, scalar, values};
use crate::convention::CS180;
use crate::encoding::fast;
use crate::parallel;

const LEVELS: usize = 10;
const WIDTH: usize = 3 + 6 * LEVELS;
/// Points of a task.
const TASK: usize = 1024;

/// Points of [-1, 1]^3.
fn workload(items: usize) -> Arrays {
    arrays([("x", array(&[items, 3], uniform(0, 3 * items, -1.0, 1.0))), ("L", scalar(LEVELS as f64))])
}

fn oracle(a: &Arrays) -> Box<dyn Kernel> {
    let encoding = crate::encoding::Encoding::new(LEVELS, &CS180);
    let run = move |x: &[f64], out: &mut [f64]| {
        for (x, out) in x.chunks_exact(3).zip(out.chunks_exact_mut(WIDTH)) {
            out.copy_from_slice(&crate::encoding::positional_encoding(x, &encoding));
        }
    };
    rows("encoding", (values(a, "x"), 3, WIDTH), run, |&y| y)
}

/// The straightforward code: sin(2^k pi x) of the library, the product rounded.
fn plain(a: &Arrays) -> Box<dyn Kernel> {
    let run = |x: &[f32], out: &mut [f32]| {
        for (x, out) in x.chunks_exact(3).zip(out.chunks_exact_mut(WIDTH)) {
            out[..3].copy_from_slice(x);
            for k in 0..LEVELS {
                let factor = std::f32::consts::PI * (1 << k) as f32;
                for d in 0..3 {
                    out[3 + 6 * k + d] = (factor * x[d]).sin();
                    out[6 + 6 * k + d] = (factor * x[d]).cos();
                }
            }
        }
    };
    rows("encoding", (singles(a, "x"), 3, WIDTH), run, |&y| y.into())
}

fn vectorized(a: &Arrays) -> Box<dyn Kernel> {
    let run =
        |x: &[f64], out: &mut [f32]| fast::positional_encoding(crate::simd::arch(), x, 3, LEVELS, out, WIDTH);
    rows("encoding", (values(a, "x"), 3, WIDTH), run, |&y| y.into())
}

fn threaded(a: &Arrays) -> Box<dyn Kernel> {
    let run = |x: &[f64], out: &mut [f32]| {
        parallel::for_chunks(out, TASK * WIDTH, |n, out| {
            let from = n * TASK * 3;
            let x = &x[from..from + out.len() / WIDTH * 3];
            fast::positional_encoding(crate::simd::arch(), x, 3, LEVELS, out, WIDTH);
        });
    };
    rows("encoding", (values(a, "x"), 3, WIDTH), run, |&y| y.into())
}

/// The replacement of the exact sine.
#[derive(Clone, Copy)]
enum Trade {
    Sine(Grade),
    /// One sine and cosine a dimension; each further band by doubling the angle.
    Doubling,
}

/// Points that are encoded together.
const BLOCK: usize = 64;

struct Block<'a, T> {
    x: &'a [f32],
    out: &'a mut [T],
    trade: Trade,
    store: fn(f32) -> T,
}

impl<T: Copy> WithSimd for Block<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Block { x, out, trade, store } = self;
        let (mut column, mut sin, mut cos) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        for d in 0..3 {
            for ((c, x), row) in column.iter_mut().zip(x.chunks_exact(3)).zip(out.chunks_exact_mut(WIDTH)) {
                *c = x[d];
                row[d] = store(x[d]);
            }
            for k in 0..LEVELS {
                for ((c, sin), cos) in column.iter_mut().zip(&mut sin).zip(&mut cos) {
                    (*sin, *cos) = match trade {
                        Trade::Sine(Grade::Low) => sin_cos_pi(*c, Grade::Low),
                        Trade::Sine(Grade::Middle) => sin_cos_pi(*c, Grade::Middle),
                        Trade::Sine(Grade::Full) => sin_cos_pi(*c, Grade::Full),
                        Trade::Doubling if k == 0 => sin_cos_pi(*c, Grade::Middle),
                        Trade::Doubling => (2.0 * *sin * *cos, (*cos - *sin) * (*cos + *sin)),
                    };
                    *c *= 2.0;
                }
                let at = 3 * (1 + 2 * k) + d;
                for ((row, sin), cos) in out.chunks_exact_mut(WIDTH).zip(sin).zip(cos) {
                    row[at] = store(sin);
                    row[at + 3] = store(cos);
                }
            }
        }
    }
}

fn traded<T: Copy + Default + Send + 'static>(
    a: &Arrays,
    trade: Trade,
    store: fn(f32) -> T,
    load: fn(T) -> f32,
) -> Box<dyn Kernel> {
    let run = move |x: &[f32], out: &mut [T]| {
        let arch = crate::simd::arch();
        parallel::for_chunks(out, TASK * WIDTH, |n, out| {
            let x = &x[n * TASK * 3..][..out.len() / WIDTH * 3];
            for (x, out) in x.chunks(3 * BLOCK).zip(out.chunks_mut(BLOCK * WIDTH)) {
                arch.dispatch(Block { x, out, trade, store });
            }
        });
    };
    rows("encoding", (singles(a, "x"), 3, WIDTH), run, move |&y| load(y).into())
}

/// The encoding's suite.
pub(crate) const SUITE: Suite = Suite {
    component: "positional_encoding",
    judged: true,
    item: "point",
    workload,
    items: 1 << 15,
    checked: 1 << 12,
    oracle,
    variants: &[
        Variant {
            name: "plain_f32",
            about: "one thread, sin(2^k pi x) of the library, the product rounded to f32",
            dtype: Dtype::F32,
            tolerance: Tolerance::f32(),
            prepare: plain,
        },
        Variant {
            name: "vectorized",
            about: "one thread, exact reduction in f64, short polynomials over 64 points at a time",
            dtype: Dtype::F32,
            tolerance: Tolerance::f32(),
            prepare: vectorized,
        },
        Variant {
            name: "threaded",
            about: "the same on all threads",
            dtype: Dtype::F32,
            tolerance: Tolerance::f32(),
            prepare: threaded,
        },
        Variant {
            name: "sine_32_ulp",
            about: "all threads, exact reduction in f32, sine within 32 ULP",
            dtype: Dtype::F32,
            tolerance: Tolerance::grade(Grade::Middle.sin_ulp()),
            prepare: |a| traded(a, Trade::Sine(Grade::Middle), |x| x, |x| x),
        },
        Variant {
            name: "sine_8192_ulp",
            about: "all threads, exact reduction in f32, sine within 8,192 ULP (11 bits)",
            dtype: Dtype::F32,
            tolerance: Tolerance::grade(Grade::Low.sin_ulp()),
            prepare: |a| traded(a, Trade::Sine(Grade::Low), |x| x, |x| x),
        },
        Variant {
            name: "doubling",
            about: "all threads, one sine of 32 ULP a dimension, then sin 2a = 2 sin a cos a: errors double with each band",
            dtype: Dtype::F32,
            // 32 ULP doubled 9 times, as phase and as length.
            tolerance: Tolerance::f32().within(2.0 * 32.0 * 512.0 / 16_777_216.0),
            prepare: |a| traded(a, Trade::Doubling, |x| x, |x| x),
        },
        Variant {
            name: "sine_8192_ulp_bf16",
            about: "the sine of 8,192 ULP, stored as bf16: half the memory",
            dtype: Dtype::Bf16,
            tolerance: Tolerance::grade(Grade::Low.sin_ulp()).stored(BF16),
            prepare: |a| traded(a, Trade::Sine(Grade::Low), to_bf16, from_bf16),
        },
    ],
};

/// Time and memory against the number of points.
pub(crate) const SCALING: &[Scaling] = &[Scaling {
    component: "positional_encoding",
    parameter: "points",
    about: "threaded, 10 bands",
    values: &[4096.0, 8192.0, 16384.0, 32768.0, 65536.0],
    prepare: |points| threaded(&workload(points as usize)),
    memory: true,
}];
