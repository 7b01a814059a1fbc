//! Cases of the occupancy grid: points in and on cells, several in one, at the threshold; rays from faces, along them, through corners.

use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, floats, sparse};

/// (R, R, R) densities, points with their sigmas, queries.
fn update_case(
    id: &str,
    comment: &'static str,
    (resolution, density): (usize, Vec<f64>),
    points: &[[f64; 4]],
    queries: &[[f64; 3]],
    [decay, threshold]: [f64; 2],
) -> Case {
    let inputs = vec![
        ("density", array(&[resolution; 3], density)),
        ("points", array(&[points.len(), 3], points.iter().flat_map(|p| [p[0], p[1], p[2]]).collect())),
        ("sigmas", array(&[points.len()], points.iter().map(|p| p[3]).collect())),
        ("queries", array(&[queries.len(), 3], queries.concat())),
        ("decay", scalar(decay)),
        ("threshold", scalar(threshold)),
    ];
    Case::new(id, comment, inputs)
}

/// Update and queries.
pub(crate) fn update() -> Vec<Case> {
    let mut draw = Draw::new("occupancy_grid", 0);
    let mut densities = |r: usize| (r, (0..r * r * r).map(|_| draw.between(0.125, 2.0)).collect::<Vec<_>>());
    let (two, three, four) = (densities(2), densities(3), densities(4));
    let mut draw = Draw::new("occupancy_grid", 1);
    // Away from faces by at least 1/8 of a cell, whatever the resolution.
    let mut inside = |r: u64| {
        [0, 1, 2].map(|_| {
            let cell = draw.below(r) as f64;
            crate::contract::case::short((cell + 0.125 + 0.75 * draw.unit()) / r as f64)
        })
    };
    let mut random = |r: u64, n: usize| {
        let places: Vec<[f64; 3]> = (0..n).map(|_| inside(r)).collect();
        let sigma = |(i, p): (usize, &[f64; 3])| [p[0], p[1], p[2], [0.0, 0.75, 1.5, 3.0][i % 4]];
        (
            places.iter().enumerate().map(sigma).collect::<Vec<_>>(),
            (0..6).map(|_| inside(r)).collect::<Vec<_>>(),
        )
    };
    let (points4, queries4) = random(4, 12);
    let (points3, queries3) = random(3, 8);
    // Below a face by so little that a shorter type puts it on the face.
    let beside = |id, n: i32| {
        let x = 0.5 - libm::ldexp(1.0, n);
        let point = [[x, 0.25, 0.25, 5.0]];
        update_case(id, "closely below a face", two.clone(), &point, &[[0.25, x, 0.25]], [0.5, 1.75])
    };
    let beside = [beside("beside_a_face_f32", -21), beside("beside_a_face_f64", -48)];
    let mut cases = vec![
        update_case(
            "plain",
            "R = 4, points in cells, decay 0.95",
            four.clone(),
            &points4,
            &queries4,
            [0.95, 1.0],
        ),
        update_case(
            "three_cells",
            "R = 3: faces that no type holds, and no point near them",
            three,
            &points3,
            &queries3,
            [0.95, 1.0],
        ),
        update_case(
            "several_in_a_cell",
            "the largest of three counts, whatever their order",
            two.clone(),
            &[[0.25, 0.25, 0.25, 2.5], [0.375, 0.125, 0.25, 4.0], [0.125, 0.25, 0.375, 3.0]],
            &[[0.25, 0.25, 0.25], [0.75, 0.25, 0.25]],
            [0.5, 1.0],
        ),
        update_case(
            "nothing_seen",
            "no point: nothing is known, so every density stays",
            two.clone(),
            &[],
            &[[0.25, 0.75, 0.25]],
            [0.75, 0.5],
        )
        .edge("no points"),
        update_case(
            "CG3_on_faces",
            "points and queries on faces belong to the cell above, at the box's end to the last",
            two.clone(),
            &[[0.5, 0.25, 0.25, 5.0], [0.25, 0.5, 0.0, 6.0], [1.0, 1.0, 0.5, 7.0]],
            &[[0.5, 0.0, 0.0], [0.25, 0.5, 0.25], [1.0, 1.0, 1.0], [0.0, 0.0, 0.0]],
            [0.25, 2.0],
        ),
        update_case(
            "at_the_threshold",
            "as dense as the threshold is not occupied, whatever the order",
            two.clone(),
            &[[0.25, 0.25, 0.25, 1.0], [0.75, 0.25, 0.75, 1.0078125]],
            &[[0.25, 0.25, 0.25], [0.75, 0.25, 0.75]],
            [0.25, 1.0],
        ),
        update_case(
            "thin_everywhere",
            "every density below the threshold: the mean of what is above 0 decides, and the densest cells stay",
            (2, vec![0.0, 0.25, 0.125, -1.0, 0.0, 0.0, -1.0, 0.0]),
            &[[0.25, 0.25, 0.75, 0.0625], [0.75, 0.75, 0.75, 0.03125]],
            &[[0.75, 0.25, 0.25], [0.25, 0.75, 0.25], [0.25, 0.25, 0.75], [0.25, 0.25, 0.25]],
            [0.5, 1.0],
        ),
        update_case(
            "thin_and_empty",
            "cells of no density beside thin ones, all seen: the mean of what is above 0 decides",
            (2, vec![0.25, 0.0, 0.125, 0.0, 0.0, 0.5, 0.0, 0.0]),
            &[[0.25, 0.25, 0.75, 0.0], [0.75, 0.25, 0.75, 0.3125]],
            &[[0.25, 0.25, 0.25], [0.25, 0.25, 0.75], [0.75, 0.25, 0.75]],
            [0.5, 1.0],
        ),
        update_case(
            "nothing_anywhere",
            "no density at all: every cell that a camera sees is open, and what no camera sees stays empty",
            (2, vec![0.0, 0.0, -1.0, 0.0, 0.0, -1.0, 0.0, 0.0]),
            &[[0.25, 0.75, 0.25, 4.0], [0.25, 0.25, 0.25, 0.0]],
            &[[0.75, 0.25, 0.25], [0.25, 0.75, 0.25]],
            [0.5, 1.0],
        ),
        update_case(
            "outside",
            "queries outside the box count to the nearest cell",
            two,
            &[[0.75, 0.25, 0.25, 9.0]],
            &[[1.5, -0.25, 0.25], [1.5, 0.25, 2.0], [-1.0, 0.25, 0.25]],
            [0.5, 1.5],
        ),
    ];
    // Cells of the box's ends are occupied, and none of those that a flat index of a place outside has.
    let ends = (0..27).map(|n| if [2, 18, 8, 6].contains(&n) { 4.0 } else { 0.0 }).collect();
    cases.push(update_case(
        "far_outside",
        "queries outside of 3^3 cells count to the nearest, coordinate by coordinate",
        (3, ends),
        &[[0.5, 0.5, 0.5, 0.0]],
        &[
            [1.5, 0.125, 0.125],
            [-0.5, 0.125, 0.875],
            [1.25, 1.5, 0.125],
            [0.125, 1.25, -1.0],
            [0.5, 0.5, 1.5],
        ],
        [0.5, 1.0],
    ));
    cases.extend(beside);
    in_full(cases, "plain")
}

fn rays_case(id: &str, comment: &'static str, r: usize, rays: &[[f64; 6]], [near, far]: [f64; 2]) -> Case {
    let part = |from: usize| {
        array(
            &[rays.len(), 3],
            rays.iter().flat_map(|ray| [ray[from], ray[from + 1], ray[from + 2]]).collect(),
        )
    };
    let inputs = vec![
        ("rays_o", part(0)),
        ("rays_d", part(3)),
        ("near", scalar(near)),
        ("far", scalar(far)),
        ("resolution", scalar(r as f64)),
    ];
    Case::new(id, comment, inputs)
}

/// Traversal. All rays lie in the unit box between near and far.
pub(crate) fn traverse() -> Vec<Case> {
    let mut draw = Draw::new("grid_traversal", 0);
    // From one point of the box to another: t in [0, 1].
    let mut through = || {
        let mut place = || draw.between(0.0625, 0.9375);
        let (o, end): (Vec<f64>, Vec<f64>) = (0..3).map(|_| (place(), place())).unzip();
        std::array::from_fn(
            |n| if n < 3 { o[n] } else { crate::contract::case::short(end[n - 3] - o[n - 3]) },
        )
    };
    let mut some = |n: usize| (0..n).map(|_| through()).collect::<Vec<[f64; 6]>>();
    let tiny = libm::ldexp(-1.0, -50);
    let cases = vec![
        rays_case("plain", "from place to place, R = 4", 4, &some(4), [0.0, 0.96875]),
        rays_case("three_cells", "R = 3: faces that no type holds", 3, &some(3), [0.0, 0.96875]),
        rays_case("one_cell", "R = 1: all of the way", 1, &some(2), [0.0, 0.9375]),
        rays_case("cut", "near and far between faces", 4, &some(3), [0.28125, 0.71875]),
        rays_case(
            "fast",
            "directions of length 4: t counts in them",
            4,
            &[[0.0625, 0.28125, 0.15625, 3.5, 1.75, 2.5], [0.9375, 0.59375, 0.40625, -3.25, 0.5, 1.0]],
            [0.0, 0.25],
        ),
        rays_case(
            "along_axes",
            "directions with zeros",
            4,
            &[
                [0.0, 0.375, 0.625, 1.0, 0.0, 0.0],
                [0.375, 1.0, 0.125, 0.0, -1.0, 0.0],
                [0.15625, 0.28125, 0.0, 0.0, 0.25, 1.0],
            ],
            [0.0, 0.71875],
        ),
        rays_case(
            "CG3_from_a_face",
            "nerfacc#265: from the box's end along its face, d_y = -2^-50 or 0: every cell of the row",
            8,
            &[
                [1.0, 0.0, 0.0, -1.0, tiny, 0.0],
                [1.0, 0.0, 0.0, -1.0, 0.0, 0.0],
                [0.0, 1.0, 1.0, 1.0, -tiny, 0.0],
            ],
            [0.0, 0.96875],
        ),
        rays_case(
            "CG3_in_a_face",
            "rays inside faces between cells belong to the cells above",
            4,
            &[[0.0, 0.5, 0.25, 1.0, 0.0, 0.0], [0.75, 1.0, 0.5, 0.0, -1.0, 0.0]],
            [0.0, 0.96875],
        ),
        rays_case(
            "through_corners",
            "the diagonals: three faces at once",
            4,
            &[[0.0, 0.0, 0.0, 1.0, 1.0, 1.0], [1.0, 0.0, 1.0, -1.0, 1.0, -1.0]],
            [0.0, 0.96875],
        ),
    ];
    in_full(cases, "plain")
}

/// A grid of real size: too large for one block of cells, so it is judged at once. Points of short types lie on faces.
pub(crate) fn large() -> Vec<Large> {
    let (cells, points, queries) = (128, 100_003, 10_007);
    let large = Large::new("cells_128", "128^3 cells, 100,003 points", cells, cells);
    let large =
        large.with("density", &[cells; 3], sparse(-6, 8, 1)).with("points", &[points, 3], Recipe::Unit);
    let large = large.with("sigmas", &[points], floats(-4, 8)).with("queries", &[queries, 3], Recipe::Unit);
    let large =
        large.with("decay", &[], Recipe::Constant(0.95)).with("threshold", &[], Recipe::Constant(0.25));
    vec![large.in_types(&[Dtype::F64, Dtype::F32])]
}

/// More rays than threads, in 9^3 cells: whole rays lie in the box.
pub(crate) fn large_traversal() -> Vec<Large> {
    let rays = 1025;
    let large = Large::new("rays_1025", "1,025 rays in 9^3 cells", rays, 64);
    let large = large.with("rays_o", &[rays, 3], floats(-2, 1)).with("rays_d", &[rays, 3], floats(-2, 2));
    let scalars = [("near", 0.0), ("far", 0.5), ("resolution", 9.0)];
    vec![scalars.into_iter().fold(large, |large, (name, x)| large.with(name, &[], Recipe::Constant(x)))]
}
