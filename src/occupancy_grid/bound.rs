//! Error bounds of the occupancy grid.
//!
//! Bits and counts are whole numbers: the bound is 0 where every honest evaluation decides alike, otherwise the distance to the other
//! answer. A point that rounding may move to another cell leaves everything open; the cases have none, which a test asserts.

use super::arrays::{Update, each_ray, update_of, updated};
use crate::camera::bound::hyper;
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::Arrays;
use crate::contract::bounded::{Bounded, exact};
use crate::convention::{Conventions, GridDecay, GridThreshold, GridUnseen};

/// Whether every honest evaluation finds the same cell: x R is exact where R is a power of two, and off by three roundings elsewhere
/// (x / (1 / R)), except at the ends of the box.
pub(crate) fn surely_in_its_cell(x: [f64; 3], resolution: usize, m: &Arithmetic) -> bool {
    let r = resolution as f64;
    resolution.is_power_of_two()
        || x.iter().all(|x| {
            let face = libm::rint(x * r);
            face <= 0.0 || face >= r || (x * r - face).abs() > 3.0 * m.u * (x * r).abs()
        })
}

/// Bound of [`super::OccupancyGrid::update`] and of what is occupied after it.
pub(crate) fn update(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let Update { grid, decay, points, sigmas, queries } = update_of(a);
    let r = grid.resolution;
    if points.iter().any(|&x| !surely_in_its_cell(x, r, m)) {
        let all = vec![f64::INFINITY; r * r * r];
        return updated(r, all.clone(), all, vec![f64::INFINITY; queries.len()]);
    }
    let mut found = vec![f64::NEG_INFINITY; grid.density.len()];
    for (&x, &sigma) in points.iter().zip(&sigmas) {
        let cell = grid.cell(x);
        found[cell] = found[cell].max(sigma);
    }
    let new = |(&density, &sigma): (&f64, &f64)| {
        let unseen = density < 0.0 && c.grid_unseen == GridUnseen::Kept;
        if unseen || sigma < 0.0 && c.grid_decay == GridDecay::Touched {
            return exact(density);
        }
        let Bounded { y, e } = m.mul(exact(density), hyper(decay, m));
        let highest = (y + e).max(sigma);
        if sigma >= y + e { exact(sigma) } else { Bounded { y: y.max(sigma), e: highest - y.max(sigma) + e } }
    };
    let density: Vec<Bounded> = grid.density.iter().zip(&found).map(new).collect();
    let threshold = threshold(&density, hyper(grid.threshold, m), c.grid_threshold, m);
    let open = |d: &Bounded| (d.y - threshold.y).abs() <= d.e + threshold.e && d.e + threshold.e > 0.0;
    let bit = |open: bool| f64::from(u8::from(open));
    let found = |&x: &[f64; 3]| bit(open(&density[grid.cell(x)]) || !surely_in_its_cell(x, r, m));
    updated(
        r,
        density.iter().map(|d| d.e).collect(),
        density.iter().map(|d| bit(open(d))).collect(),
        queries.iter().map(found).collect(),
    )
}

/// The smaller of the limit and the mean of what is above 0, summed in any order, as a sum or as a sum of shares (Higham, section
/// 4.2: n roundings, one for each division). Where rounding alone decides whether any cell lies above it, nothing is said.
fn threshold(density: &[Bounded], limit: Bounded, convention: GridThreshold, m: &Arithmetic) -> Bounded {
    if convention == GridThreshold::LimitAlone {
        return limit;
    }
    let counts = |d: &Bounded| match convention {
        GridThreshold::MeanOverAll => true,
        GridThreshold::MeanOfSeen => d.y >= 0.0,
        _ => d.y > 0.0,
    };
    let known: Vec<Bounded> =
        density.iter().filter(|d| counts(d)).map(|d| if d.y < 0.0 { exact(0.0) } else { *d }).collect();
    let n = known.len() as f64;
    let (sum, errors) = known.iter().fold((0.0, 0.0), |(y, e), d| (y + d.y, e + d.e));
    let rounded = (1.0 + m.u).powf(n + 1.0) - 1.0;
    let mean = Bounded {
        y: sum / n,
        e: (errors + rounded * (sum + errors) + (2.0 * n + 1.0) * m.tiny) / n.max(1.0),
    };
    let smaller = match () {
        _ if known.is_empty() || mean.y - mean.e > limit.y + limit.e => limit,
        _ if mean.y + mean.e < limit.y - limit.e => mean,
        _ => Bounded { y: mean.y.min(limit.y), e: mean.e.max(limit.e) + (mean.y - limit.y).abs() },
    };
    if convention != GridThreshold::MeanOfDense {
        return smaller;
    }
    let above = |sign: f64| known.iter().any(|d| d.y + sign * d.e > smaller.y - sign * smaller.e);
    match (above(-1.0), above(1.0)) {
        (true, _) => smaller,
        (false, false) => exact(-1.0),
        (false, true) => Bounded { y: smaller.y, e: f64::INFINITY },
    }
}

/// The interval of t inside one slab of cells along an axis, with the errors of its ends; the outermost cells reach to infinity, as
/// the oracle's do. `None` where the ray misses the slab.
struct Slab {
    enter: Bounded,
    leave: Bounded,
}

const NEVER: f64 = f64::INFINITY;

fn slab(o: f64, d: f64, n: usize, resolution: usize, range: [f64; 2], m: &Arithmetic) -> Option<Slab> {
    let r = resolution as f64;
    let face = |n: usize| match n {
        0 => f64::NEG_INFINITY,
        _ if n == resolution => f64::INFINITY,
        _ => n as f64 / r,
    };
    if d == 0.0 {
        let inside = face(n) <= o && o < face(n + 1);
        return inside.then_some(Slab { enter: exact(-NEVER), leave: exact(NEVER) });
    }
    let delta = m.div(exact(1.0), m.mul(exact(r), exact(d)));
    let longest = range[0].abs().max(range[1].abs());
    let t = |n: usize| {
        if face(n).is_infinite() {
            return exact(face(n) * d.signum());
        }
        let place = if resolution.is_power_of_two() { exact(face(n)) } else { m.rounded(face(n), 0.0) };
        let direct = m.div(m.sub(place, exact(o)), exact(d));
        let scaled = m.mul(m.sub(place, exact(o)), m.div(exact(1.0), exact(d)));
        // Reached face by face, each step is rounded, and the step length has an error itself.
        direct.or(scaled).widened(r * (m.u * (direct.y.abs() + longest) + delta.e))
    };
    let (a, b) = (t(n), t(n + 1));
    Some(if d > 0.0 { Slab { enter: a, leave: b } } else { Slab { enter: b, leave: a } })
}

/// The interval of the maximum, or (`sign` -1) the minimum, of honest values.
fn extreme(all: &[Bounded], sign: f64) -> [f64; 2] {
    let of = |side: f64| {
        sign * all
            .iter()
            .map(|b| sign * (b.y + side * if b.y.is_finite() { b.e } else { 0.0 }))
            .fold(-NEVER, f64::max)
    };
    [of(-1.0), of(1.0)]
}

/// Bound of [`super::OccupancyGrid::crossings`], cell by cell.
pub(crate) fn traverse(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    each_ray(a, |o, d, near, far, r| {
        let slabs: Vec<Vec<Option<Slab>>> =
            (0..3).map(|a| (0..r).map(|n| slab(o[a], d[a], n, r, [near, far], m)).collect()).collect();
        let (mut errors, mut open) = (vec![], 0.0);
        for cell in 0..r * r * r {
            let at = [cell % r, cell / r % r, cell / r / r];
            let (Some(x), Some(y), Some(z)) = (&slabs[0][at[0]], &slabs[1][at[1]], &slabs[2][at[2]]) else {
                errors.push(0.0);
                continue;
            };
            let enter = extreme(&[x.enter, y.enter, z.enter, hyper(near, m)], 1.0);
            let leave = extreme(&[x.leave, y.leave, z.leave, hyper(far, m)], -1.0);
            let [least, most] = [leave[0] - enter[1], leave[1] - enter[0]].map(|length| length.max(0.0));
            // The difference is rounded, and small ones may vanish next to t.
            let rounding = 2.0 * m.u * (enter[1].abs() + leave[1].abs()) + m.tiny;
            errors.push(if most == 0.0 { 0.0 } else { most - least + rounding });
            open += if most > 0.0 && least <= rounding { 1.0 } else { 0.0 };
        }
        (errors, open)
    })
}
