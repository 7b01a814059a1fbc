//! Honest interlevel losses: the weights that overlap added up, or a difference of running sums; gradients by the same.

use super::arrays::{form, forward, vjp};
use super::{Form, Histogram, overlaps};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::contract::operations::Operations;
use crate::convention::{Conventions, LossReduction};

/// The number of ways: by overlap, fractions before squares; then by running sums.
pub(super) const WAYS: u64 = 4;
/// The first that takes running sums.
pub(super) const RUNNING: u64 = 2;

/// A ray in some arithmetic.
pub(super) struct Ray<'a, O: Operations> {
    o: &'a O,
    form: Form,
    /// Of each interval: the proposal's intervals that overlap it.
    covers: Vec<Vec<usize>>,
    /// max(0, w - bound) and w + eps.
    missing: Vec<O::Number>,
    over: Vec<O::Number>,
    intervals: usize,
    way: u64,
}

impl<'a, O: Operations> Ray<'a, O> {
    pub(super) fn new(o: &'a O, fine: Histogram, proposal: Histogram, form: Form, way: u64) -> Self {
        let v: Vec<O::Number> = proposal.weights.iter().map(|v| o.exact(*v)).collect();
        let covers: Vec<Vec<usize>> = (0..fine.weights.len())
            .map(|i| (0..v.len()).filter(|&j| overlaps(fine.t, i, proposal.t, j, form.edges)).collect())
            .collect();
        let bound = |covers: &Vec<usize>| match (covers.first(), covers.last()) {
            (Some(&first), Some(&last)) if way % WAYS >= RUNNING => {
                o.sub(o.sum(&v[..=last]), o.sum(&v[..first]))
            }
            _ => o.sum(&covers.iter().map(|&j| v[j]).collect::<Vec<_>>()),
        };
        let missing = |(w, covers): (&f64, &Vec<usize>)| {
            let missing = o.sub(o.exact(*w), bound(covers));
            o.above(missing, o.exact(0.0), missing)
        };
        let missing = fine.weights.iter().zip(&covers).map(missing).collect();
        let over = fine.weights.iter().map(|w| o.add(o.exact(*w), o.hyper(form.eps))).collect();
        Ray { o, form, covers, missing, over, intervals: v.len(), way: way % WAYS }
    }

    fn reduced(&self, x: O::Number) -> O::Number {
        let n = self.missing.len() as f64;
        if self.form.reduction == LossReduction::Sum { x } else { self.o.div(x, self.o.exact(n)) }
    }

    pub(super) fn loss(&self) -> O::Number {
        let o = self.o;
        let term = |(missing, over): (&O::Number, &O::Number)| match self.way % 2 {
            _ if o.is_zero(*missing) => o.exact(0.0),
            0 => o.div(o.mul(*missing, *missing), *over),
            _ => o.mul(*missing, o.div(*missing, *over)),
        };
        let terms: Vec<O::Number> = self.missing.iter().zip(&self.over).map(term).collect();
        self.reduced(o.sum(&terms))
    }

    /// Gradients of the proposal's weights.
    pub(super) fn gradients(&self, g: f64) -> Vec<O::Number> {
        let (o, each) = (self.o, self.reduced(self.o.times(-2.0, self.o.exact(g))));
        let share = |i: usize| {
            if o.is_zero(self.missing[i]) {
                o.exact(0.0)
            } else if self.way % 2 == 0 {
                o.mul(each, o.div(self.missing[i], self.over[i]))
            } else {
                o.div(o.mul(each, self.missing[i]), self.over[i])
            }
        };
        let shares: Vec<O::Number> = (0..self.missing.len()).map(share).collect();
        (0..self.intervals).map(|j| o.sum(&self.parts(&shares, j))).collect()
    }

    /// What interval j of the proposal gathers. Running sums pass each share to all up to the last, and take it back in front of the
    /// first.
    fn parts(&self, shares: &[O::Number], j: usize) -> Vec<O::Number> {
        let mut parts = vec![];
        for (share, covers) in shares.iter().zip(&self.covers) {
            let (Some(&first), Some(&last)) = (covers.first(), covers.last()) else { continue };
            if self.way < RUNNING {
                parts.extend(covers.contains(&j).then_some(*share));
            } else {
                parts.extend((j <= last).then_some(*share));
                parts.extend((j < first).then(|| self.o.neg(*share)));
            }
        }
        parts
    }
}

/// Which way a machine takes.
fn way(m: &Machine) -> u64 {
    if m.stable { m.form % RUNNING } else { RUNNING + m.form % (WAYS - RUNNING) }
}

/// The loss.
pub(crate) fn interlevel(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    forward(a, |fine, proposal| Ray::new(m, fine, proposal, form(a, c), way(m)).loss())
}

/// Its gradient.
pub(crate) fn interlevel_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |fine, proposal, g| Ray::new(m, fine, proposal, form(a, c), way(m)).gradients(g))
}
