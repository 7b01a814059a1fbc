//! Error bounds of the hash grid.
//!
//! x N is rounded, so a point close to a cell's face may fall into either cell. The value is continuous there; the derivative
//! jumps (PE6), and the gradient of the tables goes to other entries. The bound covers every cell that x N may round to, and every N
//! that a rounded power may give where N is cut.

use super::arrays::{by_level, count, gradients, level, n_of, points, zeros};
use super::{Level, corner};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, rows};
use crate::contract::bounded::{Bounded, exact, gamma};
use crate::convention::{Conventions, HashLevels, HashWeights};

/// A level as rounding may make it: where a power misses a whole number, `floor` and `ceil` find the next one.
struct Reading {
    level: Level,
    /// Cells along an edge, with the error of the power.
    scale: Bounded,
}

/// All readings of level l, the oracle's first.
fn readings(a: &Arrays, l: usize, c: &Conventions, m: &Arithmetic) -> Vec<Reading> {
    let (n, base) = (n_of(a, l), n_of(a, 0));
    let level = |n: f64| level(a, n, l, c);
    let mut all = vec![level(n)];
    if l > 0 && n == n.round() {
        match c.hash_levels {
            HashLevels::Nearest => {}
            HashLevels::Floor => all.push(level(n - 1.0)),
            _ => all.push(Level { side: all[0].side + 1, ..level(n) }),
        }
    }
    // Logarithm, product, power, product with the base, and the 1 that is taken off: at least in f32, as of hyper-parameters alone.
    let off = if l == 0 { 0.0 } else { n * m.u_sum.min(m.u) * (8.0 + 4.0 * (n / base).ln()) };
    let whole = [HashLevels::Nearest, HashLevels::Floor].contains(&c.hash_levels);
    let scale = |y: f64| if whole || l == 0 { exact(y) } else { m.rounded(y, off) };
    all.into_iter().map(|level| Reading { scale: scale(level.scale), level }).collect()
}

/// A point inside a cell, along one axis.
#[derive(Clone, Copy)]
struct Along {
    cell: u32,
    /// Weight of the upper side.
    upper: Bounded,
    /// Its derivative with respect to x.
    slope: Bounded,
    /// Whether rounding may put the point on a face.
    face: bool,
}

/// A cell that a point may fall into.
struct Cell<'a> {
    level: &'a Level,
    along: [Along; 3],
}

/// All candidate cells, the oracle's first.
fn cells<'a>(x: [f64; 3], readings: &'a [Reading], m: &Arithmetic) -> Vec<Cell<'a>> {
    readings.iter().flat_map(|reading| cells_of(x, reading, m)).collect()
}

fn cells_of<'a>(x: [f64; 3], Reading { level, scale }: &'a Reading, m: &Arithmetic) -> Vec<Cell<'a>> {
    let along = |x: f64| {
        let product = m.mul(exact(x), *scale);
        let scaled = if level.shift == 0.0 { product } else { m.add(product, exact(level.shift)) };
        let cell = |y: f64| y.floor().clamp(0.0, f64::from(level.last));
        let mut found = vec![cell(scaled.y), cell(scaled.y - scaled.e), cell(scaled.y + scaled.e)];
        found.dedup();
        if found.len() == 3 && found[0] == found[2] {
            found.pop();
        }
        // A hash has an entry for any vertex: code that leaves the last cell open is in the next one at x = 1, at weight 0, and has
        // the slope to its right.
        let next = f64::from(level.last) + 1.0;
        if !level.dense() && scaled.y + scaled.e >= next {
            found.push(next);
        }
        let place = |c: f64| {
            let (upper, slope) = weight(level, m.sub(scaled, exact(c)), m);
            let face = (scaled.y - scaled.y.round()).abs() <= scaled.e;
            Along { cell: c as u32, upper, face, slope: slope.map_or(*scale, |slope| m.mul(*scale, slope)) }
        };
        found.into_iter().map(place).collect::<Vec<_>>()
    };
    let [x, y, z] = x.map(along);
    let mut all = vec![];
    for &z in &z {
        for &y in &y {
            for &x in &x {
                all.push(Cell { level, along: [x, y, z] });
            }
        }
    }
    all
}

/// The weight of the upper side and its derivative, where that isn't 1.
fn weight(level: &Level, f: Bounded, m: &Arithmetic) -> (Bounded, Option<Bounded>) {
    match level.weights {
        HashWeights::Linear => (f, None),
        HashWeights::Smoothstep => {
            let rest = m.sub(exact(3.0), m.mul(exact(2.0), f));
            let slope = m.mul(m.mul(exact(6.0), f), m.sub(exact(1.0), f));
            (m.mul(m.mul(f, f), rest), Some(slope))
        }
    }
}

/// The weight of one side along one axis.
fn side(upper: bool, weight: Bounded, m: &Arithmetic) -> Bounded {
    if upper { weight } else { m.sub(exact(1.0), weight) }
}

/// The entry of corner k and its weight; for the derivative along axis `but`, that axis' factor is replaced by its sign.
fn weighted(cell: &Cell, k: usize, but: Option<usize>, m: &Arithmetic) -> (usize, Bounded) {
    let (vertex, _) = corner(k, cell.along.map(|along| (along.cell, along.upper.y)));
    let mut weight = exact(1.0);
    for a in 0..3 {
        let upper = k >> a & 1 == 1;
        weight = match but {
            Some(axis) if axis == a && upper => weight,
            Some(axis) if axis == a => weight.neg(),
            _ => m.mul(weight, side(upper, cell.along[a].upper, m)),
        };
    }
    (cell.level.entry(vertex), weight)
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
fn feature(cell: &Cell, f: usize, m: &Arithmetic) -> Bounded {
    let (level, corners) = (cell.level, (0..8).map(|k| weighted(cell, k, None, m)).collect::<Vec<_>>());
    let terms: Vec<Bounded> = corners.iter().map(|&(e, w)| m.mul(w, exact(level.table[[e, f]]))).collect();
    let mut values: Vec<Bounded> = corners.iter().map(|&(e, _)| exact(level.table[[e, f]])).collect();
    for along in &cell.along {
        let between = |pair: &[Bounded]| {
            m.add(m.mul(side(false, along.upper, m), pair[0]), m.mul(side(true, along.upper, m), pair[1]))
        };
        values = values.chunks_exact(2).map(between).collect();
    }
    any_sum(&terms, m).or(values[0])
}

/// Bound of [`super::encode`].
pub(crate) fn hash_grid(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let errors = |readings: &Vec<Reading>, x| {
        let cells = cells(x, readings, m);
        let error = |f| {
            let values: Vec<Bounded> = cells.iter().map(|cell| feature(cell, f, m)).collect();
            values.iter().map(|&value| reach(values[0].y, value)).fold(0.0, f64::max)
        };
        (0..readings[0].level.table.ncols()).map(error).collect()
    };
    by_level(a, |l| readings(a, l, c, m), errors)
}

/// The derivative along an axis in one cell: corners outside and features inside, or the other way round.
fn slope(cell: &Cell, axis: usize, g: &[f64], m: &Arithmetic) -> Bounded {
    let level = cell.level;
    let corners: Vec<(usize, Bounded)> = (0..8).map(|k| weighted(cell, k, Some(axis), m)).collect();
    let (mut by_corner, mut by_feature) = (vec![], vec![]);
    for &(entry, weight) in &corners {
        let products: Vec<Bounded> =
            g.iter().zip(level.table.row(entry)).map(|(&g, &t)| m.mul(exact(g), exact(t))).collect();
        by_corner.push(m.mul(weight, any_sum(&products, m)));
    }
    for (f, &g) in g.iter().enumerate() {
        let products: Vec<Bounded> =
            corners.iter().map(|&(e, w)| m.mul(w, exact(level.table[[e, f]]))).collect();
        by_feature.push(m.mul(exact(g), any_sum(&products, m)));
    }
    let sum = any_sum(&by_corner, m).or(any_sum(&by_feature, m));
    m.mul(cell.along[axis].slope, m.rounded(sum.y, sum.e))
}

/// What a point in one cell adds to each entry that it touches: (entry, contribution to feature f).
fn contributions(cell: &Cell, g: f64, m: &Arithmetic) -> Vec<(usize, Bounded)> {
    let one = |k| {
        let (entry, weight) = weighted(cell, k, None, m);
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

/// The derivative along an axis in any of the cells. On a face it is 0 where both corners are taken for the same vertex (floor and ceil of
/// a whole number, as nerfstudio has it).
fn any_slope(cells: &[Cell], axis: usize, g: &[f64], m: &Arithmetic) -> Bounded {
    let slopes: Vec<Bounded> = cells.iter().map(|cell| slope(cell, axis, g, m)).collect();
    let e = slopes.iter().map(|&s| reach(slopes[0].y, s)).fold(0.0, f64::max);
    let flat = if cells[0].along[axis].face { slopes[0].y.abs() } else { 0.0 };
    Bounded { y: slopes[0].y, e: e.max(flat) }
}

/// Bound of [`super::backward::encode`].
pub(crate) fn hash_grid_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let levels: Vec<Vec<Reading>> = (0..count(a)).map(|l| readings(a, l, c, m)).collect();
    let plain: Vec<Level> = levels.iter().map(|readings| readings[0].level.clone()).collect();
    // The gradient of every entry's features.
    let mut terms: Vec<Vec<Vec<Vec<Bounded>>>> =
        plain.iter().map(|l| vec![vec![vec![]; l.table.ncols()]; l.table.nrows()]).collect();
    let mut g_x = vec![];
    for (x, g) in points(a).into_iter().zip(rows(a, "grad_encoding")) {
        let mut first = 0;
        let mut of_levels = [vec![], vec![], vec![]];
        for (l, readings) in levels.iter().enumerate() {
            let g = &g[first..first + plain[l].table.ncols()];
            first += g.len();
            let cells = cells(x, readings, m);
            (0..3).for_each(|axis| of_levels[axis].push(any_slope(&cells, axis, g, m)));
            for (f, &g) in g.iter().enumerate() {
                let all: Vec<_> = cells.iter().map(|cell| contributions(cell, g, m)).collect();
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
    let mut g_tables = zeros(&plain);
    for (level, terms) in g_tables.iter_mut().zip(&terms) {
        for (mut entry, terms) in level.table.rows_mut().into_iter().zip(terms) {
            entry.iter_mut().zip(terms).for_each(|(e, terms)| *e = any_sum(terms, m).e);
        }
    }
    gradients(&g_x, &g_tables)
}
