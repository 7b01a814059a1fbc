//! Cases of the truncated exponential: inside, at and beyond the limits of its gradient, and where each type overflows.

use crate::contract::arrays::array;
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::signed;

/// Truncated exponential.
pub(crate) fn trunc_exp() -> Vec<Case> {
    let case = |id, comment, x: Vec<f64>| Case::new(id, comment, vec![("x", array(&[x.len()], x))]);
    let seeded = |stream, low: f64, high: f64| {
        let mut draw = Draw::new("trunc_exp", stream);
        (0..12).map(|_| draw.between(low, high)).collect::<Vec<f64>>()
    };
    let tiny = libm::ldexp(1.0, -20);
    let cases = vec![
        case("zero", "e^0 is 1, beside it too", vec![0.0, -0.0, tiny, -tiny, 0.5, -0.5]),
        case("usual", "raw densities of a trained field", seeded(0, -6.0, 8.0)),
        case("thin", "empty space: densities of 1e-3 and below", seeded(1, -14.0, -7.0)),
        case(
            "limits",
            "beside and at the ends of [-15, 15]",
            vec![-15.125, -15.0, -14.875, 14.875, 15.0, 15.125],
        ),
        case("above", "above 15 the density grows on, its gradient doesn't", seeded(2, 16.0, 40.0)),
        case("below", "below -15 the density falls on, its gradient doesn't", seeded(3, -40.0, -16.0)),
        case(
            "VR6_f16",
            "e^11 is a half-precision number, e^12 is infinite there",
            vec![11.0, 12.0, -8.0, -18.0],
        ),
        case(
            "VR6_f32",
            "e^88 is a single-precision number, e^89 is infinite there",
            vec![88.0, 89.0, -87.0, -106.0],
        ),
        case(
            "VR6_f64",
            "e^704 is a double-precision number, e^712 is infinite",
            vec![704.0, 712.0, -704.0, -752.0],
        ),
    ];
    let mut cases = in_full(cases, "usual");
    let odd = seeded(4, -6.0, 8.0).into_iter().take(7).collect();
    cases.push(case("odd_count", "seven points: the last one stands alone", odd));
    cases
}

/// More points than 16 bits count.
pub(crate) fn large() -> Vec<Large> {
    let n = 100_003;
    vec![Large::new("points_100003", "100,003 points", n, 1024).with("x", &[n], signed(-3, 6))]
}
