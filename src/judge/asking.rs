//! An exam, question by question, of whoever answers: a closure in Rust, or a function of another language in the same process.

use super::answer::Answer;
use super::exam::{Exam, Question};
use super::judging::{EXP_ULP, judge_answers};
use super::repeat::Rounds;
use super::report::Report;
use crate::contract::case::Case;

/// What became of a question.
#[derive(Clone, Debug)]
pub enum Reply {
    /// Arrays by output.
    Answer(Answer),
    /// It crashed, and said this: that is the case's result.
    Crash(String),
    /// There is no answer.
    Nothing,
}

/// Asks every question of an exam and judges the answers. Where `again`, each question comes four times, so that answers that depend on
/// chance or on the question before show; otherwise once.
///
/// # Errors
/// What `ask` ends the exam with.
pub fn examine<E>(
    mut exam: Exam,
    again: bool,
    mut ask: impl FnMut(&Question, &Case) -> Result<Reply, E>,
) -> Result<Report, E> {
    let mut crashed = vec![];
    let rounds = Rounds::new(&exam, again, |question, case| match ask(question, case)? {
        Reply::Answer(answer) => Ok(Some(answer)),
        Reply::Nothing => Ok(None),
        Reply::Crash(said) => {
            crashed.push((question.row(), case.id.clone(), said));
            Ok(None)
        }
    })?;
    for (row, id, said) in crashed {
        let question = exam.questions.iter_mut().find(|question| question.row() == row);
        question.expect("it was asked").crashed.insert(id, said);
    }
    let mut report = judge_answers(&exam, &rounds.first, EXP_ULP);
    rounds.tell(&exam, |answers| judge_answers(&exam, answers, EXP_ULP), &mut report);
    Ok(report)
}
