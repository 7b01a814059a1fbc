//! Two axes in each other's place: splats by pixels for pixels by splats, points in columns for points in rows. Shapes show it, whatever else is
//! wrong.

use super::answer::Answers;
use super::exam::Question;
use crate::convention::Conventions;

/// The answers with the two axes of some outputs exchanged, and which: those of which every answer that isn't square has them so.
pub(super) fn transposed(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
) -> Option<(Answers, Vec<&'static str>)> {
    if !question.admits(base) {
        return None;
    }
    let mut names: Vec<&str> = question.component.outputs.iter().map(|port| port.name).collect();
    names.retain(|name| exchanged(question, answers, name, base));
    let mut turned = answers.clone();
    for (name, given) in turned.iter_mut().flatten().flatten() {
        if names.contains(&name.as_str()) {
            given.values = given.values.t().as_standard_layout().into_owned();
        }
    }
    (!names.is_empty()).then_some((turned, names))
}

/// Whether all answers of this output that aren't square have its axes exchanged, and there are some.
fn exchanged(question: &Question, answers: &Answers, name: &str, base: &Conventions) -> bool {
    let mut shown = false;
    let all = question.cases.iter().zip(answers).all(|(case, answer)| {
        let Some(given) = answer.as_ref().and_then(|answer| answer.get(name)) else { return true };
        let [rows, columns] = question.expected(case, base)[name].shape()[..] else { return false };
        // With one of either it is the same array.
        if rows.min(columns) <= 1 {
            return given.values.len() == rows * columns;
        }
        shown |= rows != columns;
        given.values.shape() == [columns, rows]
    });
    all && shown
}

#[cfg(test)]
mod tests {
    use super::super::answer::given;
    use super::super::exam::Exam;
    use super::super::judging::{EXP_ULP, judge_answers};
    use super::super::report::{Report, Verdict};
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::arrays::Arrays;
    use crate::contract::case::Case;
    use crate::contract::check::Kind;
    use crate::convention::CS180;

    fn exam() -> Exam {
        Exam::new("gaussian_alpha", Dtype::F64, None).unwrap()
    }

    fn turn(arrays: &mut Arrays) {
        arrays.values_mut().for_each(|a| *a = a.t().as_standard_layout().into_owned());
    }

    /// Opacities, splats by pixels in some cases.
    fn answers(question: &Question, wrong: &[&str], turned: impl Fn(&Case) -> bool) -> Answers {
        let one = |case: &Case| {
            let mut all: Arrays = (question.component.forward.wrong)(&case.inputs, &CS180, wrong);
            if turned(case) {
                turn(&mut all);
            }
            Some(given(all))
        };
        question.cases.iter().map(one).collect()
    }

    #[test]
    fn shapes_show_it() {
        let exam = exam();
        let question = exam.questions.iter().find(|q| q.kind == Kind::Forward).unwrap();
        let found = |turned: &dyn Fn(&Case) -> bool| {
            transposed(question, &answers(question, &[], turned), &CS180).is_some()
        };
        let square = |case: &Case| case.inputs["pixels"].shape()[0] == case.inputs["means2d"].shape()[0];
        assert!(found(&|_| true) && !found(&|_| false));
        assert!(!found(&square), "squares show nothing");
        assert!(!found(&|case| case.id != "GS5_faint"), "not in all cases");
    }

    fn report(wrong: &[&str]) -> Report {
        let exam = exam();
        let all = |question: &Question| match question.kind {
            Kind::Forward if question.component.name == "gaussian_alpha" => {
                answers(question, wrong, |_| true)
            }
            _ => vec![None; question.cases.len()],
        };
        judge_answers(&exam, &exam.questions.iter().map(all).collect::<Vec<_>>(), EXP_ULP)
    }

    #[test]
    fn it_is_a_layout() {
        let row = &report(&[]).rows[0];
        assert_eq!(row.verdict, Verdict::Pass);
        assert!(row.layouts.iter().any(|says| says.contains("in each other's place")), "{:?}", row.layouts);
    }

    #[test]
    fn what_else_is_wrong_is_named() {
        let row = &report(&["opacity_forgotten"]).rows[0];
        assert_eq!(row.verdict, Verdict::Fail);
        assert_eq!(row.diagnosis[0].mistakes[0].name, "opacity_forgotten");
    }
}
