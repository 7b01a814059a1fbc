//! Vector-Jacobian product of the hash grid, by hand.

use super::{Level, corner};
use crate::convention::HashWeights;

/// Adds the gradient of one point to `g_tables` (shaped like `levels`) and returns the gradient with respect to `x`.
///
/// The encoding is linear in the tables: g_entry += weight g_out for each corner, colliding corners add up. In x it is trilinear
/// inside a cell: d weight / d x_a = +-N times the other two axes' weights, times the slope of the weight where that isn't linear.
/// At cell faces the derivative jumps (PE6): the value is that of the cell which [`Level::cell`] names.
///
/// # Panics
/// Where `g_tables` isn't shaped like `levels`, or `g_out` doesn't have their features, level by level.
pub fn encode(levels: &[Level], x: [f64; 3], g_out: &[f64], g_tables: &mut [Level]) -> [f64; 3] {
    assert_eq!(g_tables.len(), levels.len(), "g_tables and levels: one each a level");
    let width = levels.iter().fold(0, |width, level| width + level.table.ncols());
    assert_eq!(g_out.len(), width, "g_out and the levels' features: one each a feature");
    let mut g_x = [0.0; 3];
    let mut first = 0;
    for l in 0..levels.len() {
        let level = &levels[l];
        let features = level.table.ncols();
        assert_eq!(
            g_tables[l].table.dim(),
            level.table.dim(),
            "g_tables and levels: as many entries and features"
        );
        let g_level = &g_out[first..first + features];
        first += features;
        let places = x.map(|x| level.cell(x));
        let cells = places.map(|(cell, f)| (cell, level.weight(f)));
        for k in 0..8 {
            let (vertex, weight) = corner(k, cells);
            let entry = level.entry(vertex);
            let mut g_weight = 0.0;
            for f in 0..features {
                g_tables[l].table[[entry, f]] += weight * g_level[f];
                g_weight += level.table[[entry, f]] * g_level[f];
            }
            for a in 0..3 {
                g_x[a] +=
                    g_weight * corner_slope(k, cells, a) * weight_slope(level, places[a].1) * level.scale;
            }
        }
    }
    g_x
}

/// d weight / d (weight of the upper side along axis a) of corner k.
fn corner_slope(k: usize, cells: [(u32, f64); 3], a: usize) -> f64 {
    let mut slope = if k >> a & 1 == 1 { 1.0 } else { -1.0 };
    for b in 0..3 {
        if b != a {
            slope *= if k >> b & 1 == 1 { cells[b].1 } else { 1.0 - cells[b].1 };
        }
    }
    slope
}

/// d [`Level::weight`] / d fraction.
fn weight_slope(level: &Level, f: f64) -> f64 {
    match level.weights {
        HashWeights::Linear => 1.0,
        HashWeights::Smoothstep => 6.0 * f * (1.0 - f),
    }
}
