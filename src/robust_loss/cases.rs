//! Cases of the robust losses: inside, at and beyond delta; about eps, equal entries and large ones.

use ndarray::ArrayD;

use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::Recipe;

fn case(
    id: &str,
    comment: &'static str,
    [prediction, target]: [ArrayD<f64>; 2],
    (name, number): (&str, f64),
) -> Case {
    Case::new(id, comment, vec![("prediction", prediction), ("target", target), (name, scalar(number))])
}

/// Two arrays of numbers from 0 to `high`.
fn random(row: &str, stream: u64, shape: &[usize], high: f64) -> [ArrayD<f64>; 2] {
    let mut draw = Draw::new(row, stream);
    [draw.array(shape, 0.0, high), draw.array(shape, 0.0, high)]
}

/// Predictions that no picture shows, and targets that one does.
fn beyond(row: &str) -> [ArrayD<f64>; 2] {
    let mut draw = Draw::new(row, 3);
    [draw.array(&[4, 3], -0.5, 1.5), draw.array(&[4, 3], 0.0, 1.0)]
}

/// Predictions of 1 and of 0, and targets so far from them.
fn apart(differences: &[f64]) -> [ArrayD<f64>; 2] {
    let (n, base) = (differences.len(), |i: usize| if i % 2 == 0 { 1.0 } else { 0.0 });
    let target = differences.iter().enumerate().map(|(i, d)| base(i) - d).collect();
    [array(&[n], (0..n).map(base).collect()), array(&[n], target)]
}

/// Huber's loss.
pub(crate) fn huber() -> Vec<Case> {
    let of = |delta| ("delta", delta);
    let cases = vec![
        case("batch", "colors, a quarter of them within delta", random("huber", 0, &[8, 3], 1.0), of(0.125)),
        case("picture", "two pictures", random("huber", 1, &[2, 3, 4, 3], 1.0), of(0.1)),
        case("colors_beyond", "predictions below 0 and above 1", beyond("huber"), of(0.25)),
        case("inside", "all within delta", random("huber", 2, &[6, 3], 0.75), of(1.0)),
        case("beyond", "outliers alone", apart(&[8.0, -16.0, 3.0, 12.0, -5.0]), of(0.25)),
        case(
            "at_delta",
            "differences of delta, of its negative, and on either side",
            apart(&[0.25, -0.25, 0.2421875, -0.2421875, 0.25390625, -0.25390625]),
            of(0.25),
        ),
        case(
            "equal",
            "equal entries beside others: no gradient",
            apart(&[0.0, 0.0, 0.5, -0.0625]),
            of(0.125),
        ),
    ];
    in_full(in_full(cases, "batch"), "picture")
}

/// Charbonnier's loss.
pub(crate) fn charbonnier() -> Vec<Case> {
    let of = |eps| ("eps", eps);
    let near: Vec<f64> = [3.0, -2.0, 1.0, -1.0, 0.5, 5.0].map(|x| x / 1024.0).to_vec();
    let small = |_: usize| 0.0;
    let cases = vec![
        case("batch", "colors", random("charbonnier", 0, &[8, 3], 1.0), of(0.001)),
        case("picture", "two pictures", random("charbonnier", 1, &[2, 3, 4, 3], 1.0), of(0.03125)),
        case("colors_beyond", "predictions below 0 and above 1", beyond("charbonnier"), of(0.0625)),
        case(
            "about_eps",
            "differences of about eps",
            [array(&[6], near), array(&[6], (0..6).map(small).collect())],
            of(0.001),
        ),
        case(
            "equal",
            "equal entries beside others: eps, and no gradient",
            apart(&[0.0, 0.0, 0.5, -0.25]),
            of(0.0625),
        ),
        case("large", "errors of linear light", apart(&[96.0, -240.0, 3.0, 1.0]), of(0.001)),
    ];
    in_full(in_full(cases, "batch"), "about_eps")
}

/// More colors than 16 bits count, judged at once, in types in which so long a sum has digits.
fn large(name: &str, number: f64) -> Vec<Large> {
    let (n, colors) = (33_335, [33_335, 3]);
    let large = Large::new("colors_33335", "33,335 colors", n, n).with("prediction", &colors, Recipe::Unit);
    let large = large.with("target", &colors, Recipe::Unit).with(name, &[], Recipe::Constant(number));
    vec![large.in_types(&[Dtype::F64, Dtype::F32])]
}

/// Huber's loss, a quarter of the entries within delta.
pub(crate) fn large_huber() -> Vec<Large> {
    large("delta", 0.125)
}

/// Charbonnier's loss.
pub(crate) fn large_charbonnier() -> Vec<Large> {
    large("eps", 0.03125)
}
