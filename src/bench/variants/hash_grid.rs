//! Variants of the hash grid for `bench`: 8 levels of 4 features from 16 to 512 cells, tables of at most 2^17 entries.

use half::f16;
use ndarray::Array2;
use pulp::{Simd, WithSimd};

use crate::approximate::{from_bf16, to_bf16};
use crate::bench::{BF16, F16, Kernel, Scaling, Suite, Tolerance, Variant, kernel, rows, singles, uniform};
use crate::contract::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, values};
use crate::hash_grid::fast::{BLOCK, Entry, FEATURES, LEVELS, Level, WIDTH, encode_level};
use crate::hash_grid::{corner, is_dense, resolutions};
use crate::parallel;
use crate::random::{Key, Purpose};
use crate::simd::multiply_add;

const TABLE: usize = 1 << 17;
/// Points of a task.
const TASK: usize = 1024;

/// Points of the unit box. The tables are the same for all: see [`table`].
fn workload(items: usize) -> Arrays {
    arrays([("points", array(&[items, 3], uniform(12, 3 * items, 0.0, 1.0)))])
}

/// Level l's resolution and table: numbers of f32 in [-1, 1).
fn table(l: usize, largest: usize) -> (u32, Vec<Entry>) {
    let resolution = resolutions(16, 512, LEVELS)[l];
    let side = resolution as usize + 1;
    let entries = if is_dense(resolution, largest) { side * side * side } else { largest };
    let u = Key::new(3, Purpose::HashTable).uniforms(0, l as u64, entries * FEATURES);
    (resolution, u.as_chunks::<FEATURES>().0.iter().map(|u| u.map(|u| (2.0 * u - 1.0) as f32)).collect())
}

fn levels(largest: usize) -> Vec<Level> {
    let level = |l| {
        let (resolution, table) = table(l, largest);
        Level::new(resolution, table, is_dense(resolution, largest))
    };
    (0..LEVELS).map(level).collect()
}

fn oracle(a: &Arrays) -> Box<dyn Kernel> {
    let level = |l| {
        let (resolution, table) = table(l, TABLE);
        let table: Vec<_> = table.iter().map(|e| e.map(f64::from)).collect();
        crate::hash_grid::Level::new(resolution, table.into())
    };
    let levels: Vec<crate::hash_grid::Level> = (0..LEVELS).map(level).collect();
    let run = move |x: &[f64], out: &mut [f64]| {
        for (x, out) in x.as_chunks::<3>().0.iter().zip(out.chunks_exact_mut(WIDTH)) {
            out.copy_from_slice(&crate::hash_grid::encode(&levels, *x));
        }
    };
    rows("features", (values(a, "points"), 3, WIDTH), run, |&y| y)
}

/// The oracle's loops in f32: a point, a level, a corner at a time.
fn plain(a: &Arrays) -> Box<dyn Kernel> {
    let tables: Vec<(crate::hash_grid::Level, Vec<Entry>)> = (0..LEVELS)
        .map(|l| {
            let (resolution, entries) = table(l, TABLE);
            // The oracle's level, for its addresses alone.
            (crate::hash_grid::Level::new(resolution, Array2::zeros([entries.len(), 0])), entries)
        })
        .collect();
    let run = move |x: &[f32], out: &mut [f32]| {
        for (x, out) in x.as_chunks::<3>().0.iter().zip(out.chunks_exact_mut(WIDTH)) {
            for ((level, entries), out) in tables.iter().zip(out.chunks_exact_mut(FEATURES)) {
                let cells = x.map(|x| {
                    let (low, _) = level.cell(x.into());
                    (low, x * level.scale as f32 - low as f32)
                });
                out.fill(0.0);
                for k in 0..8 {
                    let (vertex, _) = corner(k, cells.map(|(low, _)| (low, 0.0)));
                    let along = |a: usize| if k >> a & 1 == 1 { cells[a].1 } else { 1.0 - cells[a].1 };
                    let weight = along(0) * along(1) * along(2);
                    for (out, entry) in out.iter_mut().zip(entries[level.entry(vertex)]) {
                        *out += weight * entry;
                    }
                }
            }
        }
    };
    rows("features", (singles(a, "points"), 3, WIDTH), run, |&y| y.into())
}

/// Points of the vectorized path, with their features level by level.
struct Part {
    points: Vec<[f32; 3]>,
    out: [Vec<Entry>; LEVELS],
}

fn by_level(
    a: &Arrays,
    threads: bool,
    bytes: usize,
    encode: impl Fn(usize, &[[f32; 3]], &mut [Entry]) + Sync + Send + 'static,
) -> Box<dyn Kernel> {
    let points = singles(a, "points").as_chunks::<3>().0.to_vec();
    let bytes = bytes + points.len() * (size_of::<[f32; 3]>() + LEVELS * size_of::<Entry>());
    let part = |points: &[[f32; 3]]| Part {
        points: points.to_vec(),
        out: std::array::from_fn(|_| vec![[0.0; FEATURES]; points.len()]),
    };
    let parts: Vec<Part> = points.chunks(TASK).map(part).collect();
    let run = move |parts: &mut Vec<Part>| {
        // A thread's share of all points, so that a level's table stays in its cache.
        let share = parts.len().div_ceil(parallel::threads());
        let work = |parts: &mut [Part]| {
            for l in 0..LEVELS {
                parts.iter_mut().for_each(|part| encode(l, &part.points, &mut part.out[l]));
            }
        };
        if threads { parallel::for_chunks(parts, share, |_, parts| work(parts)) } else { work(parts) }
    };
    kernel(parts, bytes, run, |parts| {
        let row = |part: &Part, n: usize| part.out.each_ref().map(|level| level[n].map(f64::from));
        let rows = parts.iter().flat_map(|part| (0..part.points.len()).map(move |n| row(part, n)));
        let features: Vec<f64> = rows.flat_map(|row| row.as_flattened().to_vec()).collect();
        arrays([("features", array(&[features.len() / WIDTH, WIDTH], features))])
    })
}

fn vectorized(a: &Arrays, threads: bool, largest: usize) -> Box<dyn Kernel> {
    let (arch, levels) = (crate::simd::arch(), levels(largest));
    let bytes = levels.iter().map(|level| size_of_val(level.table())).sum();
    by_level(a, threads, bytes, move |l, points, out| {
        encode_level(arch, &levels[l], levels[l].table(), points, out)
    })
}

/// A table of short numbers with the addresses of a level.
struct Short<'a, T, W> {
    level: &'a Level,
    table: &'a [[T; FEATURES]],
    wide: W,
    points: &'a [[f32; 3]],
    out: &'a mut [Entry],
}

impl<T: Copy, W: Fn(T) -> f32 + Copy> WithSimd for Short<'_, T, W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (mut index, mut weight) = ([[0; BLOCK]; 8], [[0.0; BLOCK]; 8]);
        for (points, out) in self.points.chunks(BLOCK).zip(self.out.chunks_mut(BLOCK)) {
            self.level.corners(points, &mut index, &mut weight);
            for (i, out) in out.iter_mut().enumerate().take(points.len()) {
                let mut sum = [0f32; FEATURES];
                for corner in 0..8 {
                    let entry = self.table[index[corner][i] as usize].map(self.wide);
                    for f in 0..FEATURES {
                        sum[f] = multiply_add::<S>(weight[corner][i], entry[f], sum[f]);
                    }
                }
                *out = sum;
            }
        }
    }
}

/// f16 bits as f32, exact for all finite numbers, without a branch or a call: the exponent's bias by a product.
#[inline(always)]
fn wide_f16(bits: u16) -> f32 {
    let (sign, size) = (u32::from(bits & 0x8000) << 16, u32::from(bits & 0x7fff) << 13);
    let scaled = f32::from_bits(size) * f32::from_bits((254 - 15) << 23);
    f32::from_bits(scaled.to_bits() | sign)
}

fn short<T: Copy + Send + Sync + 'static>(
    a: &Arrays,
    store: fn(f32) -> T,
    wide: impl Fn(T) -> f32 + Copy + Send + Sync + 'static,
) -> Box<dyn Kernel> {
    let (arch, levels) = (crate::simd::arch(), levels(TABLE));
    let tables: Vec<Vec<[T; FEATURES]>> =
        levels.iter().map(|level| level.table().iter().map(|e| e.map(store)).collect()).collect();
    let bytes = tables.iter().map(|table| size_of_val(&table[..])).sum();
    by_level(a, true, bytes, move |l, points, out| {
        let (level, table) = (&levels[l], &tables[l][..]);
        arch.dispatch(Short { level, table, wide, points, out });
    })
}

/// The error of f32: a position is rounded against 512 cells (2^-24 of 512 cells is 2^-15 of a cell, for each of three axes, and
/// neighbors differ by at most 2), and 8 corners are added up, each with a few roundings.
const F32: Tolerance = Tolerance::exact().within(3.0 * 2.0 / 32768.0 + 20.0 / 16_777_216.0);

/// The hash grid's suite.
pub(crate) const SUITE: Suite = Suite {
    component: "hash_grid",
    judged: false,
    item: "point",
    workload,
    items: 1 << 15,
    checked: 1 << 12,
    oracle,
    variants: &[
        Variant::new(
            "plain_f32",
            "one thread, a point, a level and a corner at a time",
            Dtype::F32,
            F32,
            plain,
        ),
        Variant::new(
            "vectorized",
            "one thread, level by level, addresses and weights of 16 points together",
            Dtype::F32,
            F32,
            |a| vectorized(a, false, TABLE),
        ),
        Variant::new("threaded", "the same on all threads", Dtype::F32, F32, |a| vectorized(a, true, TABLE)),
        Variant::new(
            "bf16_table",
            "threaded, features stored as bf16: half the cache",
            Dtype::Bf16,
            F32.of_largest(BF16),
            |a| short(a, to_bf16, from_bf16),
        ),
        Variant::new("f16_table", "threaded, features stored as f16", Dtype::F16, F32.of_largest(F16), |a| {
            short(a, |x| f16::from_f32(x).to_bits(), wide_f16)
        }),
    ],
};

/// Time and memory against points and against the table's size.
pub(crate) const SCALING: &[Scaling] = &[
    Scaling {
        component: "hash_grid",
        parameter: "points",
        about: "threaded, 8 levels, tables of 2^17 entries",
        values: &[4096.0, 8192.0, 16384.0, 32768.0, 65536.0],
        prepare: |points| vectorized(&workload(points as usize), true, TABLE),
        memory: false,
    },
    Scaling {
        component: "hash_grid",
        parameter: "table",
        about: "threaded, 16,384 points, against entries of a table: work stays, until tables leave the caches",
        values: &[4096.0, 16384.0, 65536.0, 262_144.0, 1_048_576.0],
        prepare: |entries| vectorized(&workload(16384), true, entries as usize),
        memory: true,
    },
];
