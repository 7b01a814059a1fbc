//! Diagnosis: which conventions and which mistakes explain the answers of a component that failed.

use super::super::answer::Answers;
use super::super::assignment::{open, possible, small_cases};
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::partial::{Partial, apply, changes, partial};
use super::beyond::beyond;
use super::commoner::commoner;
use super::effects::{Effects, Failing};
use super::evidence::{
    Explanation, Suspect, explains_all, forward_is_the_same, largest_residual, no_number_left,
    nothing_but_zero, renamed, shows,
};
use super::fitted::fitting;
use super::hypothesis::{Hypothesis, of_forward};
use super::imprecise::{NO_CLOSER, few_bits_lost, inaccuracy, lost_digits, rather_lost};
use super::lawful::lawful;
use super::peel::peel;
use super::ranked::ranked;
use super::sets::sets;
use super::shown_together::shown_together;
use crate::contract::check::Kind;
use crate::convention::Conventions;
use crate::convention::profiles::PROFILES;
use crate::parallel;

/// The largest number of conventions that may differ, with no mistake, with one and with two.
const CHANGES: [usize; 3] = [usize::MAX, 3, 1];

/// The largest number of assignments that are tried, the same.
const ASSIGNMENTS: [usize; 3] = [usize::MAX, 120, 24];

/// The largest number of conventions that gradients show and forward answers don't.
const UNSEEN: usize = 2;

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
    diagnose_in(question, answers, (base, false), suspects, options)
}

/// The same, where it may be known that `base` are the conventions in which the forward answers are explained.
pub(crate) fn diagnose_in(
    question: &Question,
    answers: &Answers,
    (base, settled): (&Conventions, bool),
    suspects: &[Suspect],
    options: &MarkOptions,
) -> Vec<Explanation> {
    if question.statistics() {
        return shown_together(question, answers, base);
    }
    if no_number_left(question, answers) {
        return vec![];
    }
    let d = Diagnosis { settled, ..Diagnosis::new(question, answers, base, suspects, options) };
    let right = d.conventions_alone();
    if !right.is_empty() {
        return right;
    }
    let (single, strange) = d.one_mistake();
    if !single.is_empty() {
        return single;
    }
    // Some pair or other makes nothing of everything, and so do slips: what there is to say is what was seen. And a few lost bits are
    // likelier than all that is left to be tried.
    if d.large || nothing_but_zero(question, answers) || few_bits_lost(question, answers, base, options) {
        return vec![];
    }
    // Output by output first: it is quicker, and knows more than two; of which two may be one that undo each other.
    let mut parted = peel(question, answers, base, options);
    let whole = |found: &Explanation| found.unexplained.is_empty() && found.spared.is_empty();
    if let Some(found) = parted.take_if(|found| whole(found) && found.mistakes.len() <= 2) {
        return vec![found];
    }
    let pairs = d.two_mistakes();
    if !pairs.is_empty() {
        return pairs;
    }
    if let Some(found) = parted.take_if(|found| whole(found)) {
        return vec![found];
    }
    if !strange.is_empty() {
        let laws = lawful(question, answers, base, options);
        return if laws.first().is_some_and(Explanation::whole) { laws } else { d.ranked(strange) };
    }
    if let Some(found) = parted.take_if(|found| found.unexplained.is_empty()) {
        return vec![found];
    }
    beyond(question, answers, base, suspects, options, &d.applied(&d.near(1)), parted)
}

/// What is asked and answered, and in which conventions an explanation is looked for.
struct Diagnosis<'a> {
    question: &'a Question,
    answers: &'a Answers,
    base: &'a Conventions,
    suspects: &'a [Suspect],
    options: &'a MarkOptions,
    /// The run's conventions, as far as the row reads them.
    home: Partial,
    /// Conventions that the answers leave open, the nearest first.
    open: Vec<Partial>,
    /// Whether each trial takes a second.
    large: bool,
    /// Whether the forward answers are explained in the run's conventions.
    settled: bool,
}

impl<'a> Diagnosis<'a> {
    fn new(
        question: &'a Question,
        answers: &'a Answers,
        base: &'a Conventions,
        suspects: &'a [Suspect],
        options: &'a MarkOptions,
    ) -> Self {
        let numbers: usize = small_cases(question, answers).iter().map(|(case, _)| case.size()).sum();
        Diagnosis {
            question,
            answers,
            base,
            suspects,
            options,
            home: partial(question.component, base),
            open: open(question, answers, base, options),
            large: numbers > SEARCHED,
            settled: false,
        }
    }

    /// The right formula in other conventions; beside it single mistakes in the run's own, as a mistake may be another program's convention.
    fn conventions_alone(&self) -> Vec<Explanation> {
        let Diagnosis { question, answers, base, options, .. } = *self;
        let mut all = self.open.clone();
        // What the forward answers showed, they showed in these conventions: gradients may show others, but few.
        if self.settled {
            all.retain(|p| changes(p, &self.home) <= UNSEEN);
        }
        // An output may show its conventions by itself.
        let all = possible(question, answers, all, base, options);
        let mut found = self.explaining(0, &all.iter().collect::<Vec<_>>());
        if !found.is_empty() {
            let alone =
                sets(question, 1, &[], false).into_iter().map(|single| Hypothesis::new(single, *base));
            found.extend(alone.filter(|h| explains_all(h, question, answers, options)));
        }
        self.ranked(found)
    }

    /// One mistake, or lost digits, or a formula that explains what these would; and mistakes with a number that nobody writes, which give way
    /// to two that people make: 147.2 is 255 over the root of 3.
    fn one_mistake(&self) -> (Vec<Explanation>, Vec<Hypothesis>) {
        let Diagnosis { question, answers, base, options, .. } = *self;
        let mut near = self.near(1);
        let mut found = self.explaining(1, &near);
        let applied = self.applied(&near);
        // The right formula in other conventions, as far off as wrong code may be: it has lost digits, in these.
        let mut renames: Vec<Partial> = vec![];
        if question.kind == Kind::Forward && !self.large {
            found.retain(|h| {
                let close = largest_residual(h, question, answers, options) < NO_CLOSER;
                let c = if close { None } else { renamed(h, &applied, question, answers, options) };
                renames.extend(c.iter().map(|c| partial(question.component, c)));
                c.is_none()
            });
        }
        near.extend(&renames);
        if !found.is_empty() {
            found.extend(commoner(&found, question, answers, options));
            return (self.unless_lost(found), vec![]);
        }
        if !self.large && !nothing_but_zero(question, answers) {
            let numbers = fitting(question, answers, base, &applied, self.suspects, options);
            if numbers.iter().any(Hypothesis::plain_numbers) {
                return (self.unless_lost(numbers), vec![]);
            }
            if !numbers.is_empty() {
                return (vec![], numbers);
            }
        }
        let Some(lost) = inaccuracy(&near, question, answers, base, options) else {
            return (vec![], vec![]);
        };
        // What an eps does near 0 is no rounding, where it is shown better than that.
        let laws = lawful(question, answers, base, options);
        if laws.first().is_some_and(Explanation::whole) {
            return (laws, vec![]);
        }
        (vec![lost_digits(lost, question, &self.home)], vec![])
    }

    fn unless_lost(&self, found: Vec<Hypothesis>) -> Vec<Explanation> {
        let found = self.ranked(found);
        let lost = rather_lost(&found, self.question, self.answers, self.base, self.options);
        lost.map_or(found, |lost| vec![lost_digits(lost, self.question, &self.home)])
    }

    fn two_mistakes(&self) -> Vec<Explanation> {
        let Diagnosis { question, answers, base, options, .. } = *self;
        let mut near = self.near(2);
        let home = Failing::new(question, answers, base, options).filter(|_| question.kind == Kind::Forward);
        near.retain(|p| home.as_ref().is_none_or(|home| home.kept_by(question, &apply(p, base), options)));
        self.ranked(self.explaining(2, &near))
    }

    /// The conventions in which so many mistakes are looked for.
    fn near(&self, count: usize) -> Vec<&Partial> {
        let changed = |p: &&Partial| changes(p, &self.home);
        let mut near: Vec<&Partial> = self.open.iter().filter(|p| changed(p) <= CHANGES[count]).collect();
        near.truncate(if self.large { 1 } else { ASSIGNMENTS[count] });
        if let Some((case, _)) = small_cases(self.question, self.answers).first().filter(|_| count == 2) {
            let pairs = sets(self.question, count, self.suspects, self.settled).len();
            near.truncate((PAIRS / (self.question.cost(case) * pairs.max(1))).max(1));
        }
        // What known programs do is near, however many conventions they change at once.
        let known: Vec<Partial> =
            PROFILES.iter().map(|p| partial(self.question.component, &p.conventions)).collect();
        near.extend(self.open.iter().filter(|p| known.contains(p) && changed(p) > CHANGES[count]));
        near
    }

    fn applied(&self, near: &[&Partial]) -> Vec<Conventions> {
        near.iter().map(|p| apply(p, self.base)).collect()
    }

    /// The hypotheses of so many mistakes in these conventions that explain every answer.
    fn explaining(&self, count: usize, near: &[&Partial]) -> Vec<Hypothesis> {
        let sets = sets(self.question, count, self.suspects, self.settled);
        let (suspected, others): (Vec<_>, Vec<_>) = sets.into_iter().partition(|set| self.suspected(set));
        let shown = |h: &Hypothesis| shows(h, self.question, self.answers, self.options);
        let mut found = vec![];
        // Ring by ring around the run's own conventions: what needs fewer changes ranks first. One more ring for the runner-up.
        for ring in near.chunk_by(|a, b| changes(a, &self.home) == changes(b, &self.home)) {
            let had = !found.is_empty();
            let mut of_suspected = self.explaining_in(&suspected, ring);
            of_suspected.retain(shown);
            // What the forward answers showed has no rival in a gradient: the numeric gradients of all others take a minute.
            if !of_suspected.is_empty() {
                found.retain(shown);
                found.extend(of_suspected);
                return found;
            }
            found.extend(self.explaining_in(&others, ring));
            if had {
                break;
            }
        }
        found.retain(shown);
        found
    }

    /// Whether the forward answers showed these mistakes.
    fn suspected(&self, mistakes: &[&'static str]) -> bool {
        self.suspects.iter().any(|(set, fitted)| fitted.is_empty() && set == mistakes)
    }

    fn explaining_in(&self, sets: &[Vec<&'static str>], ring: &[&Partial]) -> Vec<Hypothesis> {
        let Diagnosis { question, answers, base, options, .. } = *self;
        let mut hypotheses = vec![];
        // Numeric gradients are too expensive for all assignments: the forward answers have shown the conventions, but for one that
        // gradients alone show, as a quaternion of length 1 that isn't divided by it.
        let unseen = |p: &Partial, conventions: &Conventions| {
            changes(p, &self.home) <= UNSEEN && forward_is_the_same(question, conventions, base, options)
        };
        let pairs =
            question.kind == Kind::Forward && !sets.is_empty() && sets.iter().all(|set| set.len() == 2);
        let effects = parallel::map(if pairs { ring.len() } else { 0 }, |n| {
            Effects::new(question, answers, &apply(ring[n], base), options)
        });
        for mistakes in sets {
            let numeric = question.kind == Kind::Vjp && of_forward(question, mistakes);
            let suspected = self.suspected(mistakes);
            let may = |n: usize| effects.get(n).and_then(Option::as_ref).is_none_or(|e| e.allow(mistakes));
            for (p, conventions) in
                ring.iter().enumerate().filter(|(n, _)| may(*n)).map(|(_, p)| (p, apply(p, base)))
            {
                // No mistake in the run's own conventions isn't an explanation: it has just failed.
                let near = conventions == *base || suspected && unseen(p, &conventions);
                if (near || !numeric) && !(conventions == *base && mistakes.is_empty()) {
                    hypotheses.push(Hypothesis::new(mistakes.clone(), conventions));
                }
            }
        }
        let fits =
            parallel::map(hypotheses.len(), |n| explains_all(&hypotheses[n], question, answers, options));
        hypotheses.into_iter().zip(fits).filter(|(_, fits)| *fits).map(|(h, _)| h).collect()
    }

    fn ranked(&self, found: Vec<Hypothesis>) -> Vec<Explanation> {
        ranked(found, self.question, self.answers, &self.home, self.options)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
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

    /// Where the forward answers are explained, a gradient has their mistakes and those of gradients alone.
    #[test]
    fn a_gradient_has_no_other_mistake_of_the_forward_function() {
        let exam = Exam::new("volume_render", Dtype::F32, None).unwrap();
        let question = exam.questions.iter().find(|q| q.kind == Kind::Vjp).expect("it has a gradient");
        let suspects = [(vec!["delta_missing"], vec![])];
        let tried = |settled| sets(question, 1, &suspects, settled);
        let forward = |all: Vec<Vec<&'static str>>| -> Vec<Vec<&'static str>> {
            all.into_iter().filter(|set| of_forward(question, set)).collect()
        };
        assert_eq!(forward(tried(true)), [["delta_missing"]]);
        assert!(forward(tried(false)).len() > 50 && tried(true).len() > 1);
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
