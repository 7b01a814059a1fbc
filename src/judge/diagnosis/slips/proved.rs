//! Proof of what no catalogue lists: so many formulas are tried that one of them may explain a few numbers by chance.

use super::super::super::answer::Answers;
use super::super::super::assignment::small_cases;
use super::super::super::exam::Question;
use super::super::super::mark::MarkOptions;
use super::super::super::partial::partial;
use super::super::evidence::Explanation;
use super::super::hypothesis::Hypothesis;
use super::super::telling::{SHOWN_PART, SURE, by_chance, evidence, evidence_of_places};
use super::slip::{LawSlip, Slip};
use super::slipping::{attempt, explanations, was_done};
use crate::convention::Conventions;
use crate::parallel;

/// What is left of several operations without one of them.
fn one_less(h: &Hypothesis) -> Vec<Hypothesis> {
    let Some(Slip::Formula(slip)) = &h.slip else { return vec![] };
    let less = slip.without_each().into_iter();
    less.map(|slip| Hypothesis { slip: Some(Slip::Formula(slip)), ..h.clone() }).collect()
}

/// What is left of a formula that differs in several parts without one of them, beside that part and with the bits that it has by chance.
fn one_part_less(h: &Hypothesis, question: &Question) -> Vec<(usize, Hypothesis, f64)> {
    let Some(Slip::Law(law)) = &h.slip else { return vec![] };
    let Some(laws) = question.component.special.laws_of(law.forward) else { return vec![] };
    let without = |(part, less): (usize, LawSlip)| {
        let chance = by_chance(laws.choices[part]);
        (part, Hypothesis { slip: Some(Slip::Law(less)), ..h.clone() }, chance)
    };
    law.without_each().into_iter().map(without).collect()
}

/// Those that explain every answer, with more evidence than one of as many has by `chance`, in bits, against the right formula in any of the
/// conventions. Each stands beside the case that it is tried on first.
pub(crate) fn proved(
    hypotheses: Vec<(usize, Hypothesis)>,
    chance: f64,
    nearby: &[Conventions],
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Explanation> {
    let cases = small_cases(question, answers);
    let needed = chance + SURE;
    let fits = parallel::map(hypotheses.len(), |n| {
        let (failing, h) = &hypotheses[n];
        let (case, answer) = cases[*failing];
        let first = || h.explains(question, case, answer, options);
        attempt(first).unwrap_or(false) && was_done(h, question, answers, options)
    });
    let found = hypotheses.into_iter().zip(fits).filter(|(_, fits)| *fits).map(|((_, h), _)| h);
    // A formula may end where others go on: what it says there is 0.
    let bits = |h: &Hypothesis, other: &Hypothesis| match h.slip {
        Some(Slip::Law(_)) => evidence_of_places(h, other, question, &cases, options),
        _ => evidence(h, other, question, &cases, options),
    };
    let better = |h: &Hypothesis, other: &Hypothesis, needed: f64| {
        attempt(|| bits(h, other)).is_some_and(|bits| bits >= needed)
    };
    // Nor is any of several operations there for what chance gives.
    let enough = |h: &Hypothesis| {
        nearby.iter().all(|c| better(h, &Hypothesis::new(vec![], *c), needed))
            && one_less(h).iter().all(|other| better(h, other, needed))
    };
    // Of several parts of a formula few numbers may show one, which is told: all others are as sure as the whole.
    let sure = |mut h: Hypothesis| {
        let parts = one_part_less(&h, question);
        let hardly: Vec<usize> = parts
            .iter()
            .filter(|(_, other, chance)| !better(&h, other, chance + SHOWN_PART))
            .map(|(part, ..)| *part)
            .collect();
        if let (Some(Slip::Law(law)), [part]) = (&mut h.slip, &hardly[..]) {
            law.hardly_shown(*part, question.component);
        }
        (hardly.is_empty() || hardly.len() == 1 && parts.len() > 2).then_some(h)
    };
    let mut found: Vec<_> = found.filter(enough).filter_map(sure).collect();
    // A slip has different ways on from it.
    let says =
        |h: &Hypothesis| (h.slip.as_ref().map(Slip::says), partial(question.component, &h.conventions));
    let all: Vec<_> = found.iter().map(says).collect();
    let mut n = 0..;
    found.retain(|_| n.next().is_some_and(|n| !all[..n].contains(&all[n])));
    explanations(found, question, answers, base, options)
}
