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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::check::Kind;
    use crate::convention::CS180;
    use crate::judge::answer::given;
    use crate::judge::report::Verdict;

    fn exam() -> Exam {
        Exam::of(&[("composite_background", Kind::Forward)], Dtype::F32, None).unwrap()
    }

    fn right(question: &Question, case: &Case) -> Reply {
        Reply::Answer(given((question.component.forward.oracle)(&case.inputs, &CS180)))
    }

    #[test]
    fn questions_come_once_or_four_times() {
        let cases = exam().questions[0].cases.len();
        for (again, times) in [(false, 1), (true, 4)] {
            let mut asked = 0;
            let report = examine(exam(), again, |question, case| {
                asked += 1;
                Ok::<_, ()>(right(question, case))
            });
            assert_eq!((report.unwrap().rows[0].verdict, asked), (Verdict::Pass, times * cases));
        }
    }

    #[test]
    fn an_error_ends_the_exam_at_once() {
        let mut asked = 0;
        let stopped = examine(exam(), true, |question, case| {
            asked += 1;
            if asked == 2 { Err("enough") } else { Ok(right(question, case)) }
        });
        assert_eq!((stopped.unwrap_err(), asked), ("enough", 2));
    }

    #[test]
    fn a_crash_is_its_case_s_result_and_nothing_is_no_answer() {
        let first = exam().questions[0].cases[0].id.clone();
        let asked = examine(exam(), true, |question, case| {
            let crashes = case.id == first;
            Ok::<_, ()>(if crashes { Reply::Crash("out of rays".into()) } else { right(question, case) })
        });
        let row = &asked.unwrap().rows[0];
        assert_eq!((row.verdict, &row.crashed[&first][..]), (Verdict::Fail, "out of rays"));
        assert!(row.faults[0].contains("crashed: out of rays"), "{:?}", row.faults);
        let silent = examine(exam(), false, |_, _| Ok::<_, ()>(Reply::Nothing)).unwrap();
        assert_eq!(silent.rows[0].verdict, Verdict::Unsupported);
    }
}
