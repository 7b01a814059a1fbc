//! How much answers tell: so many slips are tried that one of them may have a number, or two, by chance.

use std::collections::{BTreeMap, BTreeSet};

use ndarray::ArrayD;

use super::super::answer::{Answer, beside};
use super::super::exam::Question;
use super::super::mark::MarkOptions;
use super::hypothesis::Hypothesis;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::convention::Conventions;

/// So many different numbers must be wrong, each by more than this part of it.
pub(crate) const TELLING: usize = 3;
const WRONG: f64 = 1e-3;

/// Bits of evidence beside those that so many hypotheses have by chance; and those of one number, at most.
pub(crate) const SURE: f64 = 20.0;
pub(crate) const MOST_BITS: f64 = 16.0;

/// The same of a part of a formula, beside those of its choices: the whole has been shown.
pub(crate) const SHOWN_PART: f64 = 4.0;

/// The bits that one of so many hypotheses has by chance.
pub(crate) fn by_chance(tried: usize) -> f64 {
    (tried.max(1) as f64).log2()
}

/// By how many bits a hypothesis explains the answers better than another does, over the numbers that are wrong by that one and different.
/// In its own conventions a slip may do nothing but undo one of them.
pub(crate) fn evidence(
    h: &Hypothesis,
    other: &Hypothesis,
    question: &Question,
    cases: &[(&Case, &Answer)],
    options: &MarkOptions,
) -> f64 {
    let mut bits: BTreeMap<u64, f64> = BTreeMap::new();
    for (case, answer) in cases {
        let (wrong, allowed) = h.allowed(question, case, options);
        let (expected, _) = other.prediction(question, case);
        // In conventions of another shape it explains nothing.
        let shape = |of: &Arrays, name: &String| of.get(name).map(|array| array.shape().to_vec());
        if answer.keys().any(|name| shape(&expected, name) != shape(&wrong, name)) {
            return f64::INFINITY;
        }
        for (name, p, got) in beside(answer, &expected) {
            for (((&p, &got), &wrong), &allowed) in p.iter().zip(&got).zip(&wrong[name]).zip(&allowed[name]) {
                let gained = ((got - p).abs() / allowed.max((got - wrong).abs())).log2();
                if !plain(got) && gained > 0.0 {
                    let known = bits.entry(got.abs().to_bits()).or_insert(0.0);
                    *known = known.max(gained.min(MOST_BITS));
                }
            }
        }
    }
    bits.values().sum()
}

/// Whether it says a number that stands in several places, where the right formula has others: no loss of digits gives the same again,
/// but for parts of a rounding.
pub(crate) fn repeats(
    h: &Hypothesis,
    question: &Question,
    cases: &[(&Case, &Answer)],
    options: &MarkOptions,
) -> bool {
    let right = Hypothesis::new(vec![], h.conventions);
    let part = 0.5 * options.dtype.unit_roundoff();
    let mut times: BTreeMap<u64, usize> = BTreeMap::new();
    for (case, answer) in cases.iter().filter(|(case, _)| case.finite() && !h.numeric(question)) {
        let (wrong, _) = h.prediction(question, case);
        let (expected, _) = right.prediction(question, case);
        let alike =
            |name: &String| expected.get(name).map(ArrayD::shape) == wrong.get(name).map(ArrayD::shape);
        for (name, p, got) in beside(answer, &expected).filter(|(name, ..)| alike(name)) {
            for ((&p, &got), &wrong) in p.iter().zip(&got).zip(&wrong[name]) {
                let said =
                    got == options.dtype.round(wrong) && (got - p).abs() > WRONG * p.abs().max(got.abs());
                if said && !plain(got) && (got / part).fract() != 0.0 {
                    *times.entry(got.abs().to_bits()).or_default() += 1;
                }
            }
        }
    }
    times.values().any(|times| *times >= TELLING)
}

/// The same by places, not by numbers: what gives 0 or 1, or one number everywhere, is told by where it does.
pub(crate) fn evidence_of_places(
    h: &Hypothesis,
    other: &Hypothesis,
    question: &Question,
    cases: &[(&Case, &Answer)],
    options: &MarkOptions,
) -> f64 {
    let mut bits = 0.0;
    for (case, answer) in cases {
        let (said, allowed) = h.allowed(question, case, options);
        let (expected, _) = other.prediction(question, case);
        let alike =
            |name: &String| expected.get(name).map(ArrayD::shape) == said.get(name).map(ArrayD::shape);
        if !answer.keys().all(alike) {
            return f64::INFINITY;
        }
        for (name, p, got) in beside(answer, &expected) {
            for (((&p, &got), &said), &allowed) in p.iter().zip(&got).zip(&said[name]).zip(&allowed[name]) {
                let gained = ((got - p).abs() / allowed.max((got - said).abs())).log2();
                bits += if gained.is_nan() { 0.0 } else { gained.clamp(0.0, MOST_BITS) };
            }
        }
    }
    bits
}

/// What anything could give.
fn plain(x: f64) -> bool {
    !x.is_finite() || x == 0.0 || x.abs() == 1.0
}

/// Different numbers that are wrong, but for those that anything could give. So many slips are tried that one of them may have one
/// number, or two, by chance.
pub(crate) fn telling(
    question: &Question,
    cases: &[(&Case, &Answer)],
    c: &Conventions,
    options: &MarkOptions,
) -> usize {
    let right = Hypothesis::new(vec![], *c);
    let mut all: BTreeSet<u64> = BTreeSet::new();
    for (case, answer) in
        cases.iter().filter(|(case, answer)| !right.explains(question, case, answer, options))
    {
        let (expected, _) = right.prediction(question, case);
        for (_, p, got) in beside(answer, &expected) {
            let wrong = |(p, got): &(&f64, &f64)| (*got - *p).abs() > WRONG * p.abs().max(got.abs());
            let numbers = p.iter().zip(&got).filter(wrong).map(|(_, got)| *got);
            all.extend(numbers.filter(|got| !plain(*got)).map(|got| got.abs().to_bits()));
        }
    }
    all.len()
}
