//! Element by element: how much of what is allowed the errors of an output take, for a picture of where they sit.

use super::answer::{Answers, reshaped};
use super::exam::Exam;
use super::mark::MarkOptions;
use super::partial::apply;
use super::report::Row;
use crate::contract::arithmetic::Grade;
use crate::contract::check::budget_used;
use crate::convention::CS180;

/// The errors of an output in a case.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Errors {
    /// The output's shape.
    pub shape: Vec<usize>,
    /// Error over bound, row by row; above 1 it is wrong.
    pub used: Vec<f64>,
}

/// Those of the output in which a row's worst element is, in the conventions that the row is shown in.
pub(crate) fn errors(exam: &Exam, answers: &[Answers], row: &Row, exp_ulp: f64) -> Option<Errors> {
    let worst = row.worst_case.as_ref()?;
    let of = |n: &usize| {
        (exam.questions[*n].component.name, exam.questions[*n].kind_name()) == (row.name, row.kind)
    };
    let n = (0..exam.questions.len()).find(of)?;
    let question = &exam.questions[n];
    if question.statistics() {
        return None;
    }
    let at = question.cases.iter().position(|case| case.id == worst.id)?;
    let base = exam.profile.map_or(CS180, |profile| profile.conventions);
    let c = apply(&row.shown_in, &apply(&row.conventions, &base));
    let options = MarkOptions { dtype: exam.dtype, exp_ulp };
    let truth = options.truth(question, &question.cases[at], &c, Grade::B);
    let (expected, bound) = (truth.expected.get(&worst.output)?, truth.bound.get(&worst.output)?);
    let (got, _) = reshaped(&answers[n][at].as_ref()?.get(&worst.output)?.values, expected.shape())?;
    let used = got
        .iter()
        .zip(expected)
        .zip(bound)
        .map(|((&got, &expected), &bound)| budget_used(got, expected, bound));
    Some(Errors { shape: expected.shape().to_vec(), used: used.collect() })
}
