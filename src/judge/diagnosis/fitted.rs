//! Fitting: the number in a mistake that everybody chooses for herself, found from the answers themselves and then held against all of
//! them.

use std::iter::once_with;

use ndarray::ArrayD;

use super::super::answer::{Answer, Answers, Given, reshaped};
use super::super::assignment::small_cases;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::within::largest_of;
use super::evidence::{Suspect, explains_all, forward_is_the_same, renamed, shows, usable};
use super::hypothesis::Hypothesis;
use super::stepwise;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::check::Kind;
use crate::contract::component::{Mistake, Number};
use crate::convention::Conventions;
use crate::math::{exp, ln};
use crate::parallel;

/// Elements that a number is read off.
const ELEMENTS: usize = 5;

/// Conventions in which a number is read off even where the answers lie beyond what its range gives: next to a pole they do.
const LIKELIEST: usize = 4;

/// The same where a row has few mistakes with numbers, and small cases: this many elements for each convention, over all of these.
const ASKED: usize = 4000;

/// Numbers of a range that are tried before one is read off, on so many of the smallest cases, and by how much of an answer's size it may
/// lie beyond what they give.
const GRID: usize = 9;
const CASES: usize = 3;
const BEYOND: f64 = 0.05;

/// An answer is far from what differs by this part of it, and of the largest number.
const UNLIKE: f64 = 0.05;

/// Numbers that people write, where what changes with them goes up and down, as a wave does.
const WRITTEN: [f64; 12] =
    [2.0, 0.5, 4.0, 3.0, 0.25, 10.0, 0.1, 8.0, 100.0, 1.5, 5.0, std::f64::consts::FRAC_PI_2];

/// A range that is so many times as long as it begins is one of powers of ten.
const MANY: f64 = 1e6;

/// Steps to a number, at most: so many halvings of the longest range end at the last bits.
const STEPS: usize = 160;

/// The mistakes whose number can be chosen so that they explain every answer, in the conventions `near`. A gradient is
/// asked in `base` with the numbers that the forward answers showed (`suspects`), then for numbers of its own.
pub(crate) fn fitting(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    near: &[Conventions],
    suspects: &[Suspect],
    options: &MarkOptions,
) -> Vec<Hypothesis> {
    let fits =
        |h: &Hypothesis| explains_all(h, question, answers, options) && shows(h, question, answers, options);
    if question.kind == Kind::Vjp {
        let with_number = || suspects.iter().filter(|(_, fitted)| !fitted.is_empty());
        // In conventions too that the forward answers don't show: 1e-10 beside 1 - alpha.
        let unseen = near.iter().filter(|c| forward_is_the_same(question, c, base, options)).take(LIKELIEST);
        for c in std::iter::once(base).chain(unseen) {
            let found: Vec<_> = with_number().map(|suspect| of(suspect, c)).filter(fits).collect();
            if !found.is_empty() {
                return found;
            }
        }
    }
    let own = |m: &&Mistake| m.number.is_some() && m.gradient == (question.kind == Kind::Vjp);
    let mistakes = question.component.mistakes.iter().filter(own);
    let pairs: Vec<_> = mistakes.flat_map(|m| near.iter().map(move |c| (m, c))).collect();
    let smallest = small_cases(question, answers).first().map_or(1, |(case, _)| question.cost(case));
    let likeliest = (ASKED * near.len() / (pairs.len() * smallest).max(1)).max(LIKELIEST);
    let found = parallel::map(pairs.len(), |n| {
        let (mistake, c) = pairs[n];
        let usual = Hypothesis::new(vec![mistake.name], *c);
        let asked = n % near.len() < likeliest || within_reach(mistake, &usual, question, answers);
        asked.then(|| with_its_number(mistake, &usual, question, answers, fits))?
    });
    let own = |h: &Hypothesis| renamed(h, near, question, answers, options).is_none();
    found.into_iter().flatten().filter(own).collect()
}

/// Whether the smallest answers lie between what the numbers of a mistake's range give, so that one of these may give them.
pub(crate) fn within_reach(
    mistake: &Mistake,
    usual: &Hypothesis,
    question: &Question,
    answers: &Answers,
) -> bool {
    let [least, most] = mistake.number.expect("a mistake with a number").range;
    let at = |n: usize| least * crate::math::pow(most / least, n as f64 / (GRID - 1) as f64);
    usable(usual, question, answers).iter().take(CASES).all(|(case, answer)| {
        let with = |n| {
            let h = usual.with_number(at(n));
            let mut all = h.prediction(question, case).0;
            h.leave_open(question, case, answer, &mut all);
            all
        };
        let tried: Vec<Arrays> = (0..GRID).map(with).collect();
        answer.iter().all(|(name, given)| between(name, given, &tried))
    })
}

/// Whether an output lies between these predictions, element by element, and by a part of its size beyond them.
fn between(name: &str, given: &Given, tried: &[Arrays]) -> bool {
    let Some(first) = tried[0].get(name) else { return true };
    let Some((got, _)) = reshaped(&given.values, first.shape()) else { return false };
    if tried.iter().any(|all| all[name].shape() != first.shape()) {
        return true;
    }
    let size = largest_of(&got);
    let mut low = first.clone();
    let mut high = first.clone();
    for all in tried {
        low.zip_mut_with(&all[name], |low, x| {
            *low = if x.is_nan() { f64::NEG_INFINITY } else { low.min(*x) }
        });
        high.zip_mut_with(&all[name], |high, x| {
            *high = if x.is_nan() { f64::INFINITY } else { high.max(*x) }
        });
    }
    let beyond = |((g, low), high): ((&f64, &f64), &f64)| {
        g.is_finite() && (low - g > BEYOND * size || g - high > BEYOND * size)
    };
    !got.iter().zip(&low).zip(&high).any(beyond)
}

/// Mistakes with the numbers that single elements show, which may explain all but so many of the cases.
pub(crate) fn guesses(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    but_for: usize,
) -> Vec<Hypothesis> {
    let all = question.component.mistakes;
    let mistakes: Vec<_> = all.iter().filter(|m| m.number.is_some() && !m.gradient).collect();
    let found = parallel::map(mistakes.len(), |n| {
        let usual = Hypothesis::new(vec![mistakes[n].name], *base);
        let may = contradicted(mistakes[n], &usual, question, answers).nth(but_for).is_none();
        let shown = may.then(|| shown(mistakes[n], &usual, question, answers));
        shown.into_iter().flatten().collect::<Vec<_>>()
    });
    found.into_iter().flatten().collect()
}

fn of((mistakes, fitted): &Suspect, base: &Conventions) -> Hypothesis {
    Hypothesis { fitted: fitted.clone(), ..Hypothesis::new(mistakes.clone(), *base) }
}

/// A mistake, alone or beside others, with a number that fits, where its number may explain every answer.
pub(crate) fn with_its_number(
    mistake: &Mistake,
    usual: &Hypothesis,
    question: &Question,
    answers: &Answers,
    fits: impl Fn(&Hypothesis) -> bool,
) -> Option<Hypothesis> {
    // One alone may be across a threshold.
    let contradicted = contradicted(mistake, usual, question, answers).nth(1);
    contradicted.is_none().then(|| shown(mistake, usual, question, answers).find(|h| fits(h)))?
}

/// The cases whose answer is far from what the mistake gives with several of its numbers, which all give the same. Of those that are listed
/// any may be the only one that gives something else.
fn contradicted<'a>(
    mistake: &Mistake,
    usual: &'a Hypothesis,
    question: &'a Question,
    answers: &'a Answers,
) -> impl Iterator<Item = &'a Case> {
    let Number { usual: own, range: [least, most], listed, .. } =
        mistake.number.expect("a mistake with a number");
    let tried = [least, (least * most).sqrt(), own, most];
    let far = move |(case, answer): &(&Case, &Answer)| {
        let all = tried.map(|x| {
            let h = usual.with_number(x);
            let mut all = h.prediction(question, case).0;
            h.leave_open(question, case, answer, &mut all);
            all
        });
        answer.iter().any(|(name, given)| {
            let Some(first) = all[0].get(name) else { return false };
            let Some((got, _)) = reshaped(&given.values, first.shape()) else { return false };
            let others: Vec<_> = all[1..].iter().filter_map(|other| other.get(name)).collect();
            let least = UNLIKE * largest_of(first);
            let far = |(n, (g, x)): (usize, (&f64, &f64))| {
                let same = |other: &&ArrayD<f64>| other.iter().nth(n) == Some(x);
                (g - x).abs() > UNLIKE * g.abs().max(x.abs()) + least && others.iter().all(same)
            };
            others.iter().all(|other| other.shape() == first.shape())
                && got.iter().zip(first).enumerate().any(far)
        })
    };
    let asked = if listed.is_empty() { usable(usual, question, answers) } else { vec![] };
    asked.into_iter().filter(far).map(|(case, _)| case)
}

/// A mistake, alone or beside others, with the numbers that single elements of the answers show, the likeliest first: what they show
/// rounded to a few digits, as people write it. `usual` is the hypothesis with the usual number.
pub(crate) fn shown<'a>(
    mistake: &Mistake,
    usual: &'a Hypothesis,
    question: &'a Question,
    answers: &'a Answers,
) -> impl Iterator<Item = Hypothesis> + 'a {
    let number = mistake.number.expect("a mistake with a number");
    let mut shown: Vec<f64> = vec![];
    for (case, answer) in usable(usual, question, answers) {
        let at = |x: f64| usual.with_number(x).prediction(question, case).0;
        shown.extend(read_off(&number, at, answer));
        if shown.len() >= ELEMENTS {
            break;
        }
    }
    let rounded = shown.iter().flat_map(|&x| [1, 2, 4].map(|digits| round_to(x, digits)));
    let read = rounded.chain(shown.iter().copied()).chain(powers(number.range));
    let read = read.chain(written(mistake));
    let all: Vec<f64> = read.collect();
    let steps = once_with(move || {
        let asked = |(case, answer)| stepwise::Asked {
            at: Box::new(move |x| usual.with_number(x).prediction(question, case).0),
            answer,
        };
        let cases: Vec<_> = usable(usual, question, answers).into_iter().map(asked).collect();
        stepwise::read_off(&number, &cases)
    });
    all.into_iter().chain(steps.flatten()).map(|x| usual.with_number(x))
}

/// The numbers that people write of those that a mistake can have.
pub(crate) fn written(mistake: &Mistake) -> impl Iterator<Item = f64> + use<> {
    let range = mistake.number.map(|number| number.range);
    let usual =
        WRITTEN.into_iter().filter(move |x| range.is_some_and(|[least, most]| (least..=most).contains(x)));
    mistake.number.map_or(&[][..], |number| number.listed).iter().copied().chain(usual)
}

/// The powers of ten in a range of many: an eps is one, and where it shows is in few elements.
fn powers([least, most]: [f64; 2]) -> impl Iterator<Item = f64> {
    let many = most / least >= MANY;
    let power = |n: i32| format!("1e{n}").parse::<f64>().expect("a number");
    (-20..=0).rev().map(power).filter(move |x| many && (least..=most).contains(x))
}

/// The number at which the element that changes most over the range is what was answered, in each output of a case.
fn read_off(number: &Number, at: impl Fn(f64) -> Arrays, answer: &Answer) -> Vec<f64> {
    let [least, most] = number.range;
    let (low, high) = (at(least), at(most));
    let of_output = |(name, low): (&String, &ArrayD<f64>)| {
        let high = high.get(name).filter(|high| high.shape() == low.shape())?;
        let (got, _) = reshaped(&answer.get(name)?.values, low.shape())?;
        let between = |g: f64, l: f64, h: f64| l.is_finite() && h.is_finite() && (l - g) * (h - g) < 0.0;
        let elements = got.iter().zip(low).zip(high).enumerate();
        let inside = elements.filter(|(_, ((g, l), h))| between(**g, **l, **h));
        let (index, ((&g, &l), &h)) = inside
            .max_by(|(_, ((_, a), b)), (_, ((_, c), d))| (*b - *a).abs().total_cmp(&(*d - *c).abs()))?;
        let element = |x: f64| at(x)[name].iter().nth(index).copied().unwrap_or(f64::NAN);
        Some(crossing([least, most], [l - g, h - g], g.abs(), |x| element(x) - g))
    };
    low.iter().filter_map(of_output).collect()
}

/// Where a function changes its sign that has these values at the ends of a range, on a logarithmic scale: numbers like 1e-8 are as likely as
/// those like 0.5. By false position, the Illinois way; every third step halves, as what jumps has no slope. A value below the last
/// bit of `small` counts as 0.
fn crossing(range: [f64; 2], [mut below, mut above]: [f64; 2], small: f64, f: impl Fn(f64) -> f64) -> f64 {
    let [mut low, mut high] = range.map(ln);
    let rising = above > 0.0;
    let mut moved_low = None;
    for step in 0..STEPS {
        let middle = 0.5 * (low + high);
        let straight = low - below * (high - low) / (above - below);
        let x = if step % 3 == 2 || straight <= low || straight >= high { middle } else { straight };
        let value = f(exp(x));
        if value.abs() <= f64::EPSILON * small || x <= low || x >= high {
            return exp(x);
        }
        let lower = if value.is_nan() { false } else { (value < 0.0) == rising };
        // An end that stays is believed half as much each time.
        match (lower, moved_low) {
            (true, Some(true)) => above *= 0.5,
            (false, Some(false)) => below *= 0.5,
            _ => {}
        }
        moved_low = Some(lower);
        if lower {
            (low, below) = (x, value);
        } else {
            (high, above) = (x, if value.is_nan() { above } else { value });
        }
    }
    exp(0.5 * (low + high))
}

/// x with so many decimal digits.
fn round_to(x: f64, digits: i32) -> f64 {
    format!("{x:.*e}", (digits - 1) as usize).parse().unwrap_or(x)
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::convention::CS180;

    /// What is fitted where a row's answers have this mistake with this number.
    pub(in crate::judge) fn found(
        component: &str,
        dtype: Dtype,
        mistake: &str,
    ) -> Vec<(Vec<&'static str>, Vec<f64>)> {
        found_in(0, component, dtype, mistake)
    }

    /// The same in one direction: 0 forward, 1 back.
    fn found_in(
        direction: usize,
        component: &str,
        dtype: Dtype,
        mistake: &str,
    ) -> Vec<(Vec<&'static str>, Vec<f64>)> {
        let exam = Exam::new(component, dtype, None).unwrap();
        let (question, options) = (&exam.questions[direction], MarkOptions { dtype, exp_ulp: 4.0 });
        let answers = answered(question, dtype, &[mistake]);
        fitting(question, &answers, &CS180, &[CS180], &[], &options)
            .into_iter()
            .map(|h| (h.mistakes, h.fitted))
            .collect()
    }

    /// What answers with these mistakes are, in a type.
    pub(in crate::judge) fn answered(question: &Question, dtype: Dtype, mistakes: &[&str]) -> Answers {
        let round =
            |arrays: Arrays| arrays.into_iter().map(|(name, a)| (name, a.mapv(|x| dtype.round(x)))).collect();
        let answer = |case: &Case| {
            let wrong = question.component.direction(question.kind).unwrap().wrong;
            Some(given(round(wrong(&case.inputs, &CS180, mistakes))))
        };
        question.cases.iter().map(answer).collect()
    }

    #[test]
    fn numbers_are_read_off_the_answers() {
        for (component, mistake, number) in [
            ("volume_render", "scaled_exponential", 0.98),
            ("sample_along_rays", "jitter_width", 0.37),
            ("pixel_to_ray", "focal_scaled", 1.5),
            ("mlp", "leaky_units", 0.2),
            ("ray_aabb", "eps_in_direction", 1e-4),
            ("ndc_rays", "eps_in_depth", 1e-4),
            ("sample_along_rays", "jitter_about_grid", 2e-3),
            ("volume_render", "weights_normalized", 1e-5),
            ("volume_render", "divided_by_opacity", 1e-3),
        ] {
            for dtype in [Dtype::F64, Dtype::F32] {
                let found = found(component, dtype, &format!("{mistake}={number}"));
                assert!(found.contains(&(vec![mistake], vec![number])), "{component} {dtype}: {found:?}");
            }
        }
    }

    /// What is smooth, and what jumps.
    #[test]
    fn a_crossing_is_found_to_the_last_bits() {
        let range = [1e-12, 1e6];
        for root in [3e-9, 0.123_456_789_012_345_6, 1e5] {
            let check = |name: &str, f: &dyn Fn(f64) -> f64| {
                let found = crossing(range, range.map(f), 0.0, f);
                assert!((found / root - 1.0).abs() < 1e-13, "{name} at {root}: {found}");
            };
            check("straight", &|x| x - root);
            check("falling", &|x| root - x);
            check("saturating", &|x| x / (x + root) - 0.5);
            check("a step", &|x| if x < root { -1.0 } else { 5.0 });
        }
    }

    #[test]
    fn a_gradient_has_numbers_of_its_own() {
        for dtype in [Dtype::F64, Dtype::F32] {
            let found = found_in(1, "trunc_exp", dtype, "limits_of_its_own=1e5");
            assert_eq!(found, [(vec!["limits_of_its_own"], vec![1e5])], "{dtype}");
        }
    }

    #[test]
    fn no_number_is_read_off_another_mistake() {
        assert_eq!(found("volume_render", Dtype::F64, "delta_missing"), []);
        assert_eq!(found("pixel_to_ray", Dtype::F64, "center_swapped"), []);
    }
}
