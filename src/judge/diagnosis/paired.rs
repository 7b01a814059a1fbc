//! Pairs: two mistakes in conventions far from the run's. Which of them are worth trying, single mistakes show: of a pair, one alone makes
//! more elements agree than what has nothing to do with it.

use super::super::answer::Answers;
use super::super::assignment::{THREE_DIGITS, agreement, open, small_cases};
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::partial::{Partial, apply, changes, partial};
use super::evidence::{explains_all, shows};
use super::hypothesis::Hypothesis;
use crate::convention::Conventions;
use crate::parallel;

/// The smallest cases by which single mistakes are compared.
const CASES: usize = 4;

/// Single mistakes that others are tried with.
const KEPT: usize = 100;

/// Elements that all single mistakes together may compute on the smallest case.
const WORK: usize = 4_000_000;

/// The pairs of mistakes that explain every answer, in any conventions.
pub(crate) fn paired(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Hypothesis> {
    let cases = small_cases(question, answers);
    let Some((case, _)) = cases.first() else { return vec![] };
    let names: Vec<_> = question.component.mistakes.iter().filter(|m| !m.gradient).map(|m| m.name).collect();
    let home = partial(question.component, base);
    let mut near: Vec<Partial> = open(question, answers, base, options);
    let cost = question.cost(case);
    near.truncate((WORK / (cost * names.len().max(1))).max(1));
    let singles: Vec<Hypothesis> = names
        .iter()
        .flat_map(|name| near.iter().map(move |p| Hypothesis::new(vec![*name], apply(p, base))))
        .collect();
    let agreeing = parallel::map(singles.len(), |n| {
        let of = cases.iter().take(CASES);
        of.map(|(case, answer)| agreement(answer, &singles[n].prediction(question, case).0, THREE_DIGITS))
            .sum::<usize>()
    });
    let mut best: Vec<(usize, usize, &Hypothesis)> = agreeing
        .into_iter()
        .zip(&singles)
        .map(|(agreeing, h)| (agreeing, changes(&partial(question.component, &h.conventions), &home), h))
        .collect();
    best.sort_by_key(|(agreeing, changes, _)| (std::cmp::Reverse(*agreeing), *changes));
    best.truncate(KEPT);
    let mut pairs: Vec<Hypothesis> = vec![];
    for (_, _, single) in best {
        let first = single.mistakes[0];
        for other in names.iter().filter(|other| **other != first) {
            // Both of a pair may be among the best.
            let known = |h: &Hypothesis| h.mistakes == [*other, first] && h.conventions == single.conventions;
            if !pairs.iter().any(known) {
                pairs.push(Hypothesis { mistakes: vec![first, other], ..single.clone() });
            }
        }
    }
    let fits =
        |h: &Hypothesis| explains_all(h, question, answers, options) && shows(h, question, answers, options);
    let fits = parallel::map(pairs.len(), |n| fits(&pairs[n]));
    pairs.into_iter().zip(fits).filter(|(_, fits)| *fits).map(|(h, _)| h).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::convention::CS180;

    /// The names of the first pair that is found in answers with these mistakes.
    fn found(mistakes: [&str; 2], dtype: Dtype) -> Option<Vec<&'static str>> {
        let exam = Exam::new("gaussian_projection", dtype, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype, exp_ulp: 4.0 });
        // Three conventions away from the run's.
        let other = [("splat_center", "integer"), ("splat_clamp", "none"), ("radius_floor", "0.01")];
        let c = other.iter().fold(CS180, |c, (key, value)| c.with(key, value).unwrap());
        let answer = |case| {
            let wrong = (question.component.forward.wrong)(case, &c, &mistakes);
            Some(given(wrong.into_iter().map(|(name, a)| (name, a.mapv(|x| dtype.round(x)))).collect()))
        };
        let answers: Answers = question.cases.iter().map(|case| answer(&case.inputs)).collect();
        let found = paired(question, &answers, &CS180, &options);
        let mut all: Vec<_> = found.iter().map(|h| (h.mistakes.clone(), h.conventions)).collect();
        all.iter_mut().for_each(|(names, _)| names.sort_unstable());
        let (first, rest) = all.split_first()?;
        assert!(!rest.contains(first), "the same pair twice");
        Some(first.0.clone())
    }

    #[test]
    fn two_mistakes_are_found_far_from_the_runs_conventions() {
        for dtype in [Dtype::F64, Dtype::F32] {
            let pair = ["conic_sign", "turned_back"];
            assert_eq!(found(pair, dtype), Some(pair.to_vec()), "{dtype}");
        }
    }
}
