//! Honest implementations of samples in emulated arithmetic: what the bound must never reject.

use crate::contract::arrays::{Arrays, array, arrays, number, row, size, threes};
use crate::contract::machine::Machine;
use crate::convention::{Conventions, Delta, Grid, LastDelta};

/// (far - near) / cells.
fn width(near: f64, far: f64, cells: f64, m: &Machine) -> f64 {
    m.div(m.sub(far, near), m.round(cells))
}

/// lower + s (upper - lower), or by weights.
fn between(lower: f64, upper: f64, s: f64, m: &Machine) -> f64 {
    if m.form % 2 == 0 {
        m.add(lower, m.mul(s, m.sub(upper, lower)))
    } else {
        m.add(m.mul(lower, m.sub(1.0, s)), m.mul(upper, s))
    }
}

/// Edge a (a whole number) of a linspace: from near, from whichever end is nearer as torch does, or interpolated.
fn edge(near: f64, far: f64, a: f64, cells: f64, m: &Machine) -> f64 {
    if m.form % 3 == 2 {
        return between(near, far, m.div(m.round(a), m.round(cells)), m);
    }
    let width = width(near, far, cells, m);
    if m.form % 3 == 0 || 2.0 * a < cells {
        m.add(near, m.mul(m.round(a), width))
    } else {
        m.sub(far, m.mul(m.round(cells - a), width))
    }
}

/// An edge, or the mean of two.
fn edge_or_mean(near: f64, far: f64, a: f64, cells: f64, m: &Machine) -> f64 {
    let [below, above] = [libm::floor(a), libm::ceil(a)].map(|a| edge(near, far, a, cells, m));
    if below == above { below } else { m.mul(0.5, m.add(below, above)) }
}

/// t from the sample's number (forms 0, 1), from an edge plus jitter (2), between two edges (3).
fn position(near: f64, far: f64, a: f64, w: f64, u: f64, cells: f64, m: &Machine) -> f64 {
    let width = width(near, far, cells, m);
    let number = m.add(m.round(a), m.mul(u, w));
    match m.form % 4 {
        0 => m.add(near, m.mul(number, width)),
        1 => between(near, far, m.div(number, m.round(cells)), m),
        2 => m.add(edge_or_mean(near, far, a, cells, m), m.mul(u, m.mul(w, width))),
        _ => {
            let [lower, upper] = [a, a + w].map(|a| edge_or_mean(near, far, a, cells, m));
            between(lower, upper, u, m)
        }
    }
}

fn sample(near: f64, far: f64, i: usize, n: usize, u: f64, grid: Grid, m: &Machine) -> f64 {
    let (i, last) = (i as f64, n as f64 - 1.0);
    let jitter = m.mul(u, width(near, far, n as f64, m));
    match grid {
        Grid::Intervals => position(near, far, i, 1.0, u, n as f64, m),
        Grid::EndsPlusWidth if n == 1 => m.add(near, jitter),
        Grid::EndsPlusWidth => m.add(edge(near, far, i, last, m), jitter),
        _ if n == 1 => near,
        Grid::EndsPlusSpacing => position(near, far, i, 1.0, u, last, m),
        Grid::EndsBetweenMidpoints => {
            let (lower, upper) = ((i - 0.5).max(0.0), (i + 0.5).min(last));
            position(near, far, lower, upper - lower, u, last, m)
        }
    }
}

/// Positions and points, o + t d fused or not.
pub(crate) fn sample_along_rays(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let (near, far) = (m.round(number(a, "near")), m.round(number(a, "far")));
    let (rays, samples) = size(a, "u");
    let (o, d) = (threes(a, "rays_o"), threes(a, "rays_d"));
    let (mut t, mut points) = (vec![], vec![]);
    for r in 0..rays {
        for (i, u) in row(a, "u", r).into_iter().enumerate() {
            let at = sample(near, far, i, samples, u, c.grid, m);
            t.push(at);
            points.extend((0..3).map(|k| match m.fused {
                true => m.round(o[r][k] + at * d[r][k]),
                false => m.add(o[r][k], m.mul(at, d[r][k])),
            }));
        }
    }
    arrays([("t", array(&[rays, samples], t)), ("points", array(&[rays, samples, 3], points))])
}

/// Step lengths.
pub(crate) fn step_sizes(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let (near, far) = (m.round(number(a, "near")), m.round(number(a, "far")));
    let (rays, samples) = size(a, "t");
    let width = width(near, far, samples as f64, m);
    let mut deltas = vec![];
    for r in 0..rays {
        let t = row(a, "t", r);
        if c.delta == Delta::Width || samples == 0 {
            deltas.extend(vec![width; samples]);
            continue;
        }
        if c.delta == Delta::Midpoints {
            let edge = |i: usize| match i {
                0 => near,
                i if i == samples => far,
                i if m.form % 2 == 0 => m.mul(0.5, m.add(t[i - 1], t[i])),
                i => m.add(t[i - 1], m.mul(0.5, m.sub(t[i], t[i - 1]))),
            };
            deltas.extend((0..samples).map(|i| m.sub(edge(i + 1), edge(i))));
            continue;
        }
        let differences: Vec<f64> = t.windows(2).map(|t| m.sub(t[1], t[0])).collect();
        if c.delta == Delta::Central {
            let last = samples - 1;
            deltas.extend((0..samples).map(|i| match i {
                0 if last == 0 => width,
                0 => differences[0],
                i if i == last => differences[last - 1],
                i if m.form % 2 == 0 => m.mul(0.5, m.sub(t[i + 1], t[i - 1])),
                i => m.mul(0.5, m.add(differences[i - 1], differences[i])),
            }));
            continue;
        }
        let last = match c.last_delta {
            LastDelta::Width => width,
            LastDelta::Repeated => differences.last().copied().unwrap_or(width),
            LastDelta::Mean if samples == 1 => width,
            LastDelta::Mean => {
                let sum = if m.form % 2 == 0 { m.sum(&differences) } else { m.sub(t[samples - 1], t[0]) };
                m.div(sum, m.round(samples as f64 - 1.0))
            }
            LastDelta::TenToTen => m.round(1e10),
            LastDelta::TenToNine => m.round(1e9),
            LastDelta::Thousandth => m.round(1e-3),
            LastDelta::ToFar => m.sub(far, t[samples - 1]),
        };
        deltas.extend(differences);
        deltas.push(last);
    }
    arrays([("deltas", array(&[rays, samples], deltas))])
}
