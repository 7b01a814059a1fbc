//! The f32 path against the oracle.

use approx::assert_abs_diff_eq;
use pulp::Arch;

use super::*;
use crate::hash_grid::tests::{points, random_levels};
use crate::hash_grid::{Level as Oracle, backward, encode};
use crate::optimizer::{Adam, Moments, adam_step};

fn fast_levels(levels: &[Oracle]) -> Vec<Level> {
    let convert = |level: &Oracle| {
        let table = level.table.rows().into_iter().map(|e| std::array::from_fn(|f| e[f] as f32)).collect();
        Level::new(level.scale as u32, table, level.dense())
    };
    levels.iter().map(convert).collect()
}

const SIDES: [u32; LEVELS] = [2, 3, 5, 7, 11, 19, 40, 90];

/// Corner coordinates are exact in both, so that only the weights' and the sums' roundings differ: 8 products of 4 factors.
#[test]
fn fast_path_agrees() {
    let levels = random_levels(&SIDES, 512);
    let fast = fast_levels(&levels);
    let exact: Vec<[f64; 3]> =
        points(1000).into_iter().chain([[0.0; 3], [1.0; 3], [1.0, 0.0, 0.5]]).collect();
    let points: Vec<[f32; 3]> = exact.iter().map(|p| p.map(|x| x as f32)).collect();
    for arch in [crate::simd::arch(), Arch::Scalar] {
        let mut out = vec![vec![[0.0; FEATURES]; points.len()]; LEVELS];
        for (level, out) in fast.iter().zip(&mut out) {
            encode_level(arch, level, level.table(), &points, out);
        }
        for (n, p) in exact.iter().enumerate() {
            for (a, b) in encode(&levels, *p).iter().zip(out.iter().flat_map(|level| &level[n])) {
                assert_abs_diff_eq!(*a, f64::from(*b), epsilon = 16.0 * f64::from(f32::EPSILON));
            }
        }
    }
}

#[test]
fn fast_gradient_agrees() {
    let levels = random_levels(&SIDES, 512);
    let exact = points(100);
    let points: Vec<[f32; 3]> = exact.iter().map(|p| p.map(|x| x as f32)).collect();
    let g_out: Vec<[f32; WIDTH]> =
        (0..100).map(|i| std::array::from_fn(|c| ((i * 7 + c * 3) % 17) as f32 / 16.0 - 0.5)).collect();
    let mut expected = levels.clone();
    expected.iter_mut().for_each(|l| l.table.fill(0.0));
    for (p, g) in exact.iter().zip(&g_out) {
        backward::encode(&levels, *p, &g.map(f64::from), &mut expected);
    }
    for arch in [crate::simd::arch(), Arch::Scalar] {
        let fast = fast_levels(&levels);
        for l in 0..LEVELS {
            let g_level: Vec<Entry> = g_out.iter().map(|g| g.as_chunks().0[l]).collect();
            let mut gradient = Gradient::default();
            scatter(arch, &fast[l], &points, &g_level, &mut gradient);
            for (entry, got) in expected[l].table.rows().into_iter().zip(gradient.entries()) {
                for f in 0..FEATURES {
                    // At most 800 terms below 1/2 meet in one entry.
                    assert_abs_diff_eq!(
                        entry[f],
                        f64::from(got[f]),
                        epsilon = 800.0 * f64::from(f32::EPSILON)
                    );
                }
            }
        }
    }
}

/// Three sparse steps: entries with a gradient follow the oracle's Adam, the others don't move. A larger level has used the gradient
/// before, and left nothing in it.
#[test]
fn sparse_adam_agrees() {
    let levels = random_levels(&SIDES, 512);
    let adam = Adam { lr: 1e-2, beta1: 0.9, beta2: 0.99, eps: 1e-15, weight_decay: 0.0 };
    let points = [[0.1, 0.2, 0.3], [0.8, 0.5, 0.9]];
    for arch in [crate::simd::arch(), Arch::Scalar] {
        let l = 6;
        let mut fast = fast_levels(&levels);
        let (mut gradient, rates) = (Gradient::default(), Rates::new(&adam, 1));
        scatter(arch, &fast[LEVELS - 1], &points, &[[1.0; FEATURES]; 2], &mut gradient);
        update(arch, &mut fast[LEVELS - 1], &mut gradient, rates);
        let mut level = fast.swap_remove(l);
        let mut expected: Vec<Moments> = level
            .table()
            .as_flattened()
            .iter()
            .map(|&p| Moments { param: f64::from(p), m: 0.0, v: 0.0 })
            .collect();
        for step in 1..=3 {
            scatter(arch, &level, &points, &[[0.25 * step as f32; FEATURES]; 2], &mut gradient);
            let mut moved = 0;
            for (e, &g) in expected.iter_mut().zip(gradient.entries().as_flattened()) {
                if g != 0.0 {
                    *e = adam_step(&adam, *e, f64::from(g), step);
                    moved += 1;
                }
            }
            assert!((4..=64).contains(&moved), "{moved}");
            update(arch, &mut level, &mut gradient, Rates::new(&adam, step));
            assert!(gradient.entries().as_flattened().iter().all(|&g| g == 0.0));
        }
        for (e, &p) in expected.iter().zip(level.table().as_flattened()) {
            assert_abs_diff_eq!(e.param, f64::from(p), epsilon = 1e-6);
        }
    }
}
