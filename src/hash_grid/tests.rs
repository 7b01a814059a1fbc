//! Closed forms and properties of the hash grid.

use approx::assert_abs_diff_eq;
use ndarray::{Array2, arr1};

use super::{Level, backward, encode, growing, is_dense, primes, resolutions};
use crate::convention::{CHOICES, CS180, Conventions, HashIndex, HashLevels, HashPrimes, HashWeights};
use crate::random::{Key, Purpose};

/// Numbers an entry.
const FEATURES: usize = 4;

const KEY: fn() -> Key = || Key::new(0, Purpose::Cases);

/// Levels of these sides, filled with numbers that are exact in f32 too.
pub(super) fn random_levels(sides: &[u32], max_entries: usize) -> Vec<Level> {
    let fill = |(l, &n): (usize, &u32)| {
        let mut level = Level::zeros(n, max_entries, FEATURES);
        for ((i, f), x) in level.table.indexed_iter_mut() {
            // Numbers of 10 bits: exact in f32 too.
            *x = (KEY().below(1024, l as u64, i as u64, f as u64) as f64 - 512.0) / 512.0;
        }
        level
    };
    sides.iter().enumerate().map(fill).collect()
}

pub(super) fn points(n: u64) -> Vec<[f64; 3]> {
    let coordinate = |i, a| KEY().below(1 << 14, 99, i, a) as f64 / f64::from(1 << 14);
    (0..n).map(|i| [0, 1, 2].map(|a| coordinate(i, a))).collect()
}

/// A table that holds a linear function is interpolated to that function.
#[test]
fn linear_functions_are_reproduced() {
    let n = 5;
    let mut level = Level::zeros(n, 1 << 10, 1);
    for (x, y, z) in (0..216).map(|i| (i % 6, i / 6 % 6, i / 36)) {
        let at = level.entry([x, y, z]);
        level.table[[at, 0]] = f64::from(x) - 2.0 * f64::from(y) + 0.5 * f64::from(z);
    }
    for p in points(100).into_iter().chain([[0.0; 3], [1.0; 3], [0.2, 0.4, 0.6]]) {
        let expected = 5.0 * (p[0] - 2.0 * p[1] + 0.5 * p[2]);
        assert_abs_diff_eq!(encode(&[level.clone()], p)[0], expected, epsilon = 1e-13);
    }
}

/// Weights are a partition of unity: a constant table gives the constant, dense or hashed.
#[test]
fn constants_are_kept() {
    for (n, entries) in [(4, 125), (40, 64)] {
        let mut level = Level::zeros(n, entries, 2);
        level.table.rows_mut().into_iter().for_each(|mut e| e.assign(&arr1(&[3.0, -1.0])));
        for p in points(50) {
            let e = encode(std::slice::from_ref(&level), p);
            assert_abs_diff_eq!(e[0], 3.0, epsilon = 1e-14);
            assert_abs_diff_eq!(e[1], -1.0, epsilon = 1e-14);
        }
    }
}

#[test]
fn dense_levels_have_no_collisions() {
    let level = Level::zeros(6, 343, 1);
    assert!(level.dense() && !is_dense(7, 343));
    let mut seen = vec![false; level.table.nrows()];
    for (x, y, z) in (0..343).map(|i| (i % 7, i / 7 % 7, i / 49)) {
        assert!(!std::mem::replace(&mut seen[level.entry([x, y, z])], true));
    }
}

/// By hand: (3 xor 5 * 2654435761 xor 7 * 805459861) mod 2^32 mod 16.
#[test]
fn hash_by_hand() {
    let level = Level::zeros(100, 16, 1);
    let (y, z) = (5u64 * 2_654_435_761 % (1 << 32), 7u64 * 805_459_861 % (1 << 32));
    assert_eq!(level.entry([3, 5, 7]), ((3 ^ y ^ z) % 16) as usize);
}

#[test]
fn resolutions_grow_geometrically() {
    assert_eq!(resolutions(16, 16, 1), [16]);
    let n = resolutions(16, 400, 8);
    assert_eq!((n[0], n[7]), (16, 400));
    n.windows(2).for_each(|w| assert!((1.5..1.65).contains(&(f64::from(w[1]) / f64::from(w[0])))));
}

/// 10 to the power of l + 1: the power alone misses some of them by its rounding. What lies between whole numbers stays there.
#[test]
fn growth_is_whole_where_it_should_be() {
    for l in 0..6 {
        assert_eq!(growing(10, 1_000_000, 6, l), 10f64.powi(l as i32 + 1));
    }
    assert_ne!(10.0 * crate::math::pow(1e5, 3.0 / 5.0), 1e4);
    assert_abs_diff_eq!(growing(2, 3, 3, 1), 6f64.sqrt(), epsilon = 1e-15);
}

#[test]
fn a_level_keeps_its_conventions() {
    let c = Conventions {
        hash_index: HashIndex::Hashed,
        hash_primes: HashPrimes::Reversed,
        hash_weights: HashWeights::Smoothstep,
        ..CS180
    };
    let level = Level::by_convention(6.5, Array2::default([0, 0]), &c);
    assert_eq!((level.index, level.primes, level.weights), (c.hash_index, c.hash_primes, c.hash_weights));
}

/// Level 1 of three from 3 to 25: n = sqrt(75) = 8.66.
#[test]
fn levels_lie_on_the_box_as_their_convention_says() {
    let n = growing(3, 25, 3, 1);
    assert_abs_diff_eq!(n, 75f64.sqrt(), epsilon = 1e-14);
    let at = |hash_levels, n| {
        let level = Level::by_convention(n, Array2::default([0, 0]), &Conventions { hash_levels, ..CS180 });
        (level.scale, level.shift, level.last, level.side)
    };
    assert_eq!(at(HashLevels::Nearest, n), (9.0, 0.0, 8, 10));
    assert_eq!(at(HashLevels::Floor, n), (8.0, 0.0, 7, 9));
    // x (n - 1) + 1/2: x = 1 lies at 8.16, in cell 8, whose upper vertex is the last of 9.
    assert_eq!(at(HashLevels::TinyCudaNn, n), (n - 1.0, 0.5, 8, 9));
    assert_eq!(at(HashLevels::TorchNgp, n), (n - 1.0, 0.5, 8, 10));
    assert_eq!(at(HashLevels::AlignCorners, n), (n - 1.0, 0.0, 7, 9));
    // A whole number of cells.
    assert_eq!(at(HashLevels::TinyCudaNn, 16.0), (15.0, 0.5, 15, 16));
    assert_eq!((growing(3, 25, 3, 0), growing(3, 25, 3, 2)), (3.0, 25.0));
}

/// By hand: tiny-cuda-nn's level of n = 3 in dimension one, with entries 0, 1, 4, 9 along x, at x = 0.6: 0.6 * 2 + 0.5 = 1.7.
#[test]
fn tiny_cuda_nn_by_hand() {
    let c = Conventions { hash_levels: HashLevels::TinyCudaNn, ..CS180 };
    // 3 vertices along an edge: the fourth along x is the first of the next row.
    let table = Array2::from_shape_fn([32, 1], |(i, _)| (i * i) as f64);
    let level = Level::by_convention(3.0, table, &c);
    assert_eq!(level.cell(1.0), (2, 0.5));
    // y and z at -1/2 of a cell don't exist: x = 0 lies at 1/2, between vertices 0 and 1.
    let along = |x: f64| {
        let row = |first: usize| {
            let at = |i: usize| ((first + i) * (first + i)) as f64;
            let p = x * 2.0 + 0.5;
            at(p as usize) * (1.0 - p.fract()) + at(p as usize + 1) * p.fract()
        };
        // y = z = 0: halves of the rows 0 and 3, and of the planes 0 and 9.
        (row(0) + row(3) + row(9) + row(12)) / 4.0
    };
    for x in [0.0, 0.3, 0.6, 1.0] {
        assert_abs_diff_eq!(
            encode(std::slice::from_ref(&level), [x, 0.0, 0.0])[0],
            along(x),
            epsilon = 1e-12
        );
    }
}

#[test]
fn factors_and_dense_levels_by_convention() {
    assert_eq!(primes(HashPrimes::Prime), [1_958_374_283, 2_654_435_761, 805_459_861]);
    let table = Array2::zeros([64, 1]);
    let of = |c: Conventions| Level::by_convention(3.0, table.clone(), &c);
    assert!(of(CS180).dense());
    let hashed = of(Conventions { hash_index: HashIndex::Hashed, ..CS180 });
    assert!(!hashed.dense());
    let product = |factor: u64, x: u64| factor * x % (1 << 32);
    let by_hand = |p: [u64; 3]| ((product(p[0], 3) ^ product(p[1], 1) ^ product(p[2], 2)) % 64) as usize;
    assert_eq!(hashed.entry([3, 1, 2]), by_hand([1, 2_654_435_761, 805_459_861]));
    let reversed = Level { primes: HashPrimes::Reversed, ..hashed.clone() };
    assert_eq!(reversed.entry([3, 1, 2]), by_hand([2_165_219_737, 1_434_869_437, 2_097_192_037]));
}

/// 3 f^2 - 2 f^3 is 0, 1/2, 1 at 0, 1/2, 1, and flat at both ends.
#[test]
fn smoothstep_is_flat_at_vertices() {
    let mut level = Level::zeros(1, 8, 1);
    level.weights = HashWeights::Smoothstep;
    level.table[[1, 0]] = 1.0;
    let at = |x: f64| encode(std::slice::from_ref(&level), [x, 0.0, 0.0])[0];
    assert_eq!([0.0, 0.25, 0.5, 1.0].map(at), [0.0, 0.15625, 0.5, 1.0]);
    let slope = |x: f64| {
        backward::encode(std::slice::from_ref(&level), [x, 0.0, 0.0], &[1.0], &mut [level.clone()])[0]
    };
    assert_eq!([0.0, 0.5, 1.0].map(slope), [0.0, 1.5, 0.0]);
}

/// Continuous across cell faces: from both sides of a face the value is the face's.
#[test]
fn continuous_across_faces() {
    let levels = random_levels(&[4, 9], 128);
    for face in [0.25, 0.5, 0.75] {
        let at = |x| encode(&levels, [x, 0.3, 0.7]);
        for (below, above) in at(face - 1e-12).iter().zip(at(face + 1e-12)) {
            assert_abs_diff_eq!(*below, above, epsilon = 1e-10);
        }
    }
}

#[test]
fn gradients_are_finite_differences() {
    let each = |key: &str| CHOICES.iter().find(|(name, _)| *name == key).unwrap().1;
    for hash_levels in each("hash_levels") {
        for hash_weights in each("hash_weights") {
            let c =
                CS180.with("hash_levels", hash_levels).unwrap().with("hash_weights", hash_weights).unwrap();
            let levels = random_levels(&[3, 20], 64);
            let lay = |level: Level| Level::by_convention(level.scale - 0.25, level.table, &c);
            gradients_of(&levels.into_iter().map(lay).collect::<Vec<_>>());
        }
    }
}

fn gradients_of(levels: &[Level]) {
    let x = [0.37, 0.81, 0.12];
    let g_out: Vec<f64> = (0..2 * FEATURES).map(|i| 0.5 - i as f64 * 0.3).collect();
    let loss =
        |levels: &[Level], x: [f64; 3]| encode(levels, x).iter().zip(&g_out).map(|(e, g)| e * g).sum::<f64>();
    let mut g_tables: Vec<Level> = levels.to_vec();
    g_tables.iter_mut().for_each(|l| l.table.fill(0.0));
    let g_x = backward::encode(levels, x, &g_out, &mut g_tables);
    // Linear or cubic in x inside a cell along one axis, linear in the tables: central differences are nearly exact.
    for a in 0..3 {
        let step = |h: f64| std::array::from_fn(|b| if a == b { x[b] + h } else { x[b] });
        let slope = (loss(levels, step(1e-5)) - loss(levels, step(-1e-5))) / 2e-5;
        // h^2 / 6 times a third derivative of 12 N^3.
        assert_abs_diff_eq!(g_x[a], slope, epsilon = 1e-5);
    }
    for l in 0..2 {
        for entry in 0..levels[l].table.nrows() {
            let mut moved = levels.to_vec();
            moved[l].table[[entry, 1]] += 1.0;
            let slope = loss(&moved, x) - loss(levels, x);
            assert_abs_diff_eq!(g_tables[l].table[[entry, 1]], slope, epsilon = 1e-12);
        }
    }
}

/// PE6: at a face the value is continuous and the derivative jumps: from below it is the lower cell's, at the face the upper cell's.
#[test]
fn pe6_derivatives_jump_at_faces() {
    let levels = random_levels(&[4], 128);
    let g_out = [1.0; FEATURES];
    let slope = |x: f64| {
        let mut g_tables = levels.clone();
        backward::encode(&levels, [x, 0.3, 0.7], &g_out, &mut g_tables)[0]
    };
    let value = |x: f64| encode(&levels, [x, 0.3, 0.7]).iter().sum::<f64>();
    let one_sided = |h: f64| (value(0.5 + h) - value(0.5)) / h;
    assert_abs_diff_eq!(slope(0.5), one_sided(0.01), epsilon = 1e-10);
    assert_abs_diff_eq!(slope(0.5 - 1e-9), one_sided(-0.01), epsilon = 1e-6);
    assert!((slope(0.5) - slope(0.5 - 1e-9)).abs() > 0.1);
    // The end of the box belongs to its last cell.
    assert_abs_diff_eq!(slope(1.0), (value(1.0) - value(0.99)) / 0.01, epsilon = 1e-10);
}
