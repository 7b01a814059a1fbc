//! Cases of the contraction: inside, outside, on the sphere and on the cube between, ties of the largest coordinate, far away.

use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::signed;

/// All of space into a ball or a cube.
pub(crate) fn contraction() -> Vec<Case> {
    let case = |id, comment, x: Vec<f64>| Case::new(id, comment, vec![("x", array(&[x.len() / 3, 3], x))]);
    let seeded = |stream, points: usize, size: f64| {
        let mut draw = Draw::new("contraction", stream);
        (0..3 * points).map(|_| draw.between(-size, size)).collect::<Vec<f64>>()
    };
    let tiny = libm::ldexp(1.0, -12);
    let step = libm::ldexp(1.0, -7);
    let cases = vec![
        case("inside", "where nothing moves", seeded(0, 6, 0.5)),
        case("outside", "a few times as far as what stays", seeded(1, 8, 8.0)),
        case("mixed", "on both sides of either surface", seeded(2, 12, 1.25)),
        case("far", "sizes up to 90: what half precision can square", seeded(3, 6, 90.0)),
        case("CG6_origin", "0: 1/r is infinite there, and times 0 it is NaN", vec![0.0; 3])
            .edge("a point at the origin"),
        case(
            "CG6_beside_the_origin",
            "what the other piece would throw far out",
            vec![tiny, 0.0, 0.0, -0.0, tiny, -tiny, 0.0, 0.25, 0.0],
        ),
        case(
            "CG7_surface",
            "r = 1 exactly, in one norm or both: the pieces and their slopes agree there",
            vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.75, 0.5, 1.0, 0.5, 1.0, 0.25],
        ),
        case(
            "CG7_beside_the_surface",
            "the neighbors of 1 that every type holds",
            vec![1.0 + step, 0.0, 0.0, 0.0, 1.0 - step / 2.0, 0.0, 0.25, 0.5, -1.0 - step],
        ),
        case(
            "CG8_ties",
            "coordinates of one size: the largest of them has several slopes",
            vec![2.0, 2.0, 0.5, -3.0, 1.0, 3.0, 1.5, -1.5, 1.5, 0.5, 4.0, 4.0],
        ),
        case("along_axes", "on the axes, both ways", vec![2.0, 0.0, 0.0, 0.0, -4.0, 0.0, 0.0, 0.0, 1.5]),
        case(
            "CG9_far_away",
            "at 1e6 and 1e15, where 1/r is less than a rounding of 2 in short types",
            vec![1e6, -2e6, 3e5, 1e15, 2e15, -1e15].into_iter().map(crate::contract::case::short).collect(),
        ),
    ];
    in_full(cases, "outside")
}

/// More points than 16 bits count, most of them outside.
pub(crate) fn large() -> Vec<Large> {
    let n = 100_003;
    vec![Large::new("points_100003", "100,003 points", n, 1024).with("x", &[n, 3], signed(-2, 4))]
}
