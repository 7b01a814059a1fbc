//! The hash grid, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{self, count, forward, gradients, levels, levels_of, n_of, points, zeros};
use super::{Level, backward, corner, encode as oracle, primes};
use crate::contract::arrays::{Arrays, number, rows};
use crate::convention::Conventions;
use crate::math::pow;

mod catalogue;

pub(crate) use catalogue::HASH_GRID;
use catalogue::{OFFSET_HALF, OTHER_GROWTH};

/// The levels as the mistakes have them.
fn wrong_levels(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Vec<Level> {
    let (base, finest, levels) = (number(a, "base"), number(a, "finest"), count(a));
    let growth = OTHER_GROWTH.among(wrong);
    let usual = |l: usize| match () {
        () if wrong.contains(&"growth_over_levels") => base * pow(finest / base, l as f64 / levels as f64),
        () if wrong.contains(&"levels_even") => {
            base + (finest - base) * l as f64 / (levels.max(2) - 1) as f64
        }
        () if wrong.contains(&"resolution_doubled") => libm::ldexp(1.0, l as i32),
        () if wrong.contains(&"resolution_rounded_up") => n_of(a, l).ceil(),
        () => n_of(a, l),
    };
    let n = |l: usize| growth.map_or_else(|| usual(l), |k| base * pow(k, l as f64));
    let mut out = levels_of(a, n, c);
    if wrong.contains(&"one_cell_less") {
        for level in &mut out {
            (level.scale, level.last, level.side) =
                (level.scale - 1.0, level.last.max(1) - 1, level.side.max(2) - 1);
        }
    }
    if let Some(cells) = OFFSET_HALF.among(wrong) {
        out.iter_mut().for_each(|level| level.shift += cells);
    }
    out
}

/// The entry of a vertex of level l as the mistakes have it.
fn wrong_entry((l, level): (usize, &Level), [x, y, z]: [u32; 3], wrong: &[&str]) -> usize {
    let entries = level.table.nrows();
    let first = u32::from(wrong.contains(&"vertices_from_one"));
    let [x, y, z] = [x + first, y + first, z + first];
    let cells = (level.side as usize).saturating_sub(1);
    if level.dense()
        || wrong.contains(&"dense_by_cells") && cells.checked_pow(3).is_some_and(|n| n <= entries)
    {
        let side = level.side as usize - usize::from(wrong.contains(&"side_without_one"));
        let [x, y, z] = if wrong.contains(&"z_fastest") { [z, y, x] } else { [x, y, z] };
        return (x as usize + side * (y as usize + side * z as usize)) % entries;
    }
    let mut primes = primes(level.primes);
    for name in wrong {
        match *name {
            "prime_mistyped" => primes[1] = 265_443_567,
            "primes_of_cloth" => primes = [73_856_093, 19_349_663, 83_492_791],
            "primes_of_cloth_but_the_first" => primes = [1, 19_349_663, 83_492_791],
            "primes_from_the_second" => primes = [2_654_435_761, 805_459_861, 3_674_653_429],
            "primes_rolled" => primes.rotate_left(1),
            "primes_exchanged" => primes.swap(1, 2),
            _ => {}
        }
    }
    let [x, y, z] = [x.wrapping_mul(primes[0]), y.wrapping_mul(primes[1]), z.wrapping_mul(primes[2])];
    let hash = match () {
        () if wrong.contains(&"sum_for_xor") => x.wrapping_add(y).wrapping_add(z),
        () if wrong.contains(&"and_for_xor") => x & y & z,
        () if wrong.contains(&"level_in_the_hash") => (x ^ y ^ z).wrapping_add(l as u32),
        () => x ^ y ^ z,
    };
    hash as usize % if wrong.contains(&"modulo_one_less") { entries - 1 } else { entries }
}

/// Cell and weight of the upper side along one axis as the mistakes have them.
fn wrong_cell(level: &Level, x: f64, wrong: &[&str]) -> (u32, f64) {
    let (cell, mut fraction) = level.cell(x);
    for name in wrong {
        match *name {
            "nearest_vertex" => fraction = f64::from(u8::from(fraction >= 0.5)),
            "lower_vertex_alone" => fraction = 0.0,
            "weights_swapped" => fraction = 1.0 - fraction,
            _ => {}
        }
    }
    (cell, level.weight(fraction))
}

/// The weight of corner k as the mistakes have it: bit i of k says which side along axis i.
fn wrong_weight(k: usize, cells: [(u32, f64); 3], right: f64, wrong: &[&str]) -> f64 {
    let has = |name: &str| wrong.contains(&name);
    let side = |axis: usize, upper: bool| if upper { cells[axis].1 } else { 1.0 - cells[axis].1 };
    let bits = [k & 1 == 1, k & 2 == 2, k & 4 == 4];
    match () {
        () if has("mean_of_corners") => 0.125,
        () if has("corners_added") => 1.0,
        () if has("last_axis_unweighted") => side(0, bits[0]) * side(1, bits[1]),
        () if has("one_face_alone") && bits[2] => 0.0,
        () if has("one_face_alone") => side(0, bits[0]) * side(1, bits[1]),
        () if has("weights_of_mirrored_corners") => (0..3).map(|axis| side(axis, bits[2 - axis])).product(),
        () if has("corners_around_squares") => {
            side(0, bits[0]) * side(1, bits[1]) * side(2, bits[2] != bits[1])
        }
        () => right,
    }
}

fn encode(levels: &[Level], x: [f64; 3], wrong: &[&str]) -> Vec<f64> {
    let mut out = vec![];
    for (l, level) in levels.iter().enumerate() {
        let cells = x.map(|x| wrong_cell(level, x, wrong));
        let mut features = vec![0.0; level.table.ncols()];
        for k in 0..8 {
            let (vertex, right) = corner(k, cells);
            let weight = wrong_weight(k, cells, right, wrong);
            let entry = level.table.row(wrong_entry((l, level), vertex, wrong));
            features.iter_mut().zip(entry).for_each(|(feature, entry)| *feature += weight * entry);
        }
        out.extend(features);
    }
    if wrong.contains(&"feature_by_feature") && !levels.is_empty() {
        let width = out.len() / levels.len();
        out = (0..out.len()).map(|n| out[n % levels.len() * width + n / levels.len()]).collect();
    }
    out
}

/// The encoding.
pub(crate) fn hash_grid(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let levels = wrong_levels(a, c, wrong);
    forward(a, |x| if wrong.is_empty() { oracle(&levels, x) } else { encode(&levels, x, wrong) })
}

/// Its gradient.
pub(crate) fn hash_grid_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut right = arrays::hash_grid_vjp(a, c);
    let levels = levels(a, c);
    if wrong.contains(&"resolution_forgotten") {
        let (mut g_x, scratch) = (vec![], &mut zeros(&levels));
        for (x, g) in points(a).into_iter().zip(rows(a, "grad_encoding")) {
            let (mut sum, mut first) = ([0.0; 3], 0);
            for (l, level) in levels.iter().enumerate() {
                let g = &g[first..first + level.table.ncols()];
                first += g.len();
                let one = backward::encode(&levels[l..=l], x, g, &mut scratch[l..=l]);
                (0..3).for_each(|i| sum[i] += one[i] / level.scale);
            }
            g_x.push(sum);
        }
        right.extend(gradients(&g_x, &[]));
    }
    if wrong.contains(&"collisions_overwrite") {
        let mut last = zeros(&levels);
        for (x, g) in points(a).into_iter().zip(rows(a, "grad_encoding")) {
            let mut first = 0;
            for (level, last) in levels.iter().zip(&mut last) {
                let cells = x.map(|x| level.cell(x)).map(|(cell, f)| (cell, level.weight(f)));
                for k in 0..8 {
                    let (vertex, weight) = corner(k, cells);
                    let mut entry = last.table.row_mut(level.entry(vertex));
                    entry.iter_mut().zip(&g[first..]).for_each(|(entry, g)| *entry = weight * g);
                }
                first += level.table.ncols();
            }
        }
        let g_x = right.remove("grad_x").expect("an output");
        right = gradients(&[], &last);
        right.insert("grad_x".into(), g_x);
    }
    right
}
