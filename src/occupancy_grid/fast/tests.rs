//! The f32 traversal against the oracle.

use approx::assert_abs_diff_eq;
use pulp::Arch;

use super::*;
use crate::convention::GridThreshold;
use crate::occupancy_grid::OccupancyGrid;
use crate::occupancy_grid::tests::{key, random_grid, ray};

/// The f32 traversal visits what the oracle visits, except for lattice points within rounding of a face or of an end: one ray
/// alone, lanes that are partly filled, and lanes that are refilled.
#[test]
fn fast_traversal_agrees() {
    let oracle = random_grid(16, 0.2);
    let mut grid = Occupancy::full(16);
    grid.density = oracle.density.iter().map(|&x| x as f32).collect();
    grid.apply_threshold(oracle.threshold as f32);
    let (mut checked, mut skipped) = (0, 0);
    let step = f64::from(0.004f32);
    let numbers: Vec<u64> = (0..500).collect();
    let mut steps = Steps::default();
    for numbers in numbers.chunk_by(|_, b| ![1, 10, 80, 300].contains(b)) {
        let arch = if numbers[0] == 80 { Arch::Scalar } else { crate::simd::arch() };
        let march_rays: Vec<_> = numbers.iter().map(|&i| march_ray(i, u32::MAX)).collect();
        grid.march(arch, &march_rays, step as f32, &mut steps);
        for (lane, (&i, march_ray)) in numbers.iter().zip(&march_rays).enumerate() {
            let (o, d, near, far) = ray(i);
            let u = f64::from(march_ray.u);
            let got: Vec<i64> = steps.of(lane).iter().map(|&k| k as i64).collect();
            let mut k = (near / step - u).ceil();
            while (k + u) * step < far {
                let t = (k + u) * step;
                let x = [0, 1, 2].map(|a| o[a] + t * d[a]);
                let to_face =
                    x.map(|x| (16.0 * x - (16.0 * x).round()).abs()).into_iter().fold(1.0, f64::min);
                let to_end = ((t - near) / step).min((far - t) / step);
                if to_face > 1e-3 && to_end > 1e-3 {
                    assert_eq!(got.contains(&(k as i64)), oracle.occupied(x), "ray {i}, k {k}, x {x:?}");
                    let at = march_ray.at(k as f32, step as f32);
                    (0..3).for_each(|a| assert_abs_diff_eq!(f64::from(at[a]), x[a], epsilon = 1e-5));
                    checked += 1;
                } else {
                    skipped += 1;
                }
                k += 1.0;
            }
        }
    }
    assert!(checked > 10_000 && skipped < checked / 20, "{checked} {skipped}");
}

fn march_ray(i: u64, patience: u32) -> MarchRay {
    let (o, d, near, far) = ray(i);
    let f = |v: [f64; 3]| v.map(|x| x as f32);
    MarchRay {
        o: f(o),
        d: f(d),
        near: near as f32,
        far: far as f32,
        u: key().uniform(2, i, 0) as f32,
        patience,
    }
}

/// A ray ends after `patience` samples in opaque cells; up to there, its samples are those with more patience.
#[test]
fn patience_ends_a_ray() {
    let mut grid = Occupancy::full(16);
    grid.density = random_grid(16, 0.2).density.iter().map(|&x| x as f32).collect();
    grid.apply_thresholds([0.3, 0.6]);
    let [_, opaque] = grid.bits();
    let is_opaque = |p: [f32; 3]| {
        let [x, y, z] = p.map(|x| ((16.0 * x) as usize).min(15));
        opaque[(z / 4 * 4 + y / 4) * 4 + x / 4] >> (z % 4 * 16 + y % 4 * 4 + x % 4) & 1 == 1
    };
    let (mut all, mut some, mut cut) = (Steps::default(), Steps::default(), 0);
    for first in (0..500).step_by(50) {
        let [march_rays, short] =
            [u32::MAX, 25].map(|p| (first..first + 50).map(|i| march_ray(i, p)).collect::<Vec<_>>());
        grid.march(crate::simd::arch(), &march_rays, 0.004, &mut all);
        grid.march(crate::simd::arch(), &short, 0.004, &mut some);
        for (lane, march_ray) in march_rays.iter().enumerate() {
            let mut left = 25;
            let patient = all.of(lane).iter().take_while(|k| {
                let before = left;
                left -= usize::from(left > 0 && is_opaque(march_ray.at(**k, 0.004)));
                before > 0
            });
            let patient: Vec<f32> = patient.copied().collect();
            assert_eq!(some.of(lane), patient);
            assert_eq!(some.cut(lane), left == 0);
            assert!(!all.cut(lane));
            cut += usize::from(left == 0);
        }
    }
    assert!((50..480).contains(&cut), "{cut}");
}

/// Between the ends of the span a ray meets all the occupied cells that it meets in the box; a ray that passes by has none.
#[test]
fn a_span_holds_all_occupied_cells() {
    let mut grid = Occupancy::full(64);
    for z in 20..31 {
        for y in 0..7 {
            (40..45).for_each(|x| grid.density[(z * 64 + y) * 64 + x] = 1.0);
        }
    }
    grid.apply_threshold(0.5);
    let (mut met, mut passed) = (0, 0);
    let [mut all, mut some] = [(); 2].map(|()| Steps::default());
    for i in 0..5000 {
        let whole = march_ray(i, u32::MAX);
        let (near, far) = grid.span(whole.o, whole.d);
        let part = MarchRay { near: near.max(whole.near), far: far.min(whole.far), ..whole };
        // The ray alone, and among others.
        grid.march(crate::simd::arch(), &[whole], 0.004, &mut all);
        grid.march(crate::simd::arch(), &[part; 40], 0.004, &mut some);
        assert!((0..40).all(|n| some.of(n) == some.of(0)));
        assert_eq!(all.of(0), some.of(0), "ray {i}");
        met += usize::from(!all.of(0).is_empty());
        passed += usize::from(near > far);
    }
    assert!(met > 50 && passed > 3000, "{met} {passed}");
    let [occupied, opaque] = grid.bits();
    let parts = Occupancy::from_parts(64, grid.density.clone(), &occupied, &opaque);
    assert!(parts.as_ref() == Some(&grid), "blocks and bounds follow from the bits");
    grid.apply_threshold(2.0);
    let (near, far) = grid.span([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0]);
    assert!(near > far, "nothing is occupied");
}

/// Rays along an axis, whose other speeds are 0, on a face of cells too: by hand, in a grid of 16 cells with one occupied.
#[test]
fn rays_along_an_axis() {
    let mut grid = Occupancy::full(16);
    grid.density[(3 * 16 + 2) * 16 + 5] = 1.0;
    grid.apply_threshold(0.5);
    let mut steps = Steps::default();
    // Cell (5, 2, 3) is [5, 6) x [2, 3) x [3, 4) sixteenths; samples at (k + 1/2) / 64, four to a cell.
    let march_ray =
        |o: [f32; 3], d: [f32; 3]| MarchRay { o, d, near: 0.0, far: 1.0, u: 0.5, patience: u32::MAX };
    let sixteenths = |x: [f32; 3]| x.map(|x| x / 16.0);
    let march_rays = [
        march_ray(sixteenths([0.0, 2.5, 3.5]), [1.0, 0.0, 0.0]),
        march_ray(sixteenths([16.0, 2.0, 3.0]), [-1.0, 0.0, 0.0]),
        march_ray(sixteenths([5.5, 0.0, 3.5]), [0.0, 1.0, 0.0]),
        march_ray(sixteenths([5.5, 2.5, 0.0]), [0.0, 0.0, 1.0]),
        march_ray(sixteenths([0.0, 3.0, 3.5]), [1.0, 0.0, 0.0]),
    ];
    for arch in [crate::simd::arch(), Arch::Scalar] {
        grid.march(arch, &march_rays, 1.0 / 64.0, &mut steps);
        let found: Vec<&[f32]> = (0..5).map(|ray| steps.of(ray)).collect();
        let none: &[f32] = &[];
        assert_eq!(
            found,
            [
                &[20.0, 21.0, 22.0, 23.0][..],
                &[40.0, 41.0, 42.0, 43.0],
                &[8.0, 9.0, 10.0, 11.0],
                &[12.0, 13.0, 14.0, 15.0],
                none
            ]
        );
    }
}

#[test]
fn fast_box_agrees() {
    for i in 0..500 {
        let (o, d, near, far) = ray(i);
        let (enter, leave) = ray_box(o.map(|x| x as f32), d.map(|x| x as f32));
        assert_abs_diff_eq!(f64::from(enter).max(0.0), near, epsilon = 1e-5);
        assert_abs_diff_eq!(f64::from(leave), far, epsilon = 1e-5);
    }
    let (enter, leave) = ray_box([0.5, 1.5, 0.5], [1.0, 0.0, 0.0]);
    assert!(enter > leave);
    assert_eq!(ray_box([-1.0, 1.0, 0.5], [1.0, 0.0, 0.0]), (1.0, 2.0));
}

/// Only cells that were looked at change, and none that is hidden; the next update begins anew.
#[test]
fn an_update_changes_what_was_looked_at() {
    let mut fast = Occupancy::full(16);
    let cell = |x: f32| fast.cell([x; 3]);
    let (once, twice, hidden) = (cell(0.1), cell(0.5), cell(0.9));
    fast.density.fill(1.0);
    fast.hide(|cell| cell == hidden);
    fast.raise(&[[0.1; 3], [0.5; 3], [0.9; 3]], &[0.25, 3.0, 9.0]);
    fast.raise(&[[0.5; 3]], &[2.0]);
    fast.update(0.5);
    assert_eq!([once, twice, hidden, 1].map(|cell| fast.density[cell]), [0.5, 3.0, -1.0, 1.0]);
    fast.update(0.5);
    assert_eq!(fast.density[once], 0.5, "nobody looked since");
}

/// The threshold is the oracle's, for thin, empty and dense fields, and opens the same cells.
#[test]
fn the_threshold_is_the_oracles() {
    for four in
        [[0.0, 0.0, -1.0, 0.0], [0.5, 0.5, -1.0, 0.5], [0.125, 0.25, 0.0, -1.0], [8.0, 0.25, 0.0, 2.0]]
    {
        for limit in [0.01, 0.3, 1e9] {
            let oracle = OccupancyGrid { resolution: 16, density: four.repeat(1024), threshold: 0.0 };
            let threshold = oracle.threshold_below(limit, GridThreshold::MeanOfDense);
            let mut fast = Occupancy::full(16);
            fast.density = oracle.density.iter().map(|&d| d as f32).collect();
            assert_eq!(fast.threshold(limit as f32), threshold as f32);
            fast.apply_threshold(fast.threshold(limit as f32));
            let open: Vec<u32> =
                (0..4096).filter(|&cell| oracle.density[cell as usize] > threshold).collect();
            let mut found = fast.occupied_cells();
            found.sort_unstable();
            assert_eq!(found, open);
            assert!((0..4096).all(|cell| fast.occupied(cell) == open.contains(&(cell as u32))));
        }
    }
}
