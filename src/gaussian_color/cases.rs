//! Cases of splats' colors: each degree, from every side, near and far, and channels below 0.

use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, constants, signed};

const CENTER: [f64; 3] = [0.5, -0.25, 1.5];

/// Splats with as many coefficients as `degree` has, seen from `center`.
fn case(id: &str, comment: &'static str, means: Vec<f64>, center: [f64; 3], coefficients: Vec<f64>) -> Case {
    let splats = means.len() / 3;
    let inputs = vec![
        ("means", array(&[splats, 3], means)),
        ("camera_center", array(&[3], center.to_vec())),
        ("coefficients", array(&[splats, coefficients.len() / splats / 3, 3], coefficients)),
    ];
    Case::new(id, comment, inputs)
}

/// Colors of splats.
pub(crate) fn gaussian_color() -> Vec<Case> {
    let seeded = |id: &str, comment, stream, splats: usize, degree: usize, size: f64, first: f64| {
        let mut draw = Draw::new("gaussian_color", stream);
        let means = (0..3 * splats).map(|_| draw.between(-size, size)).collect();
        let width = (degree + 1) * (degree + 1);
        let mut one = |n: usize| if n % width == 0 { first } else { 0.0 } + draw.between(-0.25, 0.25);
        let coefficients =
            (0..splats * width).flat_map(|n| [0; 3].map(|_| one(n))).map(crate::contract::case::short);
        let coefficients = coefficients.collect();
        case(id, comment, means, CENTER, coefficients)
    };
    let axes = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, -0.5];
    let mut along = seeded("along_axes", "a camera at the origin, splats on the axes", 5, 6, 3, 1.0, 0.5);
    along.inputs.insert("means".into(), array(&[6, 3], axes.to_vec()));
    along.inputs.insert("camera_center".into(), array(&[3], vec![0.0; 3]));
    let cases = vec![
        seeded("usual", "all four bands, from every side", 0, 6, 3, 4.0, 0.5),
        seeded("constant", "degree 0: the same from everywhere", 1, 4, 0, 4.0, 0.5),
        seeded("linear", "degree 1", 2, 4, 1, 4.0, 0.5),
        seeded("quadratic", "degree 2", 3, 4, 2, 4.0, 0.5),
        seeded(
            "GS6_below_zero",
            "channels below 0, which are clamped, and above 1, which aren't",
            4,
            8,
            3,
            4.0,
            -1.75,
        ),
        seeded("bright", "channels above 1", 8, 4, 3, 4.0, 3.0),
        seeded("linear_below_zero", "degree 1, channels below 0", 9, 4, 1, 4.0, -1.75),
        seeded("linear_bright", "degree 1, channels above 1", 10, 4, 1, 4.0, 3.0),
        seeded("quadratic_below_zero", "degree 2, channels below 0", 11, 4, 2, 4.0, -1.75),
        seeded("quadratic_bright", "degree 2, channels above 1", 12, 4, 2, 4.0, 3.0),
        along,
        seeded("far", "splats a hundred units away", 6, 4, 3, 100.0, 0.5),
    ];
    in_full(cases, "usual")
}

/// More splats than 16 bits count in two bands, and many in four.
pub(crate) fn large() -> Vec<Large> {
    const CENTER: Recipe = Recipe::Cycle(&constants([0.125, -0.0625, 0.25]));
    let splats = |id, comment, n: usize, width: usize| {
        let large = Large::new(id, comment, n, 1024).with("means", &[n, 3], signed(-1, 3));
        large.with("camera_center", &[3], CENTER).with("coefficients", &[n, width, 3], signed(-5, 4))
    };
    vec![
        splats("splats_66001", "66,001 splats of two bands", 66_001, 4).forward_only(),
        splats("splats_8209", "8,209 splats of four bands", 8209, 16),
    ]
}
