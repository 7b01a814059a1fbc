//! Lost digits: answers of the right formula that are off by more than its arithmetic costs, and by how many digits.

use std::sync::Arc;

use ndarray::ArrayD;

use super::super::answer::{Answer, Answers, reshaped};
use super::super::assignment::nearest;
use super::super::exam::Question;
use super::super::mark::{MarkOptions, proves};
use super::super::partial::{Partial, apply, partial};
use super::super::within::within;
use super::evidence::{Explanation, difference, explains_all, largest_residual, usable};
use super::hypothesis::Hypothesis;
use super::slips::each::rounded;
use crate::contract::arithmetic::{Arithmetic, Dtype, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::convention::Conventions;

/// Bits whose loss is likelier than a mistake that explains the same: an eps of 1e-7 added in f32, or T as 1 less the sum of the weights.
const FEW_BITS: i32 = 4;

/// The same where the mistake is what lost digits look like: a rotation, or V of a twist, in f32 without 1 - cos theta at angles of millionths.
const LIKE_LOST: i32 = 5;

/// The same where a mistake's number explains them closely.
const BESIDE_A_NUMBER: i32 = 2;

/// The share of what wrong code may be off that a mistake's number may use to be told in the place of lost digits: what wrong code may be
/// off is 8 times the right formula's bound, and this is half of the latter.
const CLOSELY: f64 = 1.0 / 16.0;

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
pub(crate) fn lost_bits(
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

/// Whether so few bits are lost that no two mistakes, and nothing that no catalogue lists, are told in their place.
pub(crate) fn few_bits_lost(
    question: &Question,
    answers: &Answers,
    c: &Conventions,
    options: &MarkOptions,
) -> bool {
    lost_bits(question, answers, c, options).is_some_and(|bits| bits <= FEW_BITS)
}

/// How many bits may be lost where this explains the answers, too.
pub(crate) fn bits_beside(e: &Explanation) -> i32 {
    let like_lost = e.slip.is_none() && !e.mistakes.is_empty() && e.mistakes.iter().all(|m| m.lost_digits);
    match () {
        () if e.inaccurate || !e.whole() => i32::MAX,
        () if like_lost => LIKE_LOST,
        // No loss of digits does that, but with a convention T as 1 less the sum of the weights may.
        () if numbered_closely(e) => {
            if e.conventions.is_empty() {
                0
            } else {
                BESIDE_A_NUMBER
            }
        }
        () => FEW_BITS,
    }
}

/// Whether one mistake's number, as people write it, explains the answers nearly as well as the right formula would have to.
fn numbered_closely(best: &Explanation) -> bool {
    let numbered = matches!(best.mistakes[..], [mistake] if mistake.number.is_some() && !mistake.lost_digits);
    let written = best.fitted.iter().all(|x| rounded(*x)[0] == *x);
    best.whole() && best.slip.is_none() && numbered && written && best.residual < CLOSELY
}

/// How large the numbers of an array are: its largest, but no more than 1 or so many times the median of those that aren't 0. A last step of
/// 1e10 says nothing of what rounding costs the others; 1 less an opacity does, however few rays are left with light.
fn size(array: &ArrayD<f64>) -> f64 {
    let mut sizes: Vec<f64> = array.iter().map(|x| x.abs()).filter(|x| x.is_finite() && *x > 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    sizes.last().map_or(0.0, |largest| largest.min((LARGER * median).max(1.0)))
}

/// How much larger than most others the largest number of an array may count.
const LARGER: f64 = 16.0;

/// The truth, and the bound of arithmetic that is `bits` shorter: that of the formula, and as many bits of the size of an array,
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
        let of_one = question.component.special.left_of_one.contains(&name.as_str());
        let floor = short.u * size(&expected[name]).max(if of_one { 1.0 } else { 0.0 });
        bound.mapv_inplace(|bound| bound + floor);
    }
    (expected, bound)
}

/// The right formula in the nearest of these assignments that explains every answer if digits were lost, and how much of what wrong code
/// is allowed it uses.
pub(crate) fn inaccuracy(
    near: &[&Partial],
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Option<(Hypothesis, f64)> {
    let right = |p: &&Partial| Hypothesis { loose: true, ..Hypothesis::new(vec![], apply(p, base)) };
    let h = near.iter().map(right).find(|h| explains_all(h, question, answers, options))?;
    with_digits(h, question, answers, options)
}

/// The right formula where answers have digits left. Across a face or a threshold a nudge changes everything: that explains any answer, and is
/// no matter of digits.
fn with_digits(
    right: Hypothesis,
    question: &Question,
    answers: &Answers,
    options: &MarkOptions,
) -> Option<(Hypothesis, f64)> {
    let left = |(case, answer): &(&Case, &Answer)| {
        let expected = question.expected(case, &right.conventions);
        answer
            .iter()
            .all(|(name, given)| expected.get(name).is_none_or(|e| digits_are_left(e, &given.values)))
    };
    let all = usable(&right, question, answers).iter().all(left);
    all.then(|| largest_residual(&right, question, answers, options)).map(|residual| (right, residual))
}

/// What is said of lost digits; conventions as they differ from `home`.
pub(crate) fn lost_digits(
    (right, residual): (Hypothesis, f64),
    question: &Question,
    home: &Partial,
) -> Explanation {
    let conventions = difference(&partial(question.component, &right.conventions), home);
    Explanation { conventions, residual, inaccurate: true, ..Explanation::default() }
}

/// Lost digits in the place of mistakes that explain the answers no closer than these do: what is wrong by a formula is as close as
/// rounding is to the right one.
pub(crate) fn rather_lost(
    mistakes: &[Explanation],
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Option<(Hypothesis, f64)> {
    if mistakes.iter().any(|e| e.residual < NO_CLOSER) {
        return None;
    }
    let c = nearest(question, answers, base, options);
    lost_bits(question, answers, &c, options)?;
    with_digits(Hypothesis { loose: true, ..Hypothesis::new(vec![], c) }, question, answers, options)
}

/// The share of what wrong code may be off that a mistake uses where it explains the answers no closer than lost digits do.
pub(super) const NO_CLOSER: f64 = 0.5;

/// Whether answers are off by less than a part of an array's size, or of their own.
fn digits_are_left(expected: &ArrayD<f64>, given: &ArrayD<f64>) -> bool {
    let Some((got, _)) = reshaped(given, expected.shape()) else { return true };
    let finite = || got.iter().zip(expected).filter(|(g, e)| g.is_finite() && e.is_finite());
    // What is left of a difference of fractions may be anything but large, where nothing should be.
    let size = Some(size(expected)).filter(|size| *size > 0.0).unwrap_or(1.0);
    let near = |(g, e): (&f64, &f64)| (g - e).abs() <= LOST * size.max(e.abs());
    finite().all(near)
}

/// The part.
const LOST: f64 = 1.0 / 16.0;

#[cfg(test)]
mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::*;
    use crate::convention::CS180;

    /// Bits that answers in f32 have lost, after a change of each number below 1e9.
    fn lost(change: impl Fn(f64) -> f64) -> Option<i32> {
        let exam = Exam::new("step_sizes", Dtype::F32, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 });
        let c = CS180.with("delta", "differences").unwrap().with("last_delta", "1e10").unwrap();
        let own = |x: f64| Dtype::F32.round(if x < 1e9 { change(x) } else { x });
        let answer = |case: &Case| {
            let expected = (question.component.forward.oracle)(&case.inputs, &c);
            Some(given(expected.into_iter().map(|(name, a)| (name, a.mapv(own))).collect()))
        };
        let answers: Answers = question.cases.iter().map(answer).collect();
        lost_bits(question, &answers, &c, &options)
    }

    #[test]
    fn a_last_step_of_1e10_hides_no_mistake() {
        assert!(lost(|x| x * (1.0 + 2.0_f64.powi(-16))).is_some_and(|bits| bits > 1));
        assert_eq!(lost(|x| 1.5 * x), None);
        assert_eq!(lost(|x| -x), None);
    }

    /// 1 less an opacity of nearly 1 has hardly a digit of its own size, and all of those of 1.
    #[test]
    fn light_that_an_opacity_leaves_has_its_digits() {
        let exam = Exam::new("volume_render", Dtype::F32, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 });
        let bits = |light: fn(f64) -> f64| {
            let answer = |case: &Case| {
                let mut all = (question.component.forward.oracle)(&case.inputs, &CS180);
                all.values_mut().for_each(|a| a.mapv_inplace(|x| Dtype::F32.round(x)));
                all.insert("transmittance".into(), all["opacity"].mapv(|a| Dtype::F32.round(light(a))));
                Some(given(all))
            };
            let answers: Answers = question.cases.iter().map(answer).collect();
            lost_bits(question, &answers, &CS180, &options)
        };
        assert!(bits(|a| 1.0 - a).is_some_and(|bits| bits <= 2));
        assert_eq!(bits(|a| 1.001 - a), None);
    }

    #[test]
    fn across_a_face_no_digits_are_left() {
        let array = |x: &[f64]| ArrayD::from_shape_vec(vec![x.len()], x.to_vec()).unwrap();
        assert!(digits_are_left(&array(&[7.0, 1.0]), &array(&[7.1, 1.1])));
        assert!(!digits_are_left(&array(&[7.0, 1.0]), &array(&[1.39, 1.0])));
        assert!(!digits_are_left(&array(&[0.5, 0.5, 1e10]), &array(&[5.0, 0.5, 1e10])));
        assert!(digits_are_left(&array(&[0.0]), &array(&[1e-9])));
    }
}
