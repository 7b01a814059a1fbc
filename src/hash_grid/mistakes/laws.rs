//! Laws of hash grids: how many cells a level has, where a point lies in them, which entry a vertex has, and how entries are mixed.

use super::super::arrays::{by_level, level, n_of};
use super::super::{Level, corner, encode, primes};
use crate::contract::laws::Laws;

/// A level's cells along an edge.
const CELLS: [&str; 6] = [
    "as they are by convention",
    "n, not rounded",
    "n rounded up",
    "n rounded down, less one where it is whole",
    "n rounded down",
    "n rounded to the nearest",
];

/// Where x lies.
const PLACE: [&str; 6] = ["x N", "x (N - 1)", "x (N + 1)", "x N + 1/2", "x (N - 1) + 1/2", "x, not scaled"];

/// The vertices of its cell.
const VERTICES: [&str; 7] = [
    "floor and the next, the last cell closed",
    "floor and the next, none held",
    "floor and the next, held at N - 1",
    "floor and ceil",
    "floor and the next, held at N",
    "floor and the next, of a place held below N - 1",
    "floor and the next, modulo N",
];

/// Factors of the hash.
const PRIMES: [[u32; 3]; 8] = [
    [1, 2_654_435_761, 805_459_861],
    [73_856_093, 19_349_663, 83_492_791],
    [1, 19_349_663, 83_492_791],
    [1_540_171, 1_721_003, 1_890_971],
    [19_349_663, 96_925_573, 76_923_077],
    [1_958_374_283, 2_654_435_761, 805_459_861],
    [2_654_435_761, 805_459_861, 3_674_653_429],
    [1, 1, 1],
];

/// How they are joined, in levels that aren't dense.
const JOINED: [&str; 4] = ["xor", "+", "the remainders of each, xor", "+, 32 bits of the sum"];

/// The order of a dense level's vertices.
const DENSE: [&str; 7] = [
    "x + side (y + side z)",
    "z + side (y + side x)",
    "x + N (y + N z)",
    "the hash of those",
    "x + (side + 1) (y + (side + 1) z)",
    "y + side (x + side z)",
    "the hash of those, modulo N^3",
];

/// How entries are mixed.
const MIXED: [&str; 12] = [
    "trilinear weights",
    "the lower vertex alone",
    "the nearest vertex alone",
    "the mean of all eight",
    "trilinear weights the other way around",
    "the sum of all eight",
    "trilinear weights of the fractions of z, y, x",
    "weights (1 - |x - v|) of the first axis alone",
    "trilinear weights of the fractions of x, z, y",
    "trilinear weights of the fractions of y, x, z",
    "trilinear weights of the fractions of y, z, x",
    "trilinear weights of the fractions of z, x, y",
];

/// Those of a grid.
pub(crate) const OF_GRIDS: Laws = Laws {
    choices: &[
        CELLS.len(),
        PLACE.len(),
        VERTICES.len(),
        1 + PRIMES.len() * JOINED.len(),
        DENSE.len(),
        MIXED.len(),
        2,
    ],
    says: |part, choice| match part {
        0 => format!("N = {}", CELLS[choice]),
        1 => format!("{} for a point's place", PLACE[choice]),
        2 => format!("vertices {}", VERTICES[choice]),
        3 => {
            let [p, q, r] = PRIMES[(choice - 1) / JOINED.len()];
            format!("hash of x {p}, y {q}, z {r} joined by {}", JOINED[(choice - 1) % JOINED.len()])
        }
        4 => format!("dense entry {}", DENSE[choice]),
        5 => MIXED[choice].into(),
        _ => "z, y, x for x, y, z in the hash".into(),
    },
    of: |a, c, law| {
        let of_level = |l: usize| {
            let n = n_of(a, l);
            let cells = match law[0] {
                1 => n,
                2 => n.ceil(),
                3 if n.fract() == 0.0 => n - 1.0,
                3 | 4 => n.floor(),
                5 => n.round(),
                _ => n,
            };
            let mut own = level(a, cells.floor().max(1.0), l, c);
            if law[0] == 0 {
                own = level(a, n, l, c);
            } else {
                own.scale += cells - cells.floor();
            }
            own
        };
        by_level(a, of_level, |level, x| {
            if law[1..].iter().all(|choice| *choice == 0) {
                return encode(std::slice::from_ref(level), x);
            }
            features(level, x, law)
        })
    },
    rounding: &[],
};

/// A point's cell along an axis: its two vertices and its fraction.
fn cell(level: &Level, x: f64, law: &[usize]) -> ([u32; 2], f64) {
    let n = f64::from(level.last) + 1.0;
    let place = match law[1] {
        0 => x * level.scale + level.shift,
        1 => x * (n - 1.0),
        2 => x * (n + 1.0),
        3 => x * n + 0.5,
        4 => x * (n - 1.0) + 0.5,
        _ => x,
    };
    let floor = place.floor().max(0.0);
    match law[2] {
        0 => {
            let low = floor.min(f64::from(level.last));
            ([low as u32, low as u32 + 1], level.weight(place - low))
        }
        1 => ([floor as u32, floor as u32 + 1], level.weight(place - floor)),
        2 => {
            let held = |v: f64| v.min(n - 1.0) as u32;
            ([held(floor), held(floor + 1.0)], level.weight(place - floor))
        }
        3 => ([floor as u32, place.ceil() as u32], level.weight(place - floor)),
        5 => {
            let place = place.min(n - 1.0001).max(0.0);
            ([place as u32, place as u32 + 1], level.weight(place.fract()))
        }
        6 => {
            let wrapped = |v: f64| (v % n) as u32;
            ([wrapped(floor), wrapped(floor + 1.0)], level.weight(place - floor))
        }
        _ => {
            let held = |v: f64| v.min(n) as u32;
            ([held(floor), held(floor + 1.0)], level.weight(place - floor))
        }
    }
}

/// A vertex' entry.
fn entry(level: &Level, [x, y, z]: [u32; 3], law: &[usize]) -> usize {
    let (entries, side) = (level.table.nrows(), u64::from(level.side));
    let hashed = [3, 6].contains(&law[4]);
    if level.dense() && !hashed {
        let by = |x: u32, y: u32, z: u32, side: u64| {
            ((u64::from(x) + side * (u64::from(y) + side * u64::from(z))) % entries as u64) as usize
        };
        return match law[4] {
            0 => by(x, y, z, side),
            1 => by(z, y, x, side),
            2 => by(x, y, z, side - 1),
            4 => by(x, y, z, side + 1),
            _ => by(y, x, z, side),
        };
    }
    let [x, y, z] = if law[6] == 1 { [z, y, x] } else { [x, y, z] };
    let (factors, joined) = match law[3].checked_sub(1) {
        None => (primes(level.primes), 0),
        Some(n) => (PRIMES[n / JOINED.len()], n % JOINED.len()),
    };
    // A table of its own size for each level, as far as there are so many.
    let entries = if law[4] == 6 { entries.min((level.last as usize + 1).pow(3)) } else { entries };
    let part = |v: u32, p: u32| v.wrapping_mul(p);
    let [p, q, r] = [part(x, factors[0]), part(y, factors[1]), part(z, factors[2])];
    let whole = |v: u32, p: u32| u64::from(v) * u64::from(p);
    match joined {
        0 => (p ^ q ^ r) as usize % entries,
        1 => ((whole(x, factors[0]) + whole(y, factors[1]) + whole(z, factors[2])) % entries as u64) as usize,
        3 => p.wrapping_add(q).wrapping_add(r) as usize % entries,
        _ => [p, q, r].iter().fold(0, |hash, p| hash ^ (*p as usize % entries)) % entries,
    }
}

fn features(level: &Level, x: [f64; 3], law: &[usize]) -> Vec<f64> {
    let cells = x.map(|x| cell(level, x, law));
    let fractions = cells.map(|(_, f)| f);
    let seen = match law[5] {
        6 => [fractions[2], fractions[1], fractions[0]],
        8 => [fractions[0], fractions[2], fractions[1]],
        9 => [fractions[1], fractions[0], fractions[2]],
        10 => [fractions[1], fractions[2], fractions[0]],
        11 => [fractions[2], fractions[0], fractions[1]],
        4 => fractions.map(|f| 1.0 - f),
        _ => fractions,
    };
    let nearest = (0..3).fold(0, |k, a| if fractions[a] >= 0.5 { k | 1 << a } else { k });
    let mut out = vec![0.0; level.table.ncols()];
    for k in 0..8 {
        let (_, weight) = corner(k, seen.map(|f| (0, f)));
        let weight = match law[5] {
            1 => f64::from(u8::from(k == 0)),
            2 => f64::from(u8::from(k == nearest)),
            3 => 0.125,
            5 => 1.0,
            7 if k & 1 == 1 => seen[0] / 4.0,
            7 => (1.0 - seen[0]) / 4.0,
            _ => weight,
        };
        if weight == 0.0 {
            continue;
        }
        let vertex = [0, 1, 2].map(|a| cells[a].0[k >> a & 1]);
        let row = entry(level, vertex, law);
        out.iter_mut().enumerate().for_each(|(f, out)| *out += weight * level.table[[row, f]]);
    }
    out
}
