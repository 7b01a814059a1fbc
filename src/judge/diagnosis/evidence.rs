//! Evidence: how well a hypothesis explains answers, and what is said of one that does.

use std::cell::Cell;

use super::super::answer::{Answer, Answers};
use super::super::assignment::small_cases;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::partial::Partial;
use super::super::within::Off;
use super::hypothesis::{Apart, Hypothesis};
use super::slips::slip::Slip;
use super::telling::repeats;
use crate::contract::case::Case;
use crate::contract::component::Mistake;
use crate::convention::{CHOICES, Conventions};

/// Mistakes that the forward answers showed, with the number in them where it isn't the usual one.
pub(crate) type Suspect = (Vec<&'static str>, Vec<f64>);

/// By how many times a mistake must explain the answers better than lost digits do, to be named.
const MUCH_BETTER: f64 = 4.0;

/// Gradients of mistakes in the forward function are numeric and expensive: this many of the smallest cases are used.
const NUMERIC: usize = 12;

thread_local! {
    /// The place of the case that rejected this thread's last hypothesis. What is explained doesn't depend on it.
    static REJECTED_BY: Cell<usize> = const { Cell::new(0) };
}

/// A hypothesis that explains every answered element, but for the outputs and the cases that it names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Explanation {
    /// The mistakes.
    pub mistakes: Vec<&'static Mistake>,
    /// The numbers of its mistakes that have one, in their order, as far as they aren't the usual ones.
    pub fitted: Vec<f64>,
    /// Conventions in which the candidate differs from the run's.
    pub conventions: Partial,
    /// Largest error over the hypothesis' own bound.
    pub residual: f64,
    /// What happens to one array beside the mistakes, to operations of the formula, or another formula, where no catalogue lists it.
    pub(crate) slip: Option<Slip>,
    /// Whether it predicts the same as the best explanation on every case: no answer can tell the two apart.
    pub same_as_best: bool,
    /// Whether it is no mistake: the right formula, with digits lost.
    pub inaccurate: bool,
    /// Outputs that it doesn't explain; those of others are explained by it.
    pub unexplained: Vec<String>,
    /// Outputs that are right, and that its mistakes would change, too: whatever was done, was done to the others alone.
    pub spared: Vec<String>,
    /// Outputs that show some of its mistakes alone.
    pub(crate) apart: Vec<Apart>,
    /// Cases that it doesn't explain; most are.
    pub unexplained_cases: Vec<String>,
}

impl Explanation {
    /// Whether something is wrong: more than conventions or lost digits.
    pub(crate) fn wrong(&self) -> bool {
        !self.mistakes.is_empty() || self.slip.is_some()
    }

    /// Whether it is wrong about the forward function, not about its gradient alone.
    pub(crate) fn of_forward(&self) -> bool {
        self.mistakes.iter().any(|m| !m.gradient) || self.slip.as_ref().is_some_and(Slip::forward)
    }

    /// Whether it explains all that was answered.
    pub(crate) fn whole(&self) -> bool {
        self.unexplained.is_empty() && self.unexplained_cases.is_empty()
    }
}

/// Whether any output that was answered is of real numbers, no bits and counts alone.
pub(crate) fn real_numbers(question: &Question, answers: &Answers) -> bool {
    let mut names = answers.iter().flatten().flat_map(|answer| answer.keys());
    names.any(|name| !question.component.output_entries(name).whole())
}

/// The cases that a hypothesis is held against, the smallest first.
pub(crate) fn usable<'a>(
    h: &Hypothesis,
    question: &'a Question,
    answers: &'a Answers,
) -> Vec<(&'a Case, &'a Answer)> {
    let mut cases = small_cases(question, answers);
    if h.numeric(question) {
        cases.truncate(NUMERIC);
    }
    cases
}

/// The same question with some of its cases.
pub(crate) fn only(
    question: &Question,
    answers: &Answers,
    kept: impl Fn(&Case) -> bool,
) -> (Question, Answers) {
    let mut some = question.clone();
    some.truths = question.truths.shared();
    some.cases.retain(|case| kept(case));
    let both = question.cases.iter().zip(answers).filter(|(case, _)| kept(case));
    (some, both.map(|(_, answer)| answer.clone()).collect())
}

/// The case that rejected the last hypothesis, unless it is long: where one thing is wrong, many are rejected by the same.
pub(super) fn rejects_often(cases: &[(&Case, &Answer)]) -> Option<usize> {
    let n = REJECTED_BY.get();
    let (last, _) = cases.get(n)?;
    (last.size() <= 4 * cases[0].0.size()).then_some(n)
}

/// Remembers the case that rejected a hypothesis.
pub(super) fn rejected_by(case: usize) {
    REJECTED_BY.set(case);
}

/// Whether a hypothesis explains every answer; gradients by numeric differentiation on the smallest cases.
pub(crate) fn explains_all(
    h: &Hypothesis,
    question: &Question,
    answers: &Answers,
    options: &MarkOptions,
) -> bool {
    let cases = usable(h, question, answers);
    // Numeric gradients that are unknown everywhere would explain anything.
    let says = |case| {
        h.prediction(question, case).1.is_none_or(|error| error.values().flatten().any(|e| e.is_finite()))
    };
    // Those first that can be rejected without a bound.
    let early = |n: &usize| options.may_reject_early(cases[*n].0);
    let fits = |n: &usize| h.explains(question, cases[*n].0, cases[*n].1, options);
    let first = rejects_often(&cases).filter(early);
    let (others, hard) = ((0..cases.len()).filter(early), (0..cases.len()).filter(|n| !early(n)));
    let mut rest = first.into_iter().chain(others.chain(hard).filter(|n| first != Some(*n)));
    if let Some(rejected) = rest.find(|n| !fits(n)) {
        rejected_by(rejected);
        return false;
    }
    cases.iter().any(|(case, _)| says(case))
}

/// Whether its mistakes explain the answers much better than lost digits do, which are allowed what wrong code is.
pub(crate) fn shows(h: &Hypothesis, question: &Question, answers: &Answers, options: &MarkOptions) -> bool {
    if h.right() {
        return true;
    }
    let right = Hypothesis { loose: true, ..Hypothesis::new(vec![], h.conventions) };
    let off = |(case, answer): &(&Case, &Answer)| right.compared(h, question, case, answer, options);
    let together = |a: [Off; 2], b: [Off; 2]| [0, 1].map(|n| a[n].and(b[n]));
    // What wrong code makes of an infinite input isn't known, but for what it counts or flags: else it would explain any NaN.
    let known = |(case, answer): (&Case, &Answer)| -> Answer {
        let told = |name: &String| case.finite() || question.component.output_entries(name).whole();
        answer
            .iter()
            .filter(|(name, _)| told(name))
            .map(|(name, given)| (name.clone(), given.clone()))
            .collect()
    };
    let cases = usable(h, question, answers);
    if h.says_little(question, &cases) {
        return false;
    }
    let each = cases.iter().map(|(case, answer)| (*case, known((case, answer))));
    let [lost, wrong] = each.map(|(case, answer)| off(&(case, &answer))).fold([Off::default(); 2], together);
    // What misses as many numbers as the right formula explains them by the width of its own bound alone. In another shape nothing is known.
    let nearer =
        (wrong.many, wrong.most) < (lost.many, lost.most) || wrong.most.is_infinite() || h.numeric(question);
    lost.most > 1.0 && nearer || MUCH_BETTER * wrong.most < lost.most || repeats(h, question, &cases, options)
}

/// The conventions among these, or next to a mistake's own, in which the right formula gives the same: a scale of 1/2 where the frequencies are
/// those of 2 pi.
pub(crate) fn renamed(
    h: &Hypothesis,
    others: &[Conventions],
    question: &Question,
    answers: &Answers,
    options: &MarkOptions,
) -> Option<Conventions> {
    let cases = usable(h, question, answers);
    let same = |c: &Conventions| {
        let right = Hypothesis::new(vec![], *c);
        cases.iter().all(|(case, _)| right.same_as(h, question, case, options))
    };
    let keys = CHOICES.iter().filter(|(key, _)| question.component.conventions.contains(key));
    let next =
        keys.flat_map(|(key, values)| values.iter().filter_map(|value| h.conventions.with(key, value).ok()));
    others.iter().copied().chain(next.filter(|c| question.admits(c))).find(same)
}

/// Whether the right formula gives the same in both, up to rounding, on the inputs of all cases.
pub(crate) fn forward_is_the_same(
    question: &Question,
    a: &Conventions,
    b: &Conventions,
    options: &MarkOptions,
) -> bool {
    let oracle = question.component.forward.oracle;
    let near =
        |(a, b): (&f64, &f64)| (a - b).abs() <= 64.0 * options.dtype.unit_roundoff() * a.abs().max(1.0);
    let same = |case: &Case| {
        let (a, b) = (oracle(&case.inputs, a), oracle(&case.inputs, b));
        a.iter().all(|(name, a)| a.shape() == b[name].shape() && a.iter().zip(&b[name]).all(near))
    };
    question.cases.iter().all(same)
}

/// Whether all numbers of all answers are 0, real ones among them: a stub, or the way out where something couldn't be imported.
pub(crate) fn nothing_but_zero(question: &Question, answers: &Answers) -> bool {
    let arrays = || answers.iter().flatten().flatten();
    let real = |name: &String| !question.component.output_entries(name).whole();
    arrays().any(|(name, _)| real(name)) && arrays().all(|(_, given)| given.values.iter().all(|x| *x == 0.0))
}

/// Whether a program that crashed elsewhere has answered no number: one case that is none tells one mistake as well as another.
pub(crate) fn no_number_left(question: &Question, answers: &Answers) -> bool {
    let mut numbers = answers.iter().flatten().flatten().flat_map(|(_, given)| &given.values);
    !question.crashed.is_empty() && numbers.all(|x| x.is_nan())
}

/// The largest error over a hypothesis' own bound.
pub(crate) fn largest_residual(
    h: &Hypothesis,
    question: &Question,
    answers: &Answers,
    options: &MarkOptions,
) -> f64 {
    let cases = usable(h, question, answers);
    cases.iter().map(|(case, answer)| h.residual(question, case, answer, options)).fold(0.0, f64::max)
}

/// The entries of `a` that differ in `b`.
pub fn difference(a: &Partial, b: &Partial) -> Partial {
    a.iter().filter(|(key, value)| b.get(*key) != Some(value)).map(|(key, value)| (*key, *value)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::convention::CS180;

    /// Half of the frequencies of 2 pi are those of pi; a quarter of them are nobody's.
    #[test]
    fn a_scale_may_be_another_convention() {
        let exam = Exam::new("positional_encoding", Dtype::F64, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F64, exp_ulp: 4.0 });
        let right = |case: &Case| Some(given((question.component.forward.oracle)(&case.inputs, &CS180)));
        let answers: Answers = question.cases.iter().map(right).collect();
        let twice = CS180.with("frequency", "two_pi").expect("listed");
        let scaled = Hypothesis::new(vec!["another_first_band"], twice);
        let renames =
            |c: f64| renamed(&scaled.with_number(c), &[CS180], question, &answers, &options).is_some();
        assert!(renames(0.5) && !renames(0.25));
    }

    /// What predicts the same as the right formula explains nothing, however wide its bound is where a ray ends at a threshold.
    #[test]
    fn a_mistake_shows_where_it_is_nearer_than_the_right_formula() {
        let mut exam = Exam::new("volume_render", Dtype::F64, None).unwrap();
        let question = &mut exam.questions[0];
        question.cases.retain(|case| case.id == "mixed_0");
        let options = MarkOptions { dtype: Dtype::F64, exp_ulp: 4.0 };
        let ends_at = |left: f64| Hypothesis::new(vec!["given_up_early"], CS180).with_number(left);
        let answers = |h: &Hypothesis, factor: f64| -> Answers {
            let (mut outputs, _) = h.prediction(question, &question.cases[0]);
            outputs.get_mut("colors").expect("an output")[[0, 1]] *= factor;
            vec![Some(given(outputs))]
        };
        let right = Hypothesis::new(vec![], CS180);
        let least = answers(&right, 1.0)[0].as_ref().expect("an answer")["transmittance"]
            .values
            .iter()
            .fold(1.0, |least: f64, t| least.min(*t));
        // Nothing ends, but a nudge further on something would.
        let off = answers(&right, 1.0 + 1e-12);
        let loose = Hypothesis { loose: true, ..right.clone() };
        assert!(!loose.explains(question, &question.cases[0], off[0].as_ref().unwrap(), &options));
        assert!(!shows(&ends_at(0.5 * least), question, &off, &options));
        let ended = answers(&ends_at(0.5), 1.0);
        assert!(shows(&ends_at(0.5), question, &ended, &options));
    }
}
