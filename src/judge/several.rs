//! Several operations of a formula that are done in another way, found one after the other: each of them brings the answers nearer.

use super::answer::Answers;
use super::assignment::small_cases;
use super::climb::{CLOSE, NEARER, distance};
use super::exam::Question;
use super::formula_slip::FormulaSlip;
use super::hypothesis::Hypothesis;
use super::mark::MarkOptions;

use super::places::Place;
use super::slip::Slip;
use super::slipping::attempt;
use super::tried::Tried;
use crate::contract::fault::{AT_ONCE, How, Wrong};
use crate::parallel;

/// Conventions in which ways begin, the nearest first, and ways that are followed side by side.
const STARTS: usize = 6;
const WAYS: usize = 24;

/// The smallest cases go by this many.
const CASES: usize = 4;

/// Operations that all steps together may cost.
const WORK: usize = 60_000_000;

/// Operations that are done in another way, and how many bits of the answers are lost by them.
#[derive(Clone)]
struct Way<'a> {
    tried: &'a Tried,
    machine: u64,
    h: Hypothesis,
    off: f64,
}

/// What comes near to the answers, each beside the case that shows it first, and how many were tried.
pub(super) fn several(
    tried: &[Tried],
    question: &Question,
    answers: &Answers,
    options: &MarkOptions,
) -> (Vec<(usize, Hypothesis)>, usize) {
    let mut cases = small_cases(question, answers);
    cases.retain(|(case, _)| case.finite());
    cases.truncate(CASES);
    // Short types have too few digits to go by.
    if options.dtype.bits() < 24 || cases.is_empty() {
        return (vec![], 1);
    }
    let off =
        |h: &Hypothesis| attempt(|| distance(h, question, &cases, options.dtype)).unwrap_or(f64::INFINITY);
    let right = |t: &Tried| off(&Hypothesis::new(vec![], t.conventions));
    let mut starts: Vec<(f64, &Tried)> = tried.iter().map(|t| (right(t), t)).collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    starts.truncate(STARTS);
    let cost = starts.iter().map(|(_, t)| t.cost).max().unwrap_or(1) * cases.len();
    let (mut left, mut all) = (WORK / cost, 0);
    let first = starts.iter().flat_map(|(before, t)| {
        let places = t.places.iter().filter(|place| place.first);
        let each = places
            .flat_map(|place| ways(place).map(|how| (place.machine, place.hypothesis(how, &t.conventions))));
        each.map(|(machine, h)| Way { tried: t, machine, h, off: *before })
    });
    let mut next: Vec<Way> = first.collect();
    for n in 0..AT_ONCE {
        next.truncate(left);
        left -= next.len();
        all += next.len();
        let measured = parallel::map(next.len(), |n| off(&next[n].h));
        for (way, off) in next.iter_mut().zip(measured) {
            // What brings nothing nearer is no step.
            way.off = if off < way.off - NEARER { off } else { f64::INFINITY };
        }
        next.retain(|way| way.off.is_finite());
        next.sort_by(|a, b| a.off.total_cmp(&b.off));
        // What is as far off is the same, done in another place.
        next.dedup_by(|a, b| a.off == b.off);
        next.truncate(WAYS);
        // One alone was looked for before.
        let near: Vec<_> = next.iter().filter(|way| n > 0 && way.off < CLOSE).collect();
        if !near.is_empty() {
            return (near.into_iter().map(|way| (way.tried.failing, way.h.clone())).collect(), all);
        }
        next = next.iter().flat_map(steps).collect();
    }
    (vec![], all.max(1))
}

/// The ways to do it that need no other numbers than its own.
fn ways(place: &Place) -> impl Iterator<Item = How> {
    let all = How::all(place.seen.site.operation).into_iter().chain(place.seen.both());
    all.filter(|how| !how.of_parenthesis())
}

/// One operation more of the same machine.
fn steps<'a>(way: &Way<'a>) -> Vec<Way<'a>> {
    let Some(Slip::Formula(slip)) = &way.h.slip else { return vec![] };
    let others = way.tried.places.iter().filter(|place| place.machine == way.machine);
    let others = others.filter(|place| slip.fault.all().all(|wrong| wrong.site != place.seen.site));
    let each =
        others.flat_map(|place| ways(place).map(|how| Wrong { site: place.seen.site, how, nth: None }));
    let more = each.filter_map(|wrong| {
        let slip = Slip::Formula(FormulaSlip { fault: slip.fault.with(wrong)?, ..slip.clone() });
        Some(Way { h: Hypothesis { slip: Some(slip), ..way.h.clone() }, ..way.clone() })
    });
    more.collect()
}
