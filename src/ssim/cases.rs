//! Cases of structural similarity: alike and unlike pictures, low contrast, flat and equal ones, bytes. Most are higher or wider
//! than a window by one pixel.

use ndarray::ArrayD;

use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full, short};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, floats};

fn case(id: &str, comment: &'static str, prediction: ArrayD<f64>, target: ArrayD<f64>, peak: f64) -> Case {
    Case::new(id, comment, vec![("prediction", prediction), ("target", target), ("peak", scalar(peak))])
}

/// Pictures of numbers from `low` to `high`, and the same off by up to `noise`.
fn noisy(stream: u64, shape: [usize; 3], [low, high]: [f64; 2], noise: f64) -> [ArrayD<f64>; 2] {
    let mut draw = Draw::new("ssim", stream);
    let target = draw.array(&shape, low, high);
    let prediction = target.mapv(|x| short(x + noise * (draw.unit() - 0.5)));
    [prediction, target]
}

/// A picture from a function of row and column.
fn drawn([height, width]: [usize; 2], f: impl Fn(usize, usize) -> f64) -> ArrayD<f64> {
    let entry = |n: usize| f(n / width, n % width);
    array(&[height, width, 1], (0..height * width).map(entry).collect())
}

/// A gray picture as red, green and blue.
fn gray(picture: ArrayD<f64>) -> ArrayD<f64> {
    let [height, width] = [picture.shape()[0], picture.shape()[1]];
    picture.broadcast(vec![height, width, 3]).expect("its last axis has one element").into_owned()
}

/// One pixel in the middle of black, channel by channel: nothing cancels, so that bounds are as sharp as they get.
fn spots(id: &str, prediction: [f64; 2], target: [f64; 2]) -> Case {
    let picture = |colors: [f64; 2]| {
        let entry = |n: usize| if n / 2 == 5 * 11 + 5 { colors[n % 2] } else { 0.0 };
        array(&[11, 11, 2], (0..2 * 121).map(entry).collect())
    };
    case(id, "one pixel of two channels on black: little cancels", picture(prediction), picture(target), 1.0)
}

/// Two pictures.
pub(crate) fn ssim() -> Vec<Case> {
    let [usual, usual_target] = noisy(0, [12, 11, 2], [0.0625, 0.9375], 0.25);
    let [colors, colors_target] = noisy(3, [11, 12, 3], [0.0625, 0.9375], 0.25);
    let [faint, faint_target] = noisy(1, [12, 11, 1], [0.46875, 0.53125], 0.0625);
    let [bytes, bytes_target] = noisy(2, [11, 12, 1], [16.0, 240.0], 64.0).map(|x| x.mapv(f64::round));
    let stripes =
        |low: f64, high: f64| drawn([12, 11], move |j, i| if (i + j / 4) % 4 < 2 { low } else { high });
    let flat = |x: f64| drawn([11, 11], move |_, _| x);
    let spot = drawn([12, 11], |j, i| if (j, i) == (6, 5) { 1.0 } else { 0.0 });
    let cases = vec![
        case("usual", "a picture and a noisy one", usual, usual_target.clone(), 1.0),
        case("colors", "red, green and blue, each off in its own way", colors, colors_target, 1.0),
        case("faint", "contrasts of c2, so that the constants show", faint, faint_target, 1.0),
        case("bytes", "bytes, peak 255", bytes, bytes_target, 255.0),
        case(
            "ME2_stripes",
            "stripes and the same paler: windows of other sizes see others",
            stripes(0.375, 0.625),
            stripes(0.25, 0.875),
            1.0,
        ),
        case(
            "negative",
            "light and dark exchanged: below 0",
            gray(stripes(0.25, 0.75)),
            gray(stripes(0.75, 0.25)),
            1.0,
        ),
        case("flat", "two flat pictures: luminance alone", flat(0.5), flat(0.75), 1.0),
        case("equal", "equal pictures: 1, and no gradient", usual_target.clone(), usual_target, 1.0),
        case("spot", "a white pixel on black", drawn([12, 11], |_, _| 0.0), spot, 1.0),
    ];
    let mut cases = in_full(cases, "usual");
    // A power of two and almost half a bit of 11 more.
    let rounded_down = |x: f64| x * (1.0 + libm::ldexp(0.984375, -11));
    // Light that is rounded down beside light that is rounded up, by almost half a bit of 11.
    let (light, pale) = (0.75 + libm::ldexp(0.984375, -12), 0.3125 - libm::ldexp(0.984375, -13));
    cases.extend([
        case("strong", "stripes from black on", stripes(0.0, 0.75), stripes(0.0, 0.3125), 1.0),
        case("strong_f32", "the same in numbers of f32", stripes(0.0, light), stripes(0.0, pale), 1.0),
        spots("spots", [0.5, 0.25], [0.125, 0.875]),
        spots("spots_f32", [rounded_down(0.5), 0.25], [rounded_down(0.125), 0.875]),
    ]);
    cases.extend(in_colors());
    let [long, long_target] = noisy(6, [23, 14, 1], [0.0625, 0.9375], 0.25);
    cases.push(case(
        "two_windows",
        "two windows of 11 below each other don't overlap",
        long,
        long_target,
        1.0,
    ));
    in_full(cases, "colors")
}

/// What a function of red, green and blue alone must be asked too: other peaks, contrasts of the constants, no contrast at all, and the
/// sharpest of all.
fn in_colors() -> [Case; 4] {
    let [faint, faint_target] = noisy(4, [11, 12, 3], [0.46875, 0.53125], 0.0625);
    let [bytes, bytes_target] = noisy(5, [12, 11, 3], [16.0, 240.0], 64.0).map(|x| x.mapv(f64::round));
    let flat = |color: [f64; 3]| array(&[11, 11, 3], color.repeat(121));
    let pixel = |light: f64| gray(drawn([11, 12], move |j, i| if (j, i) == (5, 6) { light } else { 0.0 }));
    [
        case("colors_faint", "contrasts of c2, in three channels", faint, faint_target, 1.0),
        case("colors_bytes", "bytes of three channels, peak 255", bytes, bytes_target, 255.0),
        case("colors_spot", "a white pixel on black, in three channels", pixel(0.0), pixel(1.0), 1.0),
        case("colors_flat", "two flat colors", flat([0.5, 0.25, 0.75]), flat([0.75, 0.5, 0.5]), 1.0),
    ]
}

/// A picture in portrait whose stripes are those of its target: neither side a multiple of anything. Its value is of all of it.
pub(crate) fn large() -> Vec<Large> {
    const BRIGHT: Recipe = floats(-1, 1);
    const GRAY: Recipe = floats(-2, 1);
    const DARK: Recipe = floats(-4, 1);
    const STRIPES: Recipe = Recipe::Cycle(&[BRIGHT, BRIGHT, BRIGHT, GRAY, GRAY, GRAY, DARK, DARK, DARK]);
    let shape = [37, 19, 3];
    let large = Large::new("portrait_37x19", "a picture of 37 rows and 19 columns", shape[0], shape[0]);
    let large = large.with("prediction", &shape, STRIPES).with("target", &shape, STRIPES);
    vec![large.with("peak", &[], Recipe::Constant(1.0))]
}
