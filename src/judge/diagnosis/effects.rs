//! Which mistakes can explain a case together: what is right there neither changes, and what is wrong there one of them does. Thousands of
//! pairs of a whole renderer's mistakes would take a minute; most change what is right.

use std::collections::{BTreeMap, BTreeSet};

use super::super::answer::{Answer, Answers};
use super::super::assignment::small_cases;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::hypothesis::Hypothesis;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::convention::Conventions;

/// The smallest case that the right formula doesn't explain in some conventions.
pub(super) struct Failing<'a> {
    case: &'a Case,
    answer: &'a Answer,
    /// Its outputs that are right.
    kept: Vec<&'a str>,
    expected: Arrays,
}

impl<'a> Failing<'a> {
    /// `None` where the right formula explains all cases.
    pub(super) fn new(
        question: &'a Question,
        answers: &'a Answers,
        c: &Conventions,
        options: &MarkOptions,
    ) -> Option<Self> {
        let right = Hypothesis::new(vec![], *c);
        let mut cases = small_cases(question, answers).into_iter();
        let (case, answer) = cases.find(|(case, answer)| !right.explains(question, case, answer, options))?;
        let mut kept: Vec<&str> = answer.keys().map(String::as_str).collect();
        let expected = right.keep_explained(question, case, answer, options, &mut kept);
        Some(Failing { case, answer, kept, expected })
    }

    /// Whether what is right is right in other conventions too: mistakes don't put right again what these have made wrong.
    pub(super) fn kept_by(&self, question: &Question, other: &Conventions, options: &MarkOptions) -> bool {
        let mut left = self.kept.clone();
        Hypothesis::new(vec![], *other).keep_explained(question, self.case, self.answer, options, &mut left);
        left == self.kept
    }
}

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
        let Failing { case, answer, kept, expected } = Failing::new(question, answers, c, options)?;
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
        let home = Failing::new(question, &answers, &CS180, &options).expect("it is wrong");
        let worse = |key, value| !home.kept_by(question, &CS180.with(key, value).expect("listed"), &options);
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
