//! Cases of the positional encoding: zeros and ones of sin and cos, high bands, large and tiny x.

use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full, short};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, signed};

/// Positional encoding.
pub(crate) fn positional_encoding() -> Vec<Case> {
    let case = |id, comment, levels: f64, dims: usize, x: Vec<f64>| {
        Case::new(id, comment, vec![("x", array(&[x.len() / dims, dims], x)), ("L", scalar(levels))])
    };
    let seeded = |stream, n: usize, low, high| {
        let mut draw = Draw::new("positional_encoding", stream);
        (0..n).map(|_| draw.between(low, high)).collect::<Vec<_>>()
    };
    // sqrt(2) / 3 keeps every column apart from every other one.
    let irrational = std::f64::consts::SQRT_2 / 3.0;
    let probe = vec![0.0, 0.5, short(irrational)];
    let halves = vec![0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 2.0, 0.25, -1.5, 0.75];
    let cases = vec![
        case("probe", "x = 0, 1/2 and sqrt(2)/3 at three bands", 3.0, 3, probe.clone()),
        case(
            "probe_exact",
            "sqrt(2)/3 in f64: columns match by value",
            4.0,
            1,
            vec![irrational, -irrational],
        ),
        case(
            "two_dims",
            "two dimensions, four bands, small x: band 0 is accurate in every type",
            4.0,
            2,
            vec![0.0625, -0.125, 0.1875, 0.03125],
        ),
        case("positions", "L = 10, in [-4, 4]", 10.0, 3, seeded(0, 12, -4.0, 4.0)),
        case("directions", "L = 4, in [-1, 1]", 4.0, 3, seeded(1, 12, -1.0, 1.0)),
        case("pixels", "L = 10, two dimensions in [0, 1]", 10.0, 2, seeded(2, 8, 0.0, 1.0)),
        case("identity_only", "L = 0: the input alone", 0.0, 2, vec![0.25, -3.0]).edge("no bands"),
        case("PE3_zeros", "exact zeros and ones: sin(pi) is 0, cos(pi/2) is 0", 6.0, 2, halves),
        case("PE3_large", "large multiples of the period", 4.0, 2, vec![512.0, 1000.5, -4096.0, 65536.0]),
        case(
            "PE1_high_bands",
            "L = 25: a rounded product loses every digit in f32",
            25.0,
            2,
            seeded(3, 4, -1.0, 1.0),
        ),
        case("PE3_reduction", "reduction at 2^30 x", 31.0, 1, seeded(4, 4, -1.0, 1.0)),
        case(
            "PE3_subnormal",
            "sin is accurate for tiny x, cos is 1",
            4.0,
            2,
            vec![5e-324, -1e-310, 1e-300, -1e-38],
        ),
        case(
            "PE3_near_pi",
            "x near multiples of pi",
            4.0,
            2,
            vec![std::f64::consts::PI, 2.0 * std::f64::consts::PI, 100.0 * std::f64::consts::PI, 3.140625],
        ),
        case(
            "PE2_quarters",
            "one bit beside the zeros of cos and sin",
            10.0,
            2,
            vec![0.5 - f64::EPSILON / 4.0, 0.5 + f64::EPSILON / 2.0, 1.5 - f64::EPSILON, 1.0 + f64::EPSILON],
        ),
    ];
    in_full(cases, "directions")
}

/// Many points in ten bands.
pub(crate) fn large() -> Vec<Large> {
    let points = 100_003;
    let large = Large::new("points_100003", "100,003 points, L = 10", points, 1024);
    vec![large.with("x", &[points, 3], signed(-6, 6)).with("L", &[], Recipe::Constant(10.0))]
}
