//! Asked again: the same question must get the same answer, whatever was asked before it.

use super::answer::{Answer, Answers, Given};
use super::exam::{Exam, Question};
use super::report::{Report, Verdict};
use crate::contract::case::Case;

/// What is said of answers that change.
const CHANCE: &str = "not deterministic: asked twice in a row, it answers with other bits";
const STALE: &str = "stale state: asked again after another question, it answers with other bits";

/// Whether a text is one of these.
fn of_repeating(text: &str) -> bool {
    text.starts_with(CHANCE) || text.starts_with(STALE)
}

/// Answers to the exam in its order, and then to the same questions in the opposite one, each asked three times in a row: the first of
/// these comes after another question, the others after the same one.
pub(super) struct Rounds {
    /// In the exam's order.
    pub first: Vec<Answers>,
    /// Where it is asked again at all.
    again: Option<[Vec<Answers>; 3]>,
}

impl Rounds {
    /// Asks, four times or once. Rows that are judged by statistics are asked once: their answers are random.
    pub(super) fn new<E>(
        exam: &Exam,
        again: bool,
        mut ask: impl FnMut(&Question, &Case) -> Result<Option<Answer>, E>,
    ) -> Result<Rounds, E> {
        let mut first: Vec<Answers> = vec![];
        for question in &exam.questions {
            first.push(question.cases.iter().map(|case| ask(question, case)).collect::<Result<_, E>>()?);
        }
        if !again {
            return Ok(Rounds { first, again: None });
        }
        let mut rounds = [0; 3].map(|_| first.clone());
        for (n, question) in exam.questions.iter().enumerate().rev().filter(|(_, q)| !q.statistics()) {
            for (k, case) in question.cases.iter().enumerate().rev() {
                for round in &mut rounds {
                    round[n][k] = ask(question, case)?;
                }
            }
        }
        Ok(Rounds { first, again: Some(rounds) })
    }

    /// Adds what the other rounds show: where other bits came, whether by chance or after another question, and by how much. That is
    /// told of a row whose answers are right every time, or wrong anyway, and fails one whose aren't.
    pub(super) fn tell(&self, exam: &Exam, judge: impl Fn(&[Answers]) -> Report, report: &mut Report) {
        for other in self.again.iter().flatten() {
            if changed(&self.first, other).is_empty() {
                continue;
            }
            let later = judge(other);
            for (n, text) in self.changes(exam, other) {
                let row = &mut report.rows[n];
                if row.verdict == Verdict::Pass && later.rows[n].verdict == Verdict::Fail {
                    *row = later.rows[n].clone();
                    row.faults.push(text);
                } else if row.verdict == Verdict::Fail && !row.faults.iter().any(|fault| of_repeating(fault))
                {
                    // Whatever else is wrong: what changes from call to call explains it before any formula does.
                    row.faults.insert(0, text);
                } else if row.verdict != Verdict::Fail && row.findings.is_empty() {
                    row.findings.push(text);
                }
            }
        }
    }

    /// The questions whose answers changed, and the largest change.
    fn changes(&self, exam: &Exam, other: &[Answers]) -> Vec<(usize, String)> {
        let describe = |n: usize| {
            let [_, second, third] = self.again.as_ref().expect("another round differs");
            let chance = second[n].iter().zip(&third[n]).any(|(a, b)| differs(a, b));
            let cause = if chance { CHANCE } else { STALE };
            let pairs = exam.questions[n].cases.iter().zip(self.first[n].iter().zip(&other[n]));
            let largest = pairs.filter_map(|(case, (a, b))| Some((case, largest(a.as_ref()?, b.as_ref()?)?)));
            let largest = largest.max_by(|(_, a), (_, b)| a.1.total_cmp(&b.1));
            let at = largest.map(|(case, (name, by))| format!(" ({name} of {} is {by:.1e} off)", case.id));
            cause.to_string() + &at.unwrap_or_default()
        };
        changed(&self.first, other).into_iter().map(|n| (n, describe(n))).collect()
    }
}

/// The questions that have other answers.
fn changed(a: &[Answers], b: &[Answers]) -> Vec<usize> {
    (0..a.len()).filter(|&n| a[n].iter().zip(&b[n]).any(|(a, b)| differs(a, b))).collect()
}

fn differs(a: &Option<Answer>, b: &Option<Answer>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => a.len() != b.len() || largest(a, b).is_some(),
        _ => a.is_some() != b.is_some(),
    }
}

/// The array that differs most and by how much, relative to its largest number; `None` where all are equal.
fn largest(a: &Answer, b: &Answer) -> Option<(String, f64)> {
    let one = |(name, a): (&String, &Given)| {
        let b = &b.get(name)?.values;
        if a.values.shape() != b.shape() {
            return Some((name.clone(), f64::INFINITY));
        }
        let same = |a: f64, b: f64| a == b || a.is_nan() && b.is_nan();
        let off = a.values.iter().zip(b).filter(|&(&a, &b)| !same(a, b));
        let off = off.map(|(a, b)| (a - b).abs()).map(|off| if off.is_nan() { f64::INFINITY } else { off });
        let off = off.reduce(f64::max)?;
        let size = a.values.iter().filter(|x| x.is_finite()).fold(0.0, |max: f64, x| max.max(x.abs()));
        Some((name.clone(), if off == 0.0 { 0.0 } else { off / size.max(f64::MIN_POSITIVE) }))
    };
    a.iter().filter_map(one).max_by(|a, b| a.1.total_cmp(&b.1))
}
