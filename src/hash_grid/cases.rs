//! Cases of the hash grid: dense, hashed and colliding levels; points inside of cells and on their faces.

use super::{Level, resolutions};
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, signed};

/// Cells of the coarsest and the finest level, number of levels, entries of a table at most, features.
type Shape = (u32, u32, usize, usize, usize);

/// The hash grid.
pub(crate) fn hash_grid() -> Vec<Case> {
    let case = |id: &'static str, comment, (base, finest, levels, entries, features): Shape, x: Vec<f64>| {
        let (mut draw, mut spare) = (Draw::new(id, 0), Draw::new(id, 1));
        let mut inputs = vec![
            ("base".to_string(), scalar(f64::from(base))),
            ("finest".to_string(), scalar(f64::from(finest))),
            ("x".to_string(), array(&[x.len() / 3, 3], x)),
        ];
        for (l, n) in resolutions(base, finest, levels).into_iter().enumerate() {
            // A dense level doesn't use the last of its entries.
            let used = Level::zeros(n, entries, 1).table.nrows();
            let tables = [
                draw.array(&[used, features], -1.0, 1.0),
                spare.array(&[entries - used, features], -1.0, 1.0),
            ];
            inputs.push((
                format!("table{l}"),
                array(&[entries, features], tables.iter().flatten().copied().collect()),
            ));
        }
        let inputs = inputs.iter().map(|(name, array)| (name.as_str(), array.clone())).collect();
        Case::new(id, comment, inputs)
    };
    // Odd N: a short x meets no face. The finest of several levels is one where `floor` of a power may find a cell fewer (PE6).
    let seeded = |stream, n: usize| {
        let mut draw = Draw::new("hash_grid", stream);
        (0..3 * n).map(|_| draw.between(0.0, 1.0)).collect::<Vec<f64>>()
    };
    let mut fine = Draw::new("hash_grid", 7);
    let corners = (0..24).map(|i| f64::from((i / 3) >> (i % 3) & 1)).collect();
    let cases = vec![
        case("dense", "one level, every vertex with its own entry", (3, 3, 1, 64, 2), seeded(0, 8)),
        case("corners", "the box's own corners read single entries", (3, 3, 1, 64, 1), corners),
        case("hashed", "one level whose vertices share 32 entries", (7, 7, 1, 32, 2), seeded(1, 8)),
        case("PE6_dense_and_hashed", "3 cells fit into 64 entries, 7 don't", (3, 7, 2, 64, 2), seeded(2, 8)),
        case("PE6_three_levels", "3, 8.66 and 25 cells: the second has 9", (3, 25, 3, 64, 1), seeded(3, 8)),
        case(
            "PE6_four_levels",
            "3, 6.53, 14.2 and 31 cells: 7 and 14 in between",
            (3, 31, 4, 32, 2),
            seeded(4, 8),
        ),
        case(
            "PE6_first_cell",
            "one point in the first cell of each of four levels: its place in it keeps its digits",
            (3, 31, 4, 32, 2),
            vec![0.015625, 0.01171875, 0.0078125],
        ),
        case(
            "collisions",
            "8 entries: corners of one cell collide, gradients add up",
            (5, 9, 2, 8, 2),
            seeded(5, 10),
        ),
        case("four_features", "F = 4, a dense and a hashed level", (3, 7, 2, 64, 4), seeded(6, 4)),
        case(
            "PE6_overflow",
            "2048^3 vertices are 0 of them in 32 bits, and yet not dense",
            (2047, 2047, 1, 64, 1),
            (0..12).map(|_| Dtype::F32.round(fine.unit())).collect(),
        )
        // Differences for a numeric gradient cross these cells' faces.
        .forward_only(),
        case(
            "PE6_faces",
            "on faces, edges and vertices of cells: continuous, but for the derivative",
            (4, 4, 1, 128, 2),
            vec![
                0.25, 0.3125, 0.4375, 0.6875, 0.5, 0.75, 0.25, 0.5, 0.75, 0.0, 0.0625, 1.0, 1.0, 0.75, 0.125,
            ],
        ),
        case(
            "PE6_dense_switch",
            "4^3 vertices are just dense in 64 entries, 5^3 are not",
            (3, 4, 2, 64, 1),
            vec![0.5625, 0.4375, 0.1875, 0.8125, 0.5625, 0.9375, 0.0625, 0.6875, 0.4375],
        ),
        case("PE6_two_dense", "2 and 4 cells fit into 128 entries, 8 don't", (2, 8, 3, 128, 2), seeded(8, 6)),
        case(
            "PE6_centers",
            "centers of cells: all 8 corners count 1/8; half a cell further is a vertex",
            (4, 8, 2, 128, 1),
            vec![0.125, 0.375, 0.625, 0.875, 0.875, 0.125, 0.625, 0.625, 0.625],
        ),
    ];
    in_full(cases, "PE6_dense_and_hashed")
}

/// Grids of real size. The tables' gradients add up over all points, so that a gradient is judged at once.
pub(crate) fn large() -> Vec<Large> {
    let grid = |id, comment, [levels, entries, features, finest]: [usize; 4], [points, block]: [usize; 2]| {
        let large = Large::new(id, comment, points, block).with("x", &[points, 3], Recipe::Unit);
        let base = large.with("base", &[], Recipe::Constant(16.0));
        let large = base.with("finest", &[], Recipe::Constant(finest as f64));
        let table = |large: Large, l| large.with(format!("table{l}"), &[entries, features], signed(-4, 4));
        // In short types most points lie on a face of some cell.
        (0..levels).fold(large, table).in_types(&[Dtype::F64, Dtype::F32])
    };
    vec![
        grid("points_20011", "20,011 points, L = 4, T = 2^14, F = 2", [4, 1 << 14, 2, 128], [20_011, 1024]),
        grid(
            "points_100003",
            "100,003 points, L = 16, T = 2^19, N = 2048, F = 2",
            [16, 1 << 19, 2, 2048],
            [100_003, 50_002],
        )
        .forward_only(),
    ]
}
