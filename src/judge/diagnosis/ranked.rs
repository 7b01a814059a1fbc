//! Explanations in order, best first: fewest mistakes, then fewest conventions, then most often seen.

use super::super::answer::Answers;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::partial::{Partial, changes, partial};
use super::evidence::{Explanation, difference, largest_residual, usable};
use super::hypothesis::Hypothesis;
use crate::contract::arrays::Arrays;
use crate::convention::Conventions;

/// The largest number of explanations that are listed.
const SHOWN: usize = 8;

/// What explains the answers, ranked; conventions as they differ from `home`.
pub(super) fn ranked(
    mut fitting: Vec<Hypothesis>,
    question: &Question,
    answers: &Answers,
    home: &Partial,
    options: &MarkOptions,
) -> Vec<Explanation> {
    let row =
        |name: &str| question.component.mistakes.iter().find(|m| m.name == name).expect("its own mistake");
    let moved = |h: &Hypothesis| changes(&partial(question.component, &h.conventions), home);
    let residual = |h: &Hypothesis| largest_residual(h, question, answers, options);
    // Conventions that a mistake hides need no check: the same numbers, bit for bit, with fewer changes.
    fitting.sort_by_key(moved);
    let mut seen: Vec<(Hypothesis, Vec<Arrays>)> = vec![];
    fitting.retain(|h| {
        let now: Vec<Arrays> =
            usable(h, question, answers).iter().map(|(case, _)| h.prediction(question, case).0).collect();
        let hidden =
            seen.iter().any(|(t, had)| t.mistakes == h.mistakes && moved(t) < moved(h) && *had == now);
        seen.extend((!hidden).then(|| (h.clone(), now)));
        !hidden
    });
    let mut rows: Vec<(Hypothesis, f64)> =
        fitting.drain(..).map(|h| (residual(&h), h)).map(|(r, h)| (h, r)).collect();
    rows.sort_by(|(a, ra), (b, rb)| {
        let seen = |h: &Hypothesis| h.mistakes.iter().map(|name| row(name).count).sum::<u32>();
        let mistakes = |h: &Hypothesis| h.mistakes.len();
        // What leaves elements open explains more than what names them.
        let open = |h: &Hypothesis| h.mistakes.iter().filter(|name| row(name).open).count();
        mistakes(a)
            .cmp(&mistakes(b))
            .then(moved(a).cmp(&moved(b)))
            .then(open(a).cmp(&open(b)))
            .then(seen(b).cmp(&seen(a)))
            .then(ra.total_cmp(rb))
    });
    // The two orders of a pair are one explanation.
    let mut known: Vec<(Vec<&str>, Conventions)> = vec![];
    rows.retain(|(h, _)| {
        let mut key = (h.mistakes.clone(), h.conventions);
        key.0.sort_unstable();
        let new = !known.contains(&key);
        known.push(key);
        new
    });
    // A change of convention that these mistakes hide has no effect: the same mistakes with fewer changes rank before it.
    let predicts_same = |a: &Hypothesis, b: &Hypothesis| {
        usable(b, question, answers).iter().all(|(case, _)| a.same_as(b, question, case, options))
    };
    let mut shown: Vec<Hypothesis> = vec![];
    rows.retain(|(h, _)| {
        // This many are enough to choose from; a mistake that equals a convention stays listed.
        let new = shown.len() < SHOWN
            && !shown.iter().any(|t| t.mistakes == h.mistakes && moved(t) < moved(h) && predicts_same(h, t));
        if new {
            shown.push(h.clone());
        }
        new
    });
    let Some((best, _)) = rows.first().cloned() else { return vec![] };
    rows.iter()
        .enumerate()
        .map(|(n, (h, residual))| Explanation {
            mistakes: h.mistakes.iter().map(|name| row(name)).collect(),
            fitted: h.fitted.clone(),
            conventions: difference(&partial(question.component, &h.conventions), home),
            residual: *residual,
            same_as_best: n > 0 && predicts_same(h, &best),
            ..Explanation::default()
        })
        .collect()
}
