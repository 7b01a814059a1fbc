//! Several operations of a formula that are done in another way, found one after the other: each of them brings the answers nearer.

use super::super::super::answer::{Answer, Answers};
use super::super::super::assignment::small_cases;
use super::super::super::exam::Question;
use super::super::super::mark::MarkOptions;
use super::super::climb::{CLOSE, NEARER};
use super::super::evidence::{Explanation, real_numbers};
use super::super::hypothesis::Hypothesis;
use super::super::nearness::distance;
use super::formula_slip::FormulaSlip;
use super::places::{Place, count, sites};
use super::slip::Slip;
use super::slipping::attempt;
use super::tried::Tried;
use crate::contract::case::Case;
use crate::contract::fault::{AT_ONCE, Wrong};
use crate::contract::how::How;
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

/// The first that `prove` finds proved: it is asked with what comes near to the answers, each beside the case that shows it first, and with
/// how many were tried.
pub(super) fn several(
    tried: &[Tried],
    question: &Question,
    answers: &Answers,
    options: &MarkOptions,
    prove: &dyn Fn(Vec<(usize, Hypothesis)>, usize) -> Vec<Explanation>,
) -> Vec<Explanation> {
    let mut cases = small_cases(question, answers);
    cases.retain(|(case, _)| case.finite());
    cases.truncate(CASES);
    // Short types have too few digits to go by, and of bits and counts several of many explain a few cases by chance.
    if options.dtype.bits() < 24 || cases.is_empty() || !real_numbers(question, answers) {
        return vec![];
    }
    let off =
        |h: &Hypothesis| attempt(|| distance(h, question, &cases, options.dtype)).unwrap_or(f64::INFINITY);
    let starts = starts(tried, off);
    let cost = starts.iter().map(|(_, t)| cost(t, question, &cases)).max().unwrap_or(1);
    let (mut left, mut all) = (WORK / cost, 0);
    let mut next: Vec<Way> = starts.iter().flat_map(|(before, t)| first_steps(t, *before)).collect();
    for level in 0..AT_ONCE {
        // Each level has its share of what is left.
        next.truncate(left / (AT_ONCE - level));
        left -= next.len();
        all += next.len();
        let measured = parallel::map(next.len(), |n| off(&next[n].h));
        next = nearer(next, measured);
        let near = next.iter().filter(|way| way.off < CLOSE);
        let found = prove(near.map(|way| (way.tried.failing, way.h.clone())).collect(), all.max(1));
        if !found.is_empty() {
            return found;
        }
        next = next.iter().flat_map(steps).collect();
    }
    vec![]
}

/// The conventions that are nearest to the answers, and how far off these are.
fn starts(tried: &[Tried], off: impl Fn(&Hypothesis) -> f64) -> Vec<(f64, &Tried)> {
    let mut all: Vec<_> = tried.iter().map(|t| (off(&Hypothesis::new(vec![], t.conventions)), t)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.truncate(STARTS);
    all
}

/// Operations that a hypothesis costs on these cases.
fn cost(t: &Tried, question: &Question, cases: &[(&Case, &Answer)]) -> usize {
    cases.iter().map(|(case, _)| count(&sites(question, &t.conventions, 0, case))).sum()
}

/// The best of the ways that have come nearer, the nearest first.
fn nearer(ways: Vec<Way>, measured: Vec<f64>) -> Vec<Way> {
    let pairs = ways.into_iter().zip(measured).filter(|(way, off)| *off < way.off - NEARER);
    let mut all: Vec<Way> = pairs.map(|(way, off)| Way { off, ..way }).collect();
    all.sort_by(|a, b| a.off.total_cmp(&b.off));
    // What is as far off is mostly the same, done in another place. Where it isn't, the one leads to the other.
    all.dedup_by(|a, b| a.off == b.off);
    all.truncate(WAYS);
    all
}

/// One operation, each in the first machine that does it.
fn first_steps(t: &Tried, off: f64) -> impl Iterator<Item = Way<'_>> {
    let places = t.places.iter().filter(|place| place.first);
    let each = places
        .flat_map(|place| ways(place).map(|how| (place.machine, place.hypothesis(how, &t.conventions))));
    each.map(move |(machine, h)| Way { tried: t, machine, h, off })
}

/// The ways to do it that need no other numbers than its own.
fn ways(place: &Place) -> impl Iterator<Item = How> {
    let all = How::all(place.seen.site.operation).into_iter().chain(place.seen.both());
    all.filter(|how| !how.of_parenthesis())
}

/// One operation more of the same machine.
fn steps<'a>(way: &Way<'a>) -> Vec<Way<'a>> {
    let Some(Slip::Formula(slip)) = &way.h.slip else { return vec![] };
    // Each site once: cases that go by another path have the machine's known ones again.
    let mut others: Vec<&Place> = vec![];
    for place in way.tried.places.iter().filter(|place| place.machine == way.machine) {
        if !others.iter().any(|other| other.seen.site == place.seen.site) {
            others.push(place);
        }
    }
    let each = others
        .into_iter()
        .flat_map(|place| ways(place).map(|how| Wrong { site: place.seen.site, how, nth: None }));
    let more = each.filter_map(|wrong| {
        let slip = Slip::Formula(FormulaSlip { fault: slip.fault.with(wrong)?, ..slip.clone() });
        Some(Way { h: Hypothesis { slip: Some(slip), ..way.h.clone() }, ..way.clone() })
    });
    more.collect()
}
