//! Other formulas: what nobody listed one by one, but is made of parts among which people choose.

use std::collections::{BTreeMap, BTreeSet};

use super::super::answer::{Answer, Answers, Given};
use super::super::assignment::{nearest, small_cases};
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::partial::apply;
use super::super::within::largest_of;
use super::evidence::{Explanation, only};
use super::hypothesis::Hypothesis;
use super::nearness::likely;
use super::slips::proved::proved;
use super::slips::slip::{LawSlip, Slip};
use super::slips::slipping::{attempt, conventions};
use super::telling::by_chance;
use super::unread::as_answered;
use crate::contract::case::Case;
use crate::contract::check::Kind;
use crate::contract::laws::Laws;
use crate::convention::Conventions;
use crate::parallel;

/// Numbers that all formulas together may compute on the first case that fails; and as many again, output by output.
pub(super) const WORK: usize = 6_000_000;

/// The conventions in which formulas are tried that differ from the right one in one part, in two, and in three.
pub(super) const TRIED: [usize; 3] = [12, 6, 3];

/// Those in which they are found output by output.
pub(super) const STEPPED: usize = 2;

/// What is near: this share of a number, and the square of it of the largest. What the formula is not, and an eps or a cap beside it is, is nearer
/// than that in most numbers; what isn't the formula seldom is.
const NEARLY: f64 = 0.03;

/// How many times longer than the first that fails a case may be on which formulas are tried before they are on all; and shares of its numbers that
/// are told apart.
const LONGER: usize = 4;
const SHARES: usize = 16;

/// Conventions that are tried beside the run's and those of known programs: those that change least, and those in which the answers are nearest.
const NEAR: usize = 6;

/// The formulas of the row's family that explain every answer: those that differ from the right one in the fewest parts, or what output
/// after output shows. Where none does, edge cases are left out, and told.
pub(super) fn lawful(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Explanation> {
    Search::new(question, answers, base, options).map_or(vec![], |search| search.all())
}

/// A search among the formulas of a row.
pub(super) struct Search<'a> {
    pub(super) question: &'a Question,
    pub(super) answers: &'a Answers,
    pub(super) base: &'a Conventions,
    pub(super) options: &'a MarkOptions,
    pub(super) laws: Laws,
    /// The cases, the smallest first.
    pub(super) cases: Vec<(&'a Case, &'a Answer)>,
    /// The outputs that are answered anywhere.
    pub(super) outputs: BTreeSet<&'a str>,
    /// The conventions in which they are tried, each with the smallest case that the right formula doesn't explain in them.
    pub(super) nearby: Vec<(usize, Conventions)>,
}

impl<'a> Search<'a> {
    /// `None` where the row has no other formulas, or the right one explains all in some convention.
    pub(super) fn new(
        question: &'a Question,
        answers: &'a Answers,
        base: &'a Conventions,
        options: &'a MarkOptions,
    ) -> Option<Self> {
        let laws = question.component.special.laws_of(question.kind == Kind::Forward)?;
        let cases = small_cases(question, answers);
        let outputs = cases.iter().flat_map(|(_, answer)| answer.keys().map(String::as_str)).collect();
        let wrong = |c: &Conventions| {
            let right = Hypothesis::new(vec![], *c);
            cases.iter().position(|(case, answer)| !right.explains(question, case, answer, options))
        };
        // What is likely comes before what known programs do, for two wrong parts are tried in the first few alone.
        let mut all = vec![*base, nearest(question, answers, base, options)];
        all.retain(|c| question.admits(c));
        all.extend(likely(NEAR, (question, answers), base, options));
        all.extend(conventions(question, answers, base, options));
        let mut nearby: Vec<(usize, Conventions)> = vec![];
        for c in all {
            if !nearby.iter().any(|(_, known)| *known == c) {
                nearby.push((wrong(&c)?, c));
            }
        }
        Some(Search { question, answers, base, options, laws, cases, outputs, nearby })
    }

    pub(super) fn hypothesis(&self, choices: &[usize], c: &Conventions) -> Hypothesis {
        let forward = self.question.kind == Kind::Forward;
        let law = LawSlip {
            choices: choices.to_vec(),
            said: self.laws.said(choices),
            rounds: self.laws.rounds(choices),
            forward,
        };
        Hypothesis { slip: Some(Slip::Law(law)), ..Hypothesis::new(vec![], *c) }
    }

    /// What differs in one part alone.
    pub(super) fn in_one_part(&self) -> Vec<Explanation> {
        self.found(1)
    }

    /// What explains every answer; where nothing does, all but edge cases, which are told.
    pub(super) fn all(&self) -> Vec<Explanation> {
        let Search { question, answers, base, options, .. } = *self;
        let found = self.found(TRIED.len());
        if !found.is_empty() || question.cases.iter().all(|case| case.edge.is_none()) {
            return found;
        }
        let (usual, kept) = only(question, answers, |case| case.edge.is_none());
        let of_usual = Search::new(&usual, &kept, base, options);
        let mut found = of_usual.map_or(vec![], |search| search.found(TRIED.len()));
        for explanation in &mut found {
            let c = apply(&explanation.conventions, base);
            let h = Hypothesis { slip: explanation.slip.clone(), ..Hypothesis::new(vec![], c) };
            let edges = self.cases.iter().filter(|(case, _)| case.edge.is_some());
            let off = edges.filter(|(case, answer)| {
                !attempt(|| h.explains(question, case, answer, options)).unwrap_or(false)
            });
            explanation.unexplained_cases = off.map(|(case, _)| case.id.clone()).collect();
        }
        found
    }

    /// What differs in at most so many parts; where that may be all that are tried, output by output too.
    fn found(&self, most: usize) -> Vec<Explanation> {
        let (mut left, mut tried) = (WORK, 0);
        for (parts, conventions) in (1..=most.min(self.laws.choices.len())).zip(TRIED) {
            let all = self.laws.differing(parts, |_| true, left / self.question.cost(self.cases[0].0));
            let nearby = &self.nearby[..conventions.min(self.nearby.len())];
            let trials = self.affordable(all.len(), nearby, &mut left);
            tried += trials.len();
            let right = vec![0; self.laws.choices.len()];
            let telling: Vec<usize> =
                nearby.iter().map(|(n, c)| self.telling(&right, (*n, c), &self.outputs)).collect();
            let near = parallel::map(trials.len(), |n| {
                let (law, (case, c)) = (&all[trials[n].0], &nearby[trials[n].1]);
                let near = |n: &usize| self.near(law, *n, c) == self.cases[*n].1.len();
                [telling[trials[n].1], *case].iter().all(near).then(|| (*case, self.hypothesis(law, c)))
            });
            let found = self.proved(near.into_iter().flatten().collect(), tried);
            if !found.is_empty() {
                return found;
            }
        }
        if most < TRIED.len() {
            return vec![];
        }
        let likeliest = self.nearby.iter().take(STEPPED);
        let step_by_step = likeliest.filter_map(|(n, c)| Some((*n, self.by_outputs(*n, c, &mut tried)?)));
        let found = step_by_step.collect();
        self.proved(found, tried)
    }

    /// Which of so many formulas are tried in which conventions, with what is `left`: each convention has its share, however much one costs.
    fn affordable(
        &self,
        formulas: usize,
        nearby: &[(usize, Conventions)],
        left: &mut usize,
    ) -> Vec<(usize, usize)> {
        let mut trials = vec![];
        for (n, (case, _)) in nearby.iter().enumerate() {
            let cost = self.question.cost(self.cases[*case].0);
            let many = (*left / (nearby.len() - n) / cost).min(formulas);
            *left -= many * cost;
            trials.extend((0..many).map(|law| (law, n)));
        }
        trials
    }

    /// In how many outputs of a case most numbers are about what a formula gives: what most formulas are rejected by, for it costs little.
    pub(super) fn near(&self, law: &[usize], case: usize, c: &Conventions) -> usize {
        self.about(law, case, c).values().filter(|(about, all)| 2 * about >= *all).count()
    }

    /// Of each output of a case, how many numbers are about what a formula gives, and how many there are.
    fn about(&self, law: &[usize], case: usize, c: &Conventions) -> BTreeMap<&'a str, (usize, usize)> {
        let (case, answer) = self.cases[case];
        let Some(mut predicted) = attempt(|| (self.laws.of)(&case.inputs, c, law)) else {
            return BTreeMap::new();
        };
        as_answered(self.question.component, case, answer, &mut predicted);
        let about = |(name, given): (&'a String, &Given)| {
            let p = predicted.get(name).filter(|p| p.len() == given.values.len())?;
            let least = NEARLY * NEARLY * largest_of(p);
            let same = |(p, g): &(&f64, &f64)| {
                !p.is_finite() || !g.is_finite() || (*p - *g).abs() <= NEARLY * p.abs().max(g.abs()) + least
            };
            Some((name.as_str(), (p.iter().zip(&given.values).filter(same).count(), p.len())))
        };
        answer.iter().filter_map(about).collect()
    }

    /// Of the cases that cost not much more than `failing`, that in which the largest share of the numbers of these outputs isn't about what a
    /// formula gives: most of the others that are wrong are rejected there.
    pub(super) fn telling(
        &self,
        law: &[usize],
        (failing, c): (usize, &Conventions),
        outputs: &BTreeSet<&str>,
    ) -> usize {
        let most = LONGER * self.question.cost(self.cases[failing].0);
        let off = |n: &usize| {
            let about = self.about(law, *n, c);
            let those = about.iter().filter(|(name, _)| outputs.contains(*name)).map(|(_, counts)| *counts);
            let (about, all) = those.fold((0, 0), |(a, b), (about, all)| (a + about, b + all));
            SHARES * (all - about) / all.max(1)
        };
        // Where rounding alone may be as far off, what is right isn't about right.
        let digits =
            |n: &usize| self.options.dtype.bits() >= 24 && self.options.may_reject_early(self.cases[*n].0);
        let cheap =
            (0..self.cases.len()).filter(|n| self.question.cost(self.cases[*n].0) <= most).filter(digits);
        // The last of equals wins in max_by_key: reversed, so that the smallest does.
        cheap.rev().max_by_key(off).unwrap_or(failing)
    }

    /// Those that explain all answers by more than one of so many that were `tried` would by chance.
    fn proved(&self, near: Vec<(usize, Hypothesis)>, tried: usize) -> Vec<Explanation> {
        let nearby: Vec<Conventions> = self.nearby.iter().map(|(_, c)| *c).collect();
        proved(near, by_chance(tried), &nearby, self.question, self.answers, self.base, self.options)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::super::evidence::{explains_all, nothing_but_zero};
    use super::*;
    use crate::contract::arithmetic::{Arithmetic, Dtype, Grade};
    use crate::contract::check::{tolerance, worst};
    use crate::contract::testing::one_in;
    use crate::convention::CS180;
    use crate::registry::COMPONENTS;

    /// Formulas of each row that are tried, and the share of them that must be told: what shows in two numbers could be anything.
    const TOLD: usize = 12;
    const MOST: (usize, usize) = (2, 3);

    /// All questions whose rows have laws.
    fn asked(dtype: Dtype, f: impl Fn(&Question, &Laws)) {
        for component in COMPONENTS {
            let laws = |kind| component.special.laws_of(kind == Kind::Forward);
            if [Kind::Forward, Kind::Vjp].into_iter().all(|kind| laws(kind).is_none()) {
                continue;
            }
            // An exam asks the row's neighbors, too.
            let questions = Exam::new(component.name, dtype, None).unwrap().questions;
            for question in questions.iter().filter(|q| q.component.name == component.name) {
                laws(question.kind).iter().for_each(|laws| f(question, laws));
            }
        }
    }

    /// Without a wrong part a law is the formula.
    #[test]
    fn the_first_choices_are_right() {
        asked(Dtype::F64, |question, laws| {
            let direction = question.component.direction(question.kind).unwrap();
            for case in &question.cases {
                let got = (laws.of)(&case.inputs, &CS180, &vec![0; laws.choices.len()]);
                let expected = (direction.oracle)(&case.inputs, &CS180);
                let m = Arithmetic::new(Dtype::F64, Grade::B);
                let off = worst(&got, &expected, &tolerance(direction, &case.inputs, &CS180, &m));
                assert!(off <= 1.0, "{} {:?} {}: {off}", question.component.name, question.kind, case.id);
            }
        });
    }

    #[test]
    fn no_two_are_said_alike() {
        asked(Dtype::F64, |question, laws| {
            let name = question.component.name;
            let each = laws.differing(1, |_| true, usize::MAX).into_iter().map(|law| laws.said(&law));
            let mut known = BTreeSet::new();
            for said in each {
                assert!(!said.is_empty() && known.insert(said.clone()), "{name}: {said:?}");
            }
        });
    }

    /// Some of them, in f32: by their own words or by others that give the same numbers. Those that give nothing but 0 or no number tell
    /// nothing.
    #[test]
    fn other_formulas_are_told() {
        asked(Dtype::F32, |question, laws| {
            let all = [1, 2].map(|parts| laws.differing(parts, |_| true, usize::MAX)).concat();
            let step = (all.len() / TOLD).max(1) * one_in(4);
            let (mut tried, mut named, mut unknown) = (0, 0, vec![]);
            for law in all.into_iter().skip(step / 2).step_by(step) {
                let round = |a: ndarray::ArrayD<f64>| a.mapv(|x| Dtype::F32.round(x));
                let answer = |case: &Case| {
                    let outputs = (laws.of)(&case.inputs, &CS180, &law);
                    Some(given(outputs.into_iter().map(|(name, a)| (name, round(a))).collect()))
                };
                let answers: Answers = question.cases.iter().map(answer).collect();
                let options = MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 };
                if nothing_but_zero(question, &answers) {
                    continue;
                }
                let right = Hypothesis::new(vec![], CS180);
                let found = lawful(question, &answers, &CS180, &options);
                // Some change nothing by themselves, as a cap that no case reaches, and some little.
                let loose = Hypothesis { loose: true, ..right.clone() };
                let inert = explains_all(&loose, question, &answers, &options);
                if !inert {
                    let told = found.first().is_some_and(|e| e.slip.is_some());
                    (tried, named) = (tried + 1, named + usize::from(told));
                    unknown.extend((!told).then(|| laws.said(&law)));
                }
            }
            let (name, kind) = (question.component.name, question.kind);
            assert!(MOST.1 * named >= MOST.0 * tried, "{name} {kind:?}: {named} of {tried}, not {unknown:?}");
        });
    }
}
