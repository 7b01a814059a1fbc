//! Which conventions a run follows: one assignment over all of its components, from closed lists, nothing fitted.

use std::collections::{BTreeMap, BTreeSet};
use std::iter::once_with;

use ndarray::ArrayD;

use super::answer::{Answer, Answers, reshaped};
use super::diagnosis::hypothesis::Hypothesis;
use super::exam::Question;
use super::known::Known;
use super::mark::{MarkOptions, nothing_to_show, proves};
use super::partial::{Partial, apply, changes, partial, read, with};
use super::statistics;
use super::within::within;
use crate::contract::arithmetic::Grade;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::component::Component;
use crate::convention::profiles::PROFILES;
use crate::convention::{CHOICES, CS180, Conventions};
use crate::parallel;

/// Inputs of more elements than this are left to the final marking: a search needs the small cases only.
const LARGE: usize = 20_000;

/// The smallest cases are simple, and one alone may show little: this many are asked for the conventions of an output that no mistake
/// reaches.
const SHOWING: usize = 3;

/// Steps of backtracking before the search settles for the best it has.
const PATIENCE: usize = 20_000;

/// All assignments of a component's conventions, those next to `base` first.
pub(crate) fn assignments(component: &Component, base: &Conventions) -> Vec<Partial> {
    let mut all = vec![Partial::new()];
    for key in component.conventions {
        let (_, values) = CHOICES.iter().find(|(name, _)| name == key).expect("known conventions");
        let extend = |p: &Partial| values.iter().map(|v| with(p, key, v)).collect::<Vec<_>>();
        all = all.iter().flat_map(extend).collect();
    }
    let base = partial(component, base);
    all.sort_by_cached_key(|p| changes(p, &base));
    all
}

/// The assignments that all cases admit, those next to `base` first.
pub(crate) fn admitted(question: &Question, base: &Conventions) -> Vec<Partial> {
    let mut all = assignments(question.component, base);
    all.retain(|p| question.admits(&apply(p, base)));
    all
}

/// The admitted assignments that those outputs don't rule out which no mistake reaches. Where an output would leave none, the nearest
/// stays. What programs seldom follow is among them only where the right formula is nearer to the answers with it.
pub(crate) fn open(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Partial> {
    let mut all = admitted(question, base);
    let cases = small_cases(question, answers);
    let special = &question.component.special;
    for (output, keys) in special.reads.iter().filter(|(output, _)| special.untouched.contains(output)) {
        let answered: Vec<_> =
            cases.iter().filter(|(_, answer)| answer.contains_key(*output)).take(SHOWING).collect();
        // As many digits may be lost as where something is wrong; but what is right without that shows more.
        let fitting = |loose: bool| {
            let mut fitting = all.clone();
            keep(&mut fitting, keys, |p| {
                let right = Hypothesis { loose, ..Hypothesis::new(vec![], apply(p, base)) };
                let mut explained = vec![*output];
                for (case, answer) in &answered {
                    right.keep_explained(question, case, answer, options, &mut explained);
                }
                !explained.is_empty()
            });
            fitting
        };
        if let Some(fitting) = [false, true].into_iter().map(fitting).find(|fitting| !fitting.is_empty()) {
            all = fitting;
        } else {
            all.truncate(1);
        }
    }
    for key in special.seldom {
        let home = partial(question.component, base);
        let agreeing = |p: &Partial| agreeing(question, &cases, &apply(p, base), options);
        let (_, values) = CHOICES.iter().find(|(name, _)| name == key).expect("known conventions");
        let mut others = values.iter().filter(|value| **value != home[key]);
        if !others.any(|value| agreeing(&with(&home, key, value)) > agreeing(&home)) {
            all.retain(|p| p[key] == home[key]);
        }
    }
    all
}

/// Keeps the assignments that fit, which only these conventions decide.
fn keep(all: &mut Vec<Partial>, keys: &[&str], fits: impl Fn(&Partial) -> bool) {
    let mut known: BTreeMap<Vec<&str>, bool> = BTreeMap::new();
    all.retain(|p| *known.entry(keys.iter().map(|key| p[key]).collect()).or_insert_with(|| fits(p)));
}

/// The cases that a search goes by, the smallest first.
pub(crate) fn small_cases<'a>(question: &'a Question, answers: &'a Answers) -> Vec<(&'a Case, &'a Answer)> {
    let pairs = question.cases.iter().zip(answers).filter_map(|(case, a)| a.as_ref().map(|a| (case, a)));
    let mut pairs: Vec<_> = pairs.collect();
    pairs.sort_by_cached_key(|(case, _)| case.size());
    let first_large = pairs.iter().position(|(case, _)| case.size() > LARGE).unwrap_or(pairs.len());
    pairs.truncate(first_large.max(1));
    pairs
}

/// The assignments that no output of the smallest case rules out. A row of thousands of assignments says which
/// conventions an output reads: assignments that differ only in others are checked once.
pub(crate) fn possible(
    question: &Question,
    answers: &Answers,
    mut all: Vec<Partial>,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Partial> {
    let first = small_cases(question, answers).first().copied();
    let Some((case, answer)) = first else { return all };
    for (output, keys) in question.component.special.reads {
        let Some(given) = answer.get(*output) else { continue };
        let alone: Answer = [(output.to_string(), given.clone())].into();
        let fits = |p: &Partial| {
            let c = apply(p, base);
            let mut expected = (question.component.forward.oracle)(&case.inputs, &c);
            expected.retain(|name, _| name == output);
            let bound = once_with(|| options.truth(question, case, &c, Grade::B).bound.clone());
            within(&alone, &expected, options.scale(question, case), bound)
        };
        keep(&mut all, keys, fits);
    }
    all
}

/// Whether all small cases are right in these conventions, with evidence in every output: where 0 would be right too, these
/// conventions aren't what the answers follow, they only say nothing.
pub(crate) fn holds(question: &Question, answers: &Answers, c: &Conventions, options: &MarkOptions) -> bool {
    if question.statistics() {
        return statistics::plausible(question, answers, c);
    }
    if !question.admits(c) {
        return false;
    }
    let cases = small_cases(question, answers);
    let mut unproved: BTreeSet<&String> = cases.iter().flat_map(|(_, answer)| answer.keys()).collect();
    // Those first that can be rejected without a bound.
    let (hard, others): (Vec<_>, Vec<_>) =
        cases.iter().partition(|(case, _)| !options.may_reject_early(case));
    let right = others.into_iter().chain(hard).all(|(case, answer)| {
        let expected = question.expected(case, c);
        let bound = once_with(|| {
            let bound = options.truth(question, case, c, Grade::B).bound.clone();
            unproved.retain(|name| expected.get(*name).is_some_and(|e| !proves(e, &bound[*name])));
            bound
        });
        within(answer, &expected, options.scale(question, case), bound)
    });
    if cases.is_empty() || !right {
        return false;
    }
    let nothing = if unproved.is_empty() { BTreeSet::new() } else { nothing_to_show(question, c) };
    unproved.iter().all(|name| nothing.contains(*name))
}

/// One assignment over the whole run.
pub(crate) struct Found {
    /// The assignment.
    pub conventions: Conventions,
    /// Sheets that are right in some conventions, but not in the run's, with those conventions.
    pub contradicting: Vec<(usize, Conventions)>,
}

/// A question, its answers, and what is known of them.
pub(crate) type Asked<'a> = (&'a Question, &'a Answers, &'a Known);

/// Looks for the one assignment in which every question is right that is right in any.
pub(crate) fn find(questions: &[Asked], options: &MarkOptions) -> Found {
    let holds_in = |n: usize, c: &Conventions| {
        let (question, answers, known) = questions[n];
        known.holds(read(question.component, c), |c| holds(question, answers, c, options))
    };
    let wrong_in = |c: &Conventions| -> Vec<usize> {
        let holds = parallel::map(questions.len(), |n| holds_in(n, c));
        (0..questions.len()).filter(|n| !holds[*n]).collect()
    };
    let survivors_of = |some: &[usize]| -> Vec<(usize, Vec<Partial>)> {
        let of = |n: usize| -> Vec<Partial> {
            let (question, answers, _) = questions[n];
            let all = possible(question, answers, admitted(question, &CS180), &CS180, options);
            all.into_iter().filter(|p| holds_in(n, &apply(p, &CS180))).collect()
        };
        some.iter().copied().zip(parallel::map(some.len(), |n| of(some[n]))).collect()
    };
    // A known program's conventions, if what is wrong in them is wrong in any.
    let (conventions, wrong) = nearest_profile(wrong_in);
    let of_wrong = survivors_of(&wrong);
    if of_wrong.iter().all(|(_, survivors)| survivors.is_empty()) {
        return Found { conventions, contradicting: vec![] };
    }
    let others: Vec<usize> = (0..questions.len()).filter(|n| !wrong.contains(n)).collect();
    let all: BTreeMap<usize, Vec<Partial>> = of_wrong.into_iter().chain(survivors_of(&others)).collect();
    let survivors: Vec<Vec<Partial>> = all.into_values().collect();
    let mut order: Vec<usize> = (0..questions.len()).filter(|&n| !survivors[n].is_empty()).collect();
    order.sort_by_key(|&n| survivors[n].len());
    let mut patience = PATIENCE;
    let joined = join(&order, &survivors, &Partial::new(), &mut patience)
        .unwrap_or_else(|| majority(&order, &survivors));
    let contradicts = |n: &usize| survivors[*n].iter().all(|p| changes(p, &joined) > 0);
    let contradicting = order.iter().filter(|n| contradicts(n));
    Found {
        conventions: apply(&joined, &CS180),
        contradicting: contradicting.map(|&n| (n, apply(&survivors[n][0], &CS180))).collect(),
    }
}

/// The known program in whose conventions fewest questions are wrong, the first of equals, and which these are.
fn nearest_profile(wrong_in: impl Fn(&Conventions) -> Vec<usize>) -> (Conventions, Vec<usize>) {
    let mut all = PROFILES.iter().map(|profile| profile.conventions);
    let first = all.next().expect("there are profiles");
    let mut nearest = (first, wrong_in(&first));
    for c in all {
        if nearest.1.is_empty() {
            break;
        }
        let wrong = wrong_in(&c);
        if wrong.len() < nearest.1.len() {
            nearest = (c, wrong);
        }
    }
    nearest
}

/// Backtracking: the assignment that agrees with one survivor of every question.
fn join(
    order: &[usize],
    survivors: &[Vec<Partial>],
    so_far: &Partial,
    patience: &mut usize,
) -> Option<Partial> {
    let Some((&n, rest)) = order.split_first() else { return Some(so_far.clone()) };
    for survivor in survivors[n].iter().filter(|p| changes(p, so_far) == 0) {
        *patience = patience.checked_sub(1)?;
        let mut joined = so_far.clone();
        joined.extend(survivor.iter());
        if let Some(found) = join(rest, survivors, &joined, patience) {
            return Some(found);
        }
    }
    None
}

/// Where no assignment holds for all: convention by convention, the value that most questions agree with.
fn majority(order: &[usize], survivors: &[Vec<Partial>]) -> Partial {
    let mut joined = Partial::new();
    for (key, values) in CHOICES {
        let agrees = |n: usize, v: &str| {
            survivors[n]
                .iter()
                .any(|p| changes(p, &joined) == 0 && p.get(key).is_none_or(|other| *other == v))
        };
        let votes = |v: &&&str| order.iter().filter(|&&n| agrees(n, v)).count();
        // The last of equals wins in max_by_key: reversed, so that the default does.
        if order.iter().any(|&n| survivors[n].iter().any(|p| p.contains_key(key))) {
            let best = values.iter().rev().max_by_key(votes).expect("lists aren't empty");
            joined.insert(key, best);
        }
    }
    joined
}

/// Assignments that are compared when nothing explains the answers.
const COMPARED: usize = 2_000;

/// Roundings by which elements that agree to the last digits may be off.
const ROUNDINGS: f64 = 16.0;

/// The assignment in which most elements agree with the answers, to a few digits and to the last ones; the nearest to `base` among equals.
pub(crate) fn nearest(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Conventions {
    let all = open(question, answers, base, options).into_iter().map(|p| apply(&p, base));
    let all: Vec<Conventions> = all.take(COMPARED).collect();
    let cases = small_cases(question, answers);
    let agreeing = parallel::map(all.len(), |n| agreeing(question, &cases, &all[n], options));
    // The last of equals wins in max_by_key.
    let best = (0..all.len()).rev().max_by_key(|&n| agreeing[n]);
    best.map_or(*base, |n| all[n])
}

/// How many elements agree in these conventions, to a few digits and to the last ones.
fn agreeing(
    question: &Question,
    cases: &[(&Case, &Answer)],
    c: &Conventions,
    options: &MarkOptions,
) -> usize {
    let direction = question.component.direction(question.kind).expect("a question has its direction");
    let agree = |(case, answer): &(&Case, &Answer)| {
        let expected = (direction.oracle)(&case.inputs, c);
        let within = [THREE_DIGITS, ROUNDINGS * options.dtype.unit_roundoff()];
        within.map(|relative| agreement(answer, &expected, relative)).iter().sum::<usize>()
    };
    cases.iter().take(AGREEING).map(agree).sum()
}

/// The smallest cases that they are compared on.
const AGREEING: usize = 12;

/// What is off by no more is about right.
pub(crate) const THREE_DIGITS: f64 = 1e-3;

/// How many elements agree, to this part of them.
pub(crate) fn agreement(answer: &Answer, expected: &Arrays, relative: f64) -> usize {
    let one = |(name, e): (&String, &ArrayD<f64>)| {
        let (got, _) = reshaped(&answer.get(name)?.values, e.shape())?;
        Some(got.iter().zip(e).filter(|&(g, e)| g == e || (g - e).abs() <= relative * e.abs()).count())
    };
    expected.iter().filter_map(one).sum()
}
