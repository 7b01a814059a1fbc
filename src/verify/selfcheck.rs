//! The harness checks itself: honest machines pass, the all-zero answer and every mistake fail.

use serde_json::{Value, json};

use super::arithmetic::{Arithmetic, Dtype, Grade};
use super::case::Case;
use super::check::{Kind, tolerance, worst};
use super::component::{Arrays, Component, Pass};
use super::machine::Machine;
use crate::COMPONENTS;
use crate::convention::CS180;
use crate::parallel;

/// Honest machines a case.
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
    /// Those that don't.
    pub missed: Vec<&'static str>,
}

impl Row {
    /// No honest answer rejected, the all-zero one rejected, and in f64 every mistake.
    pub fn pass(&self) -> bool {
        self.cases > 0 && self.rejected == 0 && self.zero_fails && (self.dtype != Dtype::F64 || self.missed.is_empty())
    }

    /// For machines.
    pub fn json(&self) -> Value {
        json!({
            "component": self.name, "kind": self.kind, "dtype": self.dtype.to_string(), "cases": self.cases,
            "evaluations": self.evaluations, "rejected": self.rejected, "zero_fails": self.zero_fails,
            "mistakes": self.mistakes, "caught": self.caught, "missed": self.missed, "pass": self.pass(),
        })
    }
}

/// All rows of the components whose name or folder contains `filter`.
pub fn run(filter: &str) -> Vec<Row> {
    let wanted = COMPONENTS.iter().filter(|c| c.name.contains(filter) || c.folder.contains(filter));
    let kinds = wanted.flat_map(|c| [Kind::Forward, Kind::Vjp].into_iter().filter_map(move |k| Some((c, k, c.pass(k)?))));
    let jobs: Vec<_> = kinds.flat_map(|(c, k, pass)| Dtype::ALL.map(|dtype| (c, k, pass, dtype))).collect();
    parallel::map(jobs.len(), |n| row(jobs[n].0, jobs[n].1, jobs[n].2, jobs[n].3))
}

fn row(component: &Component, kind: Kind, pass: &Pass, dtype: Dtype) -> Row {
    let mut cases = component.cases_of(kind, &CS180);
    cases.retain(|case| case.exists_in(dtype));
    let truths: Vec<(Arrays, [Arrays; 2])> = cases.iter().map(|case| truth(pass, case, dtype)).collect();
    let shown: Vec<_> = component.mistakes.iter().filter(|m| m.gradient == (kind == Kind::Vjp)).collect();
    let exceeds = |f: &dyn Fn(&Case, &Arrays) -> Arrays| {
        cases.iter().zip(&truths).any(|(case, (expected, [_, b]))| worst(&f(case, expected), expected, b) > 1.0)
    };
    let missed = shown.iter().filter(|m| !exceeds(&|case, _| (pass.wrong)(&case.inputs, &CS180, &[m.name])));
    let missed: Vec<&str> = missed.map(|m| m.name).collect();
    let rejected = |(case, (expected, bounds)): (&Case, &(Arrays, [Arrays; 2]))| {
        let used = |n| {
            let machine = Machine::number(dtype, 5 * n);
            let got = (pass.honest)(&case.inputs, &CS180, &machine);
            worst(&got, expected, &bounds[usize::from(!machine.stable)])
        };
        (0..MACHINES).filter(|&n| used(n) > 1.0).count()
    };
    Row {
        name: component.name,
        kind: super::exam::kind_name(component, kind),
        dtype,
        cases: cases.len(),
        evaluations: cases.len() * MACHINES as usize,
        rejected: cases.iter().zip(&truths).map(rejected).sum(),
        zero_fails: exceeds(&|_, expected| expected.iter().map(|(name, a)| (name.clone(), a.mapv(|_| 0.0))).collect()),
        mistakes: shown.len(),
        caught: shown.len() - missed.len(),
        missed,
    }
}

fn truth(pass: &Pass, case: &Case, dtype: Dtype) -> (Arrays, [Arrays; 2]) {
    let bound = |grade| tolerance(pass, &case.inputs, &CS180, &Arithmetic::new(dtype, grade));
    ((pass.oracle)(&case.inputs, &CS180), [bound(Grade::A), bound(Grade::B)])
}
