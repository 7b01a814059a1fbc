//! Gradients that follow from what the forward answers showed: their mistakes, each part of them, or their slip.

use super::super::answer::Answers;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::evidence::{Explanation, forward_is_the_same};
use super::hypothesis::{Hypothesis, number_of};
use super::slips::slipping::{explanations, was_done};
use crate::convention::{CHOICES, Conventions};

/// Mistakes each part of which is tried, at most.
const SEVERAL: usize = 4;

/// What explains a gradient as one of several mistakes, or the slip, of the forward answers, in their conventions, `home`.
pub(crate) fn follows(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    (forward, home): (&Explanation, &Conventions),
    options: &MarkOptions,
) -> Vec<Explanation> {
    let mistakes: Vec<_> = forward.mistakes.iter().map(|mistake| mistake.name).collect();
    let (slip, fitted) = (forward.slip.clone(), forward.fitted.clone());
    let h = Hypothesis { slip, fitted, ..Hypothesis::new(mistakes, *home) };
    // Of several mistakes some have no gradient, as what becomes of a radius.
    let parts = match h.mistakes.len() {
        2..=SEVERAL => h.parts(question),
        _ if h.slip.is_some() => vec![h],
        _ => vec![],
    };
    let mut found = parts.iter().map(|h| gradient_of(h, question, answers, base, options));
    found.find(|found| !found.is_empty()).unwrap_or_default()
}

impl Hypothesis {
    /// Each part of its mistakes with their numbers, itself first.
    fn parts(&self, question: &Question) -> Vec<Hypothesis> {
        let mut numbers = self.fitted.iter();
        let numbered = |name: &&'static str| (*name, number_of(question, name).and_then(|_| numbers.next()));
        let each: Vec<_> = self.mistakes.iter().map(numbered).collect();
        let part = |kept: u32| {
            let some = || each.iter().enumerate().filter(|(n, _)| kept >> n & 1 == 1).map(|(_, one)| one);
            let mistakes = some().map(|(name, _)| *name).collect();
            let fitted = some().filter_map(|(_, number)| number.copied()).collect();
            Hypothesis { mistakes, fitted, ..self.clone() }
        };
        let mut all: Vec<u32> = (1..1 << each.len()).collect();
        all.sort_by_key(|kept| std::cmp::Reverse(kept.count_ones()));
        all.into_iter().map(part).collect()
    }
}

/// The gradient of a forward function with what its own answers showed.
fn gradient_of(
    forward: &Hypothesis,
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Explanation> {
    // In conventions too that gradients alone show.
    let unseen = |(key, values): &(&'static str, &'static [&'static str])| {
        let own = question.component.conventions.contains(key);
        let others = values.iter().filter(move |_| own);
        others.filter_map(|value| forward.conventions.with(key, value).ok()).collect::<Vec<_>>()
    };
    let home = &forward.conventions;
    let others = CHOICES.iter().flat_map(unseen).filter(|c| c != home);
    let same = others.filter(|c| forward_is_the_same(question, c, home, options));
    let in_each = std::iter::once(*home).chain(same);
    let mut all = in_each.map(|conventions| Hypothesis { conventions, ..forward.clone() });
    let found = all.find(|h| was_done(h, question, answers, options));
    explanations(found.into_iter().collect(), question, answers, base, options)
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::super::slips::slip::{ArraySlip, Change, Slip};
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::check::Kind;
    use crate::convention::CS180;

    const OPTIONS: MarkOptions = MarkOptions { dtype: Dtype::F64, exp_ulp: 4.0 };

    #[test]
    fn a_gradient_follows_from_the_slip_of_its_forward_function() {
        let mirrored =
            ArraySlip { input: true, array: "d".into(), change: Change::Opposite(1, 2), forward: true };
        let exam = Exam::new("spherical_harmonics", Dtype::F64, None).unwrap();
        let question = exam.questions.iter().find(|q| q.kind == Kind::Vjp).expect("it has a gradient");
        let wrong = Hypothesis { slip: Some(Slip::Array(mirrored)), ..Hypothesis::new(vec![], CS180) };
        let right = Hypothesis::new(vec![], CS180);
        let of = |h: &Hypothesis| -> Answers {
            question.cases.iter().map(|case| Some(given(h.prediction(question, case).0))).collect()
        };
        assert_eq!(gradient_of(&wrong, question, &of(&wrong), &CS180, &OPTIONS).len(), 1);
        assert_eq!(gradient_of(&wrong, question, &of(&right), &CS180, &OPTIONS).len(), 0);
    }

    /// Of three mistakes each one, each two, and all; the numbers with those that have one.
    #[test]
    fn parts_keep_their_numbers() {
        let exam = Exam::new("volume_render", Dtype::F64, None).unwrap();
        let names = vec!["inclusive_transmittance", "delta_scaled", "given_up_early"];
        let all = Hypothesis { fitted: vec![2.5, 0.125], ..Hypothesis::new(names, CS180) };
        let parts = all.parts(&exam.questions[0]);
        assert_eq!((parts.len(), &parts[0]), (7, &all));
        let of = |names: &[&str]| parts.iter().find(|h| h.mistakes == names).map(|h| h.fitted.clone());
        assert_eq!(of(&["inclusive_transmittance", "given_up_early"]), Some(vec![0.125]));
        assert_eq!(of(&["delta_scaled"]), Some(vec![2.5]));
        assert_eq!(of(&["inclusive_transmittance"]), Some(vec![]));
    }
}
