//! How near honest code comes to the truth: what an error is held against that lies within its bound.

use super::answer::{Answers, given};
use super::exam::Question;
use super::mark::{MarkOptions, mark};
use crate::contract::arithmetic::Grade;
use crate::contract::machine::Machine;
use crate::convention::Conventions;
use crate::parallel;

/// The machines that are asked: the stable formula, with sums from left to right and in halves, products rounded or not.
const MACHINES: [u64; 4] = [8, 10, 12, 14];

/// The share of its bounds that the best of them uses, over the cases and outputs that are answered. `None` of statistics, where it
/// makes no error at all, and where it leaves its bounds: with exponentials asked to be more exact than the machines' are.
pub(super) fn best_honest(
    question: &Question,
    answers: &Answers,
    c: &Conventions,
    options: &MarkOptions,
    grade: Grade,
) -> Option<f64> {
    if question.statistics() || !question.admits(c) {
        return None;
    }
    let direction = question.component.direction(question.kind).expect("a question has its direction");
    let used = parallel::map(MACHINES.len(), |n| {
        let machine = Machine::number(options.dtype, MACHINES[n]);
        let asked = question.cases.iter().zip(answers).map(|(case, answer)| {
            let answer = answer.as_ref()?;
            let mut all = given((direction.honest)(&case.inputs, c, &machine));
            all.retain(|name, _| answer.contains_key(name));
            Some(all)
        });
        mark(question, &asked.collect(), c, options, grade).budget_used
    });
    Some(used.into_iter().fold(f64::INFINITY, f64::min)).filter(|used| 0.0 < *used && *used <= 1.0)
}
