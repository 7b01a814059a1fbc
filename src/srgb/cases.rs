//! Cases of the sRGB curve: both pieces, the threshold between them, black, white and highlights. No light is negative.

use super::THRESHOLD;
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::floats;

/// Linear light to sRGB.
pub(crate) fn linear_to_srgb() -> Vec<Case> {
    let case = |id, comment, x: Vec<f64>| Case::new(id, comment, vec![("linear", array(&[x.len()], x))]);
    let seeded = |stream, low: f64, high: f64| {
        let mut draw = Draw::new("linear_to_srgb", stream);
        (0..12).map(|_| draw.between(low, high)).collect::<Vec<f64>>()
    };
    let mut dark = Draw::new("linear_to_srgb", 0);
    let step = libm::ldexp(1.0, -15);
    let cases = vec![
        case("black", "0, and light too faint to see", vec![0.0, -0.0, libm::ldexp(1.0, -14), step]),
        case("dark", "the straight piece", (0..12).map(|_| dark.decades(-4.0, -2.6)).collect()),
        case(
            "beside_threshold",
            "the neighbors of 0.0031308 that every type holds, and theirs",
            vec![101.0 * step, 102.0 * step, 103.0 * step, 104.0 * step],
        ),
        case(
            "shadows",
            "between 0.0031308 and 0.04045, the threshold of the way back",
            seeded(1, 0.0035, 0.04),
        ),
        case("usual", "most of a picture", seeded(2, 0.05, 1.0)),
        case("white", "beside and at 1", vec![0.9921875, 1.0, 1.015625]),
        case("highlights", "above 1 the power goes on, and so does its gradient", seeded(3, 1.0, 16.0)),
        case(
            "threshold_f32",
            "0.0031308 in single precision: either piece there, one in double precision",
            vec![Dtype::F32.round(THRESHOLD)],
        ),
        case(
            "threshold_f64",
            "0.0031308 in double precision: either piece is honest",
            vec![THRESHOLD.next_down(), THRESHOLD, THRESHOLD.next_up()],
        ),
    ];
    in_full(cases, "usual")
}

/// More colors than 16 bits count, of both pieces.
pub(crate) fn large() -> Vec<Large> {
    let n = 100_003;
    vec![Large::new("colors_100003", "100,003 colors", n, 1024).with("linear", &[n], floats(-10, 10))]
}
