//! Cases of contracted Gaussians: inside, outside, on the sphere and on the cube between, ties of the largest coordinate, far away;
//! Gaussians as wide as the scene, as thin as a ray, and without any width.

use crate::contract::arrays::{array, input};
use crate::contract::case::{Case, Draw, in_full, short};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, floats, signed};

/// Gaussians from their means and the upper triangles of their covariances.
fn case(id: &str, comment: &'static str, means: Vec<f64>, triangles: &[[f64; 6]]) -> Case {
    let n = triangles.len();
    let full = |[a, b, c, d, e, f]: &[f64; 6]| [*a, *b, *c, *b, *d, *e, *c, *e, *f];
    let covariances = triangles.iter().flat_map(full).collect();
    let inputs = vec![("means", array(&[n, 3], means)), ("covariances", array(&[n, 3, 3], covariances))];
    Case::new(id, comment, inputs)
}

/// L L^T of a drawn triangle of sizes up to `size`, rounded to numbers that every type holds.
fn drawn(draw: &mut Draw, size: f64) -> [f64; 6] {
    let [a, b, c] = [0; 3].map(|_| draw.between(0.25 * size, size));
    let [p, q, s] = [0; 3].map(|_| draw.between(-size, size));
    [a * a, a * p, a * q, p * p + b * b, p * q + b * s, q * q + s * s + c * c].map(short)
}

/// n Gaussians with means of sizes up to `far` and deviations up to `size`.
fn seeded(id: &str, comment: &'static str, stream: u64, n: usize, [far, size]: [f64; 2]) -> Case {
    let mut draw = Draw::new("contract_gaussians", stream);
    let means = (0..3 * n).map(|_| draw.between(-far, far)).collect();
    let triangles: Vec<[f64; 6]> = (0..n).map(|_| drawn(&mut draw, size)).collect();
    case(id, comment, means, &triangles)
}

/// The same numbers above and below the diagonals, where they were changed one by one.
fn mirrored(mut case: Case) -> Case {
    let mut covariances = input(&case.inputs, "covariances").clone();
    for (n, i, j) in (0..covariances.shape()[0]).flat_map(|n| [(n, 0, 1), (n, 0, 2), (n, 1, 2)]) {
        covariances[[n, j, i]] = covariances[[n, i, j]];
    }
    case.inputs.insert("covariances".to_owned(), covariances);
    case
}

/// Gaussians of all of space.
pub(crate) fn contract_gaussians() -> Vec<Case> {
    let slanted = [0.25, 0.125, -0.0625, 0.1875, 0.03125, 0.125];
    let ball = [0.0625, 0.0, 0.0, 0.0625, 0.0, 0.0625];
    let (step, tiny) = (libm::ldexp(1.0, -7), libm::ldexp(1.0, -12));
    let cases = vec![
        seeded("inside", "where nothing moves", 0, 4, [0.5, 0.25]),
        seeded("outside", "a few times as far as what stays", 1, 6, [8.0, 1.0]),
        seeded("mixed", "on both sides of either surface", 2, 10, [1.25, 0.5]),
        seeded("far", "sizes up to 90: what half precision can square", 3, 4, [90.0, 8.0]),
        seeded("wide", "Gaussians as wide as the scene: variances above 1", 4, 4, [4.0, 4.0]),
        case(
            "between_ball_and_cube",
            "outside of the ball, inside of the cube: who asks one norm and contracts by another",
            vec![0.75, 0.75, 0.5, -0.875, 0.625, 0.125],
            &[slanted, ball],
        ),
        case("CG6_origin", "0: the slope of 1/|x| is infinite there", vec![0.0; 3], &[slanted])
            .edge("a Gaussian at the origin"),
        case(
            "CG6_beside_the_origin",
            "what the other piece would blur",
            vec![tiny, 0.0, 0.0, -0.0, tiny, -tiny],
            &[slanted, ball],
        ),
        case(
            "CG7_surface",
            "r = 1 exactly: the slopes of both pieces agree, those of the slopes don't",
            vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.75, 0.5, 1.0],
            &[slanted, ball, slanted],
        ),
        case(
            "CG7_beside_the_surface",
            "the neighbors of 1 that every type holds",
            vec![1.0 + step, 0.0, 0.0, 0.0, 1.0 - step / 2.0, 0.0, 0.25, 0.5, -1.0 - step],
            &[slanted; 3],
        ),
        case(
            "CG8_ties",
            "coordinates of one size: the largest of them has several slopes",
            vec![2.0, 2.0, 0.5, -3.0, 1.0, 3.0, 1.5, -1.5, 1.5],
            &[slanted, ball, slanted],
        ),
        case(
            "along_axes",
            "on the axes, both ways: nothing is turned",
            vec![2.0, 0.0, 0.0, 0.0, -4.0, 0.0, 0.0, 0.0, 1.5],
            &[slanted, ball, slanted],
        ),
        case(
            "nearly_along_an_axis",
            "beside an axis: 1 - x_i^2 / r^2 is small",
            vec![0.0625, 8.0, -0.03125],
            &[slanted],
        ),
        case(
            "without_width",
            "no width at all, that of a ray along it, and that of a disk across it",
            vec![3.0, 0.0, 4.0, 3.0, 0.0, 4.0, 0.0, 2.0, 0.0],
            &[[0.0; 6], [0.5625, 0.0, 0.75, 0.0, 0.0, 1.0], [0.25, 0.0, 0.0, 0.0, 0.0, 0.25]],
        ),
        case(
            "CG9_far_away",
            "at 1e4, wide for that: 1/r^2 along the ray beside 2/r across it",
            vec![short(1e4), short(-2e4), short(3e3)],
            &[slanted.map(|x| short(1e7 * x))],
        ),
        case(
            "CG9_at_the_horizon",
            "at 1e6 and 1e15: the same, where a difference of the two has few digits left, and none",
            [[1e6, 3e5, -2e6], [1e15, 2e15, -1e15]].as_flattened().iter().map(|&x| short(x)).collect(),
            &[1e11, 1e29].map(|size| slanted.map(|x| short(size * x))),
        )
        .edge("a Gaussian at a million units and more"),
    ];
    in_full(cases, "outside")
        .into_iter()
        .map(|case| if case.full.is_some() { mirrored(case) } else { case })
        .collect()
}

/// More Gaussians than threads, most of them beyond the ball. Every entry has a word of its own: what lies on both sides of a diagonal
/// is a number that they all have.
pub(crate) fn large() -> Vec<Large> {
    const VARIANCE: Recipe = floats(-3, 3);
    const OTHER: Recipe = Recipe::Constant(0.046875);
    const COVARIANCES: Recipe =
        Recipe::Cycle(&[VARIANCE, OTHER, OTHER, OTHER, VARIANCE, OTHER, OTHER, OTHER, VARIANCE]);
    let n = 2053;
    let large = Large::new("gaussians_2053", "2,053 Gaussians", n, 1024);
    vec![large.with("means", &[n, 3], signed(-2, 4)).with("covariances", &[n, 3, 3], COVARIANCES)]
}
