//! What nobody reads: a box that is missed has no t. Where wrong code says so, whatever else it says there is no matter.

use ndarray::Axis;

use super::answer::{Answer, reshaped};
use crate::contract::arrays::Arrays;
use crate::contract::component::Component;

/// Predicts what was answered, where a prediction says that nobody reads it, and so does the answer: else whatever is predicted to be
/// missed would explain any t.
pub(crate) fn as_answered(component: &Component, answer: &Answer, predicted: &mut Arrays) {
    for (output, by) in component.special.unread {
        let (Some(read), Some(predicted)) = (predicted.get(*by).cloned(), predicted.get_mut(*output)) else {
            continue;
        };
        let of_shape = |name: &str| reshaped(&answer.get(name)?.values, read.shape()).map(|(array, _)| array);
        let both = of_shape(output).zip(of_shape(by)).filter(|_| predicted.shape() == read.shape());
        let Some((given, said)) = both else { continue };
        for (((predicted, given), read), said) in predicted.iter_mut().zip(&given).zip(&read).zip(&said) {
            *predicted = if *read == 0.0 && *said == 0.0 { *given } else { *predicted };
        }
    }
}

/// Leaves the gradients open of rays none of whose outputs anybody reads.
pub(crate) fn free_gradients(component: &Component, outputs: &Arrays, errors: &mut Arrays) {
    let Some((_, by)) = component.special.unread.first() else { return };
    let Some(read) = outputs.get(*by) else { return };
    let counted = errors.iter_mut().filter(|(name, error)| {
        component.counts(name) && error.ndim() > 0 && error.len_of(Axis(0)) == read.len()
    });
    for (_, error) in counted {
        for (mut row, _) in error.outer_iter_mut().zip(read).filter(|(_, read)| **read == 0.0) {
            row.fill(f64::INFINITY);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::exam::{Exam, Question};
    use super::super::hypothesis::Hypothesis;
    use super::super::judging::{EXP_ULP, judge_answers};
    use super::super::mark::MarkOptions;
    use super::super::report::Verdict;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::case::Case;
    use crate::convention::CS180;
    use crate::judge::answer::given;

    /// The cases that a mistake explains of its own answers after a change.
    fn explained(change: impl Fn(&mut Answer)) -> (usize, usize) {
        let exam = Exam::new("ray_aabb", Dtype::F32, None).unwrap();
        let question = &exam.questions[0];
        let h = Hypothesis::new(vec!["face_is_a_miss"], CS180);
        let options = MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 };
        let fits = |case| {
            let mut answer = given(h.prediction(question, case).0);
            change(&mut answer);
            h.explains(question, case, &answer, &options)
        };
        (question.cases.iter().filter(|case| fits(case)).count(), question.cases.len())
    }

    /// The verdicts on gradients that are off by one where a ray misses, and where it hits.
    fn gradients_off(hit: f64) -> Verdict {
        let exam = Exam::new("ray_aabb", Dtype::F32, None).unwrap();
        let off = |question: &Question, case: &Case| {
            let direction = question.component.direction(question.kind).unwrap();
            let mut answer = given((direction.oracle)(&case.inputs, &CS180));
            let read = (question.component.forward.oracle)(&case.inputs, &CS180)["hit"].clone();
            for gradient in answer.iter_mut().filter(|(name, _)| name.starts_with("grad_")) {
                for (mut row, read) in gradient.1.values.outer_iter_mut().zip(&read) {
                    row += f64::from(u8::from(*read == hit));
                }
            }
            Some(answer)
        };
        let all = |question: &Question| question.cases.iter().map(|case| off(question, case)).collect();
        let report = judge_answers(&exam, &exam.questions.iter().map(all).collect::<Vec<_>>(), EXP_ULP);
        report.rows.iter().find(|row| row.kind == "vjp").expect("it has a gradient").verdict
    }

    #[test]
    fn zz_debug() {
        let exam = Exam::new("ray_aabb", Dtype::F32, None).unwrap();
        let question = exam.questions.iter().find(|q| q.kind == crate::contract::check::Kind::Vjp).unwrap();
        let h = Hypothesis { fitted: Some(1e-8), ..Hypothesis::new(vec!["eps_in_direction"], CS180) };
        let options = MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 };
        for case in &question.cases {
            let direction = question.component.direction(question.kind).unwrap();
            let mut answer = given((direction.oracle)(&case.inputs, &CS180));
            let read =
                (question.component.forward.wrong)(&case.inputs, &CS180, &["eps_in_direction=1e-8"])["hit"]
                    .clone();
            for gradient in answer.iter_mut().filter(|(name, _)| name.starts_with("grad_")) {
                for (mut row, read) in gradient.1.values.outer_iter_mut().zip(&read) {
                    row *= *read;
                }
            }
            let (p, e) = h.prediction(question, case);
            println!(
                "{} {} {} {:?}",
                case.id,
                h.explains(question, case, &answer, &options),
                h.residual(question, case, &answer, &options),
                Hypothesis { loose: true, ..Hypothesis::new(vec![], CS180) }
                    .compared(&h, question, case, &answer, &options)
            );
            if case.id == "CG1_in_a_face" {
                println!("{p:?}\n{e:?}\n{answer:?}");
            }
        }
    }

    #[test]
    fn what_is_missed_has_no_gradient_that_is_asked_for() {
        assert_eq!((gradients_off(0.0), gradients_off(1.0)), (Verdict::Pass, Verdict::Fail));
    }

    #[test]
    fn what_is_missed_has_no_distance() {
        let all = explained(|_| ());
        assert_eq!(all.0, all.1);
        let of_misses = |answer: &mut Answer, number: f64| {
            let hit = answer["hit"].values.clone();
            let near = &mut answer.get_mut("t_near").expect("an output").values;
            near.zip_mut_with(&hit, |t, hit| *t = if *hit == 0.0 { number } else { *t });
        };
        assert_eq!(explained(|answer| of_misses(answer, f64::NAN)), all);
        assert_eq!(explained(|answer| of_misses(answer, -1e6)), all);
        // Hits are read, and without hits it isn't known what is.
        let moved = |answer: &mut Answer| answer.get_mut("t_near").expect("an output").values += 1.0;
        assert!(explained(moved).0 < all.0);
        let silent = |answer: &mut Answer| {
            of_misses(answer, -1e6);
            answer.remove("hit");
        };
        assert!(explained(silent).0 < all.0);
    }
}
