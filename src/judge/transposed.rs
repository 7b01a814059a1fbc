//! Two axes in each other's place: splats by pixels for pixels by splats, points in columns for points in rows. Shapes show it, whatever else is
//! wrong.

use super::answer::Answers;
use super::exam::Question;
use crate::convention::CS180;

/// The answers with the two axes of an output exchanged, and that in words, where every answer that isn't square has them so.
pub(super) fn transposed(question: &Question, answers: &Answers) -> Option<(Answers, String)> {
    if !question.admits(&CS180) {
        return None;
    }
    let mut names: Vec<&str> = question.component.outputs.iter().map(|port| port.name).collect();
    names.retain(|name| exchanged(question, answers, name));
    if names.is_empty() {
        return None;
    }
    let mut turned = answers.clone();
    for answer in turned.iter_mut().flatten() {
        for given in
            answer.iter_mut().filter(|(name, _)| names.contains(&name.as_str())).map(|(_, given)| given)
        {
            given.values = given.values.t().as_standard_layout().into_owned();
        }
    }
    Some((turned, format!("{}: the two axes are in each other's place", names.join(", "))))
}

/// Whether all answers of this output that aren't square have its axes exchanged, and some aren't.
fn exchanged(question: &Question, answers: &Answers, name: &str) -> bool {
    let mut shown = false;
    let all = question.cases.iter().zip(answers).all(|(case, answer)| {
        let Some(given) = answer.as_ref().and_then(|answer| answer.get(name)) else { return true };
        let expected = &question.expected(case, &CS180)[name];
        let ([a, b], [rows, columns]) = (given.values.shape(), expected.shape()) else { return false };
        // With one of either, another axis of length one is a layout by itself.
        shown |= rows != columns && rows.min(columns) > &1;
        (a, b) == (columns, rows)
    });
    all && shown
}

#[cfg(test)]
mod tests {
    use super::super::exam::Exam;
    use super::super::judging::{EXP_ULP, judge_answers};
    use super::super::report::{Report, Verdict};
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::arrays::Arrays;
    use crate::contract::case::Case;
    use crate::contract::check::Kind;
    use crate::judge::answer::given;

    fn report(wrong: &[&str], turned: impl Fn(&Case) -> bool) -> Report {
        let exam = Exam::new("gaussian_alpha", Dtype::F64, None).unwrap();
        let one = |question: &Question, case: &Case| {
            let mut all: Arrays = (question.component.forward.wrong)(&case.inputs, &CS180, wrong);
            if turned(case) {
                all.values_mut().for_each(|a| *a = a.t().to_owned());
            }
            (question.kind == Kind::Forward).then(|| given(all))
        };
        let all = |question: &Question| question.cases.iter().map(|case| one(question, case)).collect();
        judge_answers(&exam, &exam.questions.iter().map(all).collect::<Vec<_>>(), EXP_ULP)
    }

    #[test]
    fn splats_by_pixels_are_a_layout() {
        let row = &report(&[], |_| true).rows[0];
        assert_eq!(row.verdict, Verdict::Pass);
        assert!(row.layouts.iter().any(|says| says.contains("each other's place")), "{:?}", row.layouts);
        assert!(report(&[], |_| false).rows[0].layouts.is_empty());
        assert_eq!(report(&[], |case| case.id != "usual").rows[0].verdict, Verdict::Fail, "not in all cases");
    }

    #[test]
    fn what_else_is_wrong_is_named() {
        let row = &report(&["opacity_forgotten"], |_| true).rows[0];
        assert_eq!(row.verdict, Verdict::Fail);
        assert_eq!(row.diagnosis[0].mistakes[0].name, "opacity_forgotten");
    }
}
