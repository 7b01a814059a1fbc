//! An exam, question by question, of whoever answers: a closure in Rust, or a function of another language in the same process.

use super::answer::{Manner, Reply};
use super::exam::{Exam, Question};
use super::judging::{EXP_ULP, judge_answers};
use super::repeat::Rounds;
use super::report::Report;
use crate::contract::case::Case;

/// Asks every question of an exam and judges the answers. Where `again`, each question comes four times, so that answers that depend on
/// chance or on the question before show, and then otherwise: its rays or points in another order, in tiles of another size, in arrays
/// with gaps between the elements.
///
/// # Errors
/// What `ask` ends the exam with.
pub fn examine<E>(
    mut exam: Exam,
    again: bool,
    ask: impl FnMut(&Question, &Case, Manner) -> Result<Reply, E>,
) -> Result<Report, E> {
    let rounds = Rounds::new(&exam, again, ask)?;
    for ((n, id), said) in &rounds.crashed {
        exam.questions[*n].crashed.insert(id.clone(), said.clone());
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
    fn questions_come_once_or_four_times_and_with_strides() {
        let cases = exam().questions[0].cases.len();
        for (again, times) in [(false, [1, 0]), (true, [4, 1])] {
            let mut asked = [0; 2];
            let report = examine(exam(), again, |question, case, manner| {
                let whole = question.cases.contains(case);
                asked[usize::from(manner == Manner::Strided)] += usize::from(whole);
                Ok::<_, ()>(right(question, case))
            });
            assert_eq!((report.unwrap().rows[0].verdict, asked), (Verdict::Pass, times.map(|n| n * cases)));
        }
    }

    #[test]
    fn an_error_ends_the_exam_at_once() {
        let mut asked = 0;
        let stopped = examine(exam(), true, |question, case, _| {
            asked += 1;
            if asked == 2 { Err("enough") } else { Ok(right(question, case)) }
        });
        assert_eq!((stopped.unwrap_err(), asked), ("enough", 2));
    }

    #[test]
    fn a_crash_is_its_case_s_result_and_nothing_is_no_answer() {
        let first = exam().questions[0].cases[0].id.clone();
        let asked = examine(exam(), true, |question, case, _| {
            let crashes = case.id == first;
            Ok::<_, ()>(if crashes { Reply::Crash("out of rays".into()) } else { right(question, case) })
        });
        let row = &asked.unwrap().rows[0];
        assert_eq!((row.verdict, &row.crashed[&first][..]), (Verdict::Fail, "out of rays"));
        assert!(row.faults[0].contains("crashed: out of rays"), "{:?}", row.faults);
        let silent = examine(exam(), false, |_, _, _| Ok::<_, ()>(Reply::Nothing)).unwrap();
        assert_eq!(silent.rows[0].verdict, Verdict::Unsupported);
    }
}
