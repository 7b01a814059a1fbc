//! Whether answers lie within their bounds: asked of thousands of hypotheses, most of which cost little to reject.

use std::collections::BTreeMap;
use std::sync::Arc;

use ndarray::{ArrayD, CowArray, IxDyn};

use super::answer::{Answer, in_shape, reshaped};
use super::exam::Question;
use super::mark::MarkOptions;
use super::truths::Truth;
use crate::contract::arithmetic::Grade;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::check::budget_used;
use crate::convention::CS180;

/// Answers in the shapes that are expected.
type Shaped<'a> = BTreeMap<&'a str, CowArray<'a, f64, IxDyn>>;

/// How far off answers may be, as far as is known for so little work.
pub(super) enum Bound {
    /// What is within it is explained.
    Enough(Arrays),
    /// What isn't within it isn't explained, but for one number of many, which may be across a threshold.
    Needed(Arrays),
}

impl From<Arrays> for Bound {
    fn from(bound: Arrays) -> Bound {
        Bound::Enough(bound)
    }
}

impl Bound {
    /// What it says of answers; `None` where that isn't known yet.
    fn says(&self, got: &Shaped, expected: &Arrays) -> Option<bool> {
        let (Bound::Enough(bound) | Bound::Needed(bound)) = self;
        let off = got.iter().flat_map(|(name, got)| {
            let pairs = got.iter().zip(&expected[*name]).zip(&bound[*name]);
            pairs
                .filter(|((g, e), b)| budget_used(**g, **e, **b) > 1.0 || budget_used(**g, **e, **b).is_nan())
        });
        let many = got.values().map(|got| got.len()).sum::<usize>() > 1;
        match self {
            Bound::Enough(_) => { off }.next().is_none().then_some(true),
            Bound::Needed(_) => { off }.nth(usize::from(many)).is_some().then_some(false),
        }
    }
}

/// Whether answers lie within one of these bounds, the cheapest first. A search calls this thousands of times, so it may reject answers
/// that are far off before the bounds are computed (see [`MarkOptions::may_reject_early`]).
pub(super) fn within(
    answer: &Answer,
    expected: &Arrays,
    scale: Option<Scale>,
    bounds: impl IntoIterator<Item: Into<Bound>>,
) -> bool {
    let Some(got) = near(answer, expected, scale.as_ref()) else { return false };
    bounds.into_iter().find_map(|bound| bound.into().says(&got, expected)).unwrap_or(false)
}

/// The outputs that lie within one of these bounds, each by itself.
pub(super) fn each_within(
    answer: &Answer,
    expected: &Arrays,
    scale: Option<Scale>,
    mut bounds: impl Iterator<Item = Bound>,
) -> Vec<String> {
    let one = |(name, e): (&String, &ArrayD<f64>)| -> Arrays { [(name.clone(), e.clone())].into() };
    let alone = expected.iter().map(one);
    let asked = alone.filter_map(|expected| Some((near(answer, &expected, scale.as_ref())?, expected)));
    let mut open: Vec<(Shaped, Arrays)> = asked.collect();
    let mut explained = vec![];
    while !open.is_empty() {
        let Some(bound) = bounds.next() else { break };
        open.retain(|(got, expected)| {
            let said = bound.says(got, expected);
            explained.extend(got.keys().filter(|_| said == Some(true)).map(|name| name.to_string()));
            said.is_none()
        });
    }
    explained
}

/// The answers in the shapes that are expected, where there are some and they aren't far off.
fn near<'a>(answer: &'a Answer, expected: &Arrays, scale: Option<&Scale>) -> Option<Shaped<'a>> {
    let mut got = Shaped::new();
    for (name, e) in expected {
        let Some((name, given)) = answer.get_key_value(name) else { continue };
        got.insert(name, in_shape(&given.values, e.shape())?);
    }
    (!got.is_empty() && !scale.is_some_and(|scale| scale.far_off(&got, expected))).then_some(got)
}

/// How far an answer is off.
#[derive(Clone, Copy, Default)]
pub(super) struct Off {
    /// The largest error over its bound.
    pub(super) most: f64,
    /// How many numbers aren't within it.
    pub(super) many: usize,
}

impl Off {
    pub(super) fn and(self, other: Off) -> Off {
        Off { most: self.most.max(other.most), many: self.many + other.many }
    }
}

/// How far an answer is off, over a bound.
pub(super) fn off(answer: &Answer, predicted: &Arrays, bound: &Arrays) -> Off {
    let one = |(name, predicted): (&String, &ArrayD<f64>)| {
        let got = reshaped(&answer.get(name)?.values, predicted.shape());
        let Some((got, _)) = got.filter(|_| bound[name].shape() == predicted.shape()) else {
            return Some(Off { most: f64::INFINITY, many: predicted.len() });
        };
        // NaN is off where nothing else is known, too.
        let used = |((&g, &p), &b): ((&f64, &f64), &f64)| {
            if g.is_nan() && !p.is_nan() { f64::INFINITY } else { budget_used(g, p, b) }
        };
        let each = got.iter().zip(predicted).zip(&bound[name]).map(used);
        Some(
            each.map(|used| Off { most: used, many: usize::from(used > 1.0) }).fold(Off::default(), Off::and),
        )
    };
    predicted.iter().filter_map(one).fold(Off::default(), Off::and)
}

/// Times the largest bound in the contract's own conventions, and parts of the largest element: honest code in others is nearer.
const FAR: f64 = 1024.0;
const PART: f64 = 1.0 / 64.0;

/// The largest of an array's numbers, of either sign.
pub(super) fn largest_of(array: &ArrayD<f64>) -> f64 {
    array.iter().filter(|x| x.is_finite()).fold(0.0, |max, x| max.max(x.abs()))
}

/// What is far off.
pub(super) struct Scale {
    /// The truth in the contract's own conventions, whose bound says how much arithmetic costs there; nothing where the questions have the
    /// shapes of other conventions.
    truth: Arc<Truth>,
    /// Parts of the largest element.
    part: f64,
}

impl Scale {
    /// The same for wrong code, which may be of any accuracy.
    pub(super) fn of_wrong(self) -> Scale {
        Scale { part: 0.25, ..self }
    }

    /// Whether most elements of an output are far off. One alone may be across a threshold.
    fn far_off(&self, got: &Shaped, expected: &Arrays) -> bool {
        got.iter().any(|(name, got)| {
            let expected = &expected[*name];
            let size = largest_of(expected);
            let bound = self.truth.bound.get(*name);
            let far = bound.map_or(0.25 * size, |bound| self.part * size + FAR * largest_of(bound)) + 1e-9;
            // What overflows a type is infinite there.
            let beyond = |g: f64, e: f64| g.is_infinite() && e.abs() > f64::from(f32::MAX) / 4.0;
            let near =
                |g: f64, e: f64| g == e || g.is_nan() && e.is_nan() || beyond(g, e) || (g - e).abs() <= far;
            let off = got.iter().zip(expected).filter(|&(&g, &e)| !near(g, e)).count();
            off > 1 && 2 * off > got.len()
        })
    }
}

impl MarkOptions {
    /// What an answer that may be rejected early is held against.
    pub(super) fn scale(&self, question: &Question, case: &Case) -> Option<Scale> {
        let own = || (question.component.special.admits)(&case.inputs, &CS180);
        let truth = || if own() { self.truth(question, case, &CS180, Grade::B) } else { Arc::default() };
        let scale = || self.may_reject_early(case).then(truth);
        let truth = question.truths.scale(case, (self.dtype, self.exp_ulp), scale)?;
        Some(Scale { truth, part: PART })
    }
}

#[cfg(test)]
mod tests {
    use super::super::assignment::admitted;
    use super::super::exam::Exam;
    use super::super::partial::apply;
    use super::*;
    use crate::contract::arithmetic::Dtype;
    use crate::contract::arrays::{array, arrays};

    /// What isn't within a bound that is needed is rejected, but for one number of many; what is within it may be anything.
    #[test]
    fn a_needed_bound_rejects_and_nothing_else() {
        let of = |values: Vec<f64>| arrays([("x", array(&[values.len()], values))]);
        let says = |got: Vec<f64>, made: fn(Arrays) -> Bound| {
            let (zeros, ones) = (of(vec![0.0; got.len()]), of(vec![1.0; got.len()]));
            made(ones).says(&shaped(&of(got)), &zeros)
        };
        assert_eq!(says(vec![0.5, -1.0, 1.0], Bound::Needed), None);
        assert_eq!(says(vec![0.5, 2.0, 1.0], Bound::Needed), None);
        assert_eq!(says(vec![0.5, 2.0, f64::NAN], Bound::Needed), Some(false));
        assert_eq!(says(vec![2.0], Bound::Needed), Some(false));
        assert_eq!(says(vec![0.5, -1.0, 1.0], Bound::Enough), Some(true));
        assert_eq!(says(vec![0.5, 2.0, 1.0], Bound::Enough), None);
    }

    /// Whatever the conventions, an answer that uses all of its bounds.
    #[test]
    fn what_is_within_its_bounds_is_never_far_off() {
        let options = MarkOptions { dtype: Dtype::F32, exp_ulp: 4.0 };
        let mut asked = 0;
        for question in Exam::new("", Dtype::F32, None).unwrap().questions {
            let all: Vec<_> = admitted(&question, &CS180).iter().map(|p| apply(p, &CS180)).collect();
            let some = all.iter().step_by(all.len().div_ceil(6).max(1));
            for (c, case) in some.flat_map(|c| small(&question).map(move |case| (c, case))) {
                let Some(scale) = options.scale(&question, case) else { continue };
                let truth = options.truth(&question, case, c, Grade::B);
                let used = |(name, e): (&String, &ArrayD<f64>)| {
                    let bound = truth.bound[name].mapv(|bound| if bound.is_finite() { bound } else { 0.0 });
                    (name.clone(), e + &bound)
                };
                let got: Arrays = truth.expected.iter().map(used).collect();
                let far = scale.far_off(&shaped(&got), &truth.expected);
                // In some conventions a question lies on a face, a threshold or at no gradient: bounds are as wide as answers there.
                let wide =
                    (Scale { truth: Arc::default(), part: PART }).far_off(&shaped(&got), &truth.expected);
                assert!(!far || wide, "{} {} {c:?}", question.component.name, case.id);
                asked += 1;
            }
        }
        assert!(asked > 1000, "{asked}");
    }

    fn shaped(arrays: &Arrays) -> Shaped<'_> {
        arrays.iter().map(|(name, array)| (name.as_str(), array.into())).collect()
    }

    fn small(question: &Question) -> impl Iterator<Item = &Case> {
        let small = |case: &&Case| case.size() < 2_000;
        question.cases.iter().filter(small)
    }
}
