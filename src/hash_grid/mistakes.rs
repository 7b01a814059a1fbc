//! The hash grid, wrong on purpose. Without a mistake every function equals the oracle.

use std::ops::Range;

use super::arrays::{self, count, forward, gradients, levels, levels_of, n_of, points, zeros};
use super::{Level, backward, corner, encode as oracle, growing, primes};
use crate::contract::arrays::{Arrays, number, rows};
use crate::contract::component::number_of;
use crate::convention::Conventions;
use crate::math::pow;

mod catalogue;
mod digits;
pub(crate) mod laws;
mod levels;

pub(crate) use catalogue::HASH_GRID;
use catalogue::{OFFSET_HALF, OTHER_GROWTH};

/// The levels as the mistakes have them.
fn wrong_levels(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Vec<Level> {
    let (mut base, mut finest, levels) = (number(a, "base"), number(a, "finest"), count(a));
    finest = number_of("finest_of_its_own", HASH_GRID, wrong).unwrap_or(finest);
    base = number_of("base_of_its_own", HASH_GRID, wrong).unwrap_or(base);
    let other = finest != number(a, "finest") || base != number(a, "base");
    let steps = (levels.max(2) - 1) as f64;
    let growth = OTHER_GROWTH.among(wrong);
    let usual = |l: usize| match () {
        () if wrong.contains(&"growth_over_levels") => base * pow(finest / base, l as f64 / levels as f64),
        () if wrong.contains(&"levels_even") => base + (finest - base) * l as f64 / steps,
        () if wrong.contains(&"growth_from_the_second") => {
            base * pow(finest / base, (l + 1) as f64 / levels as f64)
        }
        () if wrong.contains(&"rounded_level_by_level") => {
            (0..l).fold(base, |n, _| libm::rint(n * pow(finest / base, 1.0 / steps)))
        }
        () if other => growing(base as u32, finest as u32, levels, l),
        () if wrong.contains(&"resolution_doubled") => libm::ldexp(1.0, l as i32),
        () if wrong.contains(&"resolution_rounded_up") => n_of(a, l).ceil(),
        () => n_of(a, l),
    };
    let replaced = number_of("base_replaced", HASH_GRID, wrong).map_or(1.0, |own| own / base);
    let n = |l: usize| replaced * growth.map_or_else(|| usual(l), |k| base * pow(k, l as f64));
    let mut out = levels_of(a, n, c);
    if wrong.contains(&"one_cell_less") {
        for level in &mut out {
            (level.scale, level.last, level.side) =
                (level.scale - 1.0, level.last.max(1) - 1, level.side.max(2) - 1);
        }
    }
    if wrong.contains(&"one_cell_more") {
        for level in &mut out {
            (level.scale, level.last, level.side) = (level.scale + 1.0, level.last + 1, level.side + 1);
        }
    }
    if wrong.contains(&"resolution_not_rounded") {
        for (l, level) in out.iter_mut().enumerate() {
            (level.scale, level.last, level.side) = (n(l), n(l) as u32, n(l) as u32 + 2);
        }
    }
    if wrong.contains(&"half_cell_back") {
        out.iter_mut().for_each(|level| level.shift = -0.5);
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
    let dense = match () {
        () if wrong.contains(&"first_level_dense_alone") && l > 0 => false,
        () if wrong.contains(&"dense_only_below") => {
            level.dense() && (level.side as usize).checked_pow(3).is_some_and(|n| n < entries)
        }
        () if wrong.contains(&"dense_by_cells") => {
            level.dense() || cells.checked_pow(3).is_some_and(|n| n <= entries)
        }
        () => level.dense(),
    };
    if dense {
        let side = level.side as usize - usize::from(wrong.contains(&"side_without_one"));
        let [x, y, z] = match () {
            () if wrong.contains(&"z_fastest") => [z, y, x],
            () if wrong.contains(&"y_slowest") => [x, z, y],
            () => [x, y, z],
        };
        let rows = if wrong.contains(&"side_not_squared") { 1 } else { side };
        return (x as usize + side * y as usize + side * rows * z as usize) % entries;
    }
    let mut primes = primes(level.primes);
    for name in wrong {
        match *name {
            "first_prime_of_cloth" => primes[0] = 73_856_093,
            "primes_of_cloth" => primes = [73_856_093, 19_349_663, 83_492_791],
            "primes_of_cloth_but_the_first" => primes = [1, 19_349_663, 83_492_791],
            "primes_from_the_second" => primes = [2_654_435_761, 805_459_861, 3_674_653_429],
            "primes_rolled" => primes.rotate_left(1),
            "primes_exchanged" => primes.swap(1, 2),
            _ => {}
        }
    }
    if let Some(prime) = number_of("prime_mistyped", HASH_GRID, wrong) {
        primes[1] = prime as u64 as u32;
    }
    if let Some(prime) = number_of("third_prime_mistyped", HASH_GRID, wrong) {
        primes[2] = prime as u64 as u32;
    }
    if ["products_in_floats", "products_cut_off"].iter().any(|name| wrong.contains(name)) {
        let single = |v: u32, p: u32| f64::from(v as f32 * p as f32);
        let cut = wrong.contains(&"products_cut_off");
        let whole = |x: f64| if cut { x as u32 } else { x as u64 as u32 };
        let [x, y, z] = [(x, primes[0]), (y, primes[1]), (z, primes[2])].map(|(v, p)| whole(single(v, p)));
        return (x ^ y ^ z) as usize % entries;
    }
    let [x, y, z] = [x.wrapping_mul(primes[0]), y.wrapping_mul(primes[1]), z.wrapping_mul(primes[2])];
    let hash = match () {
        () if wrong.contains(&"sum_for_xor") => x.wrapping_add(y).wrapping_add(z),
        () if wrong.contains(&"and_for_xor") => x & y & z,
        () if wrong.contains(&"hash_without_z") => x ^ y,
        () if wrong.contains(&"level_xored_in") => x ^ y ^ z ^ l as u32,
        () if wrong.contains(&"hash_of_top_bits") => {
            let bits = usize::BITS - entries.saturating_sub(1).leading_zeros();
            return ((u64::from(x ^ y ^ z)) >> (32 - bits.min(32))) as usize % entries;
        }
        () if wrong.contains(&"last_factor_reduced_alone") => {
            return ((x ^ y ^ (z as usize % entries) as u32) as usize).min(entries - 1);
        }
        () if wrong.contains(&"level_in_the_hash") => (x ^ y ^ z).wrapping_add(l as u32),
        () => x ^ y ^ z,
    };
    hash as usize % if wrong.contains(&"modulo_one_less") { (entries - 1).max(1) } else { entries }
}

/// Cell and weight of the upper side along one axis as the mistakes have them.
fn wrong_cell(level: &Level, x: f64, wrong: &[&str]) -> (u32, f64) {
    let (mut cell, mut fraction) = level.cell(x);
    if wrong.contains(&"half_cell_back") {
        let held = (x * level.scale + level.shift).max(0.0);
        cell = held.floor().min(f64::from(level.last)) as u32;
        fraction = held - f64::from(cell);
    }
    if wrong.contains(&"cell_rounded") {
        let scaled = x * level.scale + level.shift;
        cell = libm::rint(scaled).clamp(0.0, f64::from(level.last)) as u32;
        fraction = scaled - f64::from(cell);
    }
    if wrong.contains(&"last_face_one_early") && fraction == 1.0 {
        fraction = 0.0;
    }
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
    let cells = if has("y_weighs_z") { [cells[0], cells[1], cells[1]] } else { cells };
    let side = |axis: usize, upper: bool| if upper { cells[axis].1 } else { 1.0 - cells[axis].1 };
    let bits = [k & 1 == 1, k & 2 == 2, k & 4 == 4];
    match () {
        () if has("mean_of_corners") => 0.125,
        () if has("corners_added") => 1.0,
        () if has("last_axis_unweighted") => side(0, bits[0]) * side(1, bits[1]),
        () if has("y_weighs_z") => (0..3).map(|axis| side(axis, bits[axis])).product(),
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
            let (mut vertex, right) = corner(k, cells);
            if wrong.contains(&"upper_vertex_held") {
                vertex = vertex.map(|v| v.min(level.side.saturating_sub(2)));
            }
            let weight = wrong_weight(k, cells, right, wrong);
            let entry = wrong_entry((l, level), vertex, wrong);
            let of = |(f, feature): (usize, &mut f64)| *feature += weight * read(levels, l, entry, f, wrong);
            features.iter_mut().enumerate().for_each(of);
        }
        out.extend(features);
    }
    let width = if levels.is_empty() { 0 } else { out.len() / levels.len() };
    if wrong.contains(&"feature_by_feature") && !levels.is_empty() {
        out = (0..out.len()).map(|n| out[n % levels.len() * width + n / levels.len()]).collect();
    }
    if wrong.contains(&"finest_first") && width > 0 {
        out = out.chunks(width).rev().flatten().copied().collect();
    }
    out
}

/// Feature f of an entry of level l, as tables in a flat buffer are read.
fn read(levels: &[Level], l: usize, entry: usize, f: usize, wrong: &[&str]) -> f64 {
    let has = |name: &str| wrong.contains(&name);
    let table = &levels[if has("first_table_for_all") { 0 } else { l }].table;
    let (entries, width) = table.dim();
    let flat = |n: usize| table[[n / width % entries, n % width]];
    match () {
        () if has("entries_overlap") => flat(entry % entries + f),
        () if has("features_apart") => flat(f * entries + entry % entries),
        () if has("levels_overlap") => {
            let mut n =
                levels[..l].iter().map(|level| level.table.nrows()).sum::<usize>() + entry * width + f;
            for level in levels {
                if n < level.table.len() {
                    return level.table[[n / level.table.ncols(), n % level.table.ncols()]];
                }
                n -= level.table.len();
            }
            0.0
        }
        () => table[[entry % entries, f % width.max(1)]],
    }
}

/// The encoding.
pub(crate) fn hash_grid(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let levels = wrong_levels(a, c, wrong);
    let all = points(a);
    let over =
        |axis: usize, larger: fn(f64, f64) -> f64| all.iter().map(|x| x[axis]).reduce(larger).unwrap_or(0.0);
    let (least, most) =
        ([0, 1, 2].map(|axis| over(axis, f64::min)), [0, 1, 2].map(|axis| over(axis, f64::max)));
    let moved = |x: [f64; 3]| match () {
        () if wrong.contains(&"halved_into_the_box") => x.map(|x| 0.5 * (x + 1.0)),
        () if wrong.contains(&"normalized_by_the_batch") => {
            [0, 1, 2].map(|axis| (x[axis] - least[axis]) / (most[axis] - least[axis]))
        }
        () => x,
    };
    forward(a, |x| if wrong.is_empty() { oracle(&levels, x) } else { encode(&levels, moved(x), wrong) })
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
    if wrong.contains(&"other_weights_left_out") {
        let slopes: Vec<[f64; 3]> = points(a)
            .into_iter()
            .zip(rows(a, "grad_encoding"))
            .map(|(x, g)| slope_alone(&levels, x, &g))
            .collect();
        right.extend(gradients(&slopes, &[]));
    }
    // Each corner's by indexed assignment, all points at once: the last of those that share an entry is added, or all there is.
    let tables = match () {
        () if wrong.contains(&"duplicates_lost") => {
            (0..8).map(|k| last_written(a, &levels, k..k + 1)).reduce(added)
        }
        () if wrong.contains(&"collisions_overwrite") => Some(last_written(a, &levels, 0..8)),
        () => None,
    };
    if let Some(tables) = tables {
        let g_x = right.remove("grad_x").expect("an output");
        right = gradients(&[], &tables);
        right.insert("grad_x".into(), g_x);
    }
    right
}

/// The gradient of a point from its corners' entries alone: + those of the upper sides, - those of the lower ones.
fn slope_alone(levels: &[Level], x: [f64; 3], g: &[f64]) -> [f64; 3] {
    let (mut sum, mut first) = ([0.0; 3], 0);
    for level in levels {
        let cells = x.map(|x| level.cell(x)).map(|(cell, f)| (cell, level.weight(f)));
        for k in 0..8 {
            let entry = level.table.row(level.entry(corner(k, cells).0));
            let dot: f64 = entry.iter().zip(&g[first..]).map(|(entry, g)| entry * g).sum();
            for axis in 0..3 {
                sum[axis] += level.scale * if k >> axis & 1 == 1 { dot } else { -dot };
            }
        }
        first += level.table.ncols();
    }
    sum
}

/// The tables' gradients where these corners' are written over each other: the last of those that share an entry.
fn last_written(a: &Arrays, levels: &[Level], corners: Range<usize>) -> Vec<Level> {
    let mut last = zeros(levels);
    for (x, g) in points(a).into_iter().zip(rows(a, "grad_encoding")) {
        let mut first = 0;
        for (level, last) in levels.iter().zip(&mut last) {
            let cells = x.map(|x| level.cell(x)).map(|(cell, f)| (cell, level.weight(f)));
            for k in corners.clone() {
                let (vertex, weight) = corner(k, cells);
                let mut entry = last.table.row_mut(level.entry(vertex));
                entry.iter_mut().zip(&g[first..]).for_each(|(entry, g)| *entry = weight * g);
            }
            first += level.table.ncols();
        }
    }
    last
}

/// The sum of two gradients, level by level.
fn added(mut sums: Vec<Level>, more: Vec<Level>) -> Vec<Level> {
    sums.iter_mut().zip(&more).for_each(|(sum, more)| sum.table += &more.table);
    sums
}
