//! Closed forms and properties of the occupancy grid, and the f32 traversal against the oracle.

use approx::assert_abs_diff_eq;
use pulp::Arch;

use super::{Crossing, OccupancyGrid, fast};
use crate::random::{Key, Purpose};
use crate::ray_aabb;

fn key() -> Key {
    Key::new(11, Purpose::Cases)
}

/// A grid with about `share` of the cells occupied, in clumps of 2^3 so that bricks are full, mixed and empty.
fn random_grid(resolution: usize, share: f64) -> OccupancyGrid {
    let half = resolution / 2;
    let clump =
        |i: usize| (i % resolution / 2, i / resolution % resolution / 2, i / resolution / resolution / 2);
    let density = |i| {
        let (x, y, z) = clump(i);
        key().uniform(1, 0, (x + half * (y + half * z)) as u64)
    };
    let density = (0..resolution.pow(3)).map(density).collect();
    OccupancyGrid { resolution, density, threshold: 1.0 - share }
}

/// A random ray that meets the unit box, and where.
fn ray(i: u64) -> ([f64; 3], [f64; 3], f64, f64) {
    let u = key().uniforms(0, i, 6);
    let target = [u[0], u[1], u[2]];
    let o = [6.0 * u[3] - 2.5, 6.0 * u[4] - 2.5, 6.0 * u[5] - 2.5].map(|x| f64::from(x as f32));
    let d = [0, 1, 2].map(|a| f64::from((target[a] - o[a]) as f32));
    let hit = ray_aabb::intersect(o, d, [0.0; 3], [1.0; 3]).expect("the target is inside");
    (o, d, hit.enter.max(0.0), hit.leave)
}

#[test]
fn crossings_cover_the_ray_once() {
    let grid = random_grid(8, 0.3);
    for i in 0..500 {
        let (o, d, near, far) = ray(i);
        let cells = grid.crossings(o, d, near, far);
        assert_eq!((cells[0].enter, cells.last().unwrap().leave), (near, far));
        for pair in cells.windows(2) {
            assert_eq!(pair[0].leave, pair[1].enter);
            // Neighbors share a face: exactly one index differs, by one.
            let distance = [1, 8, 64].map(|n| (pair[0].cell / n % 8).abs_diff(pair[1].cell / n % 8));
            assert_eq!(distance.iter().sum::<usize>(), 1, "{pair:?}");
        }
        for c in cells.iter().filter(|c| c.leave - c.enter > 1e-9) {
            let t = c.enter + 0.3 * (c.leave - c.enter);
            assert_eq!(grid.cell([0, 1, 2].map(|a| o[a] + t * d[a])), c.cell);
        }
    }
}

/// CG3 (nerfacc issue 265): from a cell face, almost along another face, all 32 cells are visited.
#[test]
fn starts_on_a_face() {
    let grid = OccupancyGrid { resolution: 32, density: vec![0.0; 32 * 32 * 32], threshold: 0.5 };
    for dy in [-1e-16, 0.0, 1e-16] {
        let cells = grid.crossings([1.0, 0.0, 0.0], [-1.0, dy, 0.0], 0.0, 1.0);
        assert_eq!(cells.iter().map(|c| c.cell).collect::<Vec<_>>(), (0..32).rev().collect::<Vec<_>>());
    }
    // Through a vertex, along the diagonal: one cell each, whatever order the three faces come in.
    let diagonal = grid.crossings([0.0; 3], [1.0; 3], 0.0, 1.0);
    assert_eq!(diagonal.len(), 32);
}

#[test]
fn update_decays_and_rises() {
    let mut grid = OccupancyGrid { resolution: 2, density: vec![1.0; 8], threshold: 0.6 };
    grid.update(0.5, &[[0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.9, 0.1, 0.1]], &[2.0, 3.0, 0.1]);
    assert_eq!(grid.density, [3.0, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5]);
    assert!(grid.occupied([0.49, 0.0, 0.3]) && !grid.occupied([0.5, 0.0, 0.3]));
}

/// A ray that starts in a face and goes down is never in the cell above, and there is no crossing of length 0.
#[test]
fn cells_that_are_only_touched_are_not_crossed() {
    let grid = OccupancyGrid { resolution: 2, density: vec![0.0; 8], threshold: 0.5 };
    let down = grid.crossings([0.5, 0.25, 0.25], [-1.0, 0.0, 0.0], 0.0, 0.5);
    assert_eq!(down, [Crossing { cell: 0, enter: 0.0, leave: 0.5 }]);
    let up = grid.crossings([0.25, 0.25, 0.25], [1.0, 0.0, 0.0], 0.0, 0.25);
    assert_eq!(up, [Crossing { cell: 0, enter: 0.0, leave: 0.25 }]);
    assert_eq!(grid.crossings([0.25; 3], [1.0; 3], 0.125, 0.125), []);
}

/// All t = (k + u) step in [near, far): the near end belongs to it, the far end doesn't.
#[test]
fn samples_by_hand() {
    let mut grid = OccupancyGrid { resolution: 1, density: vec![1.0], threshold: 0.5 };
    let samples = |grid: &OccupancyGrid, near, far, u| {
        grid.samples([0.0, 0.5, 0.5], [1.0, 0.0, 0.0], near, far, 0.25, u)
    };
    assert_eq!(samples(&grid, 0.25, 0.75, 0.0), [0.25, 0.5]);
    assert_eq!(samples(&grid, 0.3, 1.0, 0.5), [0.375, 0.625, 0.875]);
    // A density equal to the threshold isn't above it.
    grid.density[0] = 0.5;
    assert!(samples(&grid, 0.25, 0.75, 0.0).is_empty() && !grid.occupied([0.5; 3]));
    // Two cells along x: of t = 1/8, 3/8, 5/8, 7/8 those past the middle.
    let half = OccupancyGrid { resolution: 2, density: [0.0, 1.0].repeat(4), threshold: 0.5 };
    assert_eq!(samples(&half, 0.0, 1.0, 0.5), [0.625, 0.875]);
    // Along y and z too.
    let at = |o, d| half.samples(o, d, 0.0, 1.0, 0.25, 0.5).len();
    assert_eq!([at([0.75, 0.0, 0.5], [0.0, 1.0, 0.0]), at([0.25, 0.0, 0.0], [0.0, 1.0, 1.0])], [4, 0]);
}

/// Through the edges of cells, where the planes of two axes are one ULP apart: no cell is listed twice in a row.
#[test]
fn a_cell_is_crossed_once() {
    let grid = OccupancyGrid { resolution: 32, density: vec![0.0; 32 * 32 * 32], threshold: 0.5 };
    for n in 1..200 {
        let a = f64::from(n) / 201.0;
        let (o, d) = ([0.0, 0.0, 0.5], [a, a * (1.0 + f64::EPSILON), 0.0]);
        let cells = grid.crossings(o, d, 0.0, 1.0 / a);
        assert!(cells.windows(2).all(|pair| pair[0].cell != pair[1].cell), "{a}");
        assert!(cells.iter().all(|c| c.enter < c.leave) && cells.len() >= 32, "{a}");
    }
}

/// Points on faces and outside the box.
#[test]
fn cells_by_hand() {
    let grid = OccupancyGrid { resolution: 4, density: vec![0.0; 64], threshold: 0.5 };
    assert_eq!(grid.cell([0.25, 0.5, 0.75]), 1 + 4 * (2 + 4 * 3));
    assert_eq!(grid.cell([0.999, 1.0, 1.5]), 3 + 4 * (3 + 4 * 3));
    assert_eq!(grid.cell([-0.5, 1e300, -1e300]), 4 * 3);
}

/// Samples are the lattice points inside occupied crossings.
#[test]
fn samples_lie_in_occupied_crossings() {
    let grid = random_grid(8, 0.3);
    let mut kept = 0;
    for i in 0..200 {
        let (o, d, near, far) = ray(i);
        let occupied: Vec<_> = grid
            .crossings(o, d, near, far)
            .into_iter()
            .filter(|c| grid.density[c.cell] > grid.threshold)
            .collect();
        let step = 0.01 / d.iter().map(|d| d * d).sum::<f64>().sqrt();
        let expected = occupied.iter().map(|c| (c.leave - c.enter) / step).sum::<f64>();
        let samples = grid.samples(o, d, near, far, step, 0.5);
        assert_abs_diff_eq!(samples.len() as f64, expected, epsilon = 1.0 + occupied.len() as f64);
        kept += samples.len();
    }
    assert!(kept > 1000);
}

/// The f32 traversal visits what the oracle visits, except for lattice points within rounding of a face or of an end: one ray
/// alone, lanes that are partly filled, and lanes that are refilled.
#[test]
fn fast_traversal_agrees() {
    let oracle = random_grid(16, 0.2);
    let mut grid = fast::Occupancy::full(16);
    grid.density = oracle.density.iter().map(|&x| x as f32).collect();
    grid.apply_threshold(oracle.threshold as f32);
    let (mut checked, mut skipped) = (0, 0);
    let step = f64::from(0.004f32);
    let numbers: Vec<u64> = (0..500).collect();
    let mut steps = fast::Steps::default();
    for numbers in numbers.chunk_by(|_, b| ![1, 10, 80, 300].contains(b)) {
        let arch = if numbers[0] == 80 { Arch::Scalar } else { Arch::new() };
        let ways: Vec<_> = numbers.iter().map(|&i| way(i, u32::MAX)).collect();
        grid.march(arch, &ways, step as f32, &mut steps);
        for (lane, (&i, way)) in numbers.iter().zip(&ways).enumerate() {
            let (o, d, near, far) = ray(i);
            let u = f64::from(way.u);
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
                    let at = way.at(k as f32, step as f32);
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

fn way(i: u64, patience: u32) -> fast::Way {
    let (o, d, near, far) = ray(i);
    let f = |v: [f64; 3]| v.map(|x| x as f32);
    fast::Way {
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
    let mut grid = fast::Occupancy::full(16);
    grid.density = random_grid(16, 0.2).density.iter().map(|&x| x as f32).collect();
    grid.apply_thresholds([0.3, 0.6]);
    let [_, opaque] = grid.bits();
    let is_opaque = |p: [f32; 3]| {
        let [x, y, z] = p.map(|x| ((16.0 * x) as usize).min(15));
        opaque[(z / 4 * 4 + y / 4) * 4 + x / 4] >> (z % 4 * 16 + y % 4 * 4 + x % 4) & 1 == 1
    };
    let (mut all, mut some, mut cut) = (fast::Steps::default(), fast::Steps::default(), 0);
    for first in (0..500).step_by(50) {
        let [ways, short] =
            [u32::MAX, 25].map(|p| (first..first + 50).map(|i| way(i, p)).collect::<Vec<_>>());
        grid.march(Arch::new(), &ways, 0.004, &mut all);
        grid.march(Arch::new(), &short, 0.004, &mut some);
        for (lane, way) in ways.iter().enumerate() {
            let mut left = 25;
            let patient = all.of(lane).iter().take_while(|k| {
                let before = left;
                left -= usize::from(left > 0 && is_opaque(way.at(**k, 0.004)));
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
    let mut grid = fast::Occupancy::full(64);
    for z in 20..31 {
        for y in 0..7 {
            (40..45).for_each(|x| grid.density[(z * 64 + y) * 64 + x] = 1.0);
        }
    }
    grid.apply_threshold(0.5);
    let (mut met, mut passed) = (0, 0);
    let [mut all, mut some] = [(); 2].map(|()| fast::Steps::default());
    for i in 0..5000 {
        let whole = way(i, u32::MAX);
        let (near, far) = grid.span(whole.o, whole.d);
        let part = fast::Way { near: near.max(whole.near), far: far.min(whole.far), ..whole };
        // The ray alone, and among others.
        grid.march(Arch::new(), &[whole], 0.004, &mut all);
        grid.march(Arch::new(), &[part; 40], 0.004, &mut some);
        assert!((0..40).all(|n| some.of(n) == some.of(0)));
        assert_eq!(all.of(0), some.of(0), "ray {i}");
        met += usize::from(!all.of(0).is_empty());
        passed += usize::from(near > far);
    }
    assert!(met > 50 && passed > 3000, "{met} {passed}");
    let [occupied, opaque] = grid.bits();
    let parts = fast::Occupancy::from_parts(64, grid.density.clone(), &occupied, &opaque);
    assert!(parts.as_ref() == Some(&grid), "blocks and bounds follow from the bits");
    grid.apply_threshold(2.0);
    let (near, far) = grid.span([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0]);
    assert!(near > far, "nothing is occupied");
}

/// Rays along an axis, whose other speeds are 0, on a face of cells too: by hand, in a grid of 16 cells with one occupied.
#[test]
fn rays_along_an_axis() {
    let mut grid = fast::Occupancy::full(16);
    grid.density[(3 * 16 + 2) * 16 + 5] = 1.0;
    grid.apply_threshold(0.5);
    let mut steps = fast::Steps::default();
    // Cell (5, 2, 3) is [5, 6) x [2, 3) x [3, 4) sixteenths; samples at (k + 1/2) / 64, four to a cell.
    let way = |o: [f32; 3], d: [f32; 3]| fast::Way { o, d, near: 0.0, far: 1.0, u: 0.5, patience: u32::MAX };
    let sixteenths = |x: [f32; 3]| x.map(|x| x / 16.0);
    let ways = [
        way(sixteenths([0.0, 2.5, 3.5]), [1.0, 0.0, 0.0]),
        way(sixteenths([16.0, 2.0, 3.0]), [-1.0, 0.0, 0.0]),
        way(sixteenths([5.5, 0.0, 3.5]), [0.0, 1.0, 0.0]),
        way(sixteenths([5.5, 2.5, 0.0]), [0.0, 0.0, 1.0]),
        way(sixteenths([0.0, 3.0, 3.5]), [1.0, 0.0, 0.0]),
    ];
    for arch in [Arch::new(), Arch::Scalar] {
        grid.march(arch, &ways, 1.0 / 64.0, &mut steps);
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
        let (enter, leave) = fast::ray_box(o.map(|x| x as f32), d.map(|x| x as f32));
        assert_abs_diff_eq!(f64::from(enter).max(0.0), near, epsilon = 1e-5);
        assert_abs_diff_eq!(f64::from(leave), far, epsilon = 1e-5);
    }
    let (enter, leave) = fast::ray_box([0.5, 1.5, 0.5], [1.0, 0.0, 0.0]);
    assert!(enter > leave);
    assert_eq!(fast::ray_box([-1.0, 1.0, 0.5], [1.0, 0.0, 0.0]), (1.0, 2.0));
}
