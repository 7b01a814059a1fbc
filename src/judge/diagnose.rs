//! Diagnosis: which conventions and which mistakes explain the answers of a component that failed.

use super::answer::Answers;
use super::assignment::{open, possible, small_cases};
use super::climb::climbed;
use super::evidence::{
    Explanation, Suspect, difference, explains_all, forward_is_the_same, largest_residual, no_number_left,
    nothing_but_zero, shows, usable,
};
use super::exam::Question;
use super::fitted::fitting;
use super::fitted_pairs::{beside, fitting_pairs};
use super::hypothesis::{Hypothesis, of_forward};
use super::imprecise::inaccuracy;
use super::mark::MarkOptions;
use super::misdone::{misdone_at_once, slips_alone};
use super::mostly::mostly;
use super::paired::paired;
use super::partial::{Partial, apply, changes, partial};
use super::peel::{peel, with_numbers};
use super::slips::{Beside, slipped};
use super::statistics;
use super::tripled::tripled;
use crate::contract::arrays::Arrays;
use crate::contract::check::Kind;
use crate::contract::component::Mistake;
use crate::convention::Conventions;
use crate::convention::profiles::PROFILES;
use crate::parallel;

/// The largest number of conventions that may differ, with one mistake and with two.
const CHANGES: [usize; 3] = [usize::MAX, 3, 1];

/// The largest number of assignments that are tried, with one mistake and with two.
const ASSIGNMENTS: [usize; 3] = [usize::MAX, 120, 24];

/// Elements that all pairs together may compute on the smallest case.
const PAIRS: usize = 100_000_000;

/// The largest number of explanations that are listed.
const SHOWN: usize = 8;

/// Numbers that the cases of a search may have in all. Where they have more, as the tables of a whole hash grid do, each trial takes a
/// second: single mistakes are looked for in the run's own conventions and in those of known programs, and nothing else.
const SEARCHED: usize = 4_000_000;

/// Explanations, best first: fewest mistakes, then fewest conventions, then most often seen. `suspects` are tried first for a
/// gradient (mistakes that the forward answers showed).
pub fn diagnose(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    suspects: &[Suspect],
    options: &MarkOptions,
) -> Vec<Explanation> {
    if question.statistics() {
        let shown = statistics::mistakes(question, answers, base).into_iter();
        let each = |mistake| Explanation { mistakes: vec![mistake], ..Explanation::default() };
        return shown.map(each).collect();
    }
    if no_number_left(question, answers) {
        return vec![];
    }
    let home = partial(question.component, base);
    let all = open(question, answers, base, options);
    let large = small_cases(question, answers).iter().map(|(case, _)| case.size()).sum::<usize>() > SEARCHED;
    // What a number explains that nobody writes, two mistakes may explain that people make: 147.2 is 255 over the root of 3.
    let (mut parted, mut singles, mut strange) = (None, vec![], vec![]);
    for count in 0..=2 {
        // Some pair or other makes nothing of everything, and so do slips: what there is to say is what was seen.
        if count == 2 && (large || nothing_but_zero(question, answers)) {
            return vec![];
        }
        if count == 2 {
            // Output by output first: it is quicker, and knows more than two.
            parted = peel(question, answers, base, options);
            if let Some(found) =
                parted.take_if(|found| found.unexplained.is_empty() && found.spared.is_empty())
            {
                return vec![found];
            }
        }
        let sets = sets(question, count, suspects);
        // Without a mistake, an output may show its conventions by itself.
        let right = if count == 0 { possible(question, answers, all.clone(), base, options) } else { vec![] };
        let all = if count == 0 { &right } else { &all };
        let mut near: Vec<&Partial> = all.iter().filter(|p| changes(p, &home) <= CHANGES[count]).collect();
        near.truncate(if count == 1 && large { 1 } else { ASSIGNMENTS[count] });
        if let Some((case, _)) = small_cases(question, answers).first().filter(|_| count == 2) {
            near.truncate((PAIRS / (question.cost(case) * sets.len().max(1))).max(1));
        }
        // What known programs do is near, however many conventions they change at once.
        let known: Vec<Partial> =
            PROFILES.iter().map(|p| partial(question.component, &p.conventions)).collect();
        near.extend(all.iter().filter(|p| known.contains(p) && changes(p, &home) > CHANGES[count]));
        if count == 1 {
            singles = near.iter().map(|p| (*p).clone()).collect();
        }
        let mut found = vec![];
        // Ring by ring around the run's own conventions: what needs fewer changes ranks first. One more ring for the runner-up.
        for ring in near.chunk_by(|a, b| changes(a, &home) == changes(b, &home)) {
            let had = !found.is_empty();
            found.extend(explaining((&sets, suspects), ring, question, answers, base, options));
            if had {
                break;
            }
        }
        found.retain(|h| shows(h, question, answers, options));
        let lost = count == 1 && found.is_empty();
        if lost && !large && !nothing_but_zero(question, answers) {
            let known = singles.iter().map(|p| apply(p, base)).collect::<Vec<_>>();
            strange = fitting(question, answers, base, &known, suspects, options);
            if strange.iter().any(Hypothesis::plain_numbers) {
                return ranked(strange, question, answers, &home, options);
            }
        }
        let inaccurate = if lost && strange.is_empty() {
            inaccuracy(&near, question, answers, base, options)
        } else {
            None
        };
        if let Some((h, residual)) = inaccurate {
            let conventions = difference(&partial(question.component, &h.conventions), &home);
            return vec![Explanation { conventions, residual, inaccurate: true, ..Explanation::default() }];
        }
        if !found.is_empty() {
            if count == 0 {
                // A mistake may be another program's convention: the two are reported together.
                found.extend(alone(question, answers, base, options));
            }
            return ranked(found, question, answers, &home, options);
        }
    }
    if !strange.is_empty() {
        return ranked(strange, question, answers, &home, options);
    }
    if let Some(found) = parted.take_if(|found| found.unexplained.is_empty()) {
        return vec![found];
    }
    let near: Vec<_> = singles.iter().map(|p| apply(p, base)).collect();
    beyond(question, answers, base, suspects, options, &near, parted)
}

/// What no catalogue lists, what is known of most cases, both, and what is known of some outputs (`parted`); several mistakes in
/// conventions nearby (`near`).
fn beyond(
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
    if question.kind == Kind::Forward {
        let fitted = fitting_pairs(question, answers, near, options);
        let pairs = if fitted.is_empty() { paired(question, answers, base, options) } else { fitted };
        if !pairs.is_empty() {
            return ranked(pairs, question, answers, &home, options);
        }
        let triples = tripled(question, answers, base, options);
        if !triples.is_empty() {
            return ranked(triples, question, answers, &home, options);
        }
    }
    let several = climbed(question, answers, base, options);
    if !several.is_empty() {
        return ranked(several, question, answers, &home, options);
    }
    let most = mostly(question, answers, base, suspects, options);
    let pairs =
        most.iter().flat_map(|most| beside(most, base, question, answers, options)).collect::<Vec<_>>();
    if !pairs.is_empty() {
        return ranked(pairs, question, answers, &home, options);
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

/// The hypotheses of these sets of mistakes in these assignments that explain every answer.
fn explaining(
    (sets, suspects): (&[Vec<&'static str>], &[Suspect]),
    ring: &[&Partial],
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Hypothesis> {
    let mut hypotheses = vec![];
    let home = partial(question.component, base);
    // Numeric gradients are too expensive for all assignments: the forward answers have shown the conventions, but for one that
    // gradients alone show, as a quaternion of length 1 that isn't divided by it.
    let unseen = |p: &Partial, conventions: &Conventions| {
        changes(p, &home) <= 2 && forward_is_the_same(question, conventions, base, options)
    };
    for mistakes in sets {
        let numeric = question.kind == Kind::Vjp && of_forward(question, mistakes);
        let suspected = suspects.iter().any(|(set, fitted)| fitted.is_empty() && set == mistakes);
        for (p, conventions) in ring.iter().map(|p| (p, apply(p, base))) {
            // No mistake in the run's own conventions isn't an explanation: it has just failed.
            let near = conventions == *base || suspected && unseen(p, &conventions);
            if (near || !numeric) && !(conventions == *base && mistakes.is_empty()) {
                hypotheses.push(Hypothesis::new(mistakes.clone(), conventions));
            }
        }
    }
    let fits = parallel::map(hypotheses.len(), |n| explains_all(&hypotheses[n], question, answers, options));
    hypotheses.into_iter().zip(fits).filter(|(_, fits)| *fits).map(|(h, _)| h).collect()
}

/// Single mistakes in the run's own conventions that explain everything.
fn alone(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Hypothesis> {
    let single = |mistakes| Hypothesis::new(mistakes, *base);
    let hypotheses = sets(question, 1, &[]).into_iter().map(single);
    hypotheses.filter(|h| explains_all(h, question, answers, options)).collect()
}

/// Sets of `count` mistakes that this direction can show; pairs in both orders, as their effects needn't commute.
fn sets(question: &Question, count: usize, suspects: &[Suspect]) -> Vec<Vec<&'static str>> {
    // Three and more come from the forward answers alone.
    let mut suspected: Vec<_> = suspects
        .iter()
        .filter(|(set, fitted)| fitted.is_empty() && (set.len() == count || count == 2 && set.len() > 2))
        .map(|(set, _)| set.clone())
        .collect();
    let shown = |m: &&Mistake| question.kind == Kind::Vjp || !m.gradient;
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
    suspected.extend(sets);
    suspected.dedup();
    suspected
}

fn ranked(
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
    let best = rows[0].0.clone();
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

#[cfg(test)]
mod tests {
    use super::super::answer::given;
    use super::super::exam::Exam;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::convention::CS180;

    /// What is said of a hypothesis' own answers in f32 after a change.
    fn said(
        (name, kind): (&str, Kind),
        h: &Hypothesis,
        suspects: &[Suspect],
        change: fn(f64) -> f64,
    ) -> Vec<Explanation> {
        let exam = Exam::new(name, Dtype::F32, None).unwrap();
        let question =
            exam.questions.iter().find(|question| question.kind == kind).expect("a row of this kind");
        let single = |a: ndarray::ArrayD<f64>| a.mapv(|x| Dtype::F32.round(change(x)));
        let answer = |case| {
            let (arrays, _) = h.prediction(question, case);
            Some(given(arrays.into_iter().map(|(name, a)| (name, single(a))).collect()))
        };
        let answers: Answers = question.cases.iter().map(answer).collect();
        diagnose(question, &answers, &CS180, suspects, &MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 })
    }

    #[test]
    fn nothing_explains_a_stub() {
        let right = Hypothesis::new(vec![], CS180);
        for name in ["distortion_loss", "volume_render"] {
            assert_eq!(said((name, Kind::Forward), &right, &[], |_| 0.0).len(), 0, "{name}");
        }
        assert!(!said(("distortion_loss", Kind::Forward), &right, &[], |x| 2.0 * x).is_empty());
    }

    /// What a mistake leaves open must not explain everything.
    #[test]
    fn noise_has_no_name() {
        let right = Hypothesis::new(vec![], CS180);
        for name in ["positional_encoding", "importance_sampling"] {
            let found = said((name, Kind::Forward), &right, &[], |x| 0.7 * (977.0 * x).sin() + 0.13);
            assert!(found.is_empty(), "{name}: {found:?}");
        }
    }

    #[test]
    fn a_gradient_may_show_a_convention_beside_the_mistake() {
        let row = ("pose_from_colmap", Kind::Vjp);
        let shown = [(vec!["not_inverted"], vec![])];
        let with =
            |key, value| Hypothesis::new(vec!["not_inverted"], CS180.with(key, value).expect("listed"));
        let name = |found: &[Explanation]| found.first().and_then(|e| e.mistakes.first()).map(|m| m.name);
        // Quaternions of length 1, as given: forward they are the same.
        let found = said(row, &with("quaternion", "as_given"), &shown, |g| g);
        assert_eq!(
            (name(&found), found[0].conventions.get("quaternion")),
            (Some("not_inverted"), Some(&"as_given"))
        );
        assert_ne!(name(&said(row, &with("quaternion", "as_given"), &[], |g| g)), Some("not_inverted"));
        // Other axes aren't.
        let found = said(row, &with("axes", "opengl"), &shown, |g| g);
        assert!(!found.iter().any(|e| e.conventions.contains_key("axes") && e.whole()), "{}", found.len());
    }
}
