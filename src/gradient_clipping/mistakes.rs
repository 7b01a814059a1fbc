//! Clipped gradients, wrong on purpose. Without a mistake every function equals the oracle.

pub(crate) mod laws;

use super::arrays::{self, by_norm, by_value, tensors};
use super::clip_by_value as oracle;
use crate::contract::arrays::{Arrays, input, number};
use crate::contract::component::Mistake;
use crate::convention::Conventions;

/// Mistakes of a clip by the common norm.
pub(crate) const CLIP_BY_GLOBAL_NORM: &[Mistake] = &[
    thrown_away(
        "keep what it returns, or call the one that works in place (clip_grad_norm_)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "norm_of_each_tensor",
        "each tensor by its own norm",
        "the step points elsewhere: long tensors are shortened, short ones beside them aren't",
        "one norm of all tensors",
        "TensorFlow's clip_by_norm and Keras' clipnorm where clip_by_global_norm is meant",
        2,
    ),
    Mistake::new(
        "norm_of_each_row",
        "each row of the weights by its own norm",
        "the step points elsewhere, row by row",
        "one norm of all tensors",
        "norms along an axis; never in public code",
        0,
    ),
    Mistake::new(
        "root_forgotten",
        "the sum of squares as the norm",
        "long gradients become far too short, and short ones are clipped late",
        "its root",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "square_compared",
        "the sum of squares compared with max_norm",
        "norms below 1 pass that are too long, norms above 1 are stretched up to max_norm",
        "compare the norm, or with max_norm^2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "stretched",
        "max_norm / norm where that is above 1 too",
        "every step has the same length: the training doesn't settle",
        "min(1, max_norm / norm)",
        "code that normalizes gradients and calls it clipping",
        0,
    ),
    Mistake::new(
        "sum_for_norm",
        "the sum of sizes",
        "gradients are clipped far too much, the more the larger the network",
        "the root of the sum of squares; torch: norm_type = 2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "largest_for_norm",
        "the largest size",
        "gradients are longer than max_norm, the more the larger the network",
        "the root of the sum of squares; torch: norm_type = 2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mean_for_sum",
        "the root of the mean of squares",
        "gradients are longer than max_norm, by the root of the number of parameters",
        "the root of their sum",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "bias_left_out",
        "the norm of the weights alone, and the bias as it is",
        "biases take steps of any length",
        "the parameters of all layers, weights and biases",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "numbers_clipped",
        "each number clipped to [-max_norm, max_norm]",
        "gradients of many numbers are hardly clipped, and turned where they are",
        "clip_grad_norm_, not clip_grad_value_",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "sum_of_norms",
        "|weights| + |bias| for the norm of both",
        "gradients are clipped too much, the more the more tensors there are",
        "the root of the sum of their squares",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "largest_of_norms",
        "the longest tensor's norm",
        "gradients are longer than max_norm, by the root of the number of tensors",
        "the root of the sum of their squares",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "made_unit",
        "g / norm beyond max_norm",
        "a jump at max_norm: what is a bit too long becomes 1 long",
        "times max_norm",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "dropped",
        "0 beyond max_norm",
        "no step where gradients are long",
        "times max_norm / norm",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "norm_of_clipped",
        "the norm after the clip is returned",
        "its curve is flat at max_norm: what would show that a training diverges is hidden",
        "the norm before",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "squares_squared",
        "the tensors' sums of squares are squared once more: the root of |w|^4 + |b|^4",
        "a norm of other units: large gradients are clipped far too much",
        "the root of |w|^2 + |b|^2",
        "1 public implementation",
        1,
    ),
];

const fn thrown_away(remedy: &'static str, seen: &'static str, count: u32) -> Mistake {
    Mistake::new(
        "thrown_away",
        "gradients as they came: what a function returns, which doesn't clip in place, is dropped",
        "nothing is clipped",
        remedy,
        seen,
        count,
    )
}

/// Mistakes of a clip by value.
pub(crate) const CLIP_BY_VALUE: &[Mistake] = &[
    thrown_away(
        "keep what it returns, or call the one that works in place (clip_grad_value_)",
        "1 public implementation, with paddle.clip",
        1,
    ),
    Mistake::new(
        "above_alone",
        "min(g, limit)",
        "negative gradients stay as long as they are",
        "min(max(g, -limit), limit)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "below_alone",
        "max(g, -limit)",
        "positive gradients stay as long as they are",
        "min(max(g, -limit), limit)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "sign_forgotten",
        "limit beyond it, whatever the sign of g",
        "long negative gradients turn around",
        "-limit below -limit",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "dropped",
        "0 beyond the limit",
        "parameters with long gradients don't move",
        "the limit with the sign of g",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "norm_clipped",
        "all numbers times limit / norm, where that is less than 1",
        "one long number shortens all others",
        "each number by itself; clip_by_global_norm has that",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "sign_alone",
        "1 with the sign of g beyond the limit",
        "limits other than 1 aren't kept",
        "the limit with the sign of g",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "scaled_together",
        "all numbers times limit / largest size, where that is less than 1",
        "one long number shortens all others",
        "each number by itself",
        "never; cheap to keep",
        0,
    ),
];

/// The largest size, or the sum of sizes.
fn sizes(numbers: &[f64], add: fn(f64, f64) -> f64) -> f64 {
    numbers.iter().map(|g| g.abs()).fold(0.0, add)
}

/// The norm that is taken for the right one.
fn norm(numbers: &[f64], wrong: &[&str]) -> f64 {
    let has = |name: &str| wrong.contains(&name);
    let squares: f64 = numbers.iter().map(|g| g * g).sum();
    match () {
        () if has("root_forgotten") => squares,
        () if has("sum_for_norm") => sizes(numbers, |a, b| a + b),
        () if has("largest_for_norm") => sizes(numbers, f64::max),
        () if has("mean_for_sum") => (squares / numbers.len() as f64).sqrt(),
        () => squares.sqrt(),
    }
}

/// What gradients of this norm are multiplied by.
fn factor(norm: f64, most: f64, c: &Conventions, wrong: &[&str]) -> f64 {
    let has = |name: &str| wrong.contains(&name);
    let factor = most / (norm + c.clip_eps.value());
    let clips = match () {
        // Nothing to stretch.
        () if norm == 0.0 => false,
        () if has("stretched") => true,
        () if has("square_compared") => norm * norm > most,
        () => factor < 1.0,
    };
    match () {
        () if !clips || has("thrown_away") => 1.0,
        () if has("made_unit") => 1.0 / norm,
        () if has("dropped") => 0.0,
        () => factor,
    }
}

/// By the common norm.
pub(crate) fn clip_by_global_norm(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    if wrong.is_empty() {
        return arrays::clip_by_global_norm(a, c);
    }
    let has = |name: &str| wrong.contains(&name);
    let ([weights, bias], most) = (tensors(a), number(a, "max_norm"));
    let counted = if has("bias_left_out") { weights.clone() } else { [&weights[..], &bias].concat() };
    let each = [&weights, &bias].map(|tensor| norm(tensor, &[]));
    let all = match () {
        () if has("sum_of_norms") => each[0] + each[1],
        () if has("squares_squared") => each[0].powi(2).hypot(each[1].powi(2)),
        () if has("largest_of_norms") => each[0].max(each[1]),
        () => norm(&counted, wrong),
    };
    let by = |numbers: &[f64], norm: f64| -> Vec<f64> {
        let factor = factor(norm, most, c, wrong);
        numbers.iter().map(|g| g * factor).collect()
    };
    let clipped = if has("norm_of_each_tensor") {
        [&weights, &bias].map(|tensor| by(tensor, norm(tensor, wrong)))
    } else if has("norm_of_each_row") {
        let width = input(a, "g_weights").shape()[1];
        let rows = weights.chunks_exact(width).flat_map(|row| by(row, norm(row, wrong)));
        [rows.collect(), by(&bias, norm(&bias, wrong))]
    } else if has("numbers_clipped") {
        [&weights, &bias].map(|tensor| tensor.iter().map(|g| oracle(*g, most)).collect())
    } else {
        [by(&weights, all), if has("bias_left_out") { bias } else { by(&bias, all) }]
    };
    let told = if has("norm_of_clipped") { norm(&clipped.concat(), wrong) } else { all };
    by_norm(a, clipped, told)
}

/// By value.
pub(crate) fn clip_by_value(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let has = |name: &str| wrong.contains(&name);
    let limit = number(a, "limit");
    let largest = input(a, "g").iter().fold(0.0, |most: f64, g| most.max(g.abs()));
    let largest =
        if has("norm_clipped") { input(a, "g").iter().map(|g| g * g).sum::<f64>().sqrt() } else { largest };
    by_value(a, |g| match () {
        () if has("thrown_away") => g,
        () if has("above_alone") => g.min(limit),
        () if has("below_alone") => g.max(-limit),
        () if has("sign_forgotten") => g.abs().min(limit).copysign(if g.abs() > limit { 1.0 } else { g }),
        () if has("dropped") => {
            if g.abs() > limit {
                0.0
            } else {
                g
            }
        }
        () if has("sign_alone") && g.abs() > limit => g.signum(),
        () if has("scaled_together") || has("norm_clipped") => {
            if largest > limit {
                g * limit / largest
            } else {
                g
            }
        }
        () => oracle(g, limit),
    })
}
