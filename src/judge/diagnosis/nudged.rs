//! Numeric gradients of wrong code on inputs that are off by a few roundings: next to a pole these change more than a bound has room for.

use super::super::answer::Answer;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::within::{off, within};
use super::hypothesis::{Hypothesis, LARGER, nudged};
use super::numeric;
use super::slips::slip::Slip;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;

/// By how many times its bound an answer may miss a numeric gradient so that rounded inputs may be why.
const NEARLY: f64 = 64.0;

/// One in so many of the elements that are looked at is differentiated first: two of a long array. Most of what is tried for a network is off
/// at some of these.
const ONE_IN: usize = numeric::SAMPLED / 2;

impl Hypothesis {
    /// Whether an answer misses a few elements of a numeric gradient by so much that the others needn't be known.
    pub(super) fn misses_a_few(
        &self,
        question: &Question,
        case: &Case,
        answer: &Answer,
        options: &MarkOptions,
    ) -> bool {
        if !self.numeric(question) || case.size() <= numeric::SAMPLED {
            return false;
        }
        let (mut gradient, error) = self.gradient(question, case, ONE_IN);
        self.leave_open(question, case, answer, &mut gradient);
        let bound = self.widened(question, case, &gradient, Some(&error), &[], options);
        // With all elements known the bound of these may be wider: by what is largest among them.
        off(answer, &gradient, &bound).most > LARGER * NEARLY
    }

    /// Whether an answer misses a numeric gradient, with its error, by no more than rounded inputs change it: next to a pole they do. It is
    /// asked of what is nearly right alone, for each change is a gradient more.
    pub(super) fn explains_rounded(
        &self,
        question: &Question,
        case: &Case,
        answer: &Answer,
        (gradient, error): &(Arrays, Arrays),
        options: &MarkOptions,
    ) -> bool {
        let bound = self.widened(question, case, gradient, Some(error), &[], options);
        let rounds = self.slip.as_ref().is_some_and(Slip::rounds);
        if rounds || off(answer, gradient, &bound).most > NEARLY {
            return false;
        }
        let u = options.dtype.unit_roundoff();
        let moved = |(n, by)| {
            let inputs = nudged(question, case, n, by * u).into();
            let (mut moved, error) = self.prediction(question, &Case { inputs, ..case.clone() });
            for (name, moved) in &mut moved {
                let known = error.as_ref().and_then(|error| error.get(name));
                let pairs = gradient[name].iter().zip(known.into_iter().flatten());
                // What isn't known says nothing of how it changes.
                moved
                    .iter_mut()
                    .zip(pairs)
                    .filter(|(_, (_, e))| e.is_infinite())
                    .for_each(|(m, (g, _))| *m = *g);
            }
            moved
        };
        let moved: Vec<Arrays> = [(0, 4.0), (0, -4.0), (1, 4.0), (1, -4.0)].map(moved).into();
        within(answer, gradient, None, [self.widened(question, case, gradient, Some(error), &moved, options)])
    }
}

#[cfg(test)]
mod tests {
    use ndarray::ArrayD;

    use super::super::super::answer::given;
    use super::super::super::exam::Exam;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::check::Kind;
    use crate::convention::CS180;

    /// Shares of a hundred thousandth divide what is rounded by little: gradients in f32 are off by more than differences are.
    #[test]
    fn rounded_inputs_may_be_why_a_gradient_is_off_by_little() {
        let exam = Exam::new("importance_sampling", Dtype::F32, None).unwrap();
        let question = exam.questions.iter().find(|q| q.kind == Kind::Vjp).expect("it has a gradient");
        let options = MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 };
        let case = question.cases.iter().find(|case| case.id == "SA2_faint_shares").expect("a case");
        let h = Hypothesis::new(vec!["no_leading_zero"], CS180);
        let (gradient, error) = h.prediction(question, case);
        let error = error.expect("it is numeric");
        let bound = h.widened(question, case, &gradient, Some(&error), &[], &options);
        // What is answered where inputs are off by a few roundings, as far as it is known.
        let answered = |n: u64| {
            let inputs = nudged(question, case, n, 4.0 * options.dtype.unit_roundoff()).into();
            given(h.prediction(question, &Case { inputs, ..case.clone() }).0)
        };
        let missed: Vec<_> = (2..32)
            .map(answered)
            .filter(|answer| (1.0..NEARLY).contains(&off(answer, &gradient, &bound).most))
            .collect();
        let explained = missed.iter().filter(|answer| h.explains(question, case, answer, &options)).count();
        assert!(explained > 0 && 4 * explained >= 3 * missed.len(), "{explained} of {}", missed.len());
        let far = |(name, g): (&String, &ArrayD<f64>)| {
            let by = bound[name].mapv(|b| if b.is_finite() { 100.0 * NEARLY * b } else { 0.0 });
            (name.clone(), g + &by)
        };
        assert!(!h.explains(question, case, &given(gradient.iter().map(far).collect()), &options));
    }

    /// What a few elements reject all of them reject.
    #[test]
    fn a_few_elements_reject_nothing_that_all_explain() {
        let exam = Exam::new("mlp", Dtype::F32, None).unwrap();
        let question = exam.questions.iter().find(|q| q.component.name == "mlp" && q.kind == Kind::Vjp);
        let (question, options) = (question.expect("a row"), MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 });
        let case = question.cases.iter().find(|case| case.size() > 2 * numeric::SAMPLED).expect("a long one");
        let forward = question.component.mistakes.iter().filter(|m| !m.gradient);
        let each: Vec<_> = forward.map(|m| Hypothesis::new(vec![m.name], CS180)).collect();
        let answers: Vec<_> = each.iter().map(|h| given(h.prediction(question, case).0)).collect();
        let mut rejected = 0;
        for (h, answer) in each.iter().flat_map(|h| answers.iter().map(move |answer| (h, answer))) {
            if h.misses_a_few(question, case, answer, &options) {
                let (gradient, error) = h.gradient(question, case, 1);
                let bound = h.widened(question, case, &gradient, Some(&error), &[], &options);
                assert!(off(answer, &gradient, &bound).most > NEARLY, "{:?}", h.mistakes);
                rejected += 1;
            }
        }
        let others = each.len() * (each.len() - 1);
        assert!(2 * rejected > others && rejected <= others, "{rejected} of {others}");
    }
}
