//! Left open: what a mistake doesn't say of an answer, as it depends on how it is written.

use std::collections::BTreeMap;

use super::super::answer::{Answer, reshaped};
use super::super::exam::Question;
use super::hypothesis::Hypothesis;
use super::unread;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::check::Kind;

impl Hypothesis {
    /// What wrong code makes of an infinite input depends on how it is written: infinity times 0, or less infinity. NaN is predicted
    /// there where the answer has it; and where nobody reads what wrong code returns, what was answered.
    pub(crate) fn leave_open(&self, question: &Question, case: &Case, answer: &Answer, wrong: &mut Arrays) {
        if !self.right() && question.kind == Kind::Forward {
            self.leave_undecided(question, answer, wrong);
            unread::as_answered(question.component, case, answer, wrong);
        }
        if self.right() || case.finite() {
            return;
        }
        // Counts and flags aren't open.
        let open = |name: &String| !question.component.output_entries(name).whole();
        for (name, wrong) in wrong.iter_mut().filter(|(name, _)| open(name)) {
            let given = answer.get(name).and_then(|given| reshaped(&given.values, wrong.shape()));
            if let Some((got, _)) = given {
                wrong.zip_mut_with(&got, |w, g| *w = if g.is_nan() { f64::NAN } else { *w });
            }
        }
    }

    /// Whether one of its mistakes says nothing of some elements.
    fn opens(&self, question: &Question) -> bool {
        question.component.mistakes.iter().any(|m| m.open && self.mistakes.contains(&m.name))
    }

    /// Predicts what was answered where a mistake leaves it open.
    fn leave_undecided(&self, question: &Question, answer: &Answer, wrong: &mut Arrays) {
        if !self.opens(question) {
            return;
        }
        for (name, wrong) in wrong {
            let given = answer.get(name).and_then(|given| reshaped(&given.values, wrong.shape()));
            // A flag is one of two numbers, whatever decides it.
            let flag = question.component.output_entries(name).whole();
            let open = |g: f64| !flag || g == 0.0 || g == 1.0;
            if let Some((got, _)) = given {
                wrong.zip_mut_with(&got, |w, g| *w = if w.is_nan() && open(*g) { *g } else { *w });
            }
        }
    }

    /// Whether it leaves most of what was answered of some output open: that explains anything.
    pub(crate) fn says_little(&self, question: &Question, cases: &[(&Case, &Answer)]) -> bool {
        if question.kind == Kind::Vjp || !self.opens(question) {
            return false;
        }
        let mut counts: BTreeMap<String, [usize; 2]> = BTreeMap::new();
        for (case, answer) in cases {
            let said = self.prediction(question, case).0;
            for (name, said) in said.iter().filter(|(name, _)| answer.contains_key(*name)) {
                let [open, all] = counts.entry(name.clone()).or_default();
                *open += said.iter().filter(|x| x.is_nan()).count();
                *all += said.len();
            }
        }
        counts.values().any(|[open, all]| 2 * open > *all)
    }
}
