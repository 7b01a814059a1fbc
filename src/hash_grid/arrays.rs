//! The oracle of this folder on named arrays, and what turns these into its types and back.

use std::slice;

use ndarray::ArrayView2;

use super::{Level, backward, encode, growing};
use crate::contract::arrays::{Arrays, arrays, from_rows, input, number, rows};
use crate::convention::Conventions;

/// The table of level l.
fn table(a: &Arrays, l: usize) -> ArrayView2<'_, f64> {
    let table = input(a, &format!("table{l}")).view();
    table.into_dimensionality().expect("the contract's (E, F)")
}

/// The number of levels: table0, table1, ...
pub(crate) fn count(a: &Arrays) -> usize {
    (0..).take_while(|l| a.contains_key(&format!("table{l}"))).count()
}

/// Level l of n cells in these conventions.
pub(crate) fn level(a: &Arrays, n: f64, l: usize, c: &Conventions) -> Level {
    Level::by_convention(n, table(a, l).to_owned(), c)
}

/// The levels, n cells each ([`growing`]), in these conventions.
pub(crate) fn levels_of(a: &Arrays, n: impl Fn(usize) -> f64, c: &Conventions) -> Vec<Level> {
    (0..count(a)).map(|l| level(a, n(l), l, c)).collect()
}

/// n of the levels of a case.
pub(crate) fn n_of(a: &Arrays, l: usize) -> f64 {
    growing(number(a, "base") as u32, number(a, "finest") as u32, count(a), l)
}

/// The grid of a case.
pub(crate) fn levels(a: &Arrays, c: &Conventions) -> Vec<Level> {
    levels_of(a, |l| n_of(a, l), c)
}

/// The points.
pub(crate) fn points(a: &Arrays) -> Vec<[f64; 3]> {
    rows(a, "x").iter().map(|x| [x[0], x[1], x[2]]).collect()
}

/// Tables of zeros.
pub(crate) fn zeros(levels: &[Level]) -> Vec<Level> {
    let mut zeros = levels.to_vec();
    zeros.iter_mut().for_each(|level| level.table.fill(0.0));
    zeros
}

/// `f(point)` for each point, as the output.
pub(crate) fn forward(a: &Arrays, f: impl Fn([f64; 3]) -> Vec<f64>) -> Arrays {
    encoding(a, &points(a).into_iter().map(f).collect::<Vec<_>>())
}

/// The points' features as the output.
fn encoding(a: &Arrays, rows: &[Vec<f64>]) -> Arrays {
    let width = (0..count(a)).map(|l| table(a, l).ncols()).sum();
    arrays([("encoding", from_rows(rows, width))])
}

/// `f(level, point)` for each point, level by level, as the output. One level is there at a time: a real grid has half a gigabyte of rows.
pub(crate) fn by_level<L>(
    a: &Arrays,
    level: impl Fn(usize) -> L,
    f: impl Fn(&L, [f64; 3]) -> Vec<f64>,
) -> Arrays {
    let points = points(a);
    let mut rows = vec![vec![]; points.len()];
    for l in 0..count(a) {
        let level = level(l);
        rows.iter_mut().zip(&points).for_each(|(row, &x)| row.extend(f(&level, x)));
    }
    encoding(a, &rows)
}

/// Gradients as arrays.
pub(crate) fn gradients(g_x: &[[f64; 3]], g_tables: &[Level]) -> Arrays {
    let g_x: Vec<Vec<f64>> = g_x.iter().map(|g| g.to_vec()).collect();
    let mut all = arrays([("grad_x", from_rows(&g_x, 3))]);
    for (l, level) in g_tables.iter().enumerate() {
        all.insert(format!("grad_table{l}"), level.table.clone().into_dyn());
    }
    all
}

pub(super) fn hash_grid(a: &Arrays, c: &Conventions) -> Arrays {
    by_level(a, |l| level(a, n_of(a, l), l, c), |level, x| encode(slice::from_ref(level), x))
}

pub(super) fn hash_grid_vjp(a: &Arrays, c: &Conventions) -> Arrays {
    let levels = levels(a, c);
    let (mut g_tables, mut g_x) = (zeros(&levels), vec![]);
    for (x, g) in points(a).into_iter().zip(rows(a, "grad_encoding")) {
        g_x.push(backward::encode(&levels, x, &g, &mut g_tables));
    }
    gradients(&g_x, &g_tables)
}
