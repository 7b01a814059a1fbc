//! Gradients that follow from what the forward answers showed: their mistakes, each part of them, or their slip.

use std::collections::BTreeSet;

use super::super::answer::{Answer, Answers};
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::evidence::{Explanation, forward_is_the_same, only, usable};
use super::hypothesis::Hypothesis;
use super::numbered::number_of;
use super::slips::slipping::{attempt, explanations, was_done};
use crate::contract::case::Case;
use crate::convention::{CHOICES, Conventions};

/// Mistakes each part of which is tried, at most.
const SEVERAL: usize = 4;

/// One of so many cases may be unexplained in the forward answers, and as many in the gradient that follows from them.
const MOST: usize = 4;

/// What explains a gradient as the mistakes, some of them, or the slip, of the forward answers, in their conventions, `home`; but for the
/// cases that these don't explain forward.
pub(crate) fn follows(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    (forward, home): (&Explanation, &Conventions),
    options: &MarkOptions,
) -> Vec<Explanation> {
    // One mistake alone is tried as any other is.
    let alone = forward.mistakes.len() == 1 && forward.slip.is_none() && forward.apart.is_empty();
    if alone && forward.whole() {
        return vec![];
    }
    let known = |case: &Case| !forward.unexplained_cases.contains(&case.id);
    let (some, of_some) = only(question, answers, known);
    let mut found = parts(forward, home, question).into_iter();
    let found = found.find_map(|h| gradient_of(&h, &some, &of_some, options));
    explained(found, question, answers, base, options)
}

/// The same but for edge cases, and a few others: next to kinks and poles no difference knows a gradient, and what automatic differentiation
/// makes of 0 times infinity isn't the function's.
pub(crate) fn follows_usually(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    (forward, home): (&Explanation, &Conventions),
    options: &MarkOptions,
) -> Vec<Explanation> {
    let usual = |case: &Case| case.edge.is_none() && !forward.unexplained_cases.contains(&case.id);
    let most = |h: &Hypothesis| {
        let off = unexplained(h, question, answers, options);
        let asked = usable(h, question, answers).into_iter().filter(|(case, _)| usual(case));
        let (asked, odd): (Vec<_>, Vec<_>) = asked.partition(|(case, _)| !off.contains(&case.id));
        let (rest, of_rest) = only(question, answers, |case| usual(case) && !off.contains(&case.id));
        MOST * odd.len() <= asked.len() + odd.len() && was_done(h, &rest, &of_rest, options)
    };
    let found = parts(forward, home, question).into_iter().find(most);
    explained(found, question, answers, base, options)
}

/// The same of a program that hands out zeros for the gradients of some inputs, which it has detached: these are told as unexplained.
pub(crate) fn follows_but_for_zeros(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    (forward, home): (&Explanation, &Conventions),
    options: &MarkOptions,
) -> Vec<Explanation> {
    let names: BTreeSet<&String> = answers.iter().flatten().flat_map(|answer| answer.keys()).collect();
    let zero = |name: &&&String| {
        let all = || answers.iter().flatten().filter_map(|answer| answer.get(**name));
        all().any(|given| !given.values.is_empty())
            && all().all(|given| given.values.iter().all(|g| *g == 0.0))
    };
    let detached: Vec<String> = names.iter().filter(zero).map(|name| name.to_string()).collect();
    if detached.is_empty() || detached.len() == names.len() {
        return vec![];
    }
    let left = |answer: &Answer| -> Answer {
        let kept = answer.iter().filter(|(name, _)| !detached.contains(name));
        kept.map(|(name, given)| (name.clone(), given.clone())).collect()
    };
    let left: Answers = answers.iter().map(|answer| answer.as_ref().map(left)).collect();
    let mut found = follows_usually(question, &left, base, (forward, home), options);
    found.iter_mut().for_each(|e| e.unexplained.extend(detached.iter().cloned()));
    found
}

/// The cases that a hypothesis doesn't explain.
fn unexplained(h: &Hypothesis, question: &Question, answers: &Answers, options: &MarkOptions) -> Vec<String> {
    let fits = |case, answer| attempt(|| h.explains(question, case, answer, options)).unwrap_or(false);
    let off = usable(h, question, answers).into_iter().filter(|(case, answer)| !fits(case, answer));
    off.map(|(case, _)| case.id.clone()).collect()
}

/// What the forward answers showed, and of several mistakes each part: some have no gradient, as what becomes of a radius.
fn parts(forward: &Explanation, home: &Conventions, question: &Question) -> Vec<Hypothesis> {
    if MOST * forward.unexplained_cases.len() > question.cases.len() {
        return vec![];
    }
    let mistakes: Vec<_> = forward.mistakes.iter().map(|mistake| mistake.name).collect();
    let (slip, fitted, apart) = (forward.slip.clone(), forward.fitted.clone(), forward.apart.clone());
    let h = Hypothesis { slip, fitted, apart, ..Hypothesis::new(mistakes, *home) };
    if (2..=SEVERAL).contains(&h.mistakes.len()) { h.parts(question) } else { vec![h] }
}

/// What is said of it, with the cases that it doesn't explain.
fn explained(
    found: Option<Hypothesis>,
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Explanation> {
    let Some(found) = found else { return vec![] };
    let off = unexplained(&found, question, answers, options);
    let (question, answers) = only(question, answers, |case| !off.contains(&case.id));
    let mut all = explanations(vec![found], &question, &answers, base, options);
    all.iter_mut().for_each(|e| e.unexplained_cases = off.clone());
    all
}

impl Hypothesis {
    /// Each part of its mistakes with their numbers, itself first.
    fn parts(&self, question: &Question) -> Vec<Hypothesis> {
        let mut numbers = self.fitted.iter();
        let numbered = |name: &&'static str| (*name, number_of(question, name).and_then(|_| numbers.next()));
        let each: Vec<_> = self.mistakes.iter().map(numbered).collect();
        let part = |kept: u32| {
            let whole = kept.count_ones() as usize == each.len();
            let apart = if whole { self.apart.clone() } else { vec![] };
            let some = || each.iter().enumerate().filter(|(n, _)| kept >> n & 1 == 1).map(|(_, one)| one);
            let mistakes = some().map(|(name, _)| *name).collect();
            let fitted = some().filter_map(|(_, number)| number.copied()).collect();
            Hypothesis { mistakes, fitted, apart, ..self.clone() }
        };
        let mut all: Vec<u32> = (1..1 << each.len()).collect();
        all.sort_by_key(|kept| std::cmp::Reverse(kept.count_ones()));
        all.into_iter().map(part).collect()
    }
}

/// The forward function with what its own answers showed, where a gradient is that function's.
fn gradient_of(
    forward: &Hypothesis,
    question: &Question,
    answers: &Answers,
    options: &MarkOptions,
) -> Option<Hypothesis> {
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
    all.find(|h| was_done(h, question, answers, options))
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::super::hypothesis::Apart;
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
        assert_eq!(gradient_of(&wrong, question, &of(&wrong), &OPTIONS), Some(wrong.clone()));
        assert_eq!(gradient_of(&wrong, question, &of(&right), &OPTIONS), None);
    }

    /// The gradients of a wrong forward function, and what is said of it.
    fn wrong_pair(
        component: &str,
        mistakes: [&'static str; 2],
        apart: Vec<Apart>,
    ) -> (Question, Answers, Explanation) {
        let mut exam = Exam::new(component, Dtype::F64, None).unwrap();
        let n = exam.questions.iter().position(|q| q.kind == Kind::Vjp && q.component.name == component);
        let question = exam.questions.swap_remove(n.expect("it has a gradient"));
        let wrong = Hypothesis { apart: apart.clone(), ..Hypothesis::new(mistakes.to_vec(), CS180) };
        let answers = question.cases.iter().map(|case| Some(given(wrong.prediction(&question, case).0)));
        let row = |name: &&str| question.component.mistakes.iter().find(|m| m.name == *name);
        let forward = Explanation {
            mistakes: mistakes.iter().filter_map(row).collect(),
            apart,
            ..Explanation::default()
        };
        let answers = answers.collect();
        (question, answers, forward)
    }

    /// Weights that are divided by their sum after the colors were made.
    #[test]
    fn a_gradient_follows_where_an_output_shows_some_of_the_mistakes() {
        let apart = vec![("colors".to_string(), vec!["inclusive_transmittance"])];
        let pair = ["weights_normalized", "inclusive_transmittance"];
        let (question, answers, forward) = wrong_pair("volume_render", pair, apart);
        let found = follows(&question, &answers, &CS180, (&forward, &CS180), &OPTIONS);
        assert!(found.len() == 1 && found[0].whole() && found[0].mistakes.len() == 2, "{found:?}");
        let together = Explanation { apart: vec![], ..forward };
        assert_eq!(follows(&question, &answers, &CS180, (&together, &CS180), &OPTIONS), vec![]);
    }

    #[test]
    fn edge_cases_may_be_off_and_are_told() {
        let pair = ["near_ignored", "eps_in_direction"];
        let (mut question, mut answers, forward) = wrong_pair("ray_aabb", pair, vec![]);
        question.cases.iter_mut().filter(|case| case.id == "inside").for_each(|case| case.edge = Some("so"));
        for (case, answer) in question.cases.iter().zip(&mut answers) {
            let all = answer.iter_mut().flat_map(|answer| answer.values_mut());
            all.filter(|_| case.edge.is_some()).for_each(|given| given.values += 1.0);
        }
        assert_eq!(follows(&question, &answers, &CS180, (&forward, &CS180), &OPTIONS), vec![]);
        let found = follows_usually(&question, &answers, &CS180, (&forward, &CS180), &OPTIONS);
        let edges = |id: &String| question.cases.iter().any(|case| case.id == *id && case.edge.is_some());
        let off = &found[0].unexplained_cases;
        assert!(found[0].mistakes.len() == 2 && !off.is_empty() && off.iter().all(edges), "{off:?}");
        // What is off elsewhere doesn't follow.
        answers
            .iter_mut()
            .flatten()
            .flat_map(|answer| answer.values_mut())
            .for_each(|given| given.values += 1.0);
        assert_eq!(follows_usually(&question, &answers, &CS180, (&forward, &CS180), &OPTIONS), vec![]);
    }

    /// Steps that were detached have no gradient: all others follow, and these are told.
    #[test]
    fn a_gradient_follows_but_for_inputs_that_were_detached() {
        let pair = ["inclusive_transmittance", "weights_normalized"];
        let (question, mut answers, forward) = wrong_pair("volume_render", pair, vec![]);
        let zeros = |answers: &Answers| {
            let beside = (&forward, &CS180);
            follows_but_for_zeros(&question, answers, &CS180, beside, &OPTIONS)
        };
        assert_eq!(zeros(&answers), vec![]);
        let steps = answers.iter_mut().flatten().filter_map(|answer| answer.get_mut("grad_deltas"));
        steps.for_each(|given| given.values.fill(0.0));
        let found = zeros(&answers);
        assert_eq!((found[0].mistakes.len(), &found[0].unexplained), (2, &vec!["grad_deltas".to_string()]));
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
