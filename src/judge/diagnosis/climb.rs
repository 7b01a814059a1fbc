//! Climbing: several mistakes at once, in conventions of their own, one after the other. Where each of them brings the answers nearer, the
//! way to all of them leads through few of the many that there are; where one alone shows nothing, it isn't found here.

use super::super::answer::Answers;
use super::super::assignment::small_cases;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::partial::{Partial, apply, partial, with};
use super::evidence::{explains_all, real_numbers, renamed, shows};
use super::fitted::{with_its_number, written};
use super::hypothesis::Hypothesis;
use super::nearness::{distance, likely};
use super::numbered::number_of;
use crate::contract::check::Kind;
use crate::contract::component::Mistake;
use crate::convention::{CHOICES, Conventions};
use crate::parallel;

/// Mistakes at once, steps on the way to them (a change of convention is one, too), and ways that are followed side by side.
const MISTAKES: usize = 4;
const STEPS: usize = 6;
const WAYS: usize = 24;

/// Conventions from which ways begin, the nearest first.
const STARTS: usize = 48;

/// The smallest cases go by this many.
const CASES: usize = 8;

/// Elements that all steps together may compute.
const WORK: usize = 200_000_000;

/// Bits by which a step must bring the answers nearer, on the average.
pub(crate) const NEARER: f64 = 0.02;

/// What is so near, in bits that are lost on the average, is held against all bounds.
pub(crate) const CLOSE: f64 = 1.0;

/// Of each step's best, those whose number is read off the answers.
const FITTED: usize = 4;

/// What may be, and how many bits of the answers it loses.
#[derive(Clone)]
struct Way {
    h: Hypothesis,
    off: f64,
}

/// The mistakes that explain every answer together, each of which is needed.
pub(crate) fn climbed(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Hypothesis> {
    // Of bits and counts several of many explain a few cases by chance, and short types have too few digits.
    if options.dtype.bits() < 24 || !real_numbers(question, answers) {
        return vec![];
    }
    let mut cases = small_cases(question, answers);
    cases.retain(|(case, _)| case.finite());
    cases.truncate(CASES);
    let cost: usize = cases.iter().map(|(case, _)| question.cost(case)).sum();
    let mut left = WORK / cost.max(1);
    let mut measured = |all: Vec<Hypothesis>| -> Vec<Way> {
        let all: Vec<Hypothesis> = all.into_iter().take(left).collect();
        left -= all.len();
        let off = parallel::map(all.len(), |n| distance(&all[n], question, &cases, options.dtype));
        all.into_iter().zip(off).map(|(h, off)| Way { h, off }).collect()
    };
    let fits =
        |h: &Hypothesis| explains_all(h, question, answers, options) && shows(h, question, answers, options);
    // What the right formula says in other conventions is no mistake.
    let own = |h: &Hypothesis| !h.right() && renamed(h, &[*base], question, answers, options).is_none();
    let starts = likely(STARTS, (question, answers), base, options).into_iter();
    let mut ways = measured(starts.map(|c| Hypothesis::new(vec![], c)).collect());
    best(&mut ways);
    for _ in 0..STEPS {
        let next = ways.iter().flat_map(|way| steps(&way.h, question).map(|h| (h, way.off)));
        let (all, before): (Vec<_>, Vec<_>) = next.unzip();
        let mut next = measured(all);
        let mut before = before.into_iter();
        next.retain(|way| before.next().is_some_and(|before| way.off < before - NEARER));
        best(&mut next);
        let near = |way: &Way| (way.off < CLOSE && fits(&way.h)).then(|| way.h.clone());
        let tried = parallel::map(next.len(), |n| {
            near(&next[n]).or_else(|| (n < FITTED).then(|| numbered(&next[n].h, question, answers, &fits))?)
        });
        let found: Vec<Hypothesis> = tried.into_iter().flatten().filter(own).collect();
        if !found.is_empty() {
            let mut least: Vec<Hypothesis> = vec![];
            for h in found.into_iter().map(|h| needed(h, question, base, &fits)) {
                // Many ways lead to the same.
                if !least.contains(&h) {
                    least.push(h);
                }
            }
            return least;
        }
        if next.is_empty() {
            break;
        }
        ways = next;
    }
    vec![]
}

/// The best ways, each once.
fn best(ways: &mut Vec<Way>) {
    ways.sort_by(|a, b| a.off.total_cmp(&b.off));
    let mut known: Vec<(Vec<&str>, Conventions)> = vec![];
    ways.retain(|way| {
        let mut key = (way.h.mistakes.clone(), way.h.conventions);
        key.0.sort_unstable();
        let new = known.len() < WAYS && !known.contains(&key);
        if new {
            known.push(key);
        }
        new
    });
}

/// One more mistake, or another value of one convention.
fn steps<'a>(h: &'a Hypothesis, question: &'a Question) -> impl Iterator<Item = Hypothesis> + 'a {
    let component = question.component;
    let more = h.mistakes.len() < MISTAKES;
    // What is wrong in the forward function is wrong by differences in its gradient: too expensive here.
    let gradient = question.kind == Kind::Vjp;
    let others = component.mistakes.iter().filter(move |m| more && m.gradient == gradient);
    let others = others.filter(|m| !h.mistakes.contains(&m.name)).flat_map(move |m| added(h, m));
    let own: Partial = partial(component, &h.conventions);
    let changed = component.conventions.iter().flat_map(move |key| {
        let (_, values) = CHOICES.iter().find(|(name, _)| name == key).expect("known conventions");
        let own = own.clone();
        let others: Vec<_> = values.iter().filter(|value| own[key] != **value).collect();
        others.into_iter().map(move |value| apply(&with(&own, key, value), &h.conventions))
    });
    let changed = changed.filter(|c| question.admits(c));
    others.chain(changed.map(|conventions| Hypothesis { conventions, ..h.clone() }))
}

/// A mistake beside those that there are, with its usual number and with those that people write.
fn added<'a>(h: &'a Hypothesis, m: &'static Mistake) -> impl Iterator<Item = Hypothesis> + 'a {
    let usual = Hypothesis { mistakes: [&h.mistakes[..], &[m.name]].concat(), ..h.clone() };
    let own = written(m).map(|number| Hypothesis {
        mistakes: [&[m.name], &h.mistakes[..]].concat(),
        fitted: [&[number], &h.fitted[..]].concat(),
        ..h.clone()
    });
    std::iter::once(usual).chain(own)
}

/// The same mistakes where they fit with the number of one of them read off the answers.
fn numbered(
    h: &Hypothesis,
    question: &Question,
    answers: &Answers,
    fits: &impl Fn(&Hypothesis) -> bool,
) -> Option<Hypothesis> {
    // Each with its number: the first of them is read off.
    let mut own: Vec<(&'static str, f64)> =
        h.mistakes.iter().filter_map(|name| Some((*name, number_of(question, name)?.usual))).collect();
    own.iter_mut().zip(&h.fitted).for_each(|((_, number), fitted)| *number = *fitted);
    own.iter().find_map(|(name, number)| {
        let others = h.mistakes.iter().filter(|other| *other != name).copied();
        let fitted = own.iter().filter(|(other, _)| other != name).map(|(_, number)| *number);
        let known =
            if h.fitted.is_empty() { vec![] } else { std::iter::once(*number).chain(fitted).collect() };
        let mistakes = std::iter::once(*name).chain(others).collect();
        let usual = Hypothesis { mistakes, fitted: known, ..h.clone() };
        let m = question.component.mistakes.iter().find(|m| m.name == *name)?;
        with_its_number(m, &usual, question, answers, fits)
    })
}

/// What is left without mistakes and changes of convention that nothing needs.
fn needed(
    mut h: Hypothesis,
    question: &Question,
    base: &Conventions,
    fits: &impl Fn(&Hypothesis) -> bool,
) -> Hypothesis {
    let numbered = |name: &str| number_of(question, name).is_some();
    let mut n = 0;
    while n < h.mistakes.len() {
        let mut less = h.clone();
        let taken = less.mistakes.remove(n);
        let place = h.mistakes[..n].iter().filter(|name| numbered(name)).count();
        if numbered(taken) && place < less.fitted.len() {
            less.fitted.remove(place);
        }
        if !less.right() && fits(&less) { h = less } else { n += 1 }
    }
    for key in question.component.conventions {
        let c = h.conventions.with(key, &base.get(key)).expect("a listed value");
        let less = Hypothesis { conventions: c, ..h.clone() };
        if c != h.conventions && question.admits(&c) && fits(&less) {
            h = less;
        }
    }
    h
}

#[cfg(test)]
mod tests {
    use ndarray::ArrayD;

    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::case::Case;
    use crate::convention::CS180;

    /// What is climbed to in a row's answers, after a change of each number.
    fn found(
        (row, kind): (&str, Kind),
        mistakes: &[&str],
        dtype: Dtype,
        change: impl Fn(f64) -> f64,
    ) -> Vec<Vec<&'static str>> {
        let exam = Exam::new(row, dtype, None).unwrap();
        let question = exam.questions.iter().find(|q| q.kind == kind).expect("a direction of its");
        let (direction, options) =
            (question.component.direction(kind).unwrap(), MarkOptions { dtype, exp_ulp: 4.0 });
        let answer = |case: &Case| {
            let wrong = (direction.wrong)(&case.inputs, &CS180, mistakes);
            let round = |a: ArrayD<f64>| a.mapv(|x| dtype.round(change(x)));
            Some(given(wrong.into_iter().map(|(name, a)| (name, round(a))).collect()))
        };
        let answers: Answers = question.cases.iter().map(answer).collect();
        let all = climbed(question, &answers, &CS180, &options);
        let mut all: Vec<_> = all.into_iter().map(|h| h.mistakes).collect();
        all.iter_mut().for_each(|names| names.sort_unstable());
        all.dedup();
        all
    }

    const IMPORTANCE: (&str, Kind) = ("importance_sampling", Kind::Forward);

    /// A port of `sample_pdf` as it was met: each of its deviations hides the others from a search by pairs.
    #[test]
    fn four_are_found_one_after_the_other() {
        let four = ["eps_in_denominator", "eps_in_sum", "no_leading_zero", "searched_from_the_left"];
        // Beside the others no answer tells the last from a sum over bins.
        let alike = ["eps_in_denominator", "eps_in_sum", "no_leading_zero", "summed_over_bins"];
        for dtype in [Dtype::F64, Dtype::F32] {
            assert_eq!(found(IMPORTANCE, &four, dtype, |x| x), [four, alike], "{dtype}");
        }
        assert!(found(IMPORTANCE, &four, Dtype::Bf16, |x| x).is_empty());
    }

    /// Hand-written gradients have several at once, too.
    #[test]
    fn those_of_a_gradient_are_found_one_after_the_other() {
        let three = ["compensation_not_differentiated", "jacobian_held", "off_diagonal_twice"];
        let row = ("gaussian_projection", Kind::Vjp);
        assert_eq!(found(row, &three, Dtype::F32, |x| x), [three]);
    }

    #[test]
    fn noise_is_no_number_of_mistakes() {
        for row in ["importance_sampling", "positional_encoding", "ndc_rays"] {
            let found = found((row, Kind::Forward), &[], Dtype::F32, |x| x * (1.0 + 1e-3 * (1e3 * x).sin()));
            assert!(found.is_empty(), "{row}: {found:?}");
        }
    }
}
