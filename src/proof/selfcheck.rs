//! The harness's check of itself: honest machines pass, the all-zero answer and every mistake fail.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use serde_json::{Value, json};

use crate::contract::arithmetic::{Arithmetic, Dtype, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::check::{Kind, tolerance, worst};
use crate::contract::component::{Component, Direction};
use crate::contract::machine::Machine;
use crate::convention::{CS180, american};
use crate::{COMPONENTS, parallel};

/// Honest machines per case.
const MACHINES: u64 = 8;

/// One component in one direction and type.
#[derive(Clone, Debug)]
pub struct Row {
    /// Component.
    pub name: &'static str,
    /// `forward` or `vjp`.
    pub kind: &'static str,
    /// Type.
    pub dtype: Dtype,
    /// Cases.
    pub cases: usize,
    /// Cases times machines.
    pub evaluations: usize,
    /// Honest answers that the bound rejects.
    pub rejected: usize,
    /// Whether the all-zero answer fails.
    pub zero_fails: bool,
    /// Mistakes that this direction can show.
    pub mistakes: usize,
    /// Mistakes that exceed the bound.
    pub caught: usize,
    /// Those that don't, with the largest error over bound that they reach.
    pub missed: Vec<(&'static str, f64)>,
    /// Elements that aren't 0 over the reals, and how many of these the bound reaches (vacuous: they prove nothing).
    pub elements: usize,
    /// See `elements`.
    pub vacuous: usize,
    /// Bound over |y| in the middle of the others.
    pub bound_over_y: f64,
    /// The largest error over bound of an honest machine.
    pub error_over_bound: f64,
}

impl Row {
    /// No honest answer rejected, the all-zero one rejected, and in f64 every mistake.
    pub fn pass(&self) -> bool {
        self.cases > 0
            && self.rejected == 0
            && self.zero_fails
            && (self.dtype != Dtype::F64 || self.missed.is_empty())
    }

    /// Names of the mistakes below the bound.
    pub fn missed_names(&self) -> Vec<&'static str> {
        self.missed.iter().map(|(name, _)| *name).collect()
    }

    /// For machines.
    pub fn json(&self) -> Value {
        json!({
            "component": self.name, "kind": self.kind, "dtype": self.dtype.to_string(), "cases": self.cases,
            "evaluations": self.evaluations, "rejected": self.rejected, "zero_fails": self.zero_fails,
            "mistakes": self.mistakes, "caught": self.caught, "missed": self.missed_names(), "pass": self.pass(),
            "missed_error_over_bound": self.missed.iter().copied().collect::<BTreeMap<_, _>>(), "elements": self.elements,
            "vacuous": self.vacuous, "bound_over_y": self.bound_over_y, "error_over_bound": self.error_over_bound,
        })
    }
}

/// All rows of all components, computed once.
pub fn all() -> &'static [Row] {
    static ALL: OnceLock<Vec<Row>> = OnceLock::new();
    ALL.get_or_init(|| run(""))
}

/// All rows of the components whose name or folder contains `filter`.
pub fn run(filter: &str) -> Vec<Row> {
    let filter = american(filter);
    let wanted = COMPONENTS.iter().filter(|c| c.name.contains(&filter) || c.folder.contains(&filter));
    let kinds = wanted.flat_map(|c| {
        [Kind::Forward, Kind::Vjp].into_iter().filter_map(move |k| Some((c, k, c.direction(k)?)))
    });
    let jobs: Vec<_> =
        kinds.flat_map(|(c, k, direction)| Dtype::ALL.map(|dtype| (c, k, direction, dtype))).collect();
    parallel::map(jobs.len(), |n| row(jobs[n].0, jobs[n].1, jobs[n].2, jobs[n].3))
}

fn row(component: &Component, kind: Kind, direction: &Direction, dtype: Dtype) -> Row {
    let mut cases = component.cases_of(kind, &CS180);
    cases.retain(|case| case.exists_in(dtype));
    let truths: Vec<(Arrays, [Arrays; 2])> = cases.iter().map(|case| truth(direction, case, dtype)).collect();
    let shown: Vec<_> = component.mistakes.iter().filter(|m| m.gradient == (kind == Kind::Vjp)).collect();
    let used = |f: &dyn Fn(&Case, &Arrays) -> Arrays| {
        let each = cases.iter().zip(&truths);
        each.map(|(case, (expected, [_, b]))| worst(&f(case, expected), expected, b)).fold(0.0, f64::max)
    };
    let reach = |m: &str| used(&|case, _| (direction.wrong)(&case.inputs, &CS180, &[m]));
    let reached = shown.iter().map(|m| (m.name, reach(m.name)));
    let missed: Vec<(&str, f64)> = reached.filter(|(_, used)| *used <= 1.0).collect();
    let honest: Vec<f64> = cases
        .iter()
        .zip(&truths)
        .flat_map(|(case, (expected, bounds))| {
            (0..MACHINES).map(move |n| {
                let machine = Machine::number(dtype, 5 * n);
                let got = (direction.honest)(&case.inputs, &CS180, &machine);
                worst(&got, expected, &bounds[usize::from(!machine.stable)])
            })
        })
        .collect();
    let relative: Vec<f64> = truths.iter().flat_map(|(expected, [_, b])| sharpness(expected, b)).collect();
    let mut sharp: Vec<f64> = relative.iter().copied().filter(|ratio| *ratio < 1.0).collect();
    sharp.sort_by(f64::total_cmp);
    Row {
        name: component.name,
        kind: crate::judge::exam::kind_name(component, kind),
        dtype,
        cases: cases.len(),
        evaluations: cases.len() * MACHINES as usize,
        rejected: honest.iter().filter(|used| **used > 1.0).count(),
        zero_fails: used(&|_, expected| {
            expected.iter().map(|(name, a)| (name.clone(), a.mapv(|_| 0.0))).collect()
        }) > 1.0,
        mistakes: shown.len(),
        caught: shown.len() - missed.len(),
        missed,
        elements: relative.len(),
        vacuous: relative.len() - sharp.len(),
        bound_over_y: sharp.get(sharp.len() / 2).copied().unwrap_or(f64::INFINITY),
        error_over_bound: honest.into_iter().fold(0.0, f64::max),
    }
}

/// Bound over |y| of every element that is finite and not 0.
fn sharpness(expected: &Arrays, bound: &Arrays) -> Vec<f64> {
    let pairs = expected.iter().flat_map(|(name, y)| y.iter().zip(&bound[name]));
    pairs.filter(|(y, _)| y.is_finite() && **y != 0.0).map(|(y, bound)| bound / y.abs()).collect()
}

fn truth(direction: &Direction, case: &Case, dtype: Dtype) -> (Arrays, [Arrays; 2]) {
    let bound = |grade| tolerance(direction, &case.inputs, &CS180, &Arithmetic::new(dtype, grade));
    ((direction.oracle)(&case.inputs, &CS180), [bound(Grade::A), bound(Grade::B)])
}
