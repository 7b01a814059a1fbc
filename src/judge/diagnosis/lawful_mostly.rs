//! Other formulas of most cases: something more is wrong in the others, which are told. A program that takes another T and adds 1e-8 to its
//! steps is off by that where nothing else is.

use super::super::answer::Answer;
use super::super::assignment::small_cases;
use super::evidence::{Explanation, only};
use super::hypothesis::Hypothesis;
use super::lawful::{Search, TRIED, WORK};
use super::slips::proved::proved;
use super::slips::slipping::attempt;
use super::telling::by_chance;
use crate::contract::case::Case;
use crate::convention::Conventions;
use crate::parallel;

/// The share of the cases that a formula must explain, of those that the right one doesn't.
const MOST: f64 = 0.75;

/// Of these it must explain so many.
const SHOWN: usize = 3;

/// Formulas whose proof is asked, those that explain the most first.
const ASKED: usize = 4;

/// A formula in so many wrong parts and conventions, and which cases it explains.
struct Tried<'b> {
    law: Vec<usize>,
    c: &'b Conventions,
    explained: Vec<bool>,
}

impl<'a> Search<'a> {
    /// The formula that explains most cases, and what is left of them. Those that the right one explains are among them.
    pub(super) fn most_cases(&self) -> Option<Explanation> {
        let (mut left, mut tried, mut found) = (WORK, 0, vec![]);
        for (parts, conventions) in (1..=2.min(self.laws.choices.len())).zip(TRIED) {
            let nearby = &self.nearby[..conventions.min(self.nearby.len())];
            for (n, (case, c)) in nearby.iter().enumerate() {
                let probes = self.probes(*case);
                let cost: usize = probes.iter().map(|probe| self.question.cost(self.cases[*probe].0)).sum();
                let all = self.laws.differing(parts, |_| true, left / (nearby.len() - n) / cost);
                left -= all.len() * cost;
                tried += all.len();
                found.extend(self.explaining_most(*case, c, all));
            }
            if !found.is_empty() {
                break;
            }
        }
        found.sort_by_key(|t: &Tried| t.explained.iter().filter(|explained| !**explained).count());
        found.iter().take(ASKED).find_map(|t| self.but_for_others(t, tried))
    }

    /// Those of these formulas that explain most cases.
    fn explaining_most<'b>(&self, case: usize, c: &'b Conventions, all: Vec<Vec<usize>>) -> Vec<Tried<'b>> {
        let formula = Hypothesis::new(vec![], *c);
        let right: Vec<bool> = (0..self.cases.len()).map(|n| self.explains(&formula, n)).collect();
        let failing = right.iter().filter(|right| !**right).count();
        if failing < SHOWN {
            return vec![];
        }
        let probes = self.probes(case);
        // Those that the right formula explains must be explained, and most of the others.
        let missed = failing - ((MOST * failing as f64).ceil() as usize).max(SHOWN);
        let enough = |h: &Hypothesis| {
            let mut left = missed;
            let all = right.iter().enumerate().map(|(n, right)| {
                let explained = self.explains(h, n);
                left = if explained { left } else { left.checked_sub(1).filter(|_| !right)? };
                Some(explained)
            });
            all.collect::<Option<Vec<bool>>>()
        };
        let tried = parallel::map(all.len(), |n| {
            let near = |probe: &usize| self.near(&all[n], *probe, c) == self.cases[*probe].1.len();
            probes.iter().any(near).then(|| enough(&self.hypothesis(&all[n], c))).flatten()
        });
        let found = tried.into_iter().zip(all);
        found.filter_map(|(explained, law)| Some(Tried { law, c, explained: explained? })).collect()
    }

    /// Two cases, as one may be of those in which more is wrong: the first that the right formula doesn't explain, and one halfway to the last.
    fn probes(&self, failing: usize) -> [usize; 2] {
        [failing, (failing + self.cases.len()) / 2]
    }

    fn explains(&self, h: &Hypothesis, case: usize) -> bool {
        let (case, answer) = self.cases[case];
        attempt(|| h.explains(self.question, case, answer, self.options)).unwrap_or(false)
    }

    /// The same where it is proved by the cases that it explains.
    fn but_for_others(&self, t: &Tried, tried: usize) -> Option<Explanation> {
        let of = |wanted: bool| {
            let cases =
                self.cases.iter().zip(&t.explained).filter(move |(_, explained)| **explained == wanted);
            cases.map(|((case, _), _)| case.id.clone()).collect::<Vec<_>>()
        };
        let explained = of(true);
        let (question, answers) = only(self.question, self.answers, |case| explained.contains(&case.id));
        let right = Hypothesis::new(vec![], *t.c);
        let wrong =
            |(case, answer): &(&Case, &Answer)| !right.explains(&question, case, answer, self.options);
        let failing = small_cases(&question, &answers).iter().position(wrong)?;
        let nearby: Vec<Conventions> = self.nearby.iter().map(|(_, c)| *c).collect();
        let alone = vec![(failing, self.hypothesis(&t.law, t.c))];
        let found = proved(alone, by_chance(tried), &nearby, &question, &answers, self.base, self.options);
        found.into_iter().next().map(|e| Explanation { unexplained_cases: of(false), ..e })
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::{Answers, given};
    use super::super::super::exam::Exam;
    use super::super::super::mark::MarkOptions;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::convention::CS180;

    /// The last of another formula's cases are off by something else.
    fn found(others: usize) -> Option<Explanation> {
        let exam = Exam::new("volume_render", Dtype::F32, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 });
        let laws = question.component.special.laws_of(true).unwrap();
        let law: Vec<usize> = (0..laws.choices.len()).map(|part| if part == 1 { 5 } else { 0 }).collect();
        let usual = question.cases.len() - others;
        let answer = |(n, case): (usize, &Case)| {
            let off = if n < usual { 1.0 } else { 1.01 };
            let all = (laws.of)(&case.inputs, &CS180, &law).into_iter();
            Some(given(all.map(|(name, a)| (name, a.mapv(|x| Dtype::F32.round(off * x)))).collect()))
        };
        let answers: Answers = question.cases.iter().enumerate().map(answer).collect();
        Search::new(question, &answers, &CS180, &options)?.most_cases()
    }

    #[test]
    fn other_cases_are_told() {
        let some = found(3).expect("most cases are explained");
        assert!(some.slip.is_some_and(|slip| slip.says().contains("sigma_i delta_i")));
        assert_eq!(some.unexplained_cases.len(), 3);
        assert!(found(20).is_none(), "these are too many");
    }
}
