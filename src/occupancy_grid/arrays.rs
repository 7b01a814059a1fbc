//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::OccupancyGrid;
use crate::contract::arrays::{Arrays, array, arrays, input, number, threes, values};
use crate::convention::Conventions;

/// The inputs of an update.
pub(crate) struct Update {
    pub grid: OccupancyGrid,
    pub decay: f64,
    pub points: Vec<[f64; 3]>,
    pub sigmas: Vec<f64>,
    pub queries: Vec<[f64; 3]>,
}

/// An update from the arrays.
pub(crate) fn update_of(a: &Arrays) -> Update {
    let resolution = input(a, "density").shape()[0];
    Update {
        grid: OccupancyGrid { resolution, density: values(a, "density"), threshold: number(a, "threshold") },
        decay: number(a, "decay"),
        points: threes(a, "points"),
        sigmas: values(a, "sigmas"),
        queries: threes(a, "queries"),
    }
}

/// Densities, occupancies and queried bits as the outputs.
pub(crate) fn updated(resolution: usize, density: Vec<f64>, occupied: Vec<f64>, found: Vec<f64>) -> Arrays {
    let cube = [resolution; 3];
    arrays([
        ("density_out", array(&cube, density)),
        ("occupied", array(&cube, occupied)),
        ("found", array(&[found.len()], found)),
    ])
}

/// `f(origin, direction, near, far, resolution)` = lengths and the number of cells, or their errors, as the outputs.
pub(crate) fn each_ray(
    a: &Arrays,
    f: impl Fn([f64; 3], [f64; 3], f64, f64, usize) -> (Vec<f64>, f64),
) -> Arrays {
    let (near, far, r) = (number(a, "near"), number(a, "far"), number(a, "resolution") as usize);
    let rays = threes(a, "rays_o").into_iter().zip(threes(a, "rays_d"));
    let (lengths, visited): (Vec<_>, Vec<_>) = rays.map(|(o, d)| f(o, d, near, far, r)).unzip();
    let rays = visited.len();
    arrays([("lengths", array(&[rays, r, r, r], lengths.concat())), ("visited", array(&[rays], visited))])
}

/// The oracle's lengths and number of cells.
pub(crate) fn lengths(o: [f64; 3], d: [f64; 3], near: f64, far: f64, r: usize) -> (Vec<f64>, f64) {
    let grid = OccupancyGrid { resolution: r, density: vec![], threshold: 0.0 };
    let crossings = grid.crossings(o, d, near, far);
    let mut lengths = vec![0.0; r * r * r];
    crossings.iter().for_each(|c| lengths[c.cell] += c.leave - c.enter);
    (lengths, crossings.len() as f64)
}

pub(super) fn update(a: &Arrays, c: &Conventions) -> Arrays {
    let Update { mut grid, decay, points, sigmas, queries } = update_of(a);
    grid.update(decay, &points, &sigmas, c.grid_decay, c.grid_unseen);
    grid.threshold = grid.threshold_below(grid.threshold, c.grid_threshold);
    let one = |yes: bool| f64::from(u8::from(yes));
    let occupied = grid.density.iter().map(|&density| one(density > grid.threshold)).collect();
    let found = queries.iter().map(|&x| one(grid.occupied(x))).collect();
    updated(grid.resolution, grid.density, occupied, found)
}

pub(super) fn traverse(a: &Arrays, _: &Conventions) -> Arrays {
    each_ray(a, lengths)
}
