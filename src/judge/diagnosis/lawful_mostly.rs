//! Other formulas of most cases: something more is wrong in the others, which are told. A program that takes another T and adds 1e-8 to its
//! steps is off by that where nothing else is.

use super::super::answer::Answer;
use super::evidence::{Explanation, only};
use super::hypothesis::Hypothesis;
use super::lawful::{Search, TRIED, WORK};
use super::slips::slipping::attempt;
use crate::contract::case::Case;
use crate::convention::Conventions;
use crate::parallel;

/// The share of the cases that a formula must explain, and of those that the right one doesn't.
const MOST: f64 = 0.75;

/// Of these it must explain so many.
const SHOWN: usize = 3;

/// A formula in so many wrong parts and conventions, and which cases it explains.
struct Tried<'b> {
    law: Vec<usize>,
    c: &'b Conventions,
    explained: Vec<bool>,
}

impl<'a> Search<'a> {
    /// The formula that explains most cases, and what is left of them.
    pub(super) fn most_cases(&self) -> Option<Explanation> {
        let (mut left, mut tried, mut found) = (WORK, 0, vec![]);
        for (parts, conventions) in (1..=2.min(self.laws.choices.len())).zip(TRIED) {
            let nearby = &self.nearby[..conventions.min(self.nearby.len())];
            for (n, (case, c)) in nearby.iter().enumerate() {
                let cost = 2 * self.question.cost(self.cases[*case].0);
                let all = self.laws.differing(parts, |_| true, left / (nearby.len() - n) / cost);
                left -= all.len() * cost;
                tried += all.len();
                found.extend(self.explaining_most(*case, c, all));
            }
            if !found.is_empty() {
                break;
            }
        }
        // The first of those that explain the most.
        let count = |t: &Tried| t.explained.iter().filter(|explained| **explained).count();
        found.into_iter().rev().max_by_key(count).and_then(|best| self.but_for_others(best, tried))
    }

    /// Those of these formulas that explain most cases.
    fn explaining_most<'b>(&self, case: usize, c: &'b Conventions, all: Vec<Vec<usize>>) -> Vec<Tried<'b>> {
        let right = self.explained_cases(&Hypothesis::new(vec![], *c));
        let failing: Vec<usize> = (case..right.len()).filter(|n| !right[*n]).collect();
        // One of two cases may be one of those in which more is wrong.
        let probes = [failing[0], failing[failing.len() / 2]];
        let enough = |explained: &[bool]| {
            let of = |cases: &[usize]| cases.iter().filter(|n| explained[**n]).count();
            let every: Vec<usize> = (0..explained.len()).collect();
            of(&failing) >= SHOWN
                && of(&failing) as f64 >= MOST * failing.len() as f64
                && of(&every) as f64 >= MOST * every.len() as f64
        };
        let tried = parallel::map(all.len(), |n| {
            let near = |probe: &usize| self.near(&all[n], *probe, c) == self.cases[*probe].1.len();
            let explained =
                probes.iter().any(near).then(|| self.explained_cases(&self.hypothesis(&all[n], c)));
            explained.filter(|explained| enough(explained))
        });
        let found = tried.into_iter().zip(all);
        found.filter_map(|(explained, law)| Some(Tried { law, c, explained: explained? })).collect()
    }

    fn explained_cases(&self, h: &Hypothesis) -> Vec<bool> {
        let one = |(case, answer): &(&Case, &Answer)| {
            attempt(|| h.explains(self.question, case, answer, self.options)).unwrap_or(false)
        };
        self.cases.iter().map(one).collect()
    }

    /// The same where it is proved by the cases that it explains.
    fn but_for_others(&self, best: Tried, tried: usize) -> Option<Explanation> {
        let of = |wanted: bool| {
            let cases =
                self.cases.iter().zip(&best.explained).filter(move |(_, explained)| **explained == wanted);
            cases.map(|((case, _), _)| case.id.clone()).collect::<Vec<_>>()
        };
        let explained = of(true);
        let (question, answers) = only(self.question, self.answers, |case| explained.contains(&case.id));
        let search = Search::new(&question, &answers, self.base, self.options)?;
        let case = search.nearby.iter().find(|(_, c)| c == best.c)?.0;
        let found = search.proved(vec![(case, self.hypothesis(&best.law, best.c))], tried);
        found.into_iter().next().map(|e| Explanation { unexplained_cases: of(false), ..e })
    }
}
