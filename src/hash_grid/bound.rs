//! Error bounds of the hash grid.
//!
//! x N is rounded, so a point close to a cell's face may fall into either cell. The value is continuous there; the derivative
//! jumps (PE6), and the gradient of the tables goes to other entries. The bound covers every cell that x N may round to.

use super::arrays::{forward, gradients, levels, points, zeros};
use super::{Level, corner};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, rows};
use crate::contract::bounded::{Bounded, exact, gamma};
use crate::convention::Conventions;

/// A cell that a point may fall into: along each axis its lower vertex and the point's place inside.
type Cell = [(u32, Bounded); 3];

/// All candidate cells, the oracle's first.
fn cells(x: [f64; 3], resolution: u32, m: &Arithmetic) -> Vec<Cell> {
    let last = f64::from(resolution - 1);
    let along = |x: f64| {
        let scaled = m.mul(exact(x), exact(f64::from(resolution)));
        let cell = |y: f64| y.floor().clamp(0.0, last);
        let mut found = vec![cell(scaled.y), cell(scaled.y - scaled.e), cell(scaled.y + scaled.e)];
        found.dedup();
        if found.len() == 3 && found[0] == found[2] {
            found.pop();
        }
        found.into_iter().map(|c| (c as u32, m.sub(scaled, exact(c)))).collect::<Vec<_>>()
    };
    let [x, y, z] = x.map(along);
    let mut all = vec![];
    for &z in &z {
        for &y in &y {
            for &x in &x {
                all.push([x, y, z]);
            }
        }
    }
    all
}

/// The weight of one side along one axis.
fn side(upper: bool, fraction: Bounded, m: &Arithmetic) -> Bounded {
    if upper { fraction } else { m.sub(exact(1.0), fraction) }
}

/// The entry of corner k and its weight; for the derivative along axis `but`, that axis' factor is replaced by its sign.
fn weighted(level: &Level, cell: &Cell, k: usize, but: Option<usize>, m: &Arithmetic) -> (usize, Bounded) {
    let (vertex, _) = corner(k, cell.map(|(c, f)| (c, f.y)));
    let mut weight = exact(1.0);
    for a in 0..3 {
        let upper = k >> a & 1 == 1;
        weight = match but {
            Some(axis) if axis == a && upper => weight,
            Some(axis) if axis == a => weight.neg(),
            _ => m.mul(weight, side(upper, cell[a].1, m)),
        };
    }
    (level.entry(vertex), weight)
}

/// A sum inside of one operation, or of tensors, one after the other.
fn any_sum(terms: &[Bounded], m: &Arithmetic) -> Bounded {
    let sum = m.sum(terms);
    let size: f64 = terms.iter().map(|term| term.size()).sum();
    if m.u_sum < m.u { sum.widened(gamma(terms.len() as f64, m.u) * size) } else { sum }
}

/// The same value computed another way: how far it may be from `right`.
fn reach(right: f64, other: Bounded) -> f64 {
    (other.y - right).abs() + other.e
}

/// Feature f of a level by weights, or by interpolating along one axis after the other.
fn feature(level: &Level, cell: &Cell, f: usize, m: &Arithmetic) -> Bounded {
    let corners: Vec<(usize, Bounded)> = (0..8).map(|k| weighted(level, cell, k, None, m)).collect();
    let terms: Vec<Bounded> = corners.iter().map(|&(e, w)| m.mul(w, exact(level.table[e][f]))).collect();
    let mut values: Vec<Bounded> = corners.iter().map(|&(e, _)| exact(level.table[e][f])).collect();
    for (_, fraction) in cell {
        let between = |pair: &[Bounded]| {
            m.add(m.mul(side(false, *fraction, m), pair[0]), m.mul(side(true, *fraction, m), pair[1]))
        };
        values = values.chunks_exact(2).map(between).collect();
    }
    any_sum(&terms, m).or(values[0])
}

/// Bound of [`super::encode`].
pub fn hash_grid(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let levels = levels(a);
    forward(a, |x| {
        let mut errors = vec![];
        for level in &levels {
            let cells = cells(x, level.resolution, m);
            for f in 0..level.table[0].len() {
                let values: Vec<Bounded> = cells.iter().map(|cell| feature(level, cell, f, m)).collect();
                errors.push(values.iter().map(|&value| reach(values[0].y, value)).fold(0.0, f64::max));
            }
        }
        errors
    })
}

/// The derivative along an axis in one cell: corners outside and features inside, or the other way round.
fn slope(level: &Level, cell: &Cell, axis: usize, g: &[f64], m: &Arithmetic) -> Bounded {
    let corners: Vec<(usize, Bounded)> = (0..8).map(|k| weighted(level, cell, k, Some(axis), m)).collect();
    let (mut by_corner, mut by_feature) = (vec![], vec![]);
    for &(entry, weight) in &corners {
        let products: Vec<Bounded> =
            g.iter().zip(&level.table[entry]).map(|(&g, &t)| m.mul(exact(g), exact(t))).collect();
        by_corner.push(m.mul(weight, any_sum(&products, m)));
    }
    for (f, &g) in g.iter().enumerate() {
        let products: Vec<Bounded> =
            corners.iter().map(|&(e, w)| m.mul(w, exact(level.table[e][f]))).collect();
        by_feature.push(m.mul(exact(g), any_sum(&products, m)));
    }
    let sum = any_sum(&by_corner, m).or(any_sum(&by_feature, m));
    m.mul(exact(f64::from(level.resolution)), m.rounded(sum.y, sum.e))
}

/// What a point in one cell adds to each entry that it touches: (entry, contribution to feature f).
fn contributions(level: &Level, cell: &Cell, g: f64, m: &Arithmetic) -> Vec<(usize, Bounded)> {
    let one = |k| {
        let (entry, weight) = weighted(level, cell, k, None, m);
        (entry, m.mul(weight, exact(g)))
    };
    (0..8).map(one).collect()
}

/// Sum, value and error, of the contributions to one entry.
fn total(contributions: &[(usize, Bounded)], entry: usize) -> Bounded {
    let (mut y, mut e) = (0.0, 0.0);
    for (_, one) in contributions.iter().filter(|(at, _)| *at == entry) {
        y += one.y;
        e += one.e;
    }
    Bounded { y, e }
}

/// Bound of [`super::backward::encode`].
pub fn hash_grid_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let levels = levels(a);
    // The gradient of every entry's features.
    let mut terms: Vec<Vec<Vec<Vec<Bounded>>>> =
        levels.iter().map(|l| l.table.iter().map(|entry| vec![vec![]; entry.len()]).collect()).collect();
    let mut g_x = vec![];
    for (x, g) in points(a).into_iter().zip(rows(a, "grad_encoding")) {
        let mut first = 0;
        let mut of_levels = [vec![], vec![], vec![]];
        for (l, level) in levels.iter().enumerate() {
            let g = &g[first..first + level.table[0].len()];
            first += g.len();
            let cells = cells(x, level.resolution, m);
            for axis in 0..3 {
                let slopes: Vec<Bounded> = cells.iter().map(|cell| slope(level, cell, axis, g, m)).collect();
                let e = slopes.iter().map(|&s| reach(slopes[0].y, s)).fold(0.0, f64::max);
                of_levels[axis].push(Bounded { y: slopes[0].y, e });
            }
            for (f, &g) in g.iter().enumerate() {
                let all: Vec<_> = cells.iter().map(|cell| contributions(level, cell, g, m)).collect();
                for &(entry, one) in &all[0] {
                    terms[l][entry][f].push(one);
                }
                let mut touched: Vec<usize> = all[1..].iter().flatten().map(|(entry, _)| *entry).collect();
                touched.extend(all[0].iter().map(|(entry, _)| *entry).filter(|_| all.len() > 1));
                touched.sort_unstable();
                touched.dedup();
                for entry in touched {
                    let right = total(&all[0], entry).y;
                    let e = all[1..].iter().map(|c| reach(right, total(c, entry))).fold(0.0, f64::max);
                    terms[l][entry][f].push(Bounded { y: 0.0, e });
                }
            }
        }
        g_x.push(of_levels.map(|levels| any_sum(&levels, m).e));
    }
    let mut g_tables = zeros(&levels);
    for (level, terms) in g_tables.iter_mut().zip(&terms) {
        for (entry, terms) in level.table.iter_mut().zip(terms) {
            entry.iter_mut().zip(terms).for_each(|(e, terms)| *e = any_sum(terms, m).e);
        }
    }
    gradients(&g_x, &g_tables)
}
