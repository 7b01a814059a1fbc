//! Which mistakes can explain a case together: what is right there neither changes, and what is wrong there one of them does. Thousands of
//! pairs of a whole renderer's mistakes would take a minute; most change what is right.

use std::collections::{BTreeMap, BTreeSet};

use super::super::answer::Answers;
use super::super::assignment::small_cases;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::hypothesis::Hypothesis;
use crate::contract::check::Kind;
use crate::convention::Conventions;

/// What single mistakes do to the smallest case that the right formula doesn't explain in some conventions.
pub(super) struct Effects {
    /// Its outputs that are wrong.
    wrong: BTreeSet<String>,
    /// Those of them that each mistake changes, where it leaves the others right.
    changed: BTreeMap<&'static str, BTreeSet<String>>,
}

impl Effects {
    /// `None` where the right formula explains all cases.
    pub(super) fn new(
        question: &Question,
        answers: &Answers,
        c: &Conventions,
        options: &MarkOptions,
    ) -> Option<Self> {
        let right = Hypothesis::new(vec![], *c);
        let cases = small_cases(question, answers);
        let (case, answer) =
            cases.into_iter().find(|(case, answer)| !right.explains(question, case, answer, options))?;
        let mut kept: Vec<&str> = answer.keys().map(String::as_str).collect();
        let expected = right.keep_explained(question, case, answer, options, &mut kept);
        let wrong: BTreeSet<String> =
            answer.keys().filter(|n| !kept.contains(&n.as_str())).cloned().collect();
        let of = |name: &'static str| {
            let h = Hypothesis::new(vec![name], *c);
            let mut left = kept.clone();
            let said = h.keep_explained(question, case, answer, options, &mut left);
            let changed = wrong.iter().filter(|output| said.get(*output) != expected.get(*output)).cloned();
            (left == kept).then(|| (name, changed.collect()))
        };
        let changed = question.component.mistakes.iter().filter_map(|m| of(m.name)).collect();
        Some(Effects { wrong, changed })
    }

    /// Whether these mistakes together may explain the case: each leaves right what is, and what is wrong one of them changes.
    pub(super) fn allow(&self, mistakes: &[&str]) -> bool {
        let Some(all) = mistakes.iter().map(|name| self.changed.get(name)).collect::<Option<Vec<_>>>() else {
            return false;
        };
        self.wrong.iter().all(|output| all.iter().any(|changed| changed.contains(output)))
    }
}

/// Whether what the right formula explains in the run's conventions, of the smallest case that it doesn't explain whole, it explains in others
/// too: mistakes don't put right again what other conventions have made wrong.
pub(super) fn no_worse(
    question: &Question,
    answers: &Answers,
    (base, other): (&Conventions, &Conventions),
    options: &MarkOptions,
) -> bool {
    let (home, right) = (Hypothesis::new(vec![], *base), Hypothesis::new(vec![], *other));
    let mut cases = small_cases(question, answers).into_iter();
    let failing = cases.find(|(case, answer)| !home.explains(question, case, answer, options));
    let Some((case, answer)) = failing.filter(|_| question.kind == Kind::Forward) else { return true };
    let mut kept: Vec<&str> = answer.keys().map(String::as_str).collect();
    home.keep_explained(question, case, answer, options, &mut kept);
    let mut left = kept.clone();
    right.keep_explained(question, case, answer, options, &mut left);
    left == kept
}

#[cfg(test)]
mod tests {
    use super::super::fitted::tests::answered;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::convention::CS180;
    use crate::judge::exam::Exam;

    /// Other axes turn rays that are right.
    #[test]
    fn other_conventions_are_worse_where_they_change_what_is_right() {
        let exam = Exam::new("render_trace", Dtype::F64, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F64, exp_ulp: 4.0 });
        let answers = answered(question, Dtype::F64, &["inclusive_transmittance"]);
        let worse = |key, value| {
            let other = CS180.with(key, value).expect("listed");
            !no_worse(question, &answers, (&CS180, &other), &options)
        };
        assert!(worse("axes", "opengl"));
        assert!(!worse("product_eps", "1e-10"));
    }

    /// A pair that a trace was made with is allowed; what changes something right, or leaves something wrong, isn't.
    #[test]
    fn a_pair_changes_what_is_wrong_and_nothing_else() {
        let exam = Exam::new("render_trace", Dtype::F64, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F64, exp_ulp: 4.0 });
        let of = |mistakes: &[&str]| {
            let answers = answered(question, Dtype::F64, mistakes);
            Effects::new(question, &answers, &CS180, &options)
        };
        let pair = ["delta_missing", "divided_by_opacity"];
        let effects = of(&pair).expect("it is wrong");
        assert!(effects.allow(&pair));
        // Pixels are right.
        assert!(!effects.allow(&["delta_missing", "row_column_swapped"]));
        assert!(of(&[]).is_none());
        let all: Vec<&str> = question.component.mistakes.iter().map(|m| m.name).collect();
        let pairs = (0..all.len()).flat_map(|n| all[..n].iter().map(move |other| (n, *other)));
        let allowed = pairs.filter(|(n, other)| effects.allow(&[all[*n], other])).count();
        assert!(8 * allowed < all.len() * (all.len() - 1), "{allowed}");
    }
}
