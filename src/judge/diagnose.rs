//! Diagnosis: which conventions and which mistakes explain the answers of a component that failed.

use super::answer::Answers;
use super::assignment::{open, possible, small_cases};
use super::beyond::beyond;
use super::evidence::{
    Explanation, Suspect, difference, explains_all, forward_is_the_same, no_number_left, nothing_but_zero,
    shows,
};
use super::exam::Question;
use super::fitted::fitting;
use super::hypothesis::{Hypothesis, of_forward};
use super::imprecise::inaccuracy;
use super::lawful::lawful;
use super::mark::MarkOptions;
use super::partial::{Partial, apply, changes, partial};
use super::peel::peel;
use super::ranked::ranked;
use super::statistics;
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
            // What an eps does near 0 is no rounding, where it is shown better than that.
            let laws = lawful(question, answers, base, options);
            if !laws.is_empty() {
                return laws;
            }
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
        let laws = lawful(question, answers, base, options);
        return if laws.is_empty() { ranked(strange, question, answers, &home, options) } else { laws };
    }
    if let Some(found) = parted.take_if(|found| found.unexplained.is_empty()) {
        return vec![found];
    }
    let near: Vec<_> = singles.iter().map(|p| apply(p, base)).collect();
    beyond(question, answers, base, suspects, options, &near, parted)
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
