//! Other formulas, found output by output: what explains some outputs stays, and the others show what else is wrong.

use std::collections::BTreeSet;

use ndarray::ArrayD;

use super::super::answer::Answer;
use super::evidence::{rejected_by, rejects_often};
use super::hypothesis::Hypothesis;
use super::lawful::{STEPPED, Search, TRIED, WORK};
use super::slips::slipping::attempt;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::convention::Conventions;
use crate::parallel;

/// The number of parts of which one output may show that they are wrong.
const AT_ONCE: usize = 4;

/// Numbers that all formulas may compute that are wrong in so many parts which reach one output.
const MANY: usize = 20_000_000;

/// Formulas that explain as many outputs as any other, of which each is followed to its end.
const ALIKE: usize = 3;

/// Where formulas are found output by output.
struct Step<'b> {
    /// The case that is tried first.
    failing: usize,
    c: &'b Conventions,
    /// The outputs that each part reaches, and what a formula costs.
    reached: &'b [BTreeSet<String>],
    cost: usize,
}

impl<'a> Search<'a> {
    /// The formula that explains all outputs, found as one after the other shows what is wrong with it: what explains some of them stays.
    pub(super) fn by_outputs(
        &self,
        failing: usize,
        c: &Conventions,
        tried: &mut usize,
    ) -> Option<Hypothesis> {
        let right = vec![0; self.laws.choices.len()];
        let step =
            Step { failing, c, reached: &self.reached(c), cost: self.question.cost(self.cases[failing].0) };
        let explained = self.explained(&right, failing, c, 0);
        self.finished(&step, right, explained, tried).map(|law| self.hypothesis(&law, c))
    }

    /// That formula from one on which explains some outputs. Where the next step shows several that explain as much, each of the first few is
    /// followed to its end: an output may leave open what another one tells.
    fn finished(
        &self,
        step: &Step,
        law: Vec<usize>,
        explained: Vec<&'a str>,
        tried: &mut usize,
    ) -> Option<Vec<usize>> {
        if explained.len() == self.outputs.len() {
            return Some(law);
        }
        let mut next = self.next(step, &law, &explained, tried).into_iter();
        next.find_map(|(explained, law)| self.finished(step, law, explained, tried))
    }

    /// The formulas that explain the most outputs and differ from this one in the fewest parts.
    fn next(
        &self,
        step: &Step,
        law: &[usize],
        explained: &[&'a str],
        tried: &mut usize,
    ) -> Vec<(Vec<&'a str>, Vec<usize>)> {
        let Step { reached, cost, .. } = *step;
        let left: Vec<&str> =
            self.outputs.difference(&explained.iter().copied().collect()).copied().collect();
        let reaches = |part: usize, name: &str| law[part] == 0 && reached[part].contains(name);
        let needed = |part: &usize| left.iter().any(|name| reaches(*part, name));
        // What is wrong with those that are left may need another part that puts right again what was explained.
        let touched: BTreeSet<&String> =
            (0..law.len()).filter(needed).flat_map(|part| &reached[part]).collect();
        let some = |part: usize| touched.iter().any(|name| reaches(part, name));
        // What shows in a single output is known already but for what is wrong in more parts at once.
        let most = if self.outputs.len() == 1 { 0 } else { TRIED.len() };
        let mut affordable = WORK / STEPPED / cost;
        for parts in 1..=most {
            let all = self.laws.differing(parts, some, affordable);
            affordable -= all.len();
            let found = self.better(step, law, all, explained, tried);
            if !found.is_empty() {
                return found;
            }
        }
        // The output that the fewest parts reach may show that many are wrong.
        let first = left.iter().min_by_key(|name| reached.iter().filter(|of| of.contains(**name)).count());
        let free = |part: usize| first.is_some_and(|name| reaches(part, name));
        let mut many = (TRIED.len()..=AT_ONCE).map(|parts| {
            let all = self.laws.differing(parts, free, MANY / cost);
            self.better(step, law, all, explained, tried)
        });
        many.find(|found| !found.is_empty()).unwrap_or_default()
    }

    /// The formulas that differ in some of these parts, too, and explain more outputs: the first of those that explain the most, and which.
    fn better(
        &self,
        step: &Step,
        law: &[usize],
        others: Vec<Vec<usize>>,
        explained: &[&str],
        tried: &mut usize,
    ) -> Vec<(Vec<&'a str>, Vec<usize>)> {
        let joined = |other: Vec<usize>| law.iter().zip(other).map(|(a, b)| a + b).collect();
        let all: Vec<Vec<usize>> = others.into_iter().map(joined).collect();
        *tried += all.len();
        let known = explained.len();
        let left: BTreeSet<&str> =
            self.outputs.iter().copied().filter(|name| !explained.contains(name)).collect();
        let probes = [self.telling(law, (step.failing, step.c), &left), step.failing];
        let those = parallel::map(all.len(), |n| {
            let near = probes.iter().all(|probe| self.near(&all[n], *probe, step.c) > known);
            if near { self.explained(&all[n], step.failing, step.c, known) } else { vec![] }
        });
        let most = those.iter().map(Vec::len).max().unwrap_or(0).max(known + 1);
        let best = those.into_iter().zip(all).filter(|(those, _)| those.len() == most);
        best.take(ALIKE).collect()
    }

    /// The outputs that the choices of each part change, in some case.
    fn reached(&self, c: &Conventions) -> Vec<BTreeSet<String>> {
        let right = vec![0; self.laws.choices.len()];
        let of = |case: &Case, law: &[usize]| attempt(|| (self.laws.of)(&case.inputs, c, law));
        let cases = || self.cases.iter().filter(|(case, _)| case.finite());
        let expected: Vec<_> = cases().map(|(case, _)| of(case, &right)).collect();
        let changed = |part: usize, choice: usize| -> BTreeSet<String> {
            let law: Vec<usize> = (0..right.len()).map(|n| if n == part { choice } else { 0 }).collect();
            let with = |((case, _), expected): (&(&Case, &Answer), &Option<Arrays>)| {
                let (Some(law), Some(expected)) = (of(case, &law), expected) else { return vec![] };
                let other = |(name, a): &(String, ArrayD<f64>)| {
                    let same = |(a, b): (&f64, &f64)| a == b || a.is_nan() && b.is_nan();
                    expected.get(name).is_none_or(|e| a.shape() != e.shape() || !a.iter().zip(e).all(same))
                };
                law.into_iter().filter(other).map(|(name, _)| name).collect::<Vec<_>>()
            };
            cases().zip(&expected).flat_map(with).collect()
        };
        let each = |part: usize| (1..self.laws.choices[part]).flat_map(move |choice| changed(part, choice));
        parallel::map(right.len(), |part| each(part).collect())
    }

    /// The outputs that a formula explains in all cases, that which it is tried on first among them; none where these are no more than `known`.
    fn explained(&self, law: &[usize], failing: usize, c: &Conventions, known: usize) -> Vec<&'a str> {
        let (cases, h) = (&self.cases, self.hypothesis(law, c));
        let mut outputs: Vec<&str> = self.outputs.iter().copied().collect();
        let first = [Some(failing), rejects_often(cases).filter(|n| *n != failing)];
        let rest = (0..cases.len()).filter(|n| !first.contains(&Some(*n)));
        for n in first.into_iter().flatten().chain(rest) {
            let (case, answer) = cases[n];
            let kept = attempt(|| {
                let mut kept = outputs.clone();
                h.keep_explained(self.question, case, answer, self.options, &mut kept);
                kept
            });
            outputs = kept.unwrap_or_default();
            if outputs.len() <= known {
                rejected_by(n);
                return vec![];
            }
        }
        outputs
    }
}
