//! The conventions in which slips of a formula are looked for, with every operation of it there.

use super::super::super::answer::{Answer, Answers, reshaped};
use super::super::super::assignment::small_cases;
use super::super::super::exam::Question;
use super::super::super::mark::MarkOptions;
use super::super::super::partial::partial;
use super::super::hypothesis::Hypothesis;
use super::super::telling::{TELLING, telling};
use super::places::{Place, count, places, sites};
use super::slipping::conventions;
use crate::contract::case::Case;
use crate::convention::{CHOICES, Conventions};

/// Operations that looking for them may cost: some are only done on some inputs.
pub(super) const LOOKS: usize = 1_000_000;

/// Operations that all hypotheses together may cost on the case that they are tried on first.
pub(super) const WORK: usize = 20_000_000;

/// Conventions that are tried, at most.
const NEARBY: usize = 24;

/// The part of all work that is done in the n-th of the conventions nearby: the likelier, the more.
fn share(n: usize) -> f64 {
    let all: f64 = (1..=NEARBY).map(|k| 1.0 / k as f64).sum();
    1.0 / ((n + 1) as f64 * all)
}

/// Conventions in which slips are tried.
pub(super) struct Tried {
    pub(super) conventions: Conventions,
    /// Their part of the work.
    pub(super) share: f64,
    /// Different numbers that are wrong in them.
    pub(super) shown: usize,
    /// The smallest case that the right formula doesn't explain, which most slips don't either.
    pub(super) failing: usize,
    /// What the formula costs there, in operations.
    pub(super) cost: usize,
    pub(super) places: Vec<Place>,
}

impl Tried {
    /// In each of these, where anything tells.
    pub(super) fn in_each(
        question: &Question,
        cases: &[(&Case, &Answer)],
        nearby: &[Conventions],
        options: &MarkOptions,
    ) -> Vec<Tried> {
        let of = |(n, c): (usize, &Conventions)| Tried::new(question, cases, (*c, share(n)), options);
        nearby.iter().enumerate().filter_map(of).collect()
    }

    /// `None` where too little is wrong.
    fn new(
        question: &Question,
        cases: &[(&Case, &Answer)],
        (conventions, share): (Conventions, f64),
        options: &MarkOptions,
    ) -> Option<Tried> {
        let right = Hypothesis::new(vec![], conventions);
        let shown = telling(question, cases, &conventions, options);
        let wrong = |(case, answer): &(&Case, &Answer)| !right.explains(question, case, answer, options);
        let failing = cases.iter().position(wrong).filter(|_| shown >= TELLING)?;
        let cost = count(&sites(question, &conventions, 0, cases[failing].0));
        let places = places(question, cases, &conventions, (share * LOOKS as f64) as usize);
        Some(Tried { conventions, share, shown, failing, cost, places })
    }

    /// The first places, as many as may be tried in so many ways for this part of the work.
    pub(super) fn affordable(&self, ways: usize, share: f64) -> &[Place] {
        let most = share * WORK as f64 / (ways * self.cost) as f64;
        &self.places[..self.places.len().min(most as usize)]
    }
}

/// The likely conventions, and those that differ from them in one, where the answers have their shapes: a slip hides some of them.
pub(super) fn nearby(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Conventions> {
    let own = |c: &Conventions| partial(question.component, c);
    let mut all = conventions(question, answers, base, options);
    let cases = small_cases(question, answers);
    let fits = |c: &Conventions| {
        cases.first().is_some_and(|(case, answer)| {
            let right = Hypothesis::new(vec![], *c).prediction(question, case).0;
            right.iter().all(|(name, p)| {
                answer.get(name).is_none_or(|given| reshaped(&given.values, p.shape()).is_some())
            })
        })
    };
    for c in all.clone() {
        for (key, values) in CHOICES.iter().filter(|(key, _)| question.component.conventions.contains(key)) {
            for other in values.iter().filter_map(|value| c.with(key, value).ok()) {
                let new = question.admits(&other) && !all.iter().any(|had| own(had) == own(&other));
                if all.len() < NEARBY && new && fits(&other) {
                    all.push(other);
                }
            }
        }
    }
    all
}
