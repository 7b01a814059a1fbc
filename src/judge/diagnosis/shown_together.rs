//! What the statistics of all answers show, in the conventions in which least is wrong.

use super::super::answer::Answers;
use super::super::assignment::assignments;
use super::super::exam::Question;
use super::super::partial::{Partial, apply, partial};
use super::super::statistics::{mistakes, plausible};
use super::evidence::{Explanation, difference};
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::parallel;

/// An explanation for each mistake. Where nothing is wrong in some conventions it is the run that disagrees; what keeps all else from being
/// asked comes last.
pub(super) fn shown_together(question: &Question, answers: &Answers, base: &Conventions) -> Vec<Explanation> {
    let all = assignments(question.component, base);
    let home = partial(question.component, base);
    let told = |mistakes: Vec<&'static Mistake>, p: &Partial| Explanation {
        mistakes,
        conventions: difference(p, &home),
        ..Explanation::default()
    };
    if let Some(p) = all.iter().find(|p| plausible(question, answers, &apply(p, base))) {
        return if *p == home { vec![] } else { vec![told(vec![], p)] };
    }
    let last_word = question.component.special.statistics.map_or("", |statistics| statistics.last_word);
    let each = parallel::map(all.len(), |n| mistakes(question, answers, &apply(&all[n], base)));
    let wrong = each.into_iter().zip(&all).filter(|(found, _)| !found.is_empty());
    let rank = |(found, _): &(Vec<&Mistake>, &Partial)| {
        (found.iter().any(|mistake| mistake.name == last_word), found.len())
    };
    let Some((found, p)) = wrong.min_by_key(rank) else { return vec![] };
    found.into_iter().map(|mistake| told(vec![mistake], p)).collect()
}
