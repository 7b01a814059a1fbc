//! How far a candidate goes: a function of harmonics to degree 3 isn't wrong where degree 4 is asked, it isn't asked that; nor is one of
//! five coefficients asked for eight.

use super::answer::{Answer, Answers, reshaped};
use super::exam::{Exam, Question};
use crate::contract::arrays::number;
use crate::contract::case::Case;
use crate::contract::check::Kind;
use crate::contract::special::{Only, Reach};
use crate::convention::CS180;

/// The exam and the answers without the cases that are beyond the candidate, where there are some: it crashed on all of them, or gave
/// arrays of other shapes, and it did not on all others.
pub(crate) fn within_reach(exam: &Exam, answers: &[Answers]) -> Option<(Exam, Vec<Answers>)> {
    let each = || exam.questions.iter().zip(answers);
    // A gradient that crashes where its function answers isn't beyond it.
    let whole = |name: &str| {
        let mut forward = each().filter(|(q, _)| q.kind == Kind::Forward && q.component.name == name);
        let answered = |answers: &Answers| answers.iter().any(Option::is_some);
        forward.any(|(q, answers)| answered(answers) && left_out(q, answers).iter().all(Option::is_none))
    };
    let out = |(question, answers): (&Question, &Answers)| match question.kind {
        Kind::Vjp if whole(question.component.name) => vec![None; question.cases.len()],
        _ => left_out(question, answers),
    };
    let beyond: Vec<Vec<Option<String>>> = each().map(out).collect();
    if beyond.iter().flatten().all(Option::is_none) {
        return None;
    }
    let (mut exam, mut answers) = (exam.clone(), answers.to_vec());
    for ((question, answers), beyond) in exam.questions.iter_mut().zip(&mut answers).zip(beyond) {
        let (mut of_case, mut of_answer) = (beyond.iter(), beyond.iter());
        let mut kept = vec![];
        for case in question.cases.drain(..) {
            match of_case.next().expect("an entry a case") {
                None => kept.push(case),
                Some(why) => {
                    question.left_out.insert(case.id.clone(), why.clone());
                    question.crashed.remove(&case.id);
                }
            }
        }
        question.cases = kept;
        answers.retain(|_| of_answer.next().expect("an entry an answer").is_none());
    }
    Some((exam, answers))
}

/// Why each case isn't asked; `None` where it is.
fn left_out(question: &Question, answers: &Answers) -> Vec<Option<String>> {
    let special = question.component.special;
    let (reached, only) = (reached(question, answers), takes_only(question, answers));
    let why = |case: &Case| {
        if let Some((of, only)) = special.only.zip(only).filter(|(of, only)| length(case, of) != *only) {
            return Some(format!("{} other than {only}", of.what));
        }
        let (reach, reached) = special.reach.zip(reached)?;
        let number = case.inputs[reach.input].ndim() == 0;
        (extent(case, reach.input) > reached).then(|| match number {
            true => format!("{} above {reached}", reach.input),
            false => format!("more {} than {reached}", reach.input),
        })
    };
    question.cases.iter().map(why).collect()
}

/// The length of an axis to which alone a candidate answers: on others that are asked it crashes, or says nothing, as a loop over no bands
/// does. Shapes don't count here: whether columns are missing or another convention's isn't known yet.
fn takes_only(question: &Question, answers: &Answers) -> Option<usize> {
    let only = question.component.special.only?;
    let answered = |(_, answer): &(&Case, &Option<Answer>)| answer.is_some();
    let said = |(_, answer): &(&Case, &Option<Answer>)| {
        answer.iter().flat_map(|answer| answer.values()).any(|given| !given.values.is_empty())
    };
    let alone = |taken: &usize| {
        let asked = question.cases.iter().zip(answers);
        let (fitting, others): (Vec<_>, Vec<_>) = asked.partition(|(case, _)| length(case, &only) == *taken);
        let crashed = others.iter().any(|asked| !answered(asked));
        crashed && !others.iter().any(said) && fitting.iter().any(answered)
    };
    only.lengths.iter().copied().find(alone)
}

/// How long the axis is.
fn length(case: &Case, only: &Only) -> usize {
    case.inputs[only.input].shape()[only.axis]
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
    // Asked in the shapes of other conventions, what is right isn't known yet.
    if !question.admits(&CS180) {
        return false;
    }
    let expected = question.expected(case, &CS180);
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
    use crate::convention::Conventions;

    #[test]
    fn a_gradient_goes_as_far_as_its_function() {
        let exam = Exam::new("spherical_harmonics", Dtype::F32, None).unwrap();
        let right = |question: &Question, most: f64| -> Answers {
            let of = |case: &Case| {
                (extent(case, "degree") <= most).then(|| given((*question.expected(case, &CS180)).clone()))
            };
            question.cases.iter().map(of).collect()
        };
        let out = |forward: f64, gradient: f64| {
            let most = |kind| if kind == Kind::Vjp { gradient } else { forward };
            let answers: Vec<Answers> = exam.questions.iter().map(|q| right(q, most(q.kind))).collect();
            within_reach(&exam, &answers).is_some()
        };
        assert!(out(2.0, 2.0) && out(-1.0, 2.0));
        assert!(!out(4.0, 2.0), "what is left are crashes");
    }

    /// The verdict on harmonics that go to this degree, and are `times` what they should be.
    fn verdict(degree: f64, times: f64) -> (Verdict, usize) {
        judged("spherical_harmonics", "degree", degree, times)
    }

    /// The verdict on a row that answers up to this much of an input, and is `times` what it should be.
    fn judged(row: &str, input: &str, most: f64, times: f64) -> (Verdict, usize) {
        answering(row, times, |case| extent(case, input) <= most)
    }

    /// The verdict on a row that answers to such cases, and is `times` what it should be.
    fn answering(row: &str, times: f64, answers: impl Fn(&Case) -> bool) -> (Verdict, usize) {
        let exam = Exam::new(row, Dtype::F64, None).unwrap();
        let one = |question: &Question, case: &Case| {
            let direction = question.component.direction(question.kind).unwrap();
            let mut answer = given((direction.oracle)(&case.inputs, &CS180));
            answer.values_mut().for_each(|array| array.values *= times);
            answers(case).then_some(answer)
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

    #[test]
    fn what_is_written_for_points_in_space_is_asked_points_in_space() {
        let in_space = |case: &Case| case.inputs["x"].shape()[1] == 3;
        let right = answering("positional_encoding", 1.0, in_space);
        assert!(right.0 == Verdict::Pass && right.1 > 0, "{right:?}");
        assert_eq!(answering("positional_encoding", 1.01, in_space).0, Verdict::Fail);
        // Who crashes on one of these, too, has crashed.
        let some = |case: &Case| in_space(case) && case.inputs["x"].shape()[0] > 1;
        assert_eq!(answering("positional_encoding", 1.0, some).0, Verdict::Fail);
        let linear = |case: &Case| case.inputs["coefficients"].shape()[1] == 4;
        assert_eq!(answering("gaussian_color", 1.0, linear).0, Verdict::Pass);
        assert_eq!(answering("gaussian_color", 1.01, linear).0, Verdict::Fail);
        let colored = |case: &Case| case.inputs["prediction"].shape()[2] == 3;
        assert_eq!(answering("ssim", 1.0, colored).0, Verdict::Pass);
        assert_eq!(answering("ssim", 1.0, |_| true), (Verdict::Pass, 0));
    }

    #[test]
    fn what_is_written_for_points_in_space_may_leave_the_point_itself_out() {
        let exam = Exam::new("positional_encoding", Dtype::F64, None).unwrap();
        let alone = Conventions { identity: false, ..CS180 };
        // A loop over no bands reads no coordinate: it answers with nothing, of whatever length a point is.
        for answers_without_bands in [false, true] {
            let one = |question: &Question, case: &Case| {
                let direction = question.component.direction(question.kind).unwrap();
                let answer = || given((direction.oracle)(&case.inputs, &alone));
                let space = case.inputs["x"].shape()[1] == 3;
                let without_bands = answers_without_bands && number(&case.inputs, "L") == 0.0;
                (question.kind == Kind::Forward && (space || without_bands)).then(answer)
            };
            let all = |question: &Question| question.cases.iter().map(|case| one(question, case)).collect();
            let report = judge_answers(&exam, &exam.questions.iter().map(all).collect::<Vec<_>>(), EXP_ULP);
            assert_eq!(
                report.of("positional_encoding", "forward").unwrap().verdict,
                Verdict::Pass,
                "{report}"
            );
        }
    }

    /// Who is asked one length alone is asked enough: each mistake that shows in cases of at most that length shows in one of it.
    #[test]
    fn cases_of_one_length_show_what_shorter_ones_do() {
        for component in crate::registry::COMPONENTS {
            let Some(only) = component.special.only else { continue };
            let cases = (component.cases)();
            for (mistake, alone) in
                component.mistakes.iter().flat_map(|m| only.lengths.iter().map(move |n| (m, *n)))
            {
                let shows = |case: &&Case| {
                    let wrong = (component.forward.wrong)(&case.inputs, &CS180, &[mistake.name]);
                    let right = (component.forward.oracle)(&case.inputs, &CS180);
                    right.iter().any(|(name, right)| {
                        let wrong = &wrong[name];
                        wrong.shape() != right.shape()
                            || wrong.iter().zip(right).any(|(w, r)| (w - r).abs() > 1e-3 * r.abs())
                    })
                };
                let count = |fits: &dyn Fn(usize) -> bool| {
                    cases.iter().filter(|case| fits(length(case, &only))).filter(shows).count()
                };
                let (some, fitting) = (count(&|n| n <= alone), count(&|n| n == alone));
                let told = format!("{} {}: {some} cases, none of {alone}", component.name, mistake.name);
                assert!(some == 0 || fitting > 0, "{told}");
            }
        }
    }
}
