//! Slips of the formula: any one operation of it done in another way. Honest implementations say which operations there are; one of
//! them with a fault in it is a hypothesis like any other.

use std::collections::{BTreeMap, BTreeSet};
use std::panic::{self, AssertUnwindSafe};

use super::answer::{Answer, Answers, reshaped};
use super::assignment::small_cases;
use super::evidence::Explanation;
use super::exam::Question;
use super::hypothesis::Hypothesis;
use super::infix;
use super::mark::MarkOptions;
use super::slip::Slip;
use super::slips::{conventions, explanations, was_done};
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::check::Kind;
use crate::contract::component::Honest;
use crate::contract::fault::{Fault, How, Operation, Seen, Site};
use crate::contract::machine::Machine;
use crate::convention::Conventions;
use crate::parallel;

/// Machines whose ways to the result are looked at.
const MACHINES: u64 = 48;

/// Cases on which operations are looked for: some are only done on some inputs.
const CASES: usize = 8;

/// Operations that all hypotheses together may cost on the smallest case.
const WORK: usize = 30_000_000;

/// In how many ways an operation can be done wrong, about; and how often a number is tried before it is known.
const WAYS: usize = 12;
const TRIALS: usize = 150;

/// So many different numbers must be wrong, each by more than this part of it.
const TELLING: usize = 3;
const WRONG: f64 = 1e-3;

/// Bits of evidence beside those that so many hypotheses have by chance; and those of one number, at most.
const SURE: f64 = 20.0;
const MOST_BITS: f64 = 16.0;

/// Between which numbers a factor is looked for, and a summand.
const FACTORS: [f64; 11] = [-4.0, -1.01, -0.3, 0.0, 0.4, 0.7, 0.99, 1.01, 1.5, 4.0, 64.0];
const SUMMANDS: [f64; 16] =
    [-10.0, -1.0, -0.1, -1e-3, -1e-5, -1e-7, -1e-10, -1e-20, 1e-20, 1e-10, 1e-7, 1e-5, 1e-3, 0.1, 1.0, 10.0];

/// What a hypothesis costs however short its formula is, in operations.
const LEAST: usize = 200;

/// A fault is stopped at so many times the operations of right code.
const PATIENCE: usize = 20;

/// A formula with one operation done in another way.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FormulaSlip {
    machine: u64,
    fault: Fault,
    operations: usize,
    /// Whether it is one of the forward function, also where a gradient is asked for.
    pub forward: bool,
}

impl FormulaSlip {
    /// What comes out.
    pub(crate) fn of(&self, inputs: &Arrays, c: &Conventions, honest: Honest) -> Arrays {
        Fault::begin(self.operations);
        honest(inputs, c, &machine(self.machine, self.fault))
    }

    /// What it says, on a line.
    pub(crate) fn says(&self) -> String {
        self.fault.site.map_or_else(String::new, |site| infix::says(&site, self.fault.how))
    }
}

fn machine(n: u64, fault: Fault) -> Machine {
    Machine { fault: Some(fault), ..Machine::number(Dtype::F64, n) }
}

/// The formulas with one slip that explain every answer, the likeliest first.
pub(super) fn misdone(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Vec<Explanation> {
    let cases = small_cases(question, answers);
    let shown = |c: &Conventions| telling(question, &cases, c, options);
    let tried = conventions(question, answers, base, options).into_iter().filter(|c| shown(c) >= TELLING);
    let tried: Vec<(Conventions, Vec<Place>)> = tried.map(|c| (c, places(question, &cases, &c))).collect();
    let explaining = |hypotheses: Vec<Hypothesis>, free: f64| {
        let tried = hypotheses.len() as f64;
        let fits = parallel::map(hypotheses.len(), |n| was_done(&hypotheses[n], question, answers, options));
        let mut found: Vec<_> =
            hypotheses.into_iter().zip(fits).filter(|(_, fits)| *fits).map(|(h, _)| h).collect();
        found.retain(|h| evidence(h, question, &cases, options) >= tried.log2() + SURE + free);
        explanations(found, question, answers, base, options)
    };
    let mut all: Vec<(usize, Hypothesis)> = vec![];
    for (c, places) in &tried {
        let ways = |place: &Place| How::all(place.seen.site.operation).into_iter().enumerate();
        let each = |place: &Place| {
            let here = ways(place).filter(|(_, how)| place.first || how.of_parenthesis());
            here.map(|(n, how)| (n, place.hypothesis(how, c))).collect::<Vec<_>>()
        };
        all.extend(affordable(places, WAYS).iter().flat_map(each));
    }
    all.sort_by_key(|(rank, _)| *rank);
    let found = explaining(all.into_iter().map(|(_, h)| h).collect(), 0.0);
    if !found.is_empty() || tried.is_empty() {
        return found;
    }
    let (c, places) = &tried[0];
    // A number that is read off an element explains that one anyway.
    explaining(numbers(question, &cases, affordable(places, TRIALS), c, options), MOST_BITS)
}

/// By how many bits a slip explains the answers better than the right formula does, over the numbers that are wrong and different.
fn evidence(h: &Hypothesis, question: &Question, cases: &[(&Case, &Answer)], options: &MarkOptions) -> f64 {
    let right = Hypothesis::new(vec![], h.conventions);
    let mut bits: BTreeMap<u64, f64> = BTreeMap::new();
    for (case, answer) in cases {
        let (wrong, allowed) = h.allowed(question, case, options);
        for (name, p) in right.prediction(question, case).0 {
            let Some((got, _)) = answer.get(&name).and_then(|given| reshaped(&given.values, p.shape()))
            else {
                continue;
            };
            for (((&p, &got), &wrong), &allowed) in p.iter().zip(&got).zip(&wrong[&name]).zip(&allowed[&name])
            {
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

/// What anything could give.
fn plain(x: f64) -> bool {
    !x.is_finite() || x == 0.0 || x.abs() == 1.0
}

/// Different numbers that are wrong, but for those that anything could give. So many slips are tried that one of them may have one
/// number, or two, by chance.
fn telling(question: &Question, cases: &[(&Case, &Answer)], c: &Conventions, options: &MarkOptions) -> usize {
    let right = Hypothesis::new(vec![], *c);
    let mut all: BTreeSet<u64> = BTreeSet::new();
    for (case, answer) in
        cases.iter().filter(|(case, answer)| !right.explains(question, case, answer, options))
    {
        for (name, p) in right.prediction(question, case).0 {
            let Some((got, _)) = answer.get(&name).and_then(|given| reshaped(&given.values, p.shape()))
            else {
                continue;
            };
            let wrong = |(p, got): &(&f64, &f64)| (*got - *p).abs() > WRONG * p.abs().max(got.abs());
            let numbers = p.iter().zip(&got).filter(wrong).map(|(_, got)| *got);
            all.extend(numbers.filter(|got| !plain(*got)).map(|got| got.abs().to_bits()));
        }
    }
    all.len()
}

/// An operation of a formula that one of the machines does.
#[derive(Clone, Copy)]
struct Place {
    machine: u64,
    seen: Seen,
    /// What the formula costs on the smallest case, and what it may.
    cost: usize,
    operations: usize,
    forward: bool,
    /// Whether it is the first machine that does it.
    first: bool,
}

impl Place {
    fn hypothesis(&self, how: How, c: &Conventions) -> Hypothesis {
        let fault = Fault { site: Some(self.seen.site), how };
        let Place { machine, operations, forward, .. } = *self;
        let slip = FormulaSlip { machine, fault, operations, forward };
        Hypothesis { slip: Some(Slip::Formula(slip)), ..Hypothesis::new(vec![], *c) }
    }
}

/// The first places, as many as may be tried so often.
fn affordable(places: &[Place], ways: usize) -> &[Place] {
    let mut left = WORK;
    let fits = |place: &&Place| {
        left = left.saturating_sub(ways * place.cost);
        left > 0
    };
    &places[..places.iter().take_while(fits).count()]
}

/// Every operation that an honest implementation does.
fn places(question: &Question, cases: &[(&Case, &Answer)], c: &Conventions) -> Vec<Place> {
    let direction = question.component.direction(question.kind).expect("a question has its direction");
    let sites = |n, inputs| Fault::observed(|fault| drop((direction.honest)(inputs, c, &machine(n, fault))));
    let count = |all: &[Seen]| LEAST + all.iter().map(|seen| seen.times).sum::<usize>();
    let largest = cases.last().map_or(0, |(case, _)| count(&sites(0, &case.inputs)));
    let (operations, forward) = (PATIENCE * largest, question.kind == Kind::Forward);
    let (mut all, mut paths): (Vec<Place>, Vec<Vec<Site>>) = (vec![], vec![]);
    for n in 0..MACHINES {
        for (case, _) in cases.iter().take(CASES) {
            let found = sites(n, &case.inputs);
            let path: Vec<Site> = found.iter().map(|seen| seen.site).collect();
            let (cost, new) = (count(&found), !paths.contains(&path));
            for seen in found {
                let known = all.iter_mut().find(|place| place.seen.site == seen.site);
                let first = known.is_none();
                if let Some(place) = known {
                    place.seen.value = place.seen.value.filter(|had| Some(*had) == seen.value);
                }
                if first || new {
                    all.push(Place { machine: n, seen, cost, operations, forward, first });
                }
            }
            paths.push(path);
        }
    }
    all
}

/// Other numbers in the formula: constants, factors and summands, each as the element that is furthest off shows it.
fn numbers(
    question: &Question,
    cases: &[(&Case, &Answer)],
    places: &[Place],
    c: &Conventions,
    options: &MarkOptions,
) -> Vec<Hypothesis> {
    let Some(shown) = furthest(question, cases, c, options) else { return vec![] };
    let of = |place: &Place| -> Vec<(usize, Hypothesis)> {
        let constant = place.seen.value.filter(|_| place.seen.site.operation == Operation::Given);
        let mut kinds: Vec<(usize, &[f64], Box<dyn Fn(f64) -> How>)> = vec![];
        match constant {
            Some(value) => kinds.push((0, &FACTORS, Box::new(move |k| How::Taken(k * value)))),
            None => {
                kinds.push((1, &FACTORS, Box::new(How::Times)));
                kinds.push((2, &SUMMANDS, Box::new(How::Plus)));
            }
        }
        let mut all = vec![];
        for (rank, grid, how) in kinds {
            let value = |k: f64| shown.value(question, &place.hypothesis(how(k), c));
            for k in roots(grid, |k| value(k) - shown.got) {
                let k = match how(k) {
                    How::Taken(x) => rounded(x).map(How::Taken),
                    How::Times(x) => rounded(x).map(How::Times),
                    _ => rounded(k).map(How::Plus),
                };
                all.extend(k.map(|how| (rank, place.hypothesis(how, c))));
            }
        }
        all
    };
    let mut all: Vec<_> =
        parallel::map(places.len(), |n| if places[n].first { of(&places[n]) } else { vec![] })
            .into_iter()
            .flatten()
            .collect();
    all.sort_by_key(|(rank, _)| *rank);
    all.into_iter().map(|(_, h)| h).collect()
}

/// As people write it, and as it is.
fn rounded(x: f64) -> [f64; 2] {
    [format!("{x:.3e}").parse().unwrap_or(x), x]
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
        let all = panic::catch_unwind(AssertUnwindSafe(|| h.prediction(question, self.case).0));
        let found = all.ok().and_then(|all| all.get(&self.output)?.iter().nth(self.index).copied());
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
        for (name, p) in right.prediction(question, case).0 {
            let Some((got, _)) = answer.get(&name).and_then(|given| reshaped(&given.values, p.shape()))
            else {
                continue;
            };
            for (index, (&p, &got)) in p.iter().zip(&got).enumerate() {
                let off = (got - p).abs() / p.abs().max(got.abs());
                if off.is_finite() && best.as_ref().is_none_or(|(most, _)| off > *most) {
                    best = Some((off, Shown { case: *case, output: name.clone(), index, got }));
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

#[cfg(test)]
mod tests {
    use super::super::answer::given;
    use super::super::exam::Exam;
    use super::super::judging::{EXP_ULP, judge_answers};
    use super::*;
    use crate::convention::CS180;
    use crate::registry::COMPONENTS;

    fn formula(h: Hypothesis) -> FormulaSlip {
        match h.slip {
            Some(Slip::Formula(slip)) => slip,
            _ => unreachable!("a slip of the formula"),
        }
    }

    /// The slip of a row's forward formula with these words.
    fn slip(question: &Question, says: &str) -> FormulaSlip {
        let right = |case: &Case| Some(given((question.component.forward.oracle)(&case.inputs, &CS180)));
        let answers: Answers = question.cases.iter().map(right).collect();
        let cases = small_cases(question, &answers);
        let slips = |place: &Place| {
            let all = How::all(place.seen.site.operation).into_iter();
            all.map(|how| formula(place.hypothesis(how, &CS180))).collect::<Vec<_>>()
        };
        let all: Vec<FormulaSlip> = places(question, &cases, &CS180).iter().flat_map(slips).collect();
        let found = all.iter().find(|slip| slip.says().starts_with(says));
        let said = || all.iter().map(FormulaSlip::says).collect::<Vec<_>>().join("\n");
        found.unwrap_or_else(|| panic!("{says} is none of\n{}", said())).clone()
    }

    #[test]
    fn an_operation_done_in_another_way_is_described() {
        for (component, says) in [
            ("conical_frustum", "d in the place of d * d"),
            ("ndc_rays", "2 in the place of 2 * view.focal"),
            ("adam_step", "sqrt(v_hat) + eps"),
        ] {
            for dtype in [Dtype::F64, Dtype::F32] {
                let exam = Exam::new(component, dtype, None).unwrap();
                let forward = exam.questions.iter().find(|q| q.kind == Kind::Forward).expect("each has one");
                let slip = slip(forward, says);
                let answer = |question: &Question, case: &Case| {
                    let of = slip.of(&case.inputs, &CS180, question.component.forward.honest);
                    given(of.into_iter().map(|(name, a)| (name, a.mapv(|x| dtype.round(x)))).collect())
                };
                let all = |q: &Question| -> Answers {
                    q.cases.iter().map(|case| (q.kind == Kind::Forward).then(|| answer(q, case))).collect()
                };
                let answers: Vec<Answers> = exam.questions.iter().map(all).collect();
                let report = judge_answers(&exam, &answers, EXP_ULP);
                let row =
                    report.rows.iter().find(|row| row.name == component && row.kind == "forward").unwrap();
                let best =
                    row.diagnosis.first().unwrap_or_else(|| panic!("{component} {dtype}: nothing is said"));
                let said = best.slip.as_ref().map(Slip::says);
                assert_eq!(said, Some(slip.says()), "{component} {dtype}");
            }
        }
    }

    #[test]
    fn right_formulas_are_right() {
        for component in COMPONENTS {
            for question in &Exam::new(component.name, Dtype::F64, None).unwrap().questions {
                if question.statistics() {
                    continue;
                }
                let direction = question.component.direction(question.kind).unwrap();
                let (case, _) = question
                    .cases
                    .iter()
                    .map(|case| (case, ()))
                    .min_by_key(|(case, ())| case.inputs.values().map(|a| a.len()).sum::<usize>())
                    .unwrap();
                let nothing = Fault { site: None, how: How::Opposite };
                Fault::begin(usize::MAX);
                let found = (direction.honest)(&case.inputs, &CS180, &machine(0, nothing));
                let right = (direction.oracle)(&case.inputs, &CS180);
                assert!(found.keys().eq(right.keys()), "{} {:?}", component.name, question.kind);
            }
        }
    }

    #[test]
    fn every_operation_can_be_tried_on_every_row() {
        for component in COMPONENTS {
            for question in &Exam::new(component.name, Dtype::F64, None).unwrap().questions {
                if question.statistics() {
                    continue;
                }
                let direction = question.component.direction(question.kind).unwrap();
                let right = |case: &Case| Some(given((direction.oracle)(&case.inputs, &CS180)));
                let answers: Answers = question.cases.iter().map(right).collect();
                let cases = small_cases(question, &answers);
                let all = places(question, &cases, &CS180);
                let ways = |place: &Place| {
                    let ways = How::all(place.seen.site.operation);
                    ways.into_iter().map(|how| place.hypothesis(how, &CS180)).collect::<Vec<_>>()
                };
                for h in all.iter().flat_map(ways).step_by(7) {
                    // It may break a rule that only right formulas keep; it may not go on for ever.
                    let _ = panic::catch_unwind(AssertUnwindSafe(|| h.prediction(question, cases[0].0)));
                }
            }
        }
    }
}
