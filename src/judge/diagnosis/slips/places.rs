//! Where a formula can slip: every operation that one of the honest machines does.

use super::super::super::answer::Answer;
use super::super::super::exam::Question;
use super::super::hypothesis::Hypothesis;
use super::formula_slip::{FormulaSlip, machine};
use super::slip::Slip;
use crate::contract::case::Case;
use crate::contract::check::Kind;
use crate::contract::fault::{Fault, Nth, Wrong};
use crate::contract::how::How;
use crate::contract::seen::Seen;
use crate::contract::site::Site;
use crate::convention::Conventions;

/// Machines whose ways to the result are looked at.
const MACHINES: u64 = 48;

/// What a hypothesis costs however short its formula is, in operations.
const LEAST: usize = 200;

/// Of what is done more often for a point no single time is looked at.
const MOST_TIMES: usize = 16;

/// A fault is stopped at so many times the operations of right code.
const PATIENCE: usize = 20;

/// An operation of a formula that one of the machines does.
#[derive(Clone)]
pub(super) struct Place {
    pub(super) machine: u64,
    pub(super) seen: Seen,
    /// What the formula may cost on any case.
    operations: usize,
    forward: bool,
    /// Whether it is the first machine that does it.
    pub(super) first: bool,
}

impl Place {
    pub(super) fn hypothesis(&self, how: How, c: &Conventions) -> Hypothesis {
        self.at(None, how, c)
    }

    /// One of the times that an evaluation comes by alone, or all of them.
    pub(super) fn at(&self, nth: Option<Nth>, how: How, c: &Conventions) -> Hypothesis {
        let Place { machine, operations, forward, .. } = *self;
        let fault = Fault::of([Wrong { site: self.seen.site, how, nth }]);
        let slip = FormulaSlip { machine, fault, operations, forward };
        Hypothesis { slip: Some(Slip::Formula(slip)), ..Hypothesis::new(vec![], *c) }
    }
}

/// The sites that a machine comes by.
pub(super) fn sites(question: &Question, c: &Conventions, n: u64, case: &Case) -> Vec<Seen> {
    let direction = question.component.direction(question.kind).expect("a question has its direction");
    Fault::observed(|fault| drop((direction.honest)(&case.inputs, c, &machine(n, fault))))
}

pub(super) fn count(all: &[Seen]) -> usize {
    LEAST + all.iter().map(|seen| seen.times).sum::<usize>()
}

/// How often formulas come by their operations for a point.
pub(super) struct Times {
    /// By machine, in two cases of different size: the number of points, and the sites.
    seen: Vec<[(usize, Vec<Seen>); 2]>,
}

impl Times {
    /// Counted in the failing case and in another one; where all have as many points, nothing is known.
    pub(super) fn new(
        question: &Question,
        cases: &[(&Case, &Answer)],
        failing: usize,
        c: &Conventions,
    ) -> Times {
        let points = |case: &Case| {
            let expected = question.expected(case, c);
            expected.values().filter_map(|a| a.shape().first().copied()).max().unwrap_or(1).max(1)
        };
        let case = cases[failing].0;
        let other = cases.iter().map(|(other, _)| *other).find(|other| points(other) != points(case));
        let count = |n: u64, case: &Case| (points(case), sites(question, c, n, case));
        let both = |other| (0..MACHINES).map(|n| [count(n, case), count(n, other)]).collect();
        Times { seen: other.map_or_else(Vec::new, both) }
    }

    /// Each time that it comes by a place for a point, if there are some.
    pub(super) fn of(&self, place: &Place) -> impl Iterator<Item = Nth> + use<> {
        let times = |(points, all): &(usize, Vec<Seen>)| {
            let seen = all.iter().find(|seen| seen.site == place.seen.site)?;
            (seen.times % points == 0).then_some(seen.times / points)
        };
        let both = self.seen.get(place.machine as usize).map(|both| both.each_ref().map(times));
        let of = both.filter(|[a, b]| a == b).and_then(|[a, _]| a).unwrap_or(0);
        (0..of).filter(move |_| (2..=MOST_TIMES).contains(&of)).map(move |index| Nth { index, of })
    }
}

/// Every operation that an honest implementation does; looking for them costs about so many of them.
pub(super) fn places(
    question: &Question,
    cases: &[(&Case, &Answer)],
    c: &Conventions,
    mut left: usize,
) -> Vec<Place> {
    let largest = cases.last().map_or(0, |(case, _)| count(&sites(question, c, 0, case)));
    let (operations, forward) = (PATIENCE * largest, question.kind == Kind::Forward);
    let (mut all, mut paths): (Vec<Place>, Vec<Vec<Site>>) = (vec![], vec![]);
    for n in 0..MACHINES {
        for (case, _) in cases {
            if left == 0 {
                return all;
            }
            let found = sites(question, c, n, case);
            let path: Vec<Site> = found.iter().map(|seen| seen.site).collect();
            let new = !paths.contains(&path);
            left = left.saturating_sub(count(&found));
            for seen in found {
                let known = all.iter_mut().find(|place| place.seen.site == seen.site);
                let first = known.is_none();
                if let Some(place) = known {
                    place.seen.value = place.seen.value.filter(|had| Some(*had) == seen.value);
                }
                if first || new {
                    all.push(Place { machine: n, seen, operations, forward, first });
                }
            }
            paths.push(path);
        }
    }
    all
}
