//! Right, but for edge cases: what is wrong in cases alone that few programs ever meet (no samples, an infinite density) is told apart
//! from what is wrong everywhere.

use super::answer::{Answer, Answers};
use super::diagnosis::diagnose::diagnose;
use super::exam::{Exam, Question};
use super::example::smallest;
use super::mark::{MarkOptions, Marks};
use super::report::{Report, Row, Verdict};
use super::round::{Laid, marks};
use crate::contract::case::Case;
use crate::convention::Conventions;

/// The report of a run in which some rows are right in all cases but edge cases; `None` where there is no such row. These then say
/// nothing of the run's conventions.
pub(super) fn but_for_edges(
    exam: &Exam,
    answers: &[Answers],
    whole: &Laid,
    options: &MarkOptions,
) -> Option<Report> {
    let wrong = |n: &usize| whole.marks(*n).is_some_and(|marks| !marks.right());
    let tells = |n: &usize| tells(&exam.questions[*n], &answers[*n]);
    let some: Vec<usize> = (0..answers.len()).filter(|n| wrong(n) && tells(n)).collect();
    let usual = (!some.is_empty()).then(|| Usual::new(exam, answers, whole, &some, options))?;
    let right: Vec<usize> = some.iter().copied().filter(|n| usual.passes(*n)).collect();
    // What is wrong elsewhere too is judged by all of its cases.
    let usual = match right.len() {
        0 => return None,
        n if n == some.len() => usual,
        _ => Usual::new(exam, answers, whole, &right, options),
    };
    let mut report = usual.laid.report(&usual.exam, options);
    for &n in &right {
        let row = &mut report.rows[n];
        if row.verdict != Verdict::Pass {
            return None;
        }
        let (question, c) = (&exam.questions[n], usual.laid.conventions());
        let answers = joined(question, &answers[n], usual.laid.answers(n));
        *row = told_apart(row, question, &answers, c, options);
    }
    Some(report)
}

/// Whether there are edge cases and others, each with a result of its own: an answer or a crash.
fn tells(question: &Question, answers: &Answers) -> bool {
    let edges = question.cases.iter().filter(|case| case.edge.is_some()).count();
    let mut cases = question.cases.iter().zip(answers);
    let silent = cases.any(|(case, answer)| answer.is_none() && !question.crashed.contains_key(&case.id));
    !question.statistics() && 0 < edges && edges < question.cases.len() && !silent
}

/// An exam without the edge cases of some questions, and its answers, marked.
struct Usual {
    exam: Exam,
    laid: Laid,
}

impl Usual {
    fn new(exam: &Exam, answers: &[Answers], whole: &Laid, some: &[usize], options: &MarkOptions) -> Usual {
        let (all, mut exam, mut answers) = (exam, exam.clone(), answers.to_vec());
        for (question, all) in exam.questions.iter_mut().zip(&all.questions) {
            question.truths = all.truths.shared();
        }
        for &n in some {
            let question = &mut exam.questions[n];
            let usual: Vec<bool> = question.cases.iter().map(|case| case.edge.is_none()).collect();
            let mut kept = usual.iter();
            answers[n].retain(|_| *kept.next().expect("an answer a case"));
            question.crashed.retain(|id, _| question.cases.iter().any(|c| c.id == *id && c.edge.is_none()));
            question.cases.retain(|case| case.edge.is_none());
        }
        let laid = Laid::new(&exam, &answers, whole.known_but_of(some), options);
        Usual { exam, laid }
    }

    fn passes(&self, n: usize) -> bool {
        self.laid.marks(n).is_some_and(Marks::pass)
    }
}

/// A row that passes without its edge cases, with what happens in these.
fn told_apart(
    usual: &Row,
    question: &Question,
    answers: &Answers,
    c: &Conventions,
    options: &MarkOptions,
) -> Row {
    let (marks, _) = marks(question, answers, c, options);
    let edge = |id: &String| question.cases.iter().find(|case| case.id == *id)?.edge;
    let mut row = Row {
        verdict: Verdict::Edge,
        edge_cases: marks.wrong_cases.iter().filter_map(edge).collect(),
        layouts: usual.layouts.clone(),
        example: smallest(question, answers, c, options),
        ..Row::marked(question, answers, &marks, usual.grade, c)
    };
    // A crash explains itself; numbers, and what is none, may be a mistake that shows nowhere else.
    if question.crashed.is_empty() {
        row.diagnosis = diagnose(question, answers, c, &[], options);
        row.diagnosis.retain(|e| e.whole() && e.wrong());
    }
    row
}

/// The answers to all cases: those without edge cases as they were laid, and those to edge cases as they came.
fn joined(question: &Question, answers: &Answers, usual: &Answers) -> Answers {
    let mut usual = usual.iter();
    let one = |(case, answer): (&Case, &Option<Answer>)| {
        if case.edge.is_some() { answer.clone() } else { usual.next().expect("an answer a case").clone() }
    };
    question.cases.iter().zip(answers).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::super::answer::given;
    use super::super::judging::{EXP_ULP, judge_answers};
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::check::Kind;
    use crate::convention::CS180;

    /// The report on right answers after a change.
    fn report(row: &str, change: impl Fn(&Question, &Case, Answer) -> Option<Answer>) -> Report {
        report_on(row, &[Kind::Forward, Kind::Vjp], change)
    }

    /// The same of these directions alone.
    fn report_on(
        row: &str,
        kinds: &[Kind],
        change: impl Fn(&Question, &Case, Answer) -> Option<Answer>,
    ) -> Report {
        let mut exam = Exam::new(row, Dtype::F32, None).unwrap();
        exam.questions.retain(|question| question.component.name == row && kinds.contains(&question.kind));
        let mut all = vec![];
        for question in &mut exam.questions {
            let direction = question.component.direction(question.kind).unwrap();
            let right = |case: &Case| given((direction.oracle)(&case.inputs, &CS180));
            let answers: Answers =
                question.cases.iter().map(|case| change(question, case, right(case))).collect();
            let crashed = question.cases.iter().zip(&answers).filter(|(_, answer)| answer.is_none());
            question.crashed = crashed.map(|(case, _)| (case.id.clone(), "no words".into())).collect();
            all.push(answers);
        }
        judge_answers(&exam, &all, EXP_ULP)
    }

    fn times(mut answer: Answer, factor: f64) -> Answer {
        answer.values_mut().for_each(|array| array.values *= factor);
        answer
    }

    #[test]
    fn what_crashes_or_is_nan_in_edge_cases_alone_is_told_apart() {
        let report = report("volume_render", |_, case, answer| match case.id.as_str() {
            "VR9_no_samples" => None,
            "VR9_infinite" => Some(times(answer, f64::NAN)),
            _ => Some(answer),
        });
        for row in &report.rows {
            assert_eq!(row.verdict, Verdict::Edge, "{report}");
            assert_eq!(row.edge_cases.len(), row.wrong_cases.len(), "{report}");
        }
        assert_eq!(report.rows[0].edge_cases, ["an infinite density", "no samples"], "{report}");
        assert!(report.rows[0].diagnosis.is_empty() && report.rows[0].cases > 20);
        let line = "right, but for edge cases: an infinite density (NaN: VR9_infinite), no samples (crashes: VR9_no_samples)";
        assert!(report.to_string().contains(line), "{report}");
        assert_eq!((report.exit_code(), report.exit_code_allowing(&[Verdict::Edge])), (1, 0));
    }

    #[test]
    fn conventions_are_found_without_edge_cases() {
        let other = CS180.with("frequency", "one").unwrap();
        let report = report("positional_encoding", |question, case, _| {
            let direction = question.component.direction(question.kind).unwrap();
            (case.edge.is_none()).then(|| given((direction.oracle)(&case.inputs, &other)))
        });
        assert_eq!((report.rows[0].verdict, report.rows[0].conventions["frequency"]), (Verdict::Edge, "one"));
    }

    #[test]
    fn what_is_wrong_elsewhere_too_or_unproved_without_them_fails() {
        let worse = report_on("volume_render", &[Kind::Forward], |_, case, answer| match case.id.as_str() {
            "VR9_no_samples" => None,
            "slab" => Some(times(answer, 1.01)),
            _ => Some(answer),
        });
        assert_eq!(worse.rows[0].verdict, Verdict::Fail, "{worse}");
        assert!(worse.rows[0].edge_cases.is_empty() && worse.rows[0].wrong_cases.len() == 2);
        let empty = report_on("volume_render", &[Kind::Forward], |_, case, answer| {
            case.edge.is_none().then(|| times(answer, 0.0)).filter(|_| case.id == "empty_ray")
        });
        assert_eq!(empty.rows[0].verdict, Verdict::Fail, "{empty}");
    }

    #[test]
    fn other_numbers_in_edge_cases_alone_are_told_apart_too() {
        let report = report_on("volume_render", &[Kind::Forward], |_, case, mut answer| {
            if case.id == "VR9_no_samples" {
                answer.values_mut().for_each(|array| array.values.fill(0.5));
            }
            Some(answer)
        });
        assert_eq!(report.rows[0].verdict, Verdict::Edge, "{report}");
        assert!(report.to_string().contains("no samples (other numbers: VR9_no_samples)"), "{report}");
    }

    #[test]
    fn what_is_no_number_in_edge_cases_alone_is_named_in_any_convention() {
        for norm in ["l2", "linf", "merf"] {
            let c = CS180.with("contraction_norm", norm).unwrap();
            let report = report("contraction", |question, case, _| {
                let back = question.kind == Kind::Vjp;
                let wrong = if back { &["gradient_not_a_number_at_origin"][..] } else { &[] };
                Some(given((question.component.direction(question.kind).unwrap().wrong)(
                    &case.inputs,
                    &c,
                    wrong,
                )))
            });
            let row = report.rows.iter().find(|row| row.kind == "vjp").expect("it has a gradient");
            let first: Vec<&str> = row.diagnosis[0].mistakes.iter().map(|m| m.name).collect();
            assert_eq!((row.verdict, &first[..]), (Verdict::Edge, &["gradient_not_a_number_at_origin"][..]));
        }
    }
}
