//! Honest occupancy grids in emulated arithmetic: cells by product or quotient, traversal face by face or by a running sum.

use super::arrays::{Update, each_ray, update_of, updated};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::{Conventions, GridDecay, GridThreshold, GridUnseen};

/// Index of a coordinate's cell.
fn along(x: f64, r: usize, m: &Machine) -> usize {
    let scaled = if m.form % 2 == 0 { m.mul(x, r as f64) } else { m.div(x, m.div(1.0, r as f64)) };
    (scaled.floor().max(0.0) as usize).min(r - 1)
}

fn cell(x: [f64; 3], r: usize, m: &Machine) -> usize {
    let [i, j, k] = x.map(|x| along(x, r, m));
    i + r * (j + r * k)
}

/// Update and queries.
pub(crate) fn update(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let Update { grid, decay, points, sigmas, queries } = update_of(a);
    let (r, decay, limit) = (grid.resolution, m.round(decay), m.round(grid.threshold));
    let mut found = vec![f64::NEG_INFINITY; grid.density.len()];
    for (&x, &sigma) in points.iter().zip(&sigmas) {
        let cell = cell(x, r, m);
        found[cell] = found[cell].max(sigma);
    }
    let new = |(&density, &found): (&f64, &f64)| {
        let unseen = density < 0.0 && c.grid_unseen == GridUnseen::Kept;
        if unseen || found < 0.0 && c.grid_decay == GridDecay::Touched {
            density
        } else {
            m.mul(decay, density).max(found)
        }
    };
    let density: Vec<f64> = grid.density.iter().zip(&found).map(new).collect();
    let threshold = threshold(&density, limit, c.grid_threshold, m);
    let bit = |density: f64| f64::from(u8::from(density > threshold));
    let occupied = density.iter().map(|&d| bit(d)).collect();
    let found = queries.iter().map(|&x| bit(density[cell(x, r, m)])).collect();
    updated(r, density, occupied, found)
}

/// The mean as a sum over a number, or as a sum of shares; from the first cell to the last, or back.
fn threshold(density: &[f64], limit: f64, convention: GridThreshold, m: &Machine) -> f64 {
    if convention == GridThreshold::LimitAlone {
        return limit;
    }
    let counts = |d: &f64| match convention {
        GridThreshold::MeanOverAll => true,
        GridThreshold::MeanOfSeen => *d >= 0.0,
        _ => *d > 0.0,
    };
    let mut known: Vec<f64> = density.iter().filter(|d| counts(d)).map(|d| d.max(0.0)).collect();
    if m.form / 2 % 2 == 1 {
        known.reverse();
    }
    let count = known.len() as f64;
    let mean = if m.form % 2 == 0 {
        m.div(known.iter().fold(0.0, |sum, &d| m.add(sum, d)), count)
    } else {
        known.iter().fold(0.0, |sum, &d| m.add(sum, m.div(d, count)))
    };
    let threshold = if known.is_empty() { limit } else { limit.min(mean) };
    let opens = convention == GridThreshold::MeanOfDense;
    if !opens || known.iter().any(|&d| d > threshold) { threshold } else { -1.0 }
}

/// From cell to cell (Amanatides and Woo), each face from its coordinate or one step after the last; the ray stays inside of the box.
pub(crate) fn traverse(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    each_ray(a, |o, d, near, far, r| {
        let (near, far, rs) = (m.round(near), m.round(far), r as f64);
        let mut at = [0, 1, 2].map(|a| along(m.add(o[a], m.mul(near, d[a])), r, m));
        let t = |a: usize, face: usize| {
            let way = m.sub(m.div(face as f64, rs), o[a]);
            if m.form / 2 % 2 == 0 { m.div(way, d[a]) } else { m.mul(way, m.div(1.0, d[a])) }
        };
        let ahead = |a: usize, at: usize| {
            let last = if d[a] > 0.0 { at + 1 == r } else { at == 0 };
            (d[a] != 0.0 && !last).then(|| if d[a] > 0.0 { at + 1 } else { at })
        };
        let mut next = [0, 1, 2].map(|a| ahead(a, at[a]).map_or(f64::INFINITY, |face| t(a, face)));
        let (mut lengths, mut visited, mut now) = (vec![0.0; r * r * r], 0.0, near);
        loop {
            let axis = (0..3).min_by(|&a, &b| next[a].total_cmp(&next[b])).expect("three axes");
            let stop = next[axis].min(far);
            if stop > now {
                lengths[at[0] + r * (at[1] + r * at[2])] += m.sub(stop, now);
                visited += 1.0;
                now = stop;
            }
            if next[axis] >= far {
                return (lengths, visited);
            }
            at[axis] = if d[axis] > 0.0 { at[axis] + 1 } else { at[axis] - 1 };
            let step = m.div(1.0, m.mul(rs, d[axis].abs()));
            next[axis] = match ahead(axis, at[axis]) {
                None => f64::INFINITY,
                Some(_) if m.form % 2 == 1 => m.add(next[axis], step),
                Some(face) => t(axis, face),
            };
        }
    })
}
