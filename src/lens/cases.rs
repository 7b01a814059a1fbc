//! Cases of lenses: four, five and eight coefficients, one at a time and all together, wide angles, close to a fold.

use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, constants, signed};

/// A phone's lens, in short numbers.
const PHONE: [f64; 4] = [-0.2812, 0.07422, 0.0011, -0.00079];

/// Coefficients as every type holds them.
fn short(k: &[f64]) -> Vec<f64> {
    k.iter().map(|&k| crate::contract::case::short(k)).collect()
}

/// `n` points within (x, y) of the middle.
fn points(stream: u64, n: usize, [x, y]: [f64; 2]) -> Vec<[f64; 2]> {
    let mut draw = Draw::new("lens_distort", stream);
    (0..n).map(|_| [draw.between(-x, x), draw.between(-y, y)]).collect()
}

/// Points on a ring of about this radius, one of them on the axis.
fn ring(r: f64) -> Vec<[f64; 2]> {
    let along = |a: f64, b: f64| [a * r, b * r].map(crate::contract::case::short);
    vec![along(1.0, 0.0), along(0.6, 0.8), along(-0.7, 0.7), along(0.28, -0.96)]
}

/// The cases, whose points are called `name`.
fn lenses(name: &str) -> Vec<Case> {
    let case = |id: &str, comment, k: &[f64], points: Vec<[f64; 2]>| {
        let points = array(&[points.len(), 2], points.concat());
        Case::new(id, comment, vec![(name, points), ("coefficients", array(&[k.len()], short(k)))])
    };
    let with = |n: usize, size: f64| {
        let mut k = [0.0; 8];
        k[n] = size;
        k
    };
    let tiny = libm::ldexp(1.0, -10);
    let cases = vec![
        case("usual", "a phone's lens, four coefficients", &PHONE, points(0, 8, [0.65, 0.45])),
        case(
            "five",
            "with k3, the fifth",
            &[-0.334, 0.1309, 0.0011, -0.0013, -0.0322],
            points(1, 6, [0.6, 0.6]),
        ),
        case(
            "eight",
            "a rational radial factor",
            &[0.418, -0.127, -0.0007, 0.0013, 0.0254, 0.6484, -0.0771, 0.0186],
            points(2, 8, [0.75, 0.5]),
        ),
        case("pincushion", "bent outward", &[0.1797, 0.0449, 0.0, 0.0], points(3, 4, [0.6, 0.4])),
        case("none", "no distortion: nothing moves", &[0.0; 4], points(4, 3, [0.75, 0.75])),
        case("first_tangential", "p1 alone", &with(2, 0.03125)[..4], points(5, 4, [0.5, 0.5])),
        case("second_tangential", "p2 alone", &with(3, -0.0234)[..4], points(6, 4, [0.5, 0.5])),
        case("fourth_radial", "k4 alone, in the denominator", &with(5, 0.25), points(7, 4, [0.6, 0.6])),
        case("sixth_radial", "k6 alone, which counts far from the middle", &with(7, 0.1875), ring(0.75)),
        case(
            "LE1_middle",
            "the middle of the picture and beside it: the radius is 0 there, and has no slope",
            &PHONE,
            vec![[0.0, 0.0], [tiny, 0.0], [0.0, -tiny], [0.0, 0.5]],
        ),
    ];
    in_full(cases, "usual")
}

/// Ideal points to the distorted picture.
pub(crate) fn lens_distort() -> Vec<Case> {
    let mut cases = lenses("points");
    let k = array(&[4], short(&[-0.45, 0.25, 0.0, 0.0]));
    let wide = [ring(1.25), ring(0.875)].concat();
    let comment = "51 degrees off the axis, where high powers count";
    let inputs = vec![("points", array(&[wide.len(), 2], wide.concat())), ("coefficients", k)];
    cases.push(Case::new("LE2_wide", comment, inputs));
    cases
}

/// And back.
pub(crate) fn lens_undistort() -> Vec<Case> {
    let case = |id: &str, comment, k: &[f64], points: Vec<[f64; 2]>| {
        let points = array(&[points.len(), 2], points.concat());
        Case::new(id, comment, vec![("distorted", points), ("coefficients", array(&[4], short(k)))])
    };
    let mut cases = lenses("distorted");
    cases.extend([
        case(
            "LE2_slow",
            "a strong lens without a fold: steps of x'/radial(x) swing between 1.042 and 1.407 about 1.250 for ever",
            &[-0.45, 0.25, 0.0, 0.0],
            [ring(1.133), ring(0.875)].concat(),
        ),
        case(
            "LE3_near_the_fold",
            "r (1 - 0.3 r^2) has its top at 0.703: before it a small step of the picture is a large one of the ray",
            &[-0.3, 0.0, 0.0, 0.0],
            ring(0.6875),
        ),
    ]);
    cases
}

/// More points than 16 bits count. Gradients of coefficients add up over all points, so that a gradient is judged at once, and in types in
/// which so long a sum has digits.
fn large(name: &str) -> Vec<Large> {
    const COEFFICIENTS: Recipe =
        Recipe::Cycle(&constants([-0.28125, 0.07421875, 0.0010986328125, -0.00079345703125]));
    let points = |id, comment, n: usize, block| {
        let large = Large::new(id, comment, n, block).with(name, &[n, 2], signed(-4, 3));
        large.with("coefficients", &[4], COEFFICIENTS)
    };
    vec![
        points("points_4099", "4,099 points", 4099, 4099).in_types(&[Dtype::F64, Dtype::F32]),
        points("points_100003", "100,003 points", 100_003, 1024).forward_only(),
    ]
}

/// Ideal points to the distorted picture.
pub(crate) fn large_distort() -> Vec<Large> {
    large("points")
}

/// And back.
pub(crate) fn large_undistort() -> Vec<Large> {
    large("distorted")
}
