//! Mistakes that are seen more often than the one that was found, and that explain the answers with a number of their own.

use super::super::answer::Answers;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::evidence::{explains_all, shows};
use super::fitted::with_its_number;
use super::hypothesis::Hypothesis;
use crate::contract::component::Mistake;

/// Mistakes that are seen more often than one that explains the answers with its usual number, with a number of the same meaning that
/// does, too: all rays may end at 1e-2, and so may each by itself at 1e-3.
pub(super) fn commoner(
    found: &[Hypothesis],
    question: &Question,
    answers: &Answers,
    options: &MarkOptions,
) -> Vec<Hypothesis> {
    let fits =
        |h: &Hypothesis| explains_all(h, question, answers, options) && shows(h, question, answers, options);
    let all = question.component.mistakes;
    let row = |h: &Hypothesis| all.iter().find(|m| *h.mistakes == [m.name]);
    let name = |m: &Mistake| m.number.map(|number| number.name);
    let rivals = |h: &Hypothesis| -> Vec<Hypothesis> {
        let Some(own) = row(h).filter(|own| own.number.is_some()) else { return vec![] };
        let known = |m: &Mistake| found.iter().any(|h| *h.mistakes == [m.name]);
        let rivals = all.iter().filter(|m| name(m) == name(own) && m.gradient == own.gradient);
        let usual = |m: &Mistake| Hypothesis::new(vec![m.name], h.conventions);
        rivals
            .filter(|m| m.count > own.count && !known(m))
            .filter_map(|m| with_its_number(m, &usual(m), question, answers, fits))
            .collect()
    };
    found.iter().flat_map(rivals).collect()
}
