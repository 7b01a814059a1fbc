//! Cases of the covariance: any rotation, half turns, quaternions of every length, needles, plates and balls.

use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{floats, signed};

/// Gaussians from their quaternions and scales.
fn case(id: &str, comment: &'static str, quaternions: Vec<f64>, scales: Vec<f64>) -> Case {
    let gaussians = scales.len() / 3;
    let inputs = vec![
        ("quaternions", array(&[gaussians, 4], quaternions)),
        ("scales", array(&[gaussians, 3], scales)),
    ];
    Case::new(id, comment, inputs)
}

/// The covariance of a Gaussian.
pub(crate) fn gaussian_covariance() -> Vec<Case> {
    let seeded = |id: &str, comment, stream, n: usize, length: f64, sizes: [f64; 2]| {
        let mut draw = Draw::new("gaussian_covariance", stream);
        let quaternions = (0..4 * n).map(|_| draw.between(-length, length)).collect();
        case(id, comment, quaternions, (0..3 * n).map(|_| draw.decades(sizes[0], sizes[1])).collect())
    };
    let axes = |unit: [f64; 4]| {
        (0..4).flat_map(|turn| (0..4).map(move |a| unit[(a + 4 - turn) % 4])).collect::<Vec<f64>>()
    };
    let tiny = libm::ldexp(1.0, -6);
    let cases = vec![
        seeded("usual", "quaternions of lengths around 1", 0, 8, 1.0, [-1.5, 0.5]),
        case(
            "half_turns",
            "no turn, and half turns about the axes: w = 0, and diagonals of 1 and -1",
            axes([1.0, 0.0, 0.0, 0.0]),
            [0.5, 0.25, 0.125].repeat(4),
        ),
        case(
            "thirds",
            "turns by a third about the diagonals: axes change places",
            vec![0.5, 0.5, 0.5, 0.5, -0.5, 0.5, 0.5, 0.5, 0.5, -0.5, 0.5, 0.5],
            [0.5, 1.0, 2.0].repeat(3),
        ),
        seeded("GS1_long", "quaternions as optimizers leave them: lengths up to 16", 1, 6, 16.0, [-1.5, 0.5]),
        seeded("GS1_short", "quaternions of lengths near 1/64", 2, 6, tiny, [-1.5, 0.5]),
        seeded("GS2_needles", "scales from 1/1000 to 3: needles and plates", 3, 6, 1.0, [-3.0, 0.5]),
        case(
            "balls",
            "equal scales: whatever the rotation, nothing is off the diagonal",
            vec![0.75, -0.5, 0.25, 1.0, -0.125, 0.5, 0.625, 0.25],
            vec![0.5, 0.5, 0.5, 1.25, 1.25, 1.25],
        ),
        case(
            "of_either_sign",
            "q and -q: the same rotation",
            vec![0.75, -0.5, 0.25, 1.0, -0.75, 0.5, -0.25, -1.0],
            [0.5, 0.125, 1.5].repeat(2),
        ),
    ];
    in_full(cases, "usual")
}

/// More Gaussians than threads.
pub(crate) fn large() -> Vec<Large> {
    let n = 10_007;
    let large = Large::new("gaussians_10007", "10,007 Gaussians", n, 1024);
    vec![large.with("quaternions", &[n, 4], signed(-3, 3)).with("scales", &[n, 3], floats(-4, 4))]
}
