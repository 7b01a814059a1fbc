//! What forward answers say of a gradient's diagnosis: right ones refute whatever would have made them wrong, and wrong ones that are
//! explained whatever would have made others of them.

use super::super::answer::Answers;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::partial::apply;
use super::super::report::{Row, Verdict};
use super::evidence::{Explanation, explains_all};
use super::hypothesis::Hypothesis;
use crate::convention::Conventions;

/// Drops what a component's forward answers refute, if they pass or if all of them are explained by a mistake.
pub(crate) fn refuted(
    diagnosis: &mut Vec<Explanation>,
    forward: &Row,
    (question, answers): (&Question, &Answers),
    base: &Conventions,
    options: &MarkOptions,
) {
    let passes = forward.verdict == Verdict::Pass;
    let whole = |e: &Explanation| e.whole() && !e.mistakes.is_empty() && e.slip.is_none();
    if !passes && !forward.diagnosis.first().is_some_and(whole) {
        return;
    }
    let fits = |e: &Explanation| {
        let mistakes = e.mistakes.iter().filter(|m| !m.gradient).map(|m| m.name).collect();
        let own = Hypothesis::new(mistakes, apply(&e.conventions, base));
        let numbered = e.mistakes.iter().filter(|m| m.number.is_some());
        let fitted =
            numbered.zip(&e.fitted).filter(|(m, _)| !m.gradient).map(|(_, number)| *number).collect();
        explains_all(&Hypothesis { fitted, slip: e.slip.clone(), ..own }, question, answers, options)
    };
    // A gradient may not show the number in a mistake.
    let names = |e: &Explanation| e.mistakes.iter().map(|m| m.name).collect::<Vec<_>>();
    let shown = |e: &Explanation| forward.diagnosis.iter().any(|f| names(f) == names(e));
    diagnosis.retain(|e| !e.of_forward() || shown(e) || fits(e));
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::super::super::judging::{EXP_ULP, judge_answers};
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::check::Kind;
    use crate::convention::CS180;

    /// What a gradient is said to be that is the clamped color's, beside forward answers with these mistakes.
    fn said(mistakes: &[&'static str]) -> Vec<&'static str> {
        let exam = Exam::new("composite_background", Dtype::F64, None).unwrap();
        let one = |question: &Question| -> Answers {
            let own = if question.kind == Kind::Vjp { vec!["clamped"] } else { mistakes.to_vec() };
            let h = Hypothesis::new(own, CS180);
            question.cases.iter().map(|case| Some(given(h.prediction(question, case).0))).collect()
        };
        let report = judge_answers(&exam, &exam.questions.iter().map(one).collect::<Vec<_>>(), EXP_ULP);
        let row = report.of("composite_background", "vjp").unwrap();
        assert_eq!(row.verdict, Verdict::Fail, "{report}");
        row.diagnosis.iter().flat_map(|e| &e.mistakes).map(|m| m.name).collect()
    }

    /// A gradient that is divided by rays, beside a value that is divided by rays and channels: it has its own name.
    #[test]
    fn what_the_gradient_alone_has_is_looked_for_by_itself() {
        let exam = Exam::new("mse", Dtype::F32, None).unwrap();
        let one = |question: &Question| -> Answers {
            let times = if question.kind == Kind::Vjp { 3.0 } else { 1.0 };
            let right = |case| Hypothesis::new(vec![], CS180).prediction(question, case).0;
            let rounded = |a: ndarray::ArrayD<f64>| a.mapv(|x| Dtype::F32.round(times * x));
            let answer = |case| given(right(case).into_iter().map(|(name, a)| (name, rounded(a))).collect());
            question.cases.iter().map(|case| Some(answer(case))).collect()
        };
        let report = judge_answers(&exam, &exam.questions.iter().map(one).collect::<Vec<_>>(), EXP_ULP);
        let row = report.of("mse", "vjp").unwrap();
        let best = row.diagnosis.first().and_then(|best| best.slip.as_ref()).map(|slip| slip.says());
        assert!(best.as_ref().is_some_and(|says| says.starts_with("grad_prediction times")), "{best:?}");
    }

    #[test]
    fn forward_answers_say_what_a_gradient_is_not() {
        assert!(said(&["clamped"]).contains(&"clamped"));
        assert!(!said(&[]).contains(&"clamped"));
        assert!(!said(&["one_channel"]).contains(&"clamped"));
    }
}
