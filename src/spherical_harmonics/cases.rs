//! Cases of the spherical harmonics: axes, diagonals, random directions, and directions that aren't unit.

use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, signed};

/// Spherical harmonics.
pub(crate) fn spherical_harmonics() -> Vec<Case> {
    let case = |id, comment, degree: f64, d: Vec<f64>| {
        Case::new(id, comment, vec![("d", array(&[d.len() / 3, 3], d)), ("degree", scalar(degree))])
    };
    let seeded = |stream, n: usize| {
        let mut draw = Draw::new("spherical_harmonics", stream);
        let direction = |_| {
            let d = [0, 1, 2].map(|_| draw.between(-1.0, 1.0));
            let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            d.map(|x| crate::contract::case::short(x / length))
        };
        (0..n).flat_map(direction).collect::<Vec<f64>>()
    };
    let axes =
        vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0];
    let cases = vec![
        case("axes", "along the axes, both ways: every harmonic is 0 or extreme", 4.0, axes),
        case("constant", "degree 0: 1 / sqrt(4 pi), whatever the direction", 0.0, seeded(0, 3)),
        case("linear", "degree 1: y, z, x in this order", 1.0, seeded(1, 4)),
        case("quadratic", "degree 2: the nine values of Plenoxels", 2.0, seeded(4, 5)),
        case(
            "quadratic_not_unit",
            "the same where lengths aren't 1",
            2.0,
            vec![0.25, -0.375, 0.125, 1.0, -1.5, 0.5],
        ),
        case("four_bands", "degree 3: the 16 values of Instant-NGP", 3.0, seeded(2, 6)),
        case("five_bands", "degree 4: all 25", 4.0, seeded(3, 6)),
        case(
            "PE7_unit_cube",
            "components in [0, 1], as if already shifted",
            3.0,
            vec![0.5, 0.75, 1.0, 0.25, 0.0, 0.5],
        ),
        case(
            "PE7_not_unit",
            "lengths 1/2 and 2: taken as they stand",
            4.0,
            vec![0.25, -0.375, 0.125, 1.0, -1.5, 0.5],
        ),
        case("nearly_up", "beside the pole, where m > 0 vanishes", 4.0, vec![0.0078125, -0.00390625, 1.0]),
    ];
    in_full(cases, "five_bands")
}

/// More directions than 16 bits count, of any length below 2, in three bands, and many in five.
pub(crate) fn large() -> Vec<Large> {
    let points = |id, comment, n: usize, degree: f64| {
        let large = Large::new(id, comment, n, 1024).with("d", &[n, 3], signed(-3, 3));
        large.with("degree", &[], Recipe::Constant(degree))
    };
    vec![
        points("directions_66001", "66,001 directions, degree 2", 66_001, 2.0),
        points("directions_16411", "16,411 directions, degree 4", 16_411, 4.0),
    ]
}
