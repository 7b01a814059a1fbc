//! Registry rows of the occupancy grid: its update with queries, and its traversal.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Entries, Port};
use crate::contract::special::Special;

/// Update and queries.
pub(crate) const OCCUPANCY_GRID: Component = Component {
    name: "occupancy_grid",
    folder: "occupancy_grid",
    code: include_str!("honest.rs"),
    formula: "where points lie in a cell that is seen, density_out = max(decay density, max of their sigmas), elsewhere density; occupied where density_out > min(threshold, mean of the density_out > 0), all cells with density_out >= 0 where that leaves none",
    source: "Instant-NGP (Mueller et al. 2022) appendix C; nerfacc's OccGridEstimator",
    inputs: &[
        Port::plain(
            "density",
            "G,G,G",
            "density of each cell of the unit box, index [z, y, x]; -1 where no camera sees it",
        ),
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
        Port::plain("decay", "", "factor of the densities of cells that were looked into"),
        Port::plain("threshold", "", "occupied is what lies above it, or above the mean where that is less"),
    ],
    outputs: &[
        Port::plain("density_out", "G,G,G", "densities after the update"),
        Port::plain("occupied", "G,G,G", "1 where the cell is occupied, else 0").of(Entries::Bit),
        Port::plain("found", "Q", "1 where the query's cell is occupied, else 0").of(Entries::Bit),
    ],
    conventions: &["grid_decay", "grid_threshold", "grid_unseen"],
    forward: Direction {
        oracle: arrays::update,
        bound: bound::update,
        honest: honest::update,
        wrong: mistakes::update,
    },
    vjp: None,
    cases: cases::update,
    mistakes: mistakes::OCCUPANCY_GRID,
    special: Special { large: cases::large, ..Special::NONE },
};

/// Traversal.
pub(crate) const GRID_TRAVERSAL: Component = Component {
    name: "grid_traversal",
    folder: "occupancy_grid",
    code: include_str!("honest.rs"),
    formula: "lengths = |{t in [near, far]: o + t d in the cell}|, visited = number of cells with a length above 0",
    source: "Amanatides and Woo 1987; nerfacc issue 265 (CG3)",
    inputs: &[
        Port::plain("rays_o", "M,3", "origins, in units of the box"),
        Port::plain("rays_d", "M,3", "directions, as they come; t counts in their lengths"),
        Port::plain("near", "", "where rays begin; from there to far they lie in the unit box"),
        Port::plain("far", "", "where they end"),
        Port::plain("resolution", "", "G, cells along an edge of the box").of(Entries::Count),
    ],
    outputs: &[
        Port::plain(
            "lengths",
            "M,G,G,G",
            "t spent in each cell, index [z, y, x]; faces belong to the cell above",
        ),
        Port::plain("visited", "M", "number of cells").of(Entries::Count),
    ],
    conventions: &[],
    forward: Direction {
        oracle: arrays::traverse,
        bound: bound::traverse,
        honest: honest::traverse,
        wrong: mistakes::traverse,
    },
    vjp: None,
    cases: cases::traverse,
    mistakes: mistakes::GRID_TRAVERSAL,
    special: Special { large: cases::large_traversal, ..Special::NONE },
};
