//! Fitting: the number in a mistake that everybody chooses for herself, found from the answers themselves and then held against all of
//! them.

use ndarray::ArrayD;

use super::answer::{Answer, Answers, reshaped};
use super::evidence::{Suspect, explains_all, shows, usable};
use super::exam::Question;
use super::hypothesis::Hypothesis;
use super::mark::MarkOptions;
use crate::contract::arrays::Arrays;
use crate::contract::check::Kind;
use crate::contract::component::{Mistake, Number};
use crate::convention::Conventions;
use crate::parallel;

/// Elements that a number is read off.
const ELEMENTS: usize = 5;

/// Halvings of its range: to the last bit of f32, and then some.
const HALVINGS: usize = 80;

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
        let with_number = suspects.iter().filter(|(_, fitted)| fitted.is_some());
        let found: Vec<_> = with_number.map(|suspect| of(suspect, base)).filter(fits).collect();
        if !found.is_empty() {
            return found;
        }
    }
    let own = |m: &&Mistake| m.number.is_some() && m.gradient == (question.kind == Kind::Vjp);
    let mistakes = question.component.mistakes.iter().filter(own);
    let pairs: Vec<_> = mistakes.flat_map(|m| near.iter().map(move |c| (m, c))).collect();
    let found = parallel::map(pairs.len(), |n| {
        let (mistake, c) = pairs[n];
        candidates(mistake, question, answers, c).into_iter().find(|h| fits(h))
    });
    found.into_iter().flatten().collect()
}

/// Mistakes with the numbers that single elements show, whether or not these explain all answers.
pub(crate) fn guesses(question: &Question, answers: &Answers, base: &Conventions) -> Vec<Hypothesis> {
    let mistakes = question.component.mistakes.iter().filter(|m| m.number.is_some() && !m.gradient);
    mistakes.flat_map(|mistake| candidates(mistake, question, answers, base)).collect()
}

fn of((mistakes, fitted): &Suspect, base: &Conventions) -> Hypothesis {
    Hypothesis { fitted: *fitted, ..Hypothesis::new(mistakes.clone(), *base) }
}

/// One mistake with the numbers that single elements of the answers show, the likeliest first: what they show rounded to a few digits,
/// as people write it.
fn candidates(
    mistake: &Mistake,
    question: &Question,
    answers: &Answers,
    base: &Conventions,
) -> Vec<Hypothesis> {
    let number = mistake.number.expect("a mistake with a number");
    let usual = of(&(vec![mistake.name], None), base);
    let mut shown: Vec<f64> = vec![];
    for (case, answer) in usable(&usual, question, answers) {
        let at = |x: f64| Hypothesis { fitted: Some(x), ..usual.clone() }.prediction(question, case).0;
        shown.extend(read_off(&number, at, answer));
        if shown.len() >= ELEMENTS {
            break;
        }
    }
    let rounded = shown.iter().flat_map(|&x| [2, 4].map(|digits| round_to(x, digits)));
    rounded.chain(shown.iter().copied()).map(|x| Hypothesis { fitted: Some(x), ..usual.clone() }).collect()
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
        let (index, ((&g, &l), _)) = inside
            .max_by(|(_, ((_, a), b)), (_, ((_, c), d))| (*b - *a).abs().total_cmp(&(*d - *c).abs()))?;
        let element = |x: f64| at(x)[name].iter().nth(index).copied().unwrap_or(f64::NAN);
        Some(halved([least, most], |x| (element(x) - g) * (l - g) > 0.0))
    };
    low.iter().filter_map(of_output).collect()
}

/// Where `below` ends, on a logarithmic scale: numbers like 1e-8 are as likely as those like 0.5.
fn halved([mut low, mut high]: [f64; 2], below: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = (low * high).sqrt();
        if below(middle) { low = middle } else { high = middle }
    }
    (low * high).sqrt()
}

/// x with so many decimal digits.
fn round_to(x: f64, digits: i32) -> f64 {
    format!("{x:.*e}", (digits - 1) as usize).parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::super::answer::given;
    use super::super::exam::Exam;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::case::Case;
    use crate::convention::CS180;

    /// What is fitted where a row's answers have this mistake with this number.
    fn found(component: &str, dtype: Dtype, mistake: &str) -> Vec<(Vec<&'static str>, Option<f64>)> {
        found_in(0, component, dtype, mistake)
    }

    /// The same in one direction: 0 forward, 1 back.
    fn found_in(
        direction: usize,
        component: &str,
        dtype: Dtype,
        mistake: &str,
    ) -> Vec<(Vec<&'static str>, Option<f64>)> {
        let exam = Exam::new(component, dtype, None).unwrap();
        let question = &exam.questions[direction];
        let round =
            |arrays: Arrays| arrays.into_iter().map(|(name, a)| (name, a.mapv(|x| dtype.round(x)))).collect();
        let answer = |case: &Case| {
            let wrong = question.component.direction(question.kind).unwrap().wrong;
            Some(given(round(wrong(&case.inputs, &CS180, &[mistake]))))
        };
        let answers: Answers = question.cases.iter().map(answer).collect();
        let options = MarkOptions { dtype, exp_ulp: 4.0 };
        fitting(question, &answers, &CS180, &[CS180], &[], &options)
            .into_iter()
            .map(|h| (h.mistakes, h.fitted))
            .collect()
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
        ] {
            for dtype in [Dtype::F64, Dtype::F32] {
                let found = found(component, dtype, &format!("{mistake}={number}"));
                assert!(found.contains(&(vec![mistake], Some(number))), "{component} {dtype}: {found:?}");
            }
        }
    }

    #[test]
    fn a_gradient_has_numbers_of_its_own() {
        for dtype in [Dtype::F64, Dtype::F32] {
            let found = found_in(1, "trunc_exp", dtype, "limits_of_its_own=1e5");
            assert_eq!(found, [(vec!["limits_of_its_own"], Some(1e5))], "{dtype}");
        }
    }

    #[test]
    fn no_number_is_read_off_another_mistake() {
        assert_eq!(found("volume_render", Dtype::F64, "delta_missing"), []);
        assert_eq!(found("pixel_to_ray", Dtype::F64, "center_swapped"), []);
    }
}
