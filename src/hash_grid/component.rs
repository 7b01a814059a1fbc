//! Registry row of the hash grid.

use super::{Level, backward, bound, cases, encode, honest, mistakes, resolutions};
use crate::contract::component::{Arrays, Component, Pass, Port, arrays, number};
use crate::convention::Conventions;
use crate::encoding::component::{from_rows, rows};

/// The multi-resolution hash grid.
pub const HASH_GRID: Component = Component {
    name: "hash_grid",
    folder: "hash_grid",
    formula: "level l of L tables has N_l = round(base (finest / base)^(l / (L - 1))) cells along an edge; x N_l = cell + fraction, at x = 1 in the last cell; sum over the cell's 8 corners of trilinear weight times entry; entry x + (N + 1) (y + (N + 1) z) where (N + 1)^3 <= E, else (x xor 2654435761 y xor 805459861 z) mod E",
    source: "Instant-NGP (Mueller et al. 2022) equations 1 to 4; N rounded to nearest instead of down",
    inputs: &[
        Port::smooth("x", "M,3", "points of the unit box, [0, 1]"),
        Port::smooth(
            "table*",
            "E,F",
            "entries of level 0, 1, ...: (N + 1)^3 where dense, else a power of two",
        ),
        Port::plain("base", "", "cells along an edge of the coarsest level, a whole number"),
        Port::plain("finest", "", "cells along an edge of the finest level, a whole number"),
    ],
    outputs: &[Port::smooth("encoding", "M,LF", "features, level by level")],
    conventions: &[],
    forward: Pass {
        oracle: hash_grid,
        bound: bound::hash_grid,
        honest: honest::hash_grid,
        wrong: mistakes::hash_grid,
    },
    vjp: Some(Pass {
        oracle: hash_grid_vjp,
        bound: bound::hash_grid_vjp,
        honest: honest::hash_grid_vjp,
        wrong: mistakes::hash_grid_vjp,
    }),
    cases: cases::hash_grid,
    mistakes: mistakes::HASH_GRID,
};

/// The number of levels: table0, table1, ...
pub(crate) fn count(a: &Arrays) -> usize {
    (0..).take_while(|l| a.contains_key(&format!("table{l}"))).count()
}

/// The tables, each with its level's resolution.
pub(crate) fn levels_of(a: &Arrays, resolutions: &[u32]) -> Vec<Level> {
    let level = |(l, &resolution)| Level { resolution, table: rows(a, &format!("table{l}")) };
    resolutions.iter().enumerate().map(level).collect()
}

/// The grid of a case.
pub(crate) fn levels(a: &Arrays) -> Vec<Level> {
    levels_of(a, &resolutions(number(a, "base") as u32, number(a, "finest") as u32, count(a)))
}

/// The points.
pub(crate) fn points(a: &Arrays) -> Vec<[f64; 3]> {
    rows(a, "x").iter().map(|x| [x[0], x[1], x[2]]).collect()
}

/// Tables of zeros.
pub(crate) fn zeros(levels: &[Level]) -> Vec<Level> {
    let mut zeros = levels.to_vec();
    zeros.iter_mut().flat_map(|level| &mut level.table).for_each(|entry| entry.fill(0.0));
    zeros
}

/// `f(point)` for each point, as the output.
pub(crate) fn forward(a: &Arrays, f: impl Fn([f64; 3]) -> Vec<f64>) -> Arrays {
    let width = levels(a).iter().map(|level| level.table[0].len()).sum();
    arrays([("encoding", from_rows(&points(a).into_iter().map(f).collect::<Vec<_>>(), width))])
}

/// Gradients as arrays.
pub(crate) fn gradients(g_x: &[[f64; 3]], g_tables: &[Level]) -> Arrays {
    let g_x: Vec<Vec<f64>> = g_x.iter().map(|g| g.to_vec()).collect();
    let mut all = arrays([("grad_x", from_rows(&g_x, 3))]);
    for (l, level) in g_tables.iter().enumerate() {
        all.insert(format!("grad_table{l}"), from_rows(&level.table, level.table[0].len()));
    }
    all
}

fn hash_grid(a: &Arrays, _: &Conventions) -> Arrays {
    let levels = levels(a);
    forward(a, |x| encode(&levels, x))
}

fn hash_grid_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    let levels = levels(a);
    let (mut g_tables, mut g_x) = (zeros(&levels), vec![]);
    for (x, g) in points(a).into_iter().zip(rows(a, "grad_encoding")) {
        g_x.push(backward::encode(&levels, x, &g, &mut g_tables));
    }
    gradients(&g_x, &g_tables)
}
