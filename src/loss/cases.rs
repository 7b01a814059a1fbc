//! Cases of loss, metric and bytes.

use ndarray::ArrayD;

use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, floats};

fn pair(
    id: &str,
    comment: &'static str,
    prediction: ArrayD<f64>,
    target: ArrayD<f64>,
) -> (Case, ArrayD<f64>, ArrayD<f64>) {
    let inputs = vec![("prediction", prediction.clone()), ("target", target.clone())];
    (Case::new(id, comment, inputs), prediction, target)
}

/// Mean squared error.
pub(crate) fn mse() -> Vec<Case> {
    let mut draw = Draw::new("mse", 0);
    let shape = [4, 3];
    let gray = array(&shape, vec![0.5; 12]);
    let close = gray.mapv(|x| x + 0.00390625);
    let cases = [
        pair("batch", "random colors", draw.array(&[8, 3], 0.0, 1.0), draw.array(&[8, 3], 0.0, 1.0)),
        pair(
            "picture",
            "two pictures",
            draw.array(&[2, 3, 5, 3], 0.0, 1.0),
            draw.array(&[2, 3, 5, 3], 0.0, 1.0),
        ),
        pair("close", "differences of 2^-8 are exact", close, gray.clone()),
        pair("ME1_equal", "equal pictures: exactly 0, gradient too", gray.clone(), gray),
        pair(
            "beyond",
            "colors below 0 and above 1 count as they are",
            draw.array(&shape, -0.5, 1.5),
            draw.array(&shape, 0.0, 1.0),
        ),
        pair("tiny", "squares underflow", array(&[2], vec![1e-170, 0.0]), array(&[2], vec![0.0, 2e-200])),
    ]
    .into_iter()
    .map(|(case, _, _)| case)
    .collect();
    in_full(cases, "batch")
}

/// PSNR: pictures whose errors differ by a factor, so that the two means differ.
pub(crate) fn psnr() -> Vec<Case> {
    let mut draw = Draw::new("psnr", 0);
    let shape = [2, 3, 4, 3];
    let target = draw.array(&shape, 0.25, 0.5);
    let mut noise = draw.array(&shape, 0.0625, 0.25);
    noise.index_axis_mut(ndarray::Axis(0), 1).mapv_inplace(|x| x / 16.0);
    let two = (&target + &noise).mapv(crate::contract::case::short);
    let tenth = array(&[1, 2, 3, 3], vec![0.625; 18]);
    let half = array(&[1, 2, 3, 3], vec![0.5; 18]);
    let with_peak = |id: &str, comment, prediction: &ArrayD<f64>, target: &ArrayD<f64>, peak| {
        let inputs =
            vec![("prediction", prediction.clone()), ("target", target.clone()), ("peak", scalar(peak))];
        Case::new(id, comment, inputs)
    };
    let middle = draw.array(&[1, 4, 5, 3], 0.375, 0.625);
    let mut uneven = middle.clone();
    for (at, x) in uneven.indexed_iter_mut() {
        let error = libm::ldexp(1.0 + 0.25 * at[2] as f64, -3 - 2 * at[3] as i32 - at[1] as i32);
        *x = crate::contract::case::short(if (at[1] + at[2]) % 2 == 0 { *x + error } else { *x - error });
    }
    let byte = |x: f64| (x * 255.0).round().min(255.0);
    let cases = vec![
        with_peak("two_pictures", "two pictures of unequal error: the two means differ", &two, &target, 1.0),
        with_peak("eighth", "an error of 1/8 everywhere: 18.06 dB", &tenth, &half, 1.0),
        with_peak("bytes", "bytes, peak 255", &two.mapv(byte), &target.mapv(byte), 255.0),
        with_peak(
            "two_is_white",
            "peak 2: colors in [-1, 1] are so far apart",
            &two.mapv(|x| 2.0 * x - 1.0),
            &target.mapv(|x| 2.0 * x - 1.0),
            2.0,
        ),
        with_peak(
            "uneven",
            "errors of either sign that differ from channel to channel and from pixel to pixel",
            &uneven,
            &middle,
            1.0,
        ),
        with_peak(
            "ninth_power",
            "an error of 2^-9 everywhere: 54 dB",
            &half.mapv(|x| x + libm::ldexp(1.0, -9)),
            &half,
            1.0,
        ),
        with_peak("ME1_equal", "equal pictures: infinite, never NaN", &half, &half, 1.0)
            .edge("equal pictures"),
        with_peak(
            "nearly_equal",
            "an error of 2^-18 everywhere: 108 dB",
            &half.mapv(|x| x + libm::ldexp(1.0, -18)),
            &half,
            1.0,
        ),
        with_peak(
            "zero_decibels",
            "an error of nearly 1: the digits are those of the mean squared error",
            &half.mapv(|_| 0.9921875),
            &half.mapv(|_| 0.0),
            1.0,
        ),
    ];
    in_full(cases, "two_pictures")
}

/// (k + 1/2) / 255 and then a little, of 2^-9 to 2^-`last` of it, up or down: a number of fewer bits is on the other side, or a tie.
fn beside_ties(id: &str, dtype: Dtype, last: i32) -> Case {
    let entry = |k: i32| {
        let little = libm::ldexp(if k % 2 == 0 { 1.0 } else { -1.0 }, -9 - k % (last - 8));
        dtype.round((f64::from(5 * k) + 0.5) / 255.0 * (1.0 + little))
    };
    let image = array(&[4, 4, 3], (0..48).map(entry).collect());
    Case::new(id, "beside the ties between two bytes", vec![("image", image)])
}

/// Bytes: inside and beyond [0, 1], on a picture that isn't square.
pub(crate) fn to_uint8() -> Vec<Case> {
    let mut draw = Draw::new("to_uint8", 0);
    let ends = vec![-0.0, 0.0, 1.0, 0.5, 1.0078125, -1.0, 2.0, 0.00390625, 0.99609375];
    let levels = (0..48).map(|k| f64::from(k) / 32.0 - 0.25).collect();
    vec![
        Case::new(
            "ends",
            "the ends of [0, 1], beyond them, and the tie 127.5",
            vec![("image", array(&[1, 3, 3], ends))],
        ),
        Case::new(
            "inside",
            "nothing is clipped: who guesses the scale by the largest number takes it for that of [0, 1]",
            vec![("image", draw.array(&[3, 4, 3], 0.0, 0.875))],
        ),
        beside_ties("beside_ties_f32", Dtype::F32, 20),
        beside_ties("beside_ties_f64", Dtype::F64, 49),
        Case::new("levels", "steps of 1/32 from -1/4", vec![("image", array(&[4, 4, 3], levels))]),
        Case::new(
            "picture",
            "a third of the entries lies outside [0, 1]",
            vec![("image", draw.array(&[4, 5, 3], -0.5, 1.5))],
        ),
    ]
}

/// More colors than 16 bits count, judged at once, in types in which so long a sum has digits.
pub(crate) fn large_mse() -> Vec<Large> {
    let (n, colors) = (33_335, [33_335, 3]);
    let large = Large::new("colors_33335", "33,335 colors", n, n).with("prediction", &colors, Recipe::Unit);
    vec![large.with("target", &colors, Recipe::Unit).in_types(&[Dtype::F64, Dtype::F32])]
}

/// Three pictures in portrait, the same.
pub(crate) fn large_psnr() -> Vec<Large> {
    let shape = [3, 131, 67, 3];
    let large = Large::new("portraits_3x131x67", "three pictures of 131 rows and 67 columns", 3, 3);
    let large = large.with("prediction", &shape, Recipe::Unit).with("target", &shape, Recipe::Unit);
    vec![large.with("peak", &[], Recipe::Constant(1.0)).in_types(&[Dtype::F64, Dtype::F32])]
}

/// A picture in portrait, with colors above 1.
pub(crate) fn large_to_uint8() -> Vec<Large> {
    let shape = [257, 131, 3];
    let large = Large::new("portrait_257x131", "a picture of 257 rows and 131 columns", shape[0], 16);
    vec![large.with("image", &shape, floats(-3, 4))]
}
