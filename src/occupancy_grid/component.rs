//! Registry rows of the occupancy grid: its update with queries, and its traversal.

use super::{OccupancyGrid, bound, cases, honest, mistakes};
use crate::camera::component::threes;
use crate::contract::component::{Arrays, Component, Pass, Port, array, arrays, input, number, values};
use crate::convention::Conventions;

/// Update and queries.
pub const OCCUPANCY_GRID: Component = Component {
    name: "occupancy_grid",
    folder: "occupancy_grid",
    formula: "density_out = max(decay density, max of the sigmas of the points in the cell); occupied where density_out > threshold",
    source: "Instant-NGP (Mueller et al. 2022) appendix C",
    inputs: &[
        Port::plain("density", "G,G,G", "density of each cell of the unit box, index [z, y, x]"),
        Port::plain(
            "points",
            "M,3",
            "points of the unit box, (x, y, z); a face belongs to the cell above it",
        ),
        Port::plain("sigmas", "M", "densities found there"),
        Port::plain(
            "queries",
            "Q,3",
            "points to look up after the update; outside the box the nearest cell's",
        ),
        Port::plain("decay", "", "factor of all densities"),
        Port::plain("threshold", "", "occupied is what lies above"),
    ],
    outputs: &[
        Port::plain("density_out", "G,G,G", "densities after the update"),
        Port::plain("occupied", "G,G,G", "1 where the cell is occupied, else 0"),
        Port::plain("found", "Q", "1 where the query's cell is occupied, else 0"),
    ],
    conventions: &[],
    forward: Pass { oracle: update, bound: bound::update, honest: honest::update, wrong: mistakes::update },
    vjp: None,
    cases: cases::update,
    mistakes: mistakes::OCCUPANCY_GRID,
};

/// Traversal.
pub const GRID_TRAVERSAL: Component = Component {
    name: "grid_traversal",
    folder: "occupancy_grid",
    formula: "lengths = |{t in [near, far]: o + t d in the cell}|, visited = number of cells with a length above 0",
    source: "Amanatides and Woo 1987; nerfacc issue 265 (CG3)",
    inputs: &[
        Port::plain("rays_o", "M,3", "origins, in units of the box"),
        Port::plain("rays_d", "M,3", "directions, as they come; t counts in their lengths"),
        Port::plain("near", "", "where rays begin; from there to far they lie in the unit box"),
        Port::plain("far", "", "where they end"),
        Port::plain("resolution", "", "G, cells along an edge of the box"),
    ],
    outputs: &[
        Port::plain(
            "lengths",
            "M,G,G,G",
            "t spent in each cell, index [z, y, x]; faces belong to the cell above",
        ),
        Port::plain("visited", "M", "number of cells"),
    ],
    conventions: &[],
    forward: Pass {
        oracle: traverse,
        bound: bound::traverse,
        honest: honest::traverse,
        wrong: mistakes::traverse,
    },
    vjp: None,
    cases: cases::traverse,
    mistakes: mistakes::GRID_TRAVERSAL,
};

/// What an update is asked.
pub(crate) struct Update {
    pub grid: OccupancyGrid,
    pub decay: f64,
    pub points: Vec<[f64; 3]>,
    pub sigmas: Vec<f64>,
    pub queries: Vec<[f64; 3]>,
}

/// An update from the arrays.
pub(crate) fn asked(a: &Arrays) -> Update {
    let resolution = input(a, "density").shape()[0];
    Update {
        grid: OccupancyGrid { resolution, density: values(a, "density"), threshold: number(a, "threshold") },
        decay: number(a, "decay"),
        points: threes(a, "points"),
        sigmas: values(a, "sigmas"),
        queries: threes(a, "queries"),
    }
}

/// Densities, occupancies and found ones as the outputs.
pub(crate) fn updated(resolution: usize, density: Vec<f64>, occupied: Vec<f64>, found: Vec<f64>) -> Arrays {
    let cube = [resolution; 3];
    arrays([
        ("density_out", array(&cube, density)),
        ("occupied", array(&cube, occupied)),
        ("found", array(&[found.len()], found)),
    ])
}

/// `f(origin, direction, near, far, resolution)` = lengths and the number of cells, or how far off they may be, as the outputs.
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

fn update(a: &Arrays, _: &Conventions) -> Arrays {
    let Update { mut grid, decay, points, sigmas, queries } = asked(a);
    grid.update(decay, &points, &sigmas);
    let one = |yes: bool| f64::from(u8::from(yes));
    let occupied = grid.density.iter().map(|&density| one(density > grid.threshold)).collect();
    let found = queries.iter().map(|&x| one(grid.occupied(x))).collect();
    updated(grid.resolution, grid.density, occupied, found)
}

fn traverse(a: &Arrays, _: &Conventions) -> Arrays {
    each_ray(a, lengths)
}
