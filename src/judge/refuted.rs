//! What forward answers say of a gradient's diagnosis: right ones refute whatever would have made them wrong, and wrong ones that are
//! explained whatever doesn't explain them.

use super::answer::Answers;
use super::evidence::{Explanation, explains_all};
use super::exam::Question;
use super::hypothesis::Hypothesis;
use super::mark::MarkOptions;
use super::partial::apply;
use super::report::{Row, Verdict};
use crate::convention::Conventions;

/// Drops what a component's forward answers refute, if they pass or if all of them are explained by a mistake.
pub(super) fn refuted(
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
        explains_all(
            &Hypothesis { fitted: e.fitted, slip: e.slip.clone(), ..own },
            question,
            answers,
            options,
        )
    };
    diagnosis.retain(|e| !e.of_forward() || !passes && fits(e));
}
