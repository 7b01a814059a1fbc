//! What slips of arrays and of formulas share: the conventions they are tried in, whether one was made, and what is said of it.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

use super::super::super::answer::Answers;
use super::super::super::assignment::nearest;
use super::super::super::exam::Question;
use super::super::super::mark::MarkOptions;
use super::super::super::partial::{apply, changes, partial};
use super::super::evidence::{Explanation, difference, explains_all, largest_residual, shows, usable};
use super::super::hypothesis::Hypothesis;
use crate::convention::Conventions;
use crate::convention::profiles::PROFILES;

/// Explanations that are listed.
const SHOWN: usize = 3;

/// Whether a hypothesis explains the answers, and some of them show it.
pub(crate) fn was_done(
    h: &Hypothesis,
    question: &Question,
    answers: &Answers,
    options: &MarkOptions,
) -> bool {
    let fits = || explains_all(h, question, answers, options) && shows(h, question, answers, options);
    attempt(fits).unwrap_or(false)
}

thread_local! {
    static ATTEMPTING: Cell<bool> = const { Cell::new(false) };
}

/// What wrong code says. On changed inputs it may break a rule that only right code keeps: then it says nothing, and nobody needs to read
/// of it. (The process' panic hook is asked as before for everything else.)
pub(crate) fn attempt<T>(wrong: impl FnOnce() -> T) -> Option<T> {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !ATTEMPTING.get() {
                before(info);
            }
        }));
    });
    let outer = ATTEMPTING.replace(true);
    let said = panic::catch_unwind(AssertUnwindSafe(wrong)).ok();
    ATTEMPTING.set(outer);
    said
}

/// The run's conventions, those in which most elements agree, and those of known programs.
pub(crate) fn conventions(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Conventions> {
    let own = |c: &Conventions| partial(question.component, c);
    let known = PROFILES.iter().map(|p| apply(&own(&p.conventions), base));
    let mut all: Vec<Conventions> = vec![];
    for c in [*base, nearest(question, answers, base, options)].into_iter().chain(known) {
        if question.admits(&c) && !all.iter().any(|other| own(other) == own(&c)) {
            all.push(c);
        }
    }
    all
}

/// The first few, the fewest mistakes and changes of conventions first.
pub(crate) fn explanations(
    mut found: Vec<Hypothesis>,
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Explanation> {
    let own = |c: &Conventions| partial(question.component, c);
    found.sort_by_key(|h| (h.mistakes.len(), changes(&own(&h.conventions), &own(base))));
    found.truncate(SHOWN);
    let Some(best) = found.first().cloned() else { return vec![] };
    let same = |h: &Hypothesis| {
        usable(h, question, answers).iter().all(|(case, _)| best.same_as(h, question, case, options))
    };
    let row = |name: &str| question.component.mistakes.iter().find(|m| m.name == name);
    let one = |(n, h): (usize, &Hypothesis)| Explanation {
        mistakes: h.mistakes.iter().filter_map(|name| row(name)).collect(),
        fitted: h.fitted.clone(),
        conventions: difference(&own(&h.conventions), &own(base)),
        residual: largest_residual(h, question, answers, options),
        same_as_best: n > 0 && same(h),
        slip: h.slip.clone(),
        ..Explanation::default()
    };
    found.iter().enumerate().map(one).collect()
}
