//! Occupancy grids, wrong on purpose. Without a mistake every function equals the oracle.

use super::OccupancyGrid;
use super::arrays::{Update, each_ray, lengths, update_of, updated};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::{Conventions, GridDecay, GridThreshold, GridUnseen};

/// Mistakes of update and query.
#[rustfmt::skip]
pub(crate) const OCCUPANCY_GRID: &[Mistake] = &[
    Mistake::new("rise_decays", "decay max(density, sigma)", "what was just seen has faded already", "decay first, then rise", "never; cheap to keep", 0),
    Mistake::new("density_replaced", "cells that are seen take the density found there", "one empty sample clears a cell that holds something", "the maximum of both", "hand-written grids", 1),
    Mistake::new("moving_average", "decay density + (1 - decay) sigma", "thin things fall below the threshold", "the maximum of both", "hand-written grids", 1),
    Mistake::new("last_point_wins", "of several points in a cell the last one counts", "a scattered write without a maximum: depends on the order", "scatter with max", "index assignment in torch and numpy", 3),
    Mistake::new("points_added", "densities of several points in a cell are added", "occupied by counting samples", "scatter with max", "never; cheap to keep", 0),
    Mistake::new("axes_reversed", "x and z exchanged in the index", "empty space is skipped in the wrong place", "index [z, y, x], x fastest", "between grids of both orders", 2),
    Mistake::new("nearest_cell", "round(x R) for floor(x R)", "the grid is shifted by half a cell", "floor: cells lie between faces", "align_corners and its like", 2),
    Mistake::new("threshold_included", "occupied where density >= threshold", "with a threshold of 0 no cell is ever empty", "larger than the threshold", "hand-written grids", 1),
    Mistake::new("mean_of_all", "the mean counts the -1 of cells that no camera sees", "the threshold falls with the space that no camera sees, below 0 where that is most of it", "the mean of the densities of cells that are seen", "alpha_thre of nerfacc's OccGridEstimator.sampling", 1),
    Mistake::new("points_averaged", "several points in a cell count by their mean", "thin things fall below the threshold", "scatter with max", "never; cheap to keep", 0),
    Mistake::new("mean_alone", "the mean of the densities, whatever the threshold is", "half of the scene is always empty", "the threshold where that is less", "never; cheap to keep", 0),
    Mistake::new("larger_for_smaller", "the threshold or the mean, whichever is larger", "early in a training every cell is empty", "whichever is less", "never; cheap to keep", 0),
    Mistake::new("corners_aligned", "round(x (R - 1)) for floor(x R)", "cells at the box's faces are half as wide", "floor(x R): cells lie between faces", "never; cheap to keep", 0),
    Mistake::new("mean_of_none", "the mean of no density above 0 is NaN, and no density is above that", "a grid that has seen nothing stays empty for ever", "where nothing is above 0, every cell that is seen is occupied", "ngp_pl and its copies", 2),
    Mistake::new("occupied_before", "occupied by the densities before the update", "occupancy lags behind by an update", "threshold after the update", "hand-written grids", 1),
    Mistake::new("flat_index_held", "coordinates of cells aren't held inside; the flat index is", "what lies outside counts to any cell", "hold each coordinate", "never; cheap to keep", 0),
    Mistake::new("negative_cells_wrap", "cells before the first are those from the end: -1 is R - 1", "what lies before the box counts to its far side", "hold each coordinate", "numpy's and torch's negative indices", 0),
    Mistake::new("far_face_is_empty", "queries outside of the box, or on its far faces, are in no occupied cell: 0 <= x < 1", "what lies on a face is empty", "the nearest cell, or no query outside", "1 public implementation", 1),
    Mistake::new("outside_is_empty", "queries outside of the box are in no occupied cell", "what lies a rounding beyond a face is empty", "the nearest cell, or no query outside", "never; cheap to keep", 0),
    Mistake::new("unseen_become_empty", "max(decay density, 0): -1 of cells that no camera sees becomes 0", "space that no camera sees is visited", "leave what is below 0 as it is", "never; cheap to keep", 0),
    Mistake::new("found_before", "queries are answered by the densities before the update", "queries lag behind by an update", "query after the update", "never; cheap to keep", 0),
    Mistake::new("mean_before", "the mean of the densities before the update", "the threshold lags behind by an update", "the mean after the update", "never; cheap to keep", 0),
    Mistake::new("opacities_kept", "1 - exp(-sigma) for sigma, against a threshold of densities", "whatever is dense counts as 1 at most", "the density, or its opacity over the step with a threshold of opacities", "2 public implementations", 2),
];

/// Mistakes of the traversal.
#[rustfmt::skip]
pub(crate) const GRID_TRAVERSAL: &[Mistake] = &[
    Mistake::new("left_at_a_face", "a ray from the box's face, with a component outwards however small, leaves the grid at once", "one cell for 32, holes along the box", "the last cell is closed: stay in it", "nerfacc#265", 1),
    Mistake::new("equal_steps", "a step of half a cell at a time, all of it for the cell it begins in", "lengths are multiples of the step, corners are missed", "from face to face", "ray marchers that count cells", 2),
    Mistake::new("first_cell_missing", "the cell in which the ray begins isn't listed", "nothing is seen right in front of the camera", "list a cell before stepping out of it", "loops that step first", 1),
    Mistake::new("near_ignored", "from t = 0 on", "samples in front of near", "start at near", "hand-written grids", 1),
    Mistake::new("far_ignored", "to the end of the box", "samples behind far", "stop at far", "hand-written grids", 1),
    Mistake::new("axes_reversed", "x and z exchanged in the index", "empty space is skipped in the wrong place", "index [z, y, x], x fastest", "between grids of both orders", 2),
    Mistake::new("unit_directions", "lengths in units of the box, not of the direction", "steps of the wrong length where directions aren't unit", "t as the direction counts it", "between code with and without normalized directions", 1),
    Mistake::new("nearest_cell", "round(x R) for floor(x R)", "the grid is shifted by half a cell", "floor: cells lie between faces", "align_corners and its like", 2),
];

fn wrong_cell(grid: &OccupancyGrid, x: [f64; 3], wrong: &[&str]) -> usize {
    let shift = if wrong.contains(&"nearest_cell") { 0.5 / grid.resolution as f64 } else { 0.0 };
    let last = grid.resolution as f64 - 1.0;
    let aligned = |x: f64| ((x * last).clamp(0.0, last).round() + 0.5) / grid.resolution as f64;
    let [x, y, z] = x.map(|x| if wrong.contains(&"corners_aligned") { aligned(x) } else { x + shift });
    let (r, floors) = (grid.resolution as f64, [x, y, z].map(|x| (x * grid.resolution as f64).floor()));
    if wrong.contains(&"flat_index_held") {
        let flat = floors[0] + r * (floors[1] + r * floors[2]);
        return flat.clamp(0.0, r * r * r - 1.0) as usize;
    }
    if wrong.contains(&"negative_cells_wrap") {
        let [i, j, k] = floors.map(|n| n.min(r - 1.0)).map(|n| n.rem_euclid(r) as usize);
        return i + grid.resolution * (j + grid.resolution * k);
    }
    grid.cell(if wrong.contains(&"axes_reversed") { [z, y, x] } else { [x, y, z] })
}

/// Update and queries.
pub(crate) fn update(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let Update { mut grid, decay, points, sigmas, queries } = update_of(a);
    let is = |name: &str| wrong.contains(&name);
    let before = grid.clone();
    let mut seen: Vec<Option<f64>> = vec![None; grid.density.len()];
    let mut counts = vec![0.0; grid.density.len()];
    for (&x, &sigma) in points.iter().zip(&sigmas) {
        let cell = wrong_cell(&grid, x, wrong);
        let sigma = if is("opacities_kept") { -crate::math::expm1(-sigma) } else { sigma };
        let seen = &mut seen[cell];
        counts[cell] += 1.0;
        *seen = Some(match *seen {
            Some(before) if is("points_added") => before + sigma,
            Some(before) if is("points_averaged") => before + (sigma - before) / counts[cell],
            Some(before) if !is("last_point_wins") => before.max(sigma),
            _ => sigma,
        });
    }
    for (density, seen) in grid.density.iter_mut().zip(seen) {
        if *density < 0.0 && c.grid_unseen == GridUnseen::Kept && !is("unseen_become_empty") {
            continue;
        }
        let faded = decay * *density;
        *density = match seen {
            None if c.grid_decay == GridDecay::EveryCell => faded,
            None => *density,
            Some(sigma) if is("density_replaced") => sigma,
            Some(sigma) if is("moving_average") => faded + (1.0 - decay) * sigma,
            Some(sigma) if is("rise_decays") => faded.max(decay * sigma),
            Some(sigma) => faded.max(sigma),
        };
        if is("unseen_become_empty") {
            *density = density.max(0.0);
        }
    }
    let source = if is("occupied_before") { &before } else { &grid };
    let of_mean = if is("mean_before") { &before } else { source };
    let threshold = wrong_threshold(of_mean, c.grid_threshold, wrong);
    let bit = |d: f64| f64::from(u8::from(d > threshold || is("threshold_included") && d == threshold));
    let occupied = source.density.iter().map(|&d| bit(d)).collect();
    let asked = if is("found_before") { &before } else { source };
    let inside = |x: [f64; 3]| match () {
        () if is("far_face_is_empty") => x.iter().all(|x| (0.0..1.0).contains(x)),
        () => !is("outside_is_empty") || x.iter().all(|x| (0.0..=1.0).contains(x)),
    };
    let found =
        |x: &[f64; 3]| f64::from(u8::from(inside(*x))) * bit(asked.density[wrong_cell(asked, *x, wrong)]);
    let found = queries.iter().map(found).collect();
    updated(grid.resolution, grid.density, occupied, found)
}

fn wrong_threshold(grid: &OccupancyGrid, convention: GridThreshold, wrong: &[&str]) -> f64 {
    let limit = grid.threshold;
    // Where the limit stands alone there is no mean.
    let mean =
        || Some(grid.threshold_below(f64::INFINITY, convention)).filter(|x| x.is_finite()).unwrap_or(limit);
    if wrong.contains(&"mean_of_none")
        && convention == GridThreshold::MeanOfDense
        && !grid.density.iter().any(|&d| d > 0.0)
    {
        return f64::NAN;
    }
    if wrong.contains(&"mean_alone") {
        return mean();
    }
    if wrong.contains(&"larger_for_smaller") {
        return limit.max(mean());
    }
    if wrong.contains(&"mean_of_all") {
        let mean = grid.density.iter().sum::<f64>() / grid.density.len() as f64;
        return limit.min(mean);
    }
    grid.threshold_below(limit, convention)
}

/// Traversal.
pub(crate) fn traverse(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let is = |name: &str| wrong.contains(&name);
    each_ray(a, |o, d, near, far, r| {
        let near = if is("near_ignored") { 0.0 } else { near };
        // The box's end, from inside.
        let leaves = |a: usize| ((if d[a] > 0.0 { 1.0 } else { 0.0 }) - o[a]) / d[a];
        let end =
            (0..3).filter(|&a| d[a] != 0.0).map(leaves).filter(|&t| t > near).fold(f64::INFINITY, f64::min);
        let far = if is("far_ignored") && end.is_finite() { end } else { far };
        let outwards = |a: usize| o[a] == 0.0 && d[a] < 0.0 || o[a] == 1.0 && d[a] > 0.0;
        if is("left_at_a_face") && (0..3).any(outwards) {
            return (vec![0.0; r * r * r], 1.0);
        }
        let shift = if is("nearest_cell") { 0.5 / r as f64 } else { 0.0 };
        let o = o.map(|o| o + shift);
        let (mut out, mut visited) =
            if is("equal_steps") { stepped(o, d, near, far, r) } else { lengths(o, d, near, far, r) };
        if is("first_cell_missing") {
            let grid = OccupancyGrid { resolution: r, density: vec![], threshold: 0.0 };
            if let Some(first) = grid.crossings(o, d, near, far).first() {
                (out[first.cell], visited) = (0.0, visited - 1.0);
            }
        }
        if is("axes_reversed") {
            let turned = |n: usize| out[n / r / r + r * (n / r % r + r * (n % r))];
            out = (0..out.len()).map(turned).collect();
        }
        if is("unit_directions") {
            let length = d.iter().map(|d| d * d).sum::<f64>().sqrt();
            out.iter_mut().for_each(|x| *x *= length);
        }
        (out, visited)
    })
}

/// More steps than any ray of a case has: the judge also asks about directions that it has made infinite, which have steps of 0.
const MOST_STEPS: usize = 1 << 16;

/// Steps of half a cell.
fn stepped(o: [f64; 3], d: [f64; 3], near: f64, far: f64, r: usize) -> (Vec<f64>, f64) {
    let grid = OccupancyGrid { resolution: r, density: vec![], threshold: 0.0 };
    let step = 0.5 / r as f64 / d.iter().map(|d| d * d).sum::<f64>().sqrt();
    let mut lengths = vec![0.0; r * r * r];
    let (mut t, mut left) = (near, MOST_STEPS);
    while t < far && left > 0 {
        left -= 1;
        lengths[grid.cell([0, 1, 2].map(|a| o[a] + t * d[a]))] += step.min(far - t);
        t += step;
    }
    let visited = lengths.iter().filter(|&&length| length > 0.0).count();
    (lengths, visited as f64)
}
