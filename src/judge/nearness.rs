//! Conventions by how near to the answers the right formula is in them: where a row has thousands, those that change least aren't those that a
//! program follows, and a mistake hides none of them from all answers.

use super::answer::Answers;
use super::assignment::small_cases;
use super::climb::distance;
use super::exam::Question;
use super::hypothesis::Hypothesis;
use super::mark::MarkOptions;
use super::partial::{Partial, apply};
use crate::convention::Conventions;
use crate::parallel;

/// The smallest cases go by this many.
const CASES: usize = 3;

/// Elements that all of them together may compute.
const WORK: usize = 100_000_000;

/// The `kept` likeliest ones: by turns those that change least, which come first in `all`, and those in which the answers are nearest. All as
/// they are where there are no more.
pub(super) fn likeliest(
    mut all: Vec<Partial>,
    kept: usize,
    (question, answers): (&Question, &Answers),
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Partial> {
    let mut cases = small_cases(question, answers);
    cases.retain(|(case, _)| case.finite());
    cases.truncate(CASES);
    if all.len() <= kept || cases.is_empty() {
        all.truncate(kept);
        return all;
    }
    let cost: usize = cases.iter().map(|(case, _)| question.cost(case)).sum();
    all.truncate((WORK / cost.max(1)).max(kept));
    let off = parallel::map(all.len(), |n| {
        distance(&Hypothesis::new(vec![], apply(&all[n], base)), question, &cases, options.dtype)
    });
    let mut nearest: Vec<usize> = (0..all.len()).collect();
    nearest.sort_by(|a, b| off[*a].total_cmp(&off[*b]));
    let mut chosen: Vec<usize> = vec![];
    for n in nearest.into_iter().enumerate().flat_map(|(least, nearest)| [least, nearest]) {
        if chosen.len() < kept && !chosen.contains(&n) {
            chosen.push(n);
        }
    }
    chosen.into_iter().map(|n| all[n].clone()).collect()
}
