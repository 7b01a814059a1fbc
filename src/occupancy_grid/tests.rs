//! Closed forms and properties of the occupancy grid.

use approx::assert_abs_diff_eq;

use super::{Crossing, OccupancyGrid};
use crate::convention::{GridDecay, GridThreshold, GridUnseen};
use crate::random::{Key, Purpose};
use crate::ray_aabb;

pub(super) fn key() -> Key {
    Key::new(11, Purpose::Cases)
}

/// A grid with about `share` of the cells occupied, in clumps of 2^3 so that bricks are full, mixed and empty.
pub(super) fn random_grid(resolution: usize, share: f64) -> OccupancyGrid {
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
pub(super) fn ray(i: u64) -> ([f64; 3], [f64; 3], f64, f64) {
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
/// The judge asks wrong code about directions that it has made infinite.
#[test]
fn steps_of_no_length_end() {
    let mut inputs = super::cases::traverse().swap_remove(0).inputs;
    inputs.get_mut("rays_d").unwrap().fill(f64::INFINITY);
    let out = super::mistakes::traverse(&inputs, &crate::convention::CS180, &["equal_steps"]);
    assert_eq!(out["visited"].len(), inputs["rays_d"].shape()[0]);
}

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

/// By hand.
#[test]
fn update_decays_and_rises_where_somebody_looked() {
    let mut density = vec![1.0; 8];
    density[7] = -1.0;
    let mut grid = OccupancyGrid { resolution: 2, density, threshold: 0.6 };
    let points = [[0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.9, 0.1, 0.1], [0.9, 0.9, 0.9]];
    grid.update(0.5, &points, &[2.0, 3.0, 0.1, 9.0], GridDecay::Touched, GridUnseen::Kept);
    assert_eq!(grid.density, [3.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, -1.0]);
    assert!(grid.occupied([0.49, 0.0, 0.3]) && !grid.occupied([0.5, 0.0, 0.3]));
}

/// By hand: instant-ngp's decay, nerfacc's mean, the limit alone.
#[test]
fn what_other_grids_do() {
    let mut grid = OccupancyGrid { resolution: 2, density: vec![2.0; 8], threshold: 0.6 };
    grid.density[7] = -1.0;
    grid.update(0.5, &[[0.1; 3]], &[3.0], GridDecay::EveryCell, GridUnseen::Kept);
    assert_eq!(grid.density, [3.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, -1.0]);
    grid.density = vec![0.0, 1.0, 2.0, -1.0, -1.0, -1.0, -1.0, -1.0];
    let below = |limit, convention| grid.threshold_below(limit, convention);
    assert_eq!((below(9.0, GridThreshold::MeanOfSeen), below(9.0, GridThreshold::MeanOfDense)), (1.0, 1.5));
    assert_eq!((below(0.5, GridThreshold::MeanOfSeen), below(9.0, GridThreshold::LimitAlone)), (0.5, 9.0));
    assert_eq!(below(9.0, GridThreshold::MeanOverAll), 3.0 / 8.0);
    grid.density = vec![0.0; 8];
    assert_eq!(grid.threshold_below(9.0, GridThreshold::MeanOfSeen), 0.0);
    assert_eq!(grid.threshold_below(9.0, GridThreshold::MeanOverAll), 0.0);
    // A grid without a mark for cells that no camera sees: -1 is a density as any other.
    for (fades, rest) in [(GridDecay::EveryCell, -0.5), (GridDecay::Touched, -1.0)] {
        grid.density = vec![-1.0; 8];
        grid.update(0.5, &[[0.1; 3]], &[3.0], fades, GridUnseen::Ordinary);
        assert_eq!(grid.density, [&[3.0][..], &[rest; 7]].concat());
    }
}

/// A thin field keeps its densest cells, an empty one all that are seen, whatever the limit.
#[test]
fn a_threshold_never_empties_the_grid() {
    let limits = [0.01, 0.3, 1e9];
    let opened = |four: [f64; 4], limit: f64| {
        let grid = OccupancyGrid { resolution: 2, density: four.repeat(2), threshold: 0.0 };
        four.map(|density| density > grid.threshold_below(limit, GridThreshold::MeanOfDense))
    };
    for limit in limits {
        assert_eq!(opened([0.0, 0.0, -1.0, 0.0], limit), [true, true, false, true]);
        assert_eq!(opened([0.5, 0.5, -1.0, 0.5], limit), [true, true, false, true], "all alike");
    }
    let thin = limits.map(|limit| opened([0.125, 0.25, 0.0, -1.0], limit));
    assert_eq!(thin, [[true, true, false, false], [false, true, false, false], [false, true, false, false]]);
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
