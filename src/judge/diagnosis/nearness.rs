//! Conventions by how near to the answers the right formula is in them: where a row has thousands, those that change least aren't those that a
//! program follows, and a mistake hides none of them from all answers.

use ndarray::ArrayD;

use super::super::answer::{Answer, Answers, reshaped};
use super::super::assignment::{open, small_cases};
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::super::partial::{Partial, apply};
use super::hypothesis::Hypothesis;
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::convention::Conventions;
use crate::parallel;

/// The smallest cases go by this many.
const CASES: usize = 3;

/// Elements that all of them together may compute.
const WORK: usize = 100_000_000;

/// The `kept` likeliest of those that the answers leave open.
pub(crate) fn likely(
    kept: usize,
    (question, answers): (&Question, &Answers),
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Conventions> {
    let open = open(question, answers, base, options);
    let likely = likeliest(open, kept, (question, answers), base, options);
    likely.iter().map(|p| apply(p, base)).collect()
}

/// The `kept` likeliest ones: by turns those that change least, which come first in `all`, and those in which the answers are nearest. All as
/// they are where there are no more.
pub(crate) fn likeliest(
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

/// How many bits of the answers are lost, on the average over each output's elements.
pub(crate) fn distance(h: &Hypothesis, question: &Question, cases: &[(&Case, &Answer)], dtype: Dtype) -> f64 {
    let one = |(case, answer): &(&Case, &Answer)| {
        let (mut predicted, _) = h.prediction(question, case);
        let open = |all: &Arrays| all.values().flatten().filter(|x| x.is_nan()).count();
        let before = open(&predicted);
        h.leave_open(question, case, answer, &mut predicted);
        // What is left open is worth a bit less than what is said.
        let left = before > open(&predicted);
        let each = answer.iter().filter_map(|(name, given)| {
            let predicted = predicted.get(name)?;
            let got = reshaped(&given.values, predicted.shape());
            Some(got.map_or(WORST, |(got, _)| lost(&got, predicted, dtype)))
        });
        let each = each.chain(left.then_some(OPEN));
        each.sum::<f64>() / answer.len().max(1) as f64
    };
    cases.iter().map(one).sum::<f64>() / cases.len().max(1) as f64
}

/// Bits that are lost where an answer has another shape, or no number; and where a mistake leaves some of it open.
const WORST: f64 = 24.0;
const OPEN: f64 = 1.0;

/// Bits that an output has lost, on the average.
fn lost(got: &ArrayD<f64>, predicted: &ArrayD<f64>, dtype: Dtype) -> f64 {
    let unit = 64.0 * dtype.unit_roundoff().max(Dtype::F32.unit_roundoff());
    let of = |(g, p): (&f64, &f64)| match () {
        () if g == p || g.is_nan() && p.is_nan() => 0.0,
        () if !g.is_finite() || !p.is_finite() => WORST,
        () => (1.0 + (g - p).abs() / (unit * g.abs().max(p.abs()))).log2().min(WORST),
    };
    got.iter().zip(predicted).map(of).sum::<f64>() / got.len().max(1) as f64
}
