//! Sets of mistakes that are tried together.

use super::super::exam::Question;
use super::evidence::Suspect;
use crate::contract::check::Kind;
use crate::contract::component::Mistake;

/// Sets of `count` mistakes that this direction can show; pairs in both orders, as their effects needn't commute.
pub(super) fn sets(
    question: &Question,
    count: usize,
    suspects: &[Suspect],
    settled: bool,
) -> Vec<Vec<&'static str>> {
    // Three and more come from the forward answers alone.
    let mut suspected: Vec<_> = suspects
        .iter()
        .filter(|(set, fitted)| fitted.is_empty() && (set.len() == count || count == 2 && set.len() > 2))
        .map(|(set, _)| set.clone())
        .collect();
    // A gradient has no mistake of the forward function that the forward answers don't show, where these are explained.
    let listed = |m: &Mistake| suspects.iter().any(|(set, _)| set.contains(&m.name));
    let follows = |m: &Mistake| !settled || suspects.is_empty() || listed(m);
    let shown =
        |m: &&Mistake| if question.kind == Kind::Vjp { m.gradient || follows(m) } else { !m.gradient };
    let names: Vec<_> = question.component.mistakes.iter().filter(shown).map(|m| m.name).collect();
    // Numeric gradients of pairs would take minutes: of the forward function's mistakes only pairs that its answers suggest.
    let own = |m: &&Mistake| question.kind == Kind::Forward || m.gradient;
    let own: Vec<_> = question.component.mistakes.iter().filter(own).filter(shown).map(|m| m.name).collect();
    let sets: Vec<Vec<&'static str>> = match count {
        0 => vec![vec![]],
        1 => names.iter().map(|name| vec![*name]).collect(),
        _ => {
            let others = |a| own.iter().filter(move |b| **b != a).map(move |b| vec![a, *b]);
            own.iter().flat_map(|a| others(*a)).collect()
        }
    };
    suspected.dedup();
    let others: Vec<_> = sets.into_iter().filter(|set| !suspected.contains(set)).collect();
    suspected.extend(others);
    suspected
}
