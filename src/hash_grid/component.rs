//! Registry row of the hash grid.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Port};
use crate::contract::special::Special;

/// The multi-resolution hash grid.
pub(crate) const HASH_GRID: Component = Component {
    name: "hash_grid",
    folder: "hash_grid",
    code: include_str!("honest.rs"),
    formula: "level l of L tables has N_l = round(base (finest / base)^(l / (L - 1))) cells along an edge; x N_l = cell + fraction, at x = 1 in the last cell; sum over the cell's 8 corners of trilinear weight times entry; entry x + (N + 1) (y + (N + 1) z) where (N + 1)^3 <= E, else (x xor 2654435761 y xor 805459861 z) mod E",
    source: "Instant-NGP (Mueller et al. 2022) equations 1 to 4, N rounded to nearest; by convention as tiny-cuda-nn, torch-ngp or nerfstudio have it",
    inputs: &[
        Port::smooth("x", "M,3", "points of the unit box, [0, 1]"),
        Port::smooth(
            "table*",
            "E,F",
            "E entries of level 0, 1, ..., a power of two; dense where (N + 1)^3 <= E",
        ),
        Port::plain("base", "", "cells along an edge of the coarsest level, a whole number"),
        Port::plain("finest", "", "cells along an edge of the finest level, a whole number"),
    ],
    outputs: &[Port::smooth("encoding", "M,LF", "features, level by level")],
    conventions: &["hash_levels", "hash_index", "hash_primes", "hash_weights"],
    forward: Direction {
        oracle: arrays::hash_grid,
        bound: bound::hash_grid,
        honest: honest::hash_grid,
        wrong: mistakes::hash_grid,
    },
    vjp: Some(Direction {
        oracle: arrays::hash_grid_vjp,
        bound: bound::hash_grid_vjp,
        honest: honest::hash_grid_vjp,
        wrong: mistakes::hash_grid_vjp,
    }),
    cases: cases::hash_grid,
    mistakes: mistakes::HASH_GRID,
    special: Special { large: cases::large, laws: Some(mistakes::laws::OF_GRIDS), ..Special::NONE },
};
