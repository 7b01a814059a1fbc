//! The judge: answers in, verdicts and diagnoses out.

use std::sync::Arc;

use super::answer::Answers;
use super::edges::but_for_edges;
use super::exam::Exam;
use super::mark::MarkOptions;
use super::reach::within_reach;
use super::report::Report;
use super::round::Laid;

/// The contract's accuracy of exp, log, sin and cos, in ULP.
pub const EXP_ULP: f64 = 4.0;

/// Judges answers to an exam, a list per question.
pub fn judge_answers(exam: &Exam, answers: &[Answers], exp_ulp: f64) -> Report {
    let reached = within_reach(exam, answers);
    let (exam, answers) = reached.as_ref().map_or((exam, answers), |(exam, answers)| (exam, &answers[..]));
    let options = MarkOptions { dtype: exam.dtype, exp_ulp };
    let nothing = answers.iter().map(|_| Arc::default()).collect();
    let whole = Laid::new(exam, answers, nothing, &options);
    let report = |exam: &Exam, answers: &[Answers], whole: &Laid| {
        but_for_edges(exam, answers, whole, &options).unwrap_or_else(|| whole.report(exam, &options))
    };
    match whole.in_their_order(exam, answers, &options) {
        Some((exam, answers, whole)) => report(&exam, &answers, &whole),
        None => report(exam, answers, &whole),
    }
}
