//! Somebody's implementation as closures over named arrays, judged in process.

use std::any::Any;
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::panic::{AssertUnwindSafe, catch_unwind};

use super::answer::{Manner, Reply, given};
use super::asking::examine;
use super::declared::Declared;
use super::exam::{Exam, Question};
use super::large::{LargeExam, examine_in_process};
use super::report::Report;
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::check::Kind;
use crate::convention::profiles::{self, Profile};
use crate::error::{Error, Result};

/// A function under test.
type Closure<'a> = Box<dyn Fn(&Arrays) -> Arrays + Sync + 'a>;

/// Somebody's implementation: closures by component, forward or VJP.
///
/// Of any rows at once, over the contract's own arrays; a kernel of one row has a typed front door in its component ([`super::Door`]).
///
/// ```
/// use nerf_oracle::contract::arrays::{array, arrays, input};
/// use nerf_oracle::judge::{Candidate, Verdict, judge};
/// use nerf_oracle::contract::Dtype;
///
/// // C' = C + (1 - A) b, as somebody might write it.
/// let candidate = Candidate::new().forward("composite_background", |inputs| {
///     let (colors, opacity) = (input(inputs, "colors"), input(inputs, "opacity"));
///     let b = input(inputs, "background");
///     let out = colors.indexed_iter().map(|(i, c)| c + (1.0 - opacity[[i[0]]]) * b[[i[1]]]).collect();
///     arrays([("colors_out", array(colors.shape(), out))])
/// });
/// let report = judge(&candidate, Dtype::F64).unwrap();
/// assert_eq!(report.of("composite_background", "forward").unwrap().verdict, Verdict::Pass);
/// ```
#[derive(Default)]
pub struct Candidate<'a> {
    functions: BTreeMap<(String, Kind), Closure<'a>>,
    declared: BTreeMap<(String, Kind), Declared>,
    profile: Option<&'static Profile>,
}

impl std::fmt::Debug for Candidate<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Candidate")
            .field("rows", &self.functions.keys())
            .field("profile", &self.profile.map(|p| p.name))
            .finish_non_exhaustive()
    }
}

impl<'a> Candidate<'a> {
    /// A candidate that implements nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a component's forward function (its trace, for `render_trace`): inputs by name -> outputs by name.
    pub fn forward(mut self, component: &str, f: impl Fn(&Arrays) -> Arrays + Sync + 'a) -> Self {
        self.functions.insert((component.into(), Kind::Forward), Box::new(f));
        self
    }

    /// Adds a component's vector-Jacobian product: inputs and `grad_<output>` by name -> `grad_<input>` by name.
    pub fn vjp(mut self, component: &str, f: impl Fn(&Arrays) -> Arrays + Sync + 'a) -> Self {
        self.functions.insert((component.into(), Kind::Vjp), Box::new(f));
        self
    }

    /// Says which inputs a component's functions take: cases that need others are left out and told (a center off the middle for rays of
    /// `height`, `width`, `focal` and `c2w`).
    pub fn takes(self, component: &str, inputs: &[&str]) -> Self {
        let inputs = inputs.iter().map(ToString::to_string).collect();
        self.declaring(component, Some(&inputs), None)
    }

    /// Says which outputs a component's gradient goes through: the cotangents of the others are 0.
    pub fn returns(self, component: &str, outputs: &[&str]) -> Self {
        let outputs = outputs.iter().map(ToString::to_string).collect();
        self.declaring(component, None, Some(&outputs))
    }

    /// Both at once, as far as they are said.
    pub(crate) fn declaring(
        mut self,
        component: &str,
        takes: Option<&Vec<String>>,
        returns: Option<&Vec<String>>,
    ) -> Self {
        for kind in [Kind::Forward, Kind::Vjp] {
            let declared = self.declared.entry((component.into(), kind)).or_default();
            declared.takes = takes.cloned().or(declared.takes.take());
            declared.returns = returns.cloned().or(declared.returns.take());
        }
        self
    }

    /// Pins the conventions: deviating from them fails.
    ///
    /// # Errors
    /// An unknown profile.
    pub fn profile(mut self, name: &str) -> Result<Self> {
        self.profile = Some(profiles::find(name)?);
        Ok(self)
    }
}

/// Asks a candidate that computes in `dtype` every question on the rows that it has, and no others, and judges its answers. Every
/// question comes four times, so that answers that depend on chance or on the question before show, and then with its rays or points in
/// another order and in tiles. Where it panics, that case has no answer but what it said.
///
/// # Errors
/// A component that isn't in the contract, or an input or output that the component doesn't have.
pub fn judge(candidate: &Candidate, dtype: Dtype) -> Result<Report> {
    let exam = Exam::of(&candidate.rows(), dtype, candidate.profile)?;
    let declared = candidate.declared_in(&exam);
    let exam = exam.narrowed(&declared).map_err(undeclared)?;
    let asked = examine(exam, true, |question, case, manner| match manner {
        Manner::Plain => candidate.ask(question, case),
        // The arrays of a Rust closure lie in one piece.
        Manner::Strided => Ok(Reply::Nothing),
    });
    asked.map_err(|never: Infallible| match never {})
}

/// The same of large cases: real sizes, each asked twice. Rows without any are left out.
///
/// # Errors
/// Those of [`judge`], and where no row of the candidate has large cases.
pub fn judge_large(candidate: &Candidate, dtype: Dtype) -> Result<Report> {
    let large = LargeExam::of(&candidate.rows(), dtype, candidate.profile)?;
    let declared = candidate.declared_in(&large.exam);
    let large = large.narrowed(&declared).map_err(undeclared)?;
    let asked = examine_in_process(large, |question, case| candidate.ask(question, case));
    asked.map_err(|never: Infallible| match never {})
}

fn undeclared(what: String) -> Error {
    Error::usage("takes, returns", what, "the contract's names")
}

impl Candidate<'_> {
    fn rows(&self) -> Vec<(&str, Kind)> {
        self.functions.keys().map(|(name, kind)| (&name[..], *kind)).collect()
    }

    /// What it declares of the rows of an exam.
    fn declared_in(&self, exam: &Exam) -> BTreeMap<String, Declared> {
        let one = |question: &Question| {
            let of = (question.component.name.to_string(), question.kind);
            Some((question.row(), self.declared.get(&of)?.clone()))
        };
        exam.questions.iter().filter_map(one).collect()
    }

    /// The answer to a case; what a panic says, where it panics.
    fn ask(&self, question: &Question, case: &Case) -> Result<Reply, Infallible> {
        let function = self.functions.get(&(question.component.name.to_string(), question.kind));
        let Some(f) = function else { return Ok(Reply::Nothing) };
        Ok(match catch_unwind(AssertUnwindSafe(|| f(&case.inputs))) {
            Ok(outputs) => Reply::Answer(given(outputs)),
            Err(panic) => Reply::Crash(said(&*panic)),
        })
    }
}

/// What a panic said.
fn said(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "a panic".into())
}
