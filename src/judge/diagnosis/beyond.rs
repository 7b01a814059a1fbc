//! What explains answers that no mistake of the catalogue explains, nor two of them: slips, other formulas, several mistakes at once, and what
//! is known of most cases or of some outputs.

use super::super::answer::Answers;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::partial::partial;
use super::climb::climbed;
use super::evidence::{Explanation, Suspect};
use super::fitted_pairs::{beside, fitting_pairs};
use super::lawful::Search;
use super::mostly::mostly;
use super::nearness::likely;
use super::paired::paired;
use super::peel::with_numbers;
use super::ranked::ranked;
use super::slips::misdone::{misdone_at_once, slips_alone};
use super::slips::of_arrays::{Beside, slipped};
use super::tripled::tripled;
use crate::contract::check::Kind;
use crate::convention::Conventions;

/// Conventions in which pairs with a number are looked for first.
const LIKELY: usize = 8;

/// What no catalogue lists, what is known of most cases, both, and what is known of some outputs (`parted`); several mistakes in
/// conventions nearby (`near`).
pub(super) fn beyond(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    suspects: &[Suspect],
    options: &MarkOptions,
    near: &[Conventions],
    parted: Option<Explanation>,
) -> Vec<Explanation> {
    let home = partial(question.component, base);
    let slips = slips_alone(question, answers, base, options);
    if !slips.is_empty() {
        return slips;
    }
    let formulas = Search::new(question, answers, base, options);
    let laws = formulas.as_ref().map_or(vec![], Search::in_one_part);
    if !laws.is_empty() {
        return laws;
    }
    if question.kind == Kind::Forward {
        // By turns: those that change least hide what a program follows beside them.
        let likely = likely(LIKELY, (question, answers), base, options);
        let turns = (0..near.len().max(likely.len())).flat_map(|n| [near.get(n), likely.get(n)]);
        let near: Vec<Conventions> = turns.flatten().copied().collect();
        let fitted = fitting_pairs(question, answers, &near, options);
        let pairs = if fitted.is_empty() { paired(question, answers, base, options) } else { fitted };
        if !pairs.is_empty() {
            return ranked(pairs, question, answers, &home, options);
        }
    }
    let laws = formulas.as_ref().map_or(vec![], Search::all);
    if laws.first().is_some_and(Explanation::whole) {
        return laws;
    }
    if question.kind == Kind::Forward {
        let triples = tripled(question, answers, base, options);
        if !triples.is_empty() {
            return ranked(triples, question, answers, &home, options);
        }
    }
    let several = climbed(question, answers, base, options);
    if !several.is_empty() {
        return ranked(several, question, answers, &home, options);
    }
    // All but edge cases.
    if !laws.is_empty() {
        return laws;
    }
    let most = mostly(question, answers, base, suspects, options);
    let pairs =
        most.iter().flat_map(|most| beside(most, base, question, answers, options)).collect::<Vec<_>>();
    if !pairs.is_empty() {
        return ranked(pairs, question, answers, &home, options);
    }
    let formula = formulas.as_ref().and_then(Search::most_cases);
    let left = |e: &Explanation| e.unexplained_cases.len();
    let fewer = |formula: &Explanation| most.as_ref().is_none_or(|most| left(formula) < left(most));
    if let Some(formula) = formula.filter(fewer) {
        return vec![formula];
    }
    if let Some(named) = most.clone().filter(|e| parted.is_none() && e.wrong()) {
        return vec![named];
    }
    let slips = slipped(question, answers, base, options, Beside::Mistake);
    let slips = if slips.is_empty() { misdone_at_once(question, answers, base, options) } else { slips };
    if !slips.is_empty() {
        return slips;
    }
    let parted = parted.map(|found| with_numbers(found, question, answers, base, options));
    parted.or(most).into_iter().collect()
}
