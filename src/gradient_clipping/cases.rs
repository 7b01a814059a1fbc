//! Cases of clipped gradients: above, at and below the limit; norms whose squares lie on the other side; where each tensor's own norm says
//! something else.

use ndarray::ArrayD;

use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};
use crate::contract::large::Large;
use crate::contract::recipe::{Recipe, signed};

fn layer(id: &str, comment: &'static str, [weights, bias]: [ArrayD<f64>; 2], max_norm: f64) -> Case {
    Case::new(id, comment, vec![("g_weights", weights), ("g_bias", bias), ("max_norm", scalar(max_norm))])
}

/// Gradients of two weights and a bias: 3, 4 and 12 times `unit`, whose norm is 13 times it.
fn thirteen(unit: f64) -> [ArrayD<f64>; 2] {
    [array(&[1, 2], vec![3.0 * unit, -4.0 * unit]), array(&[1], vec![12.0 * unit])]
}

/// By the norm of a layer.
pub(crate) fn clip_by_global_norm() -> Vec<Case> {
    let random = |stream, [n, m]: [usize; 2], high: f64| {
        let mut draw = Draw::new("clip_by_global_norm", stream);
        [draw.array(&[n, m], -high, high), draw.array(&[n], -high, high)]
    };
    let tiny = libm::ldexp(1.0, -20);
    let cases = vec![
        layer("usual", "a norm of about 2, clipped to 1/2", random(0, [4, 3], 1.0), 0.5),
        layer("short", "below the limit: nothing happens", random(1, [3, 4], 0.25), 4.0),
        layer("thirteen", "clipped to its half", thirteen(1.0), 6.5),
        layer("at_the_limit", "a norm of the limit itself", thirteen(0.25), 3.25),
        layer("square_below", "a norm of 0.81 above the limit, its square below", thirteen(0.0625), 0.75),
        layer("square_above", "a norm of 1.63 below the limit, its square above", thirteen(0.125), 2.0),
        layer(
            "bias_alone_is_long",
            "weights that are short by themselves",
            [array(&[2, 2], vec![0.125, -0.25, 0.0625, 0.1875]), array(&[2], vec![3.0, -1.5])],
            1.0,
        ),
        layer(
            "each_is_short",
            "tensors and rows that are short by themselves, and long together",
            [array(&[3, 2], vec![0.5, -0.5, 0.5, 0.5, -0.5, 0.5]), array(&[3], vec![0.5, 0.5, -0.5])],
            1.25,
        ),
        layer(
            "one_rules",
            "one number that is longer than all others",
            [array(&[2, 3], vec![96.0, 0.25, -0.5, 0.125, 1.0, -0.75]), array(&[2], vec![0.5, 2.0])],
            1.0,
        ),
        layer("tiny", "a norm of 1e-5: what is added to it shows", thirteen(tiny), 5e-6),
        layer(
            "nothing",
            "no gradient: nothing is divided by 0",
            [array(&[2, 2], vec![0.0; 4]), array(&[2], vec![0.0; 2])],
            1.0,
        ),
    ];
    in_full(cases, "usual")
}

/// By value.
pub(crate) fn clip_by_value() -> Vec<Case> {
    let case = |id, comment, gradient, limit| {
        Case::new(id, comment, vec![("g", gradient), ("limit", scalar(limit))])
    };
    let of = |numbers: &[f64]| array(&[numbers.len()], numbers.to_vec());
    let cases = vec![
        case("batch", "a third inside", Draw::new("clip_by_value", 0).array(&[6, 4], -1.0, 1.0), 0.3),
        case("inside", "all inside", Draw::new("clip_by_value", 1).array(&[2, 3, 2], -1.0, 1.0), 2.0),
        case("beyond", "large numbers of both signs", of(&[8.0, -16.0, 0.75, -12.0, 240.0]), 0.5),
        case(
            "at_the_limit",
            "the limit, its negative, and on either side",
            of(&[0.25, -0.25, 0.2421875, -0.2421875, 0.25390625, -0.25390625, 0.0]),
            0.25,
        ),
        case(
            "infinite",
            "a loss that overflowed: the limit all the same",
            of(&[f64::INFINITY, 0.125, f64::NEG_INFINITY, -0.5]),
            0.25,
        ),
    ];
    in_full(cases, "batch")
}

/// A layer of 257 times 67, judged at once: its norm is of all of it, in types in which so long a sum has digits.
pub(crate) fn large_by_norm() -> Vec<Large> {
    let (rows, columns) = (257, 67);
    let large = Large::new("layer_257x67", "a layer of 257 times 67", rows, rows);
    let large =
        large.with("g_weights", &[rows, columns], signed(-8, 6)).with("g_bias", &[rows], signed(-8, 6));
    vec![large.with("max_norm", &[], Recipe::Constant(1.0)).in_types(&[Dtype::F64, Dtype::F32])]
}

/// More numbers than 16 bits count.
pub(crate) fn large_by_value() -> Vec<Large> {
    let n = 100_003;
    let large = Large::new("numbers_100003", "100,003 numbers", n, 4096).with("g", &[n], signed(-4, 4));
    vec![large.with("limit", &[], Recipe::Constant(0.25))]
}
