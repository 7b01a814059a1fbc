//! Numeric gradients of wrong code on inputs that are off by a few roundings: next to a pole these change more than a bound has room for.

use super::super::answer::Answer;
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::within::{off, within};
use super::hypothesis::{Hypothesis, nudged};
use super::slips::slip::Slip;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;

/// By how many times its bound an answer may miss a numeric gradient so that rounded inputs may be why.
const NEARLY: f64 = 64.0;

impl Hypothesis {
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
            let inputs = nudged(question, case, n, by * u);
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
            let inputs = nudged(question, case, n, 4.0 * options.dtype.unit_roundoff());
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
}
