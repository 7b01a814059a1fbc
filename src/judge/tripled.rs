//! Triples: three mistakes at once, all that there are, in the conventions that are likeliest. Where two of them leave nothing that is
//! right, nothing points to the third; but most are ruled out by a first small case.

use super::answer::Answers;
use super::assignment::{nearest, open, small_cases};
use super::evidence::{explains_all, real_numbers, shows};
use super::exam::Question;
use super::hypothesis::Hypothesis;
use super::mark::MarkOptions;
use super::partial::apply;
use crate::convention::Conventions;
use crate::parallel;

/// Elements that all triples together may compute on the smallest case, and what each costs beside.
const WORK: usize = 20_000_000;
const LEAST: usize = 100;

/// The triples of mistakes that explain every answer, in the first conventions in which some do.
pub(crate) fn tripled(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Hypothesis> {
    let cases = small_cases(question, answers);
    // Of bits and counts three of many explain a few cases by chance.
    let Some((case, _)) = cases.first().filter(|_| real_numbers(question, answers)) else { return vec![] };
    let all = question.component.mistakes.iter().filter(|m| !m.gradient);
    let names: Vec<&str> = all.map(|m| m.name).collect();
    let mut sets = vec![];
    for (a, first) in names.iter().enumerate() {
        for (b, second) in names.iter().enumerate().take(a) {
            sets.extend(names[..b].iter().map(|third| [*third, *second, *first]));
        }
    }
    let cost = LEAST + case.inputs.values().map(|a| a.len()).sum::<usize>();
    let most = WORK / (cost * sets.len().max(1));
    let fits =
        |h: &Hypothesis| explains_all(h, question, answers, options) && shows(h, question, answers, options);
    for c in likeliest(question, answers, base, options).into_iter().take(most) {
        let tried = parallel::map(sets.len(), |n| {
            let h = Hypothesis::new(sets[n].to_vec(), c);
            fits(&h).then_some(h)
        });
        let found: Vec<Hypothesis> = tried.into_iter().flatten().collect();
        if !found.is_empty() {
            return found;
        }
    }
    vec![]
}

/// The run's own conventions, those in which most elements agree, and all that are open, the nearest first.
fn likeliest(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Conventions> {
    let open = open(question, answers, base, options).into_iter().map(|p| apply(&p, base));
    let mut all = vec![];
    for c in [*base, nearest(question, answers, base, options)].into_iter().chain(open) {
        if question.admits(&c) && !all.contains(&c) {
            all.push(c);
        }
    }
    all
}
