//! Climbing among formulas: one part after the other that brings the answers nearer. A march with four or five deviations is one of billions
//! of formulas, but the way to it leads through few of them.

use super::super::answer::Answer;
use super::evidence::Explanation;
use super::lawful::Search;
use super::nearness::distance;
use super::slips::slipping::attempt;
use crate::contract::case::Case;
use crate::convention::Conventions;
use crate::parallel;

/// Parts at once, and ways that are followed side by side.
const STEPS: usize = 5;
const WAYS: usize = 8;

/// Conventions from which ways begin.
const STARTS: usize = 6;

/// Cases by which ways are measured.
const CASES: usize = 8;

/// Elements that a step may compute.
const WORK: usize = 8_000_000;

/// Bits by which a part must bring the answers nearer, on the average.
const NEARER: f64 = 0.02;

/// What is so near, in bits that are lost on the average, is held against all bounds.
const CLOSE: f64 = 1.0;

/// A formula in conventions, and how many bits of the answers it loses.
struct Way<'b> {
    law: Vec<usize>,
    c: &'b Conventions,
    off: f64,
}

impl Search<'_> {
    /// The formula that explains every answer at the end of a way on which each part brought them nearer.
    pub(super) fn climbed(&self) -> Vec<Explanation> {
        let mut cases: Vec<_> = self.cases.iter().copied().filter(|(case, _)| case.finite()).collect();
        cases.truncate(CASES);
        let cost: usize = cases.iter().map(|(case, _)| self.question.cost(case)).sum();
        let right = vec![0; self.laws.choices.len()];
        let starts = self.nearby.iter().take(STARTS).map(|(_, c)| (right.clone(), c)).collect();
        let (mut ways, mut tried) = (self.measured(starts, &cases), 0);
        for _ in 0..STEPS {
            // Each way has its share.
            let most = WORK / cost.max(1) / ways.len().max(1);
            let next = ways.iter().flat_map(|way| self.one_more(way).take(most).map(|more| (more, way.off)));
            let (all, before): (Vec<_>, Vec<_>) = next.unzip();
            tried += all.len();
            let next = self.measured(all, &cases).into_iter().zip(before);
            let nearer = next.filter(|(way, before)| way.off < before - NEARER);
            ways = best(nearer.map(|(way, _)| way).collect());
            let near = ways.iter().filter(|way| way.off < CLOSE);
            let near = near.map(|way| (self.failing(way.c), self.hypothesis(&way.law, way.c)));
            let found = self.proved(near.collect(), tried);
            if !found.is_empty() {
                return found;
            }
        }
        vec![]
    }

    /// The same with one more wrong part; the parts with the fewest choices first.
    fn one_more<'b>(&self, way: &Way<'b>) -> impl Iterator<Item = (Vec<usize>, &'b Conventions)> + use<'b> {
        let (law, c, choices) = (way.law.clone(), way.c, self.laws.choices);
        let mut right: Vec<usize> = (0..law.len()).filter(|part| law[*part] == 0).collect();
        right.sort_by_key(|part| choices[*part]);
        right.into_iter().flat_map(move |part| {
            let law = law.clone();
            (1..choices[part]).map(move |choice| {
                let mut more = law.clone();
                more[part] = choice;
                (more, c)
            })
        })
    }

    fn measured<'b>(
        &self,
        all: Vec<(Vec<usize>, &'b Conventions)>,
        cases: &[(&Case, &Answer)],
    ) -> Vec<Way<'b>> {
        let off = parallel::map(all.len(), |n| {
            let h = self.hypothesis(&all[n].0, all[n].1);
            attempt(|| distance(&h, self.question, cases, self.options.dtype)).unwrap_or(f64::INFINITY)
        });
        all.into_iter().zip(off).map(|((law, c), off)| Way { law, c, off }).collect()
    }

    /// The case that shows first that the right formula isn't it in these conventions.
    fn failing(&self, c: &Conventions) -> usize {
        self.nearby.iter().find(|(_, known)| known == c).map_or(0, |(case, _)| *case)
    }
}

/// The best ways, each once, however one came to it.
fn best(mut ways: Vec<Way>) -> Vec<Way> {
    ways.sort_by(|a, b| a.off.total_cmp(&b.off));
    let mut known: Vec<(Vec<usize>, Conventions)> = vec![];
    ways.retain(|way| {
        let key = (way.law.clone(), *way.c);
        let new = known.len() < WAYS && !known.contains(&key);
        if new {
            known.push(key);
        }
        new
    });
    ways
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::{Answers, given};
    use super::super::super::exam::Exam;
    use super::super::super::mark::MarkOptions;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::convention::CS180;

    /// A march that has T behind each sample, takes the optical depth for the opacity, skips thin samples and gives up, seen by its color alone.
    #[test]
    fn four_parts_are_found_one_after_the_other() {
        let exam = Exam::new("volume_render", Dtype::F32, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 });
        let laws = question.component.special.laws_of(true).unwrap();
        let mut law = vec![0; laws.choices.len()];
        (law[0], law[5], law[6], law[7]) = (2, 1, 2, 4);
        let answer = |case: &Case| {
            let all = (laws.of)(&case.inputs, &CS180, &law);
            let mut answer =
                given(all.into_iter().map(|(n, a)| (n, a.mapv(|x| Dtype::F32.round(x)))).collect());
            answer.retain(|name, _| name == "colors");
            Some(answer)
        };
        let answers: Answers = question.cases.iter().map(answer).collect();
        let search = Search::new(question, &answers, &CS180, &options).unwrap();
        let found = search.climbed();
        let said: Vec<_> = found.iter().filter_map(|e| e.slip.as_ref().map(|slip| slip.says())).collect();
        assert!(said.iter().any(|said| said.contains(&laws.said(&law))), "{said:?}");
    }
}
