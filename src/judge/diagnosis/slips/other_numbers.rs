//! Another number in a formula: a constant of 0.1 where 0.3 should be, a factor, something small that is added. It is read off the
//! element of the answers that is furthest off, place by place.

use super::super::super::answer::{Answer, beside};
use super::super::super::exam::Question;
use super::super::super::mark::MarkOptions;
use super::super::hypothesis::Hypothesis;
use super::each::rounded;
use super::places::Place;
use super::slipping::attempt;
use crate::contract::case::Case;
use crate::contract::how::How;
use crate::contract::operation::Operation;
use crate::convention::Conventions;
use crate::parallel;

/// How often a number is tried before it is known, about.
pub(super) const TRIALS: usize = 150;

/// Between which numbers a factor is looked for, a number for one that changes, and a summand.
const FACTORS: [f64; 11] = [-4.0, -1.01, -0.3, 0.0, 0.4, 0.7, 0.99, 1.01, 1.5, 4.0, 64.0];
const NUMBERS: [f64; 10] = [-100.0, -10.0, -1.01, -0.1, 0.1, 0.99, 1.01, 5.0, 50.0, 300.0];
const SUMMANDS: [f64; 16] =
    [-10.0, -1.0, -0.1, -1e-3, -1e-5, -1e-7, -1e-10, -1e-20, 1e-20, 1e-10, 1e-7, 1e-5, 1e-3, 0.1, 1.0, 10.0];

/// Other numbers in the formula: constants, factors and summands, each as the element that is furthest off shows it.
pub(super) fn other_numbers(
    question: &Question,
    cases: &[(&Case, &Answer)],
    places: &[Place],
    c: &Conventions,
    options: &MarkOptions,
) -> Vec<Hypothesis> {
    let Some(shown) = furthest(question, cases, c, options) else { return vec![] };
    let places: Vec<&Place> = places.iter().filter(|place| place.first).collect();
    let all = parallel::map(places.len(), |n| at(places[n], &shown, question, c));
    let mut all: Vec<_> = all.into_iter().flatten().collect();
    all.sort_by_key(|(rank, _)| *rank);
    all.into_iter().map(|(_, h)| h).collect()
}

/// At one place, each with its rank: a constant is likelier than a factor, and that likelier than something that is added.
fn at(place: &Place, shown: &Shown, question: &Question, c: &Conventions) -> Vec<(usize, Hypothesis)> {
    let found = |grid: &[f64], how: &dyn Fn(f64) -> How| -> Vec<f64> {
        roots(grid, |k| shown.value(question, &place.hypothesis(how(k), c)) - shown.got)
    };
    let each = |rank: usize, all: Vec<f64>, how: fn(f64) -> How| -> Vec<(usize, Hypothesis)> {
        all.into_iter().flat_map(rounded).map(|k| (rank, place.hypothesis(how(k), c))).collect()
    };
    let constant = place.seen.value.filter(|_| place.seen.site.operation == Operation::Given);
    if let Some(value) = constant {
        let factors = found(&FACTORS, &|k| How::Taken(k * value));
        return each(0, factors.into_iter().map(|k| k * value).collect(), How::Taken);
    }
    let mut all = each(1, found(&FACTORS, &How::Times), How::Times);
    if matches!(place.seen.site.operation, Operation::Given | Operation::Rounded) {
        all.extend(each(1, found(&NUMBERS, &How::Taken), How::Taken));
    }
    all.extend(each(2, found(&SUMMANDS, &How::Plus), How::Plus));
    all
}

/// An element of an answer.
struct Shown<'a> {
    case: &'a Case,
    output: String,
    index: usize,
    got: f64,
}

impl Shown<'_> {
    /// What a hypothesis has there.
    fn value(&self, question: &Question, h: &Hypothesis) -> f64 {
        let all = attempt(|| h.prediction(question, self.case).0);
        let found = all.and_then(|all| all.get(&self.output)?.iter().nth(self.index).copied());
        found.unwrap_or(f64::NAN)
    }
}

/// The element whose error is the largest part of what it should be.
fn furthest<'a>(
    question: &Question,
    cases: &[(&'a Case, &Answer)],
    c: &Conventions,
    options: &MarkOptions,
) -> Option<Shown<'a>> {
    let right = Hypothesis::new(vec![], *c);
    for (case, answer) in cases {
        if right.explains(question, case, answer, options) {
            continue;
        }
        let mut best: Option<(f64, Shown)> = None;
        let (expected, _) = right.prediction(question, case);
        for (name, p, got) in beside(answer, &expected) {
            for (index, (&p, &got)) in p.iter().zip(&got).enumerate() {
                let off = (got - p).abs() / p.abs().max(got.abs());
                if off.is_finite() && best.as_ref().is_none_or(|(most, _)| off > *most) {
                    best = Some((off, Shown { case, output: name.clone(), index, got }));
                }
            }
        }
        if best.is_some() {
            return best.map(|(_, shown)| shown);
        }
    }
    None
}

/// Where a function changes its sign, between neighbors on a grid.
fn roots(grid: &[f64], f: impl Fn(f64) -> f64) -> Vec<f64> {
    let values: Vec<f64> = grid.iter().map(|k| f(*k)).collect();
    let mut all = vec![];
    for n in 1..grid.len() {
        let ([mut a, mut b], [mut fa, fb]) = ([grid[n - 1], grid[n]], [values[n - 1], values[n]]);
        if !(fa.is_finite() && fb.is_finite()) || fa * fb > 0.0 || fa == 0.0 {
            continue;
        }
        // The middle in the number, or in its logarithm where it grows by more than twice.
        for _ in 0..60 {
            let middle = if a * b > 0.0 && (a / b).abs().max((b / a).abs()) > 2.0 {
                a.signum() * (a * b).sqrt()
            } else {
                0.5 * (a + b)
            };
            let fm = f(middle);
            if fm * fa > 0.0 { (a, fa) = (middle, fm) } else { b = middle }
        }
        all.push(0.5 * (a + b));
    }
    all
}
