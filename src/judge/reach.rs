//! How far a candidate goes: a function of harmonics to degree 3 isn't wrong where degree 4 is asked, it isn't asked that; nor is one of
//! five coefficients asked for eight.

use super::answer::{Answer, Answers, reshaped};
use super::exam::{Exam, Question};
use crate::contract::arrays::number;
use crate::contract::case::Case;
use crate::contract::special::Reach;

/// The exam and the answers without the cases that are beyond the candidate, where there are some: it crashed on all of them, or gave
/// arrays of other shapes, and it did not on all others.
pub(crate) fn within_reach(exam: &Exam, answers: &[Answers]) -> Option<(Exam, Vec<Answers>)> {
    let reached: Vec<Option<f64>> = exam.questions.iter().zip(answers).map(|(q, a)| reached(q, a)).collect();
    if reached.iter().all(Option::is_none) {
        return None;
    }
    let (mut exam, mut answers) = (exam.clone(), answers.to_vec());
    for ((question, answers), reached) in exam.questions.iter_mut().zip(&mut answers).zip(reached) {
        let (Some(reach), Some(reached)) = (question.component.special.reach, reached) else { continue };
        let far = |case: &Case| extent(case, reach.input) > reached;
        let mut asked = question.cases.iter().map(|case| !far(case));
        answers.retain(|_| asked.next().expect("an answer a case"));
        for case in question.cases.iter().filter(|case| far(case)) {
            let beyond = if case.inputs[reach.input].ndim() == 0 {
                format!("{} above {reached}", reach.input)
            } else {
                format!("more {} than {reached}", reach.input)
            };
            question.left_out.insert(case.id.clone(), beyond);
            question.crashed.remove(&case.id);
        }
        question.cases.retain(|case| !far(case));
    }
    Some((exam, answers))
}

/// How far a case goes: a number, or how many there are.
fn extent(case: &Case, input: &str) -> f64 {
    if case.inputs[input].ndim() == 0 { number(&case.inputs, input) } else { case.inputs[input].len() as f64 }
}

/// The largest number that a candidate answers to, where larger ones are asked and all beyond it.
fn reached(question: &Question, answers: &Answers) -> Option<f64> {
    let Reach { input, least } = question.component.special.reach?;
    let asked = |case: &Case| extent(case, input);
    let largest = question.cases.iter().map(asked).fold(f64::NEG_INFINITY, f64::max);
    let heard = |(case, answer): &(&Case, &Option<Answer>)| !beyond(question, case, answer.as_ref());
    let heard = question.cases.iter().zip(answers).filter(heard);
    let reached = heard.map(|(case, _)| asked(case)).fold(f64::NEG_INFINITY, f64::max);
    (least <= reached && reached < largest).then_some(reached)
}

/// Whether nothing of the right shape was answered.
fn beyond(question: &Question, case: &Case, answer: Option<&Answer>) -> bool {
    let Some(answer) = answer else { return true };
    let direction = question.component.direction(question.kind).expect("a question has its direction");
    let expected = (direction.oracle)(&case.inputs, &crate::convention::CS180);
    let fits = |name: &String| {
        let given = answer.get(name)?;
        reshaped(&given.values, expected[name].shape())
    };
    expected.keys().all(|name| fits(name).is_none())
}

#[cfg(test)]
mod tests {
    use super::super::answer::given;
    use super::super::judging::{EXP_ULP, judge_answers};
    use super::super::report::Verdict;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::convention::CS180;

    /// The verdict on harmonics that go to this degree, and are `times` what they should be.
    fn verdict(degree: f64, times: f64) -> (Verdict, usize) {
        judged("spherical_harmonics", "degree", degree, times)
    }

    /// The verdict on a row that answers up to this much of an input, and is `times` what it should be.
    fn judged(row: &str, input: &str, most: f64, times: f64) -> (Verdict, usize) {
        let exam = Exam::new(row, Dtype::F64, None).unwrap();
        let one = |question: &Question, case: &Case| {
            let direction = question.component.direction(question.kind).unwrap();
            let mut answer = given((direction.oracle)(&case.inputs, &CS180));
            answer.values_mut().for_each(|array| array.values *= times);
            (extent(case, input) <= most).then_some(answer)
        };
        let all = |question: &Question| question.cases.iter().map(|case| one(question, case)).collect();
        let report = judge_answers(&exam, &exam.questions.iter().map(all).collect::<Vec<_>>(), EXP_ULP);
        (report.rows[0].verdict, report.rows[0].left_out.len())
    }

    #[test]
    fn harmonics_to_degree_3_are_judged_to_degree_3() {
        let (to_4, to_3) = (verdict(4.0, 1.0), verdict(3.0, 1.0));
        assert_eq!((to_4, to_3.0), ((Verdict::Pass, 0), Verdict::Pass));
        assert!(to_3.1 > 0);
        assert_eq!(verdict(3.0, 1.01).0, Verdict::Fail);
        assert_eq!(verdict(0.0, 1.0).0, Verdict::Fail, "a constant is no harmonics");
    }

    #[test]
    fn a_lens_of_five_coefficients_is_judged_by_five() {
        let lens = |most, times| judged("lens_distort", "coefficients", most, times);
        assert_eq!(lens(8.0, 1.0), (Verdict::Pass, 0));
        let five = lens(5.0, 1.0);
        assert!(five.0 == Verdict::Pass && five.1 > 0);
        assert_eq!(lens(5.0, 1.01).0, Verdict::Fail);
    }
}
