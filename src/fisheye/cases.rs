//! Cases of fisheyes: the middle, ordinary angles, nearly 90 degrees, lenses that bend back.

use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw, in_full, short};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, constants, signed};

/// A calibrated fisheye.
const FISHEYE: [f64; 4] = [0.0298, -0.0102, 0.0057, -0.0014];

/// A case from its points.
fn case(name: &str, id: &str, comment: &'static str, k: [f64; 4], points: Vec<[f64; 2]>) -> Case {
    let points = array(&[points.len(), 2], points.concat());
    Case::new(id, comment, vec![(name, points), ("coefficients", array(&[4], k.map(short).to_vec()))])
}

/// `n` points within `size` of the middle.
fn points(stream: u64, n: usize, size: f64) -> Vec<[f64; 2]> {
    let mut draw = Draw::new("fisheye_distort", stream);
    (0..n).map(|_| [draw.between(-size, size), draw.between(-size, size)]).collect()
}

/// Points at this distance from the middle, one of them on the axis.
fn ring(r: f64) -> Vec<[f64; 2]> {
    [[1.0, 0.0], [-0.6, 0.8], [0.7, 0.7], [0.0, -1.0]].map(|point| point.map(|x| short(x * r))).to_vec()
}

/// What both directions are asked.
fn lenses(name: &str) -> Vec<Case> {
    let case = |id, comment, k, points| case(name, id, comment, k, points);
    let tiny = libm::ldexp(1.0, -10);
    let one = |n: usize, size: f64| {
        let mut k = [0.0; 4];
        k[n] = size;
        k
    };
    let cases = vec![
        case("usual", "a calibrated fisheye, to 45 degrees", FISHEYE, points(0, 8, 0.7)),
        case("equidistant", "no polynomial: the angle itself", [0.0; 4], points(1, 4, 0.9)),
        case("first", "k1 alone", one(0, -0.0625), points(2, 3, 0.75)),
        case("second", "k2 alone", one(1, 0.04688), points(3, 3, 0.75)),
        case("third", "k3 alone", one(2, -0.03125), points(4, 3, 0.75)),
        case("fourth", "k4 alone", one(3, 0.02344), points(5, 3, 0.75)),
        case(
            "LE1_middle",
            "the middle of the picture and beside it, where theta / r is 0 / 0",
            FISHEYE,
            vec![[0.0, 0.0], [tiny, 0.0], [0.0, -tiny], [0.25, 0.0]],
        ),
        case(
            "one_point",
            "a strong lens and one point on an axis: sums of one term",
            [0.25, -0.125, 0.0625, -0.03125],
            vec![[0.5, 0.0]],
        ),
        case("LE1_beside_the_middle", "a thousandth from it", FISHEYE, ring(tiny)),
        case(
            "LE1_at_the_middle",
            "a millionth from it, which thresholds take for the middle",
            FISHEYE,
            ring(tiny * tiny),
        ),
    ];
    in_full(in_full(cases, "usual"), "one_point")
}

/// Ideal points to a fisheye's picture.
pub(crate) fn fisheye_distort() -> Vec<Case> {
    let mut cases = lenses("points");
    cases.push(case(
        "points",
        "LE2_wide",
        "to 86 degrees off the axis",
        FISHEYE,
        [ring(3.0), ring(14.0)].concat(),
    ));
    cases
}

/// And back.
pub(crate) fn fisheye_undistort() -> Vec<Case> {
    let mut cases = lenses("distorted");
    cases.extend([
        case("distorted", "LE2_wide", "to 83 degrees off the axis, where the tangent is steep", FISHEYE, [ring(1.25), ring(1.4531)].concat()),
        case(
            "distorted",
            "LE3_near_the_fold",
            "theta (1 - 0.15 theta^2) has its top at 0.994: before it a small step of the picture is a large one of the ray",
            [-0.15, 0.0, 0.0, 0.0],
            ring(0.9609),
        ),
        case(
            "distorted",
            "LE1_small_alone",
            "a strong lens and nothing but small points: a search that ends at an absolute error ends before it begins",
            [0.5, 0.0, 0.0, 0.0],
            ring(0.0078125),
        ),
    ]);
    cases
}

/// More points than 16 bits count. Gradients of coefficients add up over all points, so that a gradient is judged at once, and in types in
/// which so long a sum has digits.
fn large(name: &str) -> Vec<Large> {
    const COEFFICIENTS: Recipe =
        Recipe::Cycle(&constants([0.02978515625, -0.01025390625, 0.005706787109375, -0.00140380859375]));
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
