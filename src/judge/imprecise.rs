//! Lost digits: answers of the right formula that are off by more than its arithmetic costs, and by how many digits.

use std::sync::Arc;

use super::answer::Answers;
use super::exam::Question;
use super::mark::{MarkOptions, proves, within};
use crate::contract::arithmetic::{Arithmetic, Dtype, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::convention::Conventions;

/// Bits that may be lost before an answer is called wrong. f64 in which something was computed in f32 has lost 29; in f32 an eps of 1e-5
/// is a mistake, no rounding; the short types have no digits to lose.
fn most(dtype: Dtype) -> i32 {
    match dtype {
        Dtype::F64 => 30,
        Dtype::F32 => 8,
        Dtype::Tf32 | Dtype::Bf16 | Dtype::F16 => 0,
    }
}

/// How many bits fewer than `options.dtype` has would make every answer honest, if that is few enough and leaves proof in every output.
pub(super) fn lost_bits(
    question: &Question,
    answers: &Answers,
    c: &Conventions,
    options: &MarkOptions,
) -> Option<i32> {
    let fits = |bits: &i32| {
        let mut unproved: Vec<&String> = answers.iter().flatten().flat_map(|answer| answer.keys()).collect();
        let right = question.cases.iter().zip(answers).all(|(case, answer)| {
            let Some(answer) = answer else { return false };
            let (expected, bound) = coarse(question, case, c, options, *bits);
            // Four times: something must be left that is clearly right.
            let clear = |name: &&String| {
                expected.get(*name).is_some_and(|e| proves(e, &bound[*name].mapv(|bound| 4.0 * bound)))
            };
            unproved.retain(|name| expected.contains_key(*name) && !clear(name));
            within(answer, &expected, None, [bound])
        });
        right && unproved.is_empty()
    };
    // The bound grows with the bits: few steps show whether there is any hope.
    let most = most(options.dtype);
    (most > 0 && fits(&most)).then(|| (1..=most).find(fits).unwrap_or(most))
}

/// The truth, and the bound of arithmetic that is `bits` shorter: that of the formula, and as many bits of the largest number of an array,
/// for what the contract allows nothing, and for what is left of a difference.
fn coarse(
    question: &Question,
    case: &Case,
    c: &Conventions,
    options: &MarkOptions,
    bits: i32,
) -> (Arc<Arrays>, Arrays) {
    let direction = question.component.direction(question.kind).expect("a question has its direction");
    let full = options.arithmetic(Grade::B);
    let scale = libm::ldexp(1.0, bits);
    let short = Arithmetic { u: full.u * scale, u_sum: full.u_sum * scale, ..full };
    let expected = question.expected(case, c);
    let mut bound = (direction.bound)(&case.inputs, c, &short);
    for (name, bound) in &mut bound {
        let largest = |max: f64, x: &f64| if x.is_finite() { max.max(x.abs()) } else { max };
        let floor = short.u * expected[name].iter().fold(0.0, largest);
        bound.mapv_inplace(|bound| bound + floor);
    }
    (expected, bound)
}
