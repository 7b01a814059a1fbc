//! Most cases: what explains the answers but for some cases, where something more is wrong. A program that divides by the opacity also
//! divides 0 by 0 where nothing is there, and whether it adds 1e-8 shows nowhere else.

use super::super::answer::{Answer, Answers};
use super::super::assignment::open;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::partial::{Partial, apply, changes, partial};
use super::evidence::{
    Explanation, Suspect, difference, explains_all, largest_residual, real_numbers, shows, usable,
};
use super::fitted::guesses;
use super::hypothesis::Hypothesis;
use super::nearness::likeliest;
use crate::contract::case::Case;
use crate::contract::check::Kind;
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::parallel;

/// The share of the cases that must be explained.
const MOST: f64 = 2.0 / 3.0;

/// Cases that the right formula doesn't explain and a mistake does, at least; and their share of those that the right formula doesn't.
const SHOWN: (usize, f64) = (2, 0.5);

/// Numbers that these cases must have in all: where each has one, two of them are explained by chance.
const NUMBERS: usize = 3;

/// Gradients that are held against differences of what the forward answers showed, where most others are right.
const FEW: usize = 6;

/// How much of what wrong code may be off a mistake may use in the cases that it explains.
const CLOSE: f64 = 0.25;

/// Conventions that are tried, the nearest first.
const ASSIGNMENTS: usize = 48;

/// Conventions in which numbers are read off.
const GUESSED: usize = 4;

/// Conventions that are tried with two mistakes, and elements that all of these may compute.
const PAIRED: usize = 4;
const WORK: usize = 100_000_000;

/// Which cases a hypothesis explains.
struct Tried {
    hypothesis: Hypothesis,
    explained: Vec<bool>,
    changes: usize,
    seen: u32,
}

impl Tried {
    fn count(&self) -> usize {
        self.explained.iter().filter(|explained| **explained).count()
    }

    /// The cases that it explains and another doesn't.
    fn beyond<'a>(&'a self, other: &'a Tried) -> impl Iterator<Item = usize> + 'a {
        (0..self.explained.len()).filter(|n| self.explained[*n] && !other.explained[*n])
    }
}

/// The mistake, or the right formula, that explains most cases; `None` where nothing explains enough of them.
pub(crate) fn mostly(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    suspects: &[Suspect],
    options: &MarkOptions,
) -> Option<Explanation> {
    let cases = usable(&wrong(&[], base), question, answers);
    let numeric = question.kind == Kind::Vjp;
    let all: Vec<&Mistake> = question.component.mistakes.iter().filter(|m| numeric || !m.gradient).collect();
    let mut near = open(question, answers, base, options);
    near.truncate(ASSIGNMENTS);
    let all_of = |mistakes: &[&str]| {
        let seen = |name: &&str| all.iter().find(|m| m.name == *name).map_or(0, |m| m.count);
        mistakes.iter().map(seen).sum()
    };
    let home = partial(question.component, base);
    let one = |h: Hypothesis, cases: &[(&Case, &Answer)]| Tried {
        explained: explained(&h, question, cases, options),
        changes: changes(&partial(question.component, &h.conventions), &home),
        seen: all_of(&h.mistakes),
        hypothesis: h,
    };
    let tried = |sets: &[Vec<&'static str>], near: &[Partial], cases: &[(&Case, &Answer)]| {
        parallel::map(sets.len() * near.len(), |n| {
            let (mistakes, conventions) = (&sets[n / near.len()], &near[n % near.len()]);
            one(Hypothesis { conventions: apply(conventions, base), ..wrong(mistakes, base) }, cases)
        })
    };
    let best = |tried: Vec<Tried>| {
        let key = |t: &Tried| (t.count(), std::cmp::Reverse(t.changes), t.seen);
        // The last of equals wins in max_by_key: reversed, so that the first does.
        tried.into_iter().rev().max_by_key(key)
    };
    let formula = best(tried(&[vec![]], &near, &cases))?;
    let shown = all.iter().filter(|m| !numeric || m.gradient).map(|m| m.name);
    let singles: Vec<Vec<&str>> = shown.map(|name| vec![name]).collect();
    let mut found = tried(&singles, &near, &cases);
    if !numeric {
        let likely = likeliest(near.clone(), GUESSED, (question, answers), base, options);
        let but_for = ((1.0 - MOST) * cases.len() as f64) as usize;
        let guessed = |p: &Partial| guesses(question, answers, &apply(p, base), but_for);
        let guesses: Vec<Hypothesis> = likely.iter().flat_map(guessed).collect();
        found.extend(parallel::map(guesses.len(), |n| one(guesses[n].clone(), &cases)));
    }
    // Numeric gradients are too expensive for all conventions and cases, and for what the forward answers don't show.
    for (mistakes, _) in suspects.iter().filter(|(_, fitted)| numeric && fitted.is_empty()) {
        let few = usable(&wrong(mistakes, base), question, answers).len();
        found.extend(tried(std::slice::from_ref(mistakes), &near[..1], &cases[..few]));
    }
    let numbers =
        |(_, answer): &(&Case, &Answer)| answer.values().map(|given| given.values.len()).sum::<usize>();
    let enough = |t: &Tried| {
        let (asked, beyond) = (t.explained.len(), t.beyond(&formula).count());
        let wrong = formula.explained[..asked].iter().filter(|explained| !**explained).count();
        t.count() as f64 >= MOST * asked as f64
            && beyond >= SHOWN.0
            && beyond as f64 >= SHOWN.1 * wrong as f64
            && t.beyond(&formula).map(|n| numbers(&cases[n])).sum::<usize>() >= NUMBERS
    };
    found.retain(enough);
    // A number that is read off one case explains that one, and others nearly, whatever they are; so does one mistake of many, where a case
    // has a single number. What is right but for its rounding is closer. Short types and numeric gradients have too few
    // digits to tell.
    let close = |t: &Tried| {
        let fits = |h: &Hypothesis| -> f64 {
            let own = cases.iter().zip(&t.explained).filter(|(_, explained)| **explained);
            own.map(|((case, answer), _)| h.residual(question, case, answer, options)).fold(0.0, f64::max)
        };
        let exact = numeric || options.dtype.bits() < 24 || fits(&t.hypothesis) < CLOSE;
        // What leaves most of it open explains anything.
        let own = cases.iter().zip(&t.explained).filter(|(_, explained)| **explained).map(|(case, _)| *case);
        exact && !t.hypothesis.says_little(question, &own.collect::<Vec<_>>())
    };
    found.retain(close);
    // Of bits and counts a pair of many explains a few cases by chance, and so it does where a case has a single number: two of a formula's
    // pieces that are wrong show in cases apart.
    let telling = real_numbers(question, answers) && cases.iter().any(|case| numbers(case) > 1);
    if found.is_empty() && !numeric && telling {
        let pair = |n: usize| singles[..n].iter().map(move |other| (n, other[0]));
        let pairs = (0..singles.len()).flat_map(pair).map(|(n, other)| vec![other, singles[n][0]]);
        let pairs: Vec<Vec<&str>> = pairs.collect();
        let cost = cases.iter().map(|(case, _)| question.cost(case)).sum::<usize>() * pairs.len();
        found = tried(&pairs, &near[..near.len().min(PAIRED).min(WORK / cost.max(1))], &cases);
        found.retain(enough);
        found.retain(close);
    }
    if found.is_empty() && numeric {
        let show = |suspect| in_few(suspect, &formula, &cases, question, answers, base, options);
        if let Some(explanation) = suspects.iter().find_map(show) {
            return Some(explanation);
        }
    }
    let chosen = match best(found) {
        Some(mistake) => mistake,
        None if formula.count() as f64 >= MOST * cases.len() as f64 => formula,
        None => return None,
    };
    explanation(chosen, &cases, question, answers, base, options)
}

/// What the forward answers showed, where it explains all of the few gradients that the right formula doesn't: a march that ends early does
/// in opaque cases alone, which aren't among the smallest.
fn in_few(
    (mistakes, fitted): &Suspect,
    formula: &Tried,
    cases: &[(&Case, &Answer)],
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Option<Explanation> {
    let h = Hypothesis { fitted: fitted.clone(), ..Hypothesis::new(mistakes.clone(), *base) };
    let left: Vec<_> =
        cases.iter().zip(&formula.explained).filter(|(_, right)| !**right).map(|(case, _)| case).collect();
    let few = left.len() >= SHOWN.0 && left.len() <= FEW;
    // Where the right formula explains them, the mistake must, too, as far as its differences are asked for.
    let fits = few
        && explains_all(&h, question, answers, options)
        && left.iter().all(|(case, answer)| h.explains(question, case, answer, options));
    let those = |(case, answer): (&Case, &Option<Answer>)| {
        answer.clone().filter(|_| left.iter().any(|(other, _)| other.id == case.id))
    };
    let those: Answers = question.cases.iter().zip(answers).map(those).collect();
    (fits && shows(&h, question, &those, options)).then(|| Explanation {
        mistakes: question.component.mistakes.iter().filter(|m| mistakes.contains(&m.name)).collect(),
        fitted: fitted.clone(),
        residual: largest_residual(&h, question, &those, options),
        ..Explanation::default()
    })
}

/// Which of the cases it explains; those behind the one from which on they can't be enough any more count as not explained.
fn explained(
    h: &Hypothesis,
    question: &Question,
    cases: &[(&Case, &Answer)],
    options: &MarkOptions,
) -> Vec<bool> {
    let (mut explained, mut missed) = (vec![false; cases.len()], 0);
    for ((case, answer), explained) in cases.iter().zip(&mut explained) {
        *explained = h.explains(question, case, answer, options);
        missed += usize::from(!*explained);
        // The right formula is what others are compared with, case by case.
        if !h.mistakes.is_empty() && missed as f64 > (1.0 - MOST) * cases.len() as f64 {
            break;
        }
    }
    explained
}

/// These mistakes in the run's own conventions.
fn wrong(mistakes: &[&'static str], base: &Conventions) -> Hypothesis {
    Hypothesis::new(mistakes.to_vec(), *base)
}

/// What it says, where it says more than lost digits do on the cases that it explains.
fn explanation(
    tried: Tried,
    cases: &[(&Case, &Answer)],
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Option<Explanation> {
    let those_that_are = |explained: bool| -> Vec<&str> {
        let those = cases.iter().zip(&tried.explained).filter(|(_, own)| **own == explained);
        those.map(|((case, _), _)| case.id.as_str()).collect()
    };
    let explained = those_that_are(true);
    let left = |(case, answer): (&Case, &Option<Answer>)| {
        answer.clone().filter(|_| explained.contains(&case.id.as_str()))
    };
    let rest: Answers = question.cases.iter().zip(answers).map(left).collect();
    let h = &tried.hypothesis;
    // In the order of their numbers.
    let of = |name: &&str| question.component.mistakes.iter().find(|m| m.name == *name);
    let mistakes: Vec<_> = h.mistakes.iter().filter_map(of).collect();
    let own = |c: &Conventions| partial(question.component, c);
    shows(h, question, &rest, options).then(|| Explanation {
        mistakes,
        fitted: h.fitted.clone(),
        conventions: difference(&own(&h.conventions), &own(base)),
        residual: largest_residual(h, question, &rest, options),
        unexplained_cases: those_that_are(false).into_iter().map(String::from).collect(),
        ..Explanation::default()
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::arrays::{arrays, scalar};
    use crate::convention::CS180;

    /// What explains most of the answers of volume rendering with these mistakes after a change, and the names of all cases.
    fn found(
        mistakes: &[&str],
        change: impl Fn(&str, &mut Answer),
    ) -> Option<(Vec<&'static str>, Vec<String>)> {
        let exam = Exam::new("volume_render", Dtype::F64, None).unwrap();
        let question = &exam.questions[0];
        let answer = |case: &Case| {
            let mut answer = given((question.component.forward.wrong)(&case.inputs, &CS180, mistakes));
            change(&case.id, &mut answer);
            Some(answer)
        };
        let answers: Answers = question.cases.iter().map(answer).collect();
        let options = MarkOptions { dtype: Dtype::F64, exp_ulp: 4.0 };
        let e = mostly(question, &answers, &CS180, &[], &options)?;
        Some((e.mistakes.iter().map(|m| m.name).collect(), e.unexplained_cases))
    }

    #[test]
    fn a_mistake_is_named_beside_cases_of_their_own() {
        let empty = |_: &str, answer: &mut Answer| {
            answer
                .get_mut("colors")
                .expect("an output")
                .values
                .mapv_inplace(|c| if c.is_nan() { 0.25 } else { c });
        };
        let (mistakes, beside) = found(&["divided_by_opacity"], empty).unwrap();
        assert_eq!(mistakes, ["divided_by_opacity"]);
        assert!(beside.contains(&"empty_ray".to_string()), "{beside:?}");
    }

    #[test]
    fn the_right_formula_may_fail_in_one_case() {
        let one = |id: &str, answer: &mut Answer| {
            if id == "empty_ray" {
                answer.get_mut("colors").expect("an output").values.fill(f64::NAN);
            }
        };
        assert_eq!(found(&[], one), Some((vec![], vec!["empty_ray".to_string()])));
    }

    #[test]
    fn nothing_is_named_where_most_is_unexplained() {
        let all = |_: &str, answer: &mut Answer| {
            for given in answer.values_mut() {
                given.values.mapv_inplace(|x| (5.0 * x).sin() + 0.1);
            }
        };
        assert_eq!(found(&[], all), None);
    }

    /// A ceiling halves a first scale as an overflow does: of two numbers that is all that is known.
    #[test]
    fn two_numbers_show_no_mistake() {
        let mut exam = Exam::new("loss_scale_update", Dtype::F64, None).unwrap();
        let question = &mut exam.questions[0];
        question.cases.retain(|case| ["first", "overflow_first", "usual"].contains(&case.id.as_str()));
        assert_eq!(question.cases.len(), 3);
        let named = |other: usize| {
            let answer = |(n, case): (usize, &Case)| {
                let mistake = ["meaning_of_bit_exchanged"];
                let mut all = (question.component.forward.wrong)(&case.inputs, &CS180, &mistake);
                all.retain(|name, _| name == "scale_out");
                if n >= other {
                    all.values_mut().for_each(|scale| scale.fill(7.0));
                }
                Some(given(all))
            };
            let answers: Answers = question.cases.iter().enumerate().map(answer).collect();
            let options = MarkOptions { dtype: Dtype::F64, exp_ulp: 4.0 };
            mostly(question, &answers, &CS180, &[], &options).is_some_and(|e| !e.mistakes.is_empty())
        };
        assert!(named(3) && !named(2));
    }

    /// Where a case has a single number, a mistake of one piece and one of the other explain the cases of either, whatever is wrong.
    #[test]
    fn pieces_of_a_loss_are_no_pair() {
        let exam = Exam::new("huber", Dtype::F32, None).unwrap();
        let question = &exam.questions[0];
        let lines_alone = |case: &Case| {
            let (p, t, delta) =
                (&case.inputs["prediction"], &case.inputs["target"], case.inputs["delta"].sum());
            let mean = (p - t).mapv(f64::abs).mean().unwrap_or(0.0);
            Some(given(arrays([("value", scalar(Dtype::F32.round(delta * (mean - 0.5 * delta))))])))
        };
        let answers: Answers = question.cases.iter().map(lines_alone).collect();
        let options = MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 };
        let found = mostly(question, &answers, &CS180, &[], &options);
        assert!(found.is_none_or(|e| e.mistakes.len() < 2));
    }
}
