//! Hypotheses: what a candidate would answer if it followed some conventions and made some mistakes.

use ndarray::ArrayD;

use super::super::answer::Answer;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::within::{Bound, Off, Scale, each_within, largest_of, off, within};
use super::numeric;
use super::slips::slip::Slip;
use crate::contract::arithmetic::{Dtype, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::case::{Case, Draw};
use crate::contract::check::{Kind, budget_used};
use crate::contract::component::Direction;
use crate::convention::Conventions;

/// An output that shows some mistakes alone, and which: weights may be divided by their sum after the colors were made.
pub(crate) type Apart = (String, Vec<&'static str>);

/// An assignment of conventions with mistakes, in the order in which they were made.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// Names of the component's mistakes.
    pub mistakes: Vec<&'static str>,
    /// The numbers of its mistakes that have one, in their order, as far as they aren't the usual ones.
    pub fitted: Vec<f64>,
    /// The assignment.
    pub conventions: Conventions,
    /// What happens to one array beside its mistakes; or, alone, to operations of the formula, or another formula.
    pub(crate) slip: Option<Slip>,
    /// Outputs of the forward function that show some of its mistakes alone.
    pub(crate) apart: Vec<Apart>,
    /// Whether digits may be lost: then the right formula is given the bound that a wrong one has.
    pub loose: bool,
}

/// How much wider a hypothesis' bound is than that of the right formula, as wrong code has no derived bound of its own; and the
/// number of roundings of a wrong result beside those of its inputs. In the short types so wide a bound would explain anything.
fn generosity(dtype: Dtype) -> (f64, f64) {
    if dtype.bits() >= 24 { (8.0, 64.0) } else { (4.0, 4.0) }
}

impl Hypothesis {
    /// These mistakes in these conventions.
    pub fn new(mistakes: Vec<&'static str>, conventions: Conventions) -> Hypothesis {
        Hypothesis { mistakes, fitted: vec![], slip: None, apart: vec![], conventions, loose: false }
    }

    /// Whether nothing is wrong.
    pub(crate) fn right(&self) -> bool {
        self.mistakes.is_empty() && self.slip.is_none()
    }

    /// Whether it is a gradient of wrong code, which only differences know.
    pub(crate) fn numeric(&self, question: &Question) -> bool {
        let forward = self.slip.as_ref().is_some_and(Slip::forward);
        question.kind == Kind::Vjp && (forward || of_forward(question, &self.mistakes))
    }

    /// What this candidate would answer, and its error where it isn't known exactly (numeric gradients).
    pub fn prediction(&self, question: &Question, case: &Case) -> (Arrays, Option<Arrays>) {
        if self.numeric(question) {
            let (gradient, error) = self.gradient(question, case, 1);
            return (gradient, Some(error));
        }
        (self.wrong(question, &case.inputs), None)
    }

    /// The numeric gradient at one in `each` of the elements that are looked at, and its error.
    pub(super) fn gradient(&self, question: &Question, case: &Case, each: usize) -> (Arrays, Arrays) {
        let forward = |inputs: &Arrays| self.slipped(inputs, question, &question.component.forward);
        let (gradient, error) = numeric::vjp(question.component, &case.inputs, each, forward);
        let shown = question.component.special.of_gradients;
        (shown(&case.inputs, &self.conventions, gradient), error)
    }

    /// The wrong function.
    fn wrong(&self, question: &Question, inputs: &Arrays) -> Arrays {
        let direction = question.component.direction(question.kind).expect("a question has its direction");
        self.slipped(inputs, question, direction)
    }

    /// A wrong function with its mistakes, between what slips.
    fn slipped(&self, inputs: &Arrays, question: &Question, direction: &Direction) -> Arrays {
        let c = &self.conventions;
        let made = |inputs: &Arrays, mistakes: &[&'static str]| {
            self.named(question, mistakes, |names| (direction.wrong)(inputs, c, names))
        };
        let with = |inputs: &Arrays| {
            let mut outputs = made(inputs, &self.mistakes);
            for (name, mistakes) in &self.apart {
                outputs.extend(made(inputs, mistakes).remove_entry(name));
            }
            outputs
        };
        match &self.slip {
            None => with(inputs),
            Some(Slip::Formula(slip)) => slip.of(inputs, c, direction.honest),
            Some(Slip::Array(slip)) => slip.on_outputs(inputs, with(&slip.on_inputs(inputs))),
            Some(Slip::Law(slip)) => {
                let laws = question.component.special.laws_of(slip.forward).expect("a row with laws");
                (laws.of)(inputs, c, &slip.choices)
            }
        }
    }

    /// The hypothesis' own bound: a multiple of that of the right formula in these conventions, plus the change of the wrong
    /// function on inputs that are off by a few roundings.
    fn bound(
        &self,
        question: &Question,
        case: &Case,
        wrong: &Arrays,
        error: Option<&Arrays>,
        options: &MarkOptions,
    ) -> Arrays {
        let moved: Vec<Arrays> = match self.known(error) {
            true => vec![],
            false => (0..2).flat_map(|n| self.moved(question, case, n, options)).collect(),
        };
        self.widened(question, case, wrong, error, &moved, options)
    }

    /// The same, after what costs less: a bound without that change, which most answers that are explained are within, and a wide one with
    /// half of it, which most of the others aren't within.
    fn bounds<'a>(
        &'a self,
        question: &'a Question,
        case: &'a Case,
        wrong: &'a Arrays,
        error: Option<&'a Arrays>,
        options: &'a MarkOptions,
    ) -> impl Iterator<Item = Bound> + 'a {
        let mut moved = vec![];
        (0..if self.known(error) { 1 } else { 3 }).map(move |n| {
            if n > 0 {
                moved.extend(self.moved(question, case, n - 1, options));
            }
            let mut bound = self.widened(question, case, wrong, error, &moved, options);
            if n != 1 {
                return Bound::Enough(bound);
            }
            bound.values_mut().for_each(|bound| *bound *= WIDE);
            Bound::Needed(bound)
        })
    }

    /// Whether the bound is known without nudging inputs. Next to a whole number a nudge moves what is rounded by 1: so wide a bound explains
    /// anything.
    fn known(&self, error: Option<&Arrays>) -> bool {
        let rounds = self.slip.as_ref().is_some_and(Slip::rounds);
        error.is_some() || rounds || self.right() && !self.loose
    }

    /// The wrong function on inputs that are off by a few roundings. Both signs of them: across a threshold only one of the two goes.
    fn moved(&self, question: &Question, case: &Case, n: u64, options: &MarkOptions) -> [Arrays; 2] {
        let by = 4.0 * options.dtype.unit_roundoff();
        [by, -by].map(|by| {
            let inputs = || nudged(question, case, n, by);
            self.wrong(question, &question.truths.nudged(case, (n, by.to_bits()), inputs))
        })
    }

    /// The bound with the change of the wrong function to what it gives on nudged inputs, `moved`.
    pub(super) fn widened(
        &self,
        question: &Question,
        case: &Case,
        wrong: &Arrays,
        error: Option<&Arrays>,
        moved: &[Arrays],
        options: &MarkOptions,
    ) -> Arrays {
        let known = options.truth(question, case, &self.conventions, Grade::B);
        let (truth, right) = (&known.expected, &known.bound);
        if self.right() && !self.loose {
            return right.clone();
        }
        let u = options.dtype.unit_roundoff();
        let (generous, mut roundings) = generosity(options.dtype);
        // A wrong sum or product may be as long as any axis.
        let longest = case.inputs.values().flat_map(|a| a.shape()).max().copied().unwrap_or(0);
        roundings = roundings.max(2.0 * longest as f64);
        // A mistake may return one fraction in place of another: T, of which 1 - exp(-x) leaves few digits, in place of T alpha.
        let whole = |name: &String| question.component.output_entries(name).whole();
        let fractions = |name: &String| !whole(name) && truth[name].iter().all(|x| (0.0..=1.0).contains(x));
        let of_fractions = right.iter().filter(|(name, _)| fractions(name)).flat_map(|(_, bound)| bound);
        let largest = of_fractions.filter(|b| b.is_finite()).fold(0.0, |max: f64, b| max.max(*b));
        let of_one = |name: &String| question.component.special.left_of_one.contains(&name.as_str());
        let one = |(name, w): (&String, &ArrayD<f64>)| {
            let least = if of_one(name) && question.kind == Kind::Forward { 1.0 } else { 0.0 };
            let mut bound = w.mapv(|w| roundings * u * w.abs().max(least) + options.dtype.smallest_normal());
            let least = if fractions(name) { largest } else { 0.0 };
            // What comes out larger has rounded larger numbers.
            let larger =
                (largest_of(w) / truth.get(name).map_or(f64::INFINITY, largest_of)).clamp(1.0, LARGER);
            match right.get(name) {
                Some(right) if right.shape() == w.shape() => {
                    bound.zip_mut_with(right, |b, right| *b += generous * (larger * right).max(least));
                }
                // Elements in other places: which of the bounds is whose isn't known.
                Some(right) => {
                    let most = right.iter().filter(|b| b.is_finite()).fold(0.0, |max: f64, b| max.max(*b));
                    bound += generous * most;
                }
                None => {}
            }
            for moved in moved.iter().filter_map(|m| m.get(name)).filter(|m| m.shape() == w.shape()) {
                // No number where both are infinite, or where a nudge makes one of what was none: it says nothing of sizes.
                let change = (moved - w).mapv(|change| if change.is_nan() { 0.0 } else { change.abs() });
                bound.zip_mut_with(&change, |b, change| *b += generous * change);
            }
            if let Some(error) = error {
                bound += &error[name];
            }
            // Where the wrong value itself is NaN or infinite, only that fits. Where it overflows the type, or a factor of it does, the
            // answer may be infinite.
            let limited = |w: f64, b: f64| match () {
                () if !w.is_finite() || b.is_nan() => 0.0,
                () if w.abs() > options.dtype.largest() / 4.0 => f64::INFINITY,
                () => b,
            };
            bound.zip_mut_with(w, |b, &w| *b = limited(w, *b));
            (name.clone(), bound)
        };
        wrong.iter().map(one).collect()
    }

    /// What this candidate would answer, and how far off it may be.
    pub(crate) fn allowed(
        &self,
        question: &Question,
        case: &Case,
        options: &MarkOptions,
    ) -> (Arrays, Arrays) {
        let (wrong, error) = self.prediction(question, case);
        let bound = self.bound(question, case, &wrong, error.as_ref(), options);
        (wrong, bound)
    }

    /// What is far off: wrong code may be of any accuracy.
    fn scale(&self, question: &Question, case: &Case, options: &MarkOptions) -> Option<Scale> {
        let scale = options.scale(question, case);
        if self.right() && !self.loose { scale } else { scale.map(Scale::of_wrong) }
    }

    /// Whether it explains an answer.
    pub fn explains(&self, question: &Question, case: &Case, answer: &Answer, options: &MarkOptions) -> bool {
        if self.misses_a_few(question, case, answer, options) {
            return false;
        }
        let (mut wrong, error) = self.prediction(question, case);
        self.leave_open(question, case, answer, &mut wrong);
        // A numeric gradient is known only at some elements, so most elements can't be compared.
        let scale = self.scale(question, case, options).filter(|_| error.is_none());
        within(answer, &wrong, scale, self.bounds(question, case, &wrong, error.as_ref(), options))
            || error
                .is_some_and(|error| self.explains_rounded(question, case, answer, &(wrong, error), options))
    }

    /// Keeps the outputs of an answer that it explains one by one; those that weren't answered stay. What it predicts comes back.
    pub(crate) fn keep_explained(
        &self,
        question: &Question,
        case: &Case,
        answer: &Answer,
        options: &MarkOptions,
        outputs: &mut Vec<&str>,
    ) -> Arrays {
        let (predicted, _) = self.prediction(question, case);
        let asked: Answer = outputs
            .iter()
            .filter_map(|name| answer.get(*name).map(|given| (name.to_string(), given.clone())))
            .collect();
        let mut wrong = predicted.clone();
        self.leave_open(question, case, answer, &mut wrong);
        // Whether an output is read another one says, be it asked or not.
        wrong.retain(|name, _| asked.contains_key(name));
        let bounds = self.bounds(question, case, &wrong, None, options);
        let explained = each_within(&asked, &wrong, self.scale(question, case, options), bounds);
        outputs.retain(|name| !asked.contains_key(*name) || explained.iter().any(|known| known == name));
        predicted
    }

    /// The largest error over bound on an answer.
    pub fn residual(&self, question: &Question, case: &Case, answer: &Answer, options: &MarkOptions) -> f64 {
        let (mut wrong, error) = self.prediction(question, case);
        self.leave_open(question, case, answer, &mut wrong);
        let bound = self.bound(question, case, &wrong, error.as_ref(), options);
        off(answer, &wrong, &bound).most
    }

    /// How far this hypothesis and another are off an answer, both over what this one allows and what is unknown of the other.
    pub(super) fn compared(
        &self,
        other: &Hypothesis,
        question: &Question,
        case: &Case,
        answer: &Answer,
        options: &MarkOptions,
    ) -> [Off; 2] {
        let (right, _) = self.prediction(question, case);
        let (mut wrong, error) = other.prediction(question, case);
        other.leave_open(question, case, answer, &mut wrong);
        let bound = self.bound(question, case, &right, error.as_ref(), options);
        [off(answer, &right, &bound), off(answer, &wrong, &bound)]
    }

    /// Whether two hypotheses predict the same on a case, up to rounding: no answer could tell them apart.
    pub fn same_as(
        &self,
        other: &Hypothesis,
        question: &Question,
        case: &Case,
        options: &MarkOptions,
    ) -> bool {
        let (a, error) = self.prediction(question, case);
        let (b, other_error) = other.prediction(question, case);
        if a == b {
            return true;
        }
        let mut bound = self.bound(question, case, &a, error.as_ref(), options);
        for (name, error) in other_error.iter().flatten() {
            if let Some(bound) = bound.get_mut(name).filter(|bound| bound.shape() == error.shape()) {
                *bound += error;
            }
        }
        let equal = |(name, a): (&String, &ArrayD<f64>)| {
            b[name].shape() == a.shape()
                && a.iter().zip(&b[name]).zip(&bound[name]).all(|((&a, &b), &e)| budget_used(b, a, e) <= 1.0)
        };
        a.iter().all(equal)
    }
}

/// A case's inputs, off by up to `relative`.
pub(super) fn nudged(question: &Question, case: &Case, n: u64, relative: f64) -> Arrays {
    let mut draw = Draw::new(&case.id, n);
    let mut inputs = Arrays::clone(&case.inputs);
    for (name, array) in inputs.iter_mut().filter(|(_, array)| array.ndim() > 0) {
        let whole = question.component.input_entries(name).whole();
        array.mapv_inplace(|x| {
            let by = if draw.below(2) == 0 { relative } else { -relative };
            // 1 is the limit of what is a fraction; what is counted isn't rounded.
            let by = if x.abs() == 1.0 { -by.abs() } else { by };
            if whole { x } else { x * (1.0 + by) }
        });
    }
    (question.component.special.rounds_inside)(&mut inputs, relative, &mut draw);
    inputs
}

/// What four nudges move is taken to be less than so many times what two of them do.
const WIDE: f64 = 64.0;

/// How many times larger than right answers wrong ones may be so that rounding costs them so much more.
pub(super) const LARGER: f64 = 64.0;

/// Whether some of the mistakes lie in the forward function.
pub fn of_forward(question: &Question, mistakes: &[&str]) -> bool {
    question.component.mistakes.iter().any(|m| !m.gradient && mistakes.contains(&m.name))
}

#[cfg(test)]
mod tests {
    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::super::slips::each::{By, EACH};
    use super::super::slips::slip::{ArraySlip, Change};
    use super::*;
    use crate::contract::arrays::{array, arrays};
    use crate::convention::CS180;

    /// Edges of 2, 3, 5 that are nudged and then rounded down are 1, 2, 4: so wide a bound would explain any sample.
    #[test]
    fn what_is_rounded_is_not_nudged_across_whole_numbers() {
        let exam = Exam::new("importance_sampling", Dtype::F32, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 });
        let case = question.cases.iter().find(|case| case.id == "SA1_empty_ray").expect("a case");
        let down = EACH.iter().position(|(name, _)| *name == "rounded down").expect("a slip");
        let change = Change::All(By::Each(down));
        let slip = ArraySlip { input: true, array: "edges".into(), change, forward: true };
        let h = Hypothesis { slip: Some(Slip::Array(slip)), ..Hypothesis::new(vec![], CS180) };
        let (own, _) = h.prediction(question, case);
        assert!(h.explains(question, case, &given(own.clone()), &options));
        let last = array(own["t"].shape(), vec![5.0; own["t"].len()]);
        assert!(!h.explains(question, case, &given(arrays([("t", last)])), &options));
    }
}
