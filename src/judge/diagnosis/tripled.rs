//! Triples: three mistakes at once, in the conventions that are likeliest. Where two of them leave nothing that is right, nothing points to
//! the third; but most are ruled out by a first small case, so that all of a row's are tried where it has no more than some hundred.

use super::super::answer::Answers;
use super::super::assignment::{nearest, open, small_cases};
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::partial::apply;
use super::evidence::{explains_all, real_numbers, shows};
use super::hypothesis::Hypothesis;
use crate::convention::Conventions;
use crate::parallel;

/// Elements that all triples together may compute on the smallest case.
const WORK: usize = 20_000_000;

/// The triples of mistakes that explain every answer, in the first conventions in which some do. Short types have too few digits to tell so
/// many apart.
pub(crate) fn tripled(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Hypothesis> {
    let cases = small_cases(question, answers);
    // Of bits and counts three of many explain a few cases by chance.
    let told = options.dtype.bits() >= 24 && real_numbers(question, answers);
    let Some((case, _)) = cases.first().filter(|_| told) else { return vec![] };
    let all = question.component.mistakes.iter().filter(|m| !m.gradient);
    let names: Vec<&str> = all.map(|m| m.name).collect();
    let count = names.len() * names.len().saturating_sub(1) * names.len().saturating_sub(2) / 6;
    let cost = question.cost(case);
    let most = WORK / (cost * count.max(1));
    if most == 0 {
        return vec![];
    }
    let mut sets = vec![];
    for (a, first) in names.iter().enumerate() {
        for (b, second) in names.iter().enumerate().take(a) {
            sets.extend(names[..b].iter().map(|third| [*third, *second, *first]));
        }
    }
    let fits =
        |h: &Hypothesis| explains_all(h, question, answers, options) && shows(h, question, answers, options);
    // What two of them explain alone is no matter of three: an inert one can stand beside any pair.
    let fewest = |h: Hypothesis| -> Vec<Hypothesis> {
        let without = |n: usize| {
            let mut pair = h.clone();
            pair.mistakes.remove(n);
            pair
        };
        let pairs: Vec<Hypothesis> = (0..3).map(without).filter(|pair| fits(pair)).collect();
        if pairs.is_empty() { vec![h] } else { pairs }
    };
    for c in likeliest(question, answers, base, options, most) {
        let tried = parallel::map(sets.len(), |n| {
            let h = Hypothesis::new(sets[n].to_vec(), c);
            fits(&h).then_some(h)
        });
        let mut found: Vec<Hypothesis> = vec![];
        for h in tried.into_iter().flatten().flat_map(fewest) {
            // A pair comes once with every inert one.
            if !found.contains(&h) {
                found.push(h);
            }
        }
        let least = found.iter().map(|h| h.mistakes.len()).min();
        found.retain(|h| Some(h.mistakes.len()) == least);
        if !found.is_empty() {
            return found;
        }
    }
    vec![]
}

/// The run's own conventions, those in which most elements agree, and those that are open, the nearest first: so many.
fn likeliest(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
    most: usize,
) -> Vec<Conventions> {
    let first = [*base, nearest(question, answers, base, options)];
    let open = open(question, answers, base, options).into_iter().map(|p| apply(&p, base));
    let second = first[1..].iter().copied().filter(|c| *c != *base);
    let rest = open.filter(|c| !first.contains(c));
    let all = first[..1].iter().copied().chain(second).chain(rest);
    all.filter(|c| question.admits(c)).take(most).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::convention::CS180;

    /// What is found in a row's answers with these mistakes, in one convention other than the run's.
    fn found(
        row: &str,
        (key, value): (&str, &str),
        mistakes: &[&str],
        dtype: Dtype,
    ) -> Vec<Vec<&'static str>> {
        let exam = Exam::new(row, dtype, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype, exp_ulp: 4.0 });
        let c = CS180.with(key, value).unwrap();
        let answer = |inputs| {
            let wrong = (question.component.forward.wrong)(inputs, &c, mistakes);
            Some(given(wrong.into_iter().map(|(name, a)| (name, a.mapv(|x| dtype.round(x)))).collect()))
        };
        let answers: Answers = question.cases.iter().map(|case| answer(&case.inputs)).collect();
        let mut all: Vec<_> =
            tripled(question, &answers, &CS180, &options).into_iter().map(|h| h.mistakes).collect();
        all.iter_mut().for_each(|names| names.sort_unstable());
        all
    }

    #[test]
    fn three_are_found_where_there_are_digits_enough() {
        let three = ["half_size_forgotten", "near_taken_as_one", "origin_not_moved"];
        let found = |dtype| found("ndc_rays", ("ndc_depth", "positive"), &three, dtype);
        assert_eq!(found(Dtype::F64), [three]);
        assert_eq!(found(Dtype::F32), [three]);
        assert!(found(Dtype::Bf16).is_empty());
    }

    /// Beside `every_power` most others do nothing.
    #[test]
    fn two_are_never_three() {
        let two = ["every_power", "last_two_dropped"];
        assert_eq!(found("fisheye_distort", ("axes", "opencv"), &two, Dtype::F64), [two]);
    }
}
