//! The hash grid, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{self, count, forward, gradients, levels, levels_of, points, zeros};
use super::{Level, PRIMES, backward, cell, corner, encode as oracle, resolutions};
use crate::contract::arrays::{Arrays, number, rows};
use crate::convention::Conventions;
use crate::math::pow;

mod catalogue;

pub use catalogue::HASH_GRID;

/// The levels' resolutions as the mistakes have them.
fn wrong_resolutions(a: &Arrays, wrong: &[&str]) -> Vec<u32> {
    let (base, finest, levels) = (number(a, "base"), number(a, "finest"), count(a));
    let steps = if wrong.contains(&"growth_over_levels") { levels } else { levels.max(2) - 1 } as f64;
    let exact = |l: usize| base * pow(finest / base, l as f64 / steps);
    match () {
        // Rounded up to a whole number where the power misses it by a rounding.
        () if wrong.contains(&"resolution_rounded_down") => {
            (0..levels).map(|l| (exact(l) + 1e-9).floor() as u32).collect()
        }
        () if wrong.contains(&"resolution_rounded_up") => {
            (0..levels).map(|l| (exact(l) - 1e-9).ceil() as u32).collect()
        }
        () if wrong.contains(&"growth_over_levels") => (0..levels).map(|l| exact(l).round() as u32).collect(),
        () => resolutions(base as u32, finest as u32, levels),
    }
}

/// The entry of a vertex as the mistakes have it.
fn wrong_entry(level: &Level, [x, y, z]: [u32; 3], wrong: &[&str]) -> usize {
    let entries = level.table.len();
    if level.dense() && !wrong.contains(&"no_dense_levels") {
        let side = level.resolution as usize + usize::from(!wrong.contains(&"side_without_one"));
        let [x, y, z] = if wrong.contains(&"z_fastest") { [z, y, x] } else { [x, y, z] };
        return (x as usize + side * (y as usize + side * z as usize)) % entries;
    }
    let mut primes = PRIMES;
    for name in wrong {
        match *name {
            "first_prime_not_one" => primes[0] = 1_958_374_283,
            "prime_mistyped" => primes[1] = 265_443_567,
            "primes_rolled" => primes = [PRIMES[1], PRIMES[2], PRIMES[0]],
            _ => {}
        }
    }
    let [x, y, z] = [x.wrapping_mul(primes[0]), y.wrapping_mul(primes[1]), z.wrapping_mul(primes[2])];
    let hash = if wrong.contains(&"sum_for_xor") { x.wrapping_add(y).wrapping_add(z) } else { x ^ y ^ z };
    hash as usize % if wrong.contains(&"modulo_one_less") { entries - 1 } else { entries }
}

/// Cell and fraction along one axis as the mistakes have them.
fn wrong_cell(x: f64, resolution: u32, wrong: &[&str]) -> (u32, f64) {
    let (mut cell, mut fraction) = cell(x, resolution);
    for name in wrong {
        match *name {
            "offset_half" => {
                let scaled = x * f64::from(resolution) + 0.5;
                cell = scaled.floor().min(f64::from(resolution - 1)) as u32;
                fraction = scaled - f64::from(cell);
            }
            "nearest_vertex" => fraction = f64::from(u8::from(fraction >= 0.5)),
            "weights_swapped" => fraction = 1.0 - fraction,
            "smoothstep" => fraction = fraction * fraction * (3.0 - 2.0 * fraction),
            _ => {}
        }
    }
    (cell, fraction)
}

fn encode(levels: &[Level], x: [f64; 3], wrong: &[&str]) -> Vec<f64> {
    let mut out = vec![];
    for level in levels {
        let cells = x.map(|x| wrong_cell(x, level.resolution, wrong));
        let mut features = vec![0.0; level.table[0].len()];
        for k in 0..8 {
            let (vertex, weight) = corner(k, cells);
            let entry = &level.table[wrong_entry(level, vertex, wrong)];
            features.iter_mut().zip(entry).for_each(|(feature, entry)| *feature += weight * entry);
        }
        out.extend(features);
    }
    out
}

/// The encoding.
pub fn hash_grid(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let levels = levels_of(a, &wrong_resolutions(a, wrong));
    forward(a, |x| if wrong.is_empty() { oracle(&levels, x) } else { encode(&levels, x, wrong) })
}

/// Its gradient.
pub fn hash_grid_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut right = arrays::hash_grid_vjp(a, c);
    let levels = levels(a);
    if wrong.contains(&"resolution_forgotten") {
        let (mut g_x, scratch) = (vec![], &mut zeros(&levels));
        for (x, g) in points(a).into_iter().zip(rows(a, "grad_encoding")) {
            let (mut sum, mut first) = ([0.0; 3], 0);
            for (l, level) in levels.iter().enumerate() {
                let g = &g[first..first + level.table[0].len()];
                first += g.len();
                let one = backward::encode(&levels[l..=l], x, g, &mut scratch[l..=l]);
                (0..3).for_each(|i| sum[i] += one[i] / f64::from(level.resolution));
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
                let cells = x.map(|x| cell(x, level.resolution));
                for k in 0..8 {
                    let (vertex, weight) = corner(k, cells);
                    let entry = &mut last.table[level.entry(vertex)];
                    entry.iter_mut().zip(&g[first..]).for_each(|(entry, g)| *entry = weight * g);
                }
                first += level.table[0].len();
            }
        }
        let g_x = right.remove("grad_x").expect("an output");
        right = gradients(&[], &last);
        right.insert("grad_x".into(), g_x);
    }
    right
}
