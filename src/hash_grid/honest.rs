//! Honest hash grids in emulated arithmetic: by weights, or by interpolating along one axis after the other.

use super::arrays::{by_level, gradients, level, levels, n_of, points, zeros};
use super::{Level, corner};
use crate::contract::arrays::{Arrays, rows};
use crate::contract::machine::Machine;
use crate::convention::{Conventions, HashWeights};

/// Cell and weight of the upper side along each axis, x N rounded.
fn cells(x: [f64; 3], level: &Level, m: &Machine) -> [(u32, f64); 3] {
    fractions(x, level, m).map(|(cell, f)| match level.weights {
        HashWeights::Linear => (cell, f),
        HashWeights::Smoothstep => (cell, m.mul(m.mul(f, f), m.sub(3.0, m.mul(2.0, f)))),
    })
}

/// Cell and fraction along each axis.
fn fractions(x: [f64; 3], level: &Level, m: &Machine) -> [(u32, f64); 3] {
    x.map(|x| {
        let scaled = m.mul(x, m.round(level.scale));
        let scaled = if level.shift == 0.0 { scaled } else { m.add(scaled, level.shift) };
        let cell = scaled.floor().clamp(0.0, f64::from(level.last));
        (cell as u32, m.sub(scaled, cell))
    })
}

/// The weight of corner k, its factors in either order; for the derivative along axis `but`, that axis' factor is replaced by its sign.
fn weight(cells: [(u32, f64); 3], k: usize, but: Option<usize>, m: &Machine) -> f64 {
    let mut weight = 1.0;
    for n in 0..3 {
        let a = if m.form % 3 == 1 { 2 - n } else { n };
        let upper = k >> a & 1 == 1;
        let side = if upper { cells[a].1 } else { m.sub(1.0, cells[a].1) };
        weight = match but {
            Some(axis) if axis == a => {
                if upper {
                    weight
                } else {
                    -weight
                }
            }
            _ => m.mul(weight, side),
        };
    }
    weight
}

/// A sum in one operation, or (every fourth form) of tensors one after the other.
fn sum(terms: &[f64], m: &Machine) -> f64 {
    if m.form % 4 == 3 { terms.iter().fold(0.0, |sum, &x| m.add(sum, x)) } else { m.sum(terms) }
}

fn feature(level: &Level, cells: [(u32, f64); 3], f: usize, m: &Machine) -> f64 {
    let entry = |k: usize| level.table[[level.entry(corner(k, cells).0), f]];
    let mut values: Vec<f64> = (0..8).map(entry).collect();
    if m.form % 2 == 0 {
        let weights: Vec<f64> = (0..8).map(|k| weight(cells, k, None, m)).collect();
        return m.dot(&weights, &values);
    }
    if m.form % 4 == 3 {
        let terms: Vec<f64> = (0..8).map(|k| m.mul(weight(cells, k, None, m), values[k])).collect();
        return sum(&terms, m);
    }
    for (_, upper) in cells {
        let between = |pair: &[f64]| m.add(m.mul(m.sub(1.0, upper), pair[0]), m.mul(upper, pair[1]));
        values = values.chunks_exact(2).map(between).collect();
    }
    values[0]
}

/// The encoding.
pub(crate) fn hash_grid(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let features = |level: &Level, x| {
        let cells = cells(x, level, m);
        (0..level.table.ncols()).map(|f| feature(level, cells, f, m)).collect()
    };
    by_level(a, |l| level(a, n_of(a, l), l, c), features)
}

/// d encoding . g / d x along one axis.
fn slope(level: &Level, x: [f64; 3], axis: usize, g: &[f64], m: &Machine) -> f64 {
    let cells = cells(x, level, m);
    let corners: Vec<(Vec<f64>, f64)> = (0..8)
        .map(|k| (level.table.row(level.entry(corner(k, cells).0)).to_vec(), weight(cells, k, Some(axis), m)))
        .collect();
    let terms: Vec<f64> = if m.form % 2 == 0 {
        corners.iter().map(|(entry, w)| m.mul(*w, m.dot(entry, g))).collect()
    } else {
        let along = |f: usize| corners.iter().map(|(entry, w)| m.mul(*w, entry[f])).collect::<Vec<_>>();
        g.iter().enumerate().map(|(f, &g)| m.mul(g, sum(&along(f), m))).collect()
    };
    let slope = m.mul(m.round(level.scale), sum(&terms, m));
    match level.weights {
        HashWeights::Linear => slope,
        HashWeights::Smoothstep => {
            let f = fractions(x, level, m)[axis].1;
            m.mul(slope, m.mul(m.mul(6.0, f), m.sub(1.0, f)))
        }
    }
}

/// Its gradient.
pub(crate) fn hash_grid_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let levels = levels(a, c);
    let mut terms: Vec<Vec<Vec<Vec<f64>>>> =
        levels.iter().map(|l| vec![vec![vec![]; l.table.ncols()]; l.table.nrows()]).collect();
    let mut g_x = vec![];
    for (x, g) in points(a).into_iter().zip(rows(a, "grad_encoding")) {
        let mut first = 0;
        let mut of_levels = [vec![], vec![], vec![]];
        for (l, level) in levels.iter().enumerate() {
            let g = &g[first..first + level.table.ncols()];
            first += g.len();
            let cells = cells(x, level, m);
            for axis in 0..3 {
                of_levels[axis].push(slope(level, x, axis, g, m));
            }
            for k in 0..8 {
                let weight = weight(cells, k, None, m);
                let entry = &mut terms[l][level.entry(corner(k, cells).0)];
                entry.iter_mut().zip(g).for_each(|(terms, &g)| terms.push(m.mul(weight, g)));
            }
        }
        g_x.push(of_levels.map(|levels| sum(&levels, m)));
    }
    let mut g_tables = zeros(&levels);
    for (level, terms) in g_tables.iter_mut().zip(&terms) {
        for (mut entry, terms) in level.table.rows_mut().into_iter().zip(terms) {
            entry.iter_mut().zip(terms).for_each(|(g, terms)| *g = m.sum(terms));
        }
    }
    gradients(&g_x, &g_tables)
}
